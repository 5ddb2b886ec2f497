//! A few points on their way through the encoding and the layers.

use super::encoding::Waves;
use super::layer::{columns, relu, Layer};

/// How many points are evaluated together: their activations of one layer, 256 × 256 × 4 bytes, stay in a core's cache.
pub(super) const BLOCK_SIZE: usize = 256;

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
    /// Room for `points`, their features and what leaves each of `layers`.
    pub(super) fn new(points: Vec<[f32; 3]>, waves: &Waves, layers: &[Layer]) -> Self {
        let n = points.len();
        Self {
            features: vec![0.0; n * waves.n_features()],
            slopes: Vec::new(),
            activations: layers
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
            layer.forward(input, output);
            if l + 1 < layers.len() {
                relu(output);
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
