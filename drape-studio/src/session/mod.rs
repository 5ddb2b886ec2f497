//! A session: inputs, landmarks, settings, every edit, and the drape in progress.

mod file;
mod kept;
mod log;
mod mark;
mod painted;
mod strokes;

pub(crate) use file::{fnv1a, read, InputRecord};
pub(crate) use kept::{Kept, NamedSettings};
pub(crate) use log::{Change, Event, RunLog};
pub(crate) use mark::{fingerprint, landmarks, numbers, Lines, Mark, MarkKind, SourcePlace};
pub(crate) use painted::{painted_rigid, RIGID_FOLDER};

use serde::{Deserialize, Serialize};

use mesh_draping::{Parts, Stroke};

/// How many edits can be undone.
const MAX_UNDO: usize = 200;
/// More landmarks than this are a mistake.
pub(crate) const MAX_MARKS: usize = 1000;

/// What a session file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Session {
    version: u32,
    pub(crate) source: Option<InputRecord>,
    pub(crate) target: Option<InputRecord>,
    /// What edits change.
    pub(crate) document: Document,
    pub(crate) next_id: u32,
    pub(crate) run: Option<RunLog>,
    /// Results that were kept, in order.
    #[serde(default)]
    pub(crate) kept: Vec<Kept>,
    /// Targets that wait for their turn.
    #[serde(default)]
    pub(crate) queue: Vec<InputRecord>,
    /// Every stroke of a brush on the drape in progress, those that were undone last.
    #[serde(default)]
    strokes: Vec<Stroke>,
    undo: Vec<Document>,
    redo: Vec<Document>,
}

/// What edits change and undo brings back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Document {
    pub(crate) marks: Vec<Mark>,
    /// Settings of the next drape, as TOML.
    pub(crate) settings: String,
    /// The axis of source and of target across which landmarks are placed twice; none where they are not.
    #[serde(default)]
    pub(crate) mirror: Option<[usize; 2]>,
    /// Parts of the source that the next drape treats in their own way.
    #[serde(default)]
    pub(crate) parts: Parts,
    /// Settings under names of the user's.
    #[serde(default)]
    pub(crate) saved: Vec<NamedSettings>,
    /// Kept results that were taken out of the list.
    #[serde(default)]
    pub(crate) dismissed: Vec<u32>,
    /// How many strokes hold.
    #[serde(default)]
    pub(crate) n_strokes: usize,
}

impl Session {
    /// A session in which nothing was opened yet.
    pub(crate) fn new(settings: String) -> Self {
        Self {
            version: file::VERSION,
            source: None,
            target: None,
            document: Document {
                marks: Vec::new(),
                settings,
                mirror: None,
                parts: Parts::default(),
                saved: Vec::new(),
                dismissed: Vec::new(),
                n_strokes: 0,
            },
            next_id: 1,
            run: None,
            kept: Vec::new(),
            queue: Vec::new(),
            strokes: Vec::new(),
            undo: Vec::new(),
            redo: Vec::new(),
        }
    }

    /// Changes the document as one step that can be undone; what changes nothing is no step.
    pub(crate) fn edit<T>(&mut self, change: impl FnOnce(&mut Document) -> T) -> T {
        let before = self.document.clone();
        let answer = change(&mut self.document);
        if before != self.document {
            self.remember(before);
        }
        answer
    }

    /// Makes `before` what undo goes back to.
    pub(crate) fn remember(&mut self, before: Document) {
        self.undo.push(before);
        if self.undo.len() > MAX_UNDO {
            self.undo.remove(0);
        }
        self.redo.clear();
    }

    /// Takes the last edit back.
    pub(crate) fn undo(&mut self) {
        if let Some(before) = self.undo.pop() {
            self.redo
                .push(std::mem::replace(&mut self.document, before));
        }
    }

    /// Makes the last edit that was taken back again.
    pub(crate) fn redo(&mut self) {
        if let Some(after) = self.redo.pop() {
            self.undo.push(std::mem::replace(&mut self.document, after));
        }
    }

    pub(crate) fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    pub(crate) fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    /// A number that no mark of this session has had.
    pub(crate) fn fresh_id(&mut self) -> u32 {
        let id = self.next_id;
        self.next_id = self.next_id.saturating_add(1);
        id
    }

    /// Another target comes: the landmarks wait in order for their places on it; curves are drawn anew.
    pub(crate) fn wait_for_target(&mut self) {
        let marks = &mut self.document.marks;
        marks.retain(|mark| mark.source.is_some());
        marks.iter_mut().for_each(|mark| mark.target = None);
        self.forget_edits();
    }

    /// Another source comes: the landmarks wait in order for their places on it; curves are drawn anew.
    pub(crate) fn wait_for_source(&mut self) {
        let marks = &mut self.document.marks;
        marks.retain(|mark| mark.target.is_some());
        marks.iter_mut().for_each(|mark| mark.source = None);
        self.document.parts = Parts::default();
        self.forget_edits();
    }

    fn forget_edits(&mut self) {
        self.undo.clear();
        self.redo.clear();
        self.begin_strokes(Vec::new());
        self.run = None;
    }

    /// Forgets what depends on inputs that are no longer there.
    pub(crate) fn forget_places(&mut self) {
        self.document.marks.clear();
        self.document.parts = Parts::default();
        self.forget_edits();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(id: u32) -> Mark {
        Mark {
            target: Some([f64::from(id); 3]),
            ..Mark::empty(id)
        }
    }

    #[test]
    fn every_edit_is_undone_and_redone() {
        let mut session = Session::new(String::new());
        for id in 0..3 {
            session.edit(|d| d.marks.push(mark(id)));
        }
        session.edit(|_| ());
        session.undo();
        session.undo();
        assert_eq!(session.document.marks.len(), 1);
        session.redo();
        assert_eq!(session.document.marks, [mark(0), mark(1)]);
        session.edit(|d| d.marks.clear());
        assert!(session.can_undo() && !session.can_redo());
        for _ in 0..9 {
            session.undo();
        }
        assert!(session.document.marks.is_empty() && !session.can_undo());
    }

    #[test]
    fn undo_has_an_end() {
        let mut session = Session::new(String::new());
        for id in 0..2 * MAX_UNDO as u32 {
            session.edit(|d| d.marks = vec![mark(id)]);
        }
        assert_eq!(session.undo.len(), MAX_UNDO);
    }
}
