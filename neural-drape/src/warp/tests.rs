//! Warps against closed forms, and their files against damage.

use std::sync::OnceLock;

#[cfg(feature = "network")]
use mesh_core::VertexData;
use mesh_core::{shapes, Aabb, PolygonSoup, UnitFrame};
use proptest::prelude::*;

use super::format::{decode, encode, FormatError};
use super::*;
use crate::network::{Layer, NetworkMap, WaveKind, Waves};
#[cfg(feature = "network")]
use crate::network::{Network, NetworkConfig, Shapes};
#[cfg(feature = "network")]
use crate::Parametrization;

fn solids() -> [PolygonSoup; 3] {
    let mut with_loose_vertex = shapes::quad_sphere(6);
    with_loose_vertex.positions.push(Point3::new(0.3, 0.1, 0.2));
    [
        shapes::icosphere(4),
        shapes::open_grid(7, 5),
        with_loose_vertex,
    ]
}

fn warp_of(soup: &PolygonSoup, draped: impl Fn(&Point3) -> Point3) -> (Warp, Positions, Positions) {
    let (mesh, rest) = soup.clone().into_halfedge().unwrap();
    let draped = rest.map(draped);
    let warp = Warp::new(WarpInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        initial: &rest,
        draped: &draped,
        network: None,
    });
    (warp.unwrap(), rest, draped)
}

/// A warp with a trained network, the source at rest, and where the network took it.
#[cfg(feature = "network")]
fn network_warp(config: &NetworkConfig) -> (Warp, Positions, Positions) {
    let (mesh, rest) = shapes::icosphere(3).into_halfedge().unwrap();
    let initial = rest.map(|p| p + Vector3::new(0.0, 0.2 * p.x, 5.0));
    let frame = UnitFrame::of(Aabb::of(&initial));
    let x0 = initial.map(|p| frame.to_unit(p));
    let mut network = Network::new(Shapes::at_rest(&x0), config, 0).unwrap();
    network.set_progress(1.0).unwrap();
    let gradient = VertexData::from_iter(rest.iter().map(|p| p.coords * p.z));
    for _ in 0..10 {
        network.descend(&gradient, 1e-3).unwrap();
    }
    let draped = network.positions().map(|p| frame.from_unit(p));
    let warp = Warp::new(WarpInput {
        triangulation: &Triangulation::new(&mesh, &rest),
        rest: &rest,
        initial: &initial,
        draped: &draped,
        network: Some(network.network().unwrap().outside(&frame)),
    });
    (warp.unwrap(), rest, draped)
}

