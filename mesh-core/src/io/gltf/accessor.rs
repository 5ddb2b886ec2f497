//! Numbers of a glTF accessor, wherever they stand: packed, interleaved, normalised, sparse.

use std::collections::{BTreeMap, HashMap};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use super::container::Container;
use super::root::{Component, Part, Sparse};
use crate::io::error::{Place, ReadProblem};
use crate::io::fault::Fault;

/// Where the elements of an accessor stand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) count: usize,
    component: Component,
    is_normalized: bool,
    n_components: usize,
    /// Buffer, first byte and bytes from one element to the next; none where all are zero.
    dense: Option<(usize, usize, usize)>,
    /// Elements that stand elsewhere: buffer and byte.
    sparse: BTreeMap<usize, (usize, usize)>,
}

impl Hash for Layout {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.count, self.dense, &self.sparse).hash(state);
    }
}

/// The layouts of a file, each found once; accessors of the very same numbers share theirs.
#[derive(Default)]
pub(super) struct Layouts {
    row_of_accessor: HashMap<usize, usize>,
    row_of: HashMap<Arc<Layout>, usize>,
    all: Vec<Arc<Layout>>,
}

impl Layouts {
    /// The layout of accessor number `k`, and its row among the different ones.
    pub(super) fn of(
        &mut self,
        container: &Container,
        k: usize,
    ) -> Result<(Arc<Layout>, usize), Fault> {
        let row = match self.row_of_accessor.get(&k) {
            Some(&row) => row,
            None => {
                let layout = Arc::new(Layout::of(container, k)?);
                let row = *self.row_of.entry(layout.clone()).or_insert(self.all.len());
                if row == self.all.len() {
                    self.all.push(layout);
                }
                self.row_of_accessor.insert(k, row);
                row
            }
        };
        Ok((self.all[row].clone(), row))
    }
}

fn fault(accessor: usize, problem: ReadProblem) -> Fault {
    let (element, row) = ("accessor".to_owned(), accessor);
    Fault {
        place: Place::Row { element, row },
        problem,
    }
}

fn broken(accessor: usize, expected: &'static str) -> Fault {
    fault(accessor, ReadProblem::EndsEarly { expected })
}

impl Layout {
    /// The layout of accessor number `k`, all of it inside its buffers.
    pub(super) fn of(container: &Container, k: usize) -> Result<Self, Fault> {
        let expected = "an accessor of numbers";
        let accessor = container
            .root
            .accessors
            .get(k)
            .ok_or_else(|| broken(k, expected))?;
        let mut layout = Self {
            count: check_count(container, k, accessor.count)?,
            component: accessor.component,
            is_normalized: accessor.is_normalized,
            n_components: accessor.n_components,
            dense: None,
            sparse: BTreeMap::new(),
        };
        if let Some(part) = accessor.dense {
            let place = place(container, part, layout.count, layout.size());
            layout.dense = Some(place.ok_or_else(|| broken(k, "the data of an accessor"))?);
        }
        if let Some(sparse) = &accessor.sparse {
            layout.sparse = layout
                .sparse_places(container, sparse)
                .ok_or_else(|| broken(k, "the data of a sparse accessor"))?;
        }
        Ok(layout)
    }

    fn sparse_places(
        &self,
        container: &Container,
        sparse: &Sparse,
    ) -> Option<BTreeMap<usize, (usize, usize)>> {
        let n = Some(sparse.count).filter(|&n| n <= self.count)?;
        let size = sparse.index.size();
        let at = place(container, sparse.indices, n, size)?;
        let to = place(container, sparse.values, n, self.size())?;
        let mut places = BTreeMap::new();
        for k in 0..n {
            let start = at.1 + k * at.2;
            let raw = container.buffer(at.0)?.get(start..start + size)?;
            let index = decode(sparse.index, false, raw) as usize;
            if index >= self.count {
                return None;
            }
            places.insert(index, (to.0, to.1 + k * to.2));
        }
        Some(places)
    }

    /// Bytes of one element.
    fn size(&self) -> usize {
        self.n_components * self.component.size()
    }

    pub(super) fn has_components(&self, n: usize) -> bool {
        self.n_components == n
    }

    /// Whether elements are plain 32-bit floats.
    pub(super) fn is_float(&self) -> bool {
        self.component == Component::F32
    }

