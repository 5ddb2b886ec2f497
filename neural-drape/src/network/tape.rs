//! The parameters θ as dfdx tensors, and nothing else of dfdx: drawn from the seed, recorded on its tape, moved by its Adam.

use std::sync::{Arc, Mutex, PoisonError};

use dfdx::prelude::{
    AdamConfig, Backward, Cache, Cpu, CpuError, Gradients, NoneTape, OwnedTape, PutTape, SumTo,
    Tape, Tensor, TensorFromVec, TryMul,
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use super::encoding::Waves;
use super::layer::Layer;
use super::map::NetworkMap;
use super::mask::Mask;
use super::pass::Pass;
use crate::{DrapeError, StateReader, StateWriter};

type Matrix<T = NoneTape> = Tensor<(usize, usize), f32, Cpu, T>;

/// All parameters.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    device: Cpu,
    /// The layers of each network.
    networks: Vec<Vec<Linear>>,
    /// The rows of the waves, where they train.
    rows: Option<Matrix>,
}

/// The parameters of one layer.
#[derive(Clone, Debug)]
struct Linear {
    /// Inputs × outputs.
    weight: Matrix,
    /// 1 × outputs.
    bias: Matrix,
}

/// The network at its present parameters: the fused copy of its weights and every activation.
#[derive(Debug)]
pub(super) struct Evaluation {
    /// The map of the networks that are not hidden, with the masks in the weights of first and last layers.
    pub(super) map: NetworkMap,
    /// Its activations at every point.
    pub(super) pass: Pass,
    /// What each network sees of the features, and how much it counts.
    pub(super) masks: Vec<Mask>,
}

impl Parameters {
    /// For each entry of `sizes` the layers of a network between these sizes and, where they train, the rows of `waves`.
    ///
    /// Weights and biases are uniform in ±1/√inputs, as in the authors' framework; last layers are zero, so that the map
    /// starts at the identity.
    pub(super) fn draw(sizes: &[Vec<usize>], waves: Option<&Waves>, rng: &mut ChaCha8Rng) -> Self {
        let device = Cpu::default();
        device.enable_cache();
        let networks = sizes.iter().map(|sizes| draw_layers(&device, sizes, rng));
        let networks = networks.collect();
        let rows = waves.map(|waves| matrix(&device, waves.rows.as_flattened().to_vec(), 3));
        Self {
            device,
            networks,
            rows,
        }
    }

    /// Copies the parameters of the networks that `masks` do not hide into `map`, masked; features that are not revealed are
    /// left out.
    pub(super) fn copy_into(&self, map: &mut NetworkMap, masks: &[Mask]) {
        map.networks.resize_with(n_shown(masks), Vec::new);
        let masked = map.networks.iter_mut().zip(masks);
        for ((layers, mask), linears) in masked.zip(&self.networks) {
            layers.resize_with(linears.len(), Layer::default);
            for (layer, linear) in layers.iter_mut().zip(linears) {
                copy(&linear.weight, &mut layer.weight);
                copy(&linear.bias, &mut layer.bias);
            }
            let first = &mut layers[0];
            let n_outputs = first.bias.len();
            first.weight.truncate(mask.n_revealed() * n_outputs);
            mask.weigh(&mut first.weight, n_outputs);
            if let Some(last) = layers.last_mut() {
                last.scale(mask.output());
            }
        }
        if let Some(rows) = &self.rows {
            rows.copy_into(map.waves.rows.as_flattened_mut());
        }
    }

    /// Every parameter to be changed: weight and bias of each layer of each network, then the rows.
    fn tensors_mut(&mut self) -> impl Iterator<Item = &mut Matrix> {
        let layers = self.networks.iter_mut().flatten();
        layers
            .flat_map(|l| [&mut l.weight, &mut l.bias])
            .chain(&mut self.rows)
    }

    /// Writes every parameter.
    pub(super) fn save(&mut self, state: &mut StateWriter) {
        let mut entries = Vec::new();
        for parameter in self.tensors_mut() {
            copy(parameter, &mut entries);
            state.singles(&entries);
        }
    }

