//! Places on the shapes: marked, mirrored, dragged.

use anyhow::{ensure, Result};
use mesh_core::Point3;
use mesh_draping::landmarks::{counterpart, MirrorPlanes, Plane};
use serde_json::{json, Value};

use super::{Controller, Shape};
use crate::pick::{first_hit, Ray};
use crate::session::{Mark, MarkKind, SourcePlace, MAX_MARKS};

/// A place on either shape.
#[derive(Clone, Copy)]
pub(super) enum Place {
    Source(SourcePlace),
    Target(Point3),
}

impl Controller {
    /// The place that a ray meets first.
    pub(super) fn pick(&mut self, shape: Shape, ray: &Ray) -> Option<Place> {
        match shape {
            Shape::Source => {
                let place = self.source.as_ref()?.pick(ray)?;
                Some(Place::Source(SourcePlace::of(&place)))
            }
            Shape::Target => self.target.as_ref()?.pick(ray).map(Place::Target),
            Shape::Result => {
                let shown = self.broadcast.shown.borrow().clone()?;
                let displayed = self.displayed.as_ref()?;
                let source = &displayed.source;
                if self.shown_bvh.as_ref().map(|(serial, _)| *serial) != Some(shown.serial) {
                    self.shown_bvh = Some((shown.serial, source.moved_bvh(&shown.positions)));
                }
                let (_, bvh) = self.shown_bvh.as_ref()?;
                let location = first_hit(bvh, &displayed.target.frame, ray)?;
                Some(Place::Source(SourcePlace::of(
                    &source.source.place(location)?,
                )))
            }
        }
    }

    /// Completes the newest landmark, moves its only side, or begins another one.
    pub(super) fn place(&mut self, shape: Shape, ray: &Ray) -> Result<Value> {
        let Some(place) = self.pick(shape, ray) else {
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
        let shapes = &self.displayed.as_ref()?.shapes;
        let planes = MirrorPlanes {
            source: Plane::through_middle(&shapes.source.bounds(), of_source),
            target: Plane::through_middle(&shapes.target.judged().bounds(), of_target),
        };
        let pair = shapes.pair(Vec::new());
        let twin = counterpart(&pair, &mark.landmark()?, &planes)?;
        Some(Mark::of(id, &twin))
    }

    pub(super) fn drag(
        &mut self,
        id: u32,
        shape: Shape,
        ray: Option<&Ray>,
        done: bool,
    ) -> Result<()> {
        self.find(id)?;
        if let Some(place) = ray.and_then(|ray| self.pick(shape, ray)) {
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
}

impl Place {
    fn put(self, mark: &mut Mark) {
        match self {
            Self::Source(place) => mark.source = Some(place),
            Self::Target(point) => mark.target = Some(point.into()),
        }
    }
}
