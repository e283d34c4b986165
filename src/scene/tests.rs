//! Claims about the way from document to scene.

mod damage;
mod framing;
mod memory;
mod models;
mod store;

use super::*;
use crate::limits::Limits;
use crate::math::Bounds;
use bytes::Bytes;
use glam::DVec3;
use serde_json::{Value, json};
use std::sync::Arc;

pub(super) fn compiled(json: &Value) -> Result<Compiled, SceneError> {
    let document = Document::from_json(json).map_err(SceneError::Document)?;
    compile(&document, &Files::default(), None, &Limits::default())
}

pub(super) fn scene(json: &Value) -> Scene {
    compiled(json).unwrap().scene
}

/// A box of side 1 with its corner at (0, 0, 0), as `instance` places it.
fn cornered(instance: Value) -> Value {
    let [a, b] = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]];
    let positions =
        [a, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], a, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], a, [1.0, 0.0, 0.0], b];
    json!({
        "meshes": { "m": { "type": "triangles", "positions": positions } },
        "instances": { "i": instance }
    })
}

fn world_bounds(json: &Value) -> Bounds {
    let scene = scene(json);
    scene.bounds(0.0).unwrap().translated(scene.anchor)
}

#[test]
fn the_empty_document_compiles() {
    let scene = scene(&json!({}));
    assert!(scene.instances.is_empty());
    assert_eq!(scene.bounds(0.0), None);
    assert_eq!(scene.warnings, []);
}

#[test]
fn the_demo_scene_compiles_without_a_warning() {
    let document = Document::from_json(&demo::document()).unwrap();
    let compiled = compile(&document, &demo::files(), None, &Limits::default()).unwrap();
    assert_eq!(compiled.scene.warnings, []);
}

#[test]
fn transforms_apply_in_the_documented_order() {
    // S doubles x, Rx then Ry then Rz turn, T moves: M = T·Rz·Ry·Rx·S.
    let scene = scene(&cornered(json!({
        "mesh": "m", "scale": [2, 1, 1], "rotation_deg": [90, 0, 90], "translation": [10, 0, 0]
    })));
    let instance = &scene.instances[0];
    let mesh = scene.mesh(instance);
    let linear = instance.linear(0.0);
    let origin = instance.origin(mesh, linear) + scene.anchor;
    let at = |p: DVec3| origin + linear * (p - mesh.origin);
    assert_eq!(at(DVec3::X), DVec3::new(10.0, 2.0, 0.0));
    assert_eq!(at(DVec3::Y), DVec3::new(10.0, 0.0, 1.0));
    assert_eq!(at(DVec3::Z), DVec3::new(11.0, 0.0, 0.0));
}

#[test]
fn model_scale_is_about_the_worlds_origin() {
    let mut json = cornered(json!({ "mesh": "m", "translation": [4, 0, 0] }));
    json["render"] = json!({ "model_scale": 0.5 });
    let bounds = world_bounds(&json);
    assert_eq!((bounds.min, bounds.max), (DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.5, 0.5, 0.5)));
}

#[test]
fn bounds_are_those_of_the_vertices_not_of_the_turned_box() {
    let positions = json!([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [1, 0, 0], [0, 1, 0]]);
    let json = json!({
        "meshes": { "m": { "type": "triangles", "positions": positions } },
        "instances": { "i": { "mesh": "m", "rotation_deg": [0, 0, 45] } }
    });
    let bounds = world_bounds(&json);
    // A cross turned by 45° is smaller than its box turned by 45°, which would reach to ±√2.
    assert!((bounds.max.x - 0.5_f64.sqrt()).abs() < 1e-12, "{bounds:?}");
}

#[test]
fn a_scene_moved_exactly_is_the_same_in_anchored_space() {
    let at = |offset: f64| {
        scene(&json!({
            "camera": { "position": [3.0 + offset, 2.0 - offset, 4.0 + offset], "target": [offset, 0.5 - offset, offset] },
            "lights": { "lamp": { "type": "point", "position": [1.0 + offset, 2.0 - offset, 1.0 + offset] } },
            "meshes": { "ball": { "type": "sphere" }, "box": { "type": "box" } },
            "instances": {
                "a": { "mesh": "box", "rotation_deg": [10, 20, 30], "translation": [offset, 0.5 - offset, offset] },
                "b": { "mesh": "ball", "translation": [1.25 + offset, -offset, offset] }
            }
        }))
    };
    let (here, there) = (at(0.0), at(1e7));
    assert_eq!(here.camera, there.camera);
    assert_eq!(here.lights, there.lights);
    assert_eq!(here.instances, there.instances);
}

#[test]
fn a_mesh_far_from_its_own_origin_is_anchored_at_itself() {
    let far = |offset: f64| {
        let positions = [[offset, 0.25, 0.0], [offset + 1.0, 0.25, 0.0], [offset, 1.25, 0.0]];
        scene(&json!({
            "camera": { "position": [offset, 0, 4], "target": [offset, 0, 0] },
            "meshes": { "m": { "type": "triangles", "positions": positions } },
            "instances": { "i": { "mesh": "m" } }
        }))
    };
    let (here, there) = (far(0.0), far(1e7));
    assert_eq!(here.camera, there.camera);
    assert_eq!(here.bounds(0.0), there.bounds(0.0));
}

