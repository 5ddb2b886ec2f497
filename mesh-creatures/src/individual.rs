//! Individuals: a plan with proportions and a pose.

use mesh_core::sampling::SeededRng;
use mesh_core::{Positions, Triangulation};
use mesh_metrics::{self_intersections, triangle_qualities, FOLD_COSINE, SKINNY_QUALITY};

use crate::cage::Cage;
use crate::plan::{Body, Plan};
use crate::proportions::Proportions;
use crate::skeleton::Freedom;
use crate::template::smooth;

/// How far individuals differ from the template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dial {
    /// Largest turn of a joint, in degrees, 0..=120; where no joint of a plan can turn by 120°, the same part of what the
    /// widest can.
    pub angle: f64,
    /// Largest ratio of a length to the template's, and of the template's to it, 1..=3. Girths differ less.
    pub ratio: f64,
}

impl Dial {
    /// The middle of the dial: half of the largest angle, and the geometric mean of the ratios.
    pub const MIDDLE: Self = Self {
        angle: 60.0,
        ratio: 1.75,
    };
}

/// The angles of all joints, in degrees: 0 throughout at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose(Vec<f64>);

impl Pose {
    /// Shares of the limits of all joints, scaled until one turns by `angle`, or by its part of 120° where no joint of
    /// the plan turns so far; no joint goes beyond its limits.
    fn drawn(plan: Plan, proportions: &Proportions, angle: f64, rng: &mut SeededRng) -> Self {
        let skeleton = plan.body(proportions).skeleton;
        let shares: Vec<f64> = skeleton
            .freedoms()
            .map(|_| rng.uniform() + rng.uniform() - 1.0)
            .collect();
        let turn = |(freedom, share): (&Freedom, &f64)| {
            let [low, high] = freedom.degrees;
            0.5 * (low + high) + 0.5 * (high - low) * share
        };
        let turns: Vec<f64> = skeleton.freedoms().zip(&shares).map(turn).collect();
        let limits = skeleton.freedoms().flat_map(|freedom| freedom.degrees);
        let [widest, largest] = [largest(limits), largest(turns.iter().copied())];
        let scale = angle / 120.0 * widest / largest;
        let clamped = |(freedom, turn): (&Freedom, f64)| {
            (turn * scale).clamp(freedom.degrees[0], freedom.degrees[1])
        };
        Self(skeleton.freedoms().zip(turns).map(clamped).collect())
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| largest.max(value.abs()))
}

/// A creature: a plan with proportions and a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Individual {
    plan: Plan,
    proportions: Proportions,
    pose: Pose,
}

/// So many draws are looked at before the last is eased.
const N_DRAWS: usize = 24;
/// What is left of proportions and pose each time that they are eased.
const EASING: f64 = 0.8;
/// So often it is eased: what is left then is a thousandth.
const N_EASINGS: usize = 32;

impl Individual {
    /// The template of a plan: its proportions are 1, its joints at rest.
    pub fn template(plan: Plan) -> Self {
        Self::at_rest(plan, Proportions::TEMPLATE)
    }

    /// An individual with its joints at rest.
    pub fn at_rest(plan: Plan, proportions: Proportions) -> Self {
        let n = plan.body(&proportions).skeleton.n_angles();
        Self {
            plan,
            proportions,
            pose: Pose(vec![0.0; n]),
        }
    }

    /// An individual of these proportions in a random pose of a seed, as [`Self::drawn`] draws poses, but whether it is
    /// sound or not.
    ///
    /// # Panics
    /// If the angle is not 0 to 120.
    pub fn posed(plan: Plan, proportions: Proportions, angle: f64, seed: u64) -> Self {
        assert!((0.0..=120.0).contains(&angle), "angles are 0 to 120");
        let pose = Pose::drawn(plan, &proportions, angle, &mut SeededRng::new(seed));
        Self {
            plan,
            proportions,
            pose,
        }
    }

