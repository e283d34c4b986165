//! Knobs of a frame: more or less work than the scene asks for.

use crate::draw::{Picture, frame, output, plan, scene, scene_with};
use rasterd::model::Filter;
use rasterd::pipeline::{Frame, Pixels};
use rasterd::plan::{FrameRequest, Knobs, Output};
use rasterd::scene::demo;
use serde_json::{Value, json};

fn turned(knobs: Knobs) -> FrameRequest {
    FrameRequest { knobs, ..FrameRequest::default() }
}

/// A ball on a checkered floor, with a lamp's shadow.
fn ball(shadow: Value, filter: &str) -> Value {
    json!({
        "camera": { "position": [2, 1.5, 3], "target": [0, 0.3, 0] },
        "lights": {
            "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "shadow": shadow },
            "lamp": { "type": "point", "position": [1, 2, 1], "shadow": shadow },
        },
        "textures": { "tiles": { "checker": { "cells": 16 }, "filter": filter } },
        "materials": { "floor": { "diffuse_map": "tiles" } },
        "meshes": { "floor": { "type": "plane", "size": [6, 6] }, "ball": { "type": "sphere" } },
        "instances": { "floor": { "mesh": "floor", "material": "floor" }, "ball": { "mesh": "ball", "translation": [0, 0.5, 0] } },
        "render": { "width": 160, "height": 120 },
    })
}

/// A knob gives the picture of a document that says the same itself.
#[track_caller]
fn assert_as_if_the_document_said_so(plain: &Value, said: &Value, knobs: Knobs) {
    let plain = scene(plain);
    let by_knob = Picture::new(frame(&plain, &turned(knobs)));
    assert!(by_knob == Picture::of(said), "{knobs:?}: another picture");
    assert!(by_knob != Picture::new(frame(&plain, &FrameRequest::default())), "{knobs:?} changes nothing");
    let tag = |request| plan(&plain, &request).etag();
    assert_ne!(tag(turned(knobs)), tag(FrameRequest::default()), "{knobs:?}: the same tag");
}

#[test]
fn shadows_take_the_texels_and_taps_that_are_asked_for() {
    let pcf = |resolution, taps| {
        ball(json!({ "filter": "pcf", "radius": 3, "resolution": resolution, "pcf_taps": taps }), "trilinear")
    };
    let resolution = Knobs { shadow_resolution: Some(64), ..Knobs::default() };
    assert_as_if_the_document_said_so(&pcf(512, 16), &pcf(64, 16), resolution);
    let taps = Knobs { pcf_taps: Some(3), ..Knobs::default() };
    assert_as_if_the_document_said_so(&pcf(512, 16), &pcf(512, 3), taps);
    let pcss = |search, filter| {
        let shadow =
            json!({ "filter": "pcss", "light_radius": 0.1, "search_taps": search, "filter_taps": filter });
        ball(shadow, "trilinear")
    };
    let search = Knobs { search_taps: Some(4), ..Knobs::default() };
    assert_as_if_the_document_said_so(&pcss(18, 36), &pcss(4, 36), search);
    let filter = Knobs { filter_taps: Some(5), ..Knobs::default() };
    assert_as_if_the_document_said_so(&pcss(18, 36), &pcss(18, 5), filter);
}

