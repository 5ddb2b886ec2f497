//! Edits of landmarks and settings.

use anyhow::{bail, ensure, Context as _, Result};
use mesh_core::{Landmark, Point3};
use serde_json::{json, Value};
use toml::Table;

use super::{Desk, Request, Side};
use crate::pick::{first_hit, Ray};
use crate::scene::mirrored;
use crate::session::{Mark, MarkKind, SourcePlace, MAX_MARKS};

/// A landmark nearer than this share of the longest side to its mirror image has none of its own.
const ON_MIRROR: f64 = 0.01;
/// Longest name of a landmark, in characters.
const MAX_NAME: usize = 80;

/// A place on either shape.
#[derive(Clone, Copy)]
enum Place {
    Source(SourcePlace),
    Target(Point3),
}

impl Desk {
    /// Does what a page asks for.
    pub(super) fn answer(&mut self, request: Request) -> Result<Value> {
        match &request {
            Request::Pick { side, ray } => {
                let place = self.pick(*side, ray);
                return Ok(self.describe(place));
            }
            Request::Curves => return Ok(json!(self.hub.curves())),
            Request::PartFaces { name } => return Ok(self.part_faces(name)),
            Request::Place { side, ray } => {
                self.finish_drag();
                return self.place(*side, ray);
            }
            Request::Drape
            | Request::Pause
            | Request::Resume
            | Request::Step
            | Request::Stop
            | Request::Extend
            | Request::Reset => {
                self.finish_drag();
                self.command(&request)?;
            }
            _ => {
                self.change(request)?;
                self.edited();
            }
        }
        Ok(Value::Null)
    }

    /// Makes an edit.
    fn change(&mut self, request: Request) -> Result<()> {
        if !matches!(request, Request::Drag { .. }) {
            self.finish_drag();
        }
        match request {
            Request::Drag {
                landmark,
                side,
                ray,
                done,
            } => self.drag(landmark, side, ray.as_ref(), done)?,
            Request::Delete { landmark } => {
                self.find(landmark)?;
                self.session.edit(|d| d.marks.retain(|m| m.id != landmark));
            }
            Request::Rename { landmark, name } => {
                let name: String = name.trim().chars().take(MAX_NAME).collect();
                self.change_mark(landmark, |m| m.name = name)?;
            }
            Request::Kind { landmark, kind } => self.change_mark(landmark, |m| m.kind = kind)?,
            Request::Clear => self.session.edit(|d| d.marks.clear()),
            Request::Mirror { axes } => {
                let is_axis = axes.iter().flatten().all(|&axis| axis < 3);
                ensure!(is_axis, "an axis is 0, 1 or 2");
                self.session.edit(|d| d.mirror = axes);
            }
            Request::Part { name, treatment } => self.treat(&name, treatment)?,
            Request::Undo => self.session.undo(),
            Request::Redo => self.session.redo(),
            Request::Preset { name } => {
                let seed = self.settings.config.seed;
                self.set_settings(&format!("preset = {name:?}\nseed = {seed}\n"))?;
            }
            Request::Seed { seed } => {
                let mut table: Table = self.settings.toml.parse()?;
                table.insert("seed".to_owned(), i64::from(seed).into());
                self.set_settings(&table.to_string())?;
            }
            Request::Settings { toml } => self.set_settings(&toml)?,
            _ => bail!("this is no edit"),
        }
        Ok(())
    }

    /// After an edit: settings as the document has them, the preview, every page.
    fn edited(&mut self) {
        if self.settings.toml != self.session.document.settings {
            if let Ok(settings) = self.toolbox.settings(&self.session.document.settings) {
                self.settings = settings;
            }
        }
        if self.dragged_from.is_none() {
            self.pass_on();
        }
        self.ask_preview();
        self.changed();
    }

    fn set_settings(&mut self, toml: &str) -> Result<()> {
        let settings = self.toolbox.settings(toml)?;
        self.session.edit(|d| d.settings.clone_from(&settings.toml));
        Ok(())
    }

    fn find(&self, id: u32) -> Result<&Mark> {
        let mut marks = self.session.document.marks.iter();
        marks
            .find(|m| m.id == id)
            .with_context(|| format!("there is no landmark {id}; it may have been deleted"))
    }

    fn change_mark(&mut self, id: u32, change: impl FnOnce(&mut Mark)) -> Result<()> {
        self.find(id)?;
        self.session.edit(|d| {
            if let Some(mark) = d.marks.iter_mut().find(|m| m.id == id) {
                change(mark);
            }
        });
        Ok(())
    }

    fn pick(&mut self, side: Side, ray: &Ray) -> Option<Place> {
        match side {
            Side::Source => {
                let place = self.source.as_ref()?.pick(ray)?;
                Some(Place::Source(SourcePlace::of(&place)))
            }
            Side::Target => self.target.as_ref()?.pick(ray).map(Place::Target),
            Side::Result => {
                let frame = self.hub.frame.borrow().clone()?;
                let scene = self.scene()?;
                let source = &scene.source;
                if self.shown_bvh.as_ref().map(|(serial, _)| *serial) != Some(frame.serial) {
                    self.shown_bvh = Some((frame.serial, source.moved_bvh(&frame.positions)));
                }
                let (_, bvh) = self.shown_bvh.as_ref()?;
                let location = first_hit(bvh, &scene.target.frame, ray)?;
                Some(Place::Source(SourcePlace::of(&source.place(location)?)))
            }
        }
    }

