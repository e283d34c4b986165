//! `/scenes/{id}/frame.zip`: several pictures of one frame, and what a program needs to know about them.

use super::frames::Call;
use super::problem::Problem;
use super::query::Pairs;
use super::{App, accept, frames, openapi};
use crate::jobs::Product;
use crate::plan::FrameRequest;
use axum::extract::{Path, Request, State};
use axum::http::HeaderMap;
use axum::response::Response;

const ZIP: &str = "application/zip";

/// Draw several outputs of a frame
///
/// `color.png`, `depth.png`, …, and `frame.json`: the camera with its matrices, what the ends of depth
/// stand for, and every instance with its value in `instance.png`.
#[utoipa::path(
    get, path = "/scenes/{id}/frame.zip", tag = "frames",
    params(("id" = String, Path, description = "The scene"), openapi::Outputs, openapi::FrameQuery),
    responses(
        (status = 200, description = "The archive", body = Vec<u8>, content_type = "application/zip", headers(("ETag" = String), ("Server-Timing" = String), ("Render-Stats" = String), ("Render-Depth-Range" = String), ("Render-Settings" = String), ("Content-Location" = String))),
        (status = 304, description = "If-None-Match names it; nothing was drawn"),
    ),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    accept::check(&headers, ZIP)?;
    let (archive, request) = pairs.read(query)?;
    let scene = app.entry(&id)?.scene;
    let call = Call { name: &id, pairs: &pairs, headers: &headers };
    frames::draw(&app, &call, scene, request, archive).await
}

/// Draw several outputs of a frame of a changed scene
///
/// The body is a JSON merge patch that holds for this frame alone.
#[utoipa::path(
    post, path = "/scenes/{id}/frame.zip", tag = "frames",
    params(("id" = String, Path, description = "The scene"), openapi::Outputs, openapi::FrameQuery),
    request_body(content((serde_json::Value = "application/merge-patch+json"), (serde_json::Value = "application/json"))),
    responses(
        (status = 200, description = "The archive", body = Vec<u8>, content_type = "application/zip", headers(("ETag" = String), ("Server-Timing" = String), ("Render-Stats" = String), ("Render-Depth-Range" = String), ("Render-Settings" = String))),
        (status = 304, description = "If-None-Match names it; nothing was drawn"),
    ),
)]
pub(super) async fn of_changed(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
    request: Request,
) -> Result<Response, Problem> {
    accept::check(request.headers(), ZIP)?;
    let (archive, frame) = pairs.read(query)?;
    let headers = request.headers().clone();
    let scene = frames::changed(&app, &id, request).await?;
    let call = Call { name: &id, pairs: &pairs, headers: &headers };
    frames::draw(&app, &call, scene, frame, archive).await
}

fn query(query: &mut crate::plan::request::Query) -> (Product, FrameRequest) {
    (Product::read_archive(query), FrameRequest::read(query))
}
