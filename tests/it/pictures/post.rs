//! `post`: from a document to bytes.

use crate::closed_form::encode;
use crate::draw::{Picture, frame, output, samples, scene};
use crate::measure::Worst;

use rasterd::limits::Limits;
use rasterd::pipeline::Pixels;
use rasterd::plan::{FrameRequest, Output, Plan, PlanError};
use serde_json::{Value, json};

/// A ball and a box before a gradient, some of it far brighter than 1.
fn document(background: &str, post: Value) -> Value {
    json!({
        "camera": { "position": [1.5, 1.2, 2.5], "target": [0, 0, 0], "fov_y_deg": 40 },
        "environment": { "background": { "type": background } },
        "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.6], "intensity": 3 } },
        "textures": { "tiles": { "checker": { "colors": ["#a33", "#eee"], "cells": 4 } } },
        "materials": {
            "shiny": { "diffuse": [0.7, 0.3, 0.1], "specular": [2, 2, 2], "shininess": 30 },
            "tiled": { "diffuse": [1, 1, 1], "diffuse_map": "tiles" },
        },
        "meshes": { "ball": { "type": "sphere", "radius": 0.6 }, "box": { "type": "box", "size": [2, 0.2, 2] } },
        "instances": {
            "ball": { "mesh": "ball", "material": "shiny" },
            "box": { "mesh": "box", "material": "tiled", "translation": [0, -0.8, 0] },
        },
        "post": post,
        "render": { "width": 101, "height": 75, "samples": 4 },
    })
}

fn bytes(document: &Value) -> Vec<[u8; 4]> {
    Picture::of(document).pixels
}

/// What the same document shows before `post`: straight colour and alpha.
fn radiance(document: &Value) -> Vec<[f32; 4]> {
    match frame(&scene(document), &output(Output::Radiance)).pixels {
        Pixels::Rgba32F { pixels, .. } => pixels,
        _ => panic!("asked for radiance"),
    }
}

/// The largest number of codes by which a picture misses what `f` makes of its radiance. `f` gets
/// straight colour, column and row.
fn codes_off(document: &Value, f: impl Fn([f64; 3], f64, f64) -> [f64; 3]) -> f64 {
    let codes = bytes(document);
    let pixels = radiance(document).into_iter().zip(codes).zip(0u32..);
    let off = pixels.filter(|((linear, _), _)| linear[3] > 0.0).map(|((linear, code), i)| {
        let [r, g, b, _] = linear.map(f64::from);
        let expected = f([r, g, b], f64::from(i % 101), f64::from(i / 101));
        let off = |c: usize| (255.0 * encode(expected[c].clamp(0.0, 1.0)) - f64::from(code[c])).abs();
        off(0).max(off(1)).max(off(2))
    });
    off.collect::<Worst>().largest()
}

