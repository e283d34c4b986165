//! Golden pictures: `tests/golden/<pass>/<claim>.png`, one cause each, compared byte by byte.
//!
//! A failure writes `<claim>.actual.png` and `<claim>.difference.png` (differing pixels white) under
//! `target/golden/<pass>/`. `RASTERD_BLESS=1 cargo test --test it golden` rewrites the pictures; look at
//! every one of them before it is committed.

mod files;
mod instances;
mod relief;

use crate::draw::{file, frame, output, png, samples, scene_with};
use rasterd::encode;
use rasterd::limits::Limits;
use rasterd::pipeline::{Frame, Pixels, Stats, Timings};
use rasterd::plan::request::BackgroundRequest;
use rasterd::plan::{Elisions, FrameRequest, Output};
use rasterd::scene::{Files, Scene, gallery};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A picture as its file holds it.
#[derive(PartialEq)]
struct Decoded {
    width: u32,
    height: u32,
    color: png::ColorType,
    depth: png::BitDepth,
    bytes: Vec<u8>,
}

fn decode(file: &[u8]) -> Decoded {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut bytes).expect("a whole PNG");
    bytes.truncate(info.buffer_size());
    Decoded { width: info.width, height: info.height, color: info.color_type, depth: info.bit_depth, bytes }
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn write(path: &Path, bytes: &[u8]) {
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder to write to");
    std::fs::write(path, bytes).expect("a file to write to");
}

/// White where two pictures of one kind differ.
fn difference(actual: &Decoded, golden: &Decoded) -> Vec<u8> {
    let size = actual.bytes.len() / (actual.width * actual.height) as usize;
    let at = |picture: &Decoded, i: usize| picture.bytes.get(i * size..(i + 1) * size).map(<[u8]>::to_vec);
    png(actual.width, actual.height, |x, y| {
        let i = (y * actual.width + x) as usize;
        if at(actual, i) == at(golden, i) { [0, 0, 0, 255] } else { [255; 4] }
    })
}

/// Compares a frame with `tests/golden/<name>.png`.
#[track_caller]
pub fn assert_golden(name: &str, frame: &Frame) {
    let golden = root().join("tests/golden").join(name).with_extension("png");
    let actual = encode::png(frame);
    if std::env::var_os("RASTERD_BLESS").is_some_and(|value| value == "1") {
        write(&golden, &actual);
        return;
    }
    let expected =
        decode(&std::fs::read(&golden).unwrap_or_else(|error| panic!("{}: {error}", golden.display())));
    let decoded = decode(&actual);
    if decoded != expected {
        let beside = root().join("target/golden").join(name);
        write(&beside.with_extension("actual.png"), &actual);
        write(&beside.with_extension("difference.png"), &difference(&decoded, &expected));
        panic!("{name} differs: see {}", beside.with_extension("difference.png").display());
    }
}

/// Compares the bytes of a file with `tests/golden/<name>`.
#[track_caller]
fn assert_golden_file(name: &str, actual: &[u8]) {
    let golden = root().join("tests/golden").join(name);
    if std::env::var_os("RASTERD_BLESS").is_some_and(|value| value == "1") {
        write(&golden, actual);
        return;
    }
    let expected = std::fs::read(&golden).unwrap_or_else(|error| panic!("{}: {error}", golden.display()));
    if actual != expected {
        let beside = root().join("target/golden").join(name);
        write(&beside, actual);
        panic!("{name} differs: see {}", beside.display());
    }
}

/// A golden picture as a frame.
fn stored(name: &str) -> Frame {
    let file = std::fs::read(root().join("tests/golden").join(name)).expect("a golden picture");
    let picture = image::load_from_memory(&file).expect("a PNG").into_rgba8();
    Frame {
        width: picture.width(),
        height: picture.height(),
        pixels: Pixels::Rgba8 { pixels: picture.pixels().map(|pixel| pixel.0).collect(), opaque: true },
        stats: Stats::default(),
        timings: Timings::default(),
        depth_range: None,
    }
}

fn draw(document: &Value, files: &Files, request: &FrameRequest) -> Frame {
    draw_scene(&scene_with(document, files), request)
}

