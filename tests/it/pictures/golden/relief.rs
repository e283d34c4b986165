//! Golden pictures of normal, bump, specular and emissive maps.

use super::{assert_golden, draw};
use crate::draw::{file, png};
use rasterd::plan::FrameRequest;
use rasterd::scene::Files;
use serde_json::{Value, json};

#[expect(clippy::cast_possible_truncation, reason = "the pictures below stay in 0–255")]
fn code(value: f64) -> u8 {
    value.round() as u8
}

/// Studs, `across` × `down` of them, as a normal map: each a quarter of a ball that stands out.
fn studs(across: u32, down: u32) -> Files {
    let side = 32;
    let texel = move |x: u32, y: u32| {
        let at = |n: u32| (f64::from(n % side) + 0.5) / f64::from(side) * 2.0 - 1.0;
        // Rows run down, v runs up.
        let (x, y) = (at(x) / 0.8, -at(y) / 0.8);
        let flat = x * x + y * y;
        let normal = if flat < 0.7 { [x, y, (1.0 - flat).sqrt()] } else { [0.0, 0.0, 1.0] };
        let [r, g, b] = normal.map(|c| code(128.0 + 127.0 * c));
        [r, g, b, 255]
    };
    file("map.png", png(across * side, down * side, texel))
}

/// Smooth waves as heights.
fn waves() -> Files {
    let wave = |x: u32, y: u32| {
        let [a, b] = [x, y].map(|n| f64::from(n) / 256.0 * std::f64::consts::TAU);
        code(128.0 + 62.0 * (a * 6.0 + 2.0 * (b * 4.0).sin()).sin() + 62.0 * (b * 8.0).cos())
    };
    file("map.png", png(256, 256, |x, y| [wave(x, y), 0, 0, 255]))
}

/// A mesh with a material under one lamp from the upper left.
fn lit(mesh: Value, material: Value) -> Value {
    json!({
        "camera": { "position": [0, 0, 3.2], "target": [0, 0, 0], "fov_y_deg": 24 },
        "environment": { "ambient": [0.06, 0.06, 0.08], "background": { "type": "color", "color": "#1c1c20" } },
        "lights": { "sun": { "type": "directional", "direction": [0.7, -0.7, -0.6], "intensity": 0.9 } },
        "textures": { "map": { "file": "map.png" } },
        "materials": { "m": material },
        "meshes": { "mesh": mesh },
        "instances": { "one": { "mesh": "mesh", "material": "m" } },
        "render": { "width": 96, "height": 96, "samples": 4 },
    })
}

fn check(name: &str, document: &Value, files: &Files) {
    assert_golden(&format!("relief/{name}"), &draw(document, files, &FrameRequest::default()));
}

fn studded() -> Value {
    json!({ "diffuse": "#b8763c", "specular": [0.4, 0.4, 0.4], "shininess": 30, "normal_map": "map" })
}

#[test]
fn golden_normal_maps() {
    let sphere = json!({ "type": "sphere" });
    let studs_around = studs(16, 8);
    let mut ball = lit(sphere, studded());
    check("a_normal_map_studs_a_ball", &ball, &studs_around);
    ball["camera"] = json!({ "position": [0, 3.0, 0.9], "target": [0, 0.1, 0], "fov_y_deg": 20 });
    check("a_pole_has_no_crease", &ball, &studs_around);
    // The right half's coordinates are those of the left one in a mirror.
    let halves = json!({ "type": "triangles", "indices": [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
        "positions": [[-0.6, -0.3, 0], [0, -0.3, 0], [0.6, -0.3, 0], [-0.6, 0.3, 0], [0, 0.3, 0], [0.6, 0.3, 0]],
        "uvs": [[0, 0], [1, 0], [0, 0], [0, 1], [1, 1], [0, 1]] });
    let mut mirrored = lit(halves, studded());
    mirrored["render"] = json!({ "width": 96, "height": 64, "samples": 4 });
    check("studs_in_a_mirror_are_lit_from_the_same_side", &mirrored, &studs(2, 2));
    let mut ring = lit(json!({ "type": "torus", "radius": 0.38, "tube": 0.16 }), studded());
    ring["instances"]["one"]["rotation_deg"] = json!([60, 0, 20]);
    ring["instances"]["one"]["scale"] = json!([-1.2, 0.8, 1]);
    check("a_stretched_mirrored_torus_keeps_its_studs", &ring, &studs(24, 8));
    ring["materials"]["m"]["shading"] = json!("normal");
    check("shading_normal_shows_the_studs", &ring, &studs(24, 8));
}

#[test]
fn golden_bump_maps() {
    let wrinkled = json!({ "diffuse": "#5b8f6a", "specular": [0.5, 0.5, 0.5], "shininess": 40,
        "bump_map": "map", "bump_scale": 0.03 });
    check("a_bump_map_wrinkles_a_ball", &lit(json!({ "type": "sphere" }), wrinkled.clone()), &waves());
    let mut floor = lit(json!({ "type": "plane", "size": [40, 40], "uv_repeat": [20, 20] }), wrinkled);
    floor["camera"] = json!({ "position": [0, 1.4, 3], "target": [0, 0.2, 0], "fov_y_deg": 50 });
    floor["textures"]["map"] = json!({ "checker": { "colors": ["#000", "#fff"], "cells": 2 } });
    floor["lights"]["sun"]["direction"] = json!([0.7, -0.7, 0.6]);
    check("a_bump_map_tiles_a_floor_to_the_horizon", &floor, &Files::default());
    // A few texels over the whole picture: slopes change steadily from one to the next.
    let mut close =
        lit(json!({ "type": "plane", "size": [1.4, 1.4] }), json!({ "bump_map": "map", "bump_scale": 0.2 }));
    close["instances"]["one"]["rotation_deg"] = json!([90, 0, 0]);
    let hill =
        |x: u32, y: u32| if (2..4).contains(&x) && (2..4).contains(&y) { [255; 4] } else { [0, 0, 0, 255] };
    check("magnified_heights_are_smooth", &close, &file("map.png", png(6, 6, hill)));
}

#[test]
fn golden_specular_and_emissive_maps() {
    let stripes = file(
        "map.png",
        png(64, 64, |x, y| if (x + y) / 8 % 2 == 0 { [255, 220, 160, 255] } else { [10, 10, 10, 255] }),
    );
    let sphere = json!({ "type": "sphere" });
    let shiny = json!({ "diffuse": "#335", "specular": [1, 1, 1], "shininess": 6, "specular_map": "map" });
    check("a_specular_map_dulls_its_dark_stripes", &lit(sphere.clone(), shiny), &stripes);
    let glowing = json!({ "diffuse": "#335", "emissive": [1, 0.6, 0.3], "emissive_map": "map" });
    check("an_emissive_map_glows_in_the_dark", &lit(sphere, glowing), &stripes);
}
