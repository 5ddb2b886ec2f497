//! The paper's parametrisation f(M | θ): a fully connected network whose parameters say where every vertex goes.

use std::sync::{Arc, Mutex};

use dfdx::prelude::{Cpu, CpuError, Gradients};
use mesh_core::{Aabb, Positions, UnitFrame, Vector3, VertexData};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::config::{Encoding, NetworkConfig, NetworkInput};
use super::encoding::Waves;
use super::map::{to_input, NetworkMap};
use super::mask::Mask;
use super::pass::Pass;
use super::tape::{lock, Adam, Evaluation, Parameters};
use super::Shapes;
use crate::input::check_length;
use crate::setting::Setting;
use crate::{DrapeError, Parametrization, StateReader, StateWriter};

/// Positions as a network of the initial positions: `x = x₀ + r · mlp(encoding(x₀ / r))`, r half the longest side; or of
/// those of the source, y: `x = x₀ + r · mlp(encoding(y / r_y))` ([`NetworkInput::Rest`]); or as the sum of several such
/// offsets ([`super::Networks`]).
///
/// Last layers start at zero, so the network starts exactly at the initial positions, and equal positions that are seen
/// move alike. dfdx owns the parameters, the tape and Adam (betas 0.9 and 0.999, ε 1e-8); the layers are one fused
/// operation on its tape. Inside all is f32; the same seed gives the same bits whatever the thread count.
///
/// Source: Mesh Draping, "Progressive Positional Encoding". Departures: see [`NetworkConfig::paper`].
#[derive(Debug)]
pub struct Network {
    encoding: Encoding,
    initial: Positions,
    positions: Positions,
    parameters: Parameters,
    adam: Adam,
    evaluation: Arc<Mutex<Evaluation>>,
    progress: f64,
    /// Whether the positions are more than a map of the initial ones by the network.
    is_displaced: bool,
}

impl Network {
    /// A network that leaves `shapes.initial` where it is, with every other weight drawn from `seed`.
    ///
    /// # Errors
    /// A setting is out of its range, or the shapes differ in length.
    ///
    /// # Panics
    /// If there is no position.
    pub fn new(shapes: Shapes<'_>, config: &NetworkConfig, seed: u64) -> Result<Self, DrapeError> {
        let Shapes { rest, initial } = shapes;
        assert!(!initial.is_empty(), "a network needs a vertex to move");
        check_length("the rest shape", rest.len(), initial.len())?;
        Setting::check(config.settings())?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let waves = Waves::draw(&config.encoding, &mut rng);
        let is_trainable = config.encoding.is_trainable();
        let masks = Mask::all_at(&config.encoding, &waves, 0.0);
        let sizes = masks.iter().map(|mask| {
            let hidden = vec![config.width; config.n_hidden_layers];
            [vec![mask.n_features()], hidden, vec![3]].concat()
        });
        let trained = is_trainable.then_some(&waves);
        let parameters = Parameters::draw(&sizes.collect::<Vec<_>>(), trained, &mut rng);

        let mut map = NetworkMap {
            frame: UnitFrame::of(Aabb::of(initial)),
            output_scale: config.output_scale,
            waves,
            networks: Vec::new(),
        };
        parameters.copy_into(&mut map, &masks);
        let inputs = inputs(shapes, config.input);
        let mut pass = Pass::new(&inputs, &map, is_trainable);
        pass.forward(&map);
        Ok(Self {
            encoding: config.encoding,
            initial: initial.clone(),
            positions: initial.clone(),
            parameters,
            adam: Adam::new(masks.len()),
            evaluation: Arc::new(Mutex::new(Evaluation { map, pass, masks })),
            progress: 0.0,
            is_displaced: config.input != NetworkInput::Initial,
        })
    }

    /// dL/dθ for `gradient` = dL/dx.
    fn gradients(&self, gradient: &VertexData<Vector3>) -> Result<Gradients<f32, Cpu>, CpuError> {
        let unit = lock(&self.evaluation).map.output_unit();
        let by_output = gradient
            .iter()
            .flat_map(|g| [g.x, g.y, g.z].map(|d| (d * unit) as f32))
            .collect();
        self.parameters.gradients(&self.evaluation, by_output)
    }

    /// Evaluates the network at its present parameters and progress.
    fn evaluate(&mut self) {
        let Evaluation { map, pass, masks } = &mut *lock(&self.evaluation);
        *masks = Mask::all_at(&self.encoding, &map.waves, self.progress);
        self.parameters.copy_into(map, masks);
        pass.forward(map);
        let moved = self
            .positions
            .iter_mut()
            .zip(&self.initial)
            .zip(pass.outputs());
        for ((x, x0), output) in moved {
            *x = x0 + map.offset(output);
        }
    }
}

/// The positions that the network sees, ±1 over the longest side of their shape.
fn inputs(shapes: Shapes<'_>, input: NetworkInput) -> Vec<[f32; 3]> {
    let seen = match input {
        NetworkInput::Initial => shapes.initial,
        NetworkInput::Rest => shapes.rest,
    };
    let frame = UnitFrame::of(Aabb::of(seen));
    seen.iter().map(|p| to_input(&frame, p)).collect()
}

impl Parametrization for Network {
    fn positions(&self) -> &Positions {
        &self.positions
    }

    fn descend(
        &mut self,
        gradient: &VertexData<Vector3>,
        learning_rate: f64,
    ) -> Result<(), DrapeError> {
        let stepped = self.gradients(gradient).and_then(|mut gradients| {
            let masks = &lock(&self.evaluation).masks;
            self.adam
                .step(&mut self.parameters, masks, &mut gradients, learning_rate)
        });
        stepped.map_err(|_| DrapeError::OutOfMemory)?;
        self.evaluate();
        Ok(())
    }

    fn set_progress(&mut self, progress: f64) -> Result<(), DrapeError> {
        // A run that goes on hides nothing that was revealed.
        self.progress = self.progress.max(progress);
        Ok(())
    }

    fn displace(&mut self, displacements: &VertexData<Vector3>) {
        let moved = self.initial.iter_mut().zip(self.positions.iter_mut());
        for ((x0, x), d) in moved.zip(displacements) {
            *x0 += d;
            *x += d;
        }
        self.is_displaced = true;
    }

    fn save(&mut self, state: &mut StateWriter) {
        state.count(usize::from(self.is_displaced));
        state.real(self.progress);
        state.points(self.initial.iter().chain(&self.positions));
        self.parameters.save(state);
        self.adam.save(&mut self.parameters, state);
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
        self.is_displaced = state.count()? != 0;
        self.progress = state.real()?;
        let points = self.initial.iter_mut().chain(self.positions.iter_mut());
        state.points(points)?;
        self.parameters.restore(state)?;
        self.adam.restore(&mut self.parameters, state)?;
        self.evaluate();
        Ok(())
    }

    /// The map from initial positions to the present ones, without what is hidden; none once they were displaced.
    fn network(&self) -> Option<NetworkMap> {
        (!self.is_displaced).then(|| lock(&self.evaluation).map.clone())
    }
}

#[cfg(test)]
mod tests;