/// Draws a scene, with all that it can be spared and with nothing spared: both are one picture.
#[track_caller]
fn draw_scene(scene: &Arc<Scene>, request: &FrameRequest) -> Frame {
    let drawn = |elide| frame(scene, &FrameRequest { elide: Some(elide), ..request.clone() });
    let spared = drawn(Elisions::ALL);
    assert!(spared.pixels == drawn(Elisions::NONE).pixels, "another picture with nothing spared");
    spared
}

/// Draws a document without files as it is.
#[track_caller]
fn check(name: &str, document: &Value) {
    assert_golden(name, &draw(document, &Files::default(), &FrameRequest::default()));
}

/// One unlit triangle, white on black.
fn triangle(count: u32) -> Value {
    json!({
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "fov_y_deg": 40 },
        "environment": { "background": { "type": "color", "color": "#000" } },
        "lights": {},
        "materials": { "white": { "shading": "unlit", "diffuse": [1, 1, 1], "double_sided": true } },
        "meshes": { "one": { "type": "triangles", "positions": [[-0.9, -0.8, 0], [0.95, -0.3, 0], [-0.2, 0.9, 0]] } },
        "instances": { "one": { "mesh": "one", "material": "white" } },
        "render": { "width": 64, "height": 64, "samples": count },
    })
}

/// Shapes on a checkered floor under a sun.
fn still_life() -> Value {
    json!({
        "camera": { "position": [1.9, 2.0, 3.6], "target": [0.1, 0.35, 0], "fov_y_deg": 40 },
        "environment": { "ambient": [0.12, 0.13, 0.16] },
        "lights": { "sun": { "type": "directional", "direction": [-0.6, -1, -0.5], "intensity": 0.9,
            "shadow": { "filter": "hard", "resolution": 512 } } },
        "textures": { "tiles": { "checker": { "colors": ["#446", "#dda"], "cells": 8 }, "filter": "trilinear" } },
        "materials": {
            "floor": { "diffuse": [1, 1, 1], "diffuse_map": "tiles" },
            "red": { "diffuse": "#c0392b", "specular": [0.5, 0.5, 0.5], "shininess": 40 },
            "teal": { "diffuse": "#16a085" },
        },
        "meshes": {
            "floor": { "type": "plane", "size": [200, 200], "uv_repeat": [50, 50] },
            "box": { "type": "box", "size": [0.8, 0.8, 0.8] }, "ball": { "type": "sphere" },
        },
        "instances": {
            "ball": { "mesh": "ball", "material": "red", "translation": [-0.6, 0.5, 0.2] },
            "crate": { "mesh": "box", "material": "teal", "translation": [0.7, 0.4, -0.2], "rotation_deg": [0, 30, 0] },
            "floor": { "mesh": "floor", "material": "floor" },
        },
        "render": { "width": 96, "height": 72, "samples": 4 },
    })
}

/// A pole, a ball above the floor and a box, all around the middle of a plain floor.
fn shadow_study(light: Value) -> Value {
    json!({
        "camera": { "position": [0.6, 3.6, 3.0], "target": [0.35, 0.15, 0.1], "fov_y_deg": 42 },
        "environment": { "ambient": [0.15, 0.16, 0.18] },
        "lights": { "light": light },
        "materials": { "red": { "diffuse": "#c0392b" }, "teal": { "diffuse": "#16a085" } },
        "meshes": {
            "floor": { "type": "plane", "size": [9, 9] }, "ball": { "type": "sphere", "radius": 0.35 },
            "pole": { "type": "cylinder", "radius": 0.06, "height": 1.4 },
            "box": { "type": "box", "size": [0.6, 0.7, 0.6] },
        },
        "instances": {
            "ball": { "mesh": "ball", "material": "red", "translation": [0.4, 0.6, -0.6] },
            "box": { "mesh": "box", "material": "teal", "translation": [0.4, 0.35, 0.7], "rotation_deg": [0, 25, 0] },
            "floor": { "mesh": "floor" },
            "pole": { "mesh": "pole", "material": "teal", "translation": [-1.0, 0.7, 0.0] },
        },
        "render": { "width": 160, "height": 120, "samples": 4 },
    })
}

