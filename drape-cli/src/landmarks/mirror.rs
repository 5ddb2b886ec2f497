//! Landmarks of the other half of a symmetric source.

use anyhow::ensure;
use mesh_core::{Aabb, Landmark, MeshPoint, Point3, Positions, TriangleBvh, Vector3};
use nalgebra::{Matrix3, SymmetricEigen};

use super::file::label;
use crate::input::Pair;
use crate::similarity::{fit, Match};

/// A source whose mirror image is farther from it, on the mean and in longest sides of its box, is not symmetric.
const SYMMETRIC: f64 = 0.01;
/// Places nearer to each other than this share of the longest side are one.
const SAME: f64 = 0.01;
/// Places that spread less across their line than this share of the spread along it, squared, span no plane.
const SPANNED: f64 = 0.01;
/// A plane through landmarks is believed if its normal is this near to where the similarity takes the source's.
const ALIKE: f64 = 0.8;
/// Vertices that the symmetry is measured at.
const N_PROBES: usize = 2000;

/// A plane of symmetry.
pub(crate) struct Plane {
    pub(crate) normal: Vector3,
    pub(crate) point: Point3,
    /// Mean distance of the mirror image from the shape, in longest sides of its box.
    pub(crate) misfit: f64,
}

impl Plane {
    fn mirror(&self, p: &Point3) -> Point3 {
        p - self.normal * (2.0 * self.normal.dot(&(p - self.point)))
    }
}

/// The landmarks that `pair` lacks on the other side, and the plane of the source.
///
/// Mirrored places are moved to the nearest place of the target's surface. Landmarks on the plane, or whose counterpart is there already, give none.
pub(crate) fn mirror(pair: &Pair) -> anyhow::Result<(Vec<Landmark>, Plane)> {
    ensure!(
        pair.landmarks.len() >= 3,
        "mirroring needs at least 3 landmarks: they tell where the target's middle is"
    );
    let rest = &pair.source.rest;
    let bvh = TriangleBvh::new(pair.source.triangulation.corners(rest).collect());
    let plane = symmetry_plane(rest, &bvh);
    ensure!(
        plane.misfit <= SYMMETRIC,
        "the source is not symmetric: its best mirror image is {:.1} % of its longest side off on the mean",
        100.0 * plane.misfit
    );
    let side = Aabb::of(rest.iter()).longest_side();
    let target_plane = target_plane(pair, &plane, SAME * side);
    let mut added: Vec<Landmark> = Vec::new();
    for (k, l) in pair.landmarks.iter().enumerate() {
        let at = plane.mirror(&l.source.position(rest));
        let is_marked = |other: &Landmark| (other.source.position(rest) - at).norm() < SAME * side;
        if pair.landmarks.iter().chain(&added).any(is_marked) {
            continue;
        }
        let target = target_plane.mirror(&l.target);
        added.push(Landmark {
            name: Some(match &l.name {
                Some(name) => other_side(name),
                None => format!("mirror of {}", label(k, None)),
            }),
            source: place(pair, &at)?,
            target: pair.target.surface.closest_point(&target).point,
            kind: l.kind,
        });
    }
    Ok((added, plane))
}

/// The plane of the target: that of the landmarks on the source's plane where they span one, else the source's plane
/// carried by the similarity of all landmarks.
fn target_plane(pair: &Pair, plane: &Plane, near: f64) -> Plane {
    let rest = &pair.source.rest;
    let matches: Vec<Match> = pair
        .landmarks
        .iter()
        .map(|l| Match {
            from: l.source.position(rest),
            to: l.target,
        })
        .collect();
    let map = fit(&matches);
    let turned = map.turn * plane.normal;
    let on_plane: Vec<Vector3> = matches
        .iter()
        .filter(|m| plane.normal.dot(&(m.from - plane.point)).abs() < near)
        .map(|m| m.to.coords)
        .collect();
    let mean = on_plane.iter().sum::<Vector3>() / on_plane.len().max(1) as f64;
    let spread: Matrix3<f64> = on_plane
        .iter()
        .map(|p| (p - mean) * (p - mean).transpose())
        .sum();
    let eigen = SymmetricEigen::new(spread);
    let least = eigen.eigenvalues.imin();
    let normal = eigen.eigenvectors.column(least).into_owned();
    let mut sorted: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let is_plane = on_plane.len() >= 3 && sorted[1] > SPANNED * sorted[2];
    if is_plane && normal.dot(&turned).abs() > ALIKE {
        return Plane {
            normal,
            point: mean.into(),
            misfit: 0.0,
        };
    }
    Plane {
        normal: turned,
        point: map.apply(&plane.point),
        misfit: 0.0,
    }
}

