//! Bytes of kept results, and of the looks of shapes.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::{header, StatusCode};
use axum::response::{IntoResponse, Response};
use tokio::task::spawn_blocking;

use super::{snapshot, App};
use crate::buffers::position_bytes;
use crate::controller::Snapshot;
use crate::looks::kind_of;

const BYTES: &str = "application/octet-stream";

/// The picture of a kept result, or its positions in the frame of the target that is open.
pub(super) async fn kept(
    State(app): State<Arc<App>>,
    Path((id, what)): Path<(u32, String)>,
) -> Response {
    let Some(snapshot) = snapshot(&app).await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let read = spawn_blocking(move || read(&app, &snapshot, id, &what)).await;
    match read.ok().flatten() {
        Some((kind, bytes)) => ([(header::CONTENT_TYPE, kind)], bytes).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

fn read(app: &App, snapshot: &Snapshot, id: u32, what: &str) -> Option<(&'static str, Vec<u8>)> {
    let is_kept = snapshot.session.kept.iter().any(|kept| kept.id == id);
    match what {
        _ if !is_kept => None,
        "picture" => Some(("image/png", std::fs::read(app.files.picture(id)).ok()?)),
        "positions" => {
            let frame = &snapshot.target.as_ref()?.frame;
            Some((BYTES, position_bytes(frame, &app.files.read(id).ok()?)))
        }
        _ => None,
    }
}

/// Colours, texture coordinates or a picture of a shape.
pub(super) async fn looks(
    State(app): State<Arc<App>>,
    Path((name, what)): Path<(String, String)>,
) -> Response {
    let Some(snapshot) = snapshot(&app).await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let bytes = match name.as_str() {
        "source" => snapshot.source.and_then(|s| s.looks.bytes(&what)),
        "target" => snapshot.target.and_then(|t| t.looks.bytes(&what)),
        _ => None,
    };
    match bytes {
        Some(bytes) => ([(header::CONTENT_TYPE, kind_of(&bytes))], bytes).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}
