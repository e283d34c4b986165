//! `/gallery`: scenes that `POST /scenes?from=NAME` makes.

use super::problem::Problem;
use super::query::NoQuery;
use super::{etag, openapi};
use crate::scene::gallery::{Piece, pieces};
use axum::Json;
use axum::extract::Path;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

/// List the gallery
///
/// In the order to show it in; `from` takes the names.
#[utoipa::path(get, path = "/gallery", tag = "gallery", responses((status = 200, description = "What there is to open", body = Vec<openapi::GalleryPiece>)))]
pub(super) async fn list(_: NoQuery) -> Json<Vec<Value>> {
    Json(pieces().iter().map(entry).collect())
}

fn entry(piece: &Piece) -> Value {
    json!({
        "name": piece.name,
        "title": piece.title,
        "description": piece.description,
        "picture": format!("/gallery/{}/picture", piece.name),
    })
}

/// A small picture of what the gallery has
#[utoipa::path(
    get, path = "/gallery/{name}/picture", tag = "gallery",
    params(("name" = String, Path, description = "The piece")),
    responses(
        (status = 200, description = "480 × 360", body = Vec<u8>, content_type = "image/jpeg", headers(("ETag" = String))),
        (status = 304, description = "If-None-Match names it"),
    ),
)]
pub(super) async fn picture(
    Path(name): Path<String>,
    _: NoQuery,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let no_such = || Problem::new(StatusCode::NOT_FOUND, format!("the gallery has no {name:?}"));
    let piece = pieces().iter().find(|piece| piece.name == name).ok_or_else(no_such)?;
    let picture = piece.picture();
    let tag = format!("\"{}\"", blake3::hash(&picture).to_hex());
    let validators = [(ETAG, tag.as_str()), (CACHE_CONTROL, "no-cache")];
    if etag::none_match_names(&headers, &tag) {
        return Ok((StatusCode::NOT_MODIFIED, validators).into_response());
    }
    Ok((validators, [(CONTENT_TYPE, "image/jpeg")], picture).into_response())
}
