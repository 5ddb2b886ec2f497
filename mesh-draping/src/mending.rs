//! After a run, parts that hang between others are shaped anew and draped once more.

use mesh_core::Positions;
use mesh_metrics::{dirichlet_unit_area, HAUSDORFF_WEIGHT};
use neural_drape::{Drape, DrapeError, ParametrizationConfig};

use crate::{fit, sheets, Pair, Preset};

/// So often at most.
const N_ROUNDS: usize = 3;
/// Each round takes this part of the iterations of the settings.
const PART: usize = 5;

/// What was mended of a drape so far.
#[derive(Debug, Default)]
pub(crate) struct Mending {
    /// Rounds that have begun.
    n_rounds: usize,
    /// What the last one began with.
    before: Option<Before>,
}

/// A drape at the end of its run.
#[derive(Debug)]
struct Before {
    positions: Positions,
    cost: f64,
}

impl Mending {
    /// Of a drape that is not mended: where its settings ask for no last stage, or a network moves the vertices.
    pub(crate) fn is_asked_for(preset: &Preset) -> bool {
        let drape = &preset.drape;
        drape.repair && matches!(drape.parametrization, ParametrizationConfig::Vertices(_))
    }

    /// Looks at a drape whose run is over: what hangs is shaped anew, and the run gets more iterations. Where that brought
    /// the farthest place no nearer, the drape is again where it was before.
    ///
    /// # Errors
    /// As [`Drape::displace`].
    pub(crate) fn look_at(
        &mut self,
        pair: &Pair,
        preset: &Preset,
        drape: &mut Drape,
    ) -> Result<(), DrapeError> {
        let x = drape.positions();
        let off = fit::to_target(pair, drape, &x);
        let now = Before {
            cost: cost(pair, drape, &x, &off),
            positions: x,
        };
        if let Some(before) = self.before.take().filter(|before| before.cost <= now.cost) {
            self.n_rounds = N_ROUNDS;
            return move_to(drape, &now.positions, &before.positions);
        }
        if self.n_rounds == N_ROUNDS {
            return Ok(());
        }
        if let Some(anew) = sheets::shaped_anew(pair, &now.positions, &off, self.n_rounds) {
            self.n_rounds += 1;
            move_to(drape, &now.positions, &anew)?;
            drape.extend(preset.drape.n_iterations().div_ceil(PART));
            self.before = Some(now);
        }
        Ok(())
    }
}

/// The norm of which Q_transfer is made.
fn cost(pair: &Pair, drape: &Drape, x: &Positions, off: &[Option<f64>]) -> f64 {
    let to_mesh = fit::to_mesh(pair, drape, x);
    let largest = off
        .iter()
        .chain(&to_mesh)
        .flatten()
        .copied()
        .fold(0.0, f64::max);
    let size = pair.target.judged().bounds().longest_side();
    let energy = dirichlet_unit_area(pair.source.triangulation(), pair.source.rest(), x);
    (energy - 1.0).hypot(HAUSDORFF_WEIGHT * largest / size)
}

fn move_to(drape: &mut Drape, from: &Positions, to: &Positions) -> Result<(), DrapeError> {
    let moves = to.iter().zip(from).map(|(to, from)| to - from);
    drape.displace(&moves.collect())
}
