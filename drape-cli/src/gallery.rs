//! The pictures of a run: source, target, initial deformation, result and heat maps, all seen from one direction.

use mesh_core::{FaceData, Point3, Positions, VertexData};
use nalgebra::Matrix3;

use crate::input::Pair;
use crate::render::{color, draw, Axes, Image, Look, Model, Shot, Up, View};
use crate::similarity::{fit, Match};

/// Distance at the bright end of the heat map, in longest sides of the target's box.
pub(crate) const DISTANCE_AT_TOP: f64 = 0.01;
/// Error at the bright end of the heat map of errors against the truth, likewise.
pub(crate) const TRUTH_AT_TOP: f64 = 0.02;
/// Stretch above 1 at the bright end of the heat map.
pub(crate) const STRETCH_AT_TOP: f64 = 1.0;

/// How pictures are taken.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Direction to look from: quarter, front, side, back, top or AZIMUTH,ELEVATION in degrees; may be repeated
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true)]
    pub(crate) view: Vec<View>,
    /// Axis that points up in the target's file
    #[arg(long, value_name = "AXIS", default_value = "y")]
    pub(crate) up: Up,
}

impl ViewArgs {
    /// The views asked for, or these.
    pub(crate) fn views_or(&self, default: &[View]) -> Vec<View> {
        if self.view.is_empty() {
            default.to_vec()
        } else {
            self.view.clone()
        }
    }
}

/// The shapes of one pair, ready to be drawn.
pub(crate) struct Gallery<'a> {
    pair: &'a Pair,
    /// Turns the source as the target stands.
    turn: Matrix3<f64>,
    up: Up,
    size: usize,
}

impl<'a> Gallery<'a> {
    /// Pictures of `size` pixels along each side; `placed` is the source in the target's coordinates.
    pub(crate) fn new(pair: &'a Pair, placed: &Positions, up: Up, size: usize) -> Self {
        let matches = pair.source.rest.iter().zip(placed.iter());
        let matches: Vec<Match> = matches.map(|(&from, &to)| Match { from, to }).collect();
        Self {
            pair,
            turn: fit(&matches).turn,
            up,
            size,
        }
    }

    fn shot(&self, view: View) -> Shot {
        Shot {
            axes: Axes::new(view, self.up),
            size: self.size,
        }
    }

    pub(crate) fn source(&self, view: View) -> Image {
        let model = self
            .pair
            .source
            .model(&self.pair.source.rest)
            .mapped(|p| self.turn * p, |n| self.turn * n);
        let marks = self
            .pair
            .landmarks
            .iter()
            .map(|l| self.turn * l.source.position(&self.pair.source.rest));
        let marks: Vec<Point3> = marks.collect();
        draw(
            &model,
            &Look::outlined(color::SOURCE),
            &marks,
            &[],
            self.shot(view),
        )
    }

    pub(crate) fn target(&self, view: View) -> Image {
        let marks: Vec<Point3> = self.pair.landmarks.iter().map(|l| l.target).collect();
        draw(
            &self.pair.target.model,
            &Look::plain(color::TARGET),
            &marks,
            &[],
            self.shot(view),
        )
    }

    pub(crate) fn initial(&self, positions: &Positions, view: View) -> Image {
        self.on_target(positions, &Look::outlined(color::INITIAL), &[], view)
    }

    pub(crate) fn result(&self, positions: &Positions, view: View) -> Image {
        self.on_target(positions, &Look::outlined(color::RESULT), &[], view)
    }

    /// `values` on the mesh, dark at 0 and bright at `top`.
    pub(crate) fn heat(
        &self,
        positions: &Positions,
        values: &VertexData<f64>,
        top: f64,
        view: View,
    ) -> Image {
        self.marked_heat(positions, values, top, &[], view)
    }

    /// The same with dots at `marks`, in the target's coordinates.
    pub(crate) fn marked_heat(
        &self,
        positions: &Positions,
        values: &VertexData<f64>,
        top: f64,
        marks: &[Point3],
        view: View,
    ) -> Image {
        let shares = values.iter().map(|v| v / top).collect();
        self.on_target(positions, &Look::heat(shares), marks, view)
    }

    /// A mesh in the target's coordinates, framed with the target.
    fn on_target(&self, positions: &Positions, look: &Look, marks: &[Point3], view: View) -> Image {
        let model: Model = self.pair.source.model(positions);
        draw(
            &model,
            look,
            marks,
            &self.pair.target.model.seen_points(),
            self.shot(view),
        )
    }

    /// Stretch above 1 at each vertex: the mean over its faces.
    pub(crate) fn stretch_at_vertices(&self, face_stretch: &FaceData<f64>) -> VertexData<f64> {
        let mesh = &self.pair.source.mesh;
        let mut sums = VertexData::new(mesh.n_vertices(), (0.0, 0.0));
        for f in mesh.faces() {
            for &v in mesh.face_vertices(f) {
                sums[v].0 += (face_stretch[f] - 1.0).max(0.0);
                sums[v].1 += 1.0;
            }
        }
        sums.map(|&(sum, n): &(f64, f64)| sum / n.max(1.0))
    }
}
