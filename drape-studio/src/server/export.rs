//! Files that a page takes away.

use std::sync::Arc;

use anyhow::{bail, Context as _, Result};
use axum::extract::{Path, State};
use axum::http::{header, StatusCode};
use axum::response::{IntoResponse, Response};
use mesh_draping::landmarks::{write, Form};
use mesh_draping::{initial_deformation, Outcome, Preset};
use mesh_render::{Gallery, Page, View};
use tokio::task::spawn_blocking;

use super::{snapshot, App};
use crate::broadcast::ShownShape;
use crate::controller::{Snapshot, OPEN_FIRST};
use crate::replay::Replayed;
use crate::session::{landmarks, painted_rigid, RunLog, Session};
use crate::shapes::Shapes;

/// Pixels along the side of a picture in the report.
const REPORT_PICTURE: usize = 440;

/// A file for the user.
struct Download {
    name: String,
    kind: &'static str,
    bytes: Vec<u8>,
}

/// The result, the warp, the landmarks, what is painted, the report or the session.
pub(super) async fn export(State(app): State<Arc<App>>, Path(what): Path<String>) -> Response {
    let Some(snapshot) = snapshot(&app).await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let made = spawn_blocking(move || make(&what, snapshot)).await;
    match made {
        Ok(Ok(download)) => download.into_response(),
        Ok(Err(error)) => (StatusCode::CONFLICT, format!("{error:#}")).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

impl Download {
    fn into_response(self) -> Response {
        let name: String = self
            .name
            .chars()
            .map(|c| {
                if c.is_ascii() && c != '"' && c != '\\' && !c.is_control() {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        let headers = [
            (header::CONTENT_TYPE, self.kind.to_owned()),
            (
                header::CONTENT_DISPOSITION,
                format!("attachment; filename=\"{name}\""),
            ),
        ];
        (headers, self.bytes).into_response()
    }
}

fn make(what: &str, snapshot: Snapshot) -> Result<Download> {
    let download = |name: &str, kind, bytes| Download {
        name: name.to_owned(),
        kind,
        bytes,
    };
    if what == "session" {
        let json = snapshot.session.to_json()?;
        return Ok(download(
            "drape.session.json",
            "application/json",
            json.into_bytes(),
        ));
    }
    let work = Work::of(snapshot)?;
    match what {
        "landmarks" => Ok(download(
            "landmarks.json",
            "application/json",
            work.landmarks().into_bytes(),
        )),
        "weights" => work.weights(),
        "rigid" => work.rigid(),
        "result" => work.result(),
        "warp" => Ok(download(
            "result.drape",
            "application/octet-stream",
            work.replayed()?.warp()?.to_bytes(),
        )),
        "report" => Ok(download(
            "report.html",
            "text/html; charset=utf-8",
            report(work.replayed()?)?.into_bytes(),
        )),
        _ => bail!("there is no export '{what}'"),
    }
}

/// A source and a target with the shape that is shown.
struct Work {
    shapes: Shapes,
    session: Session,
    shown: Option<Arc<ShownShape>>,
}

impl Work {
    fn of(snapshot: Snapshot) -> Result<Self> {
        Ok(Self {
            shapes: snapshot.displayed.context(OPEN_FIRST)?.shapes,
            session: snapshot.session,
            shown: snapshot.shown,
        })
    }

    fn shown(&self) -> Result<&ShownShape> {
        self.shown
            .as_deref()
            .context("there is no result yet; drape first")
    }

    /// The landmarks that are complete.
    fn landmarks(&self) -> String {
        let (source, target) = (&self.shapes.source, &self.shapes.target);
        let complete = landmarks(&self.session.document.marks, &self.shapes.source);
        write(&complete, source, target, Form::Json).text
    }

    /// The weights that were painted, for `drape --weights`.
    fn weights(&self) -> Result<Download> {
        let path = self.session.document.parts.weights.as_ref();
        let path = path.filter(|path| !path.starts_with("property:"));
        painted("weights.txt", path.context("no weights were painted")?)
    }

    /// What is painted rigid, for `drape --rigid`.
    fn rigid(&self) -> Result<Download> {
        let path = painted_rigid(&self.session.document.parts);
        painted("rigid.txt", path.context("nothing is painted rigid")?)
    }

    /// The shape that is shown and how it came about.
    fn replayed(&self) -> Result<Replayed> {
        let (log, shown) = (self.log(), self.shown()?);
        let preset = Preset::from_toml(&log.settings)?;
        let start = self
            .shapes
            .pair(landmarks(&log.landmarks, &self.shapes.source));
        Ok(Replayed {
            initial: initial_deformation(&start, preset.initial)?.positions,
            pair: self
                .shapes
                .pair(landmarks(log.last_landmarks(), &self.shapes.source)),
            preset,
            draped: shown.positions.as_ref().clone(),
            network: shown.provenance.as_ref().and_then(|p| p.network.clone()),
        })
    }

    /// The source file with its vertices where they are shown.
    fn result(&self) -> Result<Download> {
        let source = &self.shapes.source;
        let file = source.file().context("the source has no file")?;
        let name = file.path().file_name().unwrap_or_default();
        let positions = source.spread(&self.shown()?.positions);
        let bytes = file.to_bytes(file.path(), &positions)?;
        Ok(Download {
            name: format!("draped-{}", name.to_string_lossy()),
            kind: "application/octet-stream",
            bytes,
        })
    }

    /// The run; a shape without one is taken as one of no iteration.
    fn log(&self) -> RunLog {
        self.session.run.clone().unwrap_or_else(|| RunLog {
            settings: self.session.document.settings.clone(),
            parts: self.session.document.parts.clone(),
            landmarks: self.session.document.marks.clone(),
            events: Vec::new(),
            iteration: 0,
        })
    }
}

/// A file that was painted.
fn painted(name: &str, path: &str) -> Result<Download> {
    Ok(Download {
        name: name.to_owned(),
        kind: "text/plain; charset=utf-8",
        bytes: std::fs::read(path)?,
    })
}

/// The report page of a result.
fn report(made: Replayed) -> Result<String> {
    let outcome = Outcome::of_shapes(made.pair, made.preset, made.initial, made.draped)?;
    let findings = outcome.pair.findings();
    let findings = findings.iter().map(ToString::to_string);
    let notes = outcome.pair.notes();
    let left_out = notes.iter().map(ToString::to_string);
    let warnings: Vec<String> = findings.chain(left_out).collect();
    let page = Page {
        title: "A drape made in the studio",
        outcome: &outcome,
        gallery: &Gallery::new(&outcome.pair, &outcome.initial, None, REPORT_PICTURE)?,
        views: &[View::FRONT_QUARTER, View::BACK_QUARTER],
        warnings: &warnings,
        seconds: None,
        times: &[],
        truth: None,
    };
    Ok(page.to_html()?)
}
