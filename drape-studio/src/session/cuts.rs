//! The landmarks that curves are cut into, found once: the shortest ways along a source take long to find.

use mesh_core::{Curve, Landmark};
use mesh_draping::landmarks::cut;
use mesh_draping::Source;

use super::Mark;

/// The curves of some marks on one source, cut.
#[derive(Default)]
pub(crate) struct Cuts {
    source: Option<Source>,
    known: Vec<Known>,
}

struct Known {
    mark: u32,
    curve: Curve,
    landmarks: Vec<Landmark>,
}

impl Cuts {
    /// Cuts what is not cut yet of the curves of some marks, and forgets the others.
    pub(crate) fn renew(&mut self, marks: &[Mark], source: &Source) {
        if !self.source.as_ref().is_some_and(|s| s.is_same(source)) {
            self.source = Some(source.clone());
            self.known.clear();
        }
        let mut before = std::mem::take(&mut self.known);
        let curves = marks.iter().filter_map(|m| Some((m.id, m.curve()?)));
        let mut known = |(mark, curve)| {
            let mut all = before.iter();
            let row = all.position(|k| k.mark == mark && k.curve == curve);
            row.map(|row| before.swap_remove(row)).unwrap_or_else(|| {
                // One that cannot be cut, which no page draws, has none.
                let landmarks = cut(curve.clone(), source).unwrap_or_default();
                Known {
                    mark,
                    curve,
                    landmarks,
                }
            })
        };
        self.known = curves.map(&mut known).collect();
    }

    /// The landmarks of a mark's curve.
    pub(crate) fn of(&self, mark: u32) -> &[Landmark] {
        let known = self.known.iter().find(|known| known.mark == mark);
        known.map_or(&[], |known| &known.landmarks)
    }

    /// The landmarks of all marks that have both sides, and after them those of the curves.
    pub(crate) fn landmarks(&self, marks: &[Mark]) -> Vec<Landmark> {
        let points = marks.iter().filter_map(Mark::landmark);
        let curves = self.known.iter().flat_map(|known| &known.landmarks);
        points.chain(curves.cloned()).collect()
    }
}
