//! `/`: the page and its files, embedded in the program.

use super::{App, etag};
use axum::Router;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, ETAG, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

/// A file of `static/`.
#[derive(Debug)]
struct Asset {
    path: &'static str,
    content_type: &'static str,
    bytes: &'static [u8],
}

static INDEX: Asset = Asset {
    path: "/",
    content_type: "text/html; charset=utf-8",
    bytes: include_bytes!("../../static/index.html"),
};

/// What the page refers to.
static PARTS: [Asset; 2] = [
    Asset {
        path: "/page.css",
        content_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../static/page.css"),
    },
    Asset {
        path: "/page.js",
        content_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../static/page.js"),
    },
];

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
    reply(&INDEX, &tag(INDEX.bytes), &headers)
}

/// The routes of the page's parts.
pub(super) fn parts() -> Router<App> {
    PARTS.iter().fold(Router::new(), |router, asset| {
        let tag = tag(asset.bytes);
        let serve = move |headers: HeaderMap| std::future::ready(reply(asset, &tag, &headers));
        router.route(asset.path, get(serve))
    })
}

fn reply(asset: &Asset, tag: &str, headers: &HeaderMap) -> Response {
    let validators = [(ETAG, tag), (CACHE_CONTROL, "no-cache")];
    if etag::none_match_names(headers, tag) {
        return (StatusCode::NOT_MODIFIED, validators).into_response();
    }
    let content = [
        (CONTENT_TYPE, asset.content_type),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (validators, content, asset.bytes).into_response()
}

fn tag(bytes: &[u8]) -> String {
    format!("\"{}\"", blake3::hash(bytes).to_hex())
}
