//! What is broken in a mesh that was not at rest.

use std::sync::Arc;

use mesh_core::measure::{triangle_normal, triangle_quality};
use mesh_core::{Positions, Rows, Triangulation, TriangulationEdge, Vector3, VertexId};
use mesh_loss::FoldBarrier;

use super::Defects;

/// An edge is folded when the normals of its triangles have a dot product below this.
const FOLD_COSINE: f64 = -0.5;
/// A triangle with Q_f (Eq. 4) below this is skinny.
const SKINNY_QUALITY: f64 = 0.1;

/// Tells what is broken that was not at rest, however the polygons are cut.
pub(crate) struct Judge<'a> {
    rest: &'a Positions,
    pub(super) cuts: Vec<Cut>,
}

/// The polygons as triangles, and the edges that are not folded at rest.
pub(super) struct Cut {
    triangulation: Arc<Triangulation>,
    edges: Vec<TriangulationEdge>,
}

/// What is broken: rows of the edges and of the triangles of each cut, each ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Broken {
    folds: Vec<Vec<u32>>,
    skinny: Vec<Vec<u32>>,
}

impl Broken {
    /// Whether nothing is broken that is not in `other`.
    pub(super) fn is_within(&self, other: &Self) -> bool {
        let new = self.without(other);
        new.folds.iter().chain(&new.skinny).all(Vec::is_empty)
    }

    /// What is broken and not in `other`.
    pub(crate) fn without(&self, other: &Self) -> Self {
        let rest = |rows: &[Vec<u32>], others: &[Vec<u32>]| {
            let of_cut = |(rows, others): (&Vec<u32>, &Vec<u32>)| {
                let is_new = |row: &&u32| others.binary_search(row).is_err();
                rows.iter().filter(is_new).copied().collect()
            };
            rows.iter().zip(others).map(of_cut).collect()
        };
        Self {
            folds: rest(&self.folds, &other.folds),
            skinny: rest(&self.skinny, &other.skinny),
        }
    }
}

/// Edges and triangles that can break or mend when some vertices move: like [`Broken`].
pub(crate) struct Reach(Broken);

impl<'a> Judge<'a> {
    pub(crate) fn new(triangulation: &Arc<Triangulation>, rest: &'a Positions) -> Self {
        let simple = triangulation.simply_cut().map(Arc::new);
        let cuts = std::iter::once(Arc::clone(triangulation)).chain(simple);
        Self {
            rest,
            cuts: cuts.map(|triangles| Cut::new(triangles, rest)).collect(),
        }
    }

    /// The shape at rest.
    pub(crate) fn rest(&self) -> &'a Positions {
        self.rest
    }

    /// The triangles by which skinny ones are told.
    pub(crate) fn triangulation(&self) -> &Arc<Triangulation> {
        &self.cuts[0].triangulation
    }

    /// What is broken at `x`.
    pub(crate) fn broken(&self, x: &Positions) -> Broken {
        let skinny = |cut: &Cut| self.skinny(cut, x, 0..cut.triangulation.len() as u32);
        Broken {
            folds: self.cuts.iter().map(|cut| cut.folds(x)).collect(),
            skinny: self.cuts.iter().map(skinny).collect(),
        }
    }

    /// What is broken when the vertices of `reach` have moved to `x`, from where `before` was.
    pub(crate) fn broken_after(&self, before: &Broken, x: &Positions, reach: &Reach) -> Broken {
        let folds = self.cuts.iter().zip(&before.folds).zip(&reach.0.folds);
        let folds = folds.map(|((cut, before), reach)| {
            let is_folded = |&row: &u32| cut.is_folded_at(row, x);
            merged(before, reach, reach.iter().copied().filter(is_folded))
        });
        let skinny = self.cuts.iter().zip(&before.skinny).zip(&reach.0.skinny);
        let skinny = skinny.map(|((cut, before), reach)| {
            let now = self.skinny(cut, x, reach.iter().copied());
            merged(before, reach, now.into_iter())
        });
        Broken {
            folds: folds.collect(),
            skinny: skinny.collect(),
        }
    }

    /// The broken edges by their vertices, in order, and the skinny triangles; no crossings.
    pub(crate) fn defects(&self, broken: &Broken) -> Defects {
        let edges = self.cuts.iter().zip(&broken.folds);
        let edges = edges.flat_map(|(cut, rows)| rows.iter().map(|&row| cut.edge(row).vertices));
        let mut folds: Vec<[VertexId; 2]> = edges.collect();
        folds.sort_unstable();
        folds.dedup();
        Defects {
            folds,
            skinny: broken.skinny[0].iter().map(|&t| t as usize).collect(),
            crossings: Vec::new(),
        }
    }

    /// Corners of all that is broken, in order.
    pub(crate) fn vertices(&self, broken: &Broken) -> Vec<VertexId> {
        let folded = self.cuts.iter().zip(&broken.folds).flat_map(|(cut, rows)| {
            let triangles = rows.iter().flat_map(|&row| cut.edge(row).triangles);
            triangles.flat_map(|t| cut.triangulation.triangles()[t])
        });
        let skinny = self
            .cuts
            .iter()
            .zip(&broken.skinny)
            .flat_map(|(cut, rows)| {
                let triangles = cut.triangulation.triangles();
                rows.iter().flat_map(|&t| triangles[t as usize])
            });
        let mut vertices: Vec<VertexId> = folded.chain(skinny).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// What keeps edges from folding, in every cut.
    pub(crate) fn barriers(&self, limit: f64) -> Vec<FoldBarrier> {
        let barrier = |cut: &Cut| FoldBarrier::new(&cut.triangulation, self.rest, limit);
        self.cuts.iter().map(barrier).collect()
    }

    /// Of `rows`, the triangles of a cut that are skinny at `x` and were not at rest.
    fn skinny(&self, cut: &Cut, x: &Positions, rows: impl Iterator<Item = u32>) -> Vec<u32> {
        let triangles = cut.triangulation.triangles();
        let is_skinny = |t: u32, x: &Positions| {
            triangle_quality(triangles[t as usize].map(|v| x[v])) < SKINNY_QUALITY
        };
        rows.filter(|&t| is_skinny(t, x) && !is_skinny(t, self.rest))
            .collect()
    }
}

