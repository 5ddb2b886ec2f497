//! A curve while it is drawn: its places come one by one, and only the whole is an edit.

use anyhow::{ensure, Context as _, Result};
use mesh_core::{Landmark, Point3, Vector3};
use mesh_draping::landmarks::cut;
use serde_json::{json, Value};

use super::can::OPEN_FIRST;
use super::places::Place;
use super::{Controller, Shape};
use crate::pick::Ray;
use crate::session::{Lines, Mark, MAX_MARKS};

/// A place nearer to the first of its line than this, in longest sides, closes the line.
const CLOSES: f64 = 0.02;
/// A line of fewer places is not closed.
const ENOUGH_TO_CLOSE: usize = 3;
/// More places along a line are a mistake.
const MAX_PLACES: usize = 1000;

/// Whether a place so far from the first of `n` places closes their line, on a shape with this longest side.
fn closes(n: usize, away: Vector3, side: f64) -> bool {
    n >= ENOUGH_TO_CLOSE && away.norm() < CLOSES * side
}

impl Controller {
    /// Adds a place to the curve that is drawn; the numbers of places on source and target, nothing where the ray misses.
    pub(super) fn draw(&mut self, shape: Shape, ray: &Ray) -> Result<Value> {
        let Some(place) = self.pick(shape, ray) else {
            return Ok(Value::Null);
        };
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let rest = displayed.shapes.source.rest();
        let mut lines = self.drawing.take().unwrap_or_default();
        match place {
            Place::Source(place) => {
                let at = place.mesh_point().position(rest);
                let first = lines.source.first().copied();
                let n = lines.source.len();
                let closes = first.filter(|first| {
                    let first = first.mesh_point().position(rest);
                    closes(n, first - at, displayed.source.frame.scale)
                });
                lines.source.push(closes.unwrap_or(place));
            }
            Place::Target(point) => {
                let first = lines.target.first().copied();
                let n = lines.target.len();
                let closes = first.filter(|&first| {
                    closes(n, Point3::from(first) - point, displayed.target.frame.scale)
                });
                lines.target.push(closes.unwrap_or(point.into()));
            }
        }
        lines.source.truncate(MAX_PLACES);
        lines.target.truncate(MAX_PLACES);
        let numbers = json!([lines.source.len(), lines.target.len()]);
        self.drawing = Some(lines);
        self.publish();
        Ok(numbers)
    }

    /// The curve as it is drawn becomes one of the landmarks; its number.
    pub(super) fn end_curve(&mut self) -> Result<Value> {
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let lines = self.drawing.clone().context("no curve is being drawn")?;
        let n_marks = self.session.document.marks.len();
        ensure!(n_marks < MAX_MARKS, "{MAX_MARKS} landmarks are enough");
        let mark = Mark {
            curve: Some(lines),
            ..Mark::empty(self.session.next_id)
        };
        let curve = mark.curve().context("no curve is being drawn")?;
        cut(curve, &displayed.shapes.source).context("the curve cannot be taken")?;
        let id = self.session.fresh_id();
        self.drawing = None;
        self.session.edit(|d| d.marks.push(mark));
        self.edited();
        Ok(json!({ "landmark": id }))
    }

    /// Gives up the curve that is drawn; there is nothing to answer.
    pub(super) fn cancel_curve(&mut self) -> Value {
        self.drawing = None;
        self.publish();
        Value::Null
    }

    /// The curve that is drawn, for pages; nothing where none is.
    pub(super) fn drawing_state(&self) -> Value {
        let Some(lines) = &self.drawing else {
            return Value::Null;
        };
        let target = lines.target.iter().map(|&p| self.in_frame(&p.into()));
        json!({ "source": lines.source, "target": target.collect::<Vec<_>>() })
    }

    /// The curves for pages: places along both lines, evenly spaced.
    pub(super) fn curves_state(&self) -> Vec<Value> {
        let marks = &self.session.document.marks;
        let curves = marks.iter().filter(|mark| mark.curve.is_some());
        curves
            .enumerate()
            .map(|(number, mark)| self.curve_state(number, mark))
            .collect()
    }

    fn curve_state(&self, number: usize, mark: &Mark) -> Value {
        let source = self.source.as_ref().map(|source| &source.source);
        let cut = source
            .zip(mark.curve())
            .map(|(source, curve)| cut(curve, source));
        let cut: Vec<Landmark> = cut.and_then(Result::ok).unwrap_or_default();
        let places = cut
            .iter()
            .map(|l| crate::session::SourcePlace::of(&l.source));
        let points = cut.iter().map(|l| self.in_frame(&l.target));
        let is_closed = mark.curve.as_ref().is_some_and(Lines::is_closed);
        json!({
            "id": mark.id,
            "number": number,
            "name": mark.name,
            "weight": mark.weight,
            "is_closed": is_closed,
            "source": places.collect::<Vec<_>>(),
            "target": points.collect::<Vec<_>>(),
        })
    }

    /// A point of the target in the frame that pages have it in.
    fn in_frame(&self, point: &Point3) -> Option<[f64; 3]> {
        let unit = self.target.as_ref()?.frame.to_unit(point);
        Some([unit.x, unit.y, unit.z])
    }
}
