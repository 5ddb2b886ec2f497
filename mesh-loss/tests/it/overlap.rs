//! What counts where one shape lacks a part of the other.

use std::sync::Arc;

use mesh_core::sampling::SeededRng;
use mesh_core::{
    shapes, PolygonSoup, Positions, Profile, TargetSurface, TriangleSoup, Triangulation, VertexData,
};
use mesh_loss::{Matches, Overlap, SamplingConfig, SurfaceMatch, SurfaceMatcher};

use crate::finite_differences::UNIT;

/// Pairs of the quad sphere, a third as thick as wide, with `target`.
fn pairs(
    target: PolygonSoup,
    overlap: Overlap,
    attraction: impl Fn(f64) -> f64,
) -> (Positions, Matches) {
    pairs_as(target, overlap, 0.7, attraction)
}

/// The same, as strict as `mutual` says.
fn pairs_as(
    target: PolygonSoup,
    overlap: Overlap,
    mutual: f64,
    attraction: impl Fn(f64) -> f64,
) -> (Positions, Matches) {
    let (mesh, rest) = flat().into_halfedge().expect("a sound shape");
    let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
    let target: Arc<dyn TargetSurface> =
        Arc::new(TriangleSoup::new(target).expect("a sound shape"));
    let config = SamplingConfig {
        n_samples: 500,
        face_uniform: 0.5,
        normal_bias: Some(0.3),
        n_hard: 100,
        overlap,
        mutual,
    };
    let mut matcher = SurfaceMatcher::new(&triangulation, &rest, &target, UNIT);
    let attraction: VertexData<f64> = rest.iter().map(|p| attraction(p.z)).collect();
    matcher.set_attraction(&attraction);
    let mut rng = SeededRng::new(1);
    let mut resample = || matcher.resample(&rest, &config, &mut rng, &mut Profile::off());
    // Far corners are kept in mind from one time to the next.
    let matches = (0..8).map(|_| resample()).last().expect("a sound shape");
    (rest, matches)
}

fn flat() -> PolygonSoup {
    let mut soup = shapes::quad_sphere(8);
    soup.positions.iter_mut().for_each(|p| p.z /= 3.0);
    soup
}

/// The upper side of the shape, a little farther up.
fn scan() -> PolygonSoup {
    let mut soup = flat();
    let is_up = |f: &Vec<u32>| f.iter().all(|&v| soup.positions[v as usize].z > -1e-9);
    soup.faces = soup.faces.iter().filter(|f| is_up(f)).cloned().collect();
    soup.positions.iter_mut().for_each(|p| p.z += 0.1);
    soup
}

fn height(m: &SurfaceMatch, x: &Positions) -> f64 {
    let corners = m.triangle.iter().zip(m.barycentric);
    corners.map(|(&v, w)| x[v].z * w).sum()
}

fn all(matches: &Matches) -> impl Iterator<Item = &SurfaceMatch> {
    let m = matches;
    [&m.to_target, &m.to_mesh, &m.hard_to_target, &m.hard_to_mesh]
        .into_iter()
        .flatten()
}

#[test]
fn what_is_not_attracted_has_no_pair_and_leaves_no_far_corner_out() {
    let mut big = flat();
    big.positions.iter_mut().for_each(|p| *p *= 1.5);
    let whole = Overlap::default();
    let (x, matches) = pairs(big, whole, |z| if z > 0.0 { 0.0 } else { 1.0 });
    assert!(all(&matches).all(|m| m.triangle.iter().any(|&v| x[v].z <= 0.0)));
    assert!(matches.hard_to_target.iter().all(|m| height(m, &x) <= 0.0));
    assert_eq!(matches.hard_to_target.len(), 100);
    assert!(all(&matches).all(|m| m.weight > 0.0));
}

#[test]
fn the_back_of_what_was_scanned_from_the_front_is_not_pulled_to_the_scan() {
    let part = Overlap {
        mesh_exceeds: true,
        ..Overlap::default()
    };
    let lowest = |overlap: Overlap| {
        let (x, matches) = pairs(scan(), overlap, |_| 1.0);
        assert!(matches.to_target.len() > 150);
        assert!(matches.to_mesh.len() > 400);
        let heights = all(&matches).map(|m| height(m, &x));
        heights.fold(f64::INFINITY, f64::min)
    };
    assert!(lowest(Overlap::default()) < -0.3);
    assert!(lowest(part) > -0.1, "{}", lowest(part));
}

#[test]
fn stricter_pairs_are_fewer_and_lead_less_far_along() {
    let part = Overlap {
        mesh_exceeds: true,
        ..Overlap::default()
    };
    // How many pairs there are, and how far along the surface the farthest leads.
    let (mut counts, mut lateral) = (Vec::new(), Vec::new());
    for mutual in [1.2, 0.7, 0.4] {
        let mut beside = scan();
        beside.positions.iter_mut().for_each(|p| p.x += 0.3);
        let (x, matches) = pairs_as(beside, part, mutual, |_| 1.0);
        counts.push(matches.to_target.len());
        let along = |m: &SurfaceMatch| m.offset(&x).xy().norm();
        lateral.push(matches.to_target.iter().map(along).fold(0.0, f64::max));
    }
    assert!(
        counts[0] > counts[1] && counts[1] > counts[2] && counts[2] > 100,
        "{counts:?}"
    );
    assert!(lateral[2] < lateral[0], "{lateral:?}");
}
