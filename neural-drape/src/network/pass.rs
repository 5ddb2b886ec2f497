//! Forward and backward through the network for all points, fused and in fixed groups: the same bits whatever the
//! thread count.

use faer::MatRef;
use rayon::prelude::*;

use super::block::{Block, BLOCK_SIZE};
use super::layer::{columns, pull_back_relu, Layer};
use super::map::NetworkMap;

/// Blocks of one lane, at least: a lane has gradients of its own, which cost as much to sum as a few points.
const BLOCKS_PER_LANE: usize = 3;
/// More lanes than this would spend memory on cores that few machines have.
const MAX_LANES: usize = 16;

/// All points, with what each layer made of them.
#[derive(Debug)]
pub(super) struct Pass {
    lanes: Vec<Lane>,
    is_trainable: bool,
}

/// Blocks that add into the same gradients, in order.
#[derive(Debug)]
struct Lane {
    blocks: Vec<Block>,
    gradients: Gradients,
    scratch: Scratch,
}

/// dL/dθ for every parameter of a [`NetworkMap`].
#[derive(Clone, Debug)]
pub(super) struct Gradients {
    /// One per layer of each network that is not hidden; the first layer's by its revealed inputs.
    pub(super) networks: Vec<Vec<Layer>>,
    /// One per row of the waves; empty where they do not train.
    pub(super) rows: Vec<[f32; 3]>,
}

/// dL/d(what leaves a layer), for the layer at hand and the one before.
#[derive(Clone, Debug, Default)]
struct Scratch {
    outer: Vec<f32>,
    inner: Vec<f32>,
}

impl Pass {
    /// Room for `points`; with `is_trainable`, the waves have gradients too.
    pub(super) fn new(points: &[[f32; 3]], map: &NetworkMap, is_trainable: bool) -> Self {
        let n_blocks = points.len().div_ceil(BLOCK_SIZE).max(1);
        let n_lanes = (n_blocks / BLOCKS_PER_LANE).clamp(1, MAX_LANES);
        let mut blocks: Vec<Block> = points
            .chunks(points.len().div_ceil(n_blocks).max(1))
            .map(|chunk| Block::new(chunk.to_vec(), &map.waves))
            .collect();
        for block in &mut blocks {
            if is_trainable {
                block.slopes = vec![0.0; block.features.len()];
            }
            block.encode(&map.waves, map.waves.n_features());
        }
        let lanes = blocks
            .chunks(n_blocks.div_ceil(n_lanes))
            .map(|blocks| Lane {
                blocks: blocks.to_vec(),
                gradients: Gradients::new(map, is_trainable),
                scratch: Scratch::default(),
            })
            .collect();
        Self {
            lanes,
            is_trainable,
        }
    }

    /// Evaluates `map` at every point.
    pub(super) fn forward(&mut self, map: &NetworkMap) {
        let is_trainable = self.is_trainable;
        self.lanes.par_iter_mut().for_each(|lane| {
            for block in &mut lane.blocks {
                if is_trainable {
                    block.encode(&map.waves, map.n_revealed());
                }
                block.forward(&map.networks);
            }
        });
    }

    /// What the networks put out together, point by point.
    pub(super) fn outputs(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.lanes
            .iter()
            .flat_map(|lane| lane.blocks.iter().flat_map(Block::outputs))
    }

    /// dL/dθ at the last [`Self::forward`] of `map`, for `gradient` = dL/d(output), three entries per point.
    pub(super) fn backward(&mut self, map: &NetworkMap, gradient: &[f32]) -> &Gradients {
        let mut rest = gradient;
        let mut parts = Vec::with_capacity(self.lanes.len());
        for lane in &self.lanes {
            let n = lane
                .blocks
                .iter()
                .map(|block| block.points.len())
                .sum::<usize>();
            let (part, others) = rest.split_at(3 * n);
            parts.push(part);
            rest = others;
        }
        self.lanes
            .par_iter_mut()
            .zip(parts)
            .for_each(|(lane, part)| lane.backward(map, part));
        self.sum_lanes()
    }

    /// Adds the gradients of all lanes, in order, into those of the first.
    fn sum_lanes(&mut self) -> &Gradients {
        let (first, others) = self.lanes.split_at_mut(1);
        let sum = &mut first[0].gradients;
        for lane in others {
            sum.add(&lane.gradients);
        }
        sum
    }
}

