//! The bounds that a document states of its positions.

use super::accessor::Layout;
use super::json_spans::{items, member, root, Edit};

/// The smallest and largest coordinates of an accessor.
pub(super) struct Bounds {
    accessor: usize,
    min: [f32; 3],
    max: [f32; 3],
}

impl Bounds {
    /// Those of all elements as they now stand in `buffers`; elements that are implied are zero.
    pub(super) fn of(accessor: usize, layout: &Layout, buffers: &[Vec<u8>]) -> Self {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for row in 0..layout.count {
            let values = match layout.slot(row) {
                None => [0.0; 3],
                Some((buffer, at)) => {
                    let raw = buffers[buffer][at..at + 12].as_chunks().0;
                    [0, 1, 2].map(|axis| f32::from_le_bytes(raw[axis]))
                }
            };
            for (axis, c) in values.into_iter().enumerate() {
                (min[axis], max[axis]) = (min[axis].min(c), max[axis].max(c));
            }
        }
        Self { accessor, min, max }
    }
}

/// What to change in a document for it to state `bounds`; where it states none, it still does not.
pub(super) fn bounds_edits(json: &[u8], bounds: &[Bounds]) -> Vec<Edit> {
    let accessors = member(json, root(json), "accessors");
    let accessors = accessors.map_or_else(Vec::new, |all| items(json, all));
    let mut edits = Vec::new();
    for bound in bounds {
        for (key, [x, y, z]) in [("min", bound.min), ("max", bound.max)] {
            let object = accessors.get(bound.accessor).cloned();
            if let Some(span) = object.and_then(|object| member(json, object, key)) {
                edits.push((span, format!("[{x},{y},{z}]")));
            }
        }
    }
    edits
}
