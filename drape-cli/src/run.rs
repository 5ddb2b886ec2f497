//! One drape from files in memory to figures: the initial deformation, the optimisation, the judge.

use mesh_core::{Positions, Profile, UnitFrame, VertexData};
use mesh_loss::Overlap;
use mesh_metrics::{EvaluationConfig, EvaluationInput, Report};
use neural_drape::network::NetworkMap;
use neural_drape::{Defects, Drape, DrapeInput, Regions, Repair, Warp, WarpInput};

use crate::explain::{explain, Counted, Explanation};
use crate::initial::{deform, Initial};
use crate::input::Pair;
use crate::profile::{Stages, DRAPING};
use crate::progress::{History, Progress};
use crate::settings::Settings;
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
        let Initial {
            positions: initial,
            assumed: mut notes,
        } = stages.time("initial deformation", || deform(pair, settings.start))?;
        let mut parts = std::mem::take(&mut stages.parts);
        let drape = stages.time(DRAPING, || {
            drape(pair, &settings, regions, &initial, &mut parts)
        })?;
        stages.parts = parts;
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
            history: drape.history,
            notes: {
                notes.extend(drape.remarks);
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

/// What the optimisation gave.
struct Draped {
    positions: Positions,
    network: Option<NetworkMap>,
    history: History,
    /// What it did of its own accord, in words.
    remarks: Vec<String>,
    attraction: VertexData<f64>,
    overlap: Overlap,
}

/// What the run takes as lying beyond the other shape.
fn left_out(drape: &Drape<'_>) -> Vec<String> {
    let (beyond, overlap) = (drape.beyond(), drape.overlap());
    [
        (overlap.target_exceeds, beyond.of_target, "target", "source"),
        (
            drape.is_mesh_part_left_out(),
            beyond.of_mesh,
            "source",
            "target",
        ),
    ]
    .into_iter()
    .filter(|&(is_left_out, ..)| is_left_out)
    .map(|(_, share, one, other)| {
        let percent = 100.0 * share;
        format!(
            "{percent:.0} % of the {one} lies beyond the {other} and was left out (--overlap decides otherwise)"
        )
    })
    .collect()
}

fn drape(
    pair: &Pair,
    settings: &Settings,
    regions: &Regions,
    initial: &Positions,
    parts: &mut Profile,
) -> anyhow::Result<Draped> {
    let input = DrapeInput {
        triangulation: &pair.source.triangulation,
        rest: &pair.source.rest,
        initial,
        target: pair.target.over.as_ref(),
        landmarks: &pair.landmarks,
    };
    let mut drape = parts.time("set-up", || Drape::new(input, settings.config.clone()))?;
    drape.set_profile(std::mem::take(parts));
    if !regions.is_none() {
        drape.set_regions(regions)?;
    }
    let mut progress = Progress::start(drape.n_iterations());
    while let Some(step) = drape.step()? {
        progress.show(&step);
    }
    *parts = drape.profile().clone();
    let end = parts.time("last stage", || drape.finish());
    let mut remarks = left_out(&drape);
    remarks.extend(repaired(&end));
    Ok(Draped {
        positions: end.positions,
        network: drape.network(),
        history: progress.finish(),
        remarks,
        attraction: drape.attraction().clone(),
        overlap: drape.overlap(),
    })
}

/// What the last stage took out, and what it could not.
fn repaired(end: &Repair) -> Vec<String> {
    let (n_before, n_left) = (count(&end.before), count(&end.left));
    let mut remarks = Vec::new();
    if n_before > n_left {
        remarks.push(format!(
            "{} folded or skinny triangles were taken out at the end (setting repair)",
            n_before - n_left
        ));
    }
    remarks.extend(end.left.folds.iter().map(|[a, b]| {
        let (a, b) = (a.index(), b.index());
        format!("a fold is left at the edge between vertices {a} and {b}; a landmark near it may undo it")
    }));
    remarks.extend(
        end.left
            .skinny
            .iter()
            .map(|t| format!("triangle {t} is left skinny; a landmark near it may widen it")),
    );
    remarks
}

fn count(defects: &Defects) -> usize {
    defects.folds.len() + defects.skinny.len()
}
