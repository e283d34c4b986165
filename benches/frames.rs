//! Whole frames, from the plan to finished pixels in memory, the shadow map redrawn in each.
//!
//! `cargo bench --bench frames` names its inputs: the demo scene, a mesh of many small triangles, and
//! a floor that is all texture.

use criterion::{Criterion, criterion_group, criterion_main};
use rasterd::limits::Limits;
use rasterd::math::simd::Level;
use rasterd::pipeline::{self, Work};
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

fn frames(c: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().build().expect("threads start");
    let cancel = AtomicBool::new(false);
    let work = Work { pool: &pool, cancel: &cancel, level: Level::new() };
    let inputs = [
        ("demo 800x600 x4", compiled(&demo::document(), &demo::files()), 800, 600, 4),
        ("dense 1280x720 x1", compiled(&dense(), &Files::default()), 1280, 720, 1),
        ("floor 1280x720 x1", compiled(&floor(), &Files::default()), 1280, 720, 1),
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
