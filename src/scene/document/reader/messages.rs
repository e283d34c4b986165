//! What messages are made of. Everything a client wrote is cut to a bounded length.

use crate::limits::MAX_SUGGESTION_CANDIDATES;
use serde_json::Value;

/// `key` as a JSON pointer token (RFC 6901, section 3).
pub(crate) fn token(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}

/// `; did you mean "fov_y_deg"?`, or nothing when no candidate is near.
pub(crate) fn suggestion<'w>(word: &str, candidates: impl IntoIterator<Item = &'w str>) -> String {
    let word = clipped(word).to_lowercase();
    let score = |candidate: &str| {
        let likeness = strsim::jaro_winkler(&word, candidate);
        if candidate.starts_with(&word) || word.starts_with(candidate) {
            likeness + 0.2
        } else if word.len() > 2 && candidate.contains(&word) {
            likeness.max(0.75)
        } else {
            likeness
        }
    };
    candidates
        .into_iter()
        .take(MAX_SUGGESTION_CANDIDATES)
        .map(clipped)
        .map(|candidate| (score(&candidate), candidate))
        .filter(|(score, _)| *score >= 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, nearest)| format!("; did you mean {nearest:?}?"))
        .unwrap_or_default()
}

/// The start of a text that a client may have made arbitrarily long.
pub(in crate::scene) fn clipped(text: &str) -> String {
    match text.char_indices().nth(64) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}

/// A value as messages show it.
pub(super) fn shown(value: &Value) -> String {
    match value {
        Value::Array(items) if items.len() > 8 => format!("an array of {}", items.len()),
        Value::Object(_) => "an object".to_owned(),
        Value::Array(items) if items.iter().any(|item| item.is_array() || item.is_object()) => {
            "a nested array".to_owned()
        }
        other => clipped(&other.to_string()),
    }
}

/// A number as people write it: `200`, `0.001`, `2.126e37`.
pub(super) fn plain(n: f64) -> String {
    if n != 0.0 && !(1e-6..1e16).contains(&n.abs()) { format!("{n:e}") } else { format!("{n}") }
}
