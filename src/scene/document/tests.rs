//! Claims about whole documents.

use super::*;
use serde_json::json;

fn faults(json: &Value) -> Vec<(String, String)> {
    let faults = Document::from_json(json).expect_err("the document is faulty");
    faults.into_iter().map(|fault| (fault.pointer, fault.detail)).collect()
}

fn pointers(json: &Value) -> Vec<String> {
    faults(json).into_iter().map(|(pointer, _)| pointer).collect()
}

fn fault(pointer: &str, detail: &str) -> (String, String) {
    (pointer.to_owned(), detail.to_owned())
}

/// One of everything.
pub(crate) fn full() -> Value {
    json!({
        "name": "one of everything",
        "camera": { "position": [3, 2, 4], "target": [0, 0.5, 0], "up": [0, 1, 0.1], "fov_y_deg": 30,
                    "orthographic": { "height": 3 }, "near": 0.5, "far": 100, "orbit_deg_per_s": 10 },
        "environment": {
            "ambient": [0.03, 0.03, 0.03], "background": "dusk",
            "backgrounds": {
                "dusk": { "type": "gradient", "top": "#123", "bottom": [1, 0.5, 0] },
                "sky": { "type": "sky", "sun_direction": [0, -1, 0], "turbidity": 4 },
                "void": { "type": "transparent" }, "wall": { "type": "color", "color": "#fff" }
            }
        },
        "lights": {
            "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "color": "#fff4e0", "intensity": 2.5,
                     "shadow": { "filter": "pcss", "search_radius": 5, "cull": "front" } },
            "lamp": { "type": "point", "position": [1, 2, 1], "color": [1, 0.8, 0.6], "enabled": false,
                      "attenuation": { "constant": 0, "linear": 1, "quadratic": 0.5 }, "shadow": {} }
        },
        "textures": { "tiles": { "checker": { "colors": ["#888", "#eee"], "cells": 8 }, "filter": "nearest",
                                 "wrap": "mirror", "color_space": "linear" } },
        "materials": { "wood": { "shading": "lambert", "diffuse_map": "tiles", "specular": [0.2, 0.2, 0.2],
                                 "ambient": "#222", "opacity": 0.5, "alpha_cutoff": 0.1, "double_sided": true,
                                 "bump_map": "tiles", "bump_scale": 0.1 } },
        "meshes": {
            "box": { "type": "box", "size": [1, 2, 3] }, "plane": { "type": "plane", "uv_repeat": [5, 5] },
            "sphere": { "type": "sphere" }, "torus": { "type": "torus" }, "cylinder": { "type": "cylinder" },
            "cone": { "type": "cone" }, "teapot": { "type": "teapot" },
            "triangle": { "type": "triangles", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "indices": [[0, 1, 2]],
                          "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]], "uvs": [[0, 0], [1, 0], [0, 1]],
                          "colors": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }
        },
        "instances": {
            "a": { "mesh": "box", "material": "wood", "translation": [0, 0.5, 0], "rotation_deg": [0, 60, 0],
                   "scale": [1, -1, 0], "spin": { "axis": [0, 1, 0], "deg_per_s": 30 } },
            "b": { "mesh": "triangle", "scale": 2, "visible": false, "casts_shadow": false, "receives_shadow": false }
        },
        "post": [
            { "type": "tonemap", "operator": "reinhard", "exposure": 2 }, { "type": "blur" }, { "type": "grayscale" },
            { "type": "vignette" }, { "type": "bloom" }, { "type": "sharpen" }, { "type": "fxaa" },
            { "type": "color_matrix", "matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.5]] },
            { "type": "kernel", "kernel": [[0, 0, 0], [0, 1, 0], [0, 0, 0]] }
        ],
        "render": { "width": 800, "height": 600, "samples": 8, "shadows": false, "shading": "unlit", "cull": "none",
                    "model_scale": 0.5 }
    })
}

