//! The last stage: no new fold, no new skinny triangle, no new crossing.

mod judge;

use std::sync::Arc;

use mesh_core::{
    Point3, Positions, TargetSurface, Triangulation, UnitFrame, Vector3, VertexData, VertexId,
};
use mesh_loss::{FoldBarrier, LocalShape};

pub(crate) use judge::{Broken, Judge, Reach, Surroundings};

use crate::untangle::{self, Untangled};

/// A patch grows up to this many rings around what is broken.
const MAX_RINGS: usize = 8;
/// Each size of a patch is relaxed at most this often.
const SWEEPS: usize = 40;
/// So often a patch that does not mend is flattened before.
const FLATTENINGS: usize = 30;
/// A patch is left as it was if mending it would move a vertex farther than this share of the longest side.
const MAX_MOTION: f64 = 0.05;
/// A vertex of a mended patch goes back this share of the way to where it was, the largest that breaks nothing ...
const SHARES_BACK: [f64; 3] = [0.8, 0.4, 0.2];
/// ... so often.
const BACK_SWEEPS: usize = 2;
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

/// What a surface is fitted to.
#[derive(Clone, Copy)]
pub struct Fit<'t> {
    /// The target, in the coordinates of the surface.
    pub target: &'t dyn TargetSurface,
    /// How strongly each vertex is attracted by it: where one is not, its distance does not count.
    pub attraction: &'t VertexData<f64>,
}

/// What becomes of crossings.
#[derive(Clone, Copy)]
pub enum Crossings<'t> {
    /// They are taken out. Where a fit is given, no patch comes farther from the target to be free than the farthest vertex
    /// of the whole surface, but a hundredth of its longest side or three times the distance of the median vertex at most:
    /// such crossings are left.
    Part(Option<Fit<'t>>),
    /// They stay.
    Stay,
}

/// What is broken in a mesh that was not at rest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Defects {
    /// Ends of the edges whose triangles turn against each other, n₁·n₂ < −0.5, in the given triangulation or in that of
    /// simple programs ([`Triangulation::simply_cut`]).
    pub folds: Vec<[VertexId; 2]>,
    /// Rows of the triangles with Q_f < 0.1.
    pub skinny: Vec<usize>,
    /// Pairs of triangles that run through each other: their rows, the lower first, in order. Touching does not count.
    pub crossings: Vec<[usize; 2]>,
}

impl Defects {
    /// Whether nothing is broken.
    pub fn is_empty(&self) -> bool {
        self.folds.is_empty() && self.skinny.is_empty() && self.crossings.is_empty()
    }
}

/// Relaxes small patches around new folds and new skinny triangles towards the shape they had at rest, turned and
/// scaled, with their surroundings held ([`LocalShape::relax`]); a patch grows until nothing in it is broken. Before,
/// edges that are only just folded are bent back along the gradient of [`FoldBarrier`].
///
/// What moved goes back as far as nothing breaks: a patch that was mended stays where the drape had brought it.
///
/// Then crossings are taken out, patch by patch: what crosses moves so that the line in which it crosses gets shorter, its
/// surroundings relax, and every vertex goes back towards where it was, and to the target, as far as nothing crosses. What
/// crosses at rest already may do so.
///
/// A patch that does not get better by a small motion stays as it was. All else stays, to the bit.
///
/// The vertices of `held`, such as those of landmarks, stay where they are.
pub fn repair(
    triangulation: &Arc<Triangulation>,
    rest: &Positions,
    x: &Positions,
    held: &[VertexId],
    crossings: Crossings<'_>,
) -> Repair {
    let mut held = held.to_vec();
    held.sort_unstable();
    let judge = Judge::new(triangulation, rest);
    let crossing = untangle::crossings(triangulation, rest, x);
    let before = Defects {
        crossings: in_full(&crossing),
        ..judge.defects(&judge.broken(x))
    };
    let (positions, broken) = unfolded(&judge, triangulation, x, &held);
    let left = if positions == *x {
        crossing
    } else {
        untangle::crossings(triangulation, rest, &positions)
    };
    let shape = Untangled {
        positions,
        broken,
        left,
    };
    let shape = match crossings {
        Crossings::Part(fit) => untangle::untangle(&judge, shape, &held, fit),
        Crossings::Stay => shape,
    };
    Repair {
        before,
        left: Defects {
            crossings: in_full(&shape.left),
            ..judge.defects(&shape.broken)
        },
        positions: shape.positions,
    }
}

fn in_full(pairs: &[[u32; 2]]) -> Vec<[usize; 2]> {
    pairs.iter().map(|pair| pair.map(|t| t as usize)).collect()
}

