//! What each elision saves: time, and instructions where valgrind is installed, scene by scene.
//!
//! `cargo run --release --example elisions` prints the tables of `docs/elisions.md`. Times are of one thread,
//! medians of pairs with and without an elision, one after the other; instructions are counted at 1 thread and
//! AVX2, which is what valgrind knows.

use rasterd::limits::Limits;
use rasterd::math::simd::Level;
use rasterd::pipeline::{self, Order, Work};
use rasterd::plan::{Elision, Elisions, FrameRequest, Plan};
use rasterd::scene::{self, Document, Files, Scene, demo, gallery};
use rasterd::settings::Simd;
use serde_json::{Value, json};
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, atomic::AtomicBool};
use std::time::Instant;

/// Rounds of timing; each draws every scene with everything left out and with all but one elision.
const ROUNDS: usize = 15;

/// The picture that is timed, and whose instructions are counted.
const SIZE: [u32; 2] = [320, 240];

/// A name in the table, and the scene.
type Case = (&'static str, Arc<Scene>);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => print_tables(),
        [mode, name] if mode == "count" => draw_each_once(name),
        _ => eprintln!("usage: elisions"),
    }
}

/// What is measured: the demo, soft shadows, paper cranes, a scene that needs next to nothing, the same with its colours
/// graded, one that does not know what it needs, and one whose shadows fall on what is out of sight.
fn cases() -> Vec<Case> {
    let of_gallery = |name: &'static str| {
        let new = gallery::find(name).expect("a piece of the gallery").to_scene();
        (name, Arc::new(new.compile(&Limits::default()).expect("the scene compiles")))
    };
    let grading =
        json!([{ "type": "tonemap" }, { "type": "grayscale", "amount": 0.3 }, { "type": "vignette" }]);
    vec![
        ("demo", compiled(&demo::document(), &demo::files())),
        of_gallery("pcf-pcss"),
        ("cranes", of_gallery("triangles").1),
        ("flat triangle", compiled(&flat(&json!([])), &Files::default())),
        ("graded", compiled(&flat(&grading), &Files::default())),
        ("careless", compiled(&careless(), &Files::default())),
        ("out of sight", compiled(&shadows_out_of_sight(), &Files::default())),
    ]
}

/// One triangle of one colour on black, and what happens to the picture.
fn flat(post: &Value) -> Value {
    json!({
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0] },
        "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
        "materials": { "flat": { "shading": "unlit" } },
        "meshes": { "one": { "type": "triangles", "positions": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]] } },
        "instances": { "one": { "mesh": "one", "material": "flat" } },
        "render": { "samples": 1 },
        "post": post,
    })
}

/// A scene that asks for much that it does not need: lights that are out, a lamp with balls above it that cast their
/// shadows on nothing, a crowd of balls behind the camera, a map of one colour, no highlights, effects of no strength.
fn careless() -> Value {
    let lamp = |z: f64, intensity: f64| json!({ "type": "point", "position": [0.5, 2, z], "intensity": intensity, "shadow": { "resolution": 512 } });
    let ball = |at: [f64; 3]| json!({ "mesh": "ball", "material": "painted", "translation": at });
    let mut document = json!({
        "camera": { "position": [2.5, 1.8, 3.5], "target": [0, 0.4, 0], "fov_y_deg": 35 },
        "lights": { "lamp": lamp(1.5, 3.0), "out": lamp(-1.5, 0.0), "off": lamp(0.0, 0.0),
            "sky": { "type": "directional", "direction": [0.1, -1, 0] }, "fill": { "type": "directional", "direction": [1, -1, -1] } },
        "textures": { "paint": { "checker": { "colors": ["#b07030", "#b07030"], "cells": 1 }, "filter": "nearest" } },
        "materials": { "painted": { "diffuse_map": "paint" } },
        "meshes": { "ball": { "type": "sphere" }, "floor": { "type": "plane", "size": [8, 8] } },
        "instances": { "a": ball([0.0, 0.5, 0.0]), "d": ball([1.7, 0.5, 1.2]), "floor": { "mesh": "floor", "material": "painted" } },
        "post": [{ "type": "blur", "radius": 0 }, { "type": "grayscale", "amount": 0 }],
    });
    for i in 0..6 {
        let x = f64::from(i) * 1.5 - 4.0;
        document["instances"][format!("behind{i}")] = ball([x, 0.5, 20.0]);
        let mut above = ball([x * 0.2, 4.0, 1.5]);
        above["receives_shadow"] = json!(false);
        document["instances"][format!("above{i}")] = above;
    }
    document
}

/// Balls under a sun that take no shadow, and a floor behind the camera that does.
fn shadows_out_of_sight() -> Value {
    let mut document = json!({
        "camera": { "position": [4, 4, 8], "target": [0, 0.4, 0], "fov_y_deg": 35 },
        "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.4], "shadow": {} } },
        "meshes": { "ball": { "type": "sphere" }, "floor": { "type": "plane", "size": [8, 8] } },
        "instances": { "floor": { "mesh": "floor", "translation": [0, 0, 24] } },
    });
    for i in 0..9 {
        let at = [f64::from(i % 3) * 1.5 - 1.5, 0.5, f64::from(i / 3) * 1.5 - 1.5];
        document["instances"][format!("ball{i}")] =
            json!({ "mesh": "ball", "translation": at, "receives_shadow": false });
    }
    document
}