    /// Reads every parameter.
    pub(super) fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
        let mut entries = Vec::new();
        for parameter in self.tensors_mut() {
            copy(parameter, &mut entries);
            state.singles(&mut entries)?;
            parameter.copy_from(&entries);
        }
        Ok(())
    }

    /// dL/dθ for `gradient` = dL/d(output), three entries per point: the gradient of `Σ output · gradient`.
    pub(super) fn gradients(
        &self,
        evaluation: &Arc<Mutex<Evaluation>>,
        gradient: Vec<f32>,
    ) -> Result<Gradients<f32, Cpu>, CpuError> {
        let shape = (gradient.len() / 3, 3);
        let gradient = self.device.try_tensor_from_vec(gradient, shape)?;
        let product = self.record(evaluation)?.try_mul(gradient)?;
        product.try_sum::<(), _>()?.try_backward()
    }

    /// The output of the network as a tensor; how it came about is one operation on its tape.
    fn record(
        &self,
        evaluation: &Arc<Mutex<Evaluation>>,
    ) -> Result<Matrix<OwnedTape<f32, Cpu>>, CpuError> {
        let outputs: Vec<f32> = lock(evaluation).pass.outputs().flatten().collect();
        let shape = (outputs.len() / 3, 3);
        let output = self.device.try_tensor_from_vec(outputs, shape)?;

        let (parameters, evaluation, out) = (self.clone(), Arc::clone(evaluation), output.clone());
        let mut tape = OwnedTape::default();
        tape.add_backward_op(move |gradients| {
            let by_output = gradients.get_or_alloc_mut(&out)?.clone();
            let Evaluation { map, pass, masks } = &mut *lock(&evaluation);
            let computed = pass.backward(map, &by_output);
            let masked = computed.networks.iter().zip(masks);
            for ((layers, mask), linears) in masked.zip(&parameters.networks) {
                for (linear, layer) in linears.iter().zip(layers) {
                    paste(&layer.weight, gradients.get_or_alloc_mut(&linear.weight)?);
                    paste(&layer.bias, gradients.get_or_alloc_mut(&linear.bias)?);
                }
                let first = gradients.get_or_alloc_mut(&linears[0].weight)?;
                mask.weigh(first, layers[0].bias.len());
                let last = &linears[linears.len() - 1];
                for tensor in [&last.weight, &last.bias] {
                    let entries = gradients.get_or_alloc_mut(tensor)?;
                    entries.iter_mut().for_each(|d| *d *= mask.output());
                }
            }
            if let Some(rows) = &parameters.rows {
                paste(
                    computed.rows.as_flattened(),
                    gradients.get_or_alloc_mut(rows)?,
                );
            }
            Ok(())
        });
        Ok(output.put_tape(tape))
    }
}

/// How many networks are not hidden: those before the first that is.
fn n_shown(masks: &[Mask]) -> usize {
    masks.iter().take_while(|mask| mask.output() > 0.0).count()
}

fn matrix(device: &Cpu, entries: Vec<f32>, n_columns: usize) -> Matrix {
    let shape = (entries.len() / n_columns, n_columns);
    device.tensor_from_vec(entries, shape)
}

/// Layers between the given `sizes`, the last of them zero.
fn draw_layers(device: &Cpu, sizes: &[usize], rng: &mut ChaCha8Rng) -> Vec<Linear> {
    let last = sizes.len() - 2;
    let mut draw = |n: usize, bound: f32| -> Vec<f32> {
        (0..n)
            .map(|_| bound * rng.random_range(-1.0..1.0))
            .collect()
    };
    sizes
        .windows(2)
        .enumerate()
        .map(|(l, size)| {
            let bound = if l < last {
                (size[0] as f32).sqrt().recip()
            } else {
                0.0
            };
            Linear {
                weight: matrix(device, draw(size[0] * size[1], bound), size[1]),
                bias: matrix(device, draw(size[1], bound), size[1]),
            }
        })
        .collect()
}

/// dfdx's Adam with a learning rate for each step: betas (0.9, 0.999), ε = 1e-8.
#[derive(Clone, Debug)]
pub(super) struct Adam {
    /// Steps of each network: the moments of one that was hidden are those of one that begins.
    n_steps: Vec<i32>,
    moment1: Gradients<f32, Cpu>,
    moment2: Gradients<f32, Cpu>,
}

impl Adam {
    /// An optimiser of as many networks, which has seen nothing.
    pub(super) fn new(n_networks: usize) -> Self {
        Self {
            n_steps: vec![0; n_networks],
            moment1: Gradients::leaky(),
            moment2: Gradients::leaky(),
        }
    }

