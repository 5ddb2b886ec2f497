//! A start that is led by where on the body each place is, beside where it is in space.

mod counterpart;
mod elastic;
mod graph;
mod signature;
mod ways;

use mesh_core::{Landmark, Positions, TargetSurface, Triangulation, Vector3};

use crate::initialize::{check_landmarks, check_length};
use crate::InitError;
use counterpart::{PairCost, Shapes};
use elastic::{Elastic, Goal};
use graph::SampleGraph;
use signature::Misfits;
pub use ways::LandmarkWays;

/// Pull of a landmark; 1 is about as strong as the surface's own.
const LANDMARK_WEIGHT: f64 = 30.0;
/// Pull of a vertex without a counterpart to where it is, in units of its area over the squared longest side: it makes
/// the system definite and does nothing else.
const TETHER: f64 = 1e-9;
/// Samples of the target.
const N_SAMPLES: usize = 3000;
/// Steps to the landmarks alone, before the rest of the surface is drawn.
const N_FIRST_STEPS: usize = 30;

/// What a guided start is found from.
#[derive(Clone, Copy)]
pub struct GuideInput<'a> {
    /// The source's polygons as triangles.
    pub triangulation: &'a Triangulation,
    /// The source's shape, in the target's coordinates: turned, moved and scaled, not sheared. It is kept.
    pub rest: &'a Positions,
    /// Places that belong together, each with a weight above 0.
    pub landmarks: &'a [Landmark],
    /// The shape to bring it to.
    pub target: &'a dyn TargetSurface,
}

/// How a guided start is found. Pairs of numbers are values in the first and in the last round, between which they change
/// geometrically; lengths are shares of the longest side of the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideConfig {
    /// How often counterparts are looked for, ≥ 1.
    pub n_rounds: usize,
    /// Steps of the surface towards them in each round.
    pub n_steps: usize,
    /// What a squared distance in space counts for in a pair, > 0.
    pub space: [f64; 2],
    /// What the squared misfit of distances to the landmarks counts for, > 0.
    pub signature: [f64; 2],
    /// What opposing normals count for: half the squared distance that costs as much.
    pub normal: f64,
    /// Details of the surface below this length follow their counterparts, > 0; larger ones always do.
    pub detail: [f64; 2],
    /// Width of the neighbourhoods that turn and scale as one, > 0.
    pub frame_radius: f64,
    /// Length below which the surface resists bending more than stretching, ≥ 0.
    pub bending_length: f64,
}

impl GuideConfig {
    /// The surface keeps its shape; only the pose is that of the target.
    pub fn stiff() -> Self {
        Self {
            n_rounds: 10,
            n_steps: 4,
            space: [0.1, 1.0],
            signature: [1.0, 0.5],
            normal: 0.01,
            detail: [0.15, 0.04],
            frame_radius: 0.08,
            bending_length: 0.03,
        }
    }

    /// The surface comes near to the target, too.
    pub fn soft() -> Self {
        Self {
            n_rounds: 14,
            space: [0.02, 2.0],
            signature: [1.0, 0.1],
            normal: 0.09,
            detail: [0.15, 0.015],
            frame_radius: 0.05,
            bending_length: 0.02,
            ..Self::stiff()
        }
    }

    /// Between the two values of a setting, at `t` in 0..=1.
    fn between([first, last]: [f64; 2], t: f64) -> f64 {
        first * (last / first).powf(t)
    }

    fn cost(&self, t: f64) -> PairCost {
        PairCost {
            space: Self::between(self.space, t) as f32,
            signature: Self::between(self.signature, t) as f32,
            normal: self.normal as f32,
        }
    }
}

