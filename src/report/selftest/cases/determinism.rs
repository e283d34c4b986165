//! The same bytes for every number of threads, every SIMD level, every order of tiles and every run (B49).

use crate::pipeline::Order;
use crate::plan::request::{BackgroundRequest, Knobs};
use crate::plan::{Filter, FrameRequest, Output};
use crate::report::selftest::instruments::draw::{
    Picture, bytes_of, file, frame, levels, output, plan, png, samples, scene_with,
};
use crate::report::selftest::instruments::engine::Engine;
use crate::report::selftest::run::measure;
use crate::report::selftest::{CASES, Case, Effort, Ledger};
use crate::scene::{Files, Scene, demo};
use serde_json::{Value, json};
use std::sync::Arc;

/// Numbers of threads to compare.
const THREADS: [usize; 5] = [1, 2, 3, 7, 16];

/// Orders of tiles to compare.
const ORDERS: [Order; 4] = [Order::Rows, Order::Morton, Order::Shuffled(0x49), Order::Shuffled(0x94)];

/// Every engine that may not show.
fn matrix() -> Vec<(String, Engine)> {
    let mut engines = Vec::new();
    for (name, level) in levels() {
        for threads in THREADS {
            for order in ORDERS {
                let setting = format!("{name}, {threads} threads, {order:?}");
                engines.push((setting, Engine { threads, level, order, ..Engine::current() }));
            }
        }
    }
    engines
}

/// From an engine of the matrix to one with other threads and another order, and mostly another level. There
/// are 20 engines a level, with no factor in common: every one is met in the end.
const STRIDE: usize = 13;

/// What part of the matrix a quick run draws with: one engine a stride, from another one on for each picture
/// of a scene, so that few of them meet all of its rows and columns. In a build that carries the scalar level,
/// which is compiled without optimisation, one engine a picture.
const SAMPLED: usize = if cfg!(feature = "scalar") { 20 } else { STRIDE };

/// One thread, at the SIMD level of the run.
fn alone() -> Engine {
    Engine { threads: 1, order: Order::Rows, ..Engine::current() }
}

fn draw(scene: &Arc<Scene>, request: &FrameRequest) -> Vec<u8> {
    bytes_of(&frame(scene, request).pixels)
}

/// Draws with the engines of the matrix, and compares every byte with what one thread draws row by row.
fn all_the_same(ledger: &mut Ledger, case: &str, scene: &Arc<Scene>, requests: &[FrameRequest]) {
    let step = ledger.effort.pick(SAMPLED, 1);
    for (at, request) in requests.iter().enumerate() {
        let first = alone().drive(|| draw(scene, request));
        for (setting, engine) in matrix().into_iter().skip(at % step).step_by(step) {
            let is_same = engine.drive(|| draw(scene, request)) == first;
            let setting = format!("{case}, {:?}: {setting}", request.output);
            ledger.holds(&setting, "frames of other bytes", is_same);
        }
    }
}

fn sized(width: u32, height: u32, request: FrameRequest) -> FrameRequest {
    FrameRequest { width: Some(width), height: Some(height), ..request }
}

pub fn the_demo_is_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&demo::document(), &demo::files());
    let requests = [samples(1), samples(4), samples(8)].map(|request| sized(200, 150, request));
    all_the_same(ledger, "demo", &scene, &requests);
}

pub fn data_outputs_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&demo::document(), &demo::files());
    let outputs = [
        Output::Depth,
        Output::Normal,
        Output::Albedo,
        Output::Instance,
        Output::Radiance,
        Output::Wireframe,
        Output::Ids,
        Output::ShadowMap,
        Output::Tiles,
        Output::Shaded,
    ];
    all_the_same(ledger, "demo", &scene, &outputs.map(|o| sized(161, 97, output(o))));
}