#[test]
fn golden_coverage() {
    check("cover/one_sample_has_hard_edges", &triangle(1));
    check("cover/sixteen_samples_have_soft_edges", &triangle(16));
    let mut clear = triangle(8);
    clear["environment"]["background"] = json!({ "type": "transparent" });
    check("cover/a_transparent_background_keeps_straight_colour", &clear);
    let mut near = triangle(1);
    near["instances"]["one"]["rotation_deg"] = json!([0, 70, 0]);
    near["camera"]["near"] = json!(2.8);
    check("cover/the_near_plane_cuts", &near);
}

#[test]
fn golden_shading() {
    let mut ball = still_life();
    ball["instances"] = json!({ "ball": ball["instances"]["ball"] });
    ball["camera"] = json!({ "position": [-0.6, 0.5, 2.4], "target": [-0.6, 0.5, 0.2], "fov_y_deg": 32 });
    ball["environment"]["background"] = json!({ "type": "color", "color": "#222" });
    ball["render"] = json!({ "width": 64, "height": 64, "samples": 4 });
    ball["lights"]["sun"]["direction"] = json!([-0.6, -0.7, -0.5]);
    for shading in ["blinn_phong", "lambert", "unlit", "normal"] {
        ball["materials"]["red"]["shading"] = json!(shading);
        check(&format!("shade/a_ball_in_{shading}"), &ball);
    }
    ball["materials"]["red"]["shading"] = json!("blinn_phong");
    ball["lights"] = json!({ "lamp": { "type": "point", "position": [-0.2, 1.2, 0.9], "intensity": 1.2 } });
    check("shade/a_point_light_fades_with_distance", &ball);
    ball["meshes"]["ball"] = json!({ "type": "torus", "radius": 0.35, "tube": 0.14 });
    ball["instances"]["ball"]["rotation_deg"] = json!([60, 0, 20]);
    ball["instances"]["ball"]["scale"] = json!([-1.2, 0.8, 1]);
    check("shade/a_mirrored_stretched_torus_keeps_its_light", &ball);
}

#[test]
fn golden_textures() {
    let floor = |filter: &str| {
        let mut document = still_life();
        document["instances"] = json!({ "floor": document["instances"]["floor"] });
        document["textures"]["tiles"]["filter"] = json!(filter);
        document["materials"]["floor"]["shading"] = json!("unlit");
        document["camera"] = json!({ "position": [0, 1.2, 0], "target": [0.4, 0.8, -2], "fov_y_deg": 55 });
        document["render"]["samples"] = json!(1);
        document
    };
    check("texture/nearest_aliases_at_the_horizon", &floor("nearest"));
    check("texture/bilinear_changes_levels_at_a_line", &floor("bilinear"));
    check("texture/trilinear_fades_to_the_mean_at_the_horizon", &floor("trilinear"));
    // A gradient with a red corner at u = v = 0, so that every turn and mirror image shows.
    let ramp = |x: u32, y: u32| {
        if x < 3 && y > 4 {
            [220, 30, 30, 255]
        } else {
            let part = |n: u32| u8::try_from(40 + 28 * n).expect("eight texels");
            [part(x), part(7 - y), 90, 255]
        }
    };
    let files = file("ramp.png", png(8, 8, ramp));
    for wrap in ["repeat", "clamp", "mirror"] {
        let document = json!({
            "camera": { "position": [0, 0, 5], "target": [0, 0, 0], "orthographic": { "height": 2 } },
            "lights": {},
            "textures": { "ramp": { "file": "ramp.png", "wrap": wrap, "filter": "bilinear" } },
            "materials": { "ramp": { "shading": "unlit", "diffuse": [1, 1, 1], "diffuse_map": "ramp" } },
            "meshes": { "chart": { "type": "triangles", "indices": [0, 1, 2, 0, 2, 3],
                "positions": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]],
                "uvs": [[-1.25, -1.25], [2.25, -1.25], [2.25, 2.25], [-1.25, 2.25]] } },
            "instances": { "chart": { "mesh": "chart", "material": "ramp" } },
            "render": { "width": 84, "height": 84, "samples": 1 },
        });
        assert_golden(&format!("texture/wrap_{wrap}"), &draw(&document, &files, &FrameRequest::default()));
    }
}

