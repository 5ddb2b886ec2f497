//! What a shape is coloured by.

use mesh_core::measure::{corner_angle, triangle_normal};
use mesh_core::{Point3, Positions, SurfacePoint, VertexId};
use mesh_metrics::{common_frame, face_stretch, folded_edges, opposed_triangles};
use serde::Deserialize;

use crate::broadcast::ShownShape;
use crate::displayed::DisplayedPair;

/// What a heat map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Heat {
    /// Distance of each vertex that has a counterpart from the target, in longest sides.
    Distance,
    /// Stretch of each face: 1 keeps its shape and its share of the area.
    Stretch,
    /// Mean change of each triangle's corner angles, in degrees.
    Angle,
    /// 1 for faces that turn against the target's normal.
    Flipped,
}

impl Heat {
    /// The message that carries the map of a shape: four u32 (2, serial, kind, 1 where there is a value per triangle),
    /// then f32 values; below 0 where there is none.
    pub(crate) fn message(self, displayed: &DisplayedPair, shown: &ShownShape) -> Vec<u8> {
        let (values, is_per_triangle) = self.values(displayed, shown);
        let mut bytes = Vec::with_capacity(16 + 4 * values.len());
        for n in [2, shown.serial, self as u32, u32::from(is_per_triangle)] {
            bytes.extend(n.to_le_bytes());
        }
        for value in values {
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes
    }

    fn values(self, displayed: &DisplayedPair, shown: &ShownShape) -> (Vec<f64>, bool) {
        let x: &Positions = &shown.positions;
        let source = &displayed.shapes.source;
        let (t, rest) = (source.triangulation(), source.rest());
        match self {
            Self::Distance => (distances(displayed, shown), false),
            Self::Stretch => {
                let stretch = face_stretch(t, rest, x);
                ((0..t.len()).map(|k| stretch[t.parent(k)]).collect(), true)
            }
            Self::Angle => {
                let pairs = t.corners(rest).zip(t.corners(x));
                let mean = |(from, to): ([_; 3], [_; 3])| {
                    let turn = |k: usize| {
                        let angle =
                            |c: [Point3; 3]| corner_angle(c[k], c[(k + 1) % 3], c[(k + 2) % 3]);
                        (angle(to) - angle(from)).abs()
                    };
                    ((0..3).map(turn).sum::<f64>() / 3.0).to_degrees()
                };
                (pairs.map(mean).collect(), true)
            }
            Self::Flipped => (flipped(displayed, x), true),
        }
    }
}

/// Distances of the vertices from the target; −1 for those that have no counterpart.
fn distances(displayed: &DisplayedPair, shown: &ShownShape) -> Vec<f64> {
    let target = displayed.target.judged();
    let unit = 1.0 / common_frame(target).scale;
    let hits = target.closest_points(shown.positions.as_slice());
    let vertices = shown.positions.ids().zip(&hits);
    let counterparts = shown.counterparts();
    let distance = |(v, hit): (VertexId, &SurfacePoint)| {
        if counterparts.has_vertex(v, hit, target) {
            hit.distance_squared.sqrt() * unit
        } else {
            -1.0
        }
    };
    vertices.map(distance).collect()
}

/// 1 for triangles that face against the target, or against their neighbours where it tells no side.
fn flipped(displayed: &DisplayedPair, x: &Positions) -> Vec<f64> {
    let source = &displayed.shapes.source;
    let t = source.triangulation();
    let mut values = vec![0.0; t.len()];
    let opposed = opposed_triangles(t, x, displayed.target.judged()).unwrap_or_default();
    let folded = folded_edges(t, source.rest(), x);
    let folded = folded.iter().flat_map(|edge| edge.triangles);
    opposed
        .into_iter()
        .chain(folded)
        .for_each(|k| values[k] = 1.0);
    for (value, corners) in values.iter_mut().zip(t.corners(x)) {
        if triangle_normal(corners).is_none() {
            *value = 1.0;
        }
    }
    values
}
