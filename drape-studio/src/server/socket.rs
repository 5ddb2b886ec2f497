//! The live connection of a page.

use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{json, Value};
use tokio::sync::{oneshot, watch};
use tokio::task::spawn_blocking;

use super::App;
use crate::broadcast::ShownShape;
use crate::controller::{Inbox, Request};
use crate::heat::Heat;

/// Largest message that a page may send: a settings file.
const MAX_MESSAGE: usize = 256 << 10;

/// What a page sends.
#[derive(Deserialize)]
#[serde(untagged)]
enum FromPage {
    /// It has drawn this shape and can take another.
    Ready { ready: u32 },
    /// It wants the heat map of the newest shape.
    Heat { heat: Heat },
    Ask {
        id: u32,
        #[serde(flatten)]
        request: Value,
    },
}

/// Takes a page's connection.
pub(super) async fn upgrade(State(app): State<Arc<App>>, upgrade: WebSocketUpgrade) -> Response {
    if app.sockets.available_permits() == 0 {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are open").into_response();
    }
    upgrade
        .max_message_size(MAX_MESSAGE)
        .max_frame_size(MAX_MESSAGE)
        .on_upgrade(move |socket| async move {
            if let Ok(_permit) = app.sockets.try_acquire() {
                Connection::new(&app, socket).serve().await;
            }
        })
}

struct Connection<'a> {
    app: &'a App,
    socket: WebSocket,
    state: watch::Receiver<Arc<str>>,
    progress: watch::Receiver<Arc<str>>,
    figures: watch::Receiver<Arc<str>>,
    shown: watch::Receiver<Option<Arc<ShownShape>>>,
    /// The shape that the page has not drawn yet.
    undrawn: Option<u32>,
}

/// What happened first.
enum Happened {
    Received(Option<Result<Message, axum::Error>>),
    Text(Arc<str>),
    Shown(Option<Arc<ShownShape>>),
}

impl<'a> Connection<'a> {
    fn new(app: &'a App, socket: WebSocket) -> Self {
        let mut connection = Self {
            state: app.broadcast.state.subscribe(),
            progress: app.broadcast.progress.subscribe(),
            figures: app.broadcast.figures.subscribe(),
            shown: app.broadcast.shown.subscribe(),
            app,
            socket,
            undrawn: None,
        };
        connection.state.mark_changed();
        connection.progress.mark_changed();
        connection.figures.mark_changed();
        connection.shown.mark_changed();
        connection
    }

    /// Until the page is gone.
    async fn serve(&mut self) {
        loop {
            let sent = match self.next().await {
                Happened::Received(Some(Ok(Message::Text(text)))) => self.answer(&text).await,
                Happened::Received(Some(Ok(Message::Binary(_)))) => {
                    self.send(&json!({ "type": "error", "error": "a page sends text" }))
                        .await
                }
                Happened::Received(Some(Ok(Message::Ping(_) | Message::Pong(_)))) => true,
                Happened::Received(_) => false,
                Happened::Text(text) if text.is_empty() => true,
                Happened::Text(text) => self.send_text(&text).await,
                Happened::Shown(None) => true,
                Happened::Shown(Some(shown)) => {
                    self.undrawn = Some(shown.serial);
                    self.send_bytes(shown.message.clone()).await
                }
            };
            if !sent {
                return;
            }
        }
    }

    async fn next(&mut self) -> Happened {
        let Self {
            socket,
            state,
            progress,
            figures,
            shown,
            undrawn,
            ..
        } = self;
        tokio::select! {
            biased;
            message = socket.recv() => Happened::Received(message),
            Ok(()) = state.changed() => Happened::Text(state.borrow_and_update().clone()),
            Ok(()) = progress.changed() => Happened::Text(progress.borrow_and_update().clone()),
            Ok(()) = figures.changed() => Happened::Text(figures.borrow_and_update().clone()),
            Ok(()) = shown.changed(), if undrawn.is_none() => {
                Happened::Shown(shown.borrow_and_update().clone())
            }
            else => Happened::Received(None),
        }
    }

    /// Answers one message; false where the page is gone.
    async fn answer(&mut self, text: &Utf8Bytes) -> bool {
        match serde_json::from_str(text) {
            Ok(FromPage::Ready { ready }) => {
                self.undrawn = self.undrawn.filter(|serial| *serial != ready);
                true
            }
            Ok(FromPage::Heat { heat }) => self.send_heat(heat).await,
            Ok(FromPage::Ask { id, request }) => {
                let answer = ask(self.app, request).await;
                let reply = match answer {
                    Ok(value) => json!({ "type": "reply", "id": id, "value": value }),
                    Err(error) => json!({ "type": "reply", "id": id, "error": error }),
                };
                self.send(&reply).await
            }
            Err(error) => {
                let text = format!("this is no request: {error}");
                self.send(&json!({ "type": "error", "error": text })).await
            }
        }
    }

    async fn send_heat(&mut self, heat: Heat) -> bool {
        let shown = self.app.broadcast.shown.borrow().clone();
        let Some((displayed, shown)) = self.app.broadcast.displayed().zip(shown) else {
            return true;
        };
        match spawn_blocking(move || heat.message(&displayed, &shown)).await {
            Ok(message) => self.send_bytes(message.into()).await,
            Err(_) => true,
        }
    }

    async fn send(&mut self, value: &Value) -> bool {
        self.send_text(&value.to_string()).await
    }

    async fn send_text(&mut self, text: &str) -> bool {
        self.socket.send(Message::text(text)).await.is_ok()
    }

    async fn send_bytes(&mut self, bytes: Bytes) -> bool {
        self.socket.send(Message::Binary(bytes)).await.is_ok()
    }
}

/// What the controller answers.
async fn ask(app: &App, request: Value) -> Result<Value, String> {
    let request: Request =
        serde_json::from_value(request).map_err(|error| format!("this is no request: {error}"))?;
    let (sender, answer) = oneshot::channel();
    app.controller.send(Inbox::Request(request, sender));
    answer
        .await
        .unwrap_or_else(|_| Err("the studio has ended".to_owned()))
}
