//! `/scenes/{id}/files`: what came with a scene.

use super::problem::Problem;
use super::query::NoQuery;
use super::{App, blocking, body, etag, openapi, scenes};
use crate::scene::{Files, files};
use axum::Json;
use axum::extract::{Path, Request, State};
use axum::http::header::{CONTENT_TYPE, ETAG, LOCATION, X_CONTENT_TYPE_OPTIONS};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use std::sync::Arc;

/// List a scene's files
///
/// In order of name.
#[utoipa::path(
    get, path = "/scenes/{id}/files", tag = "files",
    params(("id" = String, Path, description = "The scene")),
    responses((status = 200, description = "Names and sizes", body = Vec<openapi::FileEntry>)),
)]
pub(super) async fn list(
    State(app): State<App>,
    Path(id): Path<String>,
    _: NoQuery,
) -> Result<Json<Vec<Value>>, Problem> {
    let entry = app.entry(&id)?;
    Ok(Json(entry.files.iter().map(|(name, bytes)| json!({ "name": name, "bytes": bytes.len() })).collect()))
}

/// Fetch a file
#[utoipa::path(
    get, path = "/scenes/{id}/files/{name}", tag = "files",
    params(("id" = String, Path, description = "The scene"), ("name" = String, Path, description = "The file")),
    responses(
        (status = 200, description = "Its bytes", body = Vec<u8>, content_type = "*/*", headers(("ETag" = String))),
        (status = 304, description = "If-None-Match names it"),
    ),
)]
pub(super) async fn read(
    State(app): State<App>,
    Path((id, name)): Path<(String, String)>,
    _: NoQuery,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let entry = app.entry(&id)?;
    let bytes = exact(&entry.files, &name).ok_or_else(|| no_file(&name))?.clone();
    let tag = tag(entry.file_hash(&name).ok_or_else(|| no_file(&name))?);
    if etag::none_match_names(&headers, &tag) {
        return Ok((StatusCode::NOT_MODIFIED, [(ETAG, tag)]).into_response());
    }
    let headers = [
        (CONTENT_TYPE, HeaderValue::from_static(content_type(&name))),
        // An uploaded page must not run in the name of this server.
        (X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
    ];
    Ok((headers, [(ETAG, tag)], bytes).into_response())
}

/// Add or replace a file
///
/// What refers to it changes with it; if the scene can't be built any more, nothing changes.
#[utoipa::path(
    put, path = "/scenes/{id}/files/{name}", tag = "files",
    params(("id" = String, Path, description = "The scene"), ("name" = String, Path, description = "The file"), openapi::IfMatch),
    request_body(content = Vec<u8>, content_type = "application/octet-stream"),
    responses(
        (status = 200, description = "Replaced; the scene's summary", body = openapi::Summary, headers(("ETag" = String))),
        (status = 201, description = "Added; the scene's summary", body = openapi::Summary, headers(("Location" = String), ("ETag" = String))),
    ),
)]
pub(super) async fn replace(
    State(app): State<App>,
    Path((id, name)): Path<(String, String)>,
    _: NoQuery,
    request: Request,
) -> Result<Response, Problem> {
    check_name(&name)?;
    let entry = app.entry(&id)?;
    let known = entry.file_hash(&name).map(tag);
    refuse_known(request.headers(), known.as_deref())?;
    let condition = etag::if_match(request.headers());
    let location = request.uri().path().to_owned();
    let bytes = body::bytes(request, app.body_bounds()).await?;
    let store = Arc::clone(&app.store);
    let entry =
        blocking::compile(&app.renderer, move || store.put_file(&id, &name, bytes, &condition)).await?;
    let reply = scenes::changed(&entry, false);
    Ok(if known.is_none() {
        (StatusCode::CREATED, [(LOCATION, location)], reply).into_response()
    } else {
        reply
    })
}

/// Remove a file
///
/// Refused with 422 while the document can't do without it.
#[utoipa::path(
    delete, path = "/scenes/{id}/files/{name}", tag = "files",
    params(("id" = String, Path, description = "The scene"), ("name" = String, Path, description = "The file"), openapi::IfMatch),
    responses((status = 204, description = "It is gone")),
)]
pub(super) async fn remove(
    State(app): State<App>,
    Path((id, name)): Path<(String, String)>,
    _: NoQuery,
    headers: HeaderMap,
) -> Result<StatusCode, Problem> {
    exact(&app.entry(&id)?.files, &name).ok_or_else(|| no_file(&name))?;
    let condition = etag::if_match(&headers);
    let store = Arc::clone(&app.store);
    blocking::compile(&app.renderer, move || store.delete_file(&id, &name, &condition)).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// The file of exactly this name: an address is not looked up loosely.
fn exact<'a>(files: &'a Files, name: &str) -> Option<&'a bytes::Bytes> {
    files.iter().find(|(stored, _)| *stored == name).map(|(_, bytes)| bytes)
}

/// A file's ETag.
fn tag(hash: blake3::Hash) -> String {
    format!("\"{}\"", hash.to_hex())
}

/// `If-Match` is about the scene, which a file changes; `If-None-Match` about the file itself.
fn refuse_known(headers: &HeaderMap, tag: Option<&str>) -> Result<(), Problem> {
    if tag.is_some_and(|tag| etag::none_match_names(headers, tag)) {
        return Err(Problem::new(
            StatusCode::PRECONDITION_FAILED,
            "If-None-Match names the file that is there",
        ));
    }
    Ok(())
}

fn no_file(name: &str) -> Problem {
    Problem::new(StatusCode::NOT_FOUND, format!("the scene has no file {name:?}"))
}

/// A name that a document can refer to: one path component, printable.
fn check_name(name: &str) -> Result<(), Problem> {
    files::check_name(name).map_err(|detail| Problem::new(StatusCode::UNPROCESSABLE_ENTITY, detail))
}

/// By the name's ending; nothing that a browser would run.
fn content_type(name: &str) -> &'static str {
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    match ending.as_deref() {
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("webp") => "image/webp",
        Some("gif") => "image/gif",
        Some("bmp") => "image/bmp",
        Some("obj") => "model/obj",
        Some("mtl") => "model/mtl",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_served_as_bytes() {
        assert_eq!(content_type("evil.html"), "application/octet-stream");
        assert_eq!(content_type("evil.svg"), "application/octet-stream");
        assert_eq!(content_type("Crate.PNG"), "image/png");
    }

    #[test]
    fn names_are_one_component() {
        assert!(check_name("a b.obj").is_ok());
        for name in ["", "a/b", "a\\b", "a\nb"] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
    }
}
