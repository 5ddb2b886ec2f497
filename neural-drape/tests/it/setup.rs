//! A sphere of quads and an ellipsoid of triangles to drape it over.

use std::sync::Arc;

use mesh_core::{
    shapes, Landmark, Point3, PolygonSoup, Positions, TargetSurface, TriangleSoup, Triangulation,
};
use neural_drape::{Drape, DrapeConfig, DrapeError, DrapeInput, ParametrizationConfig, StepReport};

pub(crate) struct Pair {
    pub(crate) triangulation: Arc<Triangulation>,
    pub(crate) rest: Arc<Positions>,
    pub(crate) initial: Positions,
    pub(crate) target: Arc<dyn TargetSurface>,
    pub(crate) landmarks: Vec<Landmark>,
}

/// Half axes of the target.
pub(crate) const AXES: [f64; 3] = [1.0, 0.7, 0.5];

pub(crate) fn on_ellipsoid(p: &Point3) -> Point3 {
    Point3::new(AXES[0] * p.x, AXES[1] * p.y, AXES[2] * p.z)
}

impl Pair {
    /// `source` starts as it is, over an ellipsoid.
    pub(crate) fn new(source: PolygonSoup) -> Self {
        let (mesh, rest) = source.into_halfedge().expect("a shape is a mesh");
        let mut ellipsoid = shapes::icosphere(3);
        ellipsoid
            .positions
            .iter_mut()
            .for_each(|p| *p = on_ellipsoid(p));
        Self {
            triangulation: Arc::new(Triangulation::new(&mesh, &rest)),
            initial: rest.map(|p| Point3::from(p.coords * 0.8)),
            rest: Arc::new(rest),
            target: Arc::new(TriangleSoup::new(ellipsoid).expect("an ellipsoid is a target")),
            landmarks: Vec::new(),
        }
    }

    pub(crate) fn input(&self) -> DrapeInput<'_> {
        DrapeInput {
            triangulation: &self.triangulation,
            rest: &self.rest,
            initial: &self.initial,
            target: &self.target,
            landmarks: &self.landmarks,
        }
    }
}

/// The presets that this build can run.
pub(crate) fn presets() -> impl Iterator<Item = &'static str> {
    let is_there = |preset: &&str| {
        let config = DrapeConfig::named(preset).expect("a known preset");
        cfg!(feature = "network")
            || matches!(config.parametrization, ParametrizationConfig::Vertices(_))
    };
    DrapeConfig::PRESETS.into_iter().filter(is_there)
}

/// A preset with a short run.
pub(crate) fn short(preset: &str, n_iterations: usize) -> DrapeConfig {
    let mut config = DrapeConfig::named(preset).expect("a known preset");
    config.stages.truncate(1);
    config.stages[0].n_iterations = n_iterations;
    config.sampling.n_samples = 400;
    config.sampling.max_samples = 400;
    config
}

pub(crate) fn run(
    input: DrapeInput<'_>,
    config: DrapeConfig,
) -> Result<(Positions, Vec<StepReport>), DrapeError> {
    let mut drape = Drape::new(input, config)?;
    let mut reports = Vec::new();
    while let Some(report) = drape.step()? {
        reports.push(report);
    }
    Ok((drape.positions(), reports))
}
