//! What a drape came to, as notes, and what its refinement takes from it.

use mesh_loss::Overlap;
use neural_drape::{Defects, Drape, OverlapMode, Repair};

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

/// What the last stage took out, and what it could not.
pub(crate) fn repaired(end: &Repair, pair: &Pair) -> Vec<Note> {
    let row = |v| pair.source.file_row(v);
    let triangles = pair.source.triangulation().triangles();
    let count = |d: &Defects| d.folds.len() + d.skinny.len();
    let (n_before, n_left) = (count(&end.before), count(&end.left));
    let mut notes = Vec::new();
    if n_before > n_left {
        notes.push(Note::Repaired {
            n: n_before - n_left,
        });
    }
    notes.extend(end.left.folds.iter().map(|&ends| Note::FoldLeft {
        rows: ends.map(row),
    }));
    notes.extend(end.left.skinny.iter().map(|&t| Note::SkinnyLeft {
        rows: triangles[t].map(row),
    }));
    notes
}