#[test]
fn a_typical_document_is_read_as_meant() {
    let json = json!({
        "name": "box on a floor",
        "camera": { "position": [3, 2, 4], "target": [0, 0.5, 0], "fov_y_deg": 45 },
        "environment": { "ambient": [0.03, 0.03, 0.03],
                         "background": { "type": "gradient", "top": "#6ea8e8", "bottom": "#dfe9f5" } },
        "lights": {
            "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "color": "#fff4e0", "intensity": 2.5,
                     "shadow": { "filter": "pcf" } },
            "lamp": { "type": "point", "position": [1, 2, 1], "color": [1, 0.8, 0.6], "intensity": 4 }
        },
        "textures": { "crate": { "file": "container.jpg" }, "tiles": { "checker": { "colors": ["#888", "#eee"], "cells": 8 } } },
        "materials": { "wood": { "diffuse_map": "crate", "specular": [0.2, 0.2, 0.2] }, "floor": { "diffuse_map": "tiles" } },
        "meshes": { "box": { "type": "box" }, "floor": { "type": "plane", "size": [10, 10], "uv_repeat": [5, 5] },
                    "bunny": { "type": "obj", "file": "bunny.obj" } },
        "instances": {
            "box": { "mesh": "box", "material": "wood", "translation": [0, 0.5, 0], "rotation_deg": [0, 60, 0] },
            "floor": { "mesh": "floor", "material": "floor" }
        },
        "post": [{ "type": "tonemap", "operator": "aces" }],
        "render": { "width": 800, "height": 600, "samples": 4 }
    });
    let document = Document::from_json(&json).unwrap();
    assert_eq!(document.meshes["floor"], MeshPart::Plane { size: [10.0; 2], uv_repeat: [5.0; 2] });
    assert_eq!(document.post, [PostEffect::Tonemap { operator: TonemapOperator::Aces, exposure: 1.0 }]);
    let lamp = document.to_json()["lights"]["lamp"].clone();
    assert_eq!(lamp["attenuation"], json!({"constant": 1, "linear": 0, "quadratic": 1}));
    assert_eq!((&lamp["color"], lamp.get("shadow")), (&json!([1, 0.8, 0.6]), None));
    let shadow = &document.to_json()["lights"]["sun"]["shadow"];
    assert_eq!(
        (&shadow["resolution"], &shadow["filter"], &shadow["cull"]),
        (&json!(2048), &json!("pcf"), &json!("none"))
    );
}

#[test]
fn wrong_words_are_answered_with_the_right_ones() {
    let found = faults(&json!({
        "materials": { "m": { "shading": "phong" } },
        "environment": { "background": { "type": "cube" } },
        "lights": { "l": { "type": "directional", "direction": [0, -1, 0], "shadow": { "filter": "PCF" } } }
    }));
    assert_eq!(
        found,
        [
            fault(
                "/environment/background/type",
                "must be one of \"color\", \"gradient\", \"sky\", \"cubemap\", \"equirect\", \"transparent\", \
                 is \"cube\"; did you mean \"cubemap\"?"
            ),
            fault(
                "/lights/l/shadow/filter",
                "must be one of \"none\", \"hard\", \"pcf\", \"pcss\", is \"PCF\"; did you mean \"pcf\"?"
            ),
            fault(
                "/materials/m/shading",
                "must be one of \"blinn_phong\", \"lambert\", \"unlit\", \"vertex_color\", \"normal\", is \"phong\"\
                 ; did you mean \"blinn_phong\"?"
            ),
        ]
    );
}

#[test]
fn the_empty_document_is_valid_and_has_a_sun() {
    let document = Document::from_json(&json!({})).unwrap();
    assert_eq!(document, Document::default());
    assert_eq!(document.lights.keys().collect::<Vec<_>>(), ["sun"]);
    assert!(document.camera.position.is_none());
    assert!(Document::from_json(&json!({"lights": {}})).unwrap().lights.is_empty());
}

#[test]
fn everything_comes_back_as_it_was() {
    for json in [json!({}), full()] {
        let document = Document::from_json(&json).unwrap();
        let written = document.to_json();
        assert_eq!(Document::from_json(&written).unwrap(), document);
        assert_eq!(Document::from_json(&written).unwrap().to_json(), written);
    }
}

