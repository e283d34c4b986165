//! Claims about the store and about models that come without a document.

use crate::limits::Limits;
use crate::scene::{Files, ModelOptions, NewScene, Precondition, SceneError, Store, StoreError, UpAxis};
use bytes::Bytes;
use serde_json::{Value, json};
use std::sync::Arc;
use std::thread;

fn store() -> Store {
    Store::new(Limits::default())
}

fn new(document: Value) -> NewScene {
    NewScene { document: Some(document), ..NewScene::default() }
}

/// A triangle that reaches from (0, 0, 0) to (1, 2, 3).
fn model(name: &str, options: ModelOptions) -> NewScene {
    let mut files = Files::default();
    files.insert(name, Bytes::from_static(b"v 0 0 0\nv 1 0 0\nv 0 2 3\nf 1 2 3\n")).unwrap();
    NewScene { document: None, files: Some(files), options }
}

#[test]
fn a_patch_makes_a_new_revision_and_keeps_the_old_one_for_those_who_hold_it() {
    let store = store();
    let first = store.create(new(json!({}))).unwrap();
    let second = store.patch(&first.id, &json!({"camera": {"fov_y_deg": 60}}), &Precondition::None).unwrap();
    assert_eq!((first.revision, second.revision), (1, 2));
    assert_ne!(first.etag, second.etag);
    assert_eq!(first.document["camera"]["fov_y_deg"], json!(45));
    assert_eq!(store.get(&first.id).unwrap().document["camera"]["fov_y_deg"], json!(60));
}

#[test]
fn a_failed_change_leaves_everything_as_it_was() {
    let store = store();
    let id = store.create(new(json!({"name": "x"}))).unwrap().id;
    let before = store.get(&id).unwrap();
    for patch in [
        json!({"name": "y", "camera": {"fov_y_deg": 200}}),
        json!({"instances": {"a": {"mesh": "b"}}}),
        json!(1),
    ] {
        let error = store.patch(&id, &patch, &Precondition::None).unwrap_err();
        assert!(matches!(error, StoreError::Scene(SceneError::Document(_))), "{error}");
    }
    assert!(store.put(&id, new(json!({"camera": 1})), &Precondition::None).is_err());
    let after = store.get(&id).unwrap();
    assert_eq!((after.revision, after.document, after.etag), (before.revision, before.document, before.etag));
}

#[test]
fn changing_a_type_drops_what_the_new_type_does_not_know() {
    let store = store();
    let id = store.create(new(json!({"meshes": {"m": {"type": "box"}}}))).unwrap().id;
    let patch = json!({
        "environment": {"background": {"type": "color", "color": "#000"}},
        "meshes": {"m": {"type": "sphere"}}
    });
    let entry = store.patch(&id, &patch, &Precondition::None).unwrap();
    assert_eq!(entry.document["environment"]["background"], json!({"type": "color", "color": "#000"}));
    assert_eq!(entry.document["meshes"]["m"]["radius"], json!(0.5));
    let wrong = json!({"meshes": {"m": {"type": "box", "rings": 3}}});
    assert!(store.patch(&id, &wrong, &Precondition::None).is_err());
}

#[test]
fn if_match_guards_every_change() {
    let store = store();
    let entry = store.create(new(json!({}))).unwrap();
    let stale = Precondition::OneOf(vec!["\"other\"".to_owned()]);
    let refused = Err(StoreError::PreconditionFailed);
    assert_eq!(store.patch(&entry.id, &json!({}), &stale).map(drop), refused);
    assert_eq!(store.put(&entry.id, new(json!({})), &stale).map(drop), refused);
    assert_eq!(store.delete(&entry.id, &stale), refused);
    assert_eq!(store.put("not-there", new(json!({})), &Precondition::Any).map(drop), refused);
    let fresh = Precondition::OneOf(vec![entry.etag]);
    assert!(store.patch(&entry.id, &json!({}), &fresh).is_ok());
    assert_eq!(store.patch(&entry.id, &json!({}), &fresh).map(drop), refused);
}

