//! `/scenes/{id}/report.json`, `.svg`, `.html`: error against run time of a scene.

use super::problem::Problem;
use super::query::Pairs;
use super::{App, accept, frames, openapi};
use crate::plan::FrameRequest;
use crate::plan::request::Query;
use crate::report::{Knob, Options, Report, html, plot};
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};

/// A kind of file that a report comes as.
pub(super) struct Format {
    pub(super) extension: &'static str,
    pub(super) content_type: &'static str,
    write: fn(&Report) -> String,
}

pub(super) const FORMATS: [Format; 3] = [
    Format { extension: "json", content_type: "application/json", write: Report::json },
    Format { extension: "svg", content_type: "image/svg+xml", write: plot::svg },
    Format { extension: "html", content_type: "text/html; charset=utf-8", write: html::page },
];

/// Measure error against run time
///
/// The frame that the query asks for is drawn at many settings, in a size of its own (320 pixels wide unless `width`
/// says otherwise), each compared with a reference in 64-bit floats and timed against the others. One report is made
/// at a time; who asks for the same joins it, a few others wait. How far it is, `events` tells. What it measures decides
/// from then on what `preset`, `max_ms` and `max_error` choose for this scene with the same `shading`, `background`,
/// `output` and `elide`, from any camera and at any size.
#[utoipa::path(
    get, path = "/scenes/{id}/report.{format}", tag = "reports",
    params(("id" = String, Path, description = "The scene"), openapi::ReportQuery, openapi::FrameQuery),
    responses((status = 200, description = "The report: as JSON, as a figure, or as a page with the figure and its numbers", body = Vec<u8>)),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path((id, extension)): Path<(String, String)>,
    pairs: Pairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let format = FORMATS.iter().find(|format| format.extension == extension);
    let format = format.ok_or_else(|| frames::no_format("reports", &extension, ".json, .svg and .html"))?;
    accept::check(&headers, format.content_type)?;
    let (options, request) = pairs.read(|query| {
        let request = FrameRequest::read(query);
        (read_options(query, &id, &request), request)
    })?;
    let scene = app.entry(&id)?.scene;
    let (request, _) = app.renderer.to_budget(&scene, request).await?;
    let report = app.reports.make(scene, request, options).await?;
    let headers = [(CONTENT_TYPE, format.content_type), (CACHE_CONTROL, "no-store")];
    Ok((headers, (format.write)(&report)).into_response())
}

/// `budget_s`, `knobs` and `selftest`, out of a query that may hold other parameters too.
fn read_options(query: &mut Query, id: &str, request: &FrameRequest) -> Options {
    let default = Options::default();
    Options {
        name: id.to_owned(),
        budget: query.parsed("budget_s", Options::budget).unwrap_or(default.budget),
        knobs: query.parsed("knobs", Knob::list).unwrap_or_default(),
        width: request.width.unwrap_or(default.width),
        selftest: query.flag("selftest").unwrap_or(false),
        ..default
    }
}