#[test]
fn defaults_are_filled_in_but_automatic_framing_stays_automatic() {
    let camera = Document::from_json(&json!({})).unwrap().to_json()["camera"].clone();
    assert_eq!(camera, json!({"up": [0, 1, 0], "fov_y_deg": 45, "orbit_deg_per_s": 0}));
    let placed = Document::from_json(&json!({"camera": {"position": [1, 2, 3]}})).unwrap().to_json();
    assert_eq!(placed["camera"]["near"], json!(0.1));
    assert_eq!(placed["camera"]["target"], json!([0, 0, 0]));
}

#[test]
fn all_faults_come_at_once_each_with_its_place() {
    let found = faults(&json!({
        "camera": { "fov_y_deg": 200, "fov": 3, "near": -1 },
        "lights": { "a/b": { "type": "point", "position": [0, 0] } },
        "instances": { "x": { "mesh": "boks" } },
        "meshes": { "box": { "type": "box" } },
        "colour": 1
    }));
    assert_eq!(
        found,
        [
            fault("/camera/fov_y_deg", "must lie in [0.001, 179.9], is 200"),
            fault("/camera/near", "must be greater than 0, is -1"),
            fault("/camera/fov", "unknown field \"fov\"; did you mean \"fov_y_deg\"?"),
            fault("/lights/a~1b/position", "must be an array of 3 numbers, is [0,0]"),
            fault("/colour", "unknown field \"colour\""),
            fault("/instances/x/mesh", "there is no \"boks\" in meshes; did you mean \"box\"?"),
        ]
    );
}

#[test]
fn a_reference_to_a_faulty_entry_does_not_dangle() {
    let json = json!({
        "meshes": { "ball": { "type": "sphere", "radius": "big" } },
        "instances": { "x": { "mesh": "ball", "material": "none" } }
    });
    assert_eq!(pointers(&json), ["/meshes/ball/radius", "/instances/x/material"]);
}

#[test]
fn cameras_that_look_nowhere_are_refused() {
    for (camera, pointer) in [
        (json!({"near": 0}), "/camera/near"),
        (json!({"near": 2, "far": 2}), "/camera/far"),
        (json!({"position": [0, 0, 1], "far": 0.05}), "/camera/far"),
        (json!({"position": [1, 2, 3], "target": [1, 2, 3]}), "/camera/target"),
        (json!({"position": [0, 0, 0]}), "/camera/target"),
        (json!({"up": [0, 0, 0]}), "/camera/up"),
        (json!({"fov_y_deg": 0}), "/camera/fov_y_deg"),
        (json!({"fov_y_deg": 180}), "/camera/fov_y_deg"),
        (json!({"orthographic": {"height": 0}}), "/camera/orthographic/height"),
        (json!({"position": [1e38, 0, 0]}), "/camera/position/0"),
    ] {
        assert_eq!(pointers(&json!({ "camera": camera })), [pointer], "{camera}");
    }
    let thin = json!({"camera": {"position": [0, 0, 1], "near": 1, "far": 1.000_001}});
    assert!(Document::from_json(&thin).is_ok());
}

#[test]
fn lights_that_make_no_sense_are_refused() {
    for (light, pointer) in [
        (json!({"type": "directional", "direction": [0, 0, 0]}), "/lights/l/direction"),
        (json!({"type": "directional"}), "/lights/l"),
        (json!({"type": "spot"}), "/lights/l/type"),
        (
            json!({"type": "directional", "direction": [0, -1, 0], "position": [0, 0, 0]}),
            "/lights/l/position",
        ),
        (json!({"type": "point", "position": [0, 0, 0], "intensity": -1}), "/lights/l/intensity"),
        (
            json!({"type": "point", "position": [0, 0, 0], "attenuation": {"constant": 0, "quadratic": 0}}),
            "/lights/l/attenuation",
        ),
        (
            json!({"type": "point", "position": [0, 0, 0], "shadow": {"resolution": 0}}),
            "/lights/l/shadow/resolution",
        ),
    ] {
        assert_eq!(pointers(&json!({ "lights": { "l": light } })), [pointer], "{light}");
    }
}

#[test]
fn null_is_no_value() {
    for json in [json!(null), json!({"camera": null}), json!({"name": null}), json!({"meshes": {"a": null}})]
    {
        assert!(Document::from_json(&json).is_err(), "{json}");
    }
}

