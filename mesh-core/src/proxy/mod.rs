//! A coarse stand-in for a dense mesh, and the way back.

mod collapse;

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::bvh::closest_point_on_triangle;
use crate::{
    nearest_rotation, MeshPoint, Point3, PolygonSoup, Positions, Rows, Triangulation, Vector3,
    VertexData, VertexId,
};
use collapse::Collapse;

/// A mesh of some of the vertices of a dense mesh, which carries the others along: what is slow on the dense mesh is
/// done on this one.
///
/// Edges collapse onto one of their ends, the least harmful first, so that the vertices that are left are where they
/// were; the surface keeps its pieces, its boundary and its topology. Every vertex of the dense mesh is bound to the
/// triangle of the stand-in that is closest to it, among those around the vertex onto which it collapsed: never to a
/// surface that merely comes near, as a lip does to the other.
///
/// Source: Garland and Heckbert 1997 (quadrics), Sumner et al. 2007 (frames that carry what is around them).
#[derive(Clone, Debug)]
pub struct Proxy {
    soup: PolygonSoup,
    vertices: Vec<VertexId>,
    row_of: Vec<Option<u32>>,
    bindings: Vec<Binding>,
}

/// Which vertices of the stand-in carry a vertex, and how much each counts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Binding {
    rows: [u32; 3],
    weights: [f64; 3],
}

impl Proxy {
    /// A stand-in of about `n` vertices for the mesh at `rest`, with all those of `kept` among them.
    pub fn new(
        triangulation: &Triangulation,
        rest: &Positions,
        n: usize,
        kept: &[VertexId],
    ) -> Self {
        let mut is_kept = vec![false; rest.len()];
        kept.iter().for_each(|v| is_kept[v.index()] = true);
        let mut collapse = Collapse::new(rest.as_slice(), &triangulation.rows(), is_kept);
        collapse.run(n);
        let left = collapse.triangles();
        let ends = collapse.ends();

        let mut row_of = vec![None; rest.len()];
        let mut vertices: Vec<u32> = left.iter().flatten().copied().collect();
        vertices.extend(kept.iter().map(|v| v.index() as u32));
        vertices.sort_unstable();
        vertices.dedup();
        for (row, &v) in vertices.iter().enumerate() {
            row_of[v as usize] = Some(row as u32);
        }
        let rows: Vec<[u32; 3]> = left
            .iter()
            .map(|t| t.map(|v| row_of[v as usize].unwrap_or_default()))
            .collect();
        let soup = PolygonSoup {
            positions: vertices
                .iter()
                .map(|&v| rest.as_slice()[v as usize])
                .collect(),
            faces: rows.iter().map(|t| t.to_vec()).collect(),
        };
        Self {
            bindings: bindings(rest, &ends, &row_of, &soup.positions, &rows),
            vertices: vertices
                .iter()
                .map(|&v| VertexId::new(v as usize))
                .collect(),
            row_of,
            soup,
        }
    }

    /// Its triangles, and where its vertices are at rest.
    pub fn soup(&self) -> &PolygonSoup {
        &self.soup
    }

    /// The vertex of the dense mesh that each of its vertices is.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// Which of its vertices a vertex of the dense mesh is, if it is one.
    pub fn row_of(&self, v: VertexId) -> Option<VertexId> {
        self.row_of[v.index()].map(|row| VertexId::new(row as usize))
    }

    /// The place of the stand-in, in its rows, that carries a vertex of the dense mesh.
    pub fn place_of(&self, v: VertexId) -> MeshPoint {
        let Binding { rows, weights } = self.bindings[v.index()];
        MeshPoint::barycentric(rows.map(|row| VertexId::new(row as usize)), weights)
    }

    /// Where the vertices of the dense mesh go from `rest` when those of the stand-in go to `x`.
    ///
    /// `xᵥ = Σₖ wₖ (xₖ + Fₖ (rᵥ − rₖ))`, with the turn and scale F that carries the one-ring of a vertex of the stand-in
    /// best from where `rest` has it to where it is. Vertices of the stand-in are where `x` has them, to the bit. Any
    /// shape of the dense mesh may stand for its rest.
    ///
    /// # Panics
    /// If there is not one position for each vertex of the stand-in, or `rest` is not one of the dense mesh.
    pub fn carry(&self, rest: &Positions, x: &Positions) -> Positions {
        assert_eq!(x.len(), self.vertices.len(), "one position for each vertex");
        assert_eq!(rest.len(), self.bindings.len(), "a shape of the dense mesh");
        let x = x.as_slice();
        let before: Vec<Point3> = self.vertices.iter().map(|&v| rest[v]).collect();
        let frames = self.frames(&before, x);
        let carried = |(r, binding): (&Point3, &Binding)| {
            let terms = binding
                .rows
                .iter()
                .zip(binding.weights)
                .filter(|(_, w)| *w != 0.0);
            let sum = terms.fold(Vector3::zeros(), |sum, (&row, weight)| {
                let row = row as usize;
                sum + (x[row].coords + frames[row] * (r - before[row])) * weight
            });
            Point3::from(sum)
        };
        let all = rest.as_slice().par_iter().zip(&self.bindings).map(carried);
        VertexData::from(all.collect::<Vec<_>>())
    }

