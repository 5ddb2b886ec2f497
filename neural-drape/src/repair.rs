//! The last stage: no new fold, no new skinny triangle.

use mesh_core::measure::{triangle_normal, triangle_quality};
use mesh_core::{Aabb, Positions, Triangulation, TriangulationEdge, Vector3, VertexData, VertexId};
use mesh_loss::LocalShape;

/// An edge is folded when the normals of its triangles have a dot product below this.
const FOLD_COSINE: f64 = -0.5;
/// A triangle with Q_f (Eq. 4) below this is skinny.
const SKINNY_QUALITY: f64 = 0.1;
/// A patch grows up to this many rings around what is broken.
const MAX_RINGS: usize = 8;
/// Each size of a patch is relaxed at most this often.
const SWEEPS: usize = 40;
/// A patch is left as it was if mending it would move a vertex farther than this share of the longest side.
const MAX_MOTION: f64 = 0.03;

/// A result without what the drape broke, as far as that is possible.
#[derive(Clone, Debug, PartialEq)]
pub struct Repair {
    /// Where the vertices are, in the coordinates of the input.
    pub positions: Positions,
    /// What was broken before.
    pub before: Defects,
    /// What is still broken.
    pub left: Defects,
}

/// What is broken in a mesh that was not at rest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Defects {
    /// Ends of the edges whose triangles turn against each other, n₁·n₂ < −0.5.
    pub folds: Vec<[VertexId; 2]>,
    /// Rows of the triangles with Q_f < 0.1.
    pub skinny: Vec<usize>,
}

impl Defects {
    /// Whether nothing is broken.
    pub fn is_empty(&self) -> bool {
        self.folds.is_empty() && self.skinny.is_empty()
    }
}

/// Relaxes small patches around new folds and new skinny triangles towards the shape they had at rest, turned and
/// scaled, with their surroundings held ([`LocalShape::relax`]); a patch grows until nothing in it is broken.
///
/// A patch that does not get better by a small motion stays as it was. All else stays, to the bit.
///
/// The vertices of `held`, such as those of landmarks, stay where they are.
pub fn repair(
    triangulation: &Triangulation,
    rest: &Positions,
    x: &Positions,
    held: &[VertexId],
) -> Repair {
    let judge = Judge::new(triangulation, rest);
    let before = judge.defects(x);
    let mut positions = x.clone();
    let mut broken = judge.broken_vertices(x);
    if !broken.is_empty() {
        let shape = LocalShape::new(triangulation, rest);
        let neighbours = triangulation.neighbours(x.len());
        let is_broken = |v: VertexId| broken.binary_search(&v).is_ok();
        let patches = triangulation.connected_groups(x.len(), is_broken);
        let reach = MAX_MOTION * Aabb::of(x).longest_side();
        for patch in patches {
            let mended = (0..=MAX_RINGS).find_map(|rings| {
                let mut free = grown(&neighbours, &patch, rings);
                free.retain(|v| !held.contains(v));
                let mut candidate = positions.clone();
                (0..SWEEPS).find_map(|_| {
                    shape.relax(&mut candidate, &free);
                    let left = judge.broken_vertices(&candidate);
                    is_mended(&left, &broken, &patch).then(|| (candidate.clone(), left))
                })
            });
            let is_small = |moved: &Positions| farthest_motion(&positions, moved) <= reach;
            if let Some((candidate, left)) = mended.filter(|(moved, _)| is_small(moved)) {
                (positions, broken) = (candidate, left);
            }
        }
    }
    Repair {
        left: judge.defects(&positions),
        before,
        positions,
    }
}

/// How far the vertex that moved farthest went.
fn farthest_motion(from: &Positions, to: &Positions) -> f64 {
    from.iter()
        .zip(to)
        .map(|(p, q)| (q - p).norm())
        .fold(0.0, f64::max)
}

/// What is broken at `x` that was not at rest.
pub(crate) fn defects(triangulation: &Triangulation, rest: &Positions, x: &Positions) -> Defects {
    Judge::new(triangulation, rest).defects(x)
}

/// Nothing in the patch is broken any more, and nothing else is that was not.
fn is_mended(left: &[VertexId], broken: &[VertexId], patch: &[VertexId]) -> bool {
    left.iter()
        .all(|v| !patch.contains(v) && broken.contains(v))
}

/// Tells what is broken that was not at rest.
struct Judge<'a> {
    triangulation: &'a Triangulation,
    rest: &'a Positions,
    /// Those that are not folded at rest.
    edges: Vec<TriangulationEdge>,
}

