//! Forward and backward through the network for all points, fused and in fixed groups: the same bits whatever the
//! thread count.

use faer::MatRef;
use rayon::prelude::*;

use super::block::{Block, BLOCK_SIZE};
use super::encoding::Waves;
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
    /// One per layer; the first layer's by its revealed inputs.
    pub(super) layers: Vec<Layer>,
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
            .map(|chunk| Block::new(chunk.to_vec(), &map.waves, &map.layers))
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
                gradients: Gradients::zeros(map, is_trainable),
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
                    block.encode(&map.waves, map.layers[0].n_inputs());
                }
                block.forward(&map.layers);
            }
        });
    }

    /// What the last layer put out, point by point.
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
            self.scratch.outer.clear();
            self.scratch.outer.extend_from_slice(part);
            block.backward(map, &mut self.gradients, &mut self.scratch);
        }
    }
}

impl Block {
    /// Adds dL/dθ to `gradients`; `scratch.outer` holds dL/d(output).
    fn backward(&self, map: &NetworkMap, gradients: &mut Gradients, scratch: &mut Scratch) {
        for (l, layer) in map.layers.iter().enumerate().skip(1).rev() {
            let input = &self.activations[l - 1];
            layer.add_gradient(
                &mut gradients.layers[l],
                self.view(input, layer),
                &scratch.outer,
            );
            layer.pull_back(&scratch.outer, &mut scratch.inner);
            pull_back_relu(&mut scratch.inner, input);
            std::mem::swap(&mut scratch.outer, &mut scratch.inner);
        }

        let first = &map.layers[0];
        first.add_gradient(
            &mut gradients.layers[0],
            self.view(&self.features, first),
            &scratch.outer,
        );
        if !gradients.rows.is_empty() {
            first.pull_back(&scratch.outer, &mut scratch.inner);
            self.add_row_gradient(&map.waves, &mut gradients.rows, &scratch.inner);
        }
    }

    fn view<'a>(&self, input: &'a [f32], layer: &Layer) -> MatRef<'a, f32> {
        columns(input, self.points.len(), layer.n_inputs())
    }

    /// d/d(row) of wave(gain · row · x) is slope · gain · x.
    fn add_row_gradient(&self, waves: &Waves, rows: &mut [[f32; 3]], by_feature: &[f32]) {
        let n_revealed = by_feature.len() / self.points.len();
        let n_features = waves.n_features();
        let per_row = waves.kind.n_features();
        let by_point = by_feature
            .chunks(n_revealed)
            .zip(self.slopes.chunks(n_features));
        for (point, (by_feature, slopes)) in self.points.iter().zip(by_point) {
            for k in 3..n_revealed {
                let by_phase = by_feature[k] * slopes[k] * waves.gain;
                for (sum, x) in rows[(k - 3) / per_row].iter_mut().zip(point) {
                    *sum += by_phase * x;
                }
            }
        }
    }
}

impl Gradients {
    fn zeros(map: &NetworkMap, is_trainable: bool) -> Self {
        let n_rows = if is_trainable {
            map.waves.rows.len()
        } else {
            0
        };
        Self {
            layers: map.layers.clone(),
            rows: vec![[0.0; 3]; n_rows],
        }
    }

    /// Zero, for as many inputs as `map` reveals.
    fn reset(&mut self, map: &NetworkMap) {
        for (gradient, layer) in self.layers.iter_mut().zip(&map.layers) {
            gradient.weight.clear();
            gradient.weight.resize(layer.weight.len(), 0.0);
            gradient.bias.fill(0.0);
        }
        self.rows.fill([0.0; 3]);
    }

    fn add(&mut self, other: &Self) {
        let add =
            |sum: &mut [f32], part: &[f32]| sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        for (sum, part) in self.layers.iter_mut().zip(&other.layers) {
            add(&mut sum.weight, &part.weight);
            add(&mut sum.bias, &part.bias);
        }
        add(self.rows.as_flattened_mut(), other.rows.as_flattened());
    }
}