#[test]
fn put_creates_then_replaces() {
    let store = store();
    assert!(store.put("a", new(json!({})), &Precondition::None).unwrap().1);
    let (entry, is_new) = store.put("a", new(json!({})), &Precondition::None).unwrap();
    assert!(!is_new);
    assert_eq!(entry.revision, 2);
    let long = "x".repeat(65);
    for id in ["", "a/b", "ä", long.as_str()] {
        assert!(store.put(id, new(json!({})), &Precondition::None).is_err(), "{id}");
    }
}

#[test]
fn a_scene_made_again_under_its_name_has_other_tags() {
    let store = store();
    let first = store.put("a", new(json!({})), &Precondition::None).unwrap().0;
    store.delete("a", &Precondition::None).unwrap();
    assert_eq!(store.delete("a", &Precondition::None), Err(StoreError::NotFound));
    let second = store.put("a", new(json!({})), &Precondition::None).unwrap().0;
    assert_eq!(second.revision, 1);
    assert_ne!(first.etag, second.etag);
}

#[test]
fn patches_at_once_all_take_effect() {
    let store = Arc::new(store());
    let id = store.create(new(json!({"lights": {}}))).unwrap().id;
    thread::scope(|scope| {
        for i in 0..8 {
            let (store, id) = (store.clone(), id.clone());
            scope.spawn(move || {
                let lights =
                    json!({"lights": {i.to_string(): {"type": "directional", "direction": [0, -1, 0]}}});
                store.patch(&id, &lights, &Precondition::None).unwrap();
            });
        }
    });
    let entry = store.get(&id).unwrap();
    assert_eq!((entry.revision, entry.scene.lights.len()), (9, 8));
}

#[test]
fn the_memory_of_all_scenes_is_bounded() {
    let store = Store::new(Limits { total_bytes: 100_000, ..Limits::default() });
    let mut big = new(json!({}));
    big.files.get_or_insert_default().insert("a.bin", Bytes::from(vec![0; 60_000])).unwrap();
    let id = store.create(big.clone()).unwrap().id;
    assert!(matches!(store.create(big.clone()), Err(StoreError::Full { limit: 100_000, .. })));
    // In its own place it fits, and after it is gone.
    assert!(store.put(&id, big.clone(), &Precondition::None).is_ok());
    store.delete(&id, &Precondition::None).unwrap();
    assert!(store.create(big).is_ok());
}

#[test]
fn what_refers_to_a_file_changes_with_it() {
    let store = store();
    let floor = ModelOptions { floor: false, up: UpAxis::Y };
    let id = store.create(model("a.obj", floor)).unwrap().id;
    let obj = Bytes::from_static(b"v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n");
    let entry = store.put_file(&id, "a.obj", obj, &Precondition::None).unwrap();
    assert_eq!(entry.summary()["bounds"]["max"], json!([9.0, 9.0, 0.0]));
    let in_use = store.delete_file(&id, "a.obj", &Precondition::None).unwrap_err();
    assert!(matches!(in_use, StoreError::Scene(SceneError::Document(_))), "{in_use}");
    assert_eq!(store.delete_file(&id, "b.obj", &Precondition::None).map(drop), Err(StoreError::NotFound));
    let broken =
        store.put_file(&id, "a.obj", Bytes::from_static(b"v 0 0\n"), &Precondition::None).unwrap_err();
    assert!(matches!(broken, StoreError::Scene(SceneError::Unreadable { line: Some(1), .. })), "{broken}");
}

#[test]
fn what_is_read_can_be_put_back_and_a_form_replaces_the_files() {
    let store = store();
    let first = store.put("a", model("a.obj", ModelOptions::default()), &Precondition::None).unwrap().0;
    let back = store.put("a", new((*first.document).clone()), &Precondition::None).unwrap().0;
    assert_eq!((back.revision, &back.document, &back.files), (2, &first.document, &first.files));
    let form = NewScene { files: Some(Files::default()), ..new((*first.document).clone()) };
    assert!(store.put("a", form, &Precondition::None).is_err());
    let form = NewScene { files: Some(Files::default()), ..new(json!({})) };
    assert_eq!(store.put("a", form, &Precondition::None).unwrap().0.files.iter().count(), 0);
}

