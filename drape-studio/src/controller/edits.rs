//! Edits of landmarks and settings.

use anyhow::{ensure, Context as _, Result};
use mesh_core::{Curve, Landmark};
use mesh_draping::landmarks::MAX_WEIGHT;
use mesh_draping::Preset;
use serde_json::Value;

use super::can::Action;
use super::paint::forget_rigid;
use super::{Controller, Edit};
use crate::session::{Mark, NamedSettings, MAX_MARKS};

/// Longest name of a landmark, in characters.
const MAX_NAME: usize = 80;

impl Controller {
    /// Makes an edit; the number of the landmark where a place is marked.
    pub(super) fn make(&mut self, edit: Edit) -> Result<Value> {
        if !matches!(edit, Edit::Drag { .. } | Edit::Paint(_) | Edit::Brush(_)) {
            self.finish_drag();
        }
        match edit {
            Edit::Draw { shape, ray } => return self.draw(shape, &ray),
            Edit::EndCurve => return self.end_curve(),
            Edit::CancelCurve => return Ok(self.cancel_curve()),
            Edit::Place { shape, ray, snap } => return self.place(shape, &ray, snap),
            Edit::Drag {
                landmark,
                shape,
                ray,
                done,
                snap,
            } => {
                let to = ray.and_then(|ray| self.pick_snapped(shape, &ray, snap));
                self.drag(landmark, to, done)?;
            }
            Edit::Delete { landmark } => {
                self.find(landmark)?;
                self.session.edit(|d| d.marks.retain(|m| m.id != landmark));
            }
            Edit::Rename { landmark, name } => {
                let name: String = name.trim().chars().take(MAX_NAME).collect();
                self.change_mark(landmark, |m| m.name = name)?;
            }
            Edit::Weight { landmark, weight } => self.weigh(landmark, weight)?,
            Edit::Kind { landmark, kind } => self.change_mark(landmark, |m| m.kind = kind)?,
            Edit::Paint(dab) => return self.paint(&dab),
            Edit::Brush(dab) => return self.brush(&dab),
            Edit::ClearRigid => self.session.edit(|d| forget_rigid(&mut d.parts)),
            Edit::ClearWeights => self.session.edit(|d| d.parts.weights = None),
            Edit::Clear => {
                self.situation().check(Action::Clear)?;
                self.session.edit(|d| d.marks.clear());
            }
            Edit::Mirror { axes } => self.mirror(axes)?,
            Edit::Part { name, treatment } => self.treat(&name, treatment)?,
            Edit::Preset { .. }
            | Edit::Seed { .. }
            | Edit::Settings { .. }
            | Edit::SaveSettings { .. }
            | Edit::ForgetSettings { .. } => self.change_settings(edit)?,
            Edit::Dismiss { result } => {
                let is_kept = self.session.kept.iter().any(|kept| kept.id == result);
                ensure!(is_kept, "there is no kept result {result}");
                self.session.edit(|d| d.dismissed.push(result));
            }
            Edit::Undo => {
                self.situation().check(Action::Undo)?;
                self.session.undo();
            }
            Edit::Redo => {
                self.situation().check(Action::Redo)?;
                self.session.redo();
            }
        }
        self.edited();
        Ok(Value::Null)
    }

    /// Places landmarks twice from now on, across these axes of source and target.
    fn mirror(&mut self, axes: Option<[usize; 2]>) -> Result<()> {
        let is_axis = axes.iter().flatten().all(|&axis| axis < 3);
        ensure!(is_axis, "an axis is 0, 1 or 2");
        self.session.edit(|d| d.mirror = axes);
        Ok(())
    }

    fn weigh(&mut self, landmark: u32, weight: f64) -> Result<()> {
        let is_weight = (0.0..=MAX_WEIGHT).contains(&weight);
        ensure!(is_weight, "a weight is a number from 0 to {MAX_WEIGHT}");
        self.change_mark(landmark, |m| m.weight = weight)
    }

    /// Settings of the next drape, and those that are saved by name.
    fn change_settings(&mut self, edit: Edit) -> Result<()> {
        match edit {
            Edit::Preset { name } => self.choose_preset(&name)?,
            Edit::Seed { seed } => {
                let mut preset = self.preset.clone();
                preset.drape.seed = u64::from(seed);
                self.set_preset(&preset);
            }
            Edit::SaveSettings { name } => self.save_settings(&name)?,
            Edit::ForgetSettings { name } => {
                self.session.edit(|d| d.saved.retain(|s| s.name != name));
            }
            Edit::Settings { toml } => self.set_preset(&Preset::from_toml(&toml)?),
            // Whoever calls this has such an edit.
            _ => {}
        }
        Ok(())
    }

    /// After an edit: settings as the document has them, the preview, every page.
    pub(super) fn edited(&mut self) {
        // Settings that cannot be read never come into the document.
        if let Ok(preset) = Preset::from_toml(&self.session.document.settings) {
            self.preset = preset;
        }
        if self.dragged_from.is_none() {
            self.pass_on();
        }
        self.order_strokes();
        self.ask_preview();
        self.changed();
    }

    /// Keeps the settings as they are under a name.
    fn save_settings(&mut self, name: &str) -> Result<()> {
        let name: String = name.trim().chars().take(MAX_NAME).collect();
        ensure!(!name.is_empty(), "settings are saved under a name");
        let is_preset = Preset::names().any(|known| known == name);
        ensure!(
            !is_preset,
            "{name} is a preset of the program; choose another name"
        );
        self.session.edit(|d| {
            d.saved.retain(|saved| saved.name != name);
            let toml = d.settings.clone();
            d.saved.push(NamedSettings { name, toml });
        });
        Ok(())
    }

    /// Settings that were saved, or a preset, with the seed as it is.
    fn choose_preset(&mut self, name: &str) -> Result<()> {
        let mut saved = self.session.document.saved.iter();
        if let Some(saved) = saved.find(|saved| saved.name == name) {
            let toml = saved.toml.clone();
            self.session.edit(|d| d.settings = toml);
            return Ok(());
        }
        let mut preset = Preset::named(name)?;
        preset.drape.seed = self.preset.drape.seed;
        self.set_preset(&preset);
        Ok(())
    }

    fn set_preset(&mut self, preset: &Preset) {
        let settings = preset.to_toml();
        self.session.edit(|d| d.settings = settings);
    }

    pub(super) fn find(&self, id: u32) -> Result<&Mark> {
        let mut marks = self.session.document.marks.iter();
        marks
            .find(|m| m.id == id)
            .with_context(|| format!("there is no landmark {id}; it may have been deleted"))
    }

    fn change_mark(&mut self, id: u32, change: impl FnOnce(&mut Mark)) -> Result<()> {
        self.find(id)?;
        self.session.edit(|d| {
            if let Some(mark) = d.marks.iter_mut().find(|m| m.id == id) {
                change(mark);
            }
        });
        Ok(())
    }

    /// Takes the landmarks of a file.
    pub(super) fn adopt(&mut self, landmarks: &[Landmark]) -> Result<()> {
        ensure!(
            Landmark::marked(landmarks).count() + Curve::runs(landmarks).count() <= MAX_MARKS,
            "{MAX_MARKS} landmarks are enough"
        );
        self.finish_drag();
        let points = Landmark::marked(landmarks);
        let mut marks: Vec<Mark> = points
            .map(|l| Mark::of(self.session.fresh_id(), l))
            .collect();
        for (curve, _) in Curve::runs(landmarks) {
            marks.push(Mark::of_curve(self.session.fresh_id(), curve));
        }
        self.session.edit(|d| d.marks = marks);
        self.edited();
        Ok(())
    }
}