impl Cut {
    fn new(triangulation: Arc<Triangulation>, rest: &Positions) -> Self {
        let normals = normals(&triangulation, rest);
        let is_flat = |e: &TriangulationEdge| !is_folded(e, |t| normals[t]);
        Self {
            edges: triangulation.interior_edges().filter(is_flat).collect(),
            triangulation,
        }
    }

    fn edge(&self, row: u32) -> &TriangulationEdge {
        &self.edges[row as usize]
    }

    fn folds(&self, x: &Positions) -> Vec<u32> {
        let normals = normals(&self.triangulation, x);
        let edges = (0..).zip(&self.edges);
        let folded = edges.filter(|(_, e)| is_folded(e, |t| normals[t]));
        folded.map(|(row, _)| row).collect()
    }

    fn is_folded_at(&self, row: u32, x: &Positions) -> bool {
        is_folded(self.edge(row), |t| self.normal(t, x))
    }

    fn normal(&self, t: usize, x: &Positions) -> Vector3 {
        let corners = self.triangulation.triangles()[t].map(|v| x[v]);
        triangle_normal(corners).unwrap_or_default()
    }
}

/// What lies around each vertex, for all cuts.
pub(crate) struct Surroundings<'a> {
    judge: &'a Judge<'a>,
    /// For each triangle of each cut the rows of its edges.
    edges_at: Vec<Rows<u32>>,
}

impl<'a> Surroundings<'a> {
    pub(crate) fn new(judge: &'a Judge<'a>) -> Self {
        let of_cut = |cut: &Cut| {
            let sides = (0..).zip(&cut.edges);
            let sides = sides.flat_map(|(e, edge)| edge.triangles.map(|t| (t, e)));
            Rows::from_pairs(cut.triangulation.len(), sides)
        };
        Self {
            edges_at: judge.cuts.iter().map(of_cut).collect(),
            judge,
        }
    }

    /// What can break or mend when `free` moves.
    pub(crate) fn reach(&self, free: &[VertexId]) -> Reach {
        let of_cut = |(cut, edges_at): (&Cut, &Rows<u32>)| {
            let around = |&v: &VertexId| cut.triangulation.vertex_triangles(v);
            let triangles = in_order(free.iter().flat_map(around));
            let edges = in_order(triangles.iter().flat_map(|&t| &edges_at[t as usize]));
            (triangles, edges)
        };
        let (skinny, folds) = self
            .judge
            .cuts
            .iter()
            .zip(&self.edges_at)
            .map(of_cut)
            .unzip();
        Reach(Broken { folds, skinny })
    }