fn aces(x: f64) -> f64 {
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Half a code, and the share of f32 that encoding makes visible.
const NEAREST: f64 = 0.501;

#[test]
fn pointwise_effects_meet_their_formulas_in_every_pixel() {
    for background in ["gradient", "transparent"] {
        let drawn = |post: Value| document(background, post);
        let aces_of = |c: [f64; 3], _, _| c.map(|x| aces(1.7 * x));
        let off = codes_off(&drawn(json!([{ "type": "tonemap", "exposure": 1.7 }])), aces_of);
        assert!(off <= NEAREST, "aces, {background}: {off}");

        let reinhard = json!([{ "type": "tonemap", "operator": "reinhard", "exposure": 0.4 }]);
        let off = codes_off(&drawn(reinhard), |c, _, _| c.map(|x| 0.4 * x / (1.0 + 0.4 * x)));
        assert!(off <= NEAREST, "reinhard, {background}: {off}");

        let grey = json!([{ "type": "grayscale", "amount": 0.6 }]);
        let off = codes_off(&drawn(grey), |c, _, _| c.map(|x| 0.4 * x + 0.6 * luminance(c)));
        assert!(off <= NEAREST, "grayscale, {background}: {off}");

        let vignette = json!([{ "type": "vignette", "amount": 0.9 }]);
        let off = codes_off(&drawn(vignette), |c, x, y| {
            let (dx, dy) = (x + 0.5 - 50.5, y + 0.5 - 37.5);
            c.map(|v| v * (1.0 - 0.9 * (dx * dx + dy * dy) / (50.5 * 50.5 + 37.5 * 37.5)))
        });
        assert!(off <= NEAREST, "vignette, {background}: {off}");

        let matrix = json!([{ "type": "color_matrix",
            "matrix": [[0, 1, 0, 0.1], [-0.3, 0, 1, 0], [0.5, 0.5, 0, 0]] }]);
        let mixed = |[r, g, b]: [f64; 3], _, _| [g + 0.1, b - 0.3 * r, 0.5 * r + 0.5 * g];
        let off = codes_off(&drawn(matrix), mixed);
        assert!(off <= NEAREST, "colour matrix, {background}: {off}");
    }
}

#[test]
fn effects_come_in_the_order_of_the_document() {
    let dim = json!({ "type": "color_matrix", "matrix": [[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.5, 0]] });
    let tonemap = json!({ "type": "tonemap" });
    let before = document("gradient", json!([dim, tonemap]));
    let after = document("gradient", json!([tonemap, dim]));
    assert!(codes_off(&before, |c, _, _| c.map(|x| aces(0.5 * x))) <= NEAREST);
    assert!(codes_off(&after, |c, _, _| c.map(|x| 0.5 * aces(x))) <= NEAREST);
    let blur = json!({ "type": "blur", "radius": 3 });
    let order = |post: Value| bytes(&document("gradient", post));
    assert!(order(json!([blur, tonemap])) != order(json!([tonemap, blur])));
}

#[test]
fn neutral_effects_leave_the_bytes() {
    for background in ["gradient", "transparent"] {
        let plain = bytes(&document(background, json!([])));
        let neutral = json!([
            { "type": "blur", "radius": 0 }, { "type": "grayscale", "amount": 0 },
            { "type": "vignette", "amount": 0 }, { "type": "bloom", "intensity": 0 },
            { "type": "sharpen", "amount": 0 }, { "type": "tonemap", "operator": "none" },
            { "type": "color_matrix", "matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] },
            { "type": "kernel", "kernel": [[1]] },
        ]);
        for effect in neutral.as_array().expect("a list") {
            assert!(bytes(&document(background, json!([effect]))) == plain, "{effect}, {background}");
        }
        assert!(bytes(&document(background, neutral)) == plain);
    }
}

/// D18: steps that run in the tiles, after a pass, between two passes and before the encoding, beside
/// a pass that keeps every bit (its second weight is too small to be seen).
#[test]
fn steps_give_the_same_bytes_wherever_they_run() {
    let keep = json!({ "type": "kernel", "kernel": [[0, 0, 0], [0, 1, 1e-30], [0, 0, 0]] });
    let steps = json!([
        { "type": "vignette" }, { "type": "tonemap", "exposure": 1.3 }, { "type": "grayscale", "amount": 0.3 },
        { "type": "color_matrix", "matrix": [[1, 0.1, 0, 0.01], [0, 0.9, 0, 0], [0.2, 0, 0.8, 0]] },
    ]);
    let steps = steps.as_array().expect("a list");
    let fused = bytes(&document("gradient", json!(steps)));
    for places in [vec![0], vec![4], vec![2], vec![0, 1, 2, 3, 4], vec![1, 1, 3]] {
        let mut chain = steps.clone();
        for place in places.iter().rev() {
            chain.insert(*place, keep.clone());
        }
        assert!(bytes(&document("gradient", json!(chain))) == fused, "passes before steps {places:?}");
    }
}

#[test]
fn no_alpha_but_a_blurs_is_another() {
    let alpha = |post: Value| -> Vec<u8> {
        bytes(&document("transparent", post)).into_iter().map(|pixel| pixel[3]).collect()
    };
    let plain = alpha(json!([]));
    for effect in [
        json!({ "type": "tonemap" }),
        json!({ "type": "bloom", "threshold": 0.5, "intensity": 2 }),
        json!({ "type": "sharpen" }),
        json!({ "type": "fxaa" }),
        json!({ "type": "kernel", "kernel": [[0, 1, 0], [1, 1, 1], [0, 1, 0]] }),
        json!({ "type": "color_matrix", "matrix": [[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1]] }),
    ] {
        assert!(alpha(json!([effect])) == plain, "{effect}");
    }
    assert!(alpha(json!([{ "type": "blur" }])) != plain);
}

#[test]
fn a_blurred_silhouette_keeps_its_straight_colour() {
    let mut document = document("transparent", json!([{ "type": "blur", "radius": 6 }]));
    document["materials"] = json!({ "shiny": { "shading": "unlit", "diffuse": "#c86432" }, "tiled": { "shading": "unlit", "diffuse": "#c86432" } });
    let pixels = bytes(&document);
    let seen: Vec<_> = pixels.iter().filter(|pixel| pixel[3] > 8).collect();
    assert!(seen.iter().any(|pixel| pixel[3] < 128));
    assert!(seen.iter().all(|pixel| pixel[..3] == [0xc8, 0x64, 0x32]));
    assert!(
        pixels.iter().all(|pixel| pixel[3] > 0 || pixel[..3] == [0; 3] || pixel[..3] == [0xc8, 0x64, 0x32])
    );
}

#[test]
fn data_outputs_know_no_post() {
    for what in [Output::Normal, Output::Albedo, Output::Depth, Output::Instance] {
        let draw = |post: Value| frame(&scene(&document("gradient", post)), &output(what)).pixels;
        assert!(draw(json!([{ "type": "blur" }, { "type": "tonemap" }])) == draw(json!([])), "{what:?}");
    }
}

#[test]
fn post_is_a_pass_of_its_own_only_where_neighbours_count() {
    let passes = |post: Value| -> Vec<&str> {
        let frame = frame(&scene(&document("gradient", post)), &samples(1));
        frame.timings.iter().map(|(pass, _)| pass).collect()
    };
    assert!(!passes(json!([{ "type": "tonemap" }, { "type": "vignette" }])).contains(&"post"));
    assert_eq!(passes(json!([{ "type": "tonemap" }, { "type": "fxaa" }])).last(), Some(&"post"));
}

#[test]
fn the_planes_of_a_chain_count_as_working_memory() {
    let planned = |post: Value, frame_bytes: u64| {
        let limits = Limits { frame_bytes, ..Limits::default() };
        Plan::new(&scene(&document("gradient", post)), &FrameRequest::default(), &limits)
    };
    let too_large =
        |error: PlanError| matches!(error, PlanError::TooLarge { limit, value, .. } if value > limit);
    let needed = |post: Value| {
        let (mut low, mut high) = (0u64, 1 << 30);
        while low + 1 < high {
            let middle = low.midpoint(high);
            match planned(post.clone(), middle) {
                Ok(_) => high = middle,
                Err(error) => {
                    assert!(too_large(error));
                    low = middle;
                }
            }
        }
        high
    };
    let plane = 128 * 75 * 4;
    let plain = needed(json!([{ "type": "tonemap" }]));
    assert_eq!(needed(json!([{ "type": "blur" }])) - plain, 4 * plane);
    assert_eq!(needed(json!([{ "type": "blur" }, { "type": "fxaa" }])) - plain, 5 * plane);
}

#[test]
fn pictures_of_one_row_or_column_go_through_every_effect() {
    let chain = json!([
        { "type": "blur" }, { "type": "bloom", "threshold": 0.1 }, { "type": "sharpen" }, { "type": "fxaa" },
        { "type": "kernel", "kernel": [[0, 0.2, 0], [0.2, 0.2, 0.2], [0, 0.2, 0]] }, { "type": "vignette" },
    ]);
    for background in ["gradient", "transparent"] {
        let scene = scene(&document(background, chain.clone()));
        for (width, height) in [(1, 1), (1, 70), (70, 1), (2, 3), (33, 17)] {
            let request =
                FrameRequest { width: Some(width), height: Some(height), ..FrameRequest::default() };
            let picture = Picture::new(frame(&scene, &request));
            assert_eq!(picture.pixels.len(), (width * height) as usize);
        }
    }
}