#[test]
fn a_file_must_have_a_name() {
    let store = store();
    let id = store.create(new(json!({}))).unwrap().id;
    for name in ["", "..", "models/", "a\nb", "x".repeat(256).as_str()] {
        let refused = store.put_file(&id, name, Bytes::new(), &Precondition::None).unwrap_err();
        assert!(matches!(refused, StoreError::Scene(SceneError::Document(_))), "{name:?}: {refused}");
        let document = json!({"textures": {"t": {"file": name}}});
        assert!(store.patch(&id, &document, &Precondition::None).is_err(), "{name:?}");
    }
    assert_eq!(store.get(&id).unwrap().revision, 1);
}

#[test]
fn a_bare_model_has_its_own_bounds_without_a_floor() {
    let entry =
        store().create(model("dir/My Model.OBJ", ModelOptions { floor: false, up: UpAxis::Y })).unwrap();
    let summary = entry.summary();
    assert_eq!(summary["bounds"], json!({"min": [0.0, 0.0, 0.0], "max": [1.0, 2.0, 3.0]}));
    assert_eq!(summary["counts"]["triangles"], json!(1));
    assert_eq!(summary["counts"]["materials"], json!(0));
    assert_eq!(entry.document["instances"]["My Model"]["mesh"], json!("My Model"));
    assert!(entry.document["camera"].get("position").is_none());
}

#[test]
fn up_z_stands_the_model_up_and_survives_the_document() {
    let store = store();
    let entry = store.create(model("a.obj", ModelOptions { floor: false, up: UpAxis::Z })).unwrap();
    let bounds = json!({"min": [0.0, 0.0, -2.0], "max": [1.0, 3.0, 0.0]});
    assert_eq!(entry.summary()["bounds"], bounds);
    let again = NewScene {
        document: Some((*entry.document).clone()),
        files: Some((*entry.files).clone()),
        ..NewScene::default()
    };
    assert_eq!(store.create(again).unwrap().summary()["bounds"], bounds);
}

#[test]
fn a_model_on_a_floor_is_in_the_middle_of_the_picture() {
    let entry = store().create(model("floor.obj", ModelOptions::default())).unwrap();
    assert_eq!(entry.document["camera"].get("position"), None);
    let summary = entry.summary();
    assert_eq!(summary["framed_bounds"], json!({"min": [0.0, 0.0, 0.0], "max": [1.0, 2.0, 3.0]}));
    assert!(summary["bounds"]["max"][0].as_f64().unwrap() > 10.0);
    assert_eq!(entry.document["instances"]["floor-2"]["framed"], json!(false));
    assert_eq!(summary["counts"]["instances"], json!(2));
    assert!(entry.document["instances"]["floor-2"]["translation"][1].as_f64().unwrap() <= 0.0);
    assert_eq!(entry.scene.warnings, []);
}

#[test]
fn nothing_to_make_a_scene_of_is_a_fault() {
    let error = store().create(NewScene::default()).unwrap_err();
    assert!(matches!(error, StoreError::Scene(SceneError::Document(_))), "{error}");
}

#[test]
fn who_watches_a_scene_sees_its_versions_and_its_end() {
    let store = store();
    let id = store.create(new(json!({}))).unwrap().id;
    let mut versions = store.watch(&id).unwrap();
    assert!(!versions.has_changed().unwrap());
    store.patch(&id, &json!({"name": "x"}), &Precondition::None).unwrap();
    assert!(store.patch(&id, &json!({"camera": 1}), &Precondition::None).is_err());
    assert_eq!(versions.borrow_and_update().revision, 2);

    store.delete(&id, &Precondition::None).unwrap();
    store.put(&id, new(json!({})), &Precondition::None).unwrap();
    assert!(versions.has_changed().is_err(), "a scene of the same id is another one");
    assert!(store.watch("none").is_none());
}