    /// The least cosine at an edge of the patch that was not folded at rest.
    pub(crate) fn sharpest(&self, x: &Positions, patch: &[VertexId]) -> f64 {
        let reach = self.reach(patch);
        let of_cut = |(cut, rows): (&Cut, &Vec<u32>)| {
            let edges = rows.iter().map(|&row| cut.edge(row));
            let is_in_patch = |v: &VertexId| patch.binary_search(v).is_ok();
            let inside = edges.filter(|e| e.vertices.iter().all(is_in_patch));
            inside
                .map(|e| cosine(e, |t| cut.normal(t, x)))
                .fold(1.0, f64::min)
        };
        let cuts = self.judge.cuts.iter().zip(&reach.0.folds);
        cuts.map(of_cut).fold(1.0, f64::min)
    }
}

/// Each row once, ascending.
fn in_order<'r>(rows: impl Iterator<Item = &'r u32>) -> Vec<u32> {
    let mut rows: Vec<u32> = rows.copied().collect();
    rows.sort_unstable();
    rows.dedup();
    rows
}

/// `before` with what is within `reach` replaced by `now`; all ascending.
fn merged(before: &[u32], reach: &[u32], now: impl Iterator<Item = u32>) -> Vec<u32> {
    let outside = before
        .iter()
        .filter(|row| reach.binary_search(row).is_err());
    let mut rows: Vec<u32> = outside.copied().chain(now).collect();
    rows.sort_unstable();
    rows
}

fn normals(triangulation: &Triangulation, x: &Positions) -> Vec<Vector3> {
    triangulation
        .corners(x)
        .map(|corners| triangle_normal(corners).unwrap_or_default())
        .collect()
}

fn is_folded(edge: &TriangulationEdge, normal: impl Fn(usize) -> Vector3) -> bool {
    cosine(edge, normal) < FOLD_COSINE
}

/// Cosine between the normals of an edge's triangles.
fn cosine(edge: &TriangulationEdge, normal: impl Fn(usize) -> Vector3) -> f64 {
    let [one, two] = edge.triangles.map(normal);
    one.dot(&two)
}

#[cfg(test)]
mod tests {
    use mesh_core::{shapes, Point3, PolygonSoup};

    use super::*;

    #[test]
    fn polygons_that_simple_programs_cut_otherwise_are_judged_twice() {
        let (mesh, rest) = shapes::open_grid(6, 6).into_halfedge().unwrap();
        let triangulation = Arc::new(Triangulation::new(&mesh, &rest));
        assert!(triangulation.simply_cut().is_none());
        let judge = Judge::new(&triangulation, &rest);
        assert_eq!(judge.cuts.len(), 1);

        let (triangulation, rest) = kites();
        let judge = Judge::new(&triangulation, &rest);
        assert_eq!(judge.cuts.len(), 2);
        assert!(judge.defects(&judge.broken(&rest)).is_empty());
    }

    fn kites() -> (Arc<Triangulation>, Positions) {
        let kites = PolygonSoup {
            positions: [[0., 0.], [1., 5.], [0., 0.5], [-1., 5.], [0., 9.]]
                .map(|[x, y]| Point3::new(x, y, 0.0))
                .to_vec(),
            faces: vec![vec![0, 1, 2, 3], vec![1, 4, 3, 2]],
        };
        let (mesh, rest) = kites.into_halfedge().unwrap();
        (Arc::new(Triangulation::new(&mesh, &rest)), rest)
    }

    /// Moves a vertex of a broken mesh and then its neighbourhood: judged nearby, judged all over, all the same.
    #[test]
    fn what_is_judged_nearby_is_what_is_judged_all_over() {
        let (mesh, rest) = shapes::quad_sphere(12).into_halfedge().unwrap();
        let ball = (Arc::new(Triangulation::new(&mesh, &rest)), rest);
        for (triangulation, rest) in [ball, kites()] {
            let judge = Judge::new(&triangulation, &rest);
            let surroundings = Surroundings::new(&judge);
            let mut x = rest.clone();
            let mut broken = judge.broken(&x);
            let mut n_broken = 0;
            for k in 0..60 {
                let moved: Vec<VertexId> = (0..1 + k % 3)
                    .map(|i| VertexId::new((37 * k + 11 * i) % x.len()))
                    .collect();
                for &v in &moved {
                    let other = VertexId::new((v.index() + 1 + k % 5) % x.len());
                    x[v] = nalgebra::center(&x[other], &rest[v]);
                }
                let reach = surroundings.reach(&moved);
                broken = judge.broken_after(&broken, &x, &reach);
                assert_eq!(broken, judge.broken(&x));
                n_broken += judge.vertices(&broken).len();
            }
            assert!(n_broken > 0);
        }
    }
}
