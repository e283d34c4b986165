//! `/render.png`, `.jpg`, …: a model or a scene in, its picture out, nothing kept.

use super::frames::Call;
use super::problem::Problem;
use super::query::{Pairs, source};
use super::{App, accept, blocking, body, frames, openapi};
use crate::plan::FrameRequest;
use axum::extract::{Path, Request, State};
use axum::response::Response;
use std::sync::Arc;

/// Draw a model or a scene once
///
/// Body and query as for creating a scene and for its frame; nothing is kept.
#[utoipa::path(
    post, path = "/render.{format}", tag = "frames",
    params(openapi::SourceQuery, openapi::FrameQuery),
    request_body(content((serde_json::Value = "application/json"), (String = "multipart/form-data"), (String = "model/obj"), (String = "text/plain"), (String = "application/octet-stream"), (String = "application/x-www-form-urlencoded"))),
    responses(
        (status = 200, description = "The picture", body = Vec<u8>, headers(("ETag" = String), ("Server-Timing" = String), ("Render-Stats" = String), ("Render-Depth-Range" = String), ("Render-Settings" = String))),
        (status = 304, description = "If-None-Match names it; nothing was drawn"),
    ),
)]
pub(super) async fn draw(
    State(app): State<App>,
    Path(extension): Path<String>,
    pairs: Pairs,
    request: Request,
) -> Result<Response, Problem> {
    let format = frames::format(&extension)?;
    accept::check(request.headers(), format.content_type())?;
    let (source, frame) = pairs.read(|query| (source(query), FrameRequest::read(query)))?;
    let headers = request.headers().clone();
    let new = body::scene(request, app.body_bounds(), source).await?;
    let limits = *app.renderer.limits();
    let scene = blocking::compile(&app.renderer, move || new.compile(&limits)).await?;
    let call = Call { name: "-", pairs: &pairs, headers: &headers };
    frames::draw(&app, &call, Arc::new(scene), frame, format).await
}