/// Positions without the folds and skinny triangles that could be taken out, and what of them is left.
fn unfolded(
    judge: &Judge<'_>,
    triangulation: &Arc<Triangulation>,
    x: &Positions,
    held: &[VertexId],
) -> (Positions, Broken) {
    let mut broken = judge.broken(x);
    let mut positions = x.clone();
    let vertices = judge.vertices(&broken);
    if !vertices.is_empty() {
        let mender = Mender {
            judge,
            surroundings: Surroundings::new(judge),
            shape: LocalShape::new(triangulation, judge.rest()),
            barriers: judge.barriers(UNBENT_COSINE),
            triangulation,
            held,
            size: UnitFrame::principal(x.as_slice()).scale,
        };
        let is_broken = |v: VertexId| vertices.binary_search(&v).is_ok();
        for patch in triangulation.connected_groups(is_broken) {
            if let Some(mended) = mender.mended(&positions, &patch, &broken) {
                (positions, broken) = mended;
            }
        }
    }
    (positions, broken)
}

/// One of the ways to mend: it changes the positions of the free vertices, turn by turn.
type Change<'c> = &'c mut dyn FnMut(&mut Positions, &[VertexId], usize);

/// Mends patches, one at a time. What moves and what that can break or mend is looked at, nothing else.
struct Mender<'a> {
    judge: &'a Judge<'a>,
    surroundings: Surroundings<'a>,
    shape: LocalShape,
    barriers: Vec<FoldBarrier>,
    triangulation: &'a Triangulation,
    held: &'a [VertexId],
    size: f64,
}

impl Mender<'_> {
    /// The positions with `patch` mended, and what of `broken` is left then; none where it does not mend.
    fn mended(
        &self,
        x: &Positions,
        patch: &[VertexId],
        broken: &Broken,
    ) -> Option<(Positions, Broken)> {
        let vertices = self.judge.vertices(broken);
        let free = |rings: usize| {
            let mut free = grown(self.triangulation, patch, rings);
            free.retain(|v| self.held.binary_search(v).is_err());
            free
        };
        // The first of the shapes that `change` goes through in which the patch is mended by a small motion, as near as can
        // be to where it was.
        let mended = |free: &[VertexId], n: usize, change: Change<'_>| {
            let reach = self.surroundings.reach(free);
            let mut moved = x.clone();
            (0..n).find_map(|turn| {
                change(&mut moved, free, turn);
                let left = self.judge.broken_after(broken, &moved, &reach);
                let is_near = |v: &VertexId| (moved[*v] - x[*v]).norm() <= MAX_MOTION * self.size;
                let is_done = is_mended(&self.judge.vertices(&left), &vertices, patch);
                (is_done && free.iter().all(is_near)).then(|| self.back(x, &moved, free, left))
            })
        };
        let unbent = || {
            if self.surroundings.sharpest(x, patch) < JUST_FOLDED {
                return None;
            }
            let free = free(UNBENDING_RINGS);
            let edges: Vec<Vec<usize>> =
                self.barriers.iter().map(|b| b.edges_near(&free)).collect();
            mended(&free, UNBENDINGS, &mut |x, free, _| {
                self.unbend(x, free, &edges);
            })
        };
        let relaxed = |free: &[VertexId], n_flattenings: usize| {
            mended(free, SWEEPS, &mut |x, free, turn| {
                if turn == 0 {
                    (0..n_flattenings).for_each(|_| flatten(self.triangulation, x, free));
                }
                self.shape.relax(x, free);
            })
        };
        // A patch that turned over as a whole does not come back by itself; it is flattened first.
        unbent().or_else(|| {
            (0..=MAX_RINGS).find_map(|rings| {
                let free = free(rings);
                relaxed(&free, 0).or_else(|| relaxed(&free, FLATTENINGS))
            })
        })
    }

    /// The positions `moved` with each vertex of `free` as near to where it was in `x` as breaks nothing that is not in
    /// `broken`.
    fn back(
        &self,
        x: &Positions,
        moved: &Positions,
        free: &[VertexId],
        mut broken: Broken,
    ) -> (Positions, Broken) {
        let mut moved = moved.clone();
        for _ in 0..BACK_SWEEPS {
            for &v in free {
                let there = moved[v];
                let reach = self.surroundings.reach(&[v]);
                let is_back = SHARES_BACK.iter().any(|share| {
                    moved[v] = there + (x[v] - there) * *share;
                    let left = self.judge.broken_after(&broken, &moved, &reach);
                    let is_whole = left.is_within(&broken);
                    if is_whole {
                        broken = left;
                    }
                    is_whole
                });
                if !is_back {
                    moved[v] = there;
                }
            }
        }
        (moved, broken)
    }

    /// Moves the vertices of `free` a little against the gradient of the fold barrier, given the edges near them.
    fn unbend(&self, x: &mut Positions, free: &[VertexId], edges: &[Vec<usize>]) {
        let mut gradient = VertexData::new(x.len(), Vector3::zeros());
        for (barrier, edges) in self.barriers.iter().zip(edges) {
            barrier.accumulate_edges(edges, x, 1.0, &mut gradient);
        }
        let largest = free.iter().map(|&v| gradient[v].norm()).fold(0.0, f64::max);
        if largest > 0.0 {
            for &v in free {
                x[v] -= gradient[v] * (UNBENDING * self.size / largest);
            }
        }
    }
}

