//! `/metrics`: what has happened so far, as Prometheus reads it.

use super::App;
use super::query::NoQuery;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use std::fmt::Write;

/// Of the text format, version 0.0.4.
const TEXT: &str = "text/plain; version=0.0.4; charset=utf-8";

/// Counters and gauges
///
/// In the text format of Prometheus.
#[utoipa::path(get, path = "/metrics", tag = "service", responses((status = 200, description = "What has happened so far", body = String)))]
pub(super) async fn read(State(app): State<App>, _: NoQuery) -> Response {
    ([(CONTENT_TYPE, TEXT)], text(&app)).into_response()
}

fn text(app: &App) -> String {
    let counters = app.renderer.counters();
    let scenes = app.store.list();
    let bytes = scenes.iter().map(|entry| entry.bytes).sum();
    let mut text = Text::default();
    text.family("frames_rendered_total", "counter", "Frames drawn");
    text.value("frames_rendered_total{kind=\"frame\"}", counters.frames.get());
    text.value("frames_rendered_total{kind=\"stream\"}", counters.stream_frames.get());
    text.single(
        "queue_depth",
        "gauge",
        "Frames that wait for their turn",
        app.renderer.queue().depth().waiting as u64,
    );
    text.single("scenes", "gauge", "Scenes", scenes.len() as u64);
    text.single("scene_bytes", "gauge", "Bytes of all scenes", bytes);
    text.single("streams", "gauge", "Different streams that are watched", app.streams.count() as u64);
    text.single(
        "stream_watchers",
        "gauge",
        "Who watches a stream, or listens to its events",
        counters.watchers.get(),
    );
    text.single(
        "stream_frames_sent_total",
        "counter",
        "Pictures given to watchers",
        counters.pictures_sent.get(),
    );
    text.single(
        "stream_frames_dropped_total",
        "counter",
        "Pictures that a watcher was too slow for",
        counters.pictures_dropped.get(),
    );
    text.0
}

/// Lines of the format, all names with the program's own in front.
#[derive(Debug, Default)]
struct Text(String);

impl Text {
    fn family(&mut self, name: &str, kind: &str, help: &str) {
        // Writing to a string does not fail.
        let _ = writeln!(self.0, "# HELP rasterd_{name} {help}\n# TYPE rasterd_{name} {kind}");
    }

    fn value(&mut self, name: &str, value: u64) {
        let _ = writeln!(self.0, "rasterd_{name} {value}");
    }

    /// A family of one value.
    fn single(&mut self, name: &str, kind: &str, help: &str, value: u64) {
        self.family(name, kind, help);
        self.value(name, value);
    }
}
