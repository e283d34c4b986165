//! `Accept` (RFC 9110, section 12.5.1).

use super::problem::Problem;
use axum::http::header::ACCEPT;
use axum::http::{HeaderMap, StatusCode};

/// Refuses with 406 a client that says it takes no `essence` (`image/png`). Without `Accept` it takes
/// anything.
pub(super) fn check(headers: &HeaderMap, essence: &str) -> Result<(), Problem> {
    let ranges: Vec<&str> = ranges(headers).collect();
    if ranges.is_empty() || quality(&ranges, essence) > 0.0 {
        return Ok(());
    }
    let detail = format!("this path answers with {essence}, which Accept leaves out");
    Err(Problem::new(StatusCode::NOT_ACCEPTABLE, detail))
}

/// Whether a range of `kind` (`image`) is named, as browsers do that load a picture.
pub(super) fn names(headers: &HeaderMap, kind: &str) -> bool {
    ranges(headers).any(|range| range.split_once('/').is_some_and(|(of, _)| of.eq_ignore_ascii_case(kind)))
}

/// The ranges of a list header.
fn ranges(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let lines = headers.get_all(ACCEPT).into_iter().filter_map(|line| line.to_str().ok());
    lines.flat_map(|line| line.split(',')).map(str::trim).filter(|range| !range.is_empty())
}

/// The quality that the most specific matching range gives; 0 if none matches.
fn quality(ranges: &[&str], essence: &str) -> f64 {
    let matching = ranges.iter().filter_map(|range| {
        let mut parts = range.split(';').map(str::trim);
        let rank = rank(parts.next()?, essence)?;
        let q = parts.find_map(|part| part.strip_prefix("q=").or(part.strip_prefix("Q=")));
        Some((rank, q.map_or(1.0, |q| q.parse().unwrap_or(1.0))))
    });
    matching.max_by_key(|(rank, _)| *rank).map_or(0.0, |(_, q)| q)
}

/// How specific a range is; `None` if it does not match.
fn rank(range: &str, essence: &str) -> Option<u8> {
    let (kind, _) = essence.split_once('/')?;
    match range.to_ascii_lowercase() {
        range if range == essence => Some(2),
        range if range.strip_suffix("/*") == Some(kind) => Some(1),
        range if range == "*/*" => Some(0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn takes_png(accept: &'static str) -> bool {
        check(&HeaderMap::from_iter([(ACCEPT, HeaderValue::from_static(accept))]), "image/png").is_ok()
    }

    #[test]
    fn wildcards_lists_and_nothing_at_all_take_a_png() {
        for accept in
            ["", "*/*", "image/*", "image/png", "text/html, image/*;q=0.8", "IMAGE/PNG", "*/*;q=0.1"]
        {
            assert!(takes_png(accept), "{accept}");
        }
        assert!(check(&HeaderMap::new(), "image/png").is_ok());
    }

    #[test]
    fn a_kind_is_named_by_any_of_its_ranges() {
        let names_images = |accept: &'static str| {
            names(&HeaderMap::from_iter([(ACCEPT, HeaderValue::from_static(accept))]), "image")
        };
        assert!(names_images("text/html, image/avif;q=0.9, */*") && names_images("image/*"));
        assert!(!names_images("*/*") && !names_images("text/html") && !names_images(""));
    }

    #[test]
    fn other_types_and_quality_zero_do_not() {
        for accept in ["application/json", "image/webp", "image/png;q=0, */*", "text/*"] {
            assert!(!takes_png(accept), "{accept}");
        }
    }
}
