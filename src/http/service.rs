//! What operators ask: alive, ready, which version. None of it waits for a frame.

use super::App;
use super::problem::Problem;
use super::query::NoQuery;
use crate::settings::Simd;
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use serde_json::{Value, json};

/// Whether the server lives
#[utoipa::path(get, path = "/healthz", tag = "service", responses((status = 200, description = "It does", body = String)))]
pub(super) async fn healthz(_: NoQuery) -> &'static str {
    "ok\n"
}

/// Whether the server takes work
#[utoipa::path(get, path = "/readyz", tag = "service", responses((status = 200, description = "It does", body = String)))]
pub(super) async fn readyz(State(app): State<App>, _: NoQuery) -> Result<&'static str, Problem> {
    if app.is_ready() {
        Ok("ready\n")
    } else {
        Err(Problem::new(StatusCode::SERVICE_UNAVAILABLE, "the server is going down"))
    }
}

/// Version, commit, SIMD level
#[utoipa::path(get, path = "/version", tag = "service", responses((status = 200, description = "What runs here", body = Value)))]
pub(super) async fn version(State(app): State<App>, _: NoQuery) -> Json<Value> {
    Json(json!({
        "name": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "commit": option_env!("RASTERD_COMMIT"),
        "simd": app.settings.machine.simd.unwrap_or_else(Simd::best).name(),
        "threads": app.renderer.threads(),
    }))
}
