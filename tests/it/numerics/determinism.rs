//! The same bytes for every number of threads, every SIMD level and every run (B49).

use crate::draw::{file, output, png, pool, samples, scene_with, work_of};
use fearless_simd::Level;
use rasterd::limits::Limits;
use rasterd::pipeline::{self, Pixels};
use rasterd::plan::{FrameRequest, Output, Plan};
use rasterd::scene::{Files, Scene, demo};
use rasterd::settings::Simd;
use serde_json::{Value, json};
use std::sync::Arc;

/// Every SIMD level of this machine, with its name; in a build that carries the scalar one, that alone. Such
/// a build is compiled without optimisation, which takes the compiler a tenth of the time.
pub fn levels() -> Vec<(&'static str, Level)> {
    let names: &[&str] =
        if cfg!(feature = "scalar") { &["scalar"] } else { &["sse2", "sse4.2", "avx2", "avx512", "neon"] };
    names.iter().filter_map(|&name| Some((name, name.parse::<Simd>().ok()?.level()))).collect()
}

/// Numbers of threads to compare.
const THREADS: &[usize] = if cfg!(feature = "scalar") { &[3] } else { &[1, 2, 3, 16] };

fn draw(scene: &Arc<Scene>, request: &FrameRequest, threads: &rayon::ThreadPool, level: Level) -> Pixels {
    let plan = Plan::new(scene, request, &Limits::default()).expect("a plan");
    pipeline::render(&plan, &work_of(threads, level)).expect("nobody cancels").pixels
}

/// Draws with every number of threads at every SIMD level, and compares every byte with what one thread
/// draws at the machine's best.
fn assert_same(case: &str, scene: &Arc<Scene>, requests: &[FrameRequest]) {
    let alone = pool(1);
    let pools: Vec<_> = THREADS.iter().copied().map(pool).collect();
    for request in requests {
        let first = draw(scene, request, &alone, Level::new());
        let mut frames = 0;
        for (name, level) in levels() {
            for threads in &pools {
                let again = draw(scene, request, threads, level);
                let what = request.output;
                assert!(
                    again == first,
                    "{case}, {what:?}: {name} with {} threads",
                    threads.current_num_threads()
                );
                frames += 1;
            }
        }
        println!("B49 {case} {:?}, differing frames of {frames}, 0, 0, inf", request.output);
    }
}

fn sized(width: u32, height: u32, request: FrameRequest) -> FrameRequest {
    FrameRequest { width: Some(width), height: Some(height), ..request }
}

#[test]
fn the_demo_is_the_same_to_the_byte() {
    let scene = scene_with(&demo::document(), &demo::files());
    let requests = [samples(1), samples(4), samples(8)].map(|request| sized(200, 150, request));
    assert_same("demo", &scene, &requests);
}

#[test]
fn data_outputs_are_the_same_to_the_byte() {
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
    assert_same("demo", &scene, &outputs.map(|o| sized(161, 97, output(o))));
}

/// A textured floor to the horizon, boxes with shadows, a mirrored torus, two lights, a gradient.
fn busy(camera: Value) -> Value {
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

fn noise() -> Files {
    let byte = |x: u32, y: u32| u8::try_from((x * x * 7 + y * 13 + x * y) % 256).expect("a byte");
    file("noise.png", png(37, 21, |x, y| [byte(x, y), byte(y, x), byte(x + y, 3), 255]))
}

#[test]
fn textures_shadows_and_samples_are_the_same_to_the_byte() {
    let scene = scene_with(&busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] })), &noise());
    assert_same("perspective", &scene, &[1, 2, 4, 8, 16].map(|n| sized(131, 77, samples(n))));
    let parallel = json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0], "orthographic": { "height": 3 } });
    let scene = scene_with(&busy(parallel), &noise());
    assert_same("orthographic", &scene, &[1, 4].map(|n| sized(131, 77, samples(n))));
}

/// The busy scene with everything transparent in its own way.
fn glassy() -> Value {
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

#[test]
fn transparency_is_the_same_to_the_byte() {
    let scene = scene_with(&glassy(), &noise());
    assert_same("transparency", &scene, &[1, 2, 4, 8, 16].map(|n| sized(131, 77, samples(n))));
    let outputs = [Output::Depth, Output::Normal, Output::Instance];
    assert_same("transparency", &scene, &outputs.map(|o| sized(131, 77, output(o))));
}

#[test]
fn relief_is_the_same_to_the_byte() {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    document["textures"]["bumps"] = json!({ "file": "noise.png", "color_space": "linear" });
    document["materials"]["floor"]["bump_map"] = json!("bumps");
    document["materials"]["floor"]["bump_scale"] = json!(0.2);
    document["materials"]["shiny"]["normal_map"] = json!("bumps");
    document["materials"]["shiny"]["bump_map"] = json!("tiles");
    let scene = scene_with(&document, &noise());
    let requests = [samples(1), samples(4), output(Output::Normal)];
    assert_same("relief", &scene, &requests.map(|request| sized(131, 77, request)));
}

/// B15: which of two coplanar surfaces is seen may be speckled, but not differently every time.
#[test]
fn coplanar_surfaces_are_the_same_to_the_byte() {
    let mut document = busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] }));
    document["meshes"]["patch"] = json!({ "type": "triangles",
        "positions": [[-2, 0, 2], [2, 0, 2.3], [2.2, 0, -2], [-1.9, 0, -2.1]],
        "indices": [[0, 1, 3], [1, 2, 3]] });
    document["materials"]["red"] = json!({ "shading": "unlit", "diffuse": [1, 0, 0] });
    document["instances"]["patch"] = json!({ "mesh": "patch", "material": "red" });
    let scene = scene_with(&document, &noise());
    assert_same("coplanar", &scene, &[1, 4].map(|n| sized(131, 77, samples(n))));
}

#[test]
fn a_frame_is_the_same_in_every_run_and_beside_others() {
    let scene = scene_with(&busy(json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0] })), &noise());
    let request = sized(131, 77, samples(4));
    let shared = pool(3);
    let first = draw(&scene, &request, &shared, Level::new());
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..5 {
                    assert!(draw(&scene, &request, &shared, Level::new()) == first);
                }
            });
        }
    });
}

#[test]
fn the_order_of_names_does_not_show_where_depths_differ() {
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
    let pool = pool(2);
    let one = draw(&scene_with(&document, &noise()), &request, &pool, Level::new());
    let other = draw(&scene_with(&renamed, &noise()), &request, &pool, Level::new());
    assert!(one == other);
}

/// B10: a tile's tail, and pictures of one row or column.
#[test]
fn pictures_of_every_size_are_crops_of_a_larger_one() {
    // Orthographic, a pixel is a fixed length: the smaller picture is the middle of the larger one.
    let at = |width: u32, height: u32| {
        let view = f64::from(height) / 128.0 * 3.0;
        let camera = json!({ "position": [2, 1.5, 3], "target": [0, 0.4, 0], "far": 40, "orthographic": { "height": view } });
        let scene = scene_with(&busy(camera), &noise());
        let pixels = draw(&scene, &sized(width, height, samples(4)), &pool(2), Level::new());
        let Pixels::Rgba8 { pixels, .. } = pixels else { panic!("a picture of values") };
        pixels
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
        assert_eq!(differing.count(), 0, "{w}×{h}");
    }
}
