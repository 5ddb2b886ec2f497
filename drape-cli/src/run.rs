//! One drape from files in memory to figures: the initial deformation, the optimisation, the judge.

use mesh_core::{Positions, UnitFrame, VertexData};
use mesh_metrics::{EvaluationConfig, EvaluationInput, Report};
use neural_drape::network::NetworkMap;
use neural_drape::{Regions, Warp, WarpInput};

use crate::draping::{drape, Draped, Task};
use crate::explain::{explain, Counted, Explanation};
use crate::initial::{deform, Initial};
use crate::input::Pair;
use crate::profile::{Stages, DRAPING};
use crate::progress::{History, Progress};
use crate::settings::Settings;
use crate::stand_in::StandIn;
use crate::usage::{Stopwatch, Usage};

/// What a run gave and took.
pub(crate) struct Run {
    pub(crate) settings: Settings,
    /// Where the drape started, in the target's coordinates.
    pub(crate) initial: Positions,
    /// The result, likewise.
    pub(crate) draped: Positions,
    pub(crate) report: Report,
    /// The result in words.
    pub(crate) explanation: Explanation,
    pub(crate) history: History,
    /// What was assumed, which parts of either shape were left out, and what was repaired, in words.
    pub(crate) notes: Vec<String>,
    /// Seconds of each stage.
    pub(crate) stages: Vec<(&'static str, f64)>,
    pub(crate) usage: Usage,
    network: Option<NetworkMap>,
    frame: UnitFrame,
}

impl Run {
    /// Drapes the source of `pair` over its target and judges the result.
    pub(crate) fn new(
        pair: &Pair,
        settings: Settings,
        regions: &Regions,
        truth: Option<&Positions>,
        watch: &Stopwatch,
        stages: &mut Stages,
    ) -> anyhow::Result<Self> {
        let Course {
            initial,
            drape,
            history,
            mut notes,
        } = match StandIn::of(pair, &settings, stages)? {
            Some(stand_in) => stand_in.drape(pair, &settings, regions, stages)?,
            None => whole(pair, &settings, regions, stages)?,
        };
        let report = stages.time("figures", || judge(pair, &drape.positions, truth))?;
        let counted = Counted {
            attraction: &drape.attraction,
            mesh_exceeds: drape.overlap.mesh_exceeds,
            target_exceeds: drape.overlap.target_exceeds,
        };
        let explanation = stages.time("explanation", || {
            explain(pair, &drape.positions, &report.vertex_distances, &counted)
        });
        Ok(Self {
            frame: UnitFrame::of(pair.target.surface.bounds()),
            settings,
            initial,
            draped: drape.positions,
            network: drape.network,
            history,
            notes: {
                notes.extend(drape.left_out);
                notes.extend(drape.repaired);
                notes
            },
            report,
            explanation,
            stages: stages.seconds(),
            usage: watch.read(),
        })
    }

    /// A result that came about elsewhere, judged.
    pub(crate) fn of_result(
        pair: &Pair,
        settings: Settings,
        shapes: Shapes,
        watch: &Stopwatch,
    ) -> anyhow::Result<Self> {
        let report = judge(pair, &shapes.draped, None)?;
        let counted = Counted {
            attraction: &VertexData::new(shapes.draped.len(), 1.0),
            mesh_exceeds: false,
            target_exceeds: false,
        };
        Ok(Self {
            frame: UnitFrame::of(pair.target.surface.bounds()),
            explanation: explain(pair, &shapes.draped, &report.vertex_distances, &counted),
            report,
            settings,
            initial: shapes.initial,
            draped: shapes.draped,
            network: None,
            history: History::default(),
            notes: Vec::new(),
            stages: Vec::new(),
            usage: watch.read(),
        })
    }

    /// Distance of each vertex from another place, in longest sides of the target's box.
    pub(crate) fn distances_from(&self, truth: &Positions) -> VertexData<f64> {
        let pairs = self.draped.iter().zip(truth.iter());
        pairs
            .map(|(a, b)| (a - b).norm() / self.frame.scale)
            .collect()
    }

    /// What the drape did to space.
    pub(crate) fn warp(&self, pair: &Pair) -> anyhow::Result<Warp> {
        Ok(Warp::new(WarpInput {
            triangulation: &pair.source.triangulation,
            rest: &pair.source.rest,
            initial: &self.initial,
            draped: &self.draped,
            network: self.network.clone(),
        })?)
    }

    /// All figures by name: of the result, of time and memory.
    pub(crate) fn figures(&self) -> Vec<(&'static str, f64)> {
        let mut figures = self.report.figures();
        figures.extend(self.usage.figures());
        figures
    }
}

/// Every measure of a shape of the pair's source.
pub(crate) fn judge(
    pair: &Pair,
    draped: &Positions,
    truth: Option<&Positions>,
) -> anyhow::Result<Report> {
    let input = EvaluationInput {
        mesh: &pair.source.mesh,
        rest: &pair.source.rest,
        draped,
        target: pair.target.surface.as_ref(),
        landmarks: &pair.landmarks,
        truth,
    };
    Ok(mesh_metrics::evaluate(
        input,
        &EvaluationConfig::standard(),
    )?)
}

/// Where a drape started and ended.
pub(crate) struct Shapes {
    pub(crate) initial: Positions,
    pub(crate) draped: Positions,
}

/// How a result came about.
pub(crate) struct Course {
    /// Where the drape started, in the target's coordinates.
    pub(crate) initial: Positions,
    pub(crate) drape: Draped,
    pub(crate) history: History,
    /// What was assumed, in words.
    pub(crate) notes: Vec<String>,
}

/// The source itself is deformed and draped.
fn whole(
    pair: &Pair,
    settings: &Settings,
    regions: &Regions,
    stages: &mut Stages,
) -> anyhow::Result<Course> {
    let Initial { positions, assumed } =
        stages.time("initial deformation", || deform(pair, settings.start))?;
    let task = Task {
        pair,
        config: settings.config.clone(),
        regions,
        initial: &positions,
    };
    let mut progress = Progress::start(settings.config.n_iterations());
    let drape = stages.time_with_parts(DRAPING, |parts| drape(task, &mut progress, parts))?;
    Ok(Course {
        initial: positions,
        drape,
        history: progress.finish(),
        notes: assumed,
    })
}
