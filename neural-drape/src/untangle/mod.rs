//! The last stage, second part: no surface runs through another that did not at rest.

mod carry;
mod case;
mod contour;
mod crossing;
mod fit;

use mesh_core::{Positions, Triangulation, UnionFind, UnitFrame, VertexId};
use mesh_loss::LocalShape;

use crate::repair::{grown, Broken, Fit, Judge, Surroundings};
use carry::Carrier;
use case::{Candidate, Case, Start};
use crossing::{Detector, Ground};

/// What is freed in one go: patches up to so many rings apart are one; each is tried from these starts, with so many rings
/// around it.
const PASSES: [(usize, &[(usize, Start)]); 3] = [(1, NARROW), (1, NARROW), (4, WIDE)];
const NARROW: &[(usize, Start)] = &[
    (0, Start::AsItIs),
    (0, Start::Carried),
    (1, Start::Carried),
    (3, Start::AsItIs),
    (3, Start::Carried),
];
const WIDE: &[(usize, Start)] = &[
    (0, Start::AsItIs),
    (0, Start::Carried),
    (4, Start::AsItIs),
    (4, Start::Carried),
];
/// Without a target, no vertex moves farther than this share of the longest side.
const MAX_MOTION: f64 = 0.06;
/// A freed patch this near to the target is taken at once, in longest sides.
const GOOD: f64 = 0.006;
/// A patch may come as far from the target as the farthest vertex of the whole surface, within these bounds: then the
/// Hausdorff distance stays what it was, or small. ...
const LIMITS: [f64; 2] = [0.0075, 0.01];
/// ... It may always come this many times as far as the median vertex is: all surfaces are far from the points of a sparse
/// cloud.
const TIMES_MEDIAN: f64 = 3.0;
/// A patch much farther from the target than it may be is not brought back.
const HOPELESS: f64 = 3.0;
/// So often, all in all, as many vertices are moved as the surface has; then what still crosses is left.
const BUDGET: usize = 40;

/// A shape without the crossings that could be taken out of it.
pub(crate) struct Untangled {
    pub(crate) positions: Positions,
    /// What is folded or skinny there.
    pub(crate) broken: Broken,
    /// The triangles that still cross and did not at rest: pairs of rows, the lower first, in order.
    pub(crate) left: Vec<[u32; 2]>,
}

/// The triangles that cross at `x` and did not at rest: pairs of rows, the lower first, in order.
pub(crate) fn crossings(
    triangulation: &Triangulation,
    rest: &Positions,
    x: &Positions,
) -> Vec<[u32; 2]> {
    let ground = Ground {
        triangulation,
        rest,
    };
    Detector::new(ground, x).all_crossings(ground, x)
}

/// Takes crossings out of a shape, patch by patch, those of few pairs first. What crosses moves against the
/// gradient of the length of the line in which it crosses, while its surroundings relax towards the shape that they had at
/// rest, until nothing crosses; then every vertex goes back towards where it was and to the target as far as nothing crosses
/// or folds. So a patch moves no more than it must.
///
/// A patch that does not come free is taken where it crosses least, if that is less than half of it; one that would come
/// farther from the target than it may stays as it was. The vertices of `held`, in order, stay where they are.
pub(crate) fn untangle(
    judge: &Judge<'_>,
    mut shape: Untangled,
    held: &[VertexId],
    fit: Option<Fit<'_>>,
) -> Untangled {
    if shape.left.is_empty() {
        return shape;
    }
    let mut untangler = Untangler::new(judge, &shape.positions, held, fit);
    for (apart, tries) in PASSES {
        for patch in patches(judge.triangulation(), &shape.left, apart) {
            if untangler.is_spent() {
                return shape;
            }
            if let Some(positions) = untangler.freed(&shape, &patch, tries) {
                shape = untangler.shape(positions);
            }
        }
        if shape.left.is_empty() {
            break;
        }
    }
    shape
}

