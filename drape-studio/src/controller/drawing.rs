//! A curve while it is drawn: its places come one by one, and only the whole is an edit.

use anyhow::{ensure, Context as _, Result};
use mesh_core::{Point3, Vector3};
use mesh_draping::landmarks::{curve_image, cut};
use serde_json::{json, Value};

use super::can::OPEN_FIRST;
use super::places::Place;
use super::{Controller, Shape};
use crate::pick::Ray;
use crate::session::{numbers, Lines, Mark, SourcePlace, MAX_MARKS};

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

/// A curve that is being drawn.
#[derive(Default)]
pub(super) struct Drawing {
    /// The curve that waits for one of its lines; none where another one is begun.
    of: Option<u32>,
    /// The line that it has already.
    given: Lines,
    /// The places that were drawn, in order.
    places: Vec<Place>,
    /// Those that were taken back, the newest last.
    taken_back: Vec<Place>,
}

impl Drawing {
    /// The two lines as far as they are drawn.
    fn lines(&self) -> Lines {
        let mut lines = self.given.clone();
        for place in &self.places {
            match place {
                Place::Source(place) => lines.source.push(*place),
                Place::Target(point) => lines.target.push((*point).into()),
            }
        }
        lines
    }

    /// Whether there is a place to take back.
    pub(super) fn can_undo(&self) -> bool {
        !self.places.is_empty()
    }

    /// Whether there is a place to draw again.
    pub(super) fn can_redo(&self) -> bool {
        !self.taken_back.is_empty()
    }

    /// Takes the newest place back.
    pub(super) fn undo(&mut self) {
        self.taken_back.extend(self.places.pop());
    }

    /// Draws the place again that was taken back last.
    pub(super) fn redo(&mut self) {
        self.places.extend(self.taken_back.pop());
    }
}

impl Controller {
    /// Adds a place to the curve that is drawn; the numbers of places on source and target, nothing where the ray misses.
    pub(super) fn draw(&mut self, shape: Shape, ray: &Ray) -> Result<Value> {
        let Some(place) = self.pick(shape, ray) else {
            return Ok(Value::Null);
        };
        let lines = self.drawing.as_ref().map(Drawing::lines);
        let place = self.closed(&lines.unwrap_or_default(), place)?;
        let drawing = self.drawing.get_or_insert_default();
        if drawing.places.len() < MAX_PLACES {
            drawing.places.push(place);
        }
        drawing.taken_back.clear();
        let lines = drawing.lines();
        self.publish();
        Ok(json!([lines.source.len(), lines.target.len()]))
    }

    /// The place itself, or the first of its line where it closes that.
    fn closed(&self, lines: &Lines, place: Place) -> Result<Place> {
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let rest = displayed.shapes.source.rest();
        let first = match place {
            Place::Source(place) => lines
                .source
                .first()
                .filter(|first| {
                    let [first, at] = [*first, &place].map(|p| p.mesh_point().position(rest));
                    let side = displayed.source.frame.scale;
                    closes(lines.source.len(), first - at, side)
                })
                .map(|&first| Place::Source(first)),
            Place::Target(point) => lines
                .target
                .first()
                .filter(|first| {
                    let side = displayed.target.frame.scale;
                    closes(lines.target.len(), Point3::from(**first) - point, side)
                })
                .map(|&first| Place::Target(first.into())),
        };
        Ok(first.unwrap_or(place))
    }

    /// Goes on with a curve that waits for its line on another scan; there is nothing to answer.
    pub(super) fn take_up_curve(&mut self, id: u32) -> Result<Value> {
        let lines = self.find(id)?.curve.clone();
        let given = lines.filter(|lines| !lines.is_complete());
        self.drawing = Some(Drawing {
            of: Some(id),
            given: given.context("this curve has both its lines")?,
            ..Drawing::default()
        });
        self.publish();
        Ok(Value::Null)
    }