#[test]
fn what_did_not_change_is_shared() {
    let json = document::tests::full();
    let document = Document::from_json(&json).unwrap();
    let first = compile(&document, &Files::default(), None, &Limits::default()).unwrap();
    let mut moved = document.clone();
    moved.camera.near = Some(0.25);
    moved.meshes.insert("box".to_owned(), document::MeshPart::Box { size: [2.0; 3] });
    let second = compile(&moved, &Files::default(), Some(&first.assets), &Limits::default()).unwrap();
    for (name, (a, b)) in
        first.scene.mesh_names.iter().zip(first.scene.meshes.iter().zip(&second.scene.meshes))
    {
        assert_eq!(Arc::ptr_eq(a, b), name != "box", "{name}");
    }
    let map = |scene: &Scene| scene.materials.iter().find_map(|m| m.diffuse_map.clone()).unwrap();
    assert!(Arc::ptr_eq(&map(&first.scene), &map(&second.scene)));
}

#[test]
fn missing_files_are_faults_with_the_nearest_name() {
    let json = json!({
        "meshes": { "a": { "type": "obj", "file": "models/buny.obj" } },
        "textures": { "t": { "file": "x.png" } },
        "environment": { "background": { "type": "equirect", "file": "sky.hdr" } }
    });
    let mut files = Files::default();
    files.insert("bunny.obj", Bytes::new()).unwrap();
    let document = Document::from_json(&json).unwrap();
    let error = compile(&document, &files, None, &Limits::default()).unwrap_err();
    let SceneError::Document(faults) = error else { panic!("{error}") };
    let pointers: Vec<_> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(pointers, ["/meshes/a/file"]);
    assert!(faults[0].detail.contains("did you mean \"bunny.obj\"?"), "{}", faults[0].detail);
}

fn sun_shadow(shadow: Value) -> Value {
    json!({ "lights": { "sun": { "type": "directional", "direction": [0, -1, 0], "shadow": shadow } } })
}

#[test]
fn missing_files_are_told_with_all_other_faults() {
    let json = json!({
        "camera": { "fov_y_deg": 200 },
        "meshes": { "a": { "type": "obj", "file": "a.obj" }, "b": { "type": "sphere", "radius": -1 } },
        "instances": { "i": { "mesh": "c" } }
    });
    let new = NewScene { document: Some(json.clone()), ..NewScene::default() };
    let Err(SceneError::Document(faults)) = new.compile(&Limits::default()) else { panic!("faults") };
    let pointers: Vec<_> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(pointers, ["/camera/fov_y_deg", "/meshes/b/radius", "/instances/i/mesh", "/meshes/a/file"]);
    let store = Store::new(Limits::default());
    let id = store.create(NewScene { document: Some(json!({})), ..NewScene::default() }).unwrap().id;
    let Err(StoreError::Scene(SceneError::Document(patched))) = store.patch(&id, &json, &Precondition::None)
    else {
        panic!("faults")
    };
    assert_eq!(patched, faults);
}

#[test]
fn what_is_over_a_limit_is_named_with_it() {
    for (json, limit, value) in [
        (json!({"render": {"width": 16385}}), 16384, 16385),
        (json!({"render": {"width": 16384, "height": 16384}}), 1 << 26, 1 << 28),
        (json!({"render": {"width": 9_007_199_254_740_992_u64}}), 16384, 1 << 53),
        (json!({"render": {"width": 1e300}}), 16384, u64::MAX),
        (json!({"name": "é".repeat(129)}), 128, 129),
        (json!({"meshes": {"m".repeat(200): {"type": "box"}}}), 128, 200),
        (json!({"environment": {"backgrounds": {"b".repeat(130): {"type": "transparent"}}}}), 128, 130),
        (json!({"textures": {"t": {"checker": {"cells": 2049}}}}), 2048, 2049),
        (sun_shadow(json!({"bias": 1000.5})), 1000, 1001),
        (sun_shadow(json!({"radius": 1e30})), 1024, u64::MAX),
        (sun_shadow(json!({"search_radius": 1025})), 1024, 1025),
        (sun_shadow(json!({"pcf_taps": 1025})), 1024, 1025),
        (sun_shadow(json!({"search_taps": 1025})), 1024, 1025),
        (sun_shadow(json!({"filter_taps": 5000})), 1024, 5000),
        (json!({"post": [{"type": "blur", "radius": 257}]}), 256, 257),
        (json!({"post": [{"type": "bloom", "radius": 300}]}), 256, 300),
        (json!({"post": [{"type": "kernel", "kernel": vec![vec![0; 65]; 65]}]}), 63, 65),
        (json!({"meshes": {"m": {"type": "sphere", "rings": 5000}}}), 2048, 5000),
        (
            json!({"lights": {"l": {"type": "point", "position": [0, 0, 0], "shadow": {"resolution": 16385}}}}),
            16384,
            16385,
        ),
    ] {
        match compiled(&json) {
            Err(SceneError::TooLarge { limit: l, value: v, .. }) => {
                assert_eq!((l, v), (limit, value), "{json}")
            }
            other => panic!("{json}: {other:?}"),
        }
    }
}

