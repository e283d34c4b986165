//! `/scenes/{id}/frame.png`, `.jpg`, …: the picture.

use super::observe::FrameNote;
use super::problem::Problem;
use super::query::Pairs;
use super::{App, accept, blocking, body, etag, openapi};
use crate::jobs::{Format, Product, Rendered};
use crate::plan::FrameRequest;
use crate::report::choose::Choice;
use crate::scene::Scene;
use axum::extract::{Path, Request, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_LOCATION, CONTENT_TYPE, ETAG};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use std::fmt::Display;
use std::sync::Arc;

const SERVER_TIMING: HeaderName = HeaderName::from_static("server-timing");
const RENDER_SETTINGS: HeaderName = HeaderName::from_static("render-settings");
const RENDER_STATS: HeaderName = HeaderName::from_static("render-stats");
const RENDER_DEPTH_RANGE: HeaderName = HeaderName::from_static("render-depth-range");

/// Caches may keep a frame, but ask each time whether it still holds.
const NO_CACHE: (HeaderName, HeaderValue) = (CACHE_CONTROL, HeaderValue::from_static("no-cache"));

/// Draw a frame
#[utoipa::path(
    get, path = "/scenes/{id}/frame.{format}", tag = "frames",
    params(("id" = String, Path, description = "The scene"), openapi::FrameQuery),
    responses(
        (status = 200, description = "The picture", body = Vec<u8>, headers(("ETag" = String), ("Server-Timing" = String), ("Render-Stats" = String), ("Render-Depth-Range" = String), ("Render-Settings" = String), ("Content-Location" = String))),
        (status = 304, description = "If-None-Match names it; nothing was drawn"),
    ),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path((id, extension)): Path<(String, String)>,
    pairs: Pairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let format = format(&extension)?;
    accept::check(&headers, format.content_type())?;
    let request = pairs.frame()?;
    let scene = app.entry(&id)?.scene;
    draw(&app, &Call { name: &id, pairs: &pairs, headers: &headers }, scene, request, format).await
}

/// Draw a frame of a changed scene
///
/// The body is a JSON merge patch that holds for this frame alone.
#[utoipa::path(
    post, path = "/scenes/{id}/frame.{format}", tag = "frames",
    params(("id" = String, Path, description = "The scene"), openapi::FrameQuery),
    request_body(content((serde_json::Value = "application/merge-patch+json"), (serde_json::Value = "application/json"))),
    responses(
        (status = 200, description = "The picture", body = Vec<u8>, headers(("ETag" = String), ("Server-Timing" = String), ("Render-Stats" = String), ("Render-Depth-Range" = String), ("Render-Settings" = String))),
        (status = 304, description = "If-None-Match names it; nothing was drawn"),
    ),
)]
pub(super) async fn of_changed(
    State(app): State<App>,
    Path((id, extension)): Path<(String, String)>,
    pairs: Pairs,
    request: Request,
) -> Result<Response, Problem> {
    let format = format(&extension)?;
    accept::check(request.headers(), format.content_type())?;
    let frame = pairs.frame()?;
    let headers = request.headers().clone();
    let scene = changed(&app, &id, request).await?;
    draw(&app, &Call { name: &id, pairs: &pairs, headers: &headers }, scene, frame, format).await
}

/// The format that a path ends with, else a 406 that names all.
pub(super) fn format(extension: &str) -> Result<Format, Problem> {
    Format::of_extension(extension).ok_or_else(|| no_format("pictures", extension, &Format::list()))
}

/// 406 for an extension that is none of `known`.
pub(super) fn no_format(what: &str, extension: &str, known: &str) -> Problem {
    let extension: String = extension.chars().take(16).collect();
    Problem::new(StatusCode::NOT_ACCEPTABLE, format!("{what} come as {known}, not as .{extension}"))
}

/// The scene with the patch in the body of `request`, which nobody else sees.
pub(super) async fn changed(app: &App, id: &str, request: Request) -> Result<Arc<Scene>, Problem> {
    let entry = app.entry(id)?;
    let patch = body::patch(request, app.body_bounds()).await?;
    let limits = *app.renderer.limits();
    blocking::compile(&app.renderer, move || entry.patched(&patch, &limits)).await
}