    /// The curve as it is drawn becomes one of the landmarks, and that of the other half where places are mirrored; its number.
    pub(super) fn end_curve(&mut self) -> Result<Value> {
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let drawing = self.drawing.as_ref().context("no curve is being drawn")?;
        let marks = &self.session.document.marks;
        let waiting = marks.iter().find(|m| Some(m.id) == drawing.of);
        let is_new = waiting.is_none();
        ensure!(
            !is_new || marks.len() < MAX_MARKS,
            "{MAX_MARKS} landmarks are enough"
        );
        let mark = Mark {
            curve: Some(drawing.lines()),
            ..waiting
                .cloned()
                .unwrap_or_else(|| Mark::empty(self.session.next_id))
        };
        let lines = drawing.lines();
        let curve = lines.curve(mark.given_name(), mark.weight);
        cut(curve.clone(), &displayed.shapes.source).context("the curve cannot be taken")?;
        let twin = self.curve_twin(&curve);
        if is_new {
            self.session.fresh_id();
        }
        let (id, twin_id) = (mark.id, self.session.fresh_id());
        let mut marks = self.session.document.marks.clone();
        match marks.iter_mut().find(|m| m.id == id) {
            Some(waiting) => *waiting = mark,
            None => marks.push(mark),
        }
        if let Some(twin) = twin.filter(|_| marks.len() < MAX_MARKS) {
            self.add_curve_twin(&mut marks, &twin, twin_id);
        }
        self.drawing = None;
        self.session.edit(|d| d.marks = marks);
        self.edited();
        Ok(json!({ "landmark": id }))
    }

    /// Gives up the curve that is drawn; there is nothing to answer.
    pub(super) fn cancel_curve(&mut self) -> Value {
        self.drawing = None;
        self.publish();
        Value::Null
    }

    /// The curve that is drawn, for pages, with its mirror image where places are mirrored; nothing where none is.
    pub(super) fn drawing_state(&self) -> Value {
        let Some(drawing) = &self.drawing else {
            return Value::Null;
        };
        let lines = drawing.lines();
        let image = self.mirror_planes().and_then(|planes| {
            let pair = self.displayed.as_ref()?.shapes.pair(Vec::new());
            curve_image(&pair, &lines.curve(None, 1.0), &planes)
        });
        let mut state = self.lines_state(&lines);
        state["of"] = json!(drawing.of);
        state["twin"] = json!(image.map(|curve| self.lines_state(&Lines::of(&curve))));
        state
    }

    fn lines_state(&self, lines: &Lines) -> Value {
        let target = lines.target.iter().map(|&p| self.in_frame(&p.into()));
        json!({ "source": lines.source, "target": target.collect::<Vec<_>>() })
    }

    /// The curves for pages: places along both lines, evenly spaced.
    pub(super) fn curves_state(&self) -> Vec<Value> {
        let marks = &self.session.document.marks;
        let curves = numbers(marks).zip(marks);
        let curves = curves.filter(|(_, mark)| mark.curve.is_some());
        curves
            .map(|(number, mark)| self.curve_state(number, mark))
            .collect()
    }

    fn curve_state(&self, number: Option<usize>, mark: &Mark) -> Value {
        let lines = mark.curve.as_ref();
        let mut state = match lines.filter(|lines| !lines.is_complete()) {
            Some(half) => self.lines_state(half),
            None => {
                let cut = self.cuts.of(mark.id).iter();
                self.lines_state(&Lines {
                    source: cut.clone().map(|l| SourcePlace::of(&l.source)).collect(),
                    target: cut.map(|l| l.target.into()).collect(),
                })
            }
        };
        state["id"] = json!(mark.id);
        state["number"] = json!(number);
        state["name"] = json!(mark.name);
        state["weight"] = json!(mark.weight);
        state["is_closed"] = json!(lines.is_some_and(Lines::is_closed));
        state
    }

    /// A point of the target in the frame that pages have it in.
    fn in_frame(&self, point: &Point3) -> Option<[f64; 3]> {
        let unit = self.target.as_ref()?.frame.to_unit(point);
        Some([unit.x, unit.y, unit.z])
    }
}
