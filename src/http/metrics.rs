//! `/metrics`: what has happened so far, as Prometheus reads it.

use super::App;
use super::query::NoQuery;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};

/// Of the text format.
const TEXT: &str = "text/plain; version=0.0.4; charset=utf-8";

/// Counters and gauges
///
/// In the text format of Prometheus.
#[utoipa::path(get, path = "/metrics", tag = "service", responses((status = 200, description = "What has happened so far", body = String)))]
pub(super) async fn read(State(app): State<App>, _: NoQuery) -> Response {
    let metrics = app.renderer.metrics();
    let scenes = app.store.list();
    metrics.queue_depth.set(gauge(app.renderer.queue().depth().waiting as u64));
    metrics.scenes.set(gauge(scenes.len() as u64));
    metrics.scene_bytes.set(gauge(scenes.iter().map(|entry| entry.bytes).sum()));
    metrics.streams.set(gauge(app.streams.count() as u64));
    ([(CONTENT_TYPE, TEXT)], metrics.text()).into_response()
}

fn gauge(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}
