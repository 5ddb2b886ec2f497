//! Landmarks of the other half of a symmetric source.

use mesh_core::{Aabb, Curve, Landmark, MeshPoint, Point3, Positions, Vector3};
use mesh_init::point_pairs;
use nalgebra::{Matrix3, SymmetricEigen};

use super::Label;
use crate::{Pair, Similarity, Source, Target};

/// A source whose mirror image is farther from it, on the mean and in longest sides of its box, is not symmetric.
const SYMMETRIC: f64 = 0.01;
/// Places nearer to each other than this share of the longest side are one.
const SAME: f64 = 0.01;
/// Curves whose landmarks are all nearer to some of the other than this are one: a little more than they are apart along it.
const CURVE_SAME: f64 = 0.02;
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

/// The planes across which a source and its target are mirrored.
#[derive(Clone, Debug, PartialEq)]
pub struct MirrorPlanes {
    /// That of the source, in its coordinates.
    pub source: Plane,
    /// That of the target, in its coordinates.
    pub target: Plane,
}

/// How symmetric a shape is: the best of the planes through the middle of its box across an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetry {
    /// The axis across which the plane lies: 0, 1 or 2.
    pub axis: usize,
    /// The plane.
    pub plane: Plane,
    /// Mean distance of the mirror image from the shape, in longest sides of its box.
    pub misfit: f64,
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
    /// The plane through the middle of a box, across an axis.
    ///
    /// # Panics
    /// If `axis` is not 0, 1 or 2.
    pub fn through_middle(bounds: &Aabb, axis: usize) -> Self {
        let mut normal = Vector3::zeros();
        normal[axis] = 1.0;
        Self {
            normal,
            point: nalgebra::center(&bounds.min, &bounds.max),
        }
    }

    /// The mirror image of a point.
    pub fn mirror(&self, p: &Point3) -> Point3 {
        p - self.normal * (2.0 * self.normal.dot(&(p - self.point)))
    }
}

/// The plane across which a source is symmetric.
///
/// # Errors
/// A source that is not symmetric across the middle of its box.
pub(crate) fn symmetry_plane(source: &Source) -> Result<Plane, MirrorError> {
    let Symmetry { plane, misfit, .. } = source_symmetry(source);
    if misfit > SYMMETRIC {
        return Err(MirrorError::NotSymmetric { misfit });
    }
    Ok(plane)
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
    let plane = symmetry_plane(&pair.source)?;
    let side = pair.source.bounds().longest_side();
    let planes = MirrorPlanes {
        target: target_plane(pair, &plane, SAME * side),
        source: plane,
    };
    let mut added: Vec<Landmark> = Vec::new();
    for (k, l) in Landmark::marked(&pair.landmarks).enumerate() {
        let at = planes.source.mirror(&l.source.position(rest));
        let is_marked = |other: &Landmark| (other.source.position(rest) - at).norm() < SAME * side;
        if pair.landmarks.iter().chain(&added).any(is_marked) {
            continue;
        }
        let unnamed = || Some(format!("mirror of {}", Label::new(k, None)));
        added.extend(counterpart(pair, l, &planes).map(|twin| Landmark {
            name: twin.name.or_else(unnamed),
            ..twin
        }));
    }
    for (k, (curve, cut)) in Curve::runs(&pair.landmarks).enumerate() {
        let unnamed = || Some(format!("mirror of {}", Label::of_curve(k, None)));
        let twin = mirrored_curve(pair, curve, &planes).map(|twin| Curve {
            name: twin.name.or_else(unnamed),
            ..twin
        });
        // What cannot be cut has no way along the other half.
        let twin = twin.and_then(|twin| super::cut(twin, &pair.source).ok());
        let is_new = |twin: &Vec<Landmark>| {
            let is_there = |run: &[Landmark]| runs_along(twin, run, rest, CURVE_SAME * side);
            !is_there(cut) && !Curve::runs(&pair.landmarks).any(|(_, run)| is_there(run))
        };
        added.extend(twin.filter(is_new).unwrap_or_default());
    }
    Ok(Mirrored {
        added,
        plane: planes.source,
    })
}

/// The landmark of the other half: the mirror image on the source, and the place of the target's surface nearest to the
/// mirror image there. None for a landmark that lies on the source's plane.
///
/// ```
/// use mesh_core::{shapes, Landmark, VertexId};
/// use mesh_draping::landmarks::{counterpart, MirrorPlanes, Plane};
/// use mesh_draping::{Pair, Seams, Source, Target};
/// let soup = shapes::quad_sphere(4);
/// let pair = Pair {
///     source: Source::of_soup(soup.clone(), Seams::EXACT)?,
///     target: Target::of_soup(soup.clone())?,
///     landmarks: Vec::new(),
/// };
/// let plane = Plane::through_middle(&pair.source.bounds(), 0);
/// let planes = MirrorPlanes { source: plane.clone(), target: plane };
/// let left = Landmark { name: Some("left ear".to_owned()), ..Landmark::new(VertexId::new(0), soup.positions[0]) };
/// let right = counterpart(&pair, &left, &planes).expect("a corner is not on the plane");
/// assert_eq!(right.name.as_deref(), Some("right ear"));
/// assert!((right.target.x + left.target.x).abs() < 1e-12);
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub fn counterpart(pair: &Pair, landmark: &Landmark, planes: &MirrorPlanes) -> Option<Landmark> {
    let at = landmark.source.position(pair.source.rest());
    let image = planes.source.mirror(&at);
    if (image - at).norm() < SAME * pair.source.bounds().longest_side() {
        return None;
    }
    let target = planes.target.mirror(&landmark.target);
    Some(Landmark {
        name: landmark.name.as_deref().map(other_side),
        source: place(pair, &image)?,
        target: pair.target.judged().closest_point(&target).point,
        kind: landmark.kind,
        weight: landmark.weight,
        curve: None,
    })
}

