//! The map itself: plain f32 weights that move any point of space.

use mesh_core::{Point3, UnitFrame, Vector3};
use rayon::prelude::*;

use super::block::{Block, BLOCK_SIZE};
use super::encoding::Waves;
use super::layer::Layer;

/// Where the network sends points: `p ↦ p + r · mlp(encoding((p − center) / r))`, or the sum of several such offsets.
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
    /// The layers of each network, first to last; a ReLU stands between them. What the networks put out is summed.
    pub(crate) networks: Vec<Vec<Layer>>,
}

impl NetworkMap {
    /// The images of `points`; the same bits whatever the thread count.
    pub(crate) fn apply(&self, points: &[Point3]) -> Vec<Point3> {
        points
            .par_chunks(BLOCK_SIZE)
            .flat_map_iter(|chunk| {
                let mut block = Block::new(
                    chunk.iter().map(|p| to_input(&self.frame, p)).collect(),
                    &self.waves,
                );
                block.encode(&self.waves, self.n_revealed());
                block.forward(&self.networks);
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

    /// How many features of a point some network sees.
    pub(super) fn n_revealed(&self) -> usize {
        let n_inputs = self.networks.iter().map(|layers| layers[0].n_inputs());
        n_inputs.max().unwrap_or(3)
    }

    /// Whether there is a network, and in each every layer takes what the one before gives, from the features to three
    /// coordinates.
    pub(crate) fn is_consistent(&self) -> bool {
        self.frame.scale > 0.0
            && !self.networks.is_empty()
            && self.networks.iter().all(|layers| self.is_network(layers))
    }

    fn is_network(&self, layers: &[Layer]) -> bool {
        let fits = |layer: &Layer| {
            !layer.bias.is_empty()
                && !layer.weight.is_empty()
                && layer.weight.len().is_multiple_of(layer.bias.len())
        };
        let (Some(first), Some(last)) = (layers.first(), layers.last()) else {
            return false;
        };
        layers.iter().all(fits)
            && (3..=self.waves.n_features()).contains(&first.n_inputs())
            && last.n_outputs() == 3
            && layers
                .windows(2)
                .all(|pair| pair[0].n_outputs() == pair[1].n_inputs())
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

/// A point as the network sees it: ±1 over the longest side of the shape that `frame` is of.
pub(super) fn to_input(frame: &UnitFrame, p: &Point3) -> [f32; 3] {
    (frame.to_unit(p) * 2.0).coords.map(|c| c as f32).into()
}