    /// Turn and scale of the one-ring of each vertex.
    fn frames(&self, rest: &[Point3], x: &[Point3]) -> Vec<Matrix3<f64>> {
        let mut covariances = vec![Matrix3::zeros(); rest.len()];
        let mut squares = vec![0.0; rest.len()];
        for face in &self.soup.faces {
            for k in 0..face.len() {
                let (i, j) = (face[k] as usize, face[(k + 1) % face.len()] as usize);
                let (e, r) = (x[j] - x[i], rest[j] - rest[i]);
                for v in [i, j] {
                    covariances[v] += e * r.transpose();
                    squares[v] += r.norm_squared();
                }
            }
        }
        let frame = |(c, square): (&Matrix3<f64>, &f64)| {
            let rotation = nearest_rotation(c);
            let scale = rotation.dot(c) / square;
            rotation * if scale.is_finite() { scale } else { 1.0 }
        };
        covariances.iter().zip(&squares).map(frame).collect()
    }
}

/// The closest place of the triangles around the end of each vertex and around its neighbours.
fn bindings(
    rest: &Positions,
    ends: &[u32],
    row_of: &[Option<u32>],
    points: &[Point3],
    triangles: &[[u32; 3]],
) -> Vec<Binding> {
    let corners = (0u32..).zip(triangles);
    let corners = corners.flat_map(|(t, rows)| rows.map(|v| (v as usize, t)));
    let around = Rows::from_pairs(points.len(), corners);
    let near = Rows::from_lists(around.iter().map(|fan| {
        let ring = fan.iter().flat_map(|&t| triangles[t as usize]);
        let mut near: Vec<u32> = ring.flat_map(|v| &around[v as usize]).copied().collect();
        near.sort_unstable();
        near.dedup();
        near
    }));
    let nearest_vertex = |p: &Point3| {
        let squared = |row: &usize| (points[*row] - p).norm_squared();
        (0..points.len()).min_by(|a, b| squared(a).total_cmp(&squared(b)))
    };
    let bind = |(v, p): (usize, &Point3)| {
        // A vertex without a triangle has no end in the stand-in: it goes with the nearest of its vertices.
        let end = row_of[ends[v] as usize].or_else(|| nearest_vertex(p).map(|row| row as u32));
        let alone = Binding {
            rows: [end.unwrap_or_default(); 3],
            weights: [1.0, 0.0, 0.0],
        };
        if row_of[v].is_some() {
            return alone;
        }
        let candidates = end.map_or(&[][..], |end| &near[end as usize]);
        let places = candidates.iter().map(|&t| {
            let rows = triangles[t as usize];
            let at = closest_point_on_triangle(p, &rows.map(|row| points[row as usize]));
            (at.distance_squared, rows, at.barycentric)
        });
        let best = places.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(alone, |(_, rows, weights)| Binding { rows, weights })
    };
    rest.as_slice().par_iter().enumerate().map(bind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn mesh(soup: PolygonSoup) -> (Triangulation, Positions) {
        let (mesh, rest) = soup.into_halfedge().unwrap();
        (Triangulation::new(&mesh, &rest), rest)
    }

    #[test]
    fn a_sphere_keeps_its_shape_its_genus_and_what_must_stay() {
        let (triangulation, rest) = mesh(shapes::quad_sphere(24));
        let kept = [VertexId::new(7), VertexId::new(2000)];
        let proxy = Proxy::new(&triangulation, &rest, 300, &kept);
        assert_eq!(proxy.vertices().len(), 300);
        for v in kept {
            let row = proxy.row_of(v).unwrap();
            assert_eq!(proxy.soup().positions[row.index()], rest[v]);
        }
        let (coarse, x) = mesh(proxy.soup().clone());
        assert_eq!(x.len() + coarse.len() - coarse.edges().len(), 2);
        assert_eq!(coarse.interior_edges().count(), coarse.edges().len());
        let area: f64 = crate::measure::triangle_areas(&coarse, &x).iter().sum();
        assert!(
            (area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.05,
            "{area}"
        );
    }

    #[test]
    fn similarities_are_carried_exactly() {
        for soup in [shapes::quad_sphere(12), shapes::open_grid(20, 20)] {
            let (triangulation, rest) = mesh(soup);
            let proxy = Proxy::new(&triangulation, &rest, 80, &[]);
            let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.0, 2.0);
            let moved = |p: &Point3| turn * p * 1.7 + Vector3::new(1.0, 2.0, 3.0);
            let x: Positions = proxy.soup().positions.iter().map(moved).collect();
            let carried = proxy.carry(&rest, &x);
            for (p, r) in carried.iter().zip(&rest) {
                assert!((p - moved(r)).norm() < 1e-9, "{p} {r}");
            }
        }
    }

    #[test]
    fn an_open_mesh_keeps_its_boundary_and_loose_vertices_come_along() {
        let mut soup = shapes::open_grid(20, 20);
        soup.positions.push(Point3::new(5.0, 5.0, 5.0));
        let (triangulation, rest) = mesh(soup);
        let proxy = Proxy::new(&triangulation, &rest, 60, &[]);
        let (coarse, x) = mesh(proxy.soup().clone());
        let area = |t: &Triangulation, x: &Positions| -> f64 {
            crate::measure::triangle_areas(t, x).iter().sum()
        };
        assert!((area(&coarse, &x) / area(&triangulation, &rest) - 1.0).abs() < 0.05);
        let carried = proxy.carry(&rest, &proxy.soup().positions.iter().copied().collect());
        assert!(carried
            .iter()
            .zip(&rest)
            .all(|(p, r)| (p - r).norm() < 1e-9));
    }
}