#[test]
fn picture_sizes_are_positive_whole_numbers() {
    for width in [json!(0), json!(-5), json!(1.5), json!("800")] {
        assert_eq!(pointers(&json!({"render": {"width": width}})), ["/render/width"], "{width}");
    }
    assert_eq!(pointers(&json!({"render": {"samples": 3}})), ["/render/samples"]);
}

#[test]
fn inline_triangles_are_checked_against_each_other() {
    let positions = json!([[0, 0, 0], [1, 0, 0], [0, 1, 0]]);
    for (mesh, pointer) in [
        (json!({"type": "triangles"}), "/meshes/m"),
        (json!({"type": "triangles", "positions": [[0, 0, 0], [1, 0, "x"]]}), "/meshes/m/positions/1/2"),
        (json!({"type": "triangles", "positions": positions, "indices": [[0, 1, 3]]}), "/meshes/m/indices"),
        (json!({"type": "triangles", "positions": positions, "indices": [0, 1, 2.5]}), "/meshes/m/indices"),
        (json!({"type": "triangles", "positions": positions, "uvs": [[0, 0]]}), "/meshes/m/uvs"),
        (json!({"type": "triangles", "positions": [0, 0, 0, 1, 1, 1]}), "/meshes/m/positions"),
    ] {
        assert_eq!(pointers(&json!({ "meshes": { "m": mesh } })), [pointer], "{mesh}");
    }
    let flat = json!({"meshes": {"m": {"type": "triangles", "positions": [0, 0, 0, 1, 0, 0, 0, 1, 0]}}});
    let nested = json!({"meshes": {"m": {"type": "triangles", "positions": positions}}});
    assert_eq!(Document::from_json(&flat), Document::from_json(&nested));
}

#[test]
fn faulty_indices_are_indices_all_the_same() {
    let mesh = json!({"type": "triangles", "positions": [[0, 0, 0]], "indices": [[0, 1, 2]]});
    let expected = "triangle 0 must refer to vertices 0 to 0, refers to 0, 1, 2";
    assert_eq!(faults(&json!({ "meshes": { "m": mesh } })), [fault("/meshes/m/indices", expected)]);
    let mesh = json!({"type": "triangles", "positions": [[0, 0, 0]], "indices": "all"});
    assert_eq!(pointers(&json!({ "meshes": { "m": mesh } })), ["/meshes/m/indices"]);
}

#[test]
fn a_scale_is_a_number_or_three() {
    let of = |scale: Value| {
        faults(
            &json!({ "meshes": {"m": {"type": "box"}}, "instances": {"i": {"mesh": "m", "scale": scale}} }),
        )
    };
    let expected = "must be a number or an array of 3 numbers, is \"x\"";
    assert_eq!(of(json!("x")), [fault("/instances/i/scale", expected)]);
    assert_eq!(of(json!([1, 2]))[0].1, "must be an array of 3 numbers, is [1,2]");
    assert_eq!(of(json!([1, "x", 2]))[0].0, "/instances/i/scale/1");
}

#[test]
fn faults_are_bounded() {
    let bad: Vec<_> = (0..10_000).map(|_| "x").collect();
    let json = json!({"meshes": {"m": {"type": "triangles", "positions": bad}}});
    assert!(Document::from_json(&json).unwrap_err().len() < 300);
}

#[test]
fn each_use_of_a_texture_has_its_colour_space_unless_said_otherwise() {
    let json = json!({
        "textures": {
            "n": {"checker": {}}, "both": {"checker": {}}, "said": {"checker": {}, "color_space": "srgb"}, "idle": {"checker": {}},
        },
        "materials": { "m": {
            "normal_map": "n", "bump_map": "both", "diffuse_map": "both", "opacity_map": "said", "specular_map": "said",
        } }
    });
    let document = Document::from_json(&json).unwrap();
    use crate::model::texture::ColorSpace::{Linear, Srgb};
    let expected =
        [("both", vec![Srgb, Linear]), ("idle", vec![Srgb]), ("n", vec![Linear]), ("said", vec![Srgb])];
    assert!(document.color_spaces().into_iter().eq(expected));
}