#[test]
fn golden_shadows() {
    check("shadow/hard_shadows_lie_on_a_floor", &still_life());
    let mut grazing = still_life();
    grazing["lights"]["sun"]["direction"] = json!([-1, -0.15, -0.4]);
    grazing["lights"]["sun"]["intensity"] = json!(4);
    check("shadow/grazing_light_leaves_no_acne", &grazing);
    let sun = |shadow: Value| {
        shadow_study(
            json!({ "type": "directional", "direction": [0.9, -1, 0.35], "intensity": 0.9, "shadow": shadow }),
        )
    };
    let pcf = json!({ "filter": "pcf", "resolution": 128, "radius": 2 });
    check("shadow/pcf_softens_every_edge_alike", &sun(pcf));
    let pcss = json!({ "filter": "pcss", "resolution": 512, "light_radius": 0.15 });
    check("shadow/pcss_is_sharp_where_it_begins", &sun(pcss));
    let many = json!({ "filter": "pcss", "resolution": 512, "light_radius": 0.15, "search_radius": 24,
        "search_taps": 64, "filter_taps": 200 });
    check("shadow/pcss_with_many_taps_has_no_grain", &sun(many));
    for cull in ["front", "back"] {
        let mut document = sun(json!({ "filter": "hard", "resolution": 512, "cull": cull }));
        document["meshes"]["box"] = json!({ "type": "plane", "size": [0.7, 0.7] });
        check(&format!("shadow/sheets_that_cull_{cull}_faces"), &document);
    }
}

#[test]
fn golden_point_shadows() {
    let lamp = |shadow: Value| {
        shadow_study(
            json!({ "type": "point", "position": [-0.2, 1.6, 0.1], "intensity": 2.5, "shadow": shadow }),
        )
    };
    check("shadow/a_lamp_throws_hard_shadows", &lamp(json!({ "filter": "hard", "resolution": 512 })));
    let pcf = json!({ "filter": "pcf", "resolution": 128, "radius": 1.5 });
    check("shadow/a_lamp_throws_pcf_shadows", &lamp(pcf));
    let ball = json!({ "filter": "pcss", "resolution": 512, "light_radius": 0.12 });
    check("shadow/a_glowing_ball_throws_soft_shadows", &lamp(ball));
    let few = json!({ "filter": "pcss", "resolution": 512, "light_radius": 0.12, "search_radius": 16,
        "search_taps": 4, "filter_taps": 4 });
    check("shadow/a_glowing_ball_seen_by_four_taps", &lamp(few));
}

#[test]
fn golden_transparency() {
    let mut layers = still_life();
    layers["meshes"]["pane"] = json!({ "type": "plane", "size": [1.4, 1.4] });
    for (name, color, turn) in
        [("red", [0.9, 0.1, 0.1], 5), ("green", [0.1, 0.7, 0.2], 65), ("blue", [0.1, 0.2, 0.9], -35)]
    {
        layers["materials"][name] =
            json!({ "shading": "unlit", "diffuse": color, "opacity": 0.5, "double_sided": true });
        layers["instances"][name] = json!({ "mesh": "pane", "material": name, "translation": [0, 0.7, 0],
            "rotation_deg": [90, turn, 0] });
    }
    for shape in ["ball", "crate"] {
        layers["instances"].as_object_mut().expect("a map").remove(shape);
    }
    check("blend/three_panes_that_cross_are_sorted_by_pixel", &layers);

    let mut glass = still_life();
    glass["materials"]["teal"] = json!({ "diffuse": "#16a085", "opacity": 0.4, "double_sided": true,
        "specular": [0.6, 0.6, 0.6], "shininess": 60 });
    glass["instances"]["ball"]["translation"] = json!([0.6, 0.5, -0.3]);
    glass["instances"]["crate"]["scale"] = json!(1.5);
    glass["instances"]["crate"]["translation"] = json!([0.4, 0.61, -0.2]);
    check("blend/a_glass_box_shows_what_is_in_it", &glass);

    let mut clear = still_life();
    clear["instances"] = json!({ "ball": clear["instances"]["ball"] });
    clear["camera"] = json!({ "position": [-0.6, 0.5, 2.4], "target": [-0.6, 0.5, 0.2], "fov_y_deg": 32 });
    clear["materials"]["red"]["opacity"] = json!(0.6);
    clear["environment"]["background"] = json!({ "type": "transparent" });
    clear["render"] = json!({ "width": 64, "height": 64, "samples": 4 });
    check("blend/a_clear_ball_on_a_transparent_background", &clear);
}

