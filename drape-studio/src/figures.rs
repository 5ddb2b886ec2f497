//! The judge's figures of the shape that is shown.

use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use mesh_core::{Landmark, Positions};
use mesh_metrics::{
    chamfer, dirichlet_unit_area, folded_edges, hausdorff_sampled, mean_angle_deviation,
    opposed_triangles, q_transfer, skinny_triangles, Counterparts, EvaluationConfig,
    HAUSDORFF_WEIGHT, PAPER_TAU,
};
use serde::Serialize;
use serde_json::json;

use crate::broadcast::Broadcast;
use crate::displayed::DisplayedPair;
use crate::latest::Latest;
use crate::session::fingerprint;

/// Samples per surface for live figures; the report takes more.
const N_SAMPLES: usize = 20_000;
/// The judge leaves the drape this many times the time it takes itself.
const REST: u32 = 4;

/// A shape to judge.
pub(crate) struct FiguresJob {
    pub(crate) displayed: DisplayedPair,
    pub(crate) positions: Arc<Positions>,
    /// What of the two shapes is compared.
    pub(crate) counterparts: Arc<Counterparts>,
    pub(crate) landmarks: Vec<Landmark>,
    /// The iteration of the drape; none before it began.
    pub(crate) iteration: Option<usize>,
    /// Whether nothing goes on meanwhile.
    pub(crate) is_resting: bool,
}

/// Starts the judge, who tells the broadcast.
pub(crate) fn judge(broadcast: Arc<Broadcast>) -> Latest<FiguresJob> {
    Latest::start(move |job: FiguresJob| {
        let began = Instant::now();
        tell(&broadcast, &job);
        if !job.is_resting {
            thread::sleep((began.elapsed() * REST).min(Duration::from_secs(20)));
        }
    })
}

fn tell(broadcast: &Broadcast, job: &FiguresJob) {
    let figures = Figures::of(job);
    if let Some(iteration) = job.iteration {
        broadcast.record("Q", iteration, figures.q);
        broadcast.record("mean distance", iteration, figures.mean_distance);
    }
    let mut message = json!(figures);
    message["type"] = json!("figures");
    message["iteration"] = json!(job.iteration);
    message["marks"] = json!(fingerprint(&job.landmarks));
    broadcast
        .figures
        .send_replace(Arc::from(message.to_string()));
}

/// What pages show of a shape. Distances are in longest sides of the target's box, over what has a counterpart.
#[derive(Serialize)]
pub(crate) struct Figures {
    q: f64,
    hausdorff: f64,
    /// The same over everything.
    hausdorff_of_all: f64,
    /// Those of both ways, added.
    mean_distance: f64,
    /// The shares of source and target that have no counterpart.
    source_left_out: f64,
    target_left_out: f64,
    dirichlet: f64,
    angle_deviation: f64,
    folds: usize,
    /// Triangles that face against the target; none where it tells no side.
    flipped: Option<usize>,
    /// Pairs of triangles that pass through each other and did not at rest.
    crossings: usize,
    skinny: usize,
    landmark_rms: f64,
}

impl Figures {
    /// Judges a shape.
    pub(crate) fn of(job: &FiguresJob) -> Self {
        let (source, target) = (&job.displayed.shapes.source, job.displayed.target.judged());
        let (t, rest, x) = (
            source.triangulation(),
            source.rest(),
            job.positions.as_ref(),
        );
        let config = EvaluationConfig {
            n_samples: N_SAMPLES,
            seed: 0,
        };
        let counted = job.counterparts.distances(t, x, target, &config);
        let hausdorff = hausdorff_sampled(&counted.distances);
        let dirichlet = dirichlet_unit_area(t, rest, x);
        let [there, back] = [&counted.distances.to_target, &counted.distances.to_draped];
        Self {
            q: q_transfer(dirichlet - 1.0, HAUSDORFF_WEIGHT * hausdorff, PAPER_TAU),
            hausdorff,
            hausdorff_of_all: if counted.mesh_left_out + counted.target_left_out > 0.0 {
                counted.hausdorff_of_all
            } else {
                hausdorff
            },
            mean_distance: chamfer(there).mean_l2 + chamfer(back).mean_l2,
            source_left_out: counted.mesh_left_out,
            target_left_out: counted.target_left_out,
            dirichlet,
            angle_deviation: mean_angle_deviation(t, rest, x),
            folds: folded_edges(t, rest, x).len(),
            flipped: opposed_triangles(t, x, target).map(|opposed| opposed.len()),
            crossings: job.displayed.new_crossings(x),
            skinny: skinny_triangles(t, x).len(),
            landmark_rms: landmark_rms(job),
        }
    }
}

/// Root mean square of what the landmarks are off.
fn landmark_rms(job: &FiguresJob) -> f64 {
    let side = job.displayed.target.judged().bounds().longest_side();
    let marked = Landmark::marked(&job.landmarks).filter(|l| l.is_followed());
    let squares = marked.clone().map(|l| {
        let miss = (l.source.position(&job.positions) - l.target).norm();
        (miss / side.max(f64::MIN_POSITIVE)).powi(2)
    });
    (squares.sum::<f64>() / marked.count().max(1) as f64).sqrt()
}
