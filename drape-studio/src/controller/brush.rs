//! Brushes on the result: what a stroke does is shown at once, and done by the drape when it ends.

use std::sync::Arc;

use anyhow::{ensure, Context as _, Result};
use mesh_core::{Positions, VertexData};
use mesh_draping::{BrushInput, Stroke};
use serde_json::Value;

use super::can::{Action, OPEN_FIRST};
use super::places::Place;
use super::request::{BrushDab, Shape};
use super::Controller;
use crate::broadcast::ShownKind;
use crate::runner::Order;

/// A stroke that goes on, and the shape as far as it is brushed.
pub(super) struct Brushing {
    stroke: Stroke,
    positions: Positions,
    held: VertexData<bool>,
}

impl Controller {
    /// Brushes where a ray meets the result; what misses it does nothing.
    pub(super) fn brush(&mut self, dab: &BrushDab) -> Result<Value> {
        if self.brushing.is_none() {
            self.begin_brushing(dab)?;
        }
        self.put_brush(dab)?;
        if dab.done {
            self.finish_brushing();
            self.edited();
        }
        Ok(Value::Null)
    }

    fn begin_brushing(&mut self, dab: &BrushDab) -> Result<()> {
        self.situation().check(Action::Brush)?;
        ensure!(
            self.session.has_room_for_strokes(),
            "these are enough strokes for one drape"
        );
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let stroke = Stroke {
            brush: dab.brush,
            radius: dab.radius * displayed.target.frame.scale,
            strength: dab.strength,
            path: Vec::new(),
        };
        stroke.check()?;
        // A stroke before this one may not be done yet.
        if self.are_strokes_pending() {
            self.bring_to_rest()?;
        }
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let drape = self.broadcast.draped().context("nothing is shown yet")?;
        let parts = &self.session.document.parts;
        self.brushing = Some(Brushing {
            stroke,
            positions: drape.positions.as_ref().clone(),
            held: displayed.shapes.regions(parts)?.rigid,
        });
        Ok(())
    }

    /// Lets the brush go to where a ray meets the result, and shows what that does.
    fn put_brush(&mut self, dab: &BrushDab) -> Result<()> {
        let ray = dab.ray.as_ref();
        let Some(Place::Source(place)) = ray.and_then(|ray| self.pick(Shape::Result, ray)) else {
            return Ok(());
        };
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let Some(brushing) = &mut self.brushing else {
            return Ok(());
        };
        let Brushing {
            stroke,
            positions,
            held,
        } = brushing;
        let at = place.mesh_point().position(positions);
        stroke.path.push(at.into());
        let pair = displayed.shapes.pair(Vec::new());
        let input = BrushInput { pair: &pair, held };
        stroke.apply_place(input, positions, stroke.path.len() - 1);
        let shown = Arc::new(positions.clone());
        self.broadcast.show(&displayed, ShownKind::Adjusted, shown);
        Ok(())
    }

    /// The stroke that went on becomes one edit, and the drape does it.
    pub(super) fn finish_brushing(&mut self) {
        let Some(Brushing { stroke, .. }) = self.brushing.take() else {
            return;
        };
        if !stroke.path.is_empty() {
            self.session.add_stroke(stroke);
            self.order_strokes();
        }
    }

    /// Whether the drape has not done the strokes that hold.
    pub(super) fn are_strokes_pending(&self) -> bool {
        self.run
            .as_ref()
            .is_some_and(|run| !run.log.strokes().into_iter().eq(self.session.strokes()))
    }

    /// Hands the drape the strokes as they are; they are on disk by then.
    pub(super) fn order_strokes(&mut self) {
        if self.are_strokes_pending() {
            let strokes = self.session.strokes().to_vec();
            self.save();
            // Never fails: there is a run.
            drop(self.order(Order::Strokes(strokes)));
        }
    }
}
