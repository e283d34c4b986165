//! Calls the router as a service, without a socket.

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, Method, Request, Response, StatusCode};
use bytes::Bytes;
use http_body_util::BodyExt;
use rasterd::http::{App, router};
use rasterd::jobs::{Draw, Renderer};
use rasterd::pipeline::{Cancelled, Frame, Pixels, Stats, Timings};
use rasterd::settings::{Machine, Settings};
use serde_json::Value;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use tower::ServiceExt;

/// One triangle, as a model.
pub const TRIANGLE_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// How long a test waits for what must happen.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// One triangle, as a document.
pub fn triangle() -> Value {
    serde_json::json!({
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0] },
        "meshes": { "triangle": { "type": "triangles", "positions": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]] } },
        "instances": { "only": { "mesh": "triangle" } },
        "render": { "width": 32, "height": 24, "samples": 1 },
    })
}

/// Small and quick: two threads draw.
pub fn settings() -> Settings {
    let machine = Machine { threads: NonZeroUsize::new(2), ..Machine::default() };
    Settings { machine, ..Settings::default() }
}

/// A service under test.
#[derive(Clone)]
pub struct Client {
    pub app: App,
    router: Router,
}

/// What came back.
#[derive(Debug)]
pub struct Reply {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Bytes,
}

impl Client {
    pub fn new() -> Self {
        Self::with(settings())
    }

    pub fn with(settings: Settings) -> Self {
        let renderer = Renderer::new(&settings).expect("a pool");
        Self::over(App::new(settings, renderer))
    }

    pub fn drawing_with(settings: Settings, draw: Box<Draw>) -> Self {
        let renderer = Renderer::with_draw(&settings, draw).expect("a pool");
        Self::over(App::new(settings, renderer))
    }

    fn over(app: App) -> Self {
        Self { router: router(app.clone()), app }
    }

    /// The reply to a `GET` as it begins.
    pub async fn open(&self, path: &str, headers: &[(&str, &str)]) -> Response<Body> {
        let mut request = Request::builder().uri(path);
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let request = request.body(Body::empty()).expect("a request");
        self.router.clone().oneshot(request).await.expect("infallible")
    }

    pub async fn send(&self, request: Request<Body>) -> Reply {
        let response = self.router.clone().oneshot(request).await.expect("infallible");
        let (head, body) = response.into_parts();
        let body = body.collect().await.expect("a whole body").to_bytes();
        Reply { status: head.status, headers: head.headers, body }
    }

    /// A call with a content type (none if empty), headers and a body.
    pub async fn call(
        &self,
        method: Method,
        path: &str,
        content_type: &str,
        headers: &[(&str, &str)],
        body: impl Into<Body>,
    ) -> Reply {
        let mut request = Request::builder().method(method).uri(path);
        if !content_type.is_empty() {
            request = request.header("content-type", content_type);
        }
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        self.send(request.body(body.into()).expect("a request")).await
    }

    pub async fn get(&self, path: &str) -> Reply {
        self.get_with(path, &[]).await
    }

    pub async fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Reply {
        self.call(Method::GET, path, "", headers, Body::empty()).await
    }

    pub async fn json(&self, method: Method, path: &str, body: &Value) -> Reply {
        self.call(method, path, "application/json", &[], body.to_string()).await
    }

    /// Puts the triangle under `/scenes/t`.
    pub async fn put_triangle(&self) -> Reply {
        self.json(Method::PUT, "/scenes/t", &triangle()).await
    }
}

impl Reply {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).expect("JSON")
    }

    pub fn header(&self, name: &str) -> &str {
        let value = self.headers.get(name).unwrap_or_else(|| panic!("no {name} in {:?}", self.headers));
        value.to_str().expect("text")
    }

    /// Checks that this is a problem of `status` in full, and gives its JSON.
    #[track_caller]
    pub fn problem(&self, status: u16) -> Value {
        assert_eq!(self.status, status, "{}", String::from_utf8_lossy(&self.body));
        assert_eq!(self.header("content-type"), "application/problem+json");
        let problem = self.json();
        assert_eq!(problem["status"], status);
        assert_eq!(problem["request_id"], self.header("x-request-id"));
        for member in ["type", "title", "detail"] {
            assert!(problem[member].as_str().is_some_and(|text| !text.is_empty()), "{member}: {problem}");
        }
        problem
    }

    /// Checks that this is a PNG and gives its width and height.
    #[track_caller]
    pub fn png_size(&self) -> (u32, u32) {
        assert_eq!(self.status, 200, "{}", String::from_utf8_lossy(&self.body));
        assert_eq!(self.header("content-type"), "image/png");
        png_size(&self.body)
    }
}

/// Width and height of a PNG.
#[track_caller]
pub fn png_size(bytes: &[u8]) -> (u32, u32) {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    (reader.info().width, reader.info().height)
}

/// Frames that have begun and ended.
#[derive(Debug, Default)]
pub struct Counts {
    pub begun: AtomicUsize,
    pub cancelled: AtomicUsize,
}

/// A picture that no drawing has made.
pub fn still(width: u32, height: u32, pixel: impl FnMut(usize) -> [u8; 4]) -> Frame {
    Frame {
        width,
        height,
        pixels: Pixels::Rgba8 { pixels: (0..(width * height) as usize).map(pixel).collect(), opaque: false },
        stats: Stats::default(),
        timings: Timings::default(),
        depth_range: None,
    }
}

/// A drawing step that goes on until it is cancelled.
pub fn endless(counts: &Arc<Counts>) -> Box<Draw> {
    let counts = Arc::clone(counts);
    Box::new(move |_, work| {
        counts.begun.fetch_add(1, Ordering::SeqCst);
        while !work.cancel.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(2));
        }
        counts.cancelled.fetch_add(1, Ordering::SeqCst);
        Err(Cancelled)
    })
}

/// Waits until `condition` holds.
pub async fn until(condition: impl Fn() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !condition() {
        assert!(Instant::now() < end, "waited in vain");
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}
