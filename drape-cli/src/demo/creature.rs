//! Two heads of one family: a direction from the middle names the same place on both.

use mesh_core::sampling::SeededRng;
use mesh_core::{shapes, Point3, PolygonSoup, Vector3};
use nalgebra::Rotation3;

/// Quads along each side of the cube that the source is blown up from: 6 n² in all.
pub(super) const QUADS_A_SIDE: usize = 16;
/// How often the triangles of the target's icosahedron are split: 20 · 4ⁿ in all.
const TARGET_SPLITS: usize = 4;

/// A bump on a head, and where it is.
struct Feature {
    name: &'static str,
    direction: [f64; 3],
    /// Height on the source and on the target, in radii; negative for a dent.
    heights: [f64; 2],
    /// Width, in radians.
    width: f64,
}

const fn feature(
    name: &'static str,
    direction: [f64; 3],
    heights: [f64; 2],
    width: f64,
) -> Feature {
    Feature {
        name,
        direction,
        heights,
        width,
    }
}

const FEATURES: [Feature; 10] = [
    feature("nose", [0.0, -0.10, 1.0], [0.36, 0.55], 0.20),
    feature("right ear", [-0.62, 0.78, -0.05], [0.70, 0.48], 0.19),
    feature("left ear", [0.62, 0.78, -0.05], [0.70, 0.48], 0.19),
    feature("right eye", [-0.36, 0.26, 0.90], [-0.14, -0.18], 0.16),
    feature("left eye", [0.36, 0.26, 0.90], [-0.14, -0.18], 0.16),
    feature("chin", [0.0, -0.72, 0.69], [0.16, 0.26], 0.28),
    feature("right cheek", [-0.66, -0.26, 0.70], [0.06, 0.13], 0.28),
    feature("left cheek", [0.66, -0.26, 0.70], [0.06, 0.13], 0.28),
    feature("forehead", [0.0, 0.60, 0.80], [0.04, 0.14], 0.38),
    feature("back of the head", [0.0, 0.20, -1.0], [0.22, 0.05], 0.50),
];

/// Places without a bump that are marked too.
const MARKED: [(&str, [f64; 3]); 8] = [
    ("right nape", [-0.6, -0.5, -0.65]),
    ("left nape", [0.6, -0.5, -0.65]),
    ("right jaw", [-0.8, -0.65, 0.1]),
    ("left jaw", [0.8, -0.65, 0.1]),
    ("crown", [0.0, 1.0, -0.05]),
    ("neck", [0.0, -1.0, -0.1]),
    ("right temple", [-1.0, 0.1, 0.0]),
    ("left temple", [1.0, 0.1, 0.0]),
];

/// Share by which the net is drawn together in the middle of a feature.
const GATHERING: f64 = 0.6;

/// Names and directions of all landmarks.
pub(super) fn marks() -> impl Iterator<Item = (&'static str, Vector3)> {
    let features = FEATURES.iter().map(|f| (f.name, f.direction));
    features
        .chain(MARKED)
        .map(|(name, d)| (name, unit(Vector3::from(d))))
}

/// Directions of the source's vertices, denser around features, and its quads.
pub(super) fn source_net() -> (Vec<Vector3>, Vec<Vec<u32>>) {
    let PolygonSoup { positions, faces } = shapes::quad_sphere(QUADS_A_SIDE);
    (
        positions.iter().map(|p| gathered(p.coords)).collect(),
        faces,
    )
}

/// Directions of the target's vertices and its triangles: another net, turned, in another order.
pub(super) fn target_net() -> (Vec<Vector3>, Vec<Vec<u32>>) {
    let PolygonSoup {
        positions,
        mut faces,
    } = shapes::icosphere(TARGET_SPLITS);
    let turn = Rotation3::from_euler_angles(0.4, 1.1, 0.3);
    let mut rng = SeededRng::new(1);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    rng.shuffle(&mut order);
    rng.shuffle(&mut faces);

    let mut directions = vec![Vector3::zeros(); positions.len()];
    for (p, &row) in positions.iter().zip(&order) {
        directions[row as usize] = turn * p.coords;
    }
    for corner in faces.iter_mut().flatten() {
        *corner = order[*corner as usize];
    }
    (directions, faces)
}

/// The place of a direction on the source.
pub(super) fn on_source(direction: &Vector3) -> Point3 {
    Point3::from(direction.component_mul(&Vector3::new(0.92, 1.08, 1.0)) * radius(direction, 0))
}

