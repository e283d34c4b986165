//! What a frame is spared changes no bit of it.

use crate::draw::levels;
use crate::draw::{pool, scene, scene_with, work, work_of};
use crate::random::Random;
use crate::random_scene::{RandomScene, random_scene};
use fearless_simd::Level;
use rasterd::limits::Limits;
use rasterd::pipeline::{self, Frame, Pixels, Work};
use rasterd::plan::{Elision, Elisions, Face, Filter, FrameRequest, Maps, Output, Plan, Unit};
use rasterd::scene::{Scene, demo};
use serde_json::{Value, json};
use std::sync::Arc;

/// Everything that a frame can show of what was computed for it.
const OUTPUTS: [Output; 4] = [Output::Color, Output::Radiance, Output::Depth, Output::Instance];

fn draw(scene: &Arc<Scene>, request: &FrameRequest, elide: Elisions, work: &Work) -> Frame {
    let request = FrameRequest { elide: Some(elide), ..request.clone() };
    let plan = Plan::new(scene, &request, &Limits::default()).expect("a plan");
    pipeline::render(&plan, work).expect("nobody cancels")
}

/// The bits of a picture: −0 is not 0 here.
fn bits(frame: Frame) -> Vec<u32> {
    match frame.pixels {
        Pixels::Rgba8 { pixels, .. } => pixels.into_iter().map(u32::from_le_bytes).collect(),
        Pixels::Rgba32F { pixels, .. } => pixels.into_iter().flatten().map(f32::to_bits).collect(),
        Pixels::Gray16(values) => values.into_iter().map(u32::from).collect(),
    }
}

/// Every output of a frame, bit by bit.
fn outputs(scene: &Arc<Scene>, request: &FrameRequest, elide: Elisions, work: &Work) -> [Vec<u32>; 4] {
    OUTPUTS.map(|output| bits(draw(scene, &FrameRequest { output, ..request.clone() }, elide, work)))
}

/// All of them, none, each one alone left in, each one alone left out.
fn every_choice() -> impl Iterator<Item = Elisions> {
    let alone_on = Elision::ALL.into_iter().map(|elision| Elisions::NONE.with(elision));
    let alone_off = Elision::ALL.into_iter().map(|elision| Elisions::ALL.without(elision));
    [Elisions::ALL].into_iter().chain(alone_on).chain(alone_off)
}

#[track_caller]
fn assert_same(case: &str, scene: &Arc<Scene>, request: &FrameRequest) {
    let general = outputs(scene, request, Elisions::NONE, &work());
    for elide in every_choice() {
        let elided = outputs(scene, request, elide, &work());
        for ((output, general), elided) in OUTPUTS.iter().zip(&general).zip(&elided) {
            let differing = general.iter().zip(elided).filter(|(a, b)| a != b).count();
            assert_eq!((differing, general.len()), (0, elided.len()), "{case}, {output:?}, elide={elide}");
        }
    }
}

fn sized(width: u32, height: u32, samples: u32) -> FrameRequest {
    FrameRequest {
        width: Some(width),
        height: Some(height),
        samples: Some(samples),
        ..FrameRequest::default()
    }
}

#[test]
fn the_demo_is_the_same_whatever_is_left_out() {
    let scene = scene_with(&demo::document(), &demo::files());
    assert_same("demo", &scene, &sized(120, 80, 4));
}

