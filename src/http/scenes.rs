//! `/scenes` and `/scenes/{id}`.

use super::problem::Problem;
use super::query::{NoQuery, Pairs, source};
use super::{App, blocking, body, etag, openapi};
use crate::scene::store::{Entry, is_id};
use axum::Json;
use axum::extract::{Path, Request, State};
use axum::http::header::{ETAG, LOCATION};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde_json::Value;
use std::sync::Arc;

/// List all scenes
///
/// Answers the summaries, in order of id.
#[utoipa::path(get, path = "/scenes", tag = "scenes", responses((status = 200, description = "Summaries", body = Vec<openapi::Summary>)))]
pub(super) async fn list(State(app): State<App>, _: NoQuery) -> Json<Vec<Value>> {
    Json(app.store.list().iter().map(Entry::summary).collect())
}

/// Create a scene
///
/// From a scene document, a form of one with its files, or a model; or, with `from` and no body, from the
/// gallery.
#[utoipa::path(
    post, path = "/scenes", tag = "scenes",
    params(openapi::SourceQuery),
    request_body(content((Value = "application/json"), (String = "multipart/form-data"), (String = "model/obj"), (String = "text/plain"), (String = "application/octet-stream"), (String = "application/x-www-form-urlencoded"))),
    responses((status = 201, description = "Created; its summary", body = openapi::Summary, headers(("Location" = String), ("ETag" = String)))),
)]
pub(super) async fn create(
    State(app): State<App>,
    pairs: Pairs,
    request: Request,
) -> Result<Response, Problem> {
    let source = pairs.read(source)?;
    let new = body::scene(request, app.body_bounds(), source).await?;
    let store = Arc::clone(&app.store);
    let entry = blocking::compile(&app.renderer, move || store.create(new)).await?;
    Ok(changed(&entry, true))
}

/// Read a scene's document
///
/// With its defaults filled in; posting it back gives the same pictures.
#[utoipa::path(
    get, path = "/scenes/{id}", tag = "scenes",
    params(("id" = String, Path, description = "The scene")),
    responses((status = 200, description = "The document", body = Value, headers(("ETag" = String))), (status = 304, description = "If-None-Match names it")),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path(id): Path<String>,
    _: NoQuery,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let entry = app.entry(&id)?;
    if etag::none_match_names(&headers, &entry.etag) {
        return Ok((StatusCode::NOT_MODIFIED, [(ETAG, entry.etag)]).into_response());
    }
    Ok(([(ETAG, entry.etag)], Json(&*entry.document)).into_response())
}

/// Create a scene under a name, or replace it
#[utoipa::path(
    put, path = "/scenes/{id}", tag = "scenes",
    params(("id" = String, Path, description = "The scene: `[A-Za-z0-9_-]{1,64}`"), openapi::SourceQuery, openapi::IfMatch),
    request_body(content((Value = "application/json"), (String = "multipart/form-data"), (String = "model/obj"), (String = "text/plain"), (String = "application/octet-stream"), (String = "application/x-www-form-urlencoded"))),
    responses(
        (status = 200, description = "Replaced; its summary", body = openapi::Summary, headers(("ETag" = String))),
        (status = 201, description = "Created; its summary", body = openapi::Summary, headers(("Location" = String), ("ETag" = String))),
    ),
)]
pub(super) async fn replace(
    State(app): State<App>,
    Path(id): Path<String>,
    pairs: Pairs,
    request: Request,
) -> Result<Response, Problem> {
    check_id(&id)?;
    let source = pairs.read(source)?;
    let condition = etag::precondition(request.headers());
    let new = body::scene(request, app.body_bounds(), source).await?;
    let store = Arc::clone(&app.store);
    let (entry, created) = blocking::compile(&app.renderer, move || store.put(&id, new, &condition)).await?;
    Ok(changed(&entry, created))
}

/// Change parts of a scene
///
/// A JSON merge patch (RFC 7396): all of it or nothing.
#[utoipa::path(
    patch, path = "/scenes/{id}", tag = "scenes",
    params(("id" = String, Path, description = "The scene"), openapi::IfMatch),
    request_body(content((Value = "application/merge-patch+json"), (Value = "application/json"))),
    responses((status = 200, description = "Changed; its summary", body = openapi::Summary, headers(("ETag" = String)))),
)]
pub(super) async fn patch(
    State(app): State<App>,
    Path(id): Path<String>,
    _: NoQuery,
    request: Request,
) -> Result<Response, Problem> {
    app.entry(&id)?;
    let condition = etag::precondition(request.headers());
    let patch = body::patch(request, app.body_bounds()).await?;
    let store = Arc::clone(&app.store);
    let entry = blocking::compile(&app.renderer, move || store.patch(&id, &patch, &condition)).await?;
    Ok(changed(&entry, false))
}

/// Delete a scene
#[utoipa::path(
    delete, path = "/scenes/{id}", tag = "scenes",
    params(("id" = String, Path, description = "The scene"), openapi::IfMatch),
    responses((status = 204, description = "It is gone")),
)]
pub(super) async fn remove(
    State(app): State<App>,
    Path(id): Path<String>,
    _: NoQuery,
    headers: HeaderMap,
) -> Result<StatusCode, Problem> {
    app.entry(&id)?;
    app.store.delete(&id, &etag::precondition(&headers))?;
    Ok(StatusCode::NO_CONTENT)
}

/// The reply to a change: the summary, and where the scene is if it is new.
pub(super) fn changed(entry: &Entry, created: bool) -> Response {
    let summary = ([(ETAG, entry.etag.clone())], Json(entry.summary()));
    if created {
        let location = format!("/scenes/{}", entry.id);
        (StatusCode::CREATED, [(LOCATION, location)], summary).into_response()
    } else {
        summary.into_response()
    }
}

/// Before the body is read: the store would say so only then.
fn check_id(id: &str) -> Result<(), Problem> {
    if is_id(id) {
        return Ok(());
    }
    Err(Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "a scene's id must match [A-Za-z0-9_-]{1,64}"))
}
