//! Conditional requests (RFC 9110, section 13).

use crate::scene::store::Precondition;
use axum::http::HeaderMap;
use axum::http::header::{AsHeaderName, IF_MATCH, IF_NONE_MATCH};

/// Whether `If-None-Match` names `etag`, so that 304 is the answer. The comparison is weak.
pub(super) fn none_match_names(headers: &HeaderMap, etag: &str) -> bool {
    tags(headers, IF_NONE_MATCH).any(|tag| tag == "*" || strip_weak(tag) == strip_weak(etag))
}

/// Whether the client sent `If-None-Match` at all.
pub(super) fn is_conditional(headers: &HeaderMap) -> bool {
    headers.contains_key(IF_NONE_MATCH)
}

/// `If-Match`, else `If-None-Match`, of a change to a scene, as the store takes it.
pub(super) fn precondition(headers: &HeaderMap) -> Precondition {
    match if_match(headers) {
        Precondition::None => if_none_match(headers),
        given => given,
    }
}

/// The comparison of `If-Match` is strong, so weak tags are left out: they match nothing.
pub(super) fn if_match(headers: &HeaderMap) -> Precondition {
    if !headers.contains_key(IF_MATCH) {
        return Precondition::None;
    }
    if tags(headers, IF_MATCH).any(|tag| tag == "*") {
        return Precondition::Any;
    }
    let strong = tags(headers, IF_MATCH).filter(|tag| !tag.starts_with("W/"));
    Precondition::OneOf(strong.map(str::to_owned).collect())
}

fn if_none_match(headers: &HeaderMap) -> Precondition {
    if !is_conditional(headers) {
        return Precondition::None;
    }
    if tags(headers, IF_NONE_MATCH).any(|tag| tag == "*") {
        return Precondition::Absent;
    }
    Precondition::NoneOf(tags(headers, IF_NONE_MATCH).map(|tag| strip_weak(tag).to_owned()).collect())
}

/// The entity tags of a list header. Ours hold no comma, so splitting there loses none of them.
fn tags(headers: &HeaderMap, name: impl AsHeaderName) -> impl Iterator<Item = &str> {
    let lines = headers.get_all(name).into_iter().filter_map(|line| line.to_str().ok());
    lines.flat_map(|line| line.split(',')).map(str::trim).filter(|tag| !tag.is_empty())
}

fn strip_weak(tag: &str) -> &str {
    tag.strip_prefix("W/").unwrap_or(tag)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn with(name: axum::http::HeaderName, value: &'static str) -> HeaderMap {
        HeaderMap::from_iter([(name, HeaderValue::from_static(value))])
    }

    #[test]
    fn if_none_match_takes_lists_stars_and_weak_tags() {
        for value in ["\"a\"", "\"x\", \"a\"", "W/\"a\"", "*", "\"x\",W/\"a\" "] {
            assert!(none_match_names(&with(IF_NONE_MATCH, value), "\"a\""), "{value}");
        }
        for value in ["\"b\"", "a", ""] {
            assert!(!none_match_names(&with(IF_NONE_MATCH, value), "\"a\""), "{value}");
        }
        assert!(!none_match_names(&HeaderMap::new(), "\"a\""));
    }

    #[test]
    fn if_match_is_strong() {
        let Precondition::OneOf(tags) = precondition(&with(IF_MATCH, "W/\"a\", \"b\"")) else {
            panic!("a list of tags");
        };
        assert_eq!(tags, ["\"b\""]);
        assert!(matches!(precondition(&with(IF_MATCH, "*")), Precondition::Any));
        assert!(matches!(precondition(&HeaderMap::new()), Precondition::None));
    }

    #[test]
    fn if_none_match_holds_for_changes_where_if_match_is_absent() {
        assert_eq!(precondition(&with(IF_NONE_MATCH, "*")), Precondition::Absent);
        let Precondition::NoneOf(tags) = precondition(&with(IF_NONE_MATCH, "W/\"a\"")) else {
            panic!("a list of tags");
        };
        assert_eq!(tags, ["\"a\""]);
        let mut both = with(IF_NONE_MATCH, "\"a\"");
        both.insert(IF_MATCH, HeaderValue::from_static("*"));
        assert_eq!(precondition(&both), Precondition::Any);
    }
}