/// A box on a floor, lit and in shadow, with nothing that is not needed but what `extra` adds.
fn fixture(elision: Elision) -> Value {
    let mut document = json!({
        "camera": { "position": [2.5, 1.8, 3.5], "target": [0, 0.4, 0], "fov_y_deg": 35 },
        "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.4],
            "shadow": { "filter": "pcf", "resolution": 128 } } },
        "textures": { "dot": { "checker": { "colors": ["#b07030", "#b07030"], "cells": 1 }, "filter": "nearest" } },
        "materials": { "plain": { "diffuse": [0.7, 0.5, 0.3] } },
        "meshes": { "box": { "type": "box" }, "floor": { "type": "plane", "size": [6, 6] },
                    "ball": { "type": "sphere", "segments": 24, "rings": 12 } },
        "instances": {
            "box": { "mesh": "box", "material": "plain", "translation": [0, 0.5, 0] },
            "ball": { "mesh": "ball", "material": "plain", "translation": [1.2, 0.5, 0.4] },
            "floor": { "mesh": "floor", "material": "plain" },
        },
        "post": [{ "type": "vignette" }],
        "render": { "width": 160, "height": 120, "samples": 4 },
    });
    match elision {
        Elision::UnseenShadows => document["materials"]["plain"]["shading"] = json!("unlit"),
        Elision::DarkLights => {
            document["lights"]["out"] = json!({ "type": "point", "position": [1, 3, 1], "intensity": 0 })
        }
        Elision::CubeSides => {
            document["lights"]["lamp"] =
                json!({ "type": "point", "position": [0.5, 2.5, 1.5], "shadow": { "resolution": 64 } });
        }
        Elision::OutsideInstances => {
            document["instances"]["far"] = json!({ "mesh": "box", "translation": [0, 0, 40] })
        }
        Elision::OutsideTriangles => document["meshes"]["floor"]["size"] = json!([60, 60]),
        Elision::ConstantMaps => document["materials"]["plain"]["diffuse_map"] = json!("dot"),
        Elision::PlainTiles => {
            document["environment"] = json!({ "background": { "type": "color", "color": [0.1, 0.2, 0.4] } });
            document["render"]["width"] = json!(400);
        }
        Elision::NeutralEffects => document["post"] = json!([{ "type": "blur", "radius": 0 }]),
        _ => {}
    }
    if elision == Elision::UnseenShadows {
        // One lit surface that takes no shadow keeps the light alight.
        document["materials"]["lit"] = json!({});
        document["instances"]["box"]["material"] = json!("lit");
        document["instances"]["box"]["receives_shadow"] = json!(false);
    }
    if elision == Elision::OutsideTriangles {
        document["meshes"]["ball"]["segments"] = json!(8);
        document["instances"]["wide"] = json!({ "mesh": "ball", "scale": 30, "translation": [0, -20, 0] });
    }
    document
}

/// The work that an elision spares is done without it, to the last piece; and the picture is the same.
#[test]
fn each_spares_in_its_fixture_just_the_work_that_is_done_without_it() {
    for elision in Elision::ALL {
        let scene = scene(&fixture(elision));
        let request = FrameRequest::default();
        let unit = elision.unit();
        let with = draw(&scene, &request, Elisions::ALL, &work()).stats.tally;
        let without = draw(&scene, &request, Elisions::ALL.without(elision), &work()).stats.tally;
        let (spared, done) = (with.spared(elision), with.done(unit));
        println!("{}: {spared} of {} {} spared", elision.name(), without.done(unit), unit.name());
        assert!(spared > 0, "{} spares nothing", elision.name());
        assert_eq!(done + spared, without.done(unit), "{}", elision.name());
        assert_eq!(without.spared(elision), 0, "{}", elision.name());
        assert_same(elision.name(), &scene, &request);
    }
}

/// Of every triangle it is known what became of it, and of every pixel what it shows.
#[test]
fn triangles_and_pixels_are_accounted_for() {
    let scene = scene_with(&demo::document(), &demo::files());
    for elide in [Elisions::ALL, Elisions::NONE] {
        let stats = draw(&scene, &sized(200, 150, 1), elide, &work()).stats;
        assert_eq!(stats.geometry.triangles, stats.geometry.fates());
        assert!(stats.geometry.triangles > 0 && stats.geometry.drawn > 0);
    }
    let tally = draw(&scene, &sized(200, 150, 1), Elisions::ALL, &work()).stats.tally;
    assert_eq!(tally.done(Unit::CoveredPixels) + tally.done(Unit::SkyPixels), 200 * 150);
    assert_eq!(tally.done(Unit::CoveredPixels), tally.spared(Elision::CoveredSky));
}

/// What a flat unlit triangle needs: no light, no map, no relief, no sum of samples, no pass over the picture.
#[test]
fn a_flat_unlit_triangle_costs_what_it_must() {
    let scene = scene(&json!({
        "camera": { "position": [0, 0, 3], "target": [0, 0, 0] },
        "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
        "materials": { "flat": { "shading": "unlit", "normal_map": "tiles", "specular": [1, 1, 1] } },
        "textures": { "tiles": { "checker": { "colors": ["#888", "#eee"], "cells": 8 } } },
        "meshes": { "one": { "type": "triangles", "positions": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]] } },
        "instances": { "one": { "mesh": "one", "material": "flat" } },
        "render": { "width": 64, "height": 64, "samples": 1 },
    }));
    let stats = draw(&scene, &FrameRequest::default(), Elisions::ALL, &work()).stats;
    assert_eq!((stats.geometry.drawn, stats.shadow_maps), (1, 0));
    assert!(stats.shaded() > 0);
    for unit in [
        Unit::Shadows,
        Unit::ShadowTexels,
        Unit::Lights,
        Unit::Clipped,
        Unit::ColorSamples,
        Unit::ReliefSamples,
        Unit::Highlights,
        Unit::LitFragments,
        Unit::Lookups,
        Unit::Taps,
        Unit::Means,
        Unit::Passes,
    ] {
        assert_eq!(stats.tally.done(unit), 0, "{}", unit.name());
    }
}

