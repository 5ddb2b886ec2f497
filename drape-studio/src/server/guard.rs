//! Who may talk to the server: pages that it served itself, under the address that it printed.

use std::net::SocketAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{header, HeaderMap, HeaderName, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// What a request must know.
pub(crate) struct Guard {
    token: String,
    hosts: Vec<String>,
}

/// Set on every answer: nothing from elsewhere is loaded, and no other page may show or read what is here.
const ANSWER_HEADERS: [(HeaderName, &str); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
    (
        HeaderName::from_static("cross-origin-opener-policy"),
        "same-origin",
    ),
];

impl Guard {
    /// A guard with a fresh token for a server at `address`.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub(crate) fn new(address: SocketAddr) -> anyhow::Result<Self> {
        let mut bytes = [0u8; 16];
        getrandom::fill(&mut bytes)
            .map_err(|error| anyhow::anyhow!("the system gives no random numbers: {error}"))?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self::with_token(address, token))
    }

    /// A guard with a token that pages know already.
    pub(crate) fn with_token(address: SocketAddr, token: String) -> Self {
        let port = address.port();
        Self {
            token,
            hosts: vec![
                format!("127.0.0.1:{port}"),
                format!("localhost:{port}"),
                address.to_string(),
            ],
        }
    }

    pub(crate) fn token(&self) -> &str {
        &self.token
    }

    /// Why a request is refused; none where it is not.
    fn refusal(&self, method: &Method, path: &str, headers: &HeaderMap) -> Option<&'static str> {
        let host = headers.get(header::HOST).and_then(|h| h.to_str().ok());
        if !host.is_some_and(|host| self.hosts.iter().any(|h| h == host)) {
            return Some("this server answers to its own address only");
        }
        let needs_origin = method != Method::GET || headers.contains_key(header::UPGRADE);
        match headers.get(header::ORIGIN) {
            None if needs_origin => return Some("the request does not say which page it is from"),
            None => {}
            Some(origin) => {
                let own = |host: &String| origin.as_bytes() == format!("http://{host}").as_bytes();
                if !self.hosts.iter().any(own) {
                    return Some("another site's page is not served");
                }
            }
        }
        let token = path.trim_start_matches('/').split('/').next();
        if !is_same(token.unwrap_or_default().as_bytes(), self.token.as_bytes()) {
            return Some("open the address that drape studio printed, with all of its letters");
        }
        None
    }
}

/// Whether what follows is said to be more than is taken, which is refused before any of it is read.
fn announces_too_much(headers: &HeaderMap) -> bool {
    let length = headers.get(header::CONTENT_LENGTH);
    let length = length.and_then(|l| l.to_str().ok()?.parse::<usize>().ok());
    length.is_some_and(|length| length > super::MAX_UPLOAD)
}

/// Takes as long whatever the difference.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (x, y)| all | (x ^ y)) == 0
}

/// Lets a request through or refuses it.
pub(crate) async fn check(
    State(guard): State<Arc<Guard>>,
    request: Request,
    next: Next,
) -> Response {
    let refusal = guard.refusal(request.method(), request.uri().path(), request.headers());
    let mut response = match refusal {
        Some(reason) => (StatusCode::FORBIDDEN, reason).into_response(),
        None if announces_too_much(request.headers()) => {
            StatusCode::PAYLOAD_TOO_LARGE.into_response()
        }
        None => next.run(request).await,
    };
    for (name, value) in ANSWER_HEADERS {
        response
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard() -> Guard {
        Guard::new(SocketAddr::from(([127, 0, 0, 1], 4321))).unwrap()
    }

    fn headers(entries: &[(HeaderName, &'static str)]) -> HeaderMap {
        let entry = |(name, value): &(HeaderName, &'static str)| {
            (name.clone(), HeaderValue::from_static(value))
        };
        entries.iter().map(entry).collect()
    }

    #[test]
    fn only_the_own_page_gets_through() {
        let guard = guard();
        let path = format!("/{}/ws", guard.token());
        let host = (header::HOST, "127.0.0.1:4321");
        let own = (header::ORIGIN, "http://127.0.0.1:4321");
        let upgrade = (header::UPGRADE, "websocket");
        let ask = |method: Method, path: &str, entries: &[(HeaderName, &'static str)]| {
            guard.refusal(&method, path, &headers(entries)).is_none()
        };
        assert!(ask(Method::GET, &path, std::slice::from_ref(&host)));
        assert!(ask(
            Method::GET,
            &path,
            &[host.clone(), own.clone(), upgrade.clone()]
        ));
        assert!(ask(Method::POST, &path, &[host.clone(), own.clone()]));

        assert!(!ask(Method::POST, &path, std::slice::from_ref(&host)));
        assert!(!ask(Method::GET, &path, &[host.clone(), upgrade.clone()]));
        for other in [
            "http://evil.example",
            "null",
            "https://127.0.0.1:4321",
            "http://127.0.0.1:1",
        ] {
            assert!(!ask(
                Method::GET,
                &path,
                &[host.clone(), (header::ORIGIN, other)]
            ));
        }
        for other in [
            "evil.example",
            "evil.example:4321",
            "127.0.0.1",
            "127.0.0.1:43210",
        ] {
            assert!(!ask(Method::GET, &path, &[(header::HOST, other)]));
        }
        assert!(!ask(Method::GET, "/", std::slice::from_ref(&host)));
        let short = &path[..path.len() - 4];
        assert!(!ask(Method::GET, short, std::slice::from_ref(&host)));
        assert!(!ask(Method::GET, &format!("/x{path}"), &[host]));
    }

    #[test]
    fn every_server_has_a_token_of_its_own() {
        assert_ne!(guard().token(), guard().token());
        assert_eq!(guard().token().len(), 32);
    }
}
