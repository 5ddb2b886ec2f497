//! What a drape came to, as notes, and what its refinement takes from it.

use mesh_core::{Positions, UnionFind, VertexId};
use mesh_loss::Overlap;
use mesh_metrics::{folded_edges, skinny_triangles, Counterparts};
use neural_drape::{Defects, Drape, OverlapMode, Regions, Repair};

use crate::population::{Completion, Population};
use crate::{Note, Pair, Shape};

/// What the refinement takes as lying beyond: what the drape of the stand-in came to.
pub(crate) fn decided_overlap(coarse: &Drape, asked: OverlapMode) -> OverlapMode {
    let Overlap {
        target_exceeds,
        mesh_exceeds,
    } = coarse.overlap();
    // A part that no boundary of the target marks is found again.
    if coarse.is_mesh_part_left_out() && !mesh_exceeds {
        return asked;
    }
    match (target_exceeds, mesh_exceeds) {
        (false, false) => OverlapMode::Full,
        (true, false) => OverlapMode::SourcePartial,
        (false, true) => OverlapMode::TargetPartial,
        (true, true) => OverlapMode::BothPartial,
    }
}

/// What the run takes as lying beyond the other shape.
pub(crate) fn left_out(drape: &Drape) -> impl Iterator<Item = Note> {
    let beyond = drape.beyond();
    let parts = [
        (
            drape.overlap().target_exceeds,
            Shape::Target,
            beyond.of_target,
        ),
        (drape.is_mesh_part_left_out(), Shape::Source, beyond.of_mesh),
    ];
    parts
        .into_iter()
        .filter(|&(is_left_out, ..)| is_left_out)
        .map(|(_, shape, share)| Note::LeftOut { shape, share })
}

/// A result and what is known of it where a population shall complete it.
pub(crate) struct Incomplete<'a> {
    pub(crate) pair: &'a Pair,
    pub(crate) draped: &'a Positions,
    pub(crate) counterparts: &'a Counterparts,
    pub(crate) regions: &'a Regions,
}

impl Incomplete<'_> {
    /// With the vertices that have no counterpart where the population expects them; none where there are none, or where that
    /// would make new folds or skinny triangles. Free and rigid parts stay.
    pub(crate) fn completed(&self, population: &Population) -> Option<Completion> {
        let target = self.pair.target.draped_over().as_ref();
        let hits = target.closest_points(self.draped.as_slice());
        let is_kept = |v: VertexId| {
            let (regions, hit) = (self.regions, &hits[v.index()]);
            regions.rigid[v]
                || regions.attraction[v] == 0.0
                || self.counterparts.has_vertex(v, hit, target)
        };
        let completion = population.completed(self.pair, self.draped, is_kept);
        let n_before = self.n_defects(self.draped);
        completion.filter(|c| self.n_defects(&c.positions) <= n_before)
    }

    fn n_defects(&self, x: &Positions) -> usize {
        let source = &self.pair.source;
        let triangulation = source.triangulation();
        let n_folds = folded_edges(triangulation, source.rest(), x).len();
        n_folds + skinny_triangles(triangulation, x).len()
    }
}

/// What the last stage took out, and what it could not.
pub(crate) fn repaired(end: &Repair, pair: &Pair) -> Vec<Note> {
    let row = |v| pair.source.file_row(v);
    let triangles = pair.source.triangulation().triangles();
    let count = |d: &Defects| d.folds.len() + d.skinny.len();
    let taken_out = |count: &dyn Fn(&Defects) -> usize| {
        let n = count(&end.before).saturating_sub(count(&end.left));
        (n > 0).then_some(n)
    };
    let mut notes = Vec::new();
    notes.extend(taken_out(&count).map(|n| Note::Repaired { n }));
    notes.extend(taken_out(&|d| d.crossings.len()).map(|n| Note::Uncrossed { n }));
    notes.extend(end.left.folds.iter().map(|&ends| Note::FoldLeft {
        rows: ends.map(row),
    }));
    notes.extend(end.left.skinny.iter().map(|&t| Note::SkinnyLeft {
        rows: triangles[t].map(row),
    }));
    notes.extend(crossings_left(end, pair));
    notes
}

/// What still crosses, one note for each connected place.
fn crossings_left(end: &Repair, pair: &Pair) -> Vec<Note> {
    let triangulation = pair.source.triangulation();
    let corners = |t: usize| triangulation.triangles()[t];
    let mut sets = UnionFind::new(triangulation.n_vertices());
    let mut n_pairs = vec![0; triangulation.n_vertices()];
    for &[one, two] in &end.left.crossings {
        for v in corners(one).into_iter().chain(corners(two)) {
            sets.union(corners(one)[0].index(), v.index());
        }
    }
    for &[one, _] in &end.left.crossings {
        n_pairs[sets.find(corners(one)[0].index())] += 1;
    }
    let places = n_pairs.iter().enumerate().filter(|(_, n)| **n > 0);
    let note = |(v, &n): (usize, &usize)| Note::CrossingLeft {
        row: pair.source.file_row(VertexId::new(v)),
        n,
    };
    places.map(note).collect()
}