#[test]
fn golden_opacity_map() {
    let mut document = still_life();
    document["textures"]["fade"] = json!({ "file": "fade.png" });
    document["materials"]["pane"] =
        json!({ "diffuse": "#f0b030", "opacity_map": "fade", "double_sided": true });
    document["meshes"]["pane"] = json!({ "type": "plane", "size": [2.2, 1.2] });
    document["instances"]["pane"] = json!({ "mesh": "pane", "material": "pane", "translation": [0.1, 0.6, 0.8], "rotation_deg": [90, 0, 0] });
    // Clear on the left, with three solid bars.
    let part = |n: u32| u8::try_from(n * 255 / 63).expect("64 texels");
    let bar = |y: u32| y % 24 / 4 == 2;
    let fade = file("fade.png", png(64, 64, |x, y| [if bar(y) { 255 } else { part(x) }, 40, 90, 255]));
    let frame = draw(&document, &fade, &FrameRequest::default());
    assert_golden("blend/an_opacity_map_fades_a_pane_between_bars", &frame);
}

/// Two round holes and a ragged outline.
fn leaf(x: u32, y: u32) -> [u8; 4] {
    let (u, v) = (f64::from(x) / 31.5 - 1.0, f64::from(y) / 31.5 - 1.0);
    let hole = |cx: f64, cy: f64| (u - cx).hypot(v - cy) < 0.17;
    let wide = 0.75 * (1.0 - v * v) + 0.06 * f64::from(y % 8 / 4);
    let vein = u.abs() < 0.04 || ((v + u.abs()) * 5.0).rem_euclid(1.0) < 0.12;
    let is_there = u.abs() < wide && !hole(0.3, 0.2) && !hole(-0.25, -0.3);
    let [r, g, b] = if vein { [150, 190, 60] } else { [60, 130, 40] };
    [r, g, b, if is_there { 255 } else { 0 }]
}

#[test]
fn golden_cut_outs() {
    let mut document = still_life();
    document["textures"]["leaf"] = json!({ "file": "leaf.png" });
    document["materials"]["leaf"] =
        json!({ "diffuse": [1, 1, 1], "diffuse_map": "leaf", "alpha_cutoff": 0.5, "double_sided": true });
    document["meshes"]["leaf"] = json!({ "type": "plane", "size": [1.3, 1.3] });
    document["instances"] = json!({ "floor": document["instances"]["floor"] });
    document["instances"]["leaf"] = json!({ "mesh": "leaf", "material": "leaf", "translation": [0.3, 0.75, 0.2],
        "rotation_deg": [40, 20, -20] });
    document["lights"]["sun"]["direction"] = json!([-1, -0.9, 0.15]);
    document["lights"]["sun"]["shadow"]["resolution"] = json!(1024);
    document["render"] = json!({ "width": 128, "height": 96, "samples": 4 });
    let files = file("leaf.png", png(64, 64, leaf));
    let frame = draw(&document, &files, &FrameRequest::default());
    assert_golden("cut_out/a_leaf_and_its_shadow_have_holes", &frame);
}

#[test]
fn golden_backgrounds() {
    let sky = json!({ "lights": {}, "render": { "width": 64, "height": 64 },
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1], "fov_y_deg": 150 } });
    check("sky/a_gradient_from_below_to_above", &sky);
}

