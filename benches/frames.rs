//! Whole frames, from the plan to finished pixels in memory, the shadow map redrawn in each.
//!
//! `cargo bench --bench frames` names its inputs: the demo scene, a mesh of many small triangles, a floor
//! that is all texture, and balls in the soft shadows of a lamp.

use criterion::{Criterion, criterion_group, criterion_main};
use rasterd::limits::Limits;
use rasterd::math::simd::Level;
use rasterd::pipeline::{self, Order, Work};
use rasterd::plan::{FrameRequest, Plan};
use rasterd::scene::{self, Document, Files, Scene, demo};
use serde_json::{Value, json};
use std::sync::{Arc, atomic::AtomicBool};

fn compiled(json: &Value, files: &Files) -> Arc<Scene> {
    let document = Document::from_json(json).expect("the document is sound");
    Arc::new(scene::compile(&document, files, None, &Limits::default()).expect("the scene compiles").scene)
}

/// A teapot of 262,000 triangles on a floor.
fn dense() -> Value {
    json!({
        "meshes": { "pot": { "type": "teapot", "segments": 64 }, "floor": { "type": "plane", "size": [6, 6] } },
        "instances": { "pot": { "mesh": "pot", "translation": [0, 0.5, 0] }, "floor": { "mesh": "floor" } },
        "camera": { "position": [1, 1.2, 2.4], "target": [0, 0.45, 0] },
    })
}

/// A checkered floor to the horizon.
fn floor() -> Value {
    json!({
        "textures": { "tiles": { "checker": { "colors": ["#888", "#eee"], "cells": 8 } } },
        "materials": { "floor": { "diffuse_map": "tiles" } },
        "meshes": { "floor": { "type": "plane", "size": [1000, 1000], "uv_repeat": [500, 500] } },
        "instances": { "floor": { "mesh": "floor", "material": "floor" } },
        "camera": { "position": [0, 1, 0], "target": [0, 0.6, -2] },
    })
}

/// Twenty balls of 3024 triangles around a lamp, on a floor.
fn lamp() -> Value {
    let balls = (0..20u32).map(|i| {
        let angle = f64::from(i) * 2.399_963;
        let distance = 0.55 * f64::from(i + 1).sqrt();
        let at = [distance * libm::cos(angle), 0.25, distance * libm::sin(angle)];
        (format!("ball {i}"), json!({ "mesh": "ball", "translation": at }))
    });
    let floor = ("floor".to_owned(), json!({ "mesh": "floor" }));
    json!({
        "meshes": {
            "ball": { "type": "sphere", "radius": 0.25, "segments": 56, "rings": 28 },
            "floor": { "type": "plane", "size": [8, 8] },
        },
        "instances": balls.chain([floor]).collect::<serde_json::Map<_, _>>(),
        "lights": { "lamp": { "type": "point", "position": [0.3, 1.6, 0.2], "intensity": 2,
            "shadow": { "filter": "pcss", "light_radius": 0.12 } } },
        "camera": { "position": [0, 4.2, 4.6], "target": [0, 0.1, 0] },
        "post": [{ "type": "tonemap", "operator": "aces" }],
    })
}

fn frames(c: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().build().expect("threads start");
    let cancel = AtomicBool::new(false);
    let work = Work { pool: &pool, cancel: &cancel, level: Level::new(), order: Order::Rows };
    let inputs = [
        ("demo 800x600 x4", compiled(&demo::document(), &demo::files()), 800, 600, 4),
        ("dense 1280x720 x1", compiled(&dense(), &Files::default()), 1280, 720, 1),
        ("floor 1280x720 x1", compiled(&floor(), &Files::default()), 1280, 720, 1),
        ("lamp 800x800 x1", compiled(&lamp(), &Files::default()), 800, 800, 1),
    ];
    for (name, scene, width, height, samples) in inputs {
        let request = FrameRequest {
            width: Some(width),
            height: Some(height),
            samples: Some(samples),
            ..FrameRequest::default()
        };
        c.bench_function(name, |bencher| {
            bencher.iter(|| {
                let plan = Plan::new(&scene, &request, &Limits::default()).expect("the frame is plannable");
                pipeline::render(&plan, &work)
            });
        });
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