/// The curve of the other half: the mirror images of its places, those on the target moved to its surface.
fn mirrored_curve(pair: &Pair, curve: &Curve, planes: &MirrorPlanes) -> Option<Curve> {
    let rest = pair.source.rest();
    let on_source = curve.source.iter().map(|at| {
        let image = planes.source.mirror(&at.position(rest));
        place(pair, &image)
    });
    let images = curve.target.iter().map(|p| planes.target.mirror(p));
    let on_target = pair
        .target
        .judged()
        .closest_points(&images.collect::<Vec<_>>());
    Some(Curve {
        name: curve.name.as_deref().map(other_side),
        source: on_source.collect::<Option<_>>()?,
        target: on_target.iter().map(|hit| hit.point).collect(),
        weight: curve.weight,
    })
}

/// Whether the landmarks of one curve all lie near to some of another, on the source.
fn runs_along(one: &[Landmark], other: &[Landmark], rest: &Positions, near: f64) -> bool {
    let there: Vec<Point3> = other.iter().map(|l| l.source.position(rest)).collect();
    one.iter().all(|l| {
        let at = l.source.position(rest);
        there.iter().any(|p| (p - at).norm() < near)
    })
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

/// How symmetric a source is.
pub fn source_symmetry(source: &Source) -> Symmetry {
    let bvh = source.bvh();
    symmetry(source.rest().as_slice(), &bvh.bounds(), |images| {
        let closest = bvh.closest_points(images);
        closest.iter().map(|c| c.distance_squared.sqrt()).sum()
    })
}

/// How symmetric a target is.
pub fn target_symmetry(target: &Target) -> Symmetry {
    let judged = target.judged();
    symmetry(&judged.vertices(), &judged.bounds(), |images| {
        let closest = judged.closest_points(images);
        closest.iter().map(|c| c.distance_squared.sqrt()).sum()
    })
}

/// The best of the planes through the middle of the box across an axis. `sum` adds up the distances of points from the
/// shape.
fn symmetry(points: &[Point3], bounds: &Aabb, sum: impl Fn(&[Point3]) -> f64) -> Symmetry {
    let step = points.len().div_ceil(N_PROBES).max(1);
    let across = |axis: usize| {
        let plane = Plane::through_middle(bounds, axis);
        let images = points.iter().step_by(step).map(|p| plane.mirror(p));
        let images: Vec<Point3> = images.collect();
        Symmetry {
            misfit: sum(&images) / images.len().max(1) as f64 / bounds.longest_side(),
            axis,
            plane,
        }
    };
    let better = |a: Symmetry, b: Symmetry| if b.misfit < a.misfit { b } else { a };
    better(better(across(0), across(1)), across(2))
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
    use crate::Seams;

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
        let Symmetry {
            axis,
            plane,
            misfit,
        } = source_symmetry(&source);
        assert_eq!((axis, plane.normal), (2, Vector3::z()));
        assert!(misfit < 1e-9 && (plane.point.z - 4.0).abs() < 1e-9);
    }

    #[test]
    fn a_target_is_as_symmetric_as_a_source_of_its_shape() {
        let mut soup = mesh_core::shapes::icosphere(2);
        for p in &mut soup.positions {
            *p = Point3::new(p.x * (1.5 + 0.5 * p.y), p.y * (1.0 + 0.2 * p.z), p.z);
        }
        let source = source_symmetry(&Source::of_soup(soup.clone(), Seams::EXACT).unwrap());
        let target = target_symmetry(&Target::of_soup(soup).unwrap());
        assert_eq!((source.axis, target.axis), (0, 0));
        assert!((source.misfit - target.misfit).abs() < 1e-12);
    }

    #[test]
    fn a_landmark_on_the_plane_has_no_counterpart() {
        let soup = mesh_core::shapes::icosphere(2);
        let pair = Pair {
            source: Source::of_soup(soup.clone(), Seams::EXACT).unwrap(),
            target: Target::of_soup(soup).unwrap(),
            landmarks: Vec::new(),
        };
        let plane = Plane::through_middle(&pair.source.bounds(), 0);
        let planes = MirrorPlanes {
            source: plane.clone(),
            target: plane,
        };
        for (x, is_mirrored) in [(0.004, false), (0.5, true)] {
            let point = Point3::new(x, 0.5, 0.5);
            let landmark = Landmark {
                source: pair.source.closest_place(&point).unwrap(),
                ..Landmark::new(mesh_core::VertexId::new(0), point)
            };
            let twin = counterpart(&pair, &landmark, &planes);
            assert_eq!(twin.is_some(), is_mirrored, "{x}");
        }
    }
}
