//! Around every request: its id, its error body, and its one line in the log.

use super::{App, problem};
use axum::body::HttpBody;
use axum::extract::{MatchedPath, Request, State};
use axum::http::header::CONTENT_LENGTH;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method};
use axum::middleware::Next;
use axum::response::Response;
use std::hash::{BuildHasher, RandomState};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// What a frame's reply adds to its log line.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameNote {
    pub(super) scene: String,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) queue_ms: f64,
    pub(super) render_ms: f64,
    pub(super) encode_ms: f64,
}

/// The outermost layer.
pub(super) async fn observe(State(app): State<App>, request: Request, next: Next) -> Response {
    let id = sane_id(request.headers()).unwrap_or_else(fresh_id);
    let mut line = LogLine::new(&id, &request);

    // The router takes the body off a good reply to HEAD after this, and leaves its length.
    let mut response = problem::complete(next.run(request).await, &id, &line.method);
    if let Ok(value) = HeaderValue::from_str(&id) {
        response.headers_mut().insert(REQUEST_ID, value);
    }
    app.renderer.metrics().count_request(&line.route, response.status().as_u16());
    line.write(&response);
    response
}

/// An incoming id, if it is short and plain enough to be repeated in headers and logs.
fn sane_id(headers: &HeaderMap) -> Option<String> {
    let id = headers.get(REQUEST_ID)?.to_str().ok()?;
    let plain = id.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte));
    (plain && (1..=64).contains(&id.len())).then(|| id.to_owned())
}

/// Sixteen hexadecimal digits, different for every request and every start of the program.
pub(super) fn fresh_id() -> String {
    static KEYS: LazyLock<RandomState> = LazyLock::new(RandomState::new);
    static COUNT: AtomicU64 = AtomicU64::new(0);
    format!("{:016x}", KEYS.hash_one(COUNT.fetch_add(1, Ordering::Relaxed)))
}

/// Written once: with the reply, or when the client left before there was one.
struct LogLine {
    id: String,
    method: Method,
    route: String,
    started: Instant,
    written: bool,
}

impl LogLine {
    fn new(id: &str, request: &Request) -> Self {
        let route = request.extensions().get::<MatchedPath>();
        Self {
            id: id.to_owned(),
            method: request.method().clone(),
            route: route.map_or("-", MatchedPath::as_str).to_owned(),
            started: Instant::now(),
            written: false,
        }
    }

    fn write(&mut self, response: &Response) {
        self.written = true;
        let (id, method, route) = (&self.id, &self.method, &self.route);
        let (status, ms) = (response.status().as_u16(), self.ms());
        let bytes = length(response);
        match response.extensions().get::<FrameNote>() {
            Some(FrameNote { scene, width, height, queue_ms, render_ms, encode_ms }) => tracing::info!(
                id, %method, route, status, ms, bytes, scene, width, height,
                queue_ms = rounded(*queue_ms), render_ms = rounded(*render_ms), encode_ms = rounded(*encode_ms),
                "request"
            ),
            None => tracing::info!(id, %method, route, status, ms, bytes, "request"),
        }
    }

    fn ms(&self) -> f64 {
        rounded(self.started.elapsed().as_secs_f64() * 1e3)
    }
}

/// To microseconds: a log is read by people.
fn rounded(ms: f64) -> f64 {
    (ms * 1e3).round() / 1e3
}

impl Drop for LogLine {
    fn drop(&mut self) {
        if !self.written {
            let (id, method, route) = (&self.id, &self.method, &self.route);
            tracing::info!(id, %method, route, ms = self.ms(), "client left");
        }
    }
}

fn length(response: &Response) -> Option<u64> {
    let stated = response.headers().get(CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse().ok());
    stated.or_else(|| response.body().size_hint().exact())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_ids_are_taken_over() {
        let of = |value: &str| {
            let value = HeaderValue::from_str(value).expect("a header");
            sane_id(&HeaderMap::from_iter([(REQUEST_ID, value)]))
        };
        assert_eq!(of("a-B_9.z").as_deref(), Some("a-B_9.z"));
        assert!(of("").is_none() && of("a b").is_none() && of(&"x".repeat(65)).is_none());
    }

    #[test]
    fn fresh_ids_differ() {
        assert_ne!(fresh_id(), fresh_id());
    }
}
