//! Painted on the surface of the source: weights of attraction, and what is rigid.
//!
//! What is painted is a file that `drape --weights` or `--rigid` takes, called by its content: a session and its undo name
//! it, and nothing ever changes it.

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
use super::request::{Dab, Layer};
use super::Controller;
use crate::session::{fnv1a, painted_rigid, Document, RIGID_FOLDER};

/// A stroke that goes on: the document before it, and what is painted so far.
pub(super) struct Stroke {
    before: Document,
    layer: Layer,
    values: VertexData<f64>,
}

impl Controller {
    /// Paints one dab of a stroke; the vertices that changed with their values, for the page to show.
    pub(super) fn paint(&mut self, dab: &Dab) -> Result<Value> {
        ensure!(
            dab.is_sound(),
            "a brush has a size, and a strength and a weight from 0 to 1"
        );
        if self.stroke.is_none() {
            self.stroke = Some(Stroke {
                before: self.session.document.clone(),
                layer: dab.layer,
                values: self.painted(dab.layer)?,
            });
        }
        let changed = self.put_dab(dab);
        if dab.done {
            self.finish_stroke()?;
            self.edited();
        }
        Ok(json!(changed))
    }

    /// Lets the dab take effect on what the stroke paints, on both sides where places are mirrored.
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
                let value = &mut stroke.values[v];
                *value = match stroke.layer {
                    Layer::Rigid => dab.weight.round(),
                    Layer::Weights => {
                        let strength = dab.strength * (1.0 - share * share).powi(2);
                        (*value + strength * (dab.weight - *value)).clamp(0.0, 1.0)
                    }
                };
                changed.push((v.index(), *value));
            }
        }
        changed
    }

    /// What was painted becomes one edit; a stroke that leaves nothing to drape is refused.
    pub(super) fn finish_stroke(&mut self) -> Result<()> {
        let Some(stroke) = self.stroke.take() else {
            return Ok(());
        };
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let path = self.write_painted(&stroke)?.display().to_string();
        let mut parts = self.session.document.parts.clone();
        match stroke.layer {
            Layer::Weights => parts.weights = Some(path),
            Layer::Rigid => {
                forget_rigid(&mut parts);
                if stroke.values.iter().any(|&r| r > 0.0) {
                    parts.rigid.push(path);
                }
            }
        }
        displayed.shapes.regions(&parts)?;
        self.session.document.parts = parts;
        if stroke.before != self.session.document {
            self.session.remember(stroke.before);
        }
        Ok(())
    }

    /// Writes weights as lines "row weight", those of 1 need none; and what is rigid as rows.
    fn write_painted(&self, stroke: &Stroke) -> Result<PathBuf> {
        let source = self.source.as_ref().context(OPEN_FIRST)?;
        let row = |v| source.source.file_row(v);
        let painted = stroke.values.ids().map(|v| (v, stroke.values[v]));
        let lines: Vec<String> = match stroke.layer {
            Layer::Weights => painted
                .filter(|(_, weight)| *weight < 1.0)
                .map(|(v, weight)| format!("{} {weight}\n", row(v)))
                .collect(),
            Layer::Rigid => painted
                .filter(|(_, rigid)| *rigid > 0.0)
                .map(|(v, _)| format!("{}\n", row(v)))
                .collect(),
        };
        let text = format!("{}{}", stroke.layer.heading(), lines.concat());
        let folder = self.painted_folder(stroke.layer);
        fs::create_dir_all(&folder)
            .with_context(|| format!("{}: cannot be made", folder.display()))?;
        let path = folder.join(format!("{:016x}.txt", fnv1a(text.as_bytes())));
        write_atomic(&path, text.as_bytes())?;
        Ok(path)
    }

    /// Where the files of a layer are.
    fn painted_folder(&self, layer: Layer) -> PathBuf {
        let folder = self.session_path.with_extension("files");
        let folder = folder.join(layer.folder());
        std::path::absolute(&folder).unwrap_or(folder)
    }

    /// A layer as it is: weights are 1 where nobody said anything, and nothing is rigid there.
    fn painted(&self, layer: Layer) -> Result<VertexData<f64>> {
        let displayed = self.displayed.as_ref().context(OPEN_FIRST)?;
        let parts = &self.session.document.parts;
        let rigid = painted_rigid(parts).cloned();
        let only = Parts {
            weights: parts.weights.clone().filter(|_| layer == Layer::Weights),
            rigid: rigid
                .into_iter()
                .filter(|_| layer == Layer::Rigid)
                .collect(),
            is_hidden_draped: true,
            ..Parts::default()
        };
        let regions = displayed.shapes.regions(&only)?;
        Ok(match layer {
            Layer::Weights => regions.attraction,
            Layer::Rigid => regions.rigid.map(|&r| f64::from(u8::from(r))),
        })
    }

    /// A layer for the page; nothing where nothing is painted.
    pub(super) fn painted_state(&self, layer: Layer) -> Value {
        let parts = &self.session.document.parts;
        let is_there = match layer {
            Layer::Weights => parts.weights.is_some(),
            Layer::Rigid => painted_rigid(parts).is_some(),
        };
        let painted = self.painted(layer).ok().filter(|_| is_there);
        json!(painted.map(VertexData::into_vec))
    }
}

/// Nothing is painted rigid any more.
pub(super) fn forget_rigid(parts: &mut Parts) {
    if let Some(painted) = painted_rigid(parts).cloned() {
        parts.rigid.retain(|name| *name != painted);
    }
}

impl Layer {
    fn folder(self) -> &'static str {
        match self {
            Self::Weights => "weights",
            Self::Rigid => RIGID_FOLDER,
        }
    }

    fn heading(self) -> &'static str {
        match self {
            Self::Weights => "# vertex weight\n",
            Self::Rigid => "# rigid vertices\n",
        }
    }
}
