//! Curves of the other half of a symmetric source.

use mesh_core::{Curve, Landmark, Point3, Positions};

use super::mirror::{other_side, place};
use super::{cut, MirrorPlanes};
use crate::Pair;

/// Curves whose landmarks are all nearer to some of the other than this are one, in longest sides: a little more than they are
/// apart along it.
const SAME: f64 = 0.02;

/// The mirror images of the places of a curve: those on the source moved to its surface, those on the target to its surface.
/// A line without places, of a curve that is being drawn, has none. None for a source without triangles.
pub fn curve_image(pair: &Pair, curve: &Curve, planes: &MirrorPlanes) -> Option<Curve> {
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

/// The curve of the other half: [`curve_image()`], unless it cannot be cut, or runs along the curve itself, as one across the
/// middle does, or along a curve that the pair has already.
///
/// ```
/// use mesh_core::{shapes, Curve, MeshPoint, Point3, VertexId};
/// use mesh_draping::landmarks::{curve_counterpart, MirrorPlanes, Plane};
/// use mesh_draping::{Pair, Seams, Source, Target};
/// let soup = shapes::open_grid(10, 10);
/// let pair = Pair {
///     source: Source::of_soup(soup.clone(), Seams::EXACT)?,
///     target: Target::of_soup(soup)?,
///     landmarks: Vec::new(),
/// };
/// let plane = Plane::through_middle(&pair.source.bounds(), 0);
/// let planes = MirrorPlanes { source: plane.clone(), target: plane };
/// let hem = |rows: [usize; 2]| Curve {
///     name: Some("left hem".to_owned()),
///     source: rows.map(|v| MeshPoint::vertex(VertexId::new(v))).to_vec(),
///     target: rows.map(|v| Point3::new((v % 11) as f64, (v / 11) as f64, 0.0)).to_vec(),
///     weight: 1.0,
/// };
/// let twin = curve_counterpart(&pair, &hem([0, 110]), &planes).expect("the other side");
/// assert_eq!((twin.name.as_deref(), twin.target[1]), (Some("right hem"), Point3::new(10.0, 10.0, 0.0)));
/// assert!(curve_counterpart(&pair, &hem([0, 10]), &planes).is_none());
/// # Ok::<(), mesh_draping::Error>(())
/// ```
pub fn curve_counterpart(pair: &Pair, curve: &Curve, planes: &MirrorPlanes) -> Option<Curve> {
    let twin = curve_image(pair, curve, planes)?;
    let (own, other) = (
        cut(curve.clone(), &pair.source).ok()?,
        cut(twin.clone(), &pair.source).ok()?,
    );
    let (rest, near) = (
        pair.source.rest(),
        SAME * pair.source.bounds().longest_side(),
    );
    let mut known = Curve::runs(&pair.landmarks).map(|(_, run)| run);
    let is_there = |run: &[Landmark]| runs_along(&other, run, rest, near);
    (!is_there(&own) && !known.any(is_there)).then_some(twin)
}

/// Whether the landmarks of one curve all lie near to some of another, on the source.
fn runs_along(one: &[Landmark], other: &[Landmark], rest: &Positions, near: f64) -> bool {
    let there: Vec<Point3> = other.iter().map(|l| l.source.position(rest)).collect();
    one.iter().all(|l| {
        let at = l.source.position(rest);
        there.iter().any(|p| (p - at).norm() < near)
    })
}