#[test]
fn textures_are_sampled_as_asked() {
    let hard = json!({ "filter": "hard" });
    for (word, filter) in [("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)] {
        let knobs = Knobs { texture_filter: Some(filter), ..Knobs::default() };
        assert_as_if_the_document_said_so(&ball(hard.clone(), "trilinear"), &ball(hard.clone(), word), knobs);
    }
}

fn scaled(scale: f64, request: FrameRequest) -> FrameRequest {
    FrameRequest { knobs: Knobs { render_scale: Some(scale), ..request.knobs }, ..request }
}

fn radiance(frame: Frame) -> Vec<[f32; 4]> {
    let Pixels::Rgba32F { pixels, .. } = frame.pixels else { panic!("no radiance") };
    pixels
}

/// One pixel drawn as four is their mean.
#[test]
fn a_picture_of_twice_the_scale_is_the_mean_of_four_pixels() {
    let scene = scene_with(&demo::document(), &demo::files());
    let size =
        |width, height| FrameRequest { width: Some(width), height: Some(height), ..output(Output::Radiance) };
    let large = radiance(frame(&scene, &size(160, 120)));
    let small = radiance(frame(&scene, &scaled(2.0, size(80, 60))));
    for (at, pixel) in small.iter().enumerate() {
        let (x, y) = (at % 80, at / 80);
        for channel in 0..3 {
            let four = [0, 1, 160, 161].map(|step| f64::from(large[y * 320 + x * 2 + step][channel]));
            let mean = four.iter().sum::<f64>() / 4.0;
            assert!((f64::from(pixel[channel]) - mean).abs() <= 4e-7 * mean.max(1e-3), "{x}, {y}: {pixel:?}");
        }
    }
}

#[test]
fn a_picture_of_more_scale_is_nearer_to_the_truth() {
    let plain = scene(&ball(json!({ "filter": "hard" }), "trilinear"));
    let sampled = |samples| FrameRequest { samples: Some(samples), ..FrameRequest::default() };
    let truth = Picture::new(frame(&plain, &scaled(4.0, sampled(16))));
    let error = |scale| {
        let drawn = Picture::new(frame(&plain, &scaled(scale, sampled(1))));
        assert_eq!((drawn.width, drawn.height), (160, 120));
        let apart = truth.pixels.iter().flatten().zip(drawn.pixels.iter().flatten());
        apart.map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>()
    };
    let errors = [0.1, 0.33, 0.5, 1.0, 1.7, 4.0].map(error);
    assert!(errors.is_sorted_by(|more, less| more > less), "{errors:?}");
}

#[test]
fn a_scale_of_one_changes_nothing() {
    let plain = scene(&ball(json!({ "filter": "hard" }), "trilinear"));
    let full = Picture::new(frame(&plain, &FrameRequest::default()));
    assert!(full == Picture::new(frame(&plain, &scaled(1.0, FrameRequest::default()))));
}

/// An even picture stays even, and effects reach as far in it as they do at its own size.
#[test]
fn effects_of_a_scaled_picture_are_scaled_with_it() {
    let blurred = |radius: f64| {
        let mut document = ball(json!({ "filter": "hard" }), "trilinear");
        document["post"] = json!([{ "type": "blur", "radius": radius }]);
        scene(&document)
    };
    let differences = |radius: f64| {
        let full = Picture::new(frame(&blurred(8.0), &FrameRequest::default()));
        let half = Picture::new(frame(&blurred(radius), &scaled(0.5, FrameRequest::default())));
        let apart = full.pixels.iter().flatten().zip(half.pixels.iter().flatten());
        apart.map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>()
    };
    assert!(2 * differences(8.0) < differences(4.0).min(differences(16.0)));
}

#[test]
fn glass_before_nothing_is_resampled_without_a_dark_rim() {
    let document = json!({
        "environment": { "background": { "type": "transparent" }, "ambient": [1, 1, 1] },
        "camera": { "position": [0, 0, 3] },
        "lights": {},
        "materials": { "white": { "diffuse": [1, 1, 1], "shading": "unlit" } },
        "meshes": { "ball": { "type": "sphere" } },
        "instances": { "ball": { "mesh": "ball", "material": "white" } },
        "render": { "width": 64, "height": 64 },
    });
    let picture = Picture::new(frame(&scene(&document), &scaled(0.5, FrameRequest::default())));
    let mut partial = 0;
    for (x, y, [r, g, b, alpha]) in picture.iter() {
        if alpha > 0 {
            assert!(r >= 254 && g >= 254 && b >= 254, "{x}, {y}: {r} {g} {b} of alpha {alpha}");
            partial += usize::from(alpha < 255);
        }
    }
    assert!(partial > 50, "{partial} pixels of the rim");
}

#[test]
fn data_is_drawn_at_the_size_of_the_picture() {
    let plain = scene(&ball(json!({ "filter": "hard" }), "trilinear"));
    for data in [Output::Depth, Output::Instance, Output::Normal] {
        let plan = plan(&plain, &scaled(0.5, output(data)));
        assert!(!plan.is_resampled());
        assert!(plan.left_out.iter().any(|left| left.part.describe(&plain) == "render scale"), "{data:?}");
    }
}