    /// One step against `gradients` of every network that `masks` do not hide, and of the rows, which step with the first.
    pub(super) fn step(
        &mut self,
        parameters: &mut Parameters,
        masks: &[Mask],
        gradients: &mut Gradients<f32, Cpu>,
        learning_rate: f64,
    ) -> Result<(), CpuError> {
        let config = AdamConfig {
            lr: learning_rate,
            ..AdamConfig::default()
        };
        let n_shown = n_shown(masks);
        for n in &mut self.n_steps[..n_shown] {
            *n = n.saturating_add(1);
        }
        let clocks = self.n_steps[..n_shown].iter();
        let layers = clocks
            .zip(&mut parameters.networks)
            .flat_map(|(&n, layers)| {
                let tensors = layers.iter_mut().flat_map(|l| [&mut l.weight, &mut l.bias]);
                tensors.map(move |tensor| (n, tensor))
            });
        let rows = parameters
            .rows
            .iter_mut()
            .map(|rows| (self.n_steps[0], rows));
        for (n_steps, parameter) in layers.chain(rows) {
            let gradient = &*gradients.get_or_alloc_mut(parameter)?;
            let moment1 = self.moment1.get_or_alloc_mut(parameter)?;
            let moment2 = self.moment2.get_or_alloc_mut(parameter)?;
            config.try_update(n_steps, parameter, moment1, moment2, gradient)?;
        }
        Ok(())
    }

    /// Writes how far it is and its moments; where there is no memory for moments, none.
    pub(super) fn save(&mut self, parameters: &mut Parameters, state: &mut StateWriter) {
        for &n in &self.n_steps {
            state.count(n as usize);
        }
        for parameter in parameters.tensors_mut() {
            for moment in [&mut self.moment1, &mut self.moment2] {
                if let Ok(entries) = moment.get_or_alloc_mut(parameter) {
                    state.singles(entries.iter());
                }
            }
        }
    }

    /// Reads what [`Self::save`] wrote.
    pub(super) fn restore(
        &mut self,
        parameters: &mut Parameters,
        state: &mut StateReader<'_>,
    ) -> Result<(), DrapeError> {
        for n in &mut self.n_steps {
            *n = state.count()?.try_into().unwrap_or(i32::MAX);
        }
        for parameter in parameters.tensors_mut() {
            for moment in [&mut self.moment1, &mut self.moment2] {
                let entries = moment.get_or_alloc_mut(parameter);
                state.singles(entries.map_err(|_| DrapeError::OutOfMemory)?.iter_mut())?;
            }
        }
        Ok(())
    }
}

/// The evaluation, also where a panic in another thread left it half done: what is read next is computed anew.
pub(super) fn lock(evaluation: &Mutex<Evaluation>) -> std::sync::MutexGuard<'_, Evaluation> {
    evaluation.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(super) fn copy(tensor: &Matrix, entries: &mut Vec<f32>) {
    let (n_rows, n_columns) = *dfdx::prelude::HasShape::shape(tensor);
    entries.resize(n_rows * n_columns, 0.0);
    tensor.copy_into(entries);
}

/// Puts `part` at the front of `whole`; the rest of `whole` stays.
fn paste(part: &[f32], whole: &mut [f32]) {
    whole[..part.len()].copy_from_slice(part);
}

#[cfg(test)]
impl Parameters {
    /// Every parameter: weight and bias of each layer of each network, then the rows.
    pub(super) fn tensors(&self) -> Vec<&Matrix> {
        let layers = self.networks.iter().flatten();
        layers
            .flat_map(|l| [&l.weight, &l.bias])
            .chain(&self.rows)
            .collect()
    }

    /// √Σ g² over all parameters.
    pub(super) fn norm(&mut self, gradients: &mut Gradients<f32, Cpu>) -> Result<f64, CpuError> {
        let mut sum = 0.0;
        for parameter in self.tensors_mut() {
            let gradient = gradients.get_or_alloc_mut(parameter)?;
            sum += gradient.iter().map(|&g| f64::from(g).powi(2)).sum::<f64>();
        }
        Ok(sum.sqrt())
    }

    /// θ + `rate` · g
    pub(super) fn shift(
        &mut self,
        gradients: &mut Gradients<f32, Cpu>,
        rate: f32,
    ) -> Result<(), CpuError> {
        for parameter in self.tensors_mut() {
            let gradient = gradients.get_or_alloc_mut(parameter)?;
            let mut entries = Vec::new();
            copy(parameter, &mut entries);
            entries
                .iter_mut()
                .zip(&**gradient)
                .for_each(|(p, g)| *p += rate * g);
            parameter.copy_from(&entries);
        }
        Ok(())
    }
}
