//! Draws a scene document with nothing but the library: `cargo run --release --example still`.
//!
//! Document → scene → plan → frame → PNG, the way of every frame, without server or command line.

use rasterd::encode;
use rasterd::limits::Limits;
use rasterd::math::simd::Level;
use rasterd::pipeline::{self, Order, Work};
use rasterd::plan::{FrameRequest, Plan};
use rasterd::scene::{self, Document, Files};
use serde_json::json;
use std::error::Error;
use std::sync::{Arc, atomic::AtomicBool};

fn main() -> Result<(), Box<dyn Error>> {
    let json = json!({
        "camera": { "position": [2.2, 1.6, 3.2], "target": [0, 0.45, 0], "fov_y_deg": 32 },
        "textures": { "tiles": { "checker": { "colors": ["#7d8790", "#e8e4da"], "cells": 8 } } },
        "materials": {
            "floor": { "diffuse_map": "tiles" },
            "copper": { "diffuse": "#c8643c", "specular": [0.5, 0.4, 0.35], "shininess": 60, "double_sided": true },
        },
        "meshes": { "floor": { "type": "plane", "size": [8, 8] }, "pot": { "type": "teapot", "segments": 16 } },
        "instances": {
            "floor": { "mesh": "floor", "material": "floor" },
            "pot": { "mesh": "pot", "material": "copper", "translation": [0, 0.5, 0], "rotation_deg": [0, 25, 0] },
        },
        "lights": { "sun": { "type": "directional", "direction": [-0.6, -1, -0.5], "intensity": 1.1, "shadow": { "filter": "hard" } } },
    });
    let limits = Limits::default();
    let document = Document::from_json(&json).map_err(|faults| format!("{faults:?}"))?;
    let scene = Arc::new(scene::compile(&document, &Files::default(), None, &limits)?.scene);

    let request =
        FrameRequest { width: Some(640), height: Some(420), samples: Some(8), ..FrameRequest::default() };
    let plan = Plan::new(&scene, &request, &limits)?;
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let frame = pipeline::render(&plan, &work)?;

    std::fs::write("still.png", encode::png(&frame))?;
    for (pass, milliseconds) in frame.timings.iter() {
        println!("{pass:>8} {milliseconds:6.2} ms");
    }
    println!("wrote still.png");
    Ok(())
}