/// A textured floor to the horizon, boxes with shadows, a mirrored torus, two lights, a gradient.
pub fn busy(camera: Value) -> Value {
    json!({
        "camera": camera,
        "lights": {
            "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "shadow": { "filter": "hard", "resolution": 300 } },
            "side": { "type": "directional", "direction": [0.9, -0.5, -0.2], "color": "#f80", "shadow": { "filter": "hard" } },
            "lamp": { "type": "point", "position": [1, 2, 1], "intensity": 3 },
        },
        "textures": {
            "noise": { "file": "noise.png", "filter": "trilinear", "wrap": "mirror" },
            "tiles": { "checker": { "colors": ["#888", "#eee"], "cells": 8 } },
        },
        "materials": {
            "floor": { "diffuse_map": "tiles" },
            "shiny": { "diffuse_map": "noise", "specular": [0.5, 0.4, 0.3], "shininess": 90.5, "emissive": [0.1, 0, 0] },
        },
        "meshes": {
            "floor": { "type": "plane", "size": [1e4, 1e4], "uv_repeat": [1e3, 1e3] },
            "box": { "type": "box" }, "ring": { "type": "torus" }, "ball": { "type": "sphere" },
        },
        "instances": {
            "floor": { "mesh": "floor", "material": "floor" },
            "box": { "mesh": "box", "material": "shiny", "translation": [0, 0.5, 0], "rotation_deg": [10, 20, 30] },
            "ring": { "mesh": "ring", "material": "shiny", "translation": [1.3, 0.6, 0.2], "scale": [-1, 1, 2] },
            "ball": { "mesh": "ball", "translation": [-1.2, 0.5, 0.4] },
        },
    })
}

pub fn noise() -> Files {
    let byte = |x: u32, y: u32| u8::try_from((x * x * 7 + y * 13 + x * y) % 256).expect("a byte");
    file("noise.png", png(37, 21, |x, y| [byte(x, y), byte(y, x), byte(x + y, 3), 255]))
}

pub fn textures_shadows_and_samples_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] })), &noise());
    all_the_same(ledger, "perspective", &scene, &[1, 2, 4, 8, 16].map(|n| sized(131, 77, samples(n))));
    let parallel = json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0], "orthographic": { "height": 3 } });
    let scene = scene_with(&busy(parallel), &noise());
    all_the_same(ledger, "orthographic", &scene, &[1, 4].map(|n| sized(131, 77, samples(n))));
}

/// The busy scene in soft shadows: of each kind of light one with a kernel of fixed size, and one with an area.
fn softly_lit() -> Value {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    let lights = &mut document["lights"];
    lights["sun"]["shadow"] = json!({ "filter": "pcss", "resolution": 300, "light_radius": 0.05 });
    lights["side"]["shadow"] = json!({ "filter": "pcf", "resolution": 200, "radius": 2.5 });
    lights["lamp"]["shadow"] = json!({ "filter": "pcf", "resolution": 64 });
    lights["bulb"] = json!({ "type": "point", "position": [-1.5, 1.8, 1.2], "intensity": 2,
        "shadow": { "filter": "pcss", "resolution": 64, "light_radius": 0.1 } });
    document
}

pub fn soft_shadows_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&softly_lit(), &noise());
    let of = |what: Output, count: u32| small(&output(what), count);
    let requests =
        [of(Output::Color, 1), of(Output::Color, 8), of(Output::Radiance, 2), of(Output::ShadowMap, 1)];
    let lights = plan(&scene, &requests[0]).shadows;
    let soft = lights.iter().filter(|pass| !matches!(pass.filter, Filter::Hard)).count();
    ledger.holds("soft shadows", "lights without a kernel", soft == 4);
    all_the_same(ledger, "soft shadows", &scene, &requests);
}

pub fn resampled_pictures_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&glassy(), &noise());
    let scaled = |render_scale: f64, what: Output| FrameRequest {
        knobs: Knobs { render_scale: Some(render_scale), ..Knobs::default() },
        background: Some(BackgroundRequest::Transparent),
        ..small(&output(what), 4)
    };
    let requests = [scaled(0.6, Output::Color), scaled(1.7, Output::Color), scaled(0.6, Output::Radiance)];
    let as_drawn = requests.iter().filter(|request| !plan(&scene, request).is_resampled()).count();
    ledger.none_of("resampled", "pictures that are left as they are drawn", as_drawn, requests.len());
    all_the_same(ledger, "resampled", &scene, &requests);
}