impl<'a> Judge<'a> {
    fn new(triangulation: &'a Triangulation, rest: &'a Positions) -> Self {
        let normals = normals(triangulation, rest);
        let mut edges = triangulation.interior_edges();
        edges.retain(|e| !is_folded(e, &normals));
        Self {
            triangulation,
            rest,
            edges,
        }
    }

    fn defects(&self, x: &Positions) -> Defects {
        Defects {
            folds: self.folds(x).map(|e| e.vertices).collect(),
            skinny: self.skinny(x),
        }
    }

    /// Corners of all that is broken, in order.
    fn broken_vertices(&self, x: &Positions) -> Vec<VertexId> {
        let rows = self
            .folds(x)
            .flat_map(|e| e.triangles)
            .chain(self.skinny(x));
        let triangles = self.triangulation.triangles();
        let mut vertices: Vec<VertexId> = rows.flat_map(|t| triangles[t]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    fn folds(&self, x: &Positions) -> impl Iterator<Item = &TriangulationEdge> {
        let normals = normals(self.triangulation, x);
        self.edges.iter().filter(move |e| is_folded(e, &normals))
    }

    fn skinny(&self, x: &Positions) -> Vec<usize> {
        let [before, after] = [self.rest, x].map(|x| self.triangulation.corners(x));
        let is_skinny = |corners| triangle_quality(corners) < SKINNY_QUALITY;
        before
            .zip(after)
            .enumerate()
            .filter(|&(_, (before, after))| is_skinny(after) && !is_skinny(before))
            .map(|(t, _)| t)
            .collect()
    }
}

fn normals(triangulation: &Triangulation, x: &Positions) -> Vec<Vector3> {
    triangulation
        .corners(x)
        .map(|corners| triangle_normal(corners).unwrap_or_default())
        .collect()
}

fn is_folded(edge: &TriangulationEdge, normals: &[Vector3]) -> bool {
    let [one, two] = edge.triangles.map(|t| normals[t]);
    one.dot(&two) < FOLD_COSINE
}

/// The vertices within `rings` edges of `patch`, in order.
fn grown(
    neighbours: &VertexData<Vec<VertexId>>,
    patch: &[VertexId],
    rings: usize,
) -> Vec<VertexId> {
    let mut grown = patch.to_vec();
    for _ in 0..rings {
        let around: Vec<VertexId> = grown
            .iter()
            .flat_map(|&v| &neighbours[v])
            .copied()
            .collect();
        grown.extend(around);
        grown.sort_unstable();
        grown.dedup();
    }
    grown
}

#[cfg(test)]
mod tests {
    use mesh_core::shapes;

    use super::*;

    fn sphere(n: usize) -> (Triangulation, Positions) {
        let (mesh, rest) = shapes::quad_sphere(n).into_halfedge().unwrap();
        (Triangulation::new(&mesh, &rest), rest)
    }

    #[test]
    fn a_shape_without_defects_stays_to_the_bit() {
        let (triangulation, rest) = sphere(8);
        let x = rest.map(|p| p * 3.0);
        let repair = repair(&triangulation, &rest, &x, &[]);
        assert_eq!(repair.positions, x);
        assert!(repair.before.is_empty() && repair.left.is_empty());
    }

    #[test]
    fn a_vertex_thrown_over_its_neighbours_comes_back() {
        let (triangulation, rest) = sphere(48);
        let mut x = rest.map(|p| p * 2.0);
        let (v, w) = (VertexId::new(1040), VertexId::new(5200));
        let [a, b] = [v, w].map(|v| triangulation.edges().iter().find(|e| e[0] == v).unwrap()[1]);
        x[v] = x[v] + (x[a] - x[v]) * 1.6;
        x[w] = x[w] + (x[b] - x[w]) * 1.6;
        let repair = repair(&triangulation, &rest, &x, &[]);
        assert!(!repair.before.is_empty());
        assert!(repair.left.is_empty(), "{:?}", repair.left);
        let true_place = rest.map(|p| p * 2.0);
        // It moves no farther than it must, so it comes back only part of the way.
        let thrown = (x[v] - true_place[v]).norm();
        let after = (repair.positions[v] - true_place[v]).norm();
        assert!(after < 0.7 * thrown, "{after} of {thrown}");
        let moved = (0..x.len()).filter(|&i| repair.positions.as_slice()[i] != x.as_slice()[i]);
        assert!(moved.count() < x.len() / 2);
    }
}