/// A vertex where one is near, else the place in a face.
fn place(pair: &Pair, at: &Point3) -> anyhow::Result<MeshPoint> {
    let place = pair.source.closest_place(at, None)?;
    let vertex = place.main_vertex();
    let rest = &pair.source.rest;
    let side = Aabb::of(rest.iter()).longest_side();
    if (rest[vertex] - place.position(rest)).norm() < 0.1 * SAME * side {
        return Ok(MeshPoint::vertex(vertex));
    }
    Ok(place)
}

/// The best of the planes through the middle of the box across an axis.
fn symmetry_plane(rest: &Positions, bvh: &TriangleBvh) -> Plane {
    let bounds = bvh.bounds();
    let middle = nalgebra::center(&bounds.min, &bounds.max);
    let step = rest.len().div_ceil(N_PROBES).max(1);
    let planes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|normal| {
        let mut plane = Plane {
            normal,
            point: middle,
            misfit: 0.0,
        };
        let mirrored: Vec<Point3> = rest.iter().step_by(step).map(|p| plane.mirror(p)).collect();
        let sum: f64 = bvh
            .closest_points(&mirrored)
            .iter()
            .map(|c| c.distance_squared.sqrt())
            .sum();
        plane.misfit = sum / mirrored.len().max(1) as f64 / bounds.longest_side();
        plane
    });
    let [a, b, c] = planes;
    let better = |a: Plane, b: Plane| if b.misfit < a.misfit { b } else { a };
    better(better(a, b), c)
}

/// `left ear` for `right ear`, `ear_L` for `ear_R`.
fn other_side(name: &str) -> String {
    const PAIRS: [(&str, &str); 3] = [("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT")];
    for (a, b) in PAIRS {
        if name.contains(a) {
            return name.replace(a, b);
        }
        if name.contains(b) {
            return name.replace(b, a);
        }
    }
    let swapped: Vec<String> = name
        .split_inclusive(['_', '.', ' ', '-'])
        .map(|part| {
            let word = part.trim_end_matches(['_', '.', ' ', '-']);
            let other = match word {
                "l" => "r",
                "r" => "l",
                "L" => "R",
                "R" => "L",
                _ => return part.to_owned(),
            };
            format!("{other}{}", &part[word.len()..])
        })
        .collect();
    let swapped = swapped.concat();
    if swapped == name {
        format!("{name} (mirrored)")
    } else {
        swapped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_change_sides() {
        assert_eq!(other_side("left ear"), "right ear");
        assert_eq!(other_side("RightHand"), "LeftHand");
        assert_eq!(other_side("ear_L"), "ear_R");
        assert_eq!(other_side("l.eye"), "r.eye");
        assert_eq!(other_side("tail"), "tail (mirrored)");
    }

    #[test]
    fn a_plane_is_found_through_the_middle() {
        let mut soup = mesh_core::shapes::quad_sphere(4);
        for p in &mut soup.positions {
            *p = Point3::new(p.x * (1.5 + 0.5 * p.y), p.y, p.z * (1.0 + 0.3 * p.x) + 4.0);
        }
        let source = crate::input::Source::new(soup, crate::seams::Seams::EXACT).unwrap();
        let bvh = TriangleBvh::new(source.triangulation.corners(&source.rest).collect());
        let plane = symmetry_plane(&source.rest, &bvh);
        assert_eq!(plane.normal, Vector3::z());
        assert!(plane.misfit < 1e-9 && (plane.point.z - 4.0).abs() < 1e-9);
    }
}