    /// A random individual of a seed; the same on every machine.
    ///
    /// Proportions are even in the logarithm. Angles lie between the limits of their joints, more often near the middle,
    /// and are scaled together until the largest is that of the dial. Drawn again until the surface is sound: it passes
    /// nowhere through itself, no two neighbouring triangles fold onto each other, and none is skinny. If 24 draws are
    /// not, the last is eased towards the template until it is; at worst it is the template.
    ///
    /// # Panics
    /// If the dial is not within its ranges.
    pub fn drawn(plan: Plan, seed: u64, dial: Dial) -> Self {
        assert!((0.0..=120.0).contains(&dial.angle), "angles are 0 to 120");
        assert!((1.0..=3.0).contains(&dial.ratio), "ratios are 1 to 3");
        let mut rng = SeededRng::new(seed);
        let mut individual = Self::draw(plan, dial, &mut rng);
        for _ in 1..N_DRAWS {
            if individual.is_sound() {
                return individual;
            }
            individual = Self::draw(plan, dial, &mut rng);
        }
        let eased = std::iter::successors(Some(individual), |i| Some(i.eased()));
        eased
            .take(N_EASINGS)
            .find(|i| i.is_sound())
            .unwrap_or_else(|| Self::template(plan))
    }

    fn draw(plan: Plan, dial: Dial, rng: &mut SeededRng) -> Self {
        let proportions = Proportions::drawn(dial.ratio, rng);
        let pose = Pose::drawn(plan, &proportions, dial.angle, rng);
        Self {
            plan,
            proportions,
            pose,
        }
    }

    fn eased(&self) -> Self {
        Self {
            plan: self.plan,
            proportions: self.proportions.tempered(EASING),
            pose: Pose(self.pose.0.iter().map(|angle| angle * EASING).collect()),
        }
    }

    /// What kind of creature it is.
    pub fn plan(&self) -> Plan {
        self.plan
    }

    /// How it is built.
    pub fn proportions(&self) -> &Proportions {
        &self.proportions
    }

    /// Its control mesh, posed.
    pub(crate) fn cage(&self) -> Cage {
        let Body { mut cage, skeleton } = self.plan.body(&self.proportions);
        cage.positions = skeleton.posed(&cage.positions, &cage.skins, &self.pose.0);
        cage
    }

    /// Whether its surface neither passes through itself nor folds, and has no skinny triangle.
    pub(crate) fn is_sound(&self) -> bool {
        let Ok((mesh, x)) = smooth(&self.cage(), 1).into_halfedge() else {
            return false;
        };
        let triangulation = Triangulation::new(&mesh, &x);
        let is_skinny = |q: &f64| *q < SKINNY_QUALITY;
        !triangle_qualities(&triangulation, &x).iter().any(is_skinny)
            && !is_folded(&triangulation, &x)
            && self_intersections(&triangulation, &x).is_empty()
    }
}

fn is_folded(triangulation: &Triangulation, x: &Positions) -> bool {
    let normals: Vec<_> = triangulation
        .corners(x)
        .map(mesh_core::measure::triangle_normal)
        .collect();
    triangulation
        .interior_edges()
        .any(|edge| match edge.triangles.map(|t| normals[t]) {
            [Some(n), Some(m)] => n.dot(&m) < FOLD_COSINE,
            _ => true,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_joints_turn_by_the_angle_of_the_dial() {
        for plan in [Plan::Quadruped, Plan::Person] {
            for seed in 0..5 {
                let one = Individual::posed(plan, Proportions::TEMPLATE, 50.0, seed);
                let turned = largest(one.pose.0.iter().copied());
                assert!((turned - 50.0).abs() < 1e-9, "{plan} {seed}: {turned}");
            }
        }
    }

    #[test]
    fn no_joint_goes_beyond_its_limits() {
        for plan in Plan::ALL {
            let dial = Dial {
                angle: 120.0,
                ratio: 1.0,
            };
            let one = Individual::draw(plan, dial, &mut SeededRng::new(1));
            let skeleton = plan.body(&one.proportions).skeleton;
            for (freedom, turn) in skeleton.freedoms().zip(&one.pose.0) {
                let [low, high] = freedom.degrees;
                assert!((low..=high).contains(turn), "{plan}: {turn}");
            }
        }
    }
}