/// The busy scene with everything transparent in its own way.
pub fn glassy() -> Value {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    document["materials"]["shiny"]["opacity"] = json!(0.7);
    document["materials"]["shiny"]["double_sided"] = json!(true);
    document["materials"]["leaf"] =
        json!({ "opacity_map": "noise", "alpha_cutoff": 0.4, "double_sided": true });
    document["materials"]["mist"] = json!({ "opacity_map": "noise", "opacity": 0.8 });
    document["instances"]["ball"]["material"] = json!("mist");
    document["instances"]["leaf"] =
        json!({ "mesh": "ball", "material": "leaf", "translation": [0.9, 0.9, 1.0] });
    document
}

pub fn transparency_is_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&glassy(), &noise());
    all_the_same(ledger, "transparency", &scene, &[1, 2, 4, 8, 16].map(|n| sized(131, 77, samples(n))));
    let outputs = [Output::Depth, Output::Normal, Output::Instance];
    all_the_same(ledger, "transparency", &scene, &outputs.map(|o| sized(131, 77, output(o))));
}

pub fn relief_is_the_same_to_the_byte(ledger: &mut Ledger) {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    document["textures"]["bumps"] = json!({ "file": "noise.png", "color_space": "linear" });
    document["materials"]["floor"]["bump_map"] = json!("bumps");
    document["materials"]["floor"]["bump_scale"] = json!(0.2);
    document["materials"]["shiny"]["normal_map"] = json!("bumps");
    document["materials"]["shiny"]["bump_map"] = json!("tiles");
    let scene = scene_with(&document, &noise());
    let requests = [samples(1), samples(4), output(Output::Normal)];
    all_the_same(ledger, "relief", &scene, &requests.map(|request| sized(131, 77, request)));
}

/// B15: which of two coplanar surfaces is seen may be speckled, but not differently every time.
pub fn coplanar_surfaces_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    document["meshes"]["patch"] = json!({ "type": "triangles",
        "positions": [[-2, 0, 2], [2, 0, 2.3], [2.2, 0, -2], [-1.9, 0, -2.1]],
        "indices": [[0, 1, 3], [1, 2, 3]] });
    document["materials"]["red"] = json!({ "shading": "unlit", "diffuse": [1, 0, 0] });
    document["instances"]["patch"] = json!({ "mesh": "patch", "material": "red" });
    let scene = scene_with(&document, &noise());
    all_the_same(ledger, "coplanar", &scene, &[1, 4].map(|n| sized(131, 77, samples(n))));
}

pub fn a_frame_is_the_same_in_every_run_and_beside_others(ledger: &mut Ledger) {
    let scene = scene_with(&busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] })), &noise());
    let request = sized(131, 77, samples(4));
    let engine = Engine { threads: 3, ..Engine::current() };
    let first = alone().drive(|| draw(&scene, &request));
    let runs = || engine.drive(|| (0..5).filter(|_| draw(&scene, &request) != first).count());
    let differing: usize = std::thread::scope(|scope| {
        let beside: Vec<_> = (0..4).map(|_| scope.spawn(runs)).collect();
        beside.into_iter().map(|runs| runs.join().expect("no panics")).sum()
    });
    ledger.none_of("four at a time", "runs of other bytes", differing, 20);
}

/// Frames in f32 before they are encoded, depths, and codes: of one scene all three.
pub fn radiance_depth_and_codes_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let scene = scene_with(&glassy(), &noise());
    let outputs = [Output::Color, Output::Radiance, Output::Depth].map(output);
    let requests = outputs.into_iter().flat_map(|request| [1, 8].map(|n| small(&request, n)));
    all_the_same(ledger, "all at once", &scene, &requests.collect::<Vec<_>>());
}

/// A small picture with so many samples a pixel.
pub fn small(request: &FrameRequest, count: u32) -> FrameRequest {
    sized(131, 77, FrameRequest { samples: Some(count), ..request.clone() })
}

