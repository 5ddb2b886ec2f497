//! Parts of the source that are treated in their own way.

use std::thread;

use anyhow::{ensure, Context as _, Result};
use mesh_draping::parts::{InnerKind, InnerSurface};
use mesh_draping::Treatment;
use serde_json::{json, Value};

use super::can::OPEN_FIRST;
use super::{Controller, Inbox};
use crate::shapes::Shapes;

impl Controller {
    /// Treats a part in its own way, if that leaves something to drape.
    pub(super) fn treat(&mut self, name: &str, treatment: Treatment) -> Result<()> {
        let displayed = self.displayed.clone().context(OPEN_FIRST)?;
        let unasked = self.inner_surface(name).map(|(_, unasked)| unasked);
        let is_named = displayed.source.parts().iter().any(|p| p.name == name);
        ensure!(
            unasked.is_some() || is_named,
            "the source has no part of this name"
        );
        let mut parts = self.session.document.parts.clone();
        for list in [&mut parts.free, &mut parts.rigid, &mut parts.draped] {
            list.retain(|known| known != name);
        }
        let is_own_way = unasked.is_some_and(|unasked| unasked != Treatment::Draped);
        let list = match treatment {
            Treatment::Draped if is_own_way => Some(&mut parts.draped),
            Treatment::Draped => None,
            Treatment::Free => Some(&mut parts.free),
            Treatment::Rigid => Some(&mut parts.rigid),
        };
        if let Some(list) = list {
            list.push(name.to_owned());
        }
        displayed.shapes.regions(&parts)?;
        self.session.edit(|d| d.parts = parts);
        Ok(())
    }

    /// The triangles of a part, as ranges of rows.
    pub(super) fn part_triangles(&self, name: &str) -> Value {
        let inner = self.inner_surface(name);
        let ranges = self.source.as_ref().map(|source| match inner {
            Some((part, _)) => source.triangles_within(&part.vertices),
            None => source.part_triangles(name),
        });
        json!(ranges)
    }

    /// Looks for inner surfaces; the controller hears of them.
    pub(super) fn look_inside(&self) {
        let Some(displayed) = self.displayed.clone() else {
            return;
        };
        let inbox = self.inbox.clone();
        thread::spawn(move || {
            displayed.shapes.hidden();
            // The controller lives as long as the server.
            drop(inbox.send(Inbox::LookedInside(displayed.shapes)));
        });
    }

    pub(super) fn looked_inside(&mut self, shapes: &Shapes) {
        let is_open = self
            .displayed
            .as_ref()
            .is_some_and(|displayed| displayed.shapes.is_same(shapes));
        if is_open {
            self.publish();
        }
    }

    /// The inner surfaces that are known, with their names and how each is treated where nobody says otherwise.
    fn inner_surfaces(&self) -> impl Iterator<Item = (String, &InnerSurface, Treatment)> {
        let displayed = self.displayed.iter();
        let hidden = displayed.filter_map(|displayed| displayed.shapes.known_hidden());
        hidden.flat_map(|hidden| {
            let numbered = hidden.inner.iter().zip(1..);
            numbered.map(|(part, k)| (format!("hidden:{k}"), part, hidden.unasked(part)))
        })
    }

    fn inner_surface(&self, name: &str) -> Option<(&InnerSurface, Treatment)> {
        let mut all = self.inner_surfaces();
        let found = all.find(|(known, ..)| known == name);
        found.map(|(_, part, unasked)| (part, unasked))
    }

    /// The inner surfaces as pages get them.
    pub(super) fn inner_state(&self) -> Value {
        let part = |(name, part, unasked): (String, &InnerSurface, Treatment)| {
            let percent = 100.0 * part.share;
            json!({
                "name": name,
                "label": format!("{}, {percent:.1} %", in_short(part.kind)),
                "about": format!(
                    "{}, {} vertices, {percent:.1} % of the area",
                    part.kind,
                    part.vertices.len()
                ),
                "proposed": part.proposed(),
                "unasked": unasked,
            })
        };
        self.inner_surfaces().map(part).collect()
    }
}

fn in_short(kind: InnerKind) -> &'static str {
    match kind {
        InnerKind::ClosedPiece => "closed",
        InnerKind::OpenPiece => "open",
        InnerKind::Lining => "lining",
    }
}