/// Vertices within some rings of the triangles that cross: those of each pair, and what touches, are one patch. Each
/// ascending; patches of few pairs first.
fn patches(triangulation: &Triangulation, pairs: &[[u32; 2]], rings: usize) -> Vec<Vec<VertexId>> {
    let corners = |row: u32| triangulation.triangles()[row as usize];
    let mut sets = UnionFind::new(triangulation.n_vertices());
    let mut crossing = Vec::new();
    for &[one, two] in pairs {
        let [s, t] = [one, two].map(corners);
        for v in s.into_iter().chain(t) {
            sets.union(s[0].index(), v.index());
            crossing.push(v);
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    let mut is_in = vec![false; triangulation.n_vertices()];
    for v in grown(triangulation, &crossing, rings) {
        is_in[v.index()] = true;
    }
    for [a, b] in triangulation.edges().iter().map(|e| e.map(VertexId::index)) {
        if is_in[a] && is_in[b] {
            sets.union(a, b);
        }
    }
    let ids = |rows: Vec<usize>| rows.into_iter().map(VertexId::new).collect();
    let patches = sets.sets(|row| is_in[row]).into_iter().map(ids);
    let mut patches: Vec<Vec<VertexId>> = patches.collect();
    patches.sort_by_cached_key(|patch| n_pairs(triangulation, patch, pairs));
    patches
}

fn n_pairs(triangulation: &Triangulation, patch: &[VertexId], pairs: &[[u32; 2]]) -> usize {
    let is_here = |pair: &&[u32; 2]| is_at(triangulation, patch, pair);
    pairs.iter().filter(is_here).count()
}

/// Whether a pair of triangles is one of a patch.
fn is_at(triangulation: &Triangulation, patch: &[VertexId], pair: &[u32; 2]) -> bool {
    let v = triangulation.triangles()[pair[0] as usize][0];
    patch.binary_search(&v).is_ok()
}

/// Takes patches apart, one at a time.
struct Untangler<'a> {
    ground: Ground<'a>,
    held: &'a [VertexId],
    fit: Option<Fit<'a>>,
    /// Of all triangles.
    detector: Detector,
    shape: LocalShape,
    carrier: Carrier<'a>,
    judge: &'a Judge<'a>,
    surroundings: Surroundings<'a>,
    /// The longest side of the surface.
    size: f64,
    /// How far a patch may come from the target.
    limit: f64,
    /// How many vertices were moved, each time counted.
    work: usize,
}

impl<'a> Untangler<'a> {
    fn new(
        judge: &'a Judge<'a>,
        x: &Positions,
        held: &'a [VertexId],
        fit: Option<Fit<'a>>,
    ) -> Self {
        let ground = Ground {
            triangulation: judge.triangulation(),
            rest: judge.rest(),
        };
        let size = UnitFrame::principal(x.as_slice()).scale;
        let limit = fit.map_or(MAX_MOTION * size, |fit| {
            let [least, most] = LIMITS.map(|limit| limit * size);
            let [median, farthest] = fit::distances(fit, x);
            farthest.clamp(least, most).max(TIMES_MEDIAN * median)
        });
        Self {
            ground,
            held,
            fit,
            detector: Detector::new(ground, x),
            shape: LocalShape::new(ground.triangulation, ground.rest),
            carrier: Carrier::new(ground.triangulation, ground.rest),
            surroundings: Surroundings::new(judge),
            judge,
            limit,
            size,
            work: 0,
        }
    }

    fn is_spent(&self) -> bool {
        self.work > BUDGET * self.ground.rest.len()
    }

    /// These positions, with what is broken and what crosses there.
    fn shape(&mut self, positions: Positions) -> Untangled {
        Untangled {
            broken: self.judge.broken(&positions),
            left: self.detector.all_crossings(self.ground, &positions),
            positions,
        }
    }

    /// The positions with a patch that does not cross any more, or less; none where it does not come to that.
    fn freed(
        &mut self,
        shape: &Untangled,
        patch: &[VertexId],
        tries: &[(usize, Start)],
    ) -> Option<Positions> {
        let mut best: Option<Candidate> = None;
        for &how in tries {
            let Some(mut case) = Case::new(self, shape, patch, how) else {
                continue;
            };
            let candidate = case.candidate(best.as_ref());
            self.work += case.work;
            best = candidate.or(best);
            if best.as_ref().is_some_and(|best| self.is_good(best)) {
                break;
            }
        }
        best.map(|best| best.positions)
    }

    fn is_good(&self, candidate: &Candidate) -> bool {
        candidate.left.is_empty() && candidate.excess <= GOOD * self.size
    }

    /// How much farther from the target than before the triangles `rows` come from `x` to `y`; without a target the motion
    /// of the vertices `free` tells.
    fn excess(&self, rows: &[u32], free: &[VertexId], [x, y]: [&Positions; 2]) -> f64 {
        match self.fit {
            Some(fit) => fit::excess(fit, self.ground, rows, [x, y]),
            None => far(free, [x, y]),
        }
    }
}

/// How far the farthest of some vertices moves.
fn far(free: &[VertexId], [x, y]: [&Positions; 2]) -> f64 {
    free.iter()
        .map(|&v| (y[v] - x[v]).norm())
        .fold(0.0, f64::max)
}
