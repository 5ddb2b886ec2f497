//! Weights of attraction, painted on the surface of the source.
//!
//! What is painted is a file that `drape --weights` takes, called by its content: a session and its undo name it, and
//! nothing ever changes it.

use std::fs;
use std::path::PathBuf;

use anyhow::{ensure, Context as _, Result};
use mesh_core::io::write_atomic;
use mesh_core::{Point3, VertexData};
use mesh_draping::landmarks::Plane;
use mesh_draping::Parts;
use serde_json::{json, Value};

use super::can::OPEN_FIRST;
use super::places::Place;
use super::request::Dab;
use super::Controller;
use crate::session::{fnv1a, Document};

/// A stroke that goes on: the document before it, and the weights as far as they are painted.
pub(super) struct Stroke {
    before: Document,
    weights: VertexData<f64>,
}

impl Controller {
    /// Paints one dab of a stroke; the vertices that changed with their weights, for the page to show.
    pub(super) fn paint(&mut self, dab: &Dab) -> Result<Value> {
        ensure!(
            dab.is_sound(),
            "a brush has a size, and a strength and a weight from 0 to 1"
        );
        if self.stroke.is_none() {
            self.stroke = Some(Stroke {
                before: self.session.document.clone(),
                weights: self.weights()?,
            });
        }
        let changed = self.put_dab(dab);
        if dab.done {
            self.finish_stroke()?;
            self.edited();
        }
        Ok(json!(changed))
    }

    /// Lets the dab take effect on the weights of the stroke, on both sides where places are mirrored.
    fn put_dab(&mut self, dab: &Dab) -> Vec<(usize, f64)> {
        let place = dab.ray.as_ref().and_then(|ray| self.pick(dab.shape, ray));
        let (Some(Place::Source(place)), Some(source)) = (place, self.source.clone()) else {
            return Vec::new();
        };
        let Some(stroke) = &mut self.stroke else {
            return Vec::new();
        };
        let rest = source.source.rest();
        let centre = place.mesh_point().position(rest);
        let mirror =
            self.session.document.mirror.map(|[axis, _]| {
                Plane::through_middle(&source.source.bounds(), axis).mirror(&centre)
            });
        let centres: Vec<Point3> = [centre].into_iter().chain(mirror).collect();
        let radius = dab.radius * source.frame.scale;
        let mut changed = Vec::new();
        for v in rest.ids() {
            let nearest = centres.iter().map(|c| (rest[v] - c).norm());
            let share = nearest.fold(f64::INFINITY, f64::min) / radius;
            if share < 1.0 {
                let strength = dab.strength * (1.0 - share * share).powi(2);
                let weight = &mut stroke.weights[v];
                *weight = (*weight + strength * (dab.weight - *weight)).clamp(0.0, 1.0);
                changed.push((v.index(), *weight));
            }
        }
        changed
    }

    /// What was painted becomes one edit; a stroke that leaves nothing to drape is refused.
    pub(super) fn finish_stroke(&mut self) -> Result<()> {
        let Some(Stroke { before, weights }) = self.stroke.take() else {
            return Ok(());
        };
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let path = self.write_weights(&weights)?;
        let parts = Parts {
            weights: Some(path.display().to_string()),
            ..self.session.document.parts.clone()
        };
        displayed.shapes.regions(&parts)?;
        self.session.document.parts = parts;
        if before != self.session.document {
            self.session.remember(before);
        }
        Ok(())
    }

    /// Writes weights as lines "row weight"; those of 1 need none.
    fn write_weights(&self, weights: &VertexData<f64>) -> Result<PathBuf> {
        let source = self.source.as_ref().context(OPEN_FIRST)?;
        let mut text = String::from("# vertex weight\n");
        for v in weights.ids().filter(|&v| weights[v] < 1.0) {
            text += &format!("{} {}\n", source.source.file_row(v), weights[v]);
        }
        let folder = self.session_path.with_extension("files").join("weights");
        fs::create_dir_all(&folder)
            .with_context(|| format!("{}: cannot be made", folder.display()))?;
        let path = folder.join(format!("{:016x}.txt", fnv1a(text.as_bytes())));
        let path = std::path::absolute(&path).unwrap_or(path);
        write_atomic(&path, text.as_bytes())?;
        Ok(path)
    }

    /// The weights as they are: 1 where nobody said anything.
    fn weights(&self) -> Result<VertexData<f64>> {
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let only = Parts {
            weights: self.session.document.parts.weights.clone(),
            is_hidden_draped: true,
            ..Parts::default()
        };
        Ok(displayed.shapes.regions(&only)?.attraction)
    }

    /// The weights for the page; nothing where there are none.
    pub(super) fn weights_state(&self) -> Value {
        let has_weights = self.session.document.parts.weights.is_some();
        let weights = self.weights().ok().filter(|_| has_weights);
        json!(weights.map(VertexData::into_vec))
    }
}
