//! The judge's figures of the shape that is shown, and its heat maps.

use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use mesh_core::measure::{corner_angle, triangle_normal};
use mesh_core::{Landmark, Positions};
use mesh_metrics::{
    dirichlet_unit_area, face_stretch, folded_edges, hausdorff_sampled, mean_angle_deviation,
    new_crossings, opposed_triangles, q_transfer, skinny_triangles, vertex_distances,
    EvaluationConfig, SurfaceDistances, HAUSDORFF_WEIGHT, PAPER_TAU,
};
use serde::Deserialize;
use serde_json::json;

use crate::broadcast::{Broadcast, ShownShape};
use crate::displayed::DisplayedPair;
use crate::latest::Latest;

/// Samples per surface for live figures; the report takes more.
const N_SAMPLES: usize = 20_000;
/// The judge leaves the drape this many times the time it takes itself.
const REST: u32 = 4;

/// A shape to judge.
pub(crate) struct FiguresJob {
    pub(crate) displayed: DisplayedPair,
    pub(crate) positions: Arc<Positions>,
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
    let (source, target) = (&job.displayed.shapes.source, job.displayed.target.judged());
    let (triangulation, rest, x) = (
        source.triangulation(),
        source.rest(),
        job.positions.as_ref(),
    );
    let config = EvaluationConfig {
        n_samples: N_SAMPLES,
        seed: 0,
    };
    let distances = SurfaceDistances::measure(triangulation, x, target, &config);
    let hausdorff = hausdorff_sampled(&distances);
    let dirichlet = dirichlet_unit_area(triangulation, rest, x);
    let q = q_transfer(dirichlet - 1.0, HAUSDORFF_WEIGHT * hausdorff, PAPER_TAU);
    let mean = |d: &[f64]| d.iter().sum::<f64>() / d.len().max(1) as f64;
    let misses = job.landmarks.iter().map(|l| {
        (l.source.position(x) - l.target).norm()
            / target.bounds().longest_side().max(f64::MIN_POSITIVE)
    });
    let squares: f64 = misses.map(|m| m * m).sum();
    let message = json!({
        "type": "figures",
        "iteration": job.iteration,
        "q": q,
        "hausdorff": hausdorff,
        "dirichlet": dirichlet,
        "mean_distance": mean(&distances.to_target.of_samples) + mean(&distances.to_draped.of_samples),
        "angle_deviation": mean_angle_deviation(triangulation, rest, x),
        "folds": folded_edges(triangulation, rest, x).len(),
        "skinny": skinny_triangles(triangulation, x).len(),
        "crossings": new_crossings(triangulation, rest, x).len(),
        "landmark_rms": (squares / job.landmarks.len().max(1) as f64).sqrt(),
    });
    if let Some(iteration) = job.iteration {
        broadcast.record("Q", iteration, q);
    }
    broadcast
        .figures
        .send_replace(Arc::from(message.to_string()));
}

/// What a heat map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Heat {
    /// Distance of each vertex from the target, in longest sides.
    Distance,
    /// Stretch of each face: 1 keeps its shape and its share of the area.
    Stretch,
    /// Mean change of each triangle's corner angles, in degrees.
    Angle,
    /// 1 for faces that turn against the target's normal.
    Flipped,
}

impl Heat {
    /// The message that carries the map of a shape: four u32 (2, serial, kind, 1 where there is a value per triangle),
    /// then f32 values.
    pub(crate) fn message(self, displayed: &DisplayedPair, shown: &ShownShape) -> Vec<u8> {
        let (values, is_per_triangle) = self.values(displayed, &shown.positions);
        let mut bytes = Vec::with_capacity(16 + 4 * values.len());
        for n in [2, shown.serial, self as u32, u32::from(is_per_triangle)] {
            bytes.extend(n.to_le_bytes());
        }
        for value in values {
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes
    }

    fn values(self, displayed: &DisplayedPair, x: &Positions) -> (Vec<f64>, bool) {
        let source = &displayed.shapes.source;
        let (t, rest) = (source.triangulation(), source.rest());
        match self {
            Self::Distance => (
                vertex_distances(x, displayed.target.judged()).into_vec(),
                false,
            ),
            Self::Stretch => {
                let stretch = face_stretch(t, rest, x);
                ((0..t.len()).map(|k| stretch[t.parent(k)]).collect(), true)
            }
            Self::Angle => {
                let pairs = t.corners(rest).zip(t.corners(x));
                let mean = |(from, to): ([_; 3], [_; 3])| {
                    let turn = |k: usize| {
                        let angle = |c: [mesh_core::Point3; 3]| {
                            corner_angle(c[k], c[(k + 1) % 3], c[(k + 2) % 3])
                        };
                        (angle(to) - angle(from)).abs()
                    };
                    ((0..3).map(turn).sum::<f64>() / 3.0).to_degrees()
                };
                (pairs.map(mean).collect(), true)
            }
            Self::Flipped => (flipped(displayed, x), true),
        }
    }
}

/// 1 for triangles that face against the target, or against their neighbours where it tells no side.
fn flipped(displayed: &DisplayedPair, x: &Positions) -> Vec<f64> {
    let source = &displayed.shapes.source;
    let t = source.triangulation();
    let mut values = vec![0.0; t.len()];
    let opposed = opposed_triangles(t, x, displayed.target.judged()).unwrap_or_default();
    let folded = folded_edges(t, source.rest(), x);
    let folded = folded.iter().flat_map(|edge| edge.triangles);
    opposed
        .into_iter()
        .chain(folded)
        .for_each(|k| values[k] = 1.0);
    for (value, corners) in values.iter_mut().zip(t.corners(x)) {
        if triangle_normal(corners).is_none() {
            *value = 1.0;
        }
    }
    values
}
