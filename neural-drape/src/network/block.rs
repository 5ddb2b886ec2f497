//! A few points on their way through the encoding and the layers.

use super::encoding::Waves;
use super::layer::{columns, relu, Layer};

/// How many points are evaluated together: their activations of one layer, 256 × 256 × 4 bytes, stay in a core's cache.
pub(super) const BLOCK_SIZE: usize = 256;

/// A few points on their way through the networks, one column per point.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) points: Vec<[f32; 3]>,
    /// Features of each point; `n_features` rows, of which the first layers read revealed prefixes.
    pub(super) features: Vec<f32>,
    /// Derivative of each feature by its phase; empty where nobody asks.
    pub(super) slopes: Vec<f32>,
    /// What leaves each layer of each network: after the ReLU, or the output itself.
    pub(super) activations: Vec<Vec<Vec<f32>>>,
    /// The outputs of all networks, summed; three entries a point.
    outputs: Vec<f32>,
}

impl Block {
    /// Room for `points` and their features.
    pub(super) fn new(points: Vec<[f32; 3]>, waves: &Waves) -> Self {
        let n = points.len();
        Self {
            features: vec![0.0; n * waves.n_features()],
            slopes: Vec::new(),
            activations: Vec::new(),
            outputs: vec![0.0; 3 * n],
            points,
        }
    }

    /// Computes the first `n_revealed` features of every point.
    pub(super) fn encode(&mut self, waves: &Waves, n_revealed: usize) {
        let n_features = waves.n_features();
        let mut encoder = waves.encoder();
        let mut slopes = self.slopes.chunks_mut(n_features);
        for (point, features) in self.points.iter().zip(self.features.chunks_mut(n_features)) {
            encoder.encode(point, &mut features[..n_revealed], slopes.next());
        }
    }

    /// Computes what leaves every layer from the features, and the sum of what leaves the networks.
    pub(super) fn forward(&mut self, networks: &[Vec<Layer>]) {
        let n = self.points.len();
        self.activations.resize_with(networks.len(), Vec::new);
        self.outputs.fill(0.0);
        for (layers, activations) in networks.iter().zip(&mut self.activations) {
            activations.resize_with(layers.len(), Vec::new);
            for (l, layer) in layers.iter().enumerate() {
                let (before, from_here) = activations.split_at_mut(l);
                let input = match before.last() {
                    Some(activation) => columns(activation, n, layer.n_inputs()),
                    None => columns(&self.features, n, layer.n_inputs()),
                };
                let output = &mut from_here[0];
                output.resize(n * layer.n_outputs(), 0.0);
                layer.forward(input, output);
                if l + 1 < layers.len() {
                    relu(output);
                }
            }
            let output = activations.last().into_iter().flatten();
            self.outputs
                .iter_mut()
                .zip(output)
                .for_each(|(sum, y)| *sum += y);
        }
    }

    /// What the networks put out together for each point.
    pub(super) fn outputs(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.outputs.chunks_exact(3).map(|o| [o[0], o[1], o[2]])
    }
}
