//! One optimisation from start to end, and what it has to say.

use mesh_core::{Positions, Profile, VertexData};
use mesh_loss::Overlap;
use neural_drape::network::NetworkMap;
use neural_drape::{Defects, Drape, DrapeConfig, DrapeInput, Regions, Repair};

use crate::input::Pair;
use crate::progress::Progress;

/// What the optimisation gave.
pub(crate) struct Draped {
    pub(crate) positions: Positions,
    pub(crate) network: Option<NetworkMap>,
    /// Which parts it took as lying beyond the other shape, in words.
    pub(crate) left_out: Vec<String>,
    /// What was mended at the end, and what could not be, in words.
    pub(crate) repaired: Vec<String>,
    pub(crate) attraction: VertexData<f64>,
    pub(crate) overlap: Overlap,
    /// Whether a part of the source that no boundary of the target marks was left out.
    pub(crate) is_part_uncovered: bool,
}

/// What the run takes as lying beyond the other shape.
fn left_out(drape: &Drape) -> Vec<String> {
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

/// What is draped, with which settings.
pub(crate) struct Task<'a> {
    pub(crate) pair: &'a Pair,
    pub(crate) config: DrapeConfig,
    pub(crate) regions: &'a Regions,
    pub(crate) initial: &'a Positions,
}

/// Drapes and shows it; `parts` tells where the time went.
pub(crate) fn drape(
    task: Task<'_>,
    progress: &mut Progress,
    parts: &mut Profile,
) -> anyhow::Result<Draped> {
    let source = &task.pair.source;
    let input = DrapeInput {
        triangulation: &source.triangulation,
        rest: &source.rest,
        initial: task.initial,
        target: &task.pair.target.over,
        landmarks: &task.pair.landmarks,
    };
    let mut drape = parts.time("set-up", || Drape::new(input, task.config))?;
    drape.set_profile(std::mem::take(parts));
    if !task.regions.is_none() {
        drape.set_regions(task.regions)?;
    }
    while let Some(step) = drape.step()? {
        progress.show(&step);
    }
    *parts = drape.profile().clone();
    let end = parts.time("last stage", || drape.finish());
    let overlap = drape.overlap();
    Ok(Draped {
        repaired: repaired(&end),
        positions: end.positions,
        network: drape.network(),
        left_out: left_out(&drape),
        attraction: drape.attraction().clone(),
        overlap,
        is_part_uncovered: drape.is_mesh_part_left_out() && !overlap.mesh_exceeds,
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
