//! Damaged and random documents.

use crate::limits::Limits;
use crate::scene::document::tests::full;
use crate::scene::{Document, Files, NewScene, Precondition, Store, compile, patch};
use proptest::prelude::*;
use serde_json::{Map, Value, json};

/// Any JSON, with words and numbers that documents use among it.
fn any_json() -> impl Strategy<Value = Value> {
    let numbers = prop_oneof![
        Just(json!(0)),
        Just(json!(-1)),
        Just(json!(1e37)),
        Just(json!(1e308)),
        Just(json!(u64::MAX)),
        Just(json!(-0.0)),
        Just(json!(1e-320)),
        (-10.0..10.0_f64).prop_map(|n| json!(n)),
    ];
    let words = prop_oneof![
        Just("box"),
        Just("type"),
        Just("sphere"),
        Just("#fff"),
        Just("a/b~c"),
        Just(""),
        Just("point"),
        Just("\u{0}"),
    ];
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::Bool),
        numbers,
        words.prop_map(|word| json!(word)),
        ".{0,200}".prop_map(Value::String),
    ];
    leaf.prop_recursive(4, 24, 5, |inner| {
        let key = prop_oneof!["[a-z_/~]{0,8}", Just("type".to_owned()), Just("position".to_owned())];
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Value::Array),
            prop::collection::vec((key, inner), 0..5)
                .prop_map(|fields| Value::Object(Map::from_iter(fields))),
        ]
    })
}

/// Pointers of all nodes.
fn pointers(json: &Value, at: &str, out: &mut Vec<String>) {
    out.push(at.to_owned());
    match json {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| pointers(item, &format!("{at}/{i}"), out))
        }
        Value::Object(map) => map.iter().for_each(|(key, item)| pointers(item, &format!("{at}/{key}"), out)),
        _ => {}
    }
}

/// The full document with some nodes replaced.
fn damaged() -> impl Strategy<Value = Value> {
    let replacement = (any::<prop::sample::Index>(), any_json());
    prop::collection::vec(replacement, 0..4).prop_map(|replacements| {
        let mut json = full();
        for (index, value) in replacements {
            let mut places = Vec::new();
            pointers(&json, "", &mut places);
            if let Some(place) = json.pointer_mut(&places[index.index(places.len())]) {
                *place = value;
            }
        }
        json
    })
}

/// A valid document whose numbers are random.
fn valid() -> impl Strategy<Value = Value> {
    let vector = || prop::array::uniform3(-1e6..1e6_f64).prop_filter("not zero", |v| *v != [0.0; 3]);
    (
        vector(),
        vector(),
        0.001..179.9_f64,
        vector(),
        1e-3..1e3_f64,
        prop::collection::btree_map("[^\\p{C}]{1,20}", vector(), 0..4),
    )
        .prop_map(|(position, up, fov, direction, intensity, places)| {
            let mut json = full();
            json["camera"] =
                json!({ "position": position, "up": up, "fov_y_deg": fov, "target": [2e6, 0, 0] });
            json["lights"]["sun"]["direction"] = json!(direction);
            json["lights"]["sun"]["intensity"] = json!(intensity);
            for (name, place) in places {
                json["instances"][name] =
                    json!({ "mesh": "box", "translation": place, "rotation_deg": place });
            }
            json
        })
}

proptest! {
    #[test]
    fn damaged_documents_compile_or_are_refused(json in damaged()) {
        if let Ok(document) = Document::from_json(&json) {
            let written = document.to_json();
            prop_assert_eq!(Document::from_json(&written).unwrap(), document.clone());
            let limits = Limits { scene_bytes: 1 << 24, shape_segments: 64, ..Limits::default() };
            let _ = compile(&document, &Files::default(), None, &limits);
        }
    }

    #[test]
    fn every_fault_points_into_the_document_or_at_what_it_lacks(json in damaged()) {
        for fault in Document::from_json(&json).err().unwrap_or_default() {
            let parent = fault.pointer.rsplit_once('/').map_or("", |(parent, _)| parent);
            prop_assert!(json.pointer(parent).is_some(), "{:?}", fault);
        }
    }

    #[test]
    fn valid_documents_come_back_as_they_were(json in valid()) {
        let document = Document::from_json(&json).unwrap();
        let text = serde_json::to_string(&document.to_json()).unwrap();
        let back: Value = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(Document::from_json(&back).unwrap(), document);
    }

    #[test]
    fn any_patch_applies_or_leaves_the_scene_alone(patch in any_json()) {
        let store = Store::new(Limits { scene_bytes: 1 << 24, shape_segments: 64, ..Limits::default() });
        let new = NewScene { document: Some(json!({"name": "x"})), ..NewScene::default() };
        let before = store.create(new).unwrap();
        let applied = store.patch(&before.id, &patch, &Precondition::None);
        let after = store.get(&before.id).unwrap();
        match applied {
            Ok(entry) => prop_assert_eq!(after.revision, entry.revision),
            Err(_) => prop_assert_eq!(after.etag, before.etag),
        }
    }

    #[test]
    fn merging_a_document_with_itself_changes_nothing(json in valid()) {
        prop_assert_eq!(&patch::merge(&json, &json).unwrap().json, &json);
    }
}
