//! The state as every page gets it.

use mesh_draping::Preset;
use serde_json::{json, Value};

use super::Controller;
use crate::session::{fingerprint, numbers, painted_rigid, Mark, MarkKind};

impl Controller {
    /// Inputs, landmarks, settings, the drape: everything but shapes and figures.
    pub(super) fn state(&self) -> Value {
        let (document, situation) = (&self.session.document, self.situation());
        let numbers = numbers(&document.marks);
        let marks = document.marks.iter().zip(numbers);
        let points = marks.filter(|(mark, _)| mark.curve.is_none());
        let marks: Vec<Value> = points.map(|(m, number)| self.mark(m, number)).collect();
        json!({
            "type": "state",
            "revision": self.revision,
            "session": self.session_path,
            "source": self.source_state(),
            "target": self.target_state(),
            "landmarks": marks,
            "curves": self.curves_state(),
            "drawing": self.drawing_state(),
            "marks": fingerprint(&self.landmarks()),
            "warnings": self.warnings,
            "preview_error": self.preview_error,
            "notice": self.notice,
            "mirror": document.mirror,
            "parts": document.parts,
            "painted_rigid": painted_rigid(&document.parts),
            "strokes": document.n_strokes,
            "inner": self.inner_state(),
            "settings": {
                "preset": self.preset.name,
                "seed": self.preset.drape.seed,
                "n_iterations": self.preset.drape.stages.iter().map(|s| s.n_iterations).sum::<usize>(),
                "toml": document.settings,
            },
            "kept": self.kept_state(),
            "scans": self.scans_state(),
            "saved": self.saved_state(),
            "presets": Preset::names().collect::<Vec<_>>(),
            "can": situation.can(),
            "discards": situation.discarding(),
            "run": self.run_state(),
        })
    }

    /// The names of the saved settings, and the one whose settings hold.
    fn saved_state(&self) -> Value {
        let document = &self.session.document;
        let names: Vec<&String> = document.saved.iter().map(|s| &s.name).collect();
        let present = document.saved.iter().find(|s| s.toml == document.settings);
        json!({ "names": names, "present": present.map(|s| &s.name) })
    }

    fn source_state(&self) -> Value {
        let Some(source) = &self.source else {
            return Value::Null;
        };
        json!({
            "name": source.source.file().map(|file| file_name(file.path())),
            "n_vertices": source.buffers.n_vertices,
            "n_faces": source.buffers.n_faces,
            "kind": "mesh",
            "hash": self.session.source.as_ref().map(|r| &r.fnv1a),
            "looks": source.looks.state(),
            "symmetry": source.symmetry,
            "parts": source.parts().iter().map(|part| &part.name).collect::<Vec<_>>(),
        })
    }

    fn target_state(&self) -> Value {
        let Some(target) = &self.target else {
            return Value::Null;
        };
        json!({
            "name": target.target.path().map(file_name),
            "n_vertices": target.buffers.n_vertices,
            "n_faces": target.buffers.n_faces,
            "kind": if target.target.is_cloud() { "cloud" } else { "mesh" },
            // Lengths of the page are in longest sides of the box: this many units of the file.
            "side": target.frame.scale,
            "hash": self.session.target.as_ref().map(|r| &r.fnv1a),
            "looks": target.looks.state(),
            "symmetry": target.symmetry,
        })
    }

    /// A landmark; its place on the target with the normal there, in the frame of the target.
    fn mark(&self, mark: &Mark, number: Option<usize>) -> Value {
        let place = self.target.as_ref().zip(mark.target).map(|(target, point)| {
            let point = point.into();
            let location = target.judged().closest_point(&point).location;
            let normal = target.judged().normal(&location).unwrap_or_default();
            let unit = target.frame.to_unit(&point);
            json!({ "point": [unit.x, unit.y, unit.z], "normal": [normal.x, normal.y, normal.z] })
        });
        json!({
            "id": mark.id,
            "number": number,
            "name": mark.name,
            "source": mark.source,
            "target": place,
            "weight": mark.weight,
            "kind": match mark.kind { MarkKind::Soft => "soft", MarkKind::Rigid => "rigid" },
        })
    }

    fn run_state(&self) -> Value {
        let Some(run) = &self.run else {
            return json!({ "status": "none" });
        };
        json!({
            "status": run.status,
            "error": run.error,
            "iteration": run.log.iteration,
            "pending": self.are_marks_pending() || self.are_parts_pending(),
            "pending_landmarks": self.are_marks_pending(),
            "pending_parts": self.are_parts_pending(),
            "number": run.number,
            "n_more": run.n_more,
        })
    }
}

pub(super) fn file_name(path: &std::path::Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}