/// Brings the source into the pose of the target: every place to the one that lies as far along the surface from each
/// landmark, as long as the surface keeps its shape; later, more and more, to the one that is near in space.
///
/// Parts that turn far, and those without a landmark at their end, turn whole. The target may be a mesh, a soup or a cloud:
/// distances along it are those of a graph over its samples. Pairs count by how well the way there and back agrees. Without
/// a landmark only space and normals lead. The work grows with the number of vertices times that of samples: it is meant
/// for a stand-in of a thousand ([`mesh_core::Proxy`]). What does not depend on the settings is found once.
pub struct Guide<'a> {
    input: GuideInput<'a>,
    /// The longest side of the target.
    size: f64,
    graph: SampleGraph,
    misfits: Misfits,
}

impl<'a> Guide<'a> {
    /// Measures the ways from every landmark along both shapes.
    ///
    /// # Errors
    /// As [`crate::initialize`].
    pub fn new(input: GuideInput<'a>) -> Result<Self, InitError> {
        check_length(input.triangulation.n_vertices(), input.rest)?;
        check_landmarks(input.triangulation.n_vertices(), input.landmarks)?;
        let size = input.target.bounds().longest_side();
        let graph = SampleGraph::new(input.target, N_SAMPLES);
        Ok(Self {
            misfits: Misfits::new(&input, &graph, size),
            input,
            size,
            graph,
        })
    }

    /// One position per vertex, in the target's coordinates; where the rest shape is if the target has no extent.
    ///
    /// # Errors
    /// The rest shape is so degenerate that its surface does not determine a deformation.
    pub fn start(&self, config: &GuideConfig) -> Result<Positions, InitError> {
        let (input, size) = (&self.input, self.size);
        let mut x = input.rest.clone();
        if size <= 0.0 {
            return Ok(x);
        }
        let mut elastic = Elastic::new(input.triangulation, input.rest, size, config)?;
        if !input.landmarks.is_empty() {
            let nothing = vec![None; x.len()];
            let goals = goals(input, &elastic, &x, &nothing, size);
            elastic.draw(&mut x, &goals, N_FIRST_STEPS)?;
        }
        for round in 0..config.n_rounds {
            let t = round as f64 / (config.n_rounds - 1).max(1) as f64;
            let shapes = Shapes {
                triangulation: input.triangulation,
                rest: input.rest,
                x: &x,
                graph: &self.graph,
                misfits: &self.misfits,
                size,
            };
            let counterparts = shapes.counterparts(config.cost(t));
            let detail = GuideConfig::between(config.detail, t) * size;
            let goals = goals(input, &elastic, &x, &counterparts, detail);
            elastic.draw(&mut x, &goals, config.n_steps)?;
        }
        Ok(x)
    }
}

/// Landmarks and counterparts as goals; what has neither is held by next to nothing.
fn goals(
    input: &GuideInput<'_>,
    elastic: &Elastic,
    x: &Positions,
    counterparts: &[Option<(mesh_core::Point3, f64)>],
    detail: f64,
) -> Vec<Goal> {
    let goal = |((p, counterpart), m): ((&mesh_core::Point3, &Option<_>), &f64)| {
        let (point, confidence) = counterpart.unwrap_or((*p, 0.0));
        Goal {
            point,
            weight: (confidence + TETHER) * m / detail.powi(2),
        }
    };
    let places = x.iter().zip(counterparts).zip(elastic.mass());
    let mut goals: Vec<Goal> = places.map(goal).collect();
    // Those of curves first: where both are at one vertex, the landmark leads.
    let is_cut = |l: &&Landmark| l.curve.is_some();
    let (cut, marked) = (
        input.landmarks.iter().filter(is_cut),
        input.landmarks.iter(),
    );
    for l in cut.chain(marked.filter(|l| !is_cut(l))) {
        let vertex = l.source.main_vertex();
        let offset = match l.curve {
            Some(_) => x[vertex] - l.source.position(x),
            None => Vector3::zeros(),
        };
        goals[vertex.index()] = Goal {
            point: l.target + offset,
            weight: LANDMARK_WEIGHT * l.pull(),
        };
    }
    goals
}
