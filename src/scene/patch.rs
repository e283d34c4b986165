//! JSON merge patches (RFC 7396).

mod camera;

use super::document::token;
use crate::limits::MAX_PATCH_DEPTH;
use serde_json::{Map, Value};

/// A patch that is nested deeper than any document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the patch is nested deeper than {MAX_PATCH_DEPTH} levels")]
pub struct TooDeep;

/// A document after a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// The document.
    pub json: Value,
    /// Pointers of members that stayed from before where the patch changed an object's `type`.
    ///
    /// By the letter of RFC 7396 they remain, so that turning a gradient into a colour would leave
    /// `top` and `bottom` behind as unknown fields. The check drops those that the new type does
    /// not know; see [`super::Document::from_patched`].
    pub carried: Vec<String>,
}

/// Applies a client's patch to a stored document: [`merge`], and what follows from its defaults being
/// filled in.
///
/// # Errors
/// As [`merge`].
pub fn apply(document: &Value, patch: &Value) -> Result<Merged, TooDeep> {
    let mut merged = merge(document, patch)?;
    camera::settle(&mut merged.json, document, patch);
    Ok(merged)
}

/// Applies `patch` to `document`.
///
/// Objects are merged, `null` removes, everything else replaces; missing objects on the way are
/// created. Source: RFC 7396, section 2.
///
/// # Errors
/// [`TooDeep`] before anything is done.
pub fn merge(document: &Value, patch: &Value) -> Result<Merged, TooDeep> {
    if !fits_depth(patch, MAX_PATCH_DEPTH) {
        return Err(TooDeep);
    }
    let mut merged = Merged { json: document.clone(), carried: Vec::new() };
    merge_into(&mut merged.json, patch, "", &mut merged.carried);
    Ok(merged)
}

fn fits_depth(value: &Value, levels: usize) -> bool {
    match value {
        Value::Object(map) => levels > 0 && map.values().all(|inner| fits_depth(inner, levels - 1)),
        Value::Array(items) => levels > 0 && items.iter().all(|inner| fits_depth(inner, levels - 1)),
        _ => true,
    }
}

fn merge_into(target: &mut Value, patch: &Value, pointer: &str, carried: &mut Vec<String>) {
    let Value::Object(patch) = patch else {
        *target = patch.clone();
        return;
    };
    if !target.is_object() {
        *target = Value::Object(Map::new());
    }
    let Value::Object(target) = target else {
        return;
    };
    if changes_type(target, patch) {
        let stay = target.keys().filter(|key| !patch.contains_key(*key));
        carried.extend(stay.map(|key| format!("{pointer}/{}", token(key))));
    }
    for (key, value) in patch {
        if value.is_null() {
            target.shift_remove(key);
        } else {
            let inner = target.entry(key.clone()).or_insert(Value::Null);
            merge_into(inner, value, &format!("{pointer}/{}", token(key)), carried);
        }
    }
}

fn changes_type(target: &Map<String, Value>, patch: &Map<String, Value>) -> bool {
    match (target.get("type"), patch.get("type")) {
        (Some(before), Some(after)) => before != after,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn merged(document: &Value, patch: &Value) -> Value {
        merge(document, patch).unwrap().json
    }

    #[test]
    fn the_examples_of_rfc_7396_hold() {
        // RFC 7396, appendix A.
        let cases = [
            (json!({"a": "b"}), json!({"a": "c"}), json!({"a": "c"})),
            (json!({"a": "b"}), json!({"b": "c"}), json!({"a": "b", "b": "c"})),
            (json!({"a": "b"}), json!({"a": null}), json!({})),
            (json!({"a": "b", "b": "c"}), json!({"a": null}), json!({"b": "c"})),
            (json!({"a": ["b"]}), json!({"a": "c"}), json!({"a": "c"})),
            (json!({"a": "c"}), json!({"a": ["b"]}), json!({"a": ["b"]})),
            (json!({"a": {"b": "c"}}), json!({"a": {"b": "d", "c": null}}), json!({"a": {"b": "d"}})),
            (json!({"a": [{"b": "c"}]}), json!({"a": [1]}), json!({"a": [1]})),
            (json!(["a", "b"]), json!(["c", "d"]), json!(["c", "d"])),
            (json!({"a": "b"}), json!(["c"]), json!(["c"])),
            (json!({"a": "foo"}), json!(null), json!(null)),
            (json!({"a": "foo"}), json!("bar"), json!("bar")),
            (json!({"e": null}), json!({"a": 1}), json!({"e": null, "a": 1})),
            (json!([1, 2]), json!({"a": "b", "c": null}), json!({"a": "b"})),
            (json!({}), json!({"a": {"bb": {"ccc": null}}}), json!({"a": {"bb": {}}})),
        ];
        for (document, patch, expected) in cases {
            assert_eq!(merged(&document, &patch), expected, "{document} with {patch}");
        }
    }

    #[test]
    fn members_of_the_type_before_are_named() {
        let document = json!({"lights": {"a/b": {"type": "point", "position": [0, 0, 0], "color": "#fff"}}});
        let patch = json!({"lights": {"a/b": {"type": "directional", "direction": [0, -1, 0]}}});
        let carried = merge(&document, &patch).unwrap().carried;
        assert_eq!(carried, ["/lights/a~1b/position", "/lights/a~1b/color"]);
    }

    #[test]
    fn nesting_without_end_is_refused() {
        let deep = (0..100).fold(json!(1), |inner, _| json!({ "a": inner }));
        assert_eq!(merge(&json!({}), &deep), Err(TooDeep));
    }
}