fn largest_distance(a: &[Point3], b: &[Point3]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

/// Near the surface, between its parts and far away.
fn probes() -> Vec<Point3> {
    [0.0, 0.7, 1.01, 3.0, 100.0]
        .into_iter()
        .flat_map(|r| [Point3::new(r, 0.0, 0.0), Point3::new(0.1, -r, 0.6 * r)])
        .collect()
}

#[test]
fn a_drape_that_moves_nothing_moves_nothing() {
    for soup in solids() {
        let (warp, rest, _) = warp_of(&soup, |p| *p);
        assert_eq!(warp.apply(rest.as_slice()), rest.as_slice());
        assert_eq!(warp.apply(&probes()), probes());
    }
}

#[test]
fn own_vertices_land_on_the_draped_ones() {
    for soup in solids() {
        let bend =
            |p: &Point3| Point3::new(2.0 * p.x + (4.0 * p.y).sin(), p.y, p.z + p.x * p.x + 7.0);
        let (warp, rest, draped) = warp_of(&soup, bend);
        // Rounding of coordinates up to 10, through sums of 1000 terms.
        assert!(largest_distance(&warp.apply(rest.as_slice()), draped.as_slice()) < 1e-12);
    }
}

#[test]
fn an_affine_drape_is_affine_everywhere() {
    let affine = |p: &Point3| Point3::new(2.0 * p.x + p.y, 0.5 * p.y - 1.0, p.z + 0.3 * p.x + 4.0);
    let (warp, ..) = warp_of(&shapes::icosphere(4), affine);
    let expected: Vec<Point3> = probes().iter().map(affine).collect();
    // The solve of 1 000 centres loses some digits, which grow with the distance of 100.
    assert!(largest_distance(&warp.apply(&probes()), &expected) < 1e-6);
}

#[test]
fn a_refined_source_follows_between_the_vertices() {
    let stretch = |p: &Point3| Point3::new(p.x * (1.0 + 0.3 * p.z), p.y, 1.5 * p.z);
    let (warp, ..) = warp_of(&shapes::icosphere(3), stretch);
    let fine = shapes::icosphere(5).positions;
    let expected: Vec<Point3> = fine.iter().map(stretch).collect();
    // Between vertices 0.14 apart a bend of 1 is missed by less than 0.14² / 8.
    assert!(largest_distance(&warp.apply(&fine), &expected) < 2.5e-3);
}

#[cfg(feature = "network")]
#[test]
fn a_network_warp_repeats_the_network_on_the_surface_and_rests_far_away() {
    for config in [NetworkConfig::standard(), NetworkConfig::paper()] {
        let (warp, rest, draped) = network_warp(&config);
        assert!(largest_distance(rest.as_slice(), draped.as_slice()) > 0.01);
        assert!(largest_distance(&warp.apply(rest.as_slice()), draped.as_slice()) < 1e-12);
        // The residual is what f32 blocks of other sizes leave.
        assert!(warp.surface.residuals.iter().all(|r| r.norm() < 1e-4));
        let far = [Point3::new(0.0, 3.0, -2.0)];
        assert!(largest_distance(&warp.apply(&far), &[Point3::new(0.0, 3.0, 3.0)]) < 1e-6);
    }
}

#[test]
fn a_saved_warp_loads_with_the_same_bits() {
    let path = std::env::temp_dir().join(format!("neural_drape_{}.drape", std::process::id()));
    let (plain, ..) = warp_of(&solids()[2], |p| p + Vector3::new(p.y * p.y, 0.0, 1.0));
    let networked = warp_with_map();
    for warp in [plain, networked] {
        warp.save(&path).unwrap();
        let loaded = Warp::load(&path).unwrap();
        assert_eq!(loaded.apply(&probes()), warp.apply(&probes()));
        assert_eq!(loaded.surface, warp.surface);
        assert_eq!(loaded.network, warp.network);
    }
    std::fs::remove_file(&path).unwrap();
    let error = Warp::load(&path).unwrap_err();
    assert!(matches!(error, WarpError::Read { .. }));
}

/// A warp with a network of two waves and two neurons that nobody trained.
fn warp_with_map() -> Warp {
    let (warp, rest, _) = warp_of(&shapes::icosphere(2), |p| p + Vector3::new(p.y, 0.0, 1.0));
    let waves = Waves {
        rows: vec![[1.0, 0.5, 0.0], [0.0, -2.0, 3.0]],
        gain: 1.0,
        kind: WaveKind::SineCosine,
    };
    let layer = |n_inputs: usize, n_outputs: usize| Layer {
        weight: (0..n_inputs * n_outputs)
            .map(|k| (k as f32).sin())
            .collect(),
        bias: vec![0.1; n_outputs],
    };
    let map = NetworkMap {
        frame: UnitFrame::of(Aabb::of(&rest)),
        output_scale: 0.5,
        networks: vec![
            vec![layer(waves.n_features(), 2), layer(2, 3)],
            vec![layer(5, 4), layer(4, 3)],
        ],
        waves,
    };
    Warp::from_parts(warp.extension, Some(map), warp.surface)
}

/// A small file with every part.
fn file() -> Vec<u8> {
    static FILE: OnceLock<Vec<u8>> = OnceLock::new();
    let make = || {
        let warp = warp_with_map();
        encode(&warp.extension, warp.network.as_ref(), &warp.surface)
    };
    FILE.get_or_init(make).clone()
}

#[test]
fn what_is_no_warp_is_told_so() {
    assert_eq!(decode(b"v 0 0 0\n").unwrap_err(), FormatError::NotAWarp);
    assert_eq!(decode(b"").unwrap_err(), FormatError::NotAWarp);
    let mut newer = file();
    newer[8] = 2;
    assert_eq!(decode(&newer).unwrap_err(), FormatError::Version(2));
}

#[test]
fn an_impossible_length_is_refused_before_memory_is_asked_for() {
    let mut bytes = file();
    // The length of the list of kernels stands after magic, version and 15 numbers.
    bytes[132..136].copy_from_slice(&u32::MAX.to_le_bytes());
    rehash(&mut bytes);
    let reason = "a list is longer than the file";
    assert_eq!(
        decode(&bytes).unwrap_err(),
        FormatError::Damaged {
            offset: 136,
            reason
        }
    );
}

fn rehash(bytes: &mut [u8]) {
    let content = bytes.len() - 8;
    let hash = super::format::fnv1a(&bytes[..content]).to_le_bytes();
    bytes[content..].copy_from_slice(&hash);
}

proptest! {
    #[test]
    fn a_cut_file_is_refused(share in 0.0..1.0f64) {
        let bytes = file();
        let n = (share * bytes.len() as f64) as usize;
        prop_assert!(decode(&bytes[..n]).is_err());
    }

    #[test]
    fn a_changed_byte_is_noticed(share in 0.0..1.0f64, flip in 1..=255u8) {
        let mut bytes = file();
        let n = (share * bytes.len() as f64) as usize;
        bytes[n] ^= flip;
        prop_assert!(decode(&bytes).is_err());
    }

    #[test]
    fn a_forged_file_is_refused_or_works(share in 0.0..1.0f64, value: u8, n in 1..16usize) {
        let mut bytes = file();
        let start = 12 + (share * (bytes.len() - 36) as f64) as usize;
        bytes[start..start + n].fill(value);
        rehash(&mut bytes);
        if let Ok((extension, network, surface)) = decode(&bytes) {
            let warp = Warp::from_parts(extension, network, surface);
            prop_assert_eq!(warp.apply(&probes()).len(), probes().len());
        }
    }
}
