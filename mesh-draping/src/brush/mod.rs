//! Brushes on a shape of the source: relaxed, pulled to the target, or slid along it, where somebody paints.

mod ball;
mod pull;
mod relax;
mod slide;

use mesh_core::{Point3, Positions, Vector3, VertexData, VertexId};
use neural_drape::DrapeError;
use serde::{Deserialize, Serialize};

use crate::Pair;
use ball::Ball;

/// Dabs lie this many radii apart.
const SPACING: f64 = 0.5;
/// More dabs than this are never put between two places of a path.
const MAX_BETWEEN: f64 = 64.0;
/// A path has at most this many places.
const MAX_PLACES: usize = 10_000;

/// What a brush does to what it touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Brush {
    /// Brings back the local shape that the source has at rest, turned and enlarged as the surface is now.
    Relax,
    /// Moves towards the closest places of the target.
    Pull,
    /// Moves along the surface of the target, as the brush moves.
    Slide,
}

/// One stroke of a brush: all that is needed to do it again to the bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stroke {
    /// What it does.
    pub brush: Brush,
    /// How far it reaches, in the target's units; above 0.
    pub radius: f64,
    /// How much it does in its middle, 0..=1; towards its rim that falls to 0 as `(1 − (d/r)²)²`.
    pub strength: f64,
    /// Where it went, on the shape, in the target's coordinates.
    pub path: Vec<[f64; 3]>,
}

/// What is brushed.
#[derive(Clone, Copy)]
pub struct BrushInput<'a> {
    /// The source and the target that it is draped over.
    pub pair: &'a Pair,
    /// The vertices that no brush moves; one entry per vertex.
    pub held: &'a VertexData<bool>,
}

/// What a stroke did: the vertices that moved, in order, and by how much, in the target's coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moves {
    /// The vertices with their moves.
    pub entries: Vec<(VertexId, Vector3)>,
}

impl Stroke {
    /// Refuses numbers that no brush has.
    ///
    /// # Errors
    /// A radius that is not above 0, a strength outside 0..=1, a path that is endless or leaves the finite numbers.
    pub fn check(&self) -> Result<(), DrapeError> {
        let refuse = |name: &str, value: f64, expected: &'static str| {
            Err(DrapeError::Setting {
                name: name.to_owned(),
                value,
                expected,
            })
        };
        let wild = self.path.iter().flatten().find(|c| !c.is_finite());
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            return refuse("radius", self.radius, "above 0 and finite");
        }
        if !(0.0..=1.0).contains(&self.strength) {
            return refuse("strength", self.strength, "between 0 and 1");
        }
        if self.path.len() > MAX_PLACES {
            return refuse("path", self.path.len() as f64, "at most 10000 places");
        }
        wild.map_or(Ok(()), |&c| refuse("path", c, "finite"))
    }

    /// Does the whole stroke to `x`, one position per vertex of the source in the target's coordinates. The same bits
    /// whatever the number of threads.
    pub fn apply(&self, input: BrushInput<'_>, x: &mut Positions) {
        for place in 0..self.path.len() {
            self.apply_place(input, x, place);
        }
    }

    /// Does to `x` what the stroke does from one place of its path to the place in row `to`: what is shown while somebody
    /// draws it. All places in order are the whole stroke; a row that is not there does nothing.
    pub fn apply_place(&self, input: BrushInput<'_>, x: &mut Positions, to: usize) {
        let place = |row: usize| self.path.get(row).copied().map(Point3::from);
        let (Some(from), Some(to)) = (place(to.saturating_sub(1)), place(to)) else {
            return;
        };
        let way = to - from;
        let n = (way.norm() / (SPACING * self.radius)).ceil();
        let n = n.clamp(1.0, MAX_BETWEEN);
        for k in 0..n as usize {
            let at = match self.brush {
                Brush::Slide => from + way * (k as f64 / n),
                Brush::Relax | Brush::Pull => from + way * ((k + 1) as f64 / n),
            };
            self.dab(input, x, at, way / n);
        }
    }

    /// One touch at a place; `by` is how far the brush goes from there.
    fn dab(&self, input: BrushInput<'_>, x: &mut Positions, at: Point3, by: Vector3) {
        let triangulation = input.pair.source.triangulation();
        let ball = Ball::around(triangulation, x, at, self.radius).without(input.held);
        let ball = ball.times(self.strength);
        match self.brush {
            Brush::Relax => relax::relax(input.pair, &ball, x),
            Brush::Pull => pull::pull(input.pair, &ball, x),
            Brush::Slide => slide::slide(input.pair, &ball, x, by),
        }
    }
}

impl Moves {
    /// What moves `from` to `to`.
    pub fn between(from: &Positions, to: &Positions) -> Self {
        let moves = from.ids().map(|v| (v, to[v] - from[v]));
        Self {
            entries: moves.filter(|(_, by)| *by != Vector3::zeros()).collect(),
        }
    }

    /// The opposite moves: what takes these back.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            entries: self.entries.iter().map(|&(v, by)| (v, -by)).collect(),
        }
    }

    /// One move per vertex of `n`; those of other vertices are left out.
    pub fn spread(&self, n: usize) -> VertexData<Vector3> {
        let mut all = VertexData::new(n, Vector3::zeros());
        let known = self.entries.iter().filter(|(v, _)| v.index() < n);
        known.for_each(|&(v, by)| all[v] = by);
        all
    }
}