    /// Whether elements are single whole numbers from 0, as rows of vertices are.
    pub(super) fn is_rows(&self) -> bool {
        let is_whole = matches!(
            self.component,
            Component::U8 | Component::U16 | Component::U32
        );
        is_whole && !self.is_normalized && self.n_components == 1
    }

    /// Where element `row` stands: buffer and byte; none where it is an implied zero.
    pub(super) fn slot(&self, row: usize) -> Option<(usize, usize)> {
        let sparse = self.sparse.get(&row).copied();
        sparse.or_else(|| {
            self.dense
                .map(|(buffer, start, stride)| (buffer, start + row * stride))
        })
    }

    /// The rows that stand somewhere; all others are implied zeros.
    pub(super) fn rows(&self) -> Box<dyn Iterator<Item = usize> + '_> {
        match self.dense {
            Some(_) => Box::new(0..self.count),
            None => Box::new(self.sparse.keys().copied()),
        }
    }

    /// The first `N` components of element `row`.
    pub(super) fn get<const N: usize>(&self, container: &Container, row: usize) -> [f64; N] {
        let mut values = [0.0; N];
        let Some((buffer, at)) = self.slot(row) else {
            return values;
        };
        let raw = container.buffer(buffer).unwrap_or_default();
        let raw = &raw[at..at + self.size()];
        let size = self.component.size();
        for (value, raw) in values.iter_mut().zip(raw.chunks_exact(size)) {
            *value = decode(self.component, self.is_normalized, raw);
        }
        values
    }

    /// Puts `values` where element `row` stands; whole-number components are rounded.
    pub(super) fn put(&self, buffers: &mut [Vec<u8>], row: usize, values: &[f64]) {
        let Some((buffer, at)) = self.slot(row) else {
            return;
        };
        let size = self.component.size();
        for (k, &value) in values.iter().enumerate() {
            let start = at + k * size;
            encode(
                self.component,
                value,
                &mut buffers[buffer][start..start + size],
            );
        }
    }
}

/// A count that the data of the whole file could hold, even if this accessor only implies zeros.
fn check_count(container: &Container, accessor: usize, count: usize) -> Result<usize, Fault> {
    let bytes = container.n_bytes();
    if count > bytes {
        let element = "elements".to_owned();
        return Err(fault(
            accessor,
            ReadProblem::Oversized {
                element,
                count: count as u64,
                bytes,
            },
        ));
    }
    Ok(count)
}

/// Buffer, first byte and stride of `count` elements of `size` bytes, if all of them are there.
fn place(
    container: &Container,
    part: Part,
    count: usize,
    size: usize,
) -> Option<(usize, usize, usize)> {
    let view = container.root.views.get(part.view)?;
    let stride = view.stride.unwrap_or(size);
    let used = match count {
        0 => 0,
        _ => (count - 1).checked_mul(stride)?.checked_add(size)?,
    };
    let is_inside = part.offset.checked_add(used)? <= view.length
        && view.offset.checked_add(view.length)? <= container.buffer(view.buffer)?.len();
    // Elements that overlap each other could not be written.
    (is_inside && stride >= size).then_some((view.buffer, view.offset + part.offset, stride))
}

fn decode(component: Component, is_normalized: bool, raw: &[u8]) -> f64 {
    let mut bytes = [0; 4];
    bytes[..raw.len()].copy_from_slice(raw);
    let bits = u32::from_le_bytes(bytes);
    let (value, unit) = match component {
        Component::I8 => (f64::from(bits as u8 as i8), 127.0),
        Component::U8 => (f64::from(bits as u8), 255.0),
        Component::I16 => (f64::from(bits as u16 as i16), 32767.0),
        Component::U16 => (f64::from(bits as u16), 65535.0),
        Component::U32 => return f64::from(bits),
        Component::F32 => return f64::from(f32::from_bits(bits)),
    };
    if is_normalized {
        (value / unit).max(-1.0)
    } else {
        value
    }
}

/// A float, or a fraction of the largest whole number (as normals are quantised).
fn encode(component: Component, value: f64, out: &mut [u8]) {
    let bits = match component {
        Component::I8 => (value * 127.0).round() as i8 as u8 as u32,
        Component::U8 => (value * 255.0).round() as u8 as u32,
        Component::I16 => (value * 32767.0).round() as i16 as u16 as u32,
        Component::U16 => (value * 65535.0).round() as u16 as u32,
        Component::U32 => value as u32,
        Component::F32 => (value as f32).to_bits(),
    };
    let n = out.len();
    out.copy_from_slice(&bits.to_le_bytes()[..n]);
}
