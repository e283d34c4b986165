//! `/scenes/{id}/turntable.gif`, `.png`: once around the target.

use super::frames::Call;
use super::problem::Problem;
use super::query::Pairs;
use super::{App, accept, frames, openapi};
use crate::jobs::{Animation, Product};
use crate::plan::FrameRequest;
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::response::Response;

/// Draw a turn about the target
///
/// The first frame is that of the same query; each next one is turned by 360°/`frames` more about the
/// vertical through the target. A turn lasts 2.5 s, or `frames` fiftieths of a second where that is more,
/// and begins anew. Each frame waits for a turn of its own among others' frames, and has a frame's deadline.
/// Depths need a `far`, here or in the scene's camera, so that all sides share one range.
#[utoipa::path(
    get, path = "/scenes/{id}/turntable.{format}", tag = "frames",
    params(("id" = String, Path, description = "The scene"), openapi::Turn, openapi::FrameQuery),
    responses(
        (status = 200, description = "The moving picture", body = Vec<u8>, headers(("ETag" = String), ("Server-Timing" = String), ("Render-Stats" = String), ("Render-Depth-Range" = String), ("Render-Settings" = String), ("Content-Location" = String))),
        (status = 304, description = "If-None-Match names it; nothing was drawn"),
    ),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path((id, extension)): Path<(String, String)>,
    pairs: Pairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let format = Animation::of_extension(&extension)
        .ok_or_else(|| frames::no_format("turntables", &extension, &Animation::list()))?;
    accept::check(&headers, format.content_type())?;
    let (turntable, request) =
        pairs.read(|query| (Product::read_turntable(query, format), FrameRequest::read(query)))?;
    let scene = app.entry(&id)?.scene;
    let call = Call { name: &id, pairs: &pairs, headers: &headers };
    frames::draw(&app, &call, scene, request, turntable).await
}
