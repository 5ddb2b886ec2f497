//! Strokes of brushes on the drape in progress. A document says how many of them hold, so that undo takes the newest back.

use mesh_draping::Stroke;

use super::Session;

/// More strokes than this on one drape are a mistake.
pub(super) const MAX_STROKES: usize = 5000;

impl Session {
    /// The strokes that hold.
    pub(crate) fn strokes(&self) -> &[Stroke] {
        let n = self.document.n_strokes.min(self.strokes.len());
        &self.strokes[..n]
    }

    /// Whether there may be another stroke.
    pub(crate) fn has_room_for_strokes(&self) -> bool {
        self.document.n_strokes < MAX_STROKES
    }

    /// Adds a stroke, as one edit.
    pub(crate) fn add_stroke(&mut self, stroke: Stroke) {
        self.strokes.truncate(self.document.n_strokes);
        self.strokes.push(stroke);
        self.edit(|d| d.n_strokes += 1);
    }

    /// Another drape comes with these strokes, which no undo takes back: those before it are of a drape that is gone.
    pub(crate) fn begin_strokes(&mut self, strokes: Vec<Stroke>) {
        let n = strokes.len();
        self.strokes = strokes;
        let others = self.undo.iter_mut().chain(&mut self.redo);
        for document in others.chain([&mut self.document]) {
            document.n_strokes = n;
        }
        // Steps that only were strokes are none any more.
        for steps in [&mut self.undo, &mut self.redo] {
            steps.dedup();
            if steps.last() == Some(&self.document) {
                steps.pop();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_draping::Brush;

    fn stroke(x: f64) -> Stroke {
        Stroke {
            brush: Brush::Relax,
            radius: 0.1,
            strength: 0.5,
            path: vec![[x, 0.0, 0.0]],
        }
    }

    #[test]
    fn strokes_are_undone_one_by_one_and_another_takes_their_place() {
        let mut session = Session::new(String::new());
        for x in [1.0, 2.0, 3.0] {
            session.add_stroke(stroke(x));
        }
        session.undo();
        session.undo();
        assert_eq!(session.strokes(), [stroke(1.0)]);
        session.redo();
        assert_eq!(session.strokes(), [stroke(1.0), stroke(2.0)]);
        session.add_stroke(stroke(4.0));
        assert_eq!(session.strokes(), [1.0, 2.0, 4.0].map(stroke));
        assert!(!session.can_redo());
    }

    #[test]
    fn strokes_of_another_drape_are_no_steps_to_undo() {
        let mut session = Session::new(String::new());
        session.edit(|d| d.dismissed.push(7));
        session.add_stroke(stroke(1.0));
        session.add_stroke(stroke(2.0));
        session.begin_strokes(vec![stroke(3.0)]);
        session.undo();
        assert!(session.document.dismissed.is_empty() && !session.can_undo());
        assert_eq!(session.strokes(), [stroke(3.0)]);
    }
}
