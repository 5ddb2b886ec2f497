//! Mirror images of curves.

use mesh_core::{Curve, Point3};
use mesh_draping::landmarks::{curve_counterpart, MirrorPlanes, Plane};

use super::Controller;
use crate::session::{Lines, Mark};

/// A line runs along another where its places are nearer to those of the other than this, in longest sides.
const ALONG: f64 = 0.01;

impl Controller {
    /// The planes across which places are mirrored, where they are.
    pub(super) fn mirror_planes(&self) -> Option<MirrorPlanes> {
        let [of_source, of_target] = self.session.document.mirror?;
        let shapes = &self.displayed.as_ref()?.shapes;
        Some(MirrorPlanes {
            source: Plane::through_middle(&shapes.source.bounds(), of_source),
            target: Plane::through_middle(&shapes.target.judged().bounds(), of_target),
        })
    }

    /// The curve of the other half, where places are mirrored and it is another one than those that are there.
    pub(super) fn curve_twin(&self, curve: &Curve) -> Option<Curve> {
        let shapes = &self.displayed.as_ref()?.shapes;
        curve_counterpart(
            &shapes.pair(self.landmarks()),
            curve,
            &self.mirror_planes()?,
        )
    }

    /// Adds a mirror image; a curve that waits for its line where that runs gets it.
    pub(super) fn add_curve_twin(&self, marks: &mut Vec<Mark>, twin: &Curve, id: u32) {
        let lines = Lines::of(twin);
        let waiting = marks.iter_mut().find(|mark| {
            let waits = mark.curve.as_ref().filter(|l| !l.is_complete());
            waits.is_some_and(|there| self.runs_along(there, &lines))
        });
        match waiting.and_then(|mark| mark.curve.as_mut()) {
            Some(there) if there.source.is_empty() => there.source = lines.source,
            Some(there) => there.target = lines.target,
            None => marks.push(Mark::of_curve(id, twin)),
        }
    }

    /// Whether the line that one curve has runs along that of another: from place to place, in either direction.
    fn runs_along(&self, one: &Lines, other: &Lines) -> bool {
        let Some(displayed) = &self.displayed else {
            return false;
        };
        let rest = displayed.shapes.source.rest();
        let on_source = |lines: &Lines| -> Vec<Point3> {
            let places = lines.source.iter();
            places.map(|p| p.mesh_point().position(rest)).collect()
        };
        let on_target = |lines: &Lines| lines.target.iter().map(|&p| p.into()).collect();
        let (a, b, side) = match one.source.is_empty() {
            true => (
                on_target(one),
                on_target(other),
                displayed.target.frame.scale,
            ),
            false => (
                on_source(one),
                on_source(other),
                displayed.source.frame.scale,
            ),
        };
        let near = |(p, q): (&Point3, &Point3)| (p - q).norm() < ALONG * side;
        let along = a.iter().zip(&b).all(near) || a.iter().zip(b.iter().rev()).all(near);
        a.len() == b.len() && along
    }
}
