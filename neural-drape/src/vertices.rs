//! The vertices themselves as parameters, preconditioned so that a step moves them smoothly.

use mesh_core::measure::mean_edge_length;
use mesh_core::{Positions, Triangulation, Vector3, VertexData};
use mesh_operators::{CsrMatrix, SpdSolver};
use serde::{Deserialize, Serialize};

use crate::{DrapeError, Parametrization, StateReader, StateWriter};

/// Settings of [`Vertices`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VerticesConfig {
    /// How far a step spreads over the surface at the start of the run, as a share of the target's longest side. 0..
    pub smoothing_start: f64,
    /// The same at the end: coarse to fine.
    pub smoothing_end: f64,
    /// In how many steps it goes from the one to the other, ≥ 1; each costs a factorisation.
    pub n_levels: usize,
    /// Decay rates of Adam's two running means.
    pub betas: [f64; 2],
    /// How far the step of a vertex follows its own gradients at the end: 0 one scale for all, 1 each its own. 0..=1
    pub adaptivity: f64,
    /// Share of the run from which it does, 0..=1; before, one scale holds for all.
    pub adapt_from: f64,
}

impl VerticesConfig {
    /// From a tenth of the shape to a seventieth; small faces, whose gradients are small, catch up in the last third.
    pub const fn standard() -> Self {
        Self {
            smoothing_start: 0.1,
            smoothing_end: 0.014,
            n_levels: 6,
            betas: [0.9, 0.99],
            adaptivity: 0.25,
            adapt_from: 0.66,
        }
    }
}

/// Positions `x = (I + λL)⁻¹ u` with UniformAdam on `u`; L is the uniform Laplacian, `λ = (ℓ/h)²` for a smoothing length ℓ
/// and the mean edge length h.
///
/// Source: Nicolet et al. 2021, "Large Steps in Inverse Rendering of Geometry".
pub struct Vertices {
    config: VerticesConfig,
    positions: Positions,
    laplacian: CsrMatrix<f64>,
    mean_edge: f64,
    solver: SpdSolver,
    level: usize,
    adam: UniformAdam,
    scratch: Vec<Vector3>,
    step: Vec<Vector3>,
}

impl Vertices {
    /// Parameters whose positions are `initial`.
    ///
    /// # Errors
    /// The preconditioner cannot be factored.
    pub fn new(
        triangulation: &Triangulation,
        initial: &Positions,
        config: &VerticesConfig,
    ) -> Result<Self, DrapeError> {
        let n = initial.len();
        let mean_edge = mean_edge_length(triangulation, initial).max(f64::MIN_POSITIVE);
        let laplacian = mesh_operators::uniform_laplacian(n, triangulation.edges().iter().copied());
        let solver = SpdSolver::new(&preconditioner(&laplacian, mean_edge, config, 0))?;
        Ok(Self {
            config: *config,
            positions: initial.clone(),
            laplacian,
            mean_edge,
            solver,
            level: 0,
            adam: UniformAdam::new(n, config),
            scratch: Vec::new(),
            step: vec![Vector3::zeros(); n],
        })
    }
}

/// `I + (ℓ/h)² L` with ℓ falling geometrically from level to level.
fn preconditioner(
    laplacian: &CsrMatrix<f64>,
    mean_edge: f64,
    config: &VerticesConfig,
    level: usize,
) -> CsrMatrix<f64> {
    let t = level as f64 / (config.n_levels - 1).max(1) as f64;
    let length = config.smoothing_start.powf(1.0 - t) * config.smoothing_end.powf(t);
    CsrMatrix::identity(laplacian.nrows()) + laplacian * (length / mean_edge).powi(2)
}

impl Parametrization for Vertices {
    fn positions(&self) -> &Positions {
        &self.positions
    }

    fn descend(
        &mut self,
        gradient: &VertexData<Vector3>,
        learning_rate: f64,
    ) -> Result<(), DrapeError> {
        // dL/du = (I + λL)⁻¹ dL/dx
        self.step.copy_from_slice(gradient.as_slice());
        self.solver
            .solve_in_place(&mut self.step, &mut self.scratch);
        self.adam.turn_into_step(&mut self.step, learning_rate);
        // Δx = (I + λL)⁻¹ Δu
        self.solver
            .solve_in_place(&mut self.step, &mut self.scratch);
        for (p, step) in self.positions.iter_mut().zip(&self.step) {
            *p -= step;
        }
        Ok(())
    }