/// The place of a direction on the target: another radius, then tapered, twisted and bent, then turned, enlarged
/// and moved as a file from elsewhere is.
pub(super) fn on_target(direction: &Vector3) -> Point3 {
    let p = direction.component_mul(&Vector3::new(1.05, 0.95, 1.12)) * radius(direction, 1);
    let taper = 1.0 - 0.12 * p.y;
    let (sin, cos) = (0.12 * p.y).sin_cos();
    let twisted = Vector3::new(
        taper * (cos * p.x + sin * p.z),
        p.y,
        taper * (cos * p.z - sin * p.x),
    );
    let bent = twisted + Vector3::new(0.0, 0.0, 0.10 * twisted.y * twisted.y);
    let turn = Rotation3::from_euler_angles(0.15, 0.55, -0.10);
    Point3::from(turn * bent * 40.0 + Vector3::new(120.0, -35.0, 60.0))
}

/// `1 + Σ hₖ exp(−θₖ² / 2wₖ²)`, θₖ the angle to feature k.
fn radius(direction: &Vector3, which: usize) -> f64 {
    let bump = |f: &Feature| {
        let angle = direction.angle(&Vector3::from(f.direction));
        f.heights[which] * (-0.5 * (angle / f.width).powi(2)).exp()
    };
    1.0 + FEATURES.iter().map(bump).sum::<f64>()
}

/// Moves a direction along the great circle towards each feature: `θ ↦ θ (1 − g exp(−θ² / 2s²))`, one to one for
/// g < 1. The first features come last, so that theirs is the final word.
fn gathered(direction: Vector3) -> Vector3 {
    FEATURES.iter().rev().fold(direction, |d, f| {
        let middle = unit(Vector3::from(f.direction));
        let angle = d.angle(&middle);
        let reach = 1.6 * f.width;
        let pull = GATHERING * (-0.5 * (angle / reach).powi(2)).exp();
        match Rotation3::rotation_between(&d, &middle) {
            Some(whole) => unit(whole.powf(pull) * d),
            None => d,
        }
    })
}

fn unit(v: Vector3) -> Vector3 {
    v / v.norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::TargetSurface as _;

    fn soup(net: (Vec<Vector3>, Vec<Vec<u32>>), place: fn(&Vector3) -> Point3) -> PolygonSoup {
        PolygonSoup {
            positions: net.0.iter().map(place).collect(),
            faces: net.1,
        }
    }

    #[test]
    fn both_heads_are_closed_and_turned_outwards() {
        for soup in [soup(source_net(), on_source), soup(target_net(), on_target)] {
            let (mesh, rest) = soup.into_halfedge().unwrap();
            assert!(mesh.boundary_loops().is_empty());
            assert_eq!(mesh.n_cut_edges(), 0);
            assert_eq!(mesh.n_vertices() + mesh.n_faces() - mesh.n_edges(), 2);
            let triangulation = mesh_core::Triangulation::new(&mesh, &rest);
            let volume: f64 = triangulation
                .corners(&rest)
                .map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0)
                .sum();
            assert!(volume > 0.0);
        }
    }

    #[test]
    fn the_source_is_denser_around_features() {
        let nose = unit(Vector3::from(FEATURES[0].direction));
        let close =
            |directions: &[Vector3]| directions.iter().filter(|d| d.angle(&nose) < 0.2).count();
        let even: Vec<Vector3> = shapes::quad_sphere(QUADS_A_SIDE)
            .positions
            .iter()
            .map(|p| p.coords)
            .collect();
        assert!(3 * close(&source_net().0) > 4 * close(&even));
    }

    #[test]
    fn true_places_lie_close_to_the_targets_triangles() {
        let target = mesh_core::TriangleSoup::new(soup(target_net(), on_target)).unwrap();
        let size = target.bounds().longest_side();
        let (directions, _) = source_net();
        let distance = |d: &Vector3| target.closest_point(&on_target(d)).distance_squared.sqrt();
        let far: Vec<f64> = directions.iter().map(|d| distance(d) / size).collect();
        // Edges of 0.06 against curvatures of up to 10 at the tips of the ears: h² κ / 8 ≈ 0.005.
        assert!(far.iter().copied().fold(0.0, f64::max) < 0.01);
        assert!(far.iter().sum::<f64>() / (far.len() as f64) < 5e-4);
    }
}