/// Leaves out what it must not: of every shadow map the caster that comes last.
fn drop_last_casters(plan: &mut Plan) {
    for pass in &mut plan.shadows {
        match &mut pass.maps {
            Maps::Directional(face) => drop_last_caster(face),
            Maps::Cube { faces, .. } => faces.iter_mut().for_each(drop_last_caster),
        }
    }
}

fn drop_last_caster(face: &mut Face) {
    face.items.pop();
}

/// Takes a kernel for a single tap where it should have been asked whether it is one: what lies at a
/// kernel's border is ignored.
fn ignore_kernel_borders(plan: &mut Plan) {
    for pass in plan.shadows.iter_mut().filter(|pass| matches!(pass.filter, Filter::Pcf { .. })) {
        pass.filter = Filter::Hard;
    }
}

/// What the proof says of elisions that are wrong: it finds them out, in the fixture and in random scenes.
#[test]
fn a_wrong_elision_is_found_out() {
    type LeaveOut = fn(&mut Plan);
    const SCENES: u32 = 500;
    for (name, leave_out) in
        [("last casters", drop_last_casters as LeaveOut), ("kernel borders", ignore_kernel_borders)]
    {
        let differs = |scene: &Arc<Scene>, request: &FrameRequest| {
            let request = FrameRequest { elide: Some(Elisions::ALL), ..request.clone() };
            let mut plan = Plan::new(scene, &request, &Limits::default()).expect("a plan");
            leave_out(&mut plan);
            let wrong = pipeline::render(&plan, &work()).expect("nobody cancels");
            bits(wrong) != bits(draw(scene, &request, Elisions::NONE, &work()))
        };
        assert!(differs(&scene(&fixture(Elision::DecidedTaps)), &FrameRequest::default()), "{name}");
        let mut rng = Random(0xbad0_e11d);
        let found = (0..SCENES).filter(|_| {
            let RandomScene { scene, request, .. } = random_scene(rng.bits());
            differs(&scene, &request)
        });
        let found = found.count();
        println!("{name}: found in {found} of {SCENES} scenes");
        assert!(found >= 5, "{name}: found in {found} of {SCENES} scenes");
    }
}

/// Draws a random scene with everything left out, and with something drawn by lot. If that differs from
/// nothing left out: the elisions that make the difference, each for itself.
fn differences(random: &RandomScene, some: Elisions, work: &Work) -> Vec<String> {
    let RandomScene { scene, request, .. } = random;
    let general = outputs(scene, request, Elisions::NONE, work);
    let differs = |elide: &Elisions| outputs(scene, request, *elide, work) != general;
    if [Elisions::ALL, some].iter().any(differs) {
        every_choice().filter(differs).map(|elide| elide.to_string()).collect()
    } else {
        Vec::new()
    }
}

#[test]
fn a_thousand_random_scenes_are_the_same_whatever_is_left_out() {
    const SCENES: u64 = 1000;
    let mut rng = Random(0xe11d_e000);
    let pools = [1, 2, 3, 7].map(pool);
    let levels: Vec<Level> = levels().into_iter().map(|(_, level)| level).collect();
    let mut spared = [0u64; Elision::ALL.len()];
    for _ in 0..SCENES {
        let seed = rng.bits();
        let some = Elision::ALL.into_iter().filter(|_| rng.below(2) == 0);
        let some = some.fold(Elisions::NONE, Elisions::with);
        let random = random_scene(seed);
        let work = work_of(pools[rng.below(pools.len())], levels[rng.below(levels.len())]);
        let differences = differences(&random, some, &work);
        let RandomScene { document, request, .. } = &random;
        assert!(differences.is_empty(), "seed {seed:#x}, {:?}: {differences:?}\n{document}", request.knobs);
        let tally = draw(&random.scene, &random.request, Elisions::ALL, &work).stats.tally;
        for (sum, elision) in spared.iter_mut().zip(Elision::ALL) {
            *sum += u64::from(tally.spared(elision) > 0);
        }
    }
    for (elision, scenes) in Elision::ALL.into_iter().zip(spared) {
        println!("{} spares work in {scenes} of {SCENES} scenes", elision.name());
        assert!(scenes > 10, "{} in {scenes} scenes", elision.name());
    }
}