    fn set_progress(&mut self, progress: f64) -> Result<(), DrapeError> {
        if progress >= self.config.adapt_from {
            self.adam.adaptivity = self.config.adaptivity;
        }
        let n_levels = self.config.n_levels;
        let level = ((progress * n_levels as f64) as usize).min(n_levels - 1);
        if level != self.level {
            self.level = level;
            let matrix = preconditioner(&self.laplacian, self.mean_edge, &self.config, level);
            self.solver.refactor(&matrix)?;
        }
        Ok(())
    }

    fn displace(&mut self, displacements: &VertexData<Vector3>) {
        for (p, d) in self.positions.iter_mut().zip(displacements) {
            *p += d;
        }
    }

    fn save(&mut self, state: &mut StateWriter) {
        state.points(&self.positions);
        state.count(self.level);
        let adam = &self.adam;
        state.count(adam.n_steps as usize);
        state.real(adam.adaptivity);
        state.vectors(&adam.mean);
        adam.mean_square.iter().for_each(|&v| state.real(v));
    }

    fn restore(&mut self, state: &mut StateReader<'_>) -> Result<(), DrapeError> {
        state.points(self.positions.iter_mut())?;
        self.level = state.count()?.min(self.config.n_levels - 1);
        let matrix = preconditioner(&self.laplacian, self.mean_edge, &self.config, self.level);
        self.solver.refactor(&matrix)?;
        let adam = &mut self.adam;
        adam.n_steps = state.count()?.try_into().unwrap_or(i32::MAX);
        adam.adaptivity = state.real()?;
        state.vectors(&mut adam.mean)?;
        for v in &mut adam.mean_square {
            *v = state.real()?;
        }
        Ok(())
    }
}

/// Adam with one scale for all coordinates: the step keeps the direction that the preconditioner gave it, and noise
/// is not blown up where the fit is good.
///
/// `Δu = η m / √(v_max^(1−p) vᵢ^p)`, with the running means m of a vertex's gradient and v of its squared length and the adaptivity p
///
/// Source: "UniformAdam" of Nicolet et al. 2021, after Kingma and Ba 2015. Departures: the largest running mean square
/// is taken, not the running mean of the largest square; lengths instead of coordinates, so that axes do not matter; the
/// adaptivity (0 there).
struct UniformAdam {
    mean: Vec<Vector3>,
    mean_square: Vec<f64>,
    betas: [f64; 2],
    n_steps: i32,
    adaptivity: f64,
}

/// A vertex's mean square counts as at least this share of the largest.
const SMALLEST_SQUARE: f64 = 1e-8;
/// Added to the scale, so that a gradient of 0 gives a step of 0.
const EPSILON: f64 = 1e-12;

impl UniformAdam {
    fn new(n: usize, config: &VerticesConfig) -> Self {
        Self {
            mean: vec![Vector3::zeros(); n],
            mean_square: vec![0.0; n],
            betas: config.betas,
            n_steps: 0,
            adaptivity: 0.0,
        }
    }

    /// Replaces a gradient by the step against it, before the minus sign.
    fn turn_into_step(&mut self, gradient: &mut [Vector3], learning_rate: f64) {
        self.n_steps = self.n_steps.saturating_add(1);
        let [b1, b2] = self.betas;
        let (c1, c2) = (1.0 - b1.powi(self.n_steps), 1.0 - b2.powi(self.n_steps));
        let mut largest = 0.0f64;
        for ((g, m), v) in gradient
            .iter()
            .zip(&mut self.mean)
            .zip(&mut self.mean_square)
        {
            *m = *m * b1 + *g * (1.0 - b1);
            *v = *v * b2 + g.norm_squared() * (1.0 - b2);
            largest = largest.max(*v);
        }
        let scale = learning_rate / (c1 * ((largest / c2).sqrt() + EPSILON));
        let floor = largest * SMALLEST_SQUARE;
        for ((g, m), v) in gradient.iter_mut().zip(&self.mean).zip(&self.mean_square) {
            let own = if self.adaptivity > 0.0 && largest > 0.0 {
                (largest / v.max(floor)).powf(0.5 * self.adaptivity)
            } else {
                1.0
            };
            *g = m * (scale * own);
        }
    }
}
