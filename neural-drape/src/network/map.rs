//! The map itself: plain f32 weights that move any point of space.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use mesh_core::{Point3, UnitFrame, Vector3};
use rayon::prelude::*;

use super::encoding::Waves;

/// How many points are evaluated together: their activations of one layer, 256 × 256 × 4 bytes, stay in a core's cache.
pub(super) const BLOCK_SIZE: usize = 256;

/// Where the network sends points: `p ↦ p + r · mlp(encoding((p − center) / r))`.
///
/// r is half the longest side of the shape the network was made for. Points outside that shape are moved too; what
/// the network does far from it is not controlled.
#[derive(Clone, PartialEq, Debug)]
pub struct NetworkMap {
    /// Frame of the shape the network was made for.
    pub(crate) frame: UnitFrame,
    /// Factor between what the last layer puts out and an offset in half longest sides.
    pub(crate) output_scale: f64,
    /// Waves of the encoding; those past the first layer's inputs are hidden.
    pub(crate) waves: Waves,
    /// The layers, first to last; a ReLU stands between them.
    pub(crate) layers: Vec<Layer>,
}

/// `y = Wᵀ x + b`.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Layer {
    /// Entry `[i · n_outputs + o]` weighs input i in output o.
    pub(crate) weight: Vec<f32>,
    /// One entry per output.
    pub(crate) bias: Vec<f32>,
}

impl NetworkMap {
    /// The images of `points`; the same bits whatever the thread count.
    pub(crate) fn apply(&self, points: &[Point3]) -> Vec<Point3> {
        points
            .par_chunks(BLOCK_SIZE)
            .flat_map_iter(|chunk| {
                let mut block = Block::new(chunk.iter().map(|p| self.to_input(p)).collect(), self);
                block.encode(&self.waves, self.layers[0].n_inputs());
                block.forward(&self.layers);
                chunk
                    .iter()
                    .zip(block.outputs().collect::<Vec<_>>())
                    .map(|(p, output)| p + self.offset(output))
                    .collect::<Vec<_>>()
            })
            .collect()
    }

    /// The same map in the coordinates outside `frame`, where this one is in those inside: `frame⁻¹ ∘ map ∘ frame`.
    pub(crate) fn outside(self, frame: &UnitFrame) -> Self {
        Self {
            frame: UnitFrame {
                center: frame.from_unit(&self.frame.center),
                scale: frame.scale * self.frame.scale,
            },
            ..self
        }
    }

    /// Whether every layer takes what the one before gives, from the features to three coordinates.
    pub(crate) fn is_consistent(&self) -> bool {
        let fits = |layer: &Layer| {
            !layer.bias.is_empty()
                && !layer.weight.is_empty()
                && layer.weight.len().is_multiple_of(layer.bias.len())
        };
        let (Some(first), Some(last)) = (self.layers.first(), self.layers.last()) else {
            return false;
        };
        self.frame.scale > 0.0
            && self.layers.iter().all(fits)
            && (3..=self.waves.n_features()).contains(&first.n_inputs())
            && last.n_outputs() == 3
            && self
                .layers
                .windows(2)
                .all(|pair| pair[0].n_outputs() == pair[1].n_inputs())
    }

    /// A point as the network sees it: ±1 over the shape's longest side.
    pub(super) fn to_input(&self, p: &Point3) -> [f32; 3] {
        (self.frame.to_unit(p) * 2.0)
            .coords
            .map(|c| c as f32)
            .into()
    }

    /// The offset that an output stands for, in the shape's units.
    pub(super) fn offset(&self, output: [f32; 3]) -> Vector3 {
        Vector3::from(output.map(f64::from)) * self.output_unit()
    }

    /// Length of an output of 1, in the shape's units.
    pub(super) fn output_unit(&self) -> f64 {
        0.5 * self.frame.scale * self.output_scale
    }
}

impl Layer {
    /// How many inputs it has.
    pub(crate) fn n_inputs(&self) -> usize {
        self.weight.len() / self.n_outputs()
    }

    /// How many outputs it has.
    pub(crate) fn n_outputs(&self) -> usize {
        self.bias.len()
    }

    /// Wᵀ, one row per output.
    pub(super) fn transposed(&self) -> MatRef<'_, f32> {
        MatRef::from_column_major_slice(&self.weight, self.n_outputs(), self.n_inputs())
    }
}

/// A few points on their way through the layers, one column per point.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) points: Vec<[f32; 3]>,
    /// Features of each point; `n_features` rows, of which the first layer reads the revealed prefix.
    pub(super) features: Vec<f32>,
    /// Derivative of each feature by its phase; empty where nobody asks.
    pub(super) slopes: Vec<f32>,
    /// What leaves each layer: after the ReLU, or the output itself.
    pub(super) activations: Vec<Vec<f32>>,
}

impl Block {
    /// Room for `points` in `map`.
    pub(super) fn new(points: Vec<[f32; 3]>, map: &NetworkMap) -> Self {
        let n = points.len();
        Self {
            features: vec![0.0; n * map.waves.n_features()],
            slopes: Vec::new(),
            activations: map
                .layers
                .iter()
                .map(|l| vec![0.0; n * l.n_outputs()])
                .collect(),
            points,
        }
    }

    /// Computes the first `n_revealed` features of every point.
    pub(super) fn encode(&mut self, waves: &Waves, n_revealed: usize) {
        let n_features = waves.n_features();
        let mut slopes = self.slopes.chunks_mut(n_features);
        for (point, features) in self.points.iter().zip(self.features.chunks_mut(n_features)) {
            waves.encode(point, &mut features[..n_revealed], slopes.next());
        }
    }

    /// Computes what leaves every layer from the features.
    pub(super) fn forward(&mut self, layers: &[Layer]) {
        let n = self.points.len();
        for (l, layer) in layers.iter().enumerate() {
            let (before, from_here) = self.activations.split_at_mut(l);
            let input = match before.last() {
                Some(activation) => columns(activation, n, layer.n_inputs()),
                None => columns(&self.features, n, layer.n_inputs()),
            };
            let output = &mut from_here[0];
            for column in output.chunks_mut(layer.n_outputs()) {
                column.copy_from_slice(&layer.bias);
            }
            let view = MatMut::from_column_major_slice_mut(output, layer.n_outputs(), n);
            matmul(view, Accum::Add, layer.transposed(), input, 1.0, Par::Seq);
            if l + 1 < layers.len() {
                output.iter_mut().for_each(|y| *y = y.max(0.0));
            }
        }
    }

    /// What the last layer puts out for each point.
    pub(super) fn outputs(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.activations
            .last()
            .into_iter()
            .flat_map(|output| output.chunks_exact(3).map(|o| [o[0], o[1], o[2]]))
    }
}

/// The first `n_rows` rows of a matrix of `n_columns` columns.
pub(super) fn columns(entries: &[f32], n_columns: usize, n_rows: usize) -> MatRef<'_, f32> {
    MatRef::from_column_major_slice_with_stride(
        entries,
        n_rows,
        n_columns,
        entries.len() / n_columns,
    )
}
