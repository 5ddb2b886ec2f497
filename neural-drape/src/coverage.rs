//! Which parts of either shape have no counterpart on the other, seen from the initial shape.

use mesh_core::{
    Point3, Positions, TargetSurface, TriangleBvh, Triangulation, UnitFrame, VertexData, VertexId,
};
use mesh_loss::{Beyond, Overlap};

use crate::config::OverlapMode;

/// Random places on each shape that tell how far it reaches beyond the other.
pub(crate) const N_BEYOND: usize = 4000;
/// A place counts as beyond when it is farther from the other's boundary than this share of the longest side.
pub(crate) const FAR_BEYOND: f64 = 0.03;
/// A shape of which less than this share lies beyond is taken as whole.
const LEAST_BEYOND: f64 = 0.05;

/// A vertex has no counterpart when it is this far from the target, and the way there and back ends this far from it,
/// in longest sides. Where shapes cover each other, the initial deformations of the test pairs come to 0.12 at most.
const FAR: f64 = 0.15;
/// From there the part spreads along the surface to where both are below this.
const NEAR: f64 = 0.04;

/// For this share of a run, a mesh that ends openly counts as reaching beyond the target where neither does: only pairs
/// that surely belong together lead it. Where the initial shape has a mouth that is closed and the target one that is
/// open, the lower lip is nearest to the upper one of the target, and the sheets behind lips are as near as the lips.
const CAUTIOUS: f64 = 0.25;
/// [`SamplingConfig::mutual`](mesh_loss::SamplingConfig::mutual) as long as that lasts.
const CAUTIOUS_MUTUAL: f64 = 0.4;
/// The same with a target that is only a part, from the start of the run to its end: a scale that is annealed.
const MUTUAL: [f64; 2] = [0.8, 0.45];

impl OverlapMode {
    /// Which parts beyond are left out.
    pub(crate) fn resolved(self, beyond: &Beyond) -> Overlap {
        let (target_exceeds, mesh_exceeds) = match self {
            OverlapMode::Auto => (
                beyond.of_target > LEAST_BEYOND,
                beyond.of_mesh > LEAST_BEYOND,
            ),
            OverlapMode::Full => (false, false),
            OverlapMode::SourcePartial => (true, false),
            OverlapMode::TargetPartial => (false, true),
            OverlapMode::BothPartial => (true, true),
        };
        Overlap {
            target_exceeds,
            mesh_exceeds,
        }
    }
}

/// Which pairs count in the course of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairing {
    /// Which parts beyond are left out.
    pub(crate) overlap: Overlap,
    n_cautious: usize,
}

impl Pairing {
    /// For a mesh that ends openly or not, and a run of `n_iterations`.
    pub(crate) fn new(
        mode: OverlapMode,
        beyond: &Beyond,
        ends_openly: bool,
        n_iterations: usize,
    ) -> Self {
        let overlap = mode.resolved(beyond);
        let is_cautious = mode == OverlapMode::Auto && ends_openly && overlap == Overlap::default();
        let share = if is_cautious { CAUTIOUS } else { 0.0 };
        Self {
            overlap,
            n_cautious: (share * n_iterations as f64) as usize,
        }
    }

    /// What the matcher leaves out in an iteration, and its `mutual`; `progress` through the run is 0..=1.
    pub(crate) fn at(&self, iteration: usize, progress: f64) -> (Overlap, f64) {
        if iteration < self.n_cautious {
            let overlap = Overlap {
                mesh_exceeds: true,
                ..self.overlap
            };
            (overlap, CAUTIOUS_MUTUAL)
        } else {
            let [start, end] = MUTUAL;
            (self.overlap, start + (end - start) * progress)
        }
    }
}

/// A target and the frame of the mesh that is draped over it.
#[derive(Clone, Copy)]
pub(crate) struct Target<'a> {
    pub(crate) surface: &'a dyn TargetSurface,
    pub(crate) frame: &'a UnitFrame,
}

/// Marks what the target does not cover, where the settings let parts be left out and it is enough; `beyond` counts it.
pub(crate) fn mark_uncovered(
    triangulation: &Triangulation,
    initial: &Positions,
    target: Target<'_>,
    mode: OverlapMode,
    beyond: &mut Beyond,
) -> VertexData<bool> {
    let nothing = VertexData::new(initial.len(), false);
    if matches!(mode, OverlapMode::Full | OverlapMode::SourcePartial) {
        return nothing;
    }
    let least = if mode == OverlapMode::Auto {
        LEAST_BEYOND
    } else {
        0.0
    };
    let is_uncovered = uncovered(triangulation, initial, target, least);
    let share = area_share(triangulation, initial, &is_uncovered);
    beyond.of_mesh = beyond.of_mesh.max(share);
    is_uncovered
}

