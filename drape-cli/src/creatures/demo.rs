//! The pair of the demo: a dog over a giraffe.

use mesh_creatures::{CreaturePair, Individual, PairConfig, Plan, Proportions};

/// How the giraffe differs from the dog.
const GIRAFFE: Proportions = Proportions {
    trunk_length: 0.9,
    trunk_girth: 1.1,
    belly: 1.0,
    neck_length: 3.0,
    head_size: 0.95,
    face_length: 1.25,
    ear_length: 0.9,
    limb_length: 1.9,
    limb_girth: 0.85,
    foot_length: 0.8,
    tail_length: 1.2,
    wing_span: 1.0,
};

/// Largest turn of one of its joints, in degrees.
const ANGLE: f64 = 36.0;
/// The seed of its pose.
const SEED: u64 = 0;
/// Few landmarks: none on shoulders and hips.
const N_LANDMARKS: usize = 12;

/// A coarse dog at rest, so that the demo is quick, a giraffe that walks, and where twelve places of the one are on the other.
pub(crate) fn pair() -> CreaturePair {
    let dog = Individual::template(Plan::Quadruped);
    let giraffe = Individual::posed(Plan::Quadruped, GIRAFFE, ANGLE, SEED);
    let config = PairConfig {
        n_splits: 0,
        n_landmarks: N_LANDMARKS,
        ..PairConfig::standard()
    };
    CreaturePair::new(&dog, &giraffe, &config)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{TargetSurface as _, TriangleSoup, Triangulation};
    use mesh_draping::mesh_metrics::{self_intersections, skinny_triangles};

    #[test]
    fn the_giraffe_is_sound_and_the_truth_lies_on_it() {
        let pair = pair();
        let (mesh, rest) = pair.source.soup.into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &rest);
        let truth = pair.truth.clone().into();
        assert!(self_intersections(&triangulation, &truth).is_empty());
        assert!(skinny_triangles(&triangulation, &truth).is_empty());

        let target = TriangleSoup::new(pair.target).unwrap();
        let size = target.bounds().longest_side();
        let closest = target.closest_points(&pair.truth);
        assert!(closest
            .iter()
            .all(|c| c.distance_squared.sqrt() < 3e-3 * size));
    }
}
