//! Files that a page takes away.

use std::sync::Arc;

use anyhow::{bail, Context as _, Result};
use axum::extract::{Path, State};
use axum::http::{header, StatusCode};
use axum::response::{IntoResponse, Response};
use tokio::sync::oneshot;
use tokio::task::spawn_blocking;

use super::App;
use crate::broadcast::ShownShape;
use crate::controller::{Inbox, Snapshot, OPEN_FIRST};
use crate::course::Start;
use crate::replay::Replayed;
use crate::session::{landmarks, RunLog};
use crate::toolbox::Finished;
use crate::{landmark_file, Scene};

/// A file for the user.
struct Download {
    name: String,
    kind: &'static str,
    bytes: Vec<u8>,
}

/// The result, the warp, the landmarks, the report or the session.
pub(super) async fn export(State(app): State<Arc<App>>, Path(what): Path<String>) -> Response {
    let (sender, answer) = oneshot::channel();
    app.controller.send(Inbox::Snapshot(sender));
    let Ok(snapshot) = answer.await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let made = spawn_blocking(move || make(&app, &what, snapshot)).await;
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

fn make(app: &App, what: &str, snapshot: Snapshot) -> Result<Download> {
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
        "landmarks" => {
            let text = landmark_file::write(&work.scene, &work.session.document.marks)?;
            Ok(download(
                "landmarks.json",
                "application/json",
                text.into_bytes(),
            ))
        }
        "result" => work.result(),
        "warp" => Ok(download(
            "result.drape",
            "application/octet-stream",
            work.warp(app)?,
        )),
        "report" => Ok(download(
            "report.html",
            "text/html; charset=utf-8",
            work.report(app)?,
        )),
        _ => bail!("there is no export '{what}'"),
    }
}

/// A scene with the shape that is shown.
struct Work {
    scene: Scene,
    session: crate::session::Session,
    shown: Option<Arc<ShownShape>>,
}

impl Work {
    fn of(snapshot: Snapshot) -> Result<Self> {
        let (source, target) = snapshot.source.zip(snapshot.target).context(OPEN_FIRST)?;
        Ok(Self {
            scene: Scene { source, target },
            session: snapshot.session,
            shown: snapshot.shown,
        })
    }

    fn shown(&self) -> Result<&ShownShape> {
        self.shown
            .as_deref()
            .context("there is no result yet; drape first")
    }

    /// The shape that is shown and how it came about.
    fn replayed(&self, app: &App) -> Result<Replayed> {
        let (log, shown) = (self.log(), self.shown()?);
        let start = Start::new(&self.scene, app.toolbox.as_ref(), &log)?;
        Ok(Replayed {
            landmarks: landmarks(log.last_landmarks()),
            settings: start.settings,
            initial: start.initial,
            draped: shown.positions.as_ref().clone(),
            network: shown
                .provenance
                .as_ref()
                .and_then(|provenance| provenance.network.clone()),
            scene: self.scene.clone(),
        })
    }

    /// The source file with its vertices where they are shown.
    fn result(&self) -> Result<Download> {
        let file = &self.scene.source.file;
        let name = file.path().file_name().unwrap_or_default();
        let positions = self.scene.source.spread(&self.shown()?.positions);
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

    fn warp(&self, app: &App) -> Result<Vec<u8>> {
        Ok(self.replayed(app)?.warp()?.to_bytes())
    }

    fn report(&self, app: &App) -> Result<Vec<u8>> {
        let made = self.replayed(app)?;
        let page = app.toolbox.report(Finished {
            scene: &made.scene,
            landmarks: &made.landmarks,
            settings: &made.settings,
            initial: &made.initial,
            draped: &made.draped,
        })?;
        Ok(page.into_bytes())
    }
}
