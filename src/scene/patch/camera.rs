//! What a patch of the camera takes away beside what it names.
//!
//! A stored document has its defaults filled in. By the letter of RFC 7396 those would stay behind
//! as if a client had chosen them.

use crate::scene::document::DEFAULT_NEAR;
use serde_json::{Map, Value};

/// Settles the camera of `merged`, which `patch` has made of `before`.
///
/// - A position that is taken away takes along the `target` and `near` that were filled in for it,
///   or automatic framing would not come back.
/// - Of `fov_y_deg` and `orthographic`, the one that the patch gives takes the place of the other.
pub(super) fn settle(merged: &mut Value, before: &Value, patch: &Value) {
    let Some(patch) = patch.get("camera").and_then(Value::as_object) else {
        return;
    };
    let Some(camera) = merged.get_mut("camera").and_then(Value::as_object_mut) else {
        return;
    };
    let had_position = before.pointer("/camera/position").is_some();
    if had_position && patch.get("position").is_some_and(Value::is_null) {
        for (field, is_default) in [("target", is_origin as fn(&Value) -> bool), ("near", is_default_near)] {
            if !patch.contains_key(field) && camera.get(field).is_some_and(is_default) {
                camera.shift_remove(field);
            }
        }
    }
    match (gives(patch, "fov_y_deg"), gives(patch, "orthographic")) {
        (true, false) => drop(camera.shift_remove("orthographic")),
        (false, true) => drop(camera.shift_remove("fov_y_deg")),
        _ => {}
    }
}

fn gives(patch: &Map<String, Value>, field: &str) -> bool {
    patch.get(field).is_some_and(|value| !value.is_null())
}

fn is_origin(value: &Value) -> bool {
    value.as_array().is_some_and(|numbers| numbers.iter().all(|n| n.as_f64() == Some(0.0)))
}

fn is_default_near(value: &Value) -> bool {
    value.as_f64() == Some(DEFAULT_NEAR)
}

#[cfg(test)]
mod tests {
    use crate::scene::patch::apply;
    use crate::scene::{Document, document};
    use serde_json::{Value, json};

    /// The camera of a stored document after a patch of it.
    fn patched(camera: &Value, patch: &Value) -> Value {
        let before = Document::from_json(&json!({ "camera": camera })).unwrap().to_json();
        let merged = apply(&before, &json!({ "camera": patch })).unwrap().json;
        Document::from_json(&merged).unwrap().to_json()["camera"].clone()
    }

    #[test]
    fn a_position_takes_its_defaults_with_it() {
        let automatic = document::Document::default().to_json()["camera"].clone();
        let placed = patched(&automatic, &json!({"position": [1, 2, 3]}));
        assert_eq!((&placed["target"], &placed["near"]), (&json!([0, 0, 0]), &json!(0.1)));
        assert_eq!(patched(&placed, &json!({"position": null})), automatic);
    }

    #[test]
    fn what_was_chosen_stays_without_the_position() {
        let chosen = json!({"position": [1, 2, 3], "target": [0, 1, 0], "near": 0.5});
        let left = patched(&chosen, &json!({"position": null}));
        assert_eq!((&left["target"], &left["near"]), (&json!([0, 1, 0]), &json!(0.5)));
        let given = patched(&json!({"position": [1, 2, 3]}), &json!({"position": null, "target": [0, 0, 0]}));
        assert_eq!((&given["target"], given.get("near")), (&json!([0, 0, 0]), None));
        // Without a position nothing was filled in.
        let alone = patched(&json!({"target": [0, 0, 0]}), &json!({"position": null}));
        assert_eq!(alone["target"], json!([0, 0, 0]));
    }

    #[test]
    fn the_patchs_own_lens_wins() {
        let flat = json!({"orthographic": {"height": 3}});
        let wide = patched(&flat, &json!({"fov_y_deg": 60}));
        assert_eq!((&wide["fov_y_deg"], wide.get("orthographic")), (&json!(60), None));
        let flat = patched(&wide, &flat);
        assert_eq!((flat.get("fov_y_deg"), &flat["orthographic"]["height"]), (None, &json!(3)));
        assert_eq!(patched(&flat, &json!({"orthographic": null}))["fov_y_deg"], json!(45));
    }
}
