//! Normals of targets with defects, against those of the whole surface they were made from.

use std::path::PathBuf;

use mesh_core::sampling::SeededRng;
use mesh_core::{io, NormalSign, PointCloud, TargetSurface, TriangleSoup};

use crate::skipped::skip;

/// The folders of the pairs that have variants; none where the data is not there.
fn pairs() -> Vec<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data");
    let data = std::env::var_os("DRAPE_DATA").map_or_else(|| PathBuf::from(default), PathBuf::from);
    let pairs =
        ["horse_wolf", "face_augustus", "body_man_tpose"].map(|pair| data.join("pairs").join(pair));
    let found: Vec<PathBuf> = pairs.into_iter().filter(|p| p.is_dir()).collect();
    if found.is_empty() {
        skip(&format!("no data at {}; set DRAPE_DATA", data.display()));
    }
    found
}

/// Share of random places of `target` whose normal is on the side that the whole surface says.
fn share_on_right_side(target: &dyn TargetSurface, whole: &TriangleSoup) -> f64 {
    let samples = target.sample(2000, &mut SeededRng::new(1));
    let is_right = |s: &&mesh_core::SurfaceSample| {
        let expected = whole.normal(&whole.closest_point(&s.point).location);
        let found = target.normal(&s.location);
        found.zip(expected).is_some_and(|(a, b)| a.dot(&b) > 0.0)
    };
    samples.iter().filter(is_right).count() as f64 / samples.len() as f64
}

#[test]
fn soups_are_turned_outwards() {
    for pair in pairs() {
        let whole = TriangleSoup::new(io::read_soup(pair.join("target.obj")).unwrap()).unwrap();
        for (variant, least) in [("soup", 1.0), ("soup_cracked", 0.98)] {
            let soup = io::read_soup(pair.join(format!("variants/{variant}.ply"))).unwrap();
            let target = TriangleSoup::new(soup).unwrap();
            let share = share_on_right_side(&target, &whole);
            assert_eq!(
                target.normal_sign(),
                NormalSign::Oriented,
                "{pair:?} {variant}"
            );
            assert!(share >= least, "{pair:?} {variant}: {share}");
        }
    }
}

#[test]
fn clouds_that_claim_an_outside_have_it_right() {
    for pair in pairs() {
        let whole = TriangleSoup::new(io::read_soup(pair.join("target.obj")).unwrap()).unwrap();
        for variant in [
            "cloud",
            "cloud_normals",
            "cloud_uneven",
            "cloud_noisy",
            "partial_scan",
        ] {
            let set = io::read_points(pair.join(format!("variants/{variant}.ply"))).unwrap();
            let target = PointCloud::new(set.points, set.normals).unwrap();
            let share = share_on_right_side(&target, &whole);
            let least = match target.normal_sign() {
                NormalSign::Oriented => 0.97,
                NormalSign::Unoriented => 0.9,
            };
            assert!(share >= least, "{pair:?} {variant}: {share}");
            let is_whole = variant == "cloud" || variant == "cloud_normals";
            assert!(
                !is_whole || target.normal_sign() == NormalSign::Oriented,
                "{pair:?} {variant}"
            );
        }
    }
}