fn compiled(json: &Value, files: &Files) -> Arc<Scene> {
    let document = Document::from_json(json).expect("the document is sound");
    Arc::new(scene::compile(&document, files, None, &Limits::default()).expect("the scene compiles").scene)
}

fn request(elide: Elisions) -> FrameRequest {
    let [width, height] = SIZE.map(Some);
    FrameRequest { width, height, elide: Some(elide), ..FrameRequest::default() }
}

/// Plans and draws a frame. Never inlined: valgrind counts the instructions of this function.
#[inline(never)]
fn measured_frame(scene: &Arc<Scene>, request: &FrameRequest, work: &Work) {
    let plan = Plan::new(scene, request, &Limits::default()).expect("a plan");
    black_box(pipeline::render(&plan, work).expect("nobody cancels"));
}

/// Everything left out, nothing, and all but each one.
fn choices() -> Vec<Elisions> {
    let but_one = Elision::ALL.into_iter().map(|elision| Elisions::ALL.without(elision));
    [Elisions::ALL, Elisions::NONE].into_iter().chain(but_one).collect()
}

fn print_tables() {
    let cases = cases();
    let names: Vec<&str> = cases.iter().map(|(name, _)| *name).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts");
    let cancel = AtomicBool::new(false);
    let work = Work { pool: &pool, cancel: &cancel, level: Level::new(), order: Order::Rows };
    println!("Time of a frame, more without than with, 1 thread, {} × {}:\n", SIZE[0], SIZE[1]);
    let times: Vec<Vec<f64>> = cases.iter().map(|(_, scene)| times(scene, &work)).collect();
    print_table(&names, &times);
    if let Some(counts) = names.iter().map(|name| instructions(name)).collect::<Option<Vec<_>>>() {
        println!("\nInstructions of a frame, more without than with, {} × {}:\n", SIZE[0], SIZE[1]);
        print_table(&names, &counts);
    } else {
        println!("\nInstructions are counted where valgrind is installed.");
    }
}

/// Median times of each choice, relative to those of its neighbour in the same round with everything left
/// out.
fn times(scene: &Arc<Scene>, work: &Work) -> Vec<f64> {
    let seconds = |elide| {
        let request = request(elide);
        let began = Instant::now();
        measured_frame(scene, &request, work);
        began.elapsed().as_secs_f64()
    };
    let mut ratios = vec![Vec::with_capacity(ROUNDS); choices().len()];
    seconds(Elisions::ALL);
    for _ in 0..ROUNDS {
        for (ratios, elide) in ratios.iter_mut().zip(choices()) {
            let with = seconds(Elisions::ALL);
            ratios.push(seconds(elide) / with);
        }
    }
    ratios.into_iter().map(median).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Instructions of each choice on all threads, relative to everything left out; `None` without valgrind. A
/// dump holds what was done since the one before, the first everything from the start of the program.
fn instructions(name: &str) -> Option<Vec<f64>> {
    let folder =
        std::env::temp_dir().join(format!("elisions-{}-{}", std::process::id(), name.replace(' ', "-")));
    std::fs::create_dir_all(&folder).ok()?;
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--dump-after=*measured_frame*"])
        .arg(format!("--callgrind-out-file={}", folder.join("out").display()))
        .arg(std::env::current_exe().ok()?)
        .args(["count", name])
        .output();
    let counts = run.ok().filter(|run| run.status.success()).and_then(|_| {
        (2..=choices().len() + 1)
            .map(|dump| total(&folder.join(format!("out.{dump}"))))
            .collect::<Option<Vec<f64>>>()
    });
    // What is left behind in the folder of temporary files does no harm.
    let _ = std::fs::remove_dir_all(&folder);
    let counts = counts?;
    Some(counts.iter().map(|count| count / counts[0]).collect())
}

/// The sum that a dump of callgrind ends with.
fn total(dump: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(dump).ok()?;
    text.lines().find_map(|line| line.strip_prefix("totals: ")?.trim().parse().ok())
}

/// Draws a frame of each choice, under valgrind.
fn draw_each_once(name: &str) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts");
    let cancel = AtomicBool::new(false);
    let level = "avx2".parse::<Simd>().map_or(Level::new(), Simd::level);
    let work = Work { pool: &pool, cancel: &cancel, level, order: Order::Rows };
    let (_, scene) = cases().into_iter().find(|(known, _)| *known == name).expect("the name of a scene");
    for elide in [Elisions::ALL].into_iter().chain(choices()) {
        measured_frame(&scene, &request(elide), &work);
    }
}

/// A row an elision, a column a scene.
fn print_table(names: &[&str], columns: &[Vec<f64>]) {
    println!("| left in | {} |\n|---|{}", names.join(" | "), "---:|".repeat(names.len()));
    let rows = choices().into_iter().enumerate().skip(1);
    for (row, elide) in rows {
        let name = Elision::ALL.into_iter().find(|elision| elide == Elisions::ALL.without(*elision));
        let name = name.map_or("all of them", Elision::name);
        let more = |column: &Vec<f64>| format!("{:+.1} %", 100.0 * (column[row] - 1.0));
        println!("| {name} | {} |", columns.iter().map(more).collect::<Vec<_>>().join(" | "));
    }
}