/// Marks the vertices of the mesh at `x` (in `frame`) that the target does not cover: shoulders over a bust that ends
/// at the neck.
///
/// A way to the closest point of the target and from there to the closest point of the mesh comes back near its start
/// where the shapes cover each other, and far from it where one ends: all places beyond lead to its last. Where what is
/// surely beyond makes up less than the share `least` of the area, nothing is marked.
fn uncovered(
    triangulation: &Triangulation,
    x: &Positions,
    Target { surface, frame }: Target<'_>,
    least: f64,
) -> VertexData<bool> {
    let outside: Vec<Point3> = x.iter().map(|p| frame.from_unit(p)).collect();
    let there: Vec<Point3> = surface
        .closest_points(&outside)
        .iter()
        .map(|hit| frame.to_unit(&hit.point))
        .collect();
    let bvh = TriangleBvh::new(triangulation.corners(x).collect());
    let back = bvh.closest_points(&there);
    let missed = |v: VertexId, limit: f64| {
        let row = v.index();
        let is_far = (there[row] - x[v]).norm() > limit;
        is_far
            && back
                .get(row)
                .is_some_and(|b| (b.point - x[v]).norm() > limit)
    };

    let mut is_uncovered = VertexData::new(x.len(), false);
    let mut stack: Vec<VertexId> = x
        .ids()
        .filter(|&v| triangulation.is_used(v) && missed(v, FAR))
        .collect();
    stack.iter().for_each(|&v| is_uncovered[v] = true);
    if area_share(triangulation, x, &is_uncovered) < least {
        return VertexData::new(x.len(), false);
    }
    while let Some(v) = stack.pop() {
        for &w in triangulation.vertex_neighbours(v) {
            if !is_uncovered[w] && missed(w, NEAR) {
                is_uncovered[w] = true;
                stack.push(w);
            }
        }
    }
    is_uncovered
}

/// Share of the surface area at `x` that belongs to the marked vertices.
fn area_share(triangulation: &Triangulation, x: &Positions, is_marked: &VertexData<bool>) -> f64 {
    let (mut marked, mut total) = (0.0, 0.0);
    for (t, corners) in triangulation
        .triangles()
        .iter()
        .zip(triangulation.corners(x))
    {
        let area = mesh_core::measure::triangle_area(corners);
        let n_marked = t.iter().filter(|&&v| is_marked[v]).count();
        marked += area * n_marked as f64 / 3.0;
        total += area;
    }
    if total > 0.0 {
        marked / total
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_core::{shapes, Aabb, PolygonSoup, TriangleSoup};

    /// The quad sphere, twice as tall, of which the lowest part is cut away and closed flat in the second shape.
    fn bust(floor: f64) -> PolygonSoup {
        let mut soup = shapes::quad_sphere(12);
        for p in &mut soup.positions {
            *p = Point3::new(p.x, (2.0 * p.y).max(floor), p.z);
        }
        soup
    }

    #[test]
    fn open_meshes_are_paired_cautiously_at_first_unless_told() {
        let whole = Beyond {
            of_target: 0.0,
            of_mesh: 0.0,
        };
        let strict = |mode: OverlapMode, ends_openly: bool| {
            let pairing = Pairing::new(mode, &whole, ends_openly, 100);
            let is_strict = |i: &usize| pairing.at(*i, *i as f64 / 100.0).0.mesh_exceeds;
            (0..100).filter(is_strict).count()
        };
        assert_eq!(strict(OverlapMode::Auto, true), 25);
        assert_eq!(strict(OverlapMode::Auto, false), 0);
        assert_eq!(strict(OverlapMode::Full, true), 0);
        assert_eq!(strict(OverlapMode::TargetPartial, true), 100);

        let part = Pairing::new(OverlapMode::TargetPartial, &whole, true, 100);
        assert_eq!(part.at(0, 0.0).1, 0.8);
        assert!((part.at(100, 1.0).1 - 0.45).abs() < 1e-12);
    }

    #[test]
    fn what_the_target_does_not_cover_is_marked_and_nothing_else() {
        let (mesh, rest) = bust(-9.0).into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &rest);
        let share = |floor: f64| {
            let target = TriangleSoup::new(bust(floor)).unwrap();
            let frame = UnitFrame::of(Aabb {
                min: Point3::new(-1.0, -2.0, -1.0),
                max: Point3::new(1.0, 2.0, 1.0),
            });
            let x = rest.map(|p| frame.to_unit(p));
            let target = Target {
                surface: &target,
                frame: &frame,
            };
            let marked = uncovered(&triangulation, &x, target, 0.0);
            for v in x.ids().filter(|&v| marked[v]) {
                assert!(rest[v].y < floor, "{}", rest[v]);
            }
            area_share(&triangulation, &x, &marked)
        };
        assert_eq!(share(-9.0), 0.0);
        assert!(share(-0.8) > 0.1);
    }
}