#[test]
fn too_many_lights_are_refused() {
    let light = json!({ "type": "directional", "direction": [0, -1, 0] });
    let lights: serde_json::Map<_, _> = (0..1025).map(|i| (i.to_string(), light.clone())).collect();
    assert!(matches!(
        compiled(&json!({ "lights": lights })),
        Err(SceneError::TooLarge { limit: 1024, value: 1025, .. })
    ));
}

#[test]
fn there_are_as_many_instances_as_codes_for_them() {
    let of = |count: usize| {
        let names = (0..count).map(|i| (i.to_string(), json!({ "mesh": "m" })));
        let instances: serde_json::Map<_, _> = names.collect();
        compiled(&json!({ "meshes": { "m": { "type": "box" } }, "instances": instances }))
    };
    // 0 is the background.
    let codes = of(65_535).unwrap().scene.instances.len();
    assert_eq!(codes, usize::from(u16::MAX));
    assert!(matches!(of(65_536), Err(SceneError::TooLarge { limit: 65_535, value: 65_536, .. })));
}

#[test]
fn instances_out_of_reach_are_faults() {
    let error = compiled(&cornered(json!({ "mesh": "m", "scale": 1e30, "translation": [1e37, 0, 0] })));
    assert!(error.is_ok());
    let error =
        compiled(&cornered(json!({ "mesh": "m", "scale": 2e37, "translation": [1e37, 0, 0] }))).unwrap_err();
    assert!(matches!(&error, SceneError::Document(faults) if faults[0].pointer == "/instances/i"), "{error}");
}

#[test]
fn singular_scales_compile() {
    for scale in [json!(0), json!([1, 1, 0]), json!([0, 0, 1]), json!([-1, 1, 1]), json!([1, 1e-6, 1e6])] {
        let scene = scene(&cornered(json!({ "mesh": "m", "scale": scale, "rotation_deg": [1, 2, 3] })));
        assert!(scene.bounds(0.0).unwrap().max.is_finite(), "{scale}");
    }
}

#[test]
fn maps_without_texture_coordinates_and_parallel_up_are_warned_of() {
    let mut json = cornered(json!({ "mesh": "m", "material": "tiled" }));
    json["textures"] = json!({ "t": { "checker": {} } });
    json["materials"] = json!({ "tiled": { "diffuse_map": "t" } });
    json["camera"] = json!({ "position": [0, 5, 0], "target": [0, 0, 0] });
    let warnings = scene(&json).warnings;
    assert!(warnings.iter().any(|warning| warning.detail.contains("texture coordinates")), "{warnings:?}");
    assert!(warnings.iter().any(|warning| warning.detail.contains("parallel")), "{warnings:?}");
}

#[test]
fn two_lenses_are_warned_of() {
    let both = json!({ "camera": { "fov_y_deg": 30, "orthographic": { "height": 3 } } });
    assert!(scene(&both).warnings[0].detail.contains("orthographic is used"));
    let one = json!({ "camera": { "orthographic": { "height": 3 } } });
    let again = Document::from_json(&one).unwrap().to_json();
    assert_eq!(scene(&again).warnings, []);
}

#[test]
fn a_name_is_no_part_of_the_content() {
    let of = |json: Value| scene(&json).content;
    assert_eq!(of(json!({})), of(json!({"name": "x"})));
    assert_ne!(of(json!({})), of(json!({"environment": {"ambient": "#fff"}})));
}

#[test]
fn linear_checkers_hold_the_numbers_as_written() {
    let json = json!({ "textures": { "t": {
        "checker": { "colors": [[0.2, 0.2, 0.2], [0.6, 0.6, 0.6]], "cells": 1 }, "color_space": "linear"
    } }, "materials": { "m": { "diffuse_map": "t" } } });
    let scene = scene(&json);
    let texture = scene.materials[1].diffuse_map.clone().unwrap();
    assert_eq!(texture.image.texels[0], [51, 51, 51, 255]);
}

#[test]
fn a_scene_moves_if_its_camera_or_what_is_seen_turns() {
    let turning = |deg: f64, visible: bool| {
        scene(&cornered(
            json!({"mesh": "m", "visible": visible, "spin": {"axis": [0, 1, 0], "deg_per_s": deg}}),
        ))
    };
    assert!(turning(10.0, true).moves());
    assert!(!turning(0.0, true).moves() && !turning(10.0, false).moves());
    assert!(scene(&json!({"camera": {"orbit_deg_per_s": 1}})).moves());
    assert!(!scene(&json!({})).moves());
}
