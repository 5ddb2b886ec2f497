//! Which parts of the source have no counterpart on the target, seen from the initial shape.

use mesh_core::{
    Point3, Positions, TargetSurface, TriangleBvh, Triangulation, UnitFrame, VertexData, VertexId,
};

/// A vertex has no counterpart when it is this far from the target, and the way there and back ends this far from it,
/// in longest sides. Where shapes cover each other, the initial deformations of the test pairs come to 0.12 at most.
const FAR: f64 = 0.15;
/// From there the part spreads along the surface to where both are below this.
const NEAR: f64 = 0.04;

/// Marks the vertices of the mesh at `x` (in `frame`) that the target does not cover: shoulders over a bust that ends
/// at the neck.
///
/// A way to the closest point of the target and from there to the closest point of the mesh comes back near its start
/// where the shapes cover each other, and far from it where one ends: all places beyond lead to its last. Where what is
/// surely beyond makes up less than the share `least` of the area, nothing is marked.
pub(crate) fn uncovered(
    triangulation: &Triangulation,
    x: &Positions,
    target: &dyn TargetSurface,
    frame: &UnitFrame,
    least: f64,
) -> VertexData<bool> {
    let outside: Vec<Point3> = x.iter().map(|p| frame.from_unit(p)).collect();
    let there: Vec<Point3> = target
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
    let mut neighbours = VertexData::new(x.len(), Vec::new());
    for [a, b] in triangulation.edges() {
        neighbours[a].push(b);
        neighbours[b].push(a);
    }
    let mut stack: Vec<VertexId> = x
        .ids()
        .filter(|&v| !neighbours[v].is_empty() && missed(v, FAR))
        .collect();
    stack.iter().for_each(|&v| is_uncovered[v] = true);
    if area_share(triangulation, x, &is_uncovered) < least {
        return VertexData::new(x.len(), false);
    }
    while let Some(v) = stack.pop() {
        for &w in &neighbours[v] {
            if !is_uncovered[w] && missed(w, NEAR) {
                is_uncovered[w] = true;
                stack.push(w);
            }
        }
    }
    is_uncovered
}

/// Share of the surface area at `x` that belongs to the marked vertices.
pub(crate) fn area_share(
    triangulation: &Triangulation,
    x: &Positions,
    is_marked: &VertexData<bool>,
) -> f64 {
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
    fn what_the_target_lacks_is_marked_and_nothing_else() {
        let (mesh, rest) = bust(-9.0).into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &rest);
        let share = |floor: f64| {
            let target = TriangleSoup::new(bust(floor)).unwrap();
            let frame = UnitFrame::of(Aabb {
                min: Point3::new(-1.0, -2.0, -1.0),
                max: Point3::new(1.0, 2.0, 1.0),
            });
            let x = rest.map(|p| frame.to_unit(p));
            let marked = uncovered(&triangulation, &x, &target, &frame, 0.0);
            for v in x.ids().filter(|&v| marked[v]) {
                assert!(rest[v].y < floor, "{}", rest[v]);
            }
            area_share(&triangulation, &x, &marked)
        };
        assert_eq!(share(-9.0), 0.0);
        assert!(share(-0.8) > 0.1);
    }
}
