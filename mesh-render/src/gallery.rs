//! The pictures of a run: source, target, initial deformation, result and heat maps, all seen from one direction.

use mesh_core::{FaceData, Point3, Positions, VertexData};
use mesh_draping::mesh_init::PointPair;
use mesh_draping::{Pair, Similarity};
use nalgebra::Matrix3;

use crate::{color, draw, Axes, Image, Look, Model, RenderError, Shot, Up, Upright, View};

/// Distance at the bright end of the heat map, in longest sides of the target's box.
pub const DISTANCE_AT_TOP: f64 = 0.01;
/// Error at the bright end of the heat map of errors against the truth, likewise.
pub const TRUTH_AT_TOP: f64 = 0.02;
/// Stretch above 1 at the bright end of the heat map.
pub const STRETCH_AT_TOP: f64 = 1.0;

/// The shapes of one pair, ready to be drawn.
pub struct Gallery<'a> {
    pair: &'a Pair,
    target: Model,
    /// Turns the source as the target stands.
    turn: Matrix3<f64>,
    up: Up,
    size: usize,
}

impl<'a> Gallery<'a> {
    /// Pictures of `size` pixels along each side; `placed` is the source in the target's coordinates, and `up` what points
    /// up there: what the shapes say where it is none.
    ///
    /// # Errors
    /// A target that cannot be drawn.
    pub fn new(
        pair: &'a Pair,
        placed: &Positions,
        up: Option<Up>,
        size: usize,
    ) -> Result<Self, RenderError> {
        let matches = pair.source.rest().iter().zip(placed.iter());
        let matches = matches.map(|(&source, &target)| PointPair::new(source, target));
        let turn = Similarity::fit(&matches.collect::<Vec<_>>()).turn;
        Ok(Self {
            target: Model::of_target(&pair.target)?,
            up: up.unwrap_or_else(|| Upright::of_pair(pair, &turn).up),
            turn,
            pair,
            size,
        })
    }

    /// What points up in all pictures, in the target's coordinates.
    pub fn up(&self) -> Up {
        self.up
    }

    fn shot(&self, view: View) -> Shot {
        Shot {
            axes: Axes::new(view, self.up),
            size: self.size,
        }
    }

    /// The source, turned as the target stands, with its landmarks.
    pub fn source(&self, view: View) -> Image {
        let source = &self.pair.source;
        let model = Model::of_source(source, source.rest());
        let model = model.mapped(|p| self.turn * p, |n| self.turn * n);
        let landmarks = self.pair.landmarks.iter();
        let marks = landmarks.map(|l| self.turn * l.source.position(source.rest()));
        let marks: Vec<Point3> = marks.collect();
        let look = Look::outlined(color::SOURCE);
        draw(&model, &look, &marks, &[], self.shot(view))
    }

    /// The target with its landmarks.
    pub fn target(&self, view: View) -> Image {
        let marks: Vec<Point3> = self.pair.landmarks.iter().map(|l| l.target).collect();
        let look = Look::plain(color::TARGET);
        draw(&self.target, &look, &marks, &[], self.shot(view))
    }

    /// The initial deformation.
    pub fn initial(&self, positions: &Positions, view: View) -> Image {
        self.on_target(positions, &Look::outlined(color::INITIAL), &[], view)
    }

    /// The result.
    pub fn result(&self, positions: &Positions, view: View) -> Image {
        self.on_target(positions, &Look::outlined(color::RESULT), &[], view)
    }

    /// `values` on the mesh, dark at 0 and bright at `top`.
    pub fn heat(
        &self,
        positions: &Positions,
        values: &VertexData<f64>,
        top: f64,
        view: View,
    ) -> Image {
        self.marked_heat(positions, values, top, &[], view)
    }

    /// The same with dots at `marks`, in the target's coordinates.
    pub fn marked_heat(
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
        let model = Model::of_source(&self.pair.source, positions);
        draw(
            &model,
            look,
            marks,
            &self.target.seen_points(),
            self.shot(view),
        )
    }

    /// Stretch above 1 at each vertex: the mean over its faces.
    pub fn stretch_at_vertices(&self, face_stretch: &FaceData<f64>) -> VertexData<f64> {
        let mesh = self.pair.source.mesh();
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
