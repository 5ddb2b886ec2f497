//! The last stage: no new fold, no new skinny triangle.

use std::borrow::Cow;

use mesh_core::measure::{triangle_normal, triangle_quality};
use mesh_core::{
    Point3, Positions, Triangulation, TriangulationEdge, UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_loss::{FoldBarrier, LocalShape, Loss};

/// An edge is folded when the normals of its triangles have a dot product below this.
const FOLD_COSINE: f64 = -0.5;
/// A triangle with Q_f (Eq. 4) below this is skinny.
const SKINNY_QUALITY: f64 = 0.1;
/// A patch grows up to this many rings around what is broken.
const MAX_RINGS: usize = 8;
/// Each size of a patch is relaxed at most this often.
const SWEEPS: usize = 40;
/// So often a patch that does not mend is flattened before.
const FLATTENINGS: usize = 30;
/// A patch is left as it was if mending it would move a vertex farther than this share of the longest side.
const MAX_MOTION: f64 = 0.05;
/// Edges that are only just folded, with cosines above this, are bent back ...
const JUST_FOLDED: f64 = -0.65;
/// ... in at most so many steps ...
const UNBENDINGS: usize = 12;
/// ... of this share of the longest side, ...
const UNBENDING: f64 = 5e-4;
/// ... with this many rings around them, until no cosine is below this.
const UNBENDING_RINGS: usize = 1;
const UNBENT_COSINE: f64 = -0.45;

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
    /// Ends of the edges whose triangles turn against each other, n₁·n₂ < −0.5, in the given triangulation or in that of
    /// simple programs ([`Triangulation::simply_cut`]).
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
/// scaled, with their surroundings held ([`LocalShape::relax`]); a patch grows until nothing in it is broken. Before,
/// edges that are only just folded are bent back along the gradient of [`FoldBarrier`].
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
        let mender = Mender {
            judge: &judge,
            shape: LocalShape::new(triangulation, rest),
            barriers: judge.barriers(),
            neighbours: triangulation.neighbours(x.len()),
            held,
            size: UnitFrame::principal(x.as_slice()).scale,
        };
        let is_broken = |v: VertexId| broken.binary_search(&v).is_ok();
        for patch in triangulation.connected_groups(x.len(), is_broken) {
            if let Some((mended, left)) = mender.mended(&positions, &patch, &broken) {
                (positions, broken) = (mended, left);
            }
        }
    }
    Repair {
        left: judge.defects(&positions),
        before,
        positions,
    }
}

/// Mends patches, one at a time.
struct Mender<'a> {
    judge: &'a Judge<'a>,
    shape: LocalShape,
    barriers: Vec<FoldBarrier<'a>>,
    neighbours: VertexData<Vec<VertexId>>,
    held: &'a [VertexId],
    size: f64,
}

impl Mender<'_> {
    /// The positions with `patch` mended, and what of `broken` is left then; none where it does not mend.
    fn mended(
        &self,
        x: &Positions,
        patch: &[VertexId],
        broken: &[VertexId],
    ) -> Option<(Positions, Vec<VertexId>)> {
        let free = |rings: usize| {
            let mut free = self.grown(patch, rings);
            free.retain(|v| !self.held.contains(v));
            free
        };
        let if_mended = |moved: &Positions, free: &[VertexId]| {
            let left = self.judge.broken_vertices(moved);
            let is_near = |v: &VertexId| (moved[*v] - x[*v]).norm() <= MAX_MOTION * self.size;
            (is_mended(&left, broken, patch) && free.iter().all(is_near))
                .then(|| (moved.clone(), left))
        };
        let unbent = || {
            if self.judge.sharpest(x, patch) < JUST_FOLDED {
                return None;
            }
            let (free, mut moved) = (free(UNBENDING_RINGS), x.clone());
            (0..UNBENDINGS).find_map(|_| {
                self.unbend(&mut moved, &free);
                if_mended(&moved, &free)
            })
        };
        let relaxed = |rings: usize, n_flattenings: usize| {
            let (free, mut moved) = (free(rings), x.clone());
            (0..n_flattenings).for_each(|_| self.flatten(&mut moved, &free));
            (0..SWEEPS).find_map(|_| {
                self.shape.relax(&mut moved, &free);
                if_mended(&moved, &free)
            })
        };
        // A patch that turned over as a whole does not come back by itself; it is flattened first.
        unbent().or_else(|| {
            (0..=MAX_RINGS)
                .find_map(|rings| relaxed(rings, 0).or_else(|| relaxed(rings, FLATTENINGS)))
        })
    }

    /// Moves the vertices of `free` a little against the gradient of the fold barrier.
    fn unbend(&self, x: &mut Positions, free: &[VertexId]) {
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        for barrier in &self.barriers {
            barrier.accumulate(x, 1.0, &mut gradient);
        }
        let largest = free.iter().map(|&v| gradient[v].norm()).fold(0.0, f64::max);
        if largest > 0.0 {
            for &v in free {
                x[v] -= gradient[v] * (UNBENDING * self.size / largest);
            }
        }
    }

    /// Moves each vertex of `free` once, in their order, to the mean of its neighbours.
    fn flatten(&self, x: &mut Positions, free: &[VertexId]) {
        for &v in free {
            let around = &self.neighbours[v];
            let sum: Vector3 = around.iter().map(|&w| x[w].coords).sum();
            if !around.is_empty() {
                x[v] = Point3::from(sum / around.len() as f64);
            }
        }
    }

    /// The vertices within `rings` edges of `patch`, in order.
    fn grown(&self, patch: &[VertexId], rings: usize) -> Vec<VertexId> {
        let mut grown = patch.to_vec();
        for _ in 0..rings {
            let around = grown.iter().flat_map(|&v| &self.neighbours[v]);
            let around: Vec<VertexId> = around.copied().collect();
            grown.extend(around);
            grown.sort_unstable();
            grown.dedup();
        }
        grown
    }
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