/// A call for a picture.
pub(super) struct Call<'a> {
    /// The scene's name, for the log.
    pub(super) name: &'a str,
    /// Its path and query.
    pub(super) pairs: &'a Pairs,
    /// What else it says.
    pub(super) headers: &'a HeaderMap,
}

/// Draws and replies, or says that the client has the picture already. A budget is settled first.
pub(super) async fn draw(
    app: &App,
    call: &Call<'_>,
    scene: Arc<Scene>,
    request: FrameRequest,
    product: impl Into<Product>,
) -> Result<Response, Problem> {
    let product = product.into();
    let (request, choice) = app.renderer.to_budget(&scene, request).await?;
    let mut response = picture(app, call, scene, request, product).await?;
    if let Some(choice) = choice {
        add_settings(&mut response, &choice, call.pairs);
    }
    Ok(response)
}

async fn picture(
    app: &App,
    call: &Call<'_>,
    scene: Arc<Scene>,
    request: FrameRequest,
    product: Product,
) -> Result<Response, Problem> {
    if etag::is_conditional(call.headers) {
        let tag = app.renderer.etag(Arc::clone(&scene), request.clone(), product.clone()).await?;
        if etag::none_match_names(call.headers, &tag) {
            return Ok((StatusCode::NOT_MODIFIED, [NO_CACHE], [(ETAG, tag)]).into_response());
        }
    }
    Ok(reply(call.name, app.renderer.render(scene, request, product).await?))
}

/// Says which settings a budget was settled into, and by which query they give the same.
pub(super) fn add_settings(response: &mut Response, choice: &Choice, pairs: &Pairs) {
    let location = pairs.location(&choice.setting.parameters());
    for (name, value) in [(RENDER_SETTINGS, Some(settings(choice))), (CONTENT_LOCATION, location)] {
        if let Some(Ok(value)) = value.as_deref().map(HeaderValue::from_str) {
            response.headers_mut().insert(name, value);
        }
    }
}

/// The settings that a budget became, what is to be expected of them, what says so, and whether that misses the budget.
pub(super) fn settings(choice: &Choice) -> String {
    let parameters = choice.setting.parameters();
    let expected = [
        ("error", format!("{:.6}", choice.error)),
        ("ms", format!("{:.3}", choice.ms)),
        ("source", choice.source.word().to_owned()),
    ];
    let missed = (!choice.met).then(|| ("budget", "missed".to_owned()));
    let said = parameters.iter().chain(&expected).chain(&missed);
    listed(said.map(|(name, value)| format!("{name}={value}")))
}

fn reply(name: &str, rendered: Rendered) -> Response {
    let time = |pass| rendered.timing(pass).unwrap_or_default();
    let note = FrameNote {
        scene: name.to_owned(),
        width: rendered.width,
        height: rendered.height,
        queue_ms: time("queue"),
        render_ms: time("total") - time("queue") - time("encode"),
        encode_ms: time("encode"),
    };
    let timings = rendered.timings.iter().map(|(pass, ms)| format!("{pass};dur={ms:.3}"));
    let stats = rendered.stats.iter().map(|(name, count)| format!("{name}={count}"));
    let fixed = [(CONTENT_TYPE, HeaderValue::from_static(rendered.content_type)), NO_CACHE];
    let made = [
        (ETAG, rendered.etag.clone()),
        (SERVER_TIMING, listed(timings)),
        // A dictionary of integers (RFC 8941, section 3.2).
        (RENDER_STATS, listed(stats)),
    ];
    let range = rendered.depth_range.map(|[near, far]| [(RENDER_DEPTH_RANGE, listed([near, far]))]);
    let mut response = (fixed, made, rendered.bytes).into_response();
    if let Some([(name, value)]) = range
        && let Ok(value) = HeaderValue::from_str(&value)
    {
        response.headers_mut().insert(name, value);
    }
    response.extensions_mut().insert(note);
    response
}

fn listed(items: impl IntoIterator<Item = impl Display>) -> String {
    items.into_iter().map(|item| item.to_string()).collect::<Vec<_>>().join(", ")
}