/// A still life with effects. Its sun is so bright that highlights and white tiles are beyond 1.
#[track_caller]
fn check_post(name: &str, post: Value, changes: impl FnOnce(&mut Value)) {
    let mut document = still_life();
    document["lights"]["sun"]["intensity"] = json!(2.2);
    document["post"] = post;
    changes(&mut document);
    check(&format!("post/{name}"), &document);
}

#[test]
fn golden_post_pointwise() {
    let show = |name, effect: Value| check_post(name, json!([effect]), |_| ());
    show("aces_keeps_bright_tiles_apart", json!({ "type": "tonemap" }));
    show("reinhard_never_reaches_white", json!({ "type": "tonemap", "operator": "reinhard" }));
    show("exposure_alone_darkens", json!({ "type": "tonemap", "operator": "none", "exposure": 0.3 }));
    show("grey", json!({ "type": "grayscale" }));
    show("a_vignette_darkens_the_corners", json!({ "type": "vignette", "amount": 0.9 }));
    let swap = [[0, 0, 1, 0], [0, 1, 0, 0], [1, 0, 0, 0]];
    show("a_matrix_swaps_red_and_blue", json!({ "type": "color_matrix", "matrix": swap }));
}

#[test]
fn golden_post_with_neighbours() {
    let show = |name, effect: Value| check_post(name, json!([effect]), |_| ());
    show("a_blur_of_four_pixels", json!({ "type": "blur" }));
    show("sharper", json!({ "type": "sharpen", "amount": 1.5 }));
    show("a_kernel_embosses", json!({ "type": "kernel", "kernel": [[-2, -1, 0], [-1, 1, 1], [0, 1, 2]] }));
    let lamp = |document: &mut Value| {
        document["instances"].as_object_mut().expect("instances").remove("floor");
        document["environment"]["background"] = json!({ "type": "color", "color": "#181818" });
        document["materials"]["teal"]["emissive"] = json!([2.5, 1.4, 0.2]);
    };
    check_post("what_is_bright_glows", json!([{ "type": "bloom", "intensity": 0.8, "radius": 12 }]), lamp);
    let one_sample = |document: &mut Value| document["render"]["samples"] = json!(1);
    check_post("without_fxaa_edges_are_stairs", json!([{ "type": "tonemap" }]), one_sample);
    check_post("fxaa_smooths_the_stairs", json!([{ "type": "tonemap" }, { "type": "fxaa" }]), one_sample);
    let before_nothing = |document: &mut Value| {
        document["instances"].as_object_mut().expect("instances").remove("floor");
        document["environment"]["background"] = json!({ "type": "transparent" });
    };
    let tonemapped = json!([{ "type": "tonemap" }, { "type": "blur" }]);
    check_post("a_blurred_silhouette_fades_into_nothing", tonemapped, before_nothing);
}

/// A procedural sky with its sun at an elevation, over the still life.
fn under_a_sky(elevation_deg: f64, turbidity: f64) -> Value {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let travels = json!([-0.45 * cos, -sin, 0.893 * cos]);
    let mut document = still_life();
    document["lights"]["sun"]["direction"] = travels;
    document["environment"]["background"] = json!({ "type": "sky", "turbidity": turbidity });
    document["camera"] = json!({ "position": [0.2, 0.9, 3.4], "target": [0.1, 1.15, 0], "fov_y_deg": 60 });
    document["render"] = json!({ "width": 160, "height": 120, "samples": 4 });
    document
}

#[test]
fn golden_skies() {
    check("sky/a_clear_noon", &under_a_sky(55.0, 2.5));
    check("sky/a_low_sun", &under_a_sky(7.0, 3.0));
    check("sky/dusk", &under_a_sky(-3.0, 3.0));
}