/// Tells what is broken that was not at rest, however the polygons are cut.
struct Judge<'a> {
    rest: &'a Positions,
    cuts: Vec<Cut<'a>>,
}

/// The polygons as triangles, and the edges that are not folded at rest.
struct Cut<'a> {
    triangulation: Cow<'a, Triangulation>,
    edges: Vec<TriangulationEdge>,
}

impl<'a> Judge<'a> {
    fn new(triangulation: &'a Triangulation, rest: &'a Positions) -> Self {
        let simple = triangulation.simply_cut().map(Cow::Owned);
        let cuts = std::iter::once(Cow::Borrowed(triangulation)).chain(simple);
        Self {
            rest,
            cuts: cuts.map(|triangles| Cut::new(triangles, rest)).collect(),
        }
    }

    fn defects(&self, x: &Positions) -> Defects {
        let edges = self.cuts.iter().flat_map(|cut| cut.folds(x));
        let mut folds: Vec<[VertexId; 2]> = edges.map(|e| e.vertices).collect();
        folds.sort_unstable();
        folds.dedup();
        Defects {
            folds,
            skinny: self.cuts[0].skinny(self.rest, x),
        }
    }

    /// The least cosine at an edge of the patch that was not folded at rest.
    fn sharpest(&self, x: &Positions, patch: &[VertexId]) -> f64 {
        let of_cut = |cut: &Cut<'_>| {
            let normals = normals(&cut.triangulation, x);
            let is_inside = |e: &&TriangulationEdge| e.vertices.iter().all(|v| patch.contains(v));
            let edges = cut.edges.iter().filter(is_inside);
            edges.map(|e| cosine(e, &normals)).fold(1.0, f64::min)
        };
        self.cuts.iter().map(of_cut).fold(1.0, f64::min)
    }

    /// What keeps edges from folding, in every cut.
    fn barriers(&self) -> Vec<FoldBarrier<'_>> {
        let barrier = |cut| FoldBarrier::new(cut, self.rest, UNBENT_COSINE);
        self.cuts
            .iter()
            .map(|cut| barrier(&*cut.triangulation))
            .collect()
    }

    /// Corners of all that is broken, in order.
    fn broken_vertices(&self, x: &Positions) -> Vec<VertexId> {
        let corners = |cut: &Cut<'_>| {
            let triangles = cut.triangulation.triangles();
            let folded = cut.folds(x).flat_map(|e| e.triangles);
            let rows = folded.chain(cut.skinny(self.rest, x));
            rows.flat_map(|t| triangles[t]).collect::<Vec<VertexId>>()
        };
        let mut vertices: Vec<VertexId> = self.cuts.iter().flat_map(corners).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }
}

impl<'a> Cut<'a> {
    fn new(triangulation: Cow<'a, Triangulation>, rest: &Positions) -> Self {
        let normals = normals(&triangulation, rest);
        let mut edges = triangulation.interior_edges();
        edges.retain(|e| !is_folded(e, &normals));
        Self {
            triangulation,
            edges,
        }
    }

    fn folds(&self, x: &Positions) -> impl Iterator<Item = &TriangulationEdge> {
        let normals = normals(&self.triangulation, x);
        self.edges.iter().filter(move |e| is_folded(e, &normals))
    }

    fn skinny(&self, rest: &Positions, x: &Positions) -> Vec<usize> {
        let [before, after] = [rest, x].map(|x| self.triangulation.corners(x));
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
    cosine(edge, normals) < FOLD_COSINE
}

/// Cosine between the normals of an edge's triangles.
fn cosine(edge: &TriangulationEdge, normals: &[Vector3]) -> f64 {
    let [one, two] = edge.triangles.map(|t| normals[t]);
    one.dot(&two)
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

    #[test]
    fn neighbours_that_changed_places_are_put_back() {
        let (triangulation, rest) = sphere(48);
        let mut x = rest.clone();
        for [v, w] in triangulation.edges().into_iter().step_by(4001) {
            (x[v], x[w]) = (x[w], x[v]);
        }
        let repair = repair(&triangulation, &rest, &x, &[]);
        assert!(!repair.before.is_empty());
        assert!(repair.left.is_empty(), "{:?}", repair.left);
    }

    #[test]
    fn polygons_that_simple_programs_cut_otherwise_are_judged_twice() {
        let (mesh, rest) = shapes::open_grid(6, 6).into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &rest);
        assert!(triangulation.simply_cut().is_none());
        let judge = Judge::new(&triangulation, &rest);
        assert_eq!(judge.cuts.len(), 1);

        let kites = mesh_core::PolygonSoup {
            positions: [[0., 0.], [1., 5.], [0., 0.5], [-1., 5.], [0., 9.]]
                .map(|[x, y]| Point3::new(x, y, 0.0))
                .to_vec(),
            faces: vec![vec![0, 1, 2, 3], vec![1, 4, 3, 2]],
        };
        let (mesh, rest) = kites.into_halfedge().unwrap();
        let triangulation = Triangulation::new(&mesh, &rest);
        let judge = Judge::new(&triangulation, &rest);
        assert_eq!(judge.cuts.len(), 2);
        assert!(judge.defects(&rest).is_empty());
    }
}
