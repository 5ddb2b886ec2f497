//! The pair of the demo: a dog over a giraffe.

use mesh_creatures::{CreaturePair, Individual, PairConfig, Plan, Proportions};

/// How the giraffe differs from the dog.
const GIRAFFE: Proportions = Proportions {
    trunk_length: 0.95,
    trunk_girth: 1.15,
    belly: 1.0,
    neck_length: 3.2,
    head_size: 0.95,
    face_length: 1.3,
    ear_length: 0.75,
    limb_length: 1.9,
    limb_girth: 0.85,
    foot_length: 0.8,
    tail_length: 1.1,
    wing_span: 1.0,
};

/// Largest turn of one of its joints, in degrees.
const ANGLE: f64 = 50.0;
/// The seed of its pose.
const SEED: u64 = 3;

/// A dog at rest, a giraffe that walks, and 16 landmarks.
pub(crate) fn pair() -> CreaturePair {
    let dog = Individual::template(Plan::Quadruped);
    let giraffe = Individual::posed(Plan::Quadruped, GIRAFFE, ANGLE, SEED);
    CreaturePair::new(&dog, &giraffe, &PairConfig::standard())
}
