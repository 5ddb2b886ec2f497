//! Deformation as similar as possible: rotations and scales spread smoothly from the landmarks.

use mesh_core::{Point3, Positions, Triangulation, UnitFrame, Vector3, VertexId};
use mesh_operators::{
    cotan_laplacian, multiply, pointwise_laplacian, voronoi_mass, CsrMatrix, FixedSolve,
    FixedSolveScratch, SolveError,
};

use crate::frames::{diagonal, SmoothFrames};
use crate::reach::held_and_unreached;

/// A neighbourhood is at least this many mean sides wide, so that its frame is determined.
const MIN_RADIUS_IN_SIDES: f64 = 1.0;

/// How far rotations spread and how closely landmarks are met. Lengths are shares of the longest side of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimilarConfig {
    /// Width of the neighbourhoods that turn and scale as one, > 0.
    pub frame_radius: f64,
    /// Length below which the surface resists bending more than stretching, ≥ 0.
    pub bending_length: f64,
    /// Pull of a landmark, > 0; 1 is about as strong as the surface's own.
    pub landmark_weight: f64,
    /// Steps at most, ≥ 1.
    pub max_steps: usize,
    /// The solve ends when no vertex moves farther than this share of the longest side in a step, ≥ 0.
    pub min_motion: f64,
}

impl SimilarConfig {
    /// Chosen on the pairs of bodies, faces and animals together, for least distortion without folds.
    pub fn standard() -> Self {
        Self {
            frame_radius: 0.1,
            bending_length: 0.03,
            landmark_weight: 30.0,
            max_steps: 40,
            min_motion: 5e-4,
        }
    }
}

/// A vertex that a landmark pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PulledVertex {
    /// The vertex.
    pub vertex: VertexId,
    /// The landmark's weight, in [`SimilarConfig::landmark_weight`]s, > 0.
    pub weight: f64,
}

impl PulledVertex {
    /// A vertex that a landmark of weight 1 pulls.
    pub fn new(vertex: VertexId) -> Self {
        Self {
            vertex,
            weight: 1.0,
        }
    }
}

/// Deformation in which every neighbourhood turns and scales as one, drawn towards landmarks.
///
/// Alternates between the frames `F_i = s_i R_i` that carry the surroundings of each vertex, and
/// `(L + b² L M⁻¹ L + W) x = (I + b² L M⁻¹) δ(F) + W u`, where `δ(F)` is the Laplacian of the rest shape transformed by the
/// frames, `b` the bending length and `W` the landmark weights. With `F = I` and large `b` that is the biharmonic
/// displacement; unlike it, a limb that turns keeps its shape.
///
/// The frames come from the covariances of the cells, smoothed over the frame radius `r` by `(M + r² L)⁻¹`, so that
/// small features ride along instead of folding. Pieces without a landmark stay where the guess has them.
/// After Au et al. 2006 (rotated Laplacian coordinates) and Levi and Gotsman 2015 (smooth rotations).
#[derive(Clone, Debug)]
pub struct SimilarSolver {
    config: SimilarConfig,
    size: f64,
    frames: SmoothFrames,
    bending: CsrMatrix<f64>,
    pulled: Vec<PulledVertex>,
    solve: FixedSolve,
}

impl SimilarSolver {
    /// Factors the systems for a rest shape and the vertices that landmarks will pull.
    ///
    /// # Errors
    /// The rest shape is so degenerate that its surface does not determine a deformation.
    pub fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        pulled: &[PulledVertex],
        config: SimilarConfig,
    ) -> Result<Self, SolveError> {
        let n = rest.len();
        let size = UnitFrame::principal(rest.as_slice()).scale;
        let laplacian = cotan_laplacian(triangulation, rest);
        let mass = voronoi_mass(triangulation, rest);
        let radius =
            (config.frame_radius * size).max(MIN_RADIUS_IN_SIDES * mean_side(triangulation, rest));
        let frames = SmoothFrames::new(triangulation, rest, &laplacian, &mass, radius)?;

        let bending = pointwise_laplacian(&laplacian, &mass).transpose()
            * (config.bending_length * size).powi(2);
        let mut pull = vec![0.0; n];
        for handle in pulled {
            pull[handle.vertex.index()] = handle.weight * config.landmark_weight;
        }
        let landmarks: Vec<VertexId> = pulled.iter().map(|handle| handle.vertex).collect();
        let system = &laplacian + &(&bending * &laplacian) + diagonal(pull.into_iter());
        let is_landmark = |v: &VertexId| landmarks.contains(v);
        let stay = held_and_unreached(triangulation, &landmarks);
        let stay: Vec<VertexId> = stay.into_iter().filter(|v| !is_landmark(v)).collect();
        Ok(Self {
            solve: FixedSolve::new(&system, &stay)?,
            pulled: pulled.to_vec(),
            config,
            size,
            frames,
            bending,
        })
    }

    /// The deformed positions, with `targets[k]` the place of the k-th landmark, starting at `guess`.
    ///
    /// # Panics
    /// If there is not one target for each landmark, or not one position for each vertex.
    pub fn solve(&self, targets: &[Point3], guess: &Positions) -> Positions {
        assert_eq!(
            targets.len(),
            self.pulled.len(),
            "one target for each landmark"
        );
        let mut x = guess.clone();
        let mut scratch = FixedSolveScratch::default();
        for _ in 0..self.config.max_steps {
            let delta = self.frames.turned_laplacian(&x);
            let mut right = multiply(&self.bending, &delta);
            for (r, d) in right.iter_mut().zip(&delta) {
                *r += d;
            }
            for (handle, target) in self.pulled.iter().zip(targets) {
                let weight = handle.weight * self.config.landmark_weight;
                right[handle.vertex.index()] += target.coords * weight;
            }

            let mut next: Vec<Vector3> = x.iter().map(|p| p.coords).collect();
            self.solve
                .solve_with_in_place(&mut next, &right, &mut scratch);
            let moved = x
                .iter()
                .zip(&next)
                .map(|(p, q)| (p.coords - q).norm())
                .fold(0.0, f64::max);
            x = next.into_iter().map(Point3::from).collect();
            if moved <= self.config.min_motion * self.size {
                break;
            }
        }
        x
    }
}

fn mean_side(triangulation: &Triangulation, x: &Positions) -> f64 {
    let sides = triangulation
        .corners(x)
        .map(|[a, b, c]| (b - a).norm() + (c - b).norm() + (a - c).norm());
    sides.sum::<f64>() / (3 * triangulation.len()).max(1) as f64
}