impl Lane {
    fn backward(&mut self, map: &NetworkMap, gradient: &[f32]) {
        self.gradients.reset(map);
        let mut rest = gradient;
        for block in &self.blocks {
            let (part, others) = rest.split_at(3 * block.points.len());
            rest = others;
            for network in 0..map.networks.len() {
                // The outputs are summed, so that each network has the gradient of the sum.
                self.scratch.outer.clear();
                self.scratch.outer.extend_from_slice(part);
                block.backward(map, network, &mut self.gradients, &mut self.scratch);
            }
        }
    }
}

impl Block {
    /// Adds dL/dθ of one network to `gradients`; `scratch.outer` holds dL/d(output).
    fn backward(
        &self,
        map: &NetworkMap,
        network: usize,
        gradients: &mut Gradients,
        scratch: &mut Scratch,
    ) {
        let (layers, activations) = (&map.networks[network], &self.activations[network]);
        let by_layer = &mut gradients.networks[network];
        for (l, layer) in layers.iter().enumerate().skip(1).rev() {
            let input = &activations[l - 1];
            layer.add_gradient(&mut by_layer[l], self.view(input, layer), &scratch.outer);
            layer.pull_back(&scratch.outer, &mut scratch.inner);
            pull_back_relu(&mut scratch.inner, input);
            std::mem::swap(&mut scratch.outer, &mut scratch.inner);
        }

        let first = &layers[0];
        let features = self.view(&self.features, first);
        first.add_gradient(&mut by_layer[0], features, &scratch.outer);
        if !gradients.rows.is_empty() {
            first.pull_back(&scratch.outer, &mut scratch.inner);
            self.add_row_gradient(map.waves.gain, &mut gradients.rows, &mut scratch.inner);
        }
    }

    fn view<'a>(&self, input: &'a [f32], layer: &Layer) -> MatRef<'a, f32> {
        columns(input, self.points.len(), layer.n_inputs())
    }

    /// d/d(row) of wave(gain · row · x) is slope · gain · x; waves that train have one feature a row. `by_feature`, dL/d(feature),
    /// becomes dL/d(row · x).
    fn add_row_gradient(&self, gain: f32, rows: &mut [[f32; 3]], by_feature: &mut [f32]) {
        let n = self.points.len();
        let (n_revealed, n_features) = (by_feature.len() / n, self.features.len() / n);
        let mut by_axis = [0, 1, 2].map(|_| vec![0.0; n_revealed - 3]);
        let by_point = by_feature
            .chunks_mut(n_revealed)
            .zip(self.slopes.chunks(n_features));
        for (point, (by_feature, slopes)) in self.points.iter().zip(by_point) {
            let by_phase = &mut by_feature[3..];
            for (d, slope) in by_phase.iter_mut().zip(&slopes[3..]) {
                *d *= slope * gain;
            }
            for (sums, &x) in by_axis.iter_mut().zip(point) {
                sums.iter_mut()
                    .zip(&*by_phase)
                    .for_each(|(sum, d)| *sum += d * x);
            }
        }
        for (axis, sums) in by_axis.iter().enumerate() {
            rows.iter_mut()
                .zip(sums)
                .for_each(|(row, sum)| row[axis] += sum);
        }
    }
}

impl Gradients {
    fn new(map: &NetworkMap, is_trainable: bool) -> Self {
        let n_rows = if is_trainable {
            map.waves.rows.len()
        } else {
            0
        };
        Self {
            networks: Vec::new(),
            rows: vec![[0.0; 3]; n_rows],
        }
    }

    /// Zero, for as many networks and inputs as `map` reveals.
    fn reset(&mut self, map: &NetworkMap) {
        self.networks.resize_with(map.networks.len(), Vec::new);
        for (gradients, layers) in self.networks.iter_mut().zip(&map.networks) {
            gradients.resize_with(layers.len(), Layer::default);
            for (gradient, layer) in gradients.iter_mut().zip(layers) {
                for (sum, like) in [
                    (&mut gradient.weight, &layer.weight),
                    (&mut gradient.bias, &layer.bias),
                ] {
                    sum.clear();
                    sum.resize(like.len(), 0.0);
                }
            }
        }
        self.rows.fill([0.0; 3]);
    }

    fn add(&mut self, other: &Self) {
        let add =
            |sum: &mut [f32], part: &[f32]| sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        let layers = self.networks.iter_mut().flatten();
        for (sum, part) in layers.zip(other.networks.iter().flatten()) {
            add(&mut sum.weight, &part.weight);
            add(&mut sum.bias, &part.bias);
        }
        add(self.rows.as_flattened_mut(), other.rows.as_flattened());
    }
}
