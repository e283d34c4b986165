//! What is refused before any handler sees it: calls that another site makes through a visitor's
//! browser, and heads that are too large.

use super::App;
use super::problem::Problem;
use axum::extract::{Request, State};
use axum::http::header::{HOST, ORIGIN};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::IpAddr;

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// Bytes of target and headers together: what common servers take.
const HEAD_BYTES_MAX: usize = 32 << 10;

/// Lets a request through, or answers 403 or 431.
pub(super) async fn check(State(app): State<App>, request: Request, next: Next) -> Response {
    let refusal = head_size(&request).and_then(|()| host(&app, &request)).and_then(|()| same_site(&request));
    match refusal {
        Ok(()) => next.run(request).await,
        Err(problem) => problem.into_response(),
    }
}

fn head_size(request: &Request) -> Result<(), Problem> {
    let headers = request.headers().iter().map(|(name, value)| name.as_str().len() + value.len() + 4);
    let target = request.uri().path().len() + request.uri().query().map_or(0, str::len);
    if headers.sum::<usize>() + target <= HEAD_BYTES_MAX {
        return Ok(());
    }
    let detail = format!("target and headers must be at most {HEAD_BYTES_MAX} bytes");
    Err(Problem::new(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, detail))
}

/// On loopback, a name that is not ours means DNS rebinding: a page whose own name was made to point
/// here. HTTP/1.0 sends no name.
fn host(app: &App, request: &Request) -> Result<(), Problem> {
    if !app.settings.listen.ip().is_loopback() {
        return Ok(());
    }
    match named_host(request) {
        None => Ok(()),
        Some(Ok(name)) if is_loopback(&name) || app.settings.allow_hosts.contains(&name) => Ok(()),
        Some(_) => Err(forbidden("the Host is not this server's; RASTERD_ALLOW_HOSTS takes further names")),
    }
}

/// The host of the target if it has one, else of `Host`, without its port; `Err` if it is none.
fn named_host(request: &Request) -> Option<Result<String, ()>> {
    let of = |authority: &Authority| authority.host().to_ascii_lowercase();
    if let Some(authority) = request.uri().authority() {
        return Some(Ok(of(authority)));
    }
    let header = request.headers().get(HOST)?;
    Some(header.to_str().ok().and_then(|text| text.parse().ok()).map(|authority| of(&authority)).ok_or(()))
}

fn is_loopback(name: &str) -> bool {
    let bare = name.trim_start_matches('[').trim_end_matches(']');
    name == "localhost" || bare.parse().is_ok_and(|ip: IpAddr| ip.is_loopback())
}

/// Browsers say where a call comes from: `Sec-Fetch-Site`, and older ones `Origin`. What says neither
/// is no browser.
fn same_site(request: &Request) -> Result<(), Problem> {
    if matches!(*request.method(), Method::GET | Method::HEAD | Method::OPTIONS) {
        return Ok(());
    }
    let headers = request.headers();
    let ours = match (text(headers, SEC_FETCH_SITE), text(headers, ORIGIN)) {
        (Some(site), _) => site == "same-origin" || site == "none",
        (None, Some(origin)) => is_origin_of(origin, text(headers, HOST)),
        (None, None) => true,
    };
    if ours {
        Ok(())
    } else {
        Err(forbidden("a call that changes something must not come from another site"))
    }
}

/// Whether `origin` (`scheme://host:port`) names `host`; `null` names nothing.
fn is_origin_of(origin: &str, host: Option<&str>) -> bool {
    let authority = origin.split_once("://").map(|(_, authority)| authority);
    authority.is_some() && authority.map(str::to_ascii_lowercase) == host.map(str::to_ascii_lowercase)
}

/// A header's text; one that is no text counts as an empty one, which nothing matches.
fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name).map(|value| value.to_str().unwrap_or_default())
}

fn forbidden(detail: &str) -> Problem {
    Problem::new(StatusCode::FORBIDDEN, detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loopback_names_are_known() {
        for name in ["localhost", "127.0.0.1", "127.9.9.9", "[::1]"] {
            assert!(is_loopback(name), "{name}");
        }
        for name in ["localhost.evil.example", "example.com", "192.168.0.1", "", "[::2]"] {
            assert!(!is_loopback(name), "{name}");
        }
    }

    #[test]
    fn an_origin_is_ours_only_with_the_same_host_and_port() {
        assert!(is_origin_of("http://localhost:8080", Some("localhost:8080")));
        assert!(!is_origin_of("http://localhost:9090", Some("localhost:8080")));
        assert!(!is_origin_of("null", Some("localhost:8080")));
        assert!(!is_origin_of("null", None));
    }
}
