//! Landmarks of the other half of a symmetric source.

use mesh_core::{Landmark, MeshPoint, Point3, Positions, TriangleBvh, Vector3};
use mesh_init::point_pairs;
use nalgebra::{Matrix3, SymmetricEigen};

use super::Label;
use crate::{Pair, Similarity};

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
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Its unit normal.
    pub normal: Vector3,
    /// A point of it.
    pub point: Point3,
}

/// Landmarks of the other half.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirrored {
    /// Those that were lacking.
    pub added: Vec<Landmark>,
    /// The source's plane of symmetry.
    pub plane: Plane,
}

/// Why landmarks cannot be mirrored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MirrorError {
    /// Too few to tell where the target's middle is.
    #[error("mirroring needs at least 3 landmarks: they tell where the target's middle is")]
    TooFew,
    /// The source's mirror image is far from it.
    #[error("the source is not symmetric: its best mirror image is {:.1} % of its longest side off on the mean", 100.0 * misfit)]
    NotSymmetric {
        /// How far, on the mean, in longest sides of its box.
        misfit: f64,
    },
}

impl Plane {
    fn mirror(&self, p: &Point3) -> Point3 {
        p - self.normal * (2.0 * self.normal.dot(&(p - self.point)))
    }
}

/// The landmarks that `pair` lacks on the other side, and the plane of the source.
///
/// Mirrored places are moved to the nearest place of the target's surface. Landmarks on the plane, or whose counterpart
/// is there already, give none.
///
/// # Errors
/// Fewer than three landmarks, or a source that is not symmetric across the middle of its box.
pub fn mirror(pair: &Pair) -> Result<Mirrored, MirrorError> {
    if pair.landmarks.len() < 3 {
        return Err(MirrorError::TooFew);
    }
    let rest = pair.source.rest();
    let (plane, misfit) = symmetry_plane(rest, pair.source.bvh());
    if misfit > SYMMETRIC {
        return Err(MirrorError::NotSymmetric { misfit });
    }
    let side = pair.source.bounds().longest_side();
    let target_plane = target_plane(pair, &plane, SAME * side);
    let mut added: Vec<Landmark> = Vec::new();
    for (k, l) in pair.landmarks.iter().enumerate() {
        let at = plane.mirror(&l.source.position(rest));
        let is_marked = |other: &Landmark| (other.source.position(rest) - at).norm() < SAME * side;
        if pair.landmarks.iter().chain(&added).any(is_marked) {
            continue;
        }
        let Some(source) = place(pair, &at) else {
            continue;
        };
        let target = target_plane.mirror(&l.target);
        added.push(Landmark {
            name: Some(match &l.name {
                Some(name) => other_side(name),
                None => format!("mirror of {}", Label::new(k, None)),
            }),
            source,
            target: pair.target.judged().closest_point(&target).point,
            kind: l.kind,
        });
    }
    Ok(Mirrored { added, plane })
}

/// The plane of the target: that of the landmarks on the source's plane where they span one, else the source's plane
/// under the similarity of all landmarks.
fn target_plane(pair: &Pair, plane: &Plane, near: f64) -> Plane {
    let pairs = point_pairs(&pair.landmarks, pair.source.rest());
    let map = Similarity::fit(&pairs);
    let turned = map.turn * plane.normal;
    let on_plane: Vec<Vector3> = pairs
        .iter()
        .filter(|p| plane.normal.dot(&(p.source - plane.point)).abs() < near)
        .map(|p| p.target.coords)
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
        };
    }
    Plane {
        normal: turned,
        point: map.apply(&plane.point),
    }
}

/// A vertex where one is near, else the place in a face.
fn place(pair: &Pair, at: &Point3) -> Option<MeshPoint> {
    let place = pair.source.closest_place(at)?;
    let vertex = place.main_vertex();
    let rest = pair.source.rest();
    let side = pair.source.bounds().longest_side();
    if (rest[vertex] - place.position(rest)).norm() < 0.1 * SAME * side {
        return Some(MeshPoint::vertex(vertex));
    }
    Some(place)
}

/// The best of the planes through the middle of the box across an axis, and the mean distance of the mirror image from
/// the shape, in longest sides of its box.
fn symmetry_plane(rest: &Positions, bvh: &TriangleBvh) -> (Plane, f64) {
    let bounds = bvh.bounds();
    let middle = nalgebra::center(&bounds.min, &bounds.max);
    let step = rest.len().div_ceil(N_PROBES).max(1);
    let [a, b, c] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|normal| {
        let plane = Plane {
            normal,
            point: middle,
        };
        let mirrored: Vec<Point3> = rest.iter().step_by(step).map(|p| plane.mirror(p)).collect();
        let sum: f64 = bvh
            .closest_points(&mirrored)
            .iter()
            .map(|c| c.distance_squared.sqrt())
            .sum();
        let misfit = sum / mirrored.len().max(1) as f64 / bounds.longest_side();
        (plane, misfit)
    });
    let better = |a: (Plane, f64), b: (Plane, f64)| if b.1 < a.1 { b } else { a };
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
    use crate::{Seams, Source};

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
        let source = Source::of_soup(soup, Seams::EXACT).unwrap();
        let (plane, misfit) = symmetry_plane(source.rest(), source.bvh());
        assert_eq!(plane.normal, Vector3::z());
        assert!(misfit < 1e-9 && (plane.point.z - 4.0).abs() < 1e-9);
    }
}