/// Moves each vertex of `free` once, in their order, to the mean of its neighbours.
pub(crate) fn flatten(triangulation: &Triangulation, x: &mut Positions, free: &[VertexId]) {
    for &v in free {
        let around = triangulation.vertex_neighbours(v);
        let sum: Vector3 = around.iter().map(|&w| x[w].coords).sum();
        if !around.is_empty() {
            x[v] = Point3::from(sum / around.len() as f64);
        }
    }
}

/// The vertices within `rings` edges of `patch`, in order.
pub(crate) fn grown(
    triangulation: &Triangulation,
    patch: &[VertexId],
    rings: usize,
) -> Vec<VertexId> {
    let mut is_in = VertexData::new(triangulation.n_vertices(), false);
    patch.iter().for_each(|&v| is_in[v] = true);
    let mut edge = patch.to_vec();
    for _ in 0..rings {
        let around = edge
            .iter()
            .flat_map(|&v| triangulation.vertex_neighbours(v));
        let around = around
            .copied()
            .filter(|&w| !std::mem::replace(&mut is_in[w], true));
        edge = around.collect();
    }
    triangulation.vertices().filter(|&v| is_in[v]).collect()
}

/// What is broken at `x` that was not at rest.
pub(crate) fn defects(
    triangulation: &Arc<Triangulation>,
    rest: &Positions,
    x: &Positions,
) -> Defects {
    let judge = Judge::new(triangulation, rest);
    Defects {
        crossings: in_full(&untangle::crossings(triangulation, rest, x)),
        ..judge.defects(&judge.broken(x))
    }
}

/// Nothing in the patch is broken any more, and nothing else is that was not.
fn is_mended(left: &[VertexId], broken: &[VertexId], patch: &[VertexId]) -> bool {
    left.iter()
        .all(|v| patch.binary_search(v).is_err() && broken.binary_search(v).is_ok())
}

#[cfg(test)]
mod tests {
    use mesh_core::shapes;

    use super::*;

    fn sphere(n: usize) -> (Arc<Triangulation>, Positions) {
        let (mesh, rest) = shapes::quad_sphere(n).into_halfedge().unwrap();
        (Arc::new(Triangulation::new(&mesh, &rest)), rest)
    }

    #[test]
    fn a_shape_without_defects_stays_to_the_bit() {
        let (triangulation, rest) = sphere(8);
        let x = rest.map(|p| p * 3.0);
        let repair = repair(&triangulation, &rest, &x, &[], Crossings::Part(None));
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
        let repair = repair(&triangulation, &rest, &x, &[], Crossings::Part(None));
        assert!(!repair.before.is_empty());
        assert!(repair.left.is_empty(), "{:?}", repair.left);
        let true_place = rest.map(|p| p * 2.0);
        // It moves no farther than it must, so it comes back only part of the way.
        let thrown = (x[v] - true_place[v]).norm();
        let after = (repair.positions[v] - true_place[v]).norm();
        assert!(after < 0.7 * thrown, "{after} of {thrown}");
        // All else is back to within a part of what was thrown.
        let way = |i: &usize| (repair.positions.as_slice()[*i] - x.as_slice()[*i]).norm();
        let n_moved = (0..x.len()).filter(|i| way(i) > 0.05 * thrown).count();
        assert!(n_moved <= 12, "{n_moved}");
    }

    #[test]
    fn neighbours_that_changed_places_are_put_back() {
        let (triangulation, rest) = sphere(48);
        let mut x = rest.clone();
        for [v, w] in triangulation.edges().iter().copied().step_by(4001) {
            (x[v], x[w]) = (x[w], x[v]);
        }
        let repair = repair(&triangulation, &rest, &x, &[], Crossings::Part(None));
        assert!(!repair.before.is_empty());
        assert!(repair.left.is_empty(), "{:?}", repair.left);
    }
}