    /// A place for the page: vertices and weights, or a point, in the frame of the target.
    fn describe(&self, place: Option<Place>) -> Value {
        match place {
            None => Value::Null,
            Some(Place::Source(place)) => json!({ "source": place }),
            Some(Place::Target(point)) => {
                let unit = self.target.as_ref().map(|t| t.frame.to_unit(&point));
                json!({ "target": unit.map(|p| [p.x, p.y, p.z]) })
            }
        }
    }

    /// Completes the newest landmark, moves its only side, or begins another one.
    fn place(&mut self, side: Side, ray: &Ray) -> Result<Value> {
        let Some(place) = self.pick(side, ray) else {
            return Ok(Value::Null);
        };
        let half = self.session.document.marks.iter();
        let half = half.rev().find(|m| m.landmark().is_none()).map(|m| m.id);
        let n_marks = self.session.document.marks.len();
        ensure!(
            half.is_some() || n_marks < MAX_MARKS,
            "{MAX_MARKS} landmarks are enough"
        );
        let id = half.unwrap_or_else(|| self.session.fresh_id());
        let twin_id = self.session.fresh_id();
        let mut document = self.session.document.clone();
        if half.is_none() {
            document.marks.push(Mark {
                id,
                name: String::new(),
                source: None,
                target: None,
                kind: MarkKind::Soft,
            });
        }
        let mut twin = None;
        if let Some(mark) = document.marks.iter_mut().find(|m| m.id == id) {
            place.put(mark);
            let axes = document.mirror.filter(|_| n_marks < MAX_MARKS);
            twin = axes.and_then(|axes| self.twin(mark, axes, twin_id));
        }
        document.marks.extend(twin);
        self.session.edit(|d| *d = document);
        self.edited();
        Ok(json!({ "landmark": id }))
    }

    /// The mirror image of a landmark that is complete, unless it lies on the mirror.
    fn twin(&self, mark: &Mark, [of_source, of_target]: [usize; 2], id: u32) -> Option<Mark> {
        let scene = self.scene()?;
        let landmark = mark.landmark()?;
        let (source, target) = (&scene.source, scene.target.judged());

        let place = landmark.source.position(&source.rest);
        let image = mirrored(&place, of_source, &source.bounds());
        if (image - place).norm() < ON_MIRROR * source.frame.scale {
            return None;
        }
        let twin = Landmark {
            name: landmark.name.as_deref().map(other_side),
            source: source.closest_place(&image)?,
            target: target
                .closest_point(&mirrored(&landmark.target, of_target, &target.bounds()))
                .point,
            kind: landmark.kind,
        };
        Some(Mark::of(id, &twin))
    }

    fn drag(&mut self, id: u32, side: Side, ray: Option<&Ray>, done: bool) -> Result<()> {
        self.find(id)?;
        if let Some(place) = ray.and_then(|ray| self.pick(side, ray)) {
            if self.dragged_from.is_none() {
                self.dragged_from = Some(self.session.document.clone());
            }
            let marks = &mut self.session.document.marks;
            if let Some(mark) = marks.iter_mut().find(|m| m.id == id) {
                place.put(mark);
            }
        }
        if done {
            self.finish_drag();
        }
        Ok(())
    }

    /// What was dragged becomes one edit.
    pub(super) fn finish_drag(&mut self) {
        if let Some(before) = self.dragged_from.take() {
            if before != self.session.document {
                self.session.remember(before);
            }
        }
    }

    /// Takes the landmarks of a file.
    pub(super) fn adopt(&mut self, landmarks: &[Landmark]) -> Result<()> {
        if landmarks.len() > MAX_MARKS {
            bail!("{MAX_MARKS} landmarks are enough");
        }
        self.finish_drag();
        let marks: Vec<Mark> = landmarks
            .iter()
            .map(|l| Mark::of(self.session.fresh_id(), l))
            .collect();
        self.session.edit(|d| d.marks = marks);
        self.edited();
        Ok(())
    }
}

impl Place {
    fn put(self, mark: &mut Mark) {
        match self {
            Self::Source(place) => mark.source = Some(place),
            Self::Target(point) => mark.target = Some(point.into()),
        }
    }
}

/// `left ear` ↔ `right ear`; other names say that they are mirrored.
fn other_side(name: &str) -> String {
    for (one, other) in [
        ("left", "right"),
        ("Left", "Right"),
        ("_l", "_r"),
        (".L", ".R"),
    ] {
        for (from, to) in [(one, other), (other, one)] {
            if name.contains(from) {
                return name.replacen(from, to, 1);
            }
        }
    }
    format!("{name} mirrored")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_change_sides() {
        assert_eq!(other_side("left ear"), "right ear");
        assert_eq!(other_side("hand.R"), "hand.L");
        assert_eq!(other_side("tail"), "tail mirrored");
    }
}
