//! The studio's socket and pages without a browser.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::{json, Value};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

use super::server::Server;
use crate::support::Workplace;

/// A connection such as a page has.
pub(crate) struct Wire {
    socket: WebSocket<TcpStream>,
    next: u32,
}

impl Wire {
    /// Connects as the studio's own page does.
    pub(crate) fn own(server: &Server) -> Self {
        let origin = format!("http://{}", server.host());
        Self::connect(server, &server.path(), Some(&origin)).expect("the own page is served")
    }

    /// Connects with a path and an origin; the status of the refusal where it is refused.
    pub(crate) fn connect(server: &Server, path: &str, origin: Option<&str>) -> Result<Self, u16> {
        let stream = TcpStream::connect(server.host()).expect("the studio listens");
        stream
            .set_read_timeout(Some(Duration::from_secs(60)))
            .expect("a stream takes a timeout");
        let url = format!("ws://{}{path}ws", server.host());
        let mut request = url.into_client_request().expect("a request");
        if let Some(origin) = origin {
            let origin = HeaderValue::from_str(origin).expect("an origin");
            request.headers_mut().insert("Origin", origin);
        }
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(Self { socket, next: 1 }),
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(response))) => {
                Err(response.status().as_u16())
            }
            Err(error) => panic!("{error}"),
        }
    }

    pub(crate) fn send(&mut self, text: &str) -> bool {
        self.socket.send(Message::text(text)).is_ok()
    }

    /// The next message that is JSON; none where the connection has ended.
    pub(crate) fn hear(&mut self) -> Option<Value> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    return Some(serde_json::from_str(&text).expect("the studio sends JSON"));
                }
                Ok(Message::Close(_)) | Err(_) => return None,
                Ok(_) => {}
            }
        }
    }

    /// Sends a request without waiting for its answer; its number.
    pub(crate) fn post(&mut self, mut request: Value) -> u32 {
        let id = self.next;
        self.next += 1;
        request["id"] = json!(id);
        assert!(self.send(&request.to_string()), "the studio listens");
        id
    }

    /// The answer to a request.
    pub(crate) fn answer(&mut self, id: u32) -> Value {
        loop {
            let message = self.hear().expect("the studio answers");
            if message["type"] == "reply" && message["id"] == json!(id) {
                return message;
            }
        }
    }

    pub(crate) fn ask(&mut self, request: Value) -> Value {
        let id = self.post(request);
        self.answer(id)
    }

    /// The next state for which a condition holds.
    pub(crate) fn state(&mut self, holds: impl Fn(&Value) -> bool) -> Value {
        loop {
            let message = self.hear().expect("the studio tells its state");
            if message["type"] == "state" && holds(&message) {
                return message;
            }
        }
    }
}

/// Replays the session as it is from the command line: it comes to this result, to the bit.
pub(crate) fn replays_to(place: &Workplace, server: &Server, result: &[u8]) {
    std::fs::write(place.path("exported.json"), download(server, "session"))
        .expect("the session is written");
    place.drape("replay exported.json -o replayed.obj").well();
    assert!(
        place.read("replayed.obj").as_bytes() == result,
        "the replay came to another result"
    );
}

/// What the export menu gives.
pub(crate) fn download(server: &Server, what: &str) -> Vec<u8> {
    let (path, host) = (server.path(), server.host());
    let request = format!("GET {path}export/{what} HTTP/1.0\r\nHost: {host}\r\n\r\n");
    let answer = raw_bytes(server, &request);
    let head = answer.windows(4).position(|w| w == b"\r\n\r\n");
    let (head, body) = answer.split_at(head.expect("a head") + 4);
    let head = String::from_utf8_lossy(head);
    assert!(head.starts_with("HTTP/1.0 200"), "{head}");
    body.to_vec()
}

/// Sends a request as it stands; the whole answer as text.
pub(crate) fn raw(server: &Server, request: &str) -> String {
    String::from_utf8_lossy(&raw_bytes(server, request)).into_owned()
}

fn raw_bytes(server: &Server, request: &str) -> Vec<u8> {
    let mut stream = TcpStream::connect(server.host()).expect("the studio listens");
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .expect("a stream takes a timeout");
    stream
        .write_all(request.as_bytes())
        .expect("the studio reads");
    let mut answer = Vec::new();
    // A server that has said enough may close before everything was read.
    drop(stream.read_to_end(&mut answer));
    answer
}