/// Post effects, from the document to the bytes; 8 samples have smaller tiles.
pub fn pictures_with_effects_are_the_same_to_the_byte(ledger: &mut Ledger) {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    document["post"] = json!([
        { "type": "vignette" }, { "type": "bloom" }, { "type": "tonemap" }, { "type": "fxaa" },
        { "type": "blur", "radius": 1.5 }, { "type": "grayscale", "amount": 0.4 },
    ]);
    for (background, count) in [(json!({ "type": "sky" }), 1), (json!({ "type": "transparent" }), 8)] {
        document["environment"]["background"] = background;
        let scene = scene_with(&document, &noise());
        all_the_same(ledger, "effects", &scene, &[small(&output(Output::Color), count)]);
    }
}

/// Cases that a quick run measures with other engines too.
const QUICK: &[&str] = if cfg!(feature = "scalar") { &["B12"] } else { &["B2", "B12", "B14", "B21", "B28"] };

/// Cases to measure with other engines, one after the other. In an exhaustive run those are all, two times, but
/// for the two that compare engines and builds themselves.
fn turns(effort: Effort) -> impl Iterator<Item = &'static Case> {
    let is_measured = move |case: &&Case| match effort {
        Effort::Quick => QUICK.contains(&case.id),
        Effort::Exhaustive => !case.checks.is_empty() && !["B49", "B50"].contains(&case.id),
    };
    std::iter::repeat_n(CASES, effort.pick(1, 2)).flatten().filter(is_measured)
}

/// The catalogue itself, with other engines than that of the run: what holds for one holds for all. Its cases are
/// as large as in a quick run.
pub fn the_catalogue_holds_for_other_engines(ledger: &mut Ledger) {
    let engines = matrix();
    for (turn, case) in turns(ledger.effort).enumerate() {
        let (setting, engine) = &engines[turn * STRIDE % engines.len()];
        let setting = format!("{}, {setting}", case.id);
        for &check in case.checks {
            let rows = engine.drive(|| measure(case.id, check, Effort::Quick));
            let out = rows.iter().filter(|row| row.is_out()).count();
            ledger.none_of(&setting, "measurements out with another engine", out, rows.len());
        }
    }
}

pub fn the_order_of_names_does_not_show_where_depths_differ(ledger: &mut Ledger) {
    let camera = json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] });
    let document = busy(camera);
    let mut renamed = document.clone();
    let instances = document["instances"].as_object().expect("a map");
    let reversed = instances.iter().map(|(name, instance)| {
        let name: String =
            name.chars().map(|c| char::from(b'a' + b'z' - u8::try_from(c).expect("ascii"))).collect();
        (name, instance.clone())
    });
    renamed["instances"] = Value::Object(reversed.collect());
    let request = sized(131, 77, samples(4));
    let [one, other] = [document, renamed].map(|document| draw(&scene_with(&document, &noise()), &request));
    ledger.holds("", "frames that the order of names changes", one == other);
}

/// B10: a tile's tail, and pictures of one row or column.
pub fn pictures_of_every_size_are_crops_of_a_larger_one(ledger: &mut Ledger) {
    // Orthographic, a pixel is a fixed length: the smaller picture is the middle of the larger one.
    let at = |width: u32, height: u32| {
        let view = f64::from(height) / 128.0 * 3.0;
        let camera = json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0], "far": 40, "orthographic": { "height": view } });
        let scene = scene_with(&busy(camera), &noise());
        Picture::new(frame(&scene, &sized(width, height, samples(4)))).pixels
    };
    let (width, height) = (160, 128);
    let large = at(width, height);
    for (w, h) in [(160, 64), (128, 128), (66, 62), (160, 2), (2, 128), (2, 2), (34, 98)] {
        let small = at(w, h);
        let (left, top) = ((width - w) / 2, (height - h) / 2);
        let differing = small
            .iter()
            .zip(0..)
            .filter(|&(pixel, i)| *pixel != large[((top + i / w) * width + left + i % w) as usize]);
        ledger.none_of(&format!("{w} × {h}"), "pixels unlike the larger one", differing.count(), small.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_has_a_turn_in_an_exhaustive_run() {
        let engines = matrix().len();
        let mut met: Vec<usize> =
            (0..turns(Effort::Exhaustive).count()).map(|turn| turn * STRIDE % engines).collect();
        met.sort_unstable();
        met.dedup();
        assert_eq!(met.len(), engines);
    }
}