/// A face with its direction's colour, a frame of its own, and a white corner where s = t = 0.
fn marked_face(face: usize) -> Vec<u8> {
    let color = [[200, 60, 60], [90, 30, 30], [70, 180, 80], [30, 80, 40], [70, 90, 210], [30, 40, 95]][face];
    png(32, 32, |x, y| {
        let rim = x < 2 || y < 2 || x > 29 || y > 29;
        let [r, g, b] = if x < 10 && y < 10 { [255; 3] } else { color };
        if rim { [r / 2 + 60, g / 2 + 60, b / 2 + 60, 255] } else { [r, g, b, 255] }
    })
}

/// Continents of noise are not needed to see where a panorama lies: a graticule, red to the right.
fn graticule(x: u32, y: u32) -> [u8; 4] {
    let part = |n: u32, of: u32| u8::try_from(30 + 200 * n / of).expect("below 256");
    if x % 32 < 2 || y % 32 < 2 { [250, 250, 240, 255] } else { [part(x, 256), part(y, 128), 110, 255] }
}

#[test]
fn golden_surroundings() {
    let mut files = file("graticule.png", png(256, 128, graticule));
    let mut faces = json!({});
    for (face, name) in ["px", "nx", "py", "ny", "pz", "nz"].into_iter().enumerate() {
        faces[name] = json!(name);
        files.insert(name, marked_face(face).into()).expect("a sound name");
    }
    let document = json!({
        "camera": { "position": [0, 0, 0], "target": [0.6, 0.4, -1], "fov_y_deg": 110 },
        "environment": { "background": "cube", "backgrounds": {
            "around": { "type": "equirect", "file": "graticule.png" },
            "cube": { "type": "cubemap", "faces": faces },
        } },
        "lights": {},
        "render": { "width": 128, "height": 96, "samples": 1 },
    });
    assert_golden("sky/a_cube_map", &draw(&document, &files, &FrameRequest::default()));
    let background = Some(BackgroundRequest::Named("around".to_owned()));
    let chosen = FrameRequest { background, ..FrameRequest::default() };
    assert_golden("sky/a_panorama_chosen_by_query", &draw(&document, &files, &chosen));
    let eye = Some(glam::DVec3::ZERO);
    let up = FrameRequest { eye, target: Some(glam::DVec3::new(0.05, 1.0, -0.02)), ..chosen };
    assert_golden("sky/the_pole_of_a_panorama", &draw(&document, &files, &up));
}

#[test]
fn golden_outputs() {
    let mut document = still_life();
    document["camera"]["far"] = json!(9);
    let outputs = [
        ("depth", Output::Depth),
        ("normal", Output::Normal),
        ("albedo", Output::Albedo),
        ("instance", Output::Instance),
        ("wireframe", Output::Wireframe),
        ("ids", Output::Ids),
        ("tiles", Output::Tiles),
        ("shaded", Output::Shaded),
        ("shadow_map", Output::ShadowMap),
    ];
    for (name, what) in outputs {
        assert_golden(&format!("output/{name}"), &draw(&document, &Files::default(), &output(what)));
    }
    let mut glass = document.clone();
    glass["materials"]["red"]["opacity"] = json!(0.5);
    let shaded = FrameRequest { output: Output::Shaded, ..samples(4) };
    assert_golden("output/shaded_glass", &draw(&glass, &Files::default(), &shaded));
    let lamp = json!({ "type": "point", "position": [-0.2, 1.6, 0.6], "shadow": { "resolution": 256 } });
    let mut lit = document.clone();
    lit["lights"]["lamp"] = lamp;
    let shadow_maps = output(Output::ShadowMap);
    assert_golden("output/shadow_maps_of_two_lights", &draw(&lit, &Files::default(), &shadow_maps));
    document["camera"]["orthographic"] = json!({ "height": 2.6 });
    document["camera"].as_object_mut().expect("a camera").remove("fov_y_deg");
    assert_golden("output/an_orthographic_camera", &draw(&document, &Files::default(), &samples(4)));
}

#[test]
fn golden_gallery() {
    let request = FrameRequest { width: Some(160), height: Some(120), ..FrameRequest::default() };
    for piece in gallery::pieces() {
        let scene = piece.to_scene().compile(&Limits::default()).expect("a scene");
        assert_golden(&format!("gallery/{}", piece.name), &draw_scene(&Arc::new(scene), &request));
    }
}
