//! The server: one router, everything behind the guard.

mod assets;
mod export;
mod guard;
mod kept;
mod open;
mod socket;

use std::path::PathBuf;
use std::sync::Arc;

use axum::extract::{DefaultBodyLimit, Path, State};
use axum::http::{header, StatusCode};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::Router;
use tokio::net::TcpListener;

use crate::broadcast::Broadcast;
use crate::controller::{ControllerHandle, Inbox, Snapshot};
use crate::kept_files::KeptFiles;
pub(crate) use guard::Guard;

/// Largest file that a page may send.
const MAX_UPLOAD: usize = 512 << 20;
/// Pages connected at once.
const MAX_SOCKETS: usize = 32;

/// What every handler needs.
pub(crate) struct App {
    pub(crate) controller: ControllerHandle,
    pub(crate) broadcast: Arc<Broadcast>,
    /// Folder of the files that pages send.
    pub(crate) uploads: PathBuf,
    /// Where kept results and other sessions are.
    pub(crate) files: KeptFiles,
    pub(crate) sockets: tokio::sync::Semaphore,
}

impl App {
    pub(crate) fn new(
        controller: ControllerHandle,
        broadcast: Arc<Broadcast>,
        session: &std::path::Path,
    ) -> Self {
        Self {
            controller,
            broadcast,
            uploads: session.with_extension("files"),
            files: KeptFiles::beside(session),
            sockets: tokio::sync::Semaphore::new(MAX_SOCKETS),
        }
    }
}

/// Serves until the process ends.
pub(crate) async fn serve(listener: TcpListener, guard: Guard, app: App) -> std::io::Result<()> {
    let app = Arc::new(app);
    let studio = Router::new()
        .route("/{file}", get(assets::file))
        .route("/mesh/{name}", get(mesh))
        .route("/looks/{name}/{what}", get(kept::looks))
        .route("/kept/{id}/{what}", get(kept::kept))
        .route("/open/{role}/{name}", post(open::open))
        .route("/export/{what}", get(export::export))
        .route("/ws", get(socket::upgrade))
        .layer(DefaultBodyLimit::max(MAX_UPLOAD))
        .with_state(app);
    let router = Router::new()
        .route(&format!("/{}/", guard.token()), get(assets::index))
        .nest(&format!("/{}", guard.token()), studio)
        .layer(middleware::from_fn_with_state(
            Arc::new(guard),
            guard::check,
        ));
    axum::serve(listener, router).await
}

/// All that there is now; none where the studio ends.
async fn snapshot(app: &App) -> Option<Snapshot> {
    let (sender, answer) = tokio::sync::oneshot::channel();
    app.controller.send(Inbox::Snapshot(sender));
    answer.await.ok()
}

/// The buffers of a shape.
async fn mesh(State(app): State<Arc<App>>, Path(name): Path<String>) -> Response {
    let Some(snapshot) = snapshot(&app).await else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let bytes = match name.as_str() {
        "source" => snapshot.source.map(|s| s.buffers.bytes.clone()),
        "target" => snapshot.target.map(|t| t.buffers.bytes.clone()),
        _ => None,
    };
    match bytes {
        Some(bytes) => {
            ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response()
        }
        None => StatusCode::NOT_FOUND.into_response(),
    }
}
