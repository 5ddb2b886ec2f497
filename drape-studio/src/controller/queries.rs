//! What is asked without changing anything.

use serde_json::{json, Value};

use super::places::Place;
use super::request::Layer;
use super::{Controller, Query};

impl Controller {
    /// Answers a query.
    pub(super) fn look_up(&mut self, query: &Query) -> Value {
        match query {
            Query::Pick { shape, ray } => {
                let place = self.pick(*shape, ray);
                self.describe(place)
            }
            Query::PartTriangles { name } => self.part_triangles(name),
            Query::Weights => self.painted_state(Layer::Weights),
            Query::Rigid => self.painted_state(Layer::Rigid),
            Query::Curves => json!(self.broadcast.curves()),
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
}
