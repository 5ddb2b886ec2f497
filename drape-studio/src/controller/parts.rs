//! Parts of the source that are treated in their own way.

use std::sync::Arc;
use std::thread;

use anyhow::{ensure, Context as _, Result};
use serde_json::{json, Value};

use super::can::OPEN_FIRST;
use super::{Controller, Inbox};
use crate::{InnerPart, Source, Treatment};

impl Controller {
    /// Treats a part in its own way, if that leaves something to drape.
    pub(super) fn treat(&mut self, name: &str, treatment: Treatment) -> Result<()> {
        let scene = self.scene().context(OPEN_FIRST)?;
        let named = scene.source.parts();
        let inner = self.inner.iter().find(|part| part.name == name);
        ensure!(
            inner.is_some() || named.iter().any(|part| part.name == name),
            "the source has no part of this name"
        );
        let mut parts = self.session.document.parts.clone();
        for list in [&mut parts.free, &mut parts.rigid, &mut parts.draped] {
            list.retain(|known| known != name);
        }
        let list = match treatment {
            Treatment::Draped if inner.is_some_and(|i| i.unasked != Treatment::Draped) => {
                Some(&mut parts.draped)
            }
            Treatment::Draped => None,
            Treatment::Free => Some(&mut parts.free),
            Treatment::Rigid => Some(&mut parts.rigid),
        };
        if let Some(list) = list {
            list.push(name.to_owned());
        }
        self.toolbox.regions(&scene, &parts)?;
        self.session.edit(|d| d.parts = parts);
        Ok(())
    }

    /// The triangles of a part, as ranges of rows.
    pub(super) fn part_triangles(&self, name: &str) -> Value {
        let inner = self.inner.iter().find(|part| part.name == name);
        let ranges = self.source.as_ref().map(|source| match inner {
            Some(part) => source.triangles_within(&part.vertices),
            None => source.part_triangles(name),
        });
        json!(ranges)
    }

    /// Looks for inner parts; the controller hears of them.
    pub(super) fn look_inside(&self) {
        let Some(scene) = self.scene() else {
            return;
        };
        let (toolbox, inbox) = (Arc::clone(&self.toolbox), self.inbox.clone());
        thread::spawn(move || {
            // A source that cannot be worked on says so where it is to be deformed.
            let inner = toolbox.inner_parts(&scene).unwrap_or_default();
            drop(inbox.send(Inbox::Inner(scene.source, inner)));
        });
    }

    pub(super) fn found_inside(&mut self, of: &Arc<Source>, inner: Vec<InnerPart>) {
        let is_open = |source: &Arc<Source>| Arc::ptr_eq(source, of);
        if !inner.is_empty() && self.source.as_ref().is_some_and(is_open) {
            self.inner = inner;
            self.publish();
        }
    }

    /// The inner parts as pages get them.
    pub(super) fn inner_state(&self) -> Value {
        let part = |part: &InnerPart| {
            json!({
                "name": part.name,
                "label": part.label,
                "about": part.about,
                "proposed": part.proposed,
                "unasked": part.unasked,
            })
        };
        self.inner.iter().map(part).collect()
    }
}
