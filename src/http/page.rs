//! `/`: the page and its files, embedded in the program. A debug build reads them from `static/` at each
//! request, so that who works on the page has only to reload it.

use super::{App, etag};
use axum::Router;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, ETAG, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use rust_embed::{Embed, EmbeddedFile};
use std::borrow::Cow;

/// The files of `static/`, by their paths in it.
#[derive(Embed)]
#[folder = "static/"]
struct Files;

const INDEX: &str = "index.html";

/// Nothing is loaded from another host, nothing but our own files runs, and no other site frames the
/// page.
const POLICY: &str = "default-src 'self'; img-src 'self' blob: data:; \
                      style-src 'self' 'unsafe-inline'; frame-ancestors 'self'";

/// The page
#[utoipa::path(get, path = "/", tag = "service", responses(
    (status = 200, description = "The page", body = String, content_type = "text/html", headers(("ETag" = String))),
    (status = 304, description = "If-None-Match names it"),
))]
pub(super) async fn index(headers: HeaderMap) -> Response {
    reply(INDEX, &headers)
}

/// The routes of what the page refers to.
pub(super) fn parts() -> Router<App> {
    Files::iter().filter(|path| path != INDEX).fold(Router::new(), |router, path| {
        let route = format!("/{path}");
        let serve = move |headers: HeaderMap| std::future::ready(reply(&path, &headers));
        router.route(&route, get(serve))
    })
}

fn reply(path: &str, headers: &HeaderMap) -> Response {
    let Some(EmbeddedFile { data, metadata }) = Files::get(path) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let tag = tag(metadata.sha256_hash());
    let validators = [(ETAG, tag.as_str()), (CACHE_CONTROL, "no-cache")];
    if etag::none_match_names(headers, &tag) {
        return (StatusCode::NOT_MODIFIED, validators).into_response();
    }
    let content = [
        (CONTENT_TYPE, content_type(path)),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (validators, content, body(data)).into_response()
}

fn tag(hash: [u8; 32]) -> String {
    let digits: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("\"{digits}\"")
}

fn body(data: Cow<'static, [u8]>) -> axum::body::Body {
    match data {
        Cow::Borrowed(bytes) => bytes.into(),
        Cow::Owned(bytes) => bytes.into(),
    }
}

fn content_type(path: &str) -> &'static str {
    match path.rsplit_once('.') {
        Some((_, "html")) => "text/html; charset=utf-8",
        Some((_, "css")) => "text/css; charset=utf-8",
        Some((_, "js")) => "text/javascript; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_has_a_type() {
        for path in Files::iter() {
            assert_ne!(content_type(&path), "application/octet-stream", "{path}");
        }
    }
}
