//! Places on the shapes: marked, mirrored, dragged.

use anyhow::{bail, ensure, Result};
use mesh_core::{MeshPoint, Point3, VertexId};
use mesh_draping::landmarks::{counterpart, MirrorPlanes, Plane};
use mesh_draping::{SnapPoints, SNAP_REACH};
use serde_json::{json, Value};

use super::request::Snap;
use super::{Controller, Shape};
use crate::pick::{first_hit, Ray};
use crate::session::{numbers, Mark, SourcePlace, MAX_MARKS};

/// Marks nearer to each other than this, in longest sides, are at one place.
const SAME_PLACE: f64 = 0.002;

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

    /// The place that a ray meets first, or that it snaps to.
    pub(super) fn pick_snapped(
        &mut self,
        shape: Shape,
        ray: &Ray,
        snap: Option<Snap>,
    ) -> Option<Place> {
        let place = self.pick(shape, ray)?;
        let Some(snap) = snap else {
            return Some(place);
        };
        match place {
            Place::Source(place) => {
                let source = self.source.as_ref()?;
                let at = place.mesh_point().position(source.source.rest());
                let row = snap.vertex(source.snap_points(), &at, source.frame.scale)?;
                let vertex = MeshPoint::vertex(VertexId::new(row));
                Some(Place::Source(SourcePlace::of(&vertex)))
            }
            Place::Target(at) => {
                let target = self.target.as_ref()?;
                let points = target.snap_points();
                let row = snap.vertex(points, &at, target.frame.scale)?;
                points.point(row).map(Place::Target)
            }
        }
    }

    /// Completes the newest landmark, moves its only side, or begins another one.
    pub(super) fn place(&mut self, shape: Shape, ray: &Ray, snap: Option<Snap>) -> Result<Value> {
        let Some(place) = self.pick_snapped(shape, ray, snap) else {
            return Ok(Value::Null);
        };
        let half = self.half_made(&place);
        self.check_single(&place, half)?;
        let n_marks = self.session.document.marks.len();
        ensure!(
            half.is_some() || n_marks < MAX_MARKS,
            "{MAX_MARKS} landmarks are enough"
        );
        let id = half.unwrap_or_else(|| self.session.fresh_id());
        let twin_id = self.session.fresh_id();
        let mut document = self.session.document.clone();
        if half.is_none() {
            document.marks.push(Mark::empty(id));
        }
        let mut twin = None;
        if let Some(mark) = document.marks.iter_mut().find(|m| m.id == id) {
            place.put(mark);
            let axes = document.mirror.filter(|_| n_marks < MAX_MARKS);
            twin = axes.and_then(|axes| self.twin(mark, axes, twin_id));
        }
        if let Some(twin) = twin {
            self.add_twin(&mut document.marks, twin);
        }
        self.session.edit(|d| *d = document);
        self.edited();
        Ok(json!({ "landmark": id }))
    }

    /// The mark that a place belongs to: the first that waits for one on this shape, else the only one that is half made,
    /// whose side moves; none where another is begun.
    fn half_made(&self, place: &Place) -> Option<u32> {
        let half = || {
            let marks = self.session.document.marks.iter();
            marks.filter(|m| !m.is_complete())
        };
        let waiting = half().find(|mark| place.is_missing_of(mark));
        let only = half().next().filter(|_| half().count() == 1);
        waiting.or(only).map(|mark| mark.id)
    }

    /// Refuses a second mark at one place.
    fn check_single(&self, place: &Place, own: Option<u32>) -> Result<()> {
        let marks = &self.session.document.marks;
        let others = numbers(marks).zip(marks).filter(|(_, m)| Some(m.id) != own);
        for (number, mark) in others {
            if self.is_same(place, mark) {
                let number = number.map_or("one half made".to_owned(), |n| n.to_string());
                bail!("landmark {number} is at this place already; drag it to move it");
            }
        }
        Ok(())
    }

    /// Whether a mark is at a place already.
    fn is_same(&self, place: &Place, mark: &Mark) -> bool {
        match place {
            Place::Target(point) => {
                let side = self.target.as_ref().map_or(0.0, |t| t.frame.scale);
                let there = mark.target.map(Point3::from);
                there.is_some_and(|there| (there - point).norm() < SAME_PLACE * side)
            }
            Place::Source(place) => self.source.as_ref().is_some_and(|source| {
                let at = |p: &SourcePlace| p.mesh_point().position(source.source.rest());
                let there = mark.source.as_ref().map(at);
                let side = source.frame.scale;
                there.is_some_and(|there| (there - at(place)).norm() < SAME_PLACE * side)
            }),
        }
    }

    /// Adds a mirror image; where a mark is there already, that one gets what it lacks.
    fn add_twin(&self, marks: &mut Vec<Mark>, twin: Mark) {
        let sides = [
            twin.source.map(Place::Source),
            twin.target.map(|p| Place::Target(p.into())),
        ];
        let there = marks.iter_mut().find(|mark| {
            let mut sides = sides.iter().flatten();
            sides.any(|side| self.is_same(side, mark))
        });
        match there {
            None => marks.push(twin),
            Some(mark) => {
                mark.source = mark.source.or(twin.source);
                mark.target = mark.target.or(twin.target);
            }
        }
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

    /// Moves a landmark to a place, if there is one.
    pub(super) fn drag(&mut self, id: u32, to: Option<Place>, done: bool) -> Result<()> {
        self.find(id)?;
        if let Some(place) = to {
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

    /// What was dragged or painted becomes one edit.
    pub(super) fn finish_drag(&mut self) {
        // Whoever painted has been told by then why a stroke cannot be; it is forgotten.
        drop(self.finish_stroke());
        self.finish_brushing();
        if let Some(before) = self.dragged_from.take() {
            if before != self.session.document {
                self.session.remember(before);
            }
        }
    }
}

impl Snap {
    /// The vertex that a place of a shape snaps to; `side` is the longest side of its box.
    fn vertex(self, points: &SnapPoints, at: &Point3, side: f64) -> Option<usize> {
        match self {
            Self::Vertex => points.nearest(at),
            Self::Curvature => points.most_curved(at, SNAP_REACH * side),
        }
    }
}

impl Place {
    /// Whether a mark has no place on this shape.
    fn is_missing_of(&self, mark: &Mark) -> bool {
        match self {
            Self::Source(_) => mark.source.is_none(),
            Self::Target(_) => mark.target.is_none(),
        }
    }

    fn put(self, mark: &mut Mark) {
        match self {
            Self::Source(place) => mark.source = Some(place),
            Self::Target(point) => mark.target = Some(point.into()),
        }
    }
}
