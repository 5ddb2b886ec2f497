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
    layers: Vec<Linear>,
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
    /// The map, with the mask in the weights of its first layer.
    pub(super) map: NetworkMap,
    /// Its activations at every point.
    pub(super) pass: Pass,
    /// What the first layer sees of the features.
    pub(super) mask: Mask,
}

impl Parameters {
    /// Layers between the given `sizes` and, where they train, the rows of `waves`.
    ///
    /// Weights and biases are uniform in ±1/√inputs, as in the authors' framework; the last layer is zero, so the
    /// network starts at the identity.
    pub(super) fn draw(sizes: &[usize], waves: Option<&Waves>, rng: &mut ChaCha8Rng) -> Self {
        let device = Cpu::default();
        device.enable_cache();
        let matrix = |entries: Vec<f32>, n_columns: usize| {
            let shape = (entries.len() / n_columns, n_columns);
            device.tensor_from_vec(entries, shape)
        };
        let last = sizes.len() - 2;
        let layers = sizes
            .windows(2)
            .enumerate()
            .map(|(l, size)| {
                let bound = if l < last {
                    (size[0] as f32).sqrt().recip()
                } else {
                    0.0
                };
                let mut draw = |n: usize| -> Vec<f32> {
                    (0..n)
                        .map(|_| bound * rng.random_range(-1.0..1.0))
                        .collect()
                };
                Linear {
                    weight: matrix(draw(size[0] * size[1]), size[1]),
                    bias: matrix(draw(size[1]), size[1]),
                }
            })
            .collect();
        let rows = waves.map(|waves| matrix(waves.rows.as_flattened().to_vec(), 3));
        Self {
            device,
            layers,
            rows,
        }
    }

    /// Copies the parameters into `map`, the features masked by `mask`; those that are not revealed are left out.
    pub(super) fn copy_into(&self, map: &mut NetworkMap, mask: &Mask) {
        map.layers.resize_with(self.layers.len(), Layer::default);
        for (layer, linear) in map.layers.iter_mut().zip(&self.layers) {
            copy(&linear.weight, &mut layer.weight);
            copy(&linear.bias, &mut layer.bias);
        }
        let first = &mut map.layers[0];
        let n_outputs = first.bias.len();
        first.weight.truncate(mask.n_revealed() * n_outputs);
        mask.weigh(&mut first.weight, n_outputs);
        if let Some(rows) = &self.rows {
            rows.copy_into(map.waves.rows.as_flattened_mut());
        }
    }

    /// Every parameter to be changed: weight and bias of each layer, then the rows.
    fn tensors_mut(&mut self) -> impl Iterator<Item = &mut Matrix> {
        let layers = self
            .layers
            .iter_mut()
            .flat_map(|l| [&mut l.weight, &mut l.bias]);
        layers.chain(&mut self.rows)
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
            let Evaluation { map, pass, mask } = &mut *lock(&evaluation);
            let computed = pass.backward(map, &by_output);
            for (linear, layer) in parameters.layers.iter().zip(&computed.layers) {
                paste(&layer.weight, gradients.get_or_alloc_mut(&linear.weight)?);
                paste(&layer.bias, gradients.get_or_alloc_mut(&linear.bias)?);
            }
            let first = gradients.get_or_alloc_mut(&parameters.layers[0].weight)?;
            mask.weigh(first, map.layers[0].bias.len());
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

/// dfdx's Adam with a learning rate for each step: betas (0.9, 0.999), ε = 1e-8.
#[derive(Clone, Debug)]
pub(super) struct Adam {
    n_steps: i32,
    moment1: Gradients<f32, Cpu>,
    moment2: Gradients<f32, Cpu>,
}

impl Adam {
    /// An optimiser that has seen nothing.
    pub(super) fn new() -> Self {
        Self {
            n_steps: 0,
            moment1: Gradients::leaky(),
            moment2: Gradients::leaky(),
        }
    }

    /// One step of every parameter against `gradients`.
    pub(super) fn step(
        &mut self,
        parameters: &mut Parameters,
        gradients: &mut Gradients<f32, Cpu>,
        learning_rate: f64,
    ) -> Result<(), CpuError> {
        self.n_steps = self.n_steps.saturating_add(1);
        let config = AdamConfig {
            lr: learning_rate,
            ..AdamConfig::default()
        };
        for parameter in parameters.tensors_mut() {
            let gradient = &*gradients.get_or_alloc_mut(parameter)?;
            let moment1 = self.moment1.get_or_alloc_mut(parameter)?;
            let moment2 = self.moment2.get_or_alloc_mut(parameter)?;
            config.try_update(self.n_steps, parameter, moment1, moment2, gradient)?;
        }
        Ok(())
    }
}

impl Adam {
    /// Writes how far it is and its moments; where there is no memory for moments, none.
    pub(super) fn save(&mut self, parameters: &mut Parameters, state: &mut StateWriter) {
        state.count(self.n_steps as usize);
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
        self.n_steps = state.count()?.try_into().unwrap_or(i32::MAX);
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

fn copy(tensor: &Matrix, entries: &mut Vec<f32>) {
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
    /// Every parameter: weight and bias of each layer, then the rows.
    pub(super) fn tensors(&self) -> Vec<&Matrix> {
        let layers = self.layers.iter().flat_map(|l| [&l.weight, &l.bias]);
        layers.chain(&self.rows).collect()
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
