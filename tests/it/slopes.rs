//! Error as a power of what it depends on: the cheapest detector of samples in the wrong place, of a shadow map that
//! is read beside its texels, or of a texture that is.

use crate::draw::{file, output, png, scene, scene_with, work};
use crate::random::Random;
use glam::DVec3;
use rasterd::pipeline::{self, Pixels};
use rasterd::plan::{FrameRequest, Knobs, Maps, Output, Plan};
use rasterd::report::error::{Difference, Region, difference};
use rasterd::report::reference::{Aim, Effort, Reference};
use rasterd::report::{Fit, Knob, Law, Metric, subject};
use rasterd::scene::Scene;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::sync::Arc;

const RMSE_OF_SAMPLES: Law =
    Law { knob: Knob::Samples, metric: Metric::Rmse, region: Region::Edges, window: Some([-0.85, -0.55]) };
const MAE_OF_TEXELS: Law =
    Law { knob: Knob::ShadowResolution, metric: Metric::Mae, region: Region::All, window: Some([0.9, 1.1]) };
const RMSE_OF_TEXELS: Law = Law {
    knob: Knob::ShadowResolution,
    metric: Metric::Rmse,
    region: Region::All,
    window: Some([0.45, 0.55]),
};

fn planned(scene: &Arc<Scene>, request: FrameRequest) -> Plan {
    crate::draw::plan(scene, &request)
}

fn radiance(plan: &Plan) -> Vec<[f32; 4]> {
    let frame = pipeline::render(plan, &work()).expect("nobody cancels");
    let Pixels::Rgba32F { pixels, .. } = frame.pixels else { panic!("no radiance") };
    pixels
}

fn truth(plan: &Plan, effort: Effort) -> Reference {
    Reference::draw(&subject::of_reference(plan), effort, &|_| {}, &work()).expect("nobody cancels")
}

#[track_caller]
fn fitted(law: &Law, points: &[[f64; 2]]) -> Fit {
    let fit = Fit::of(law, points, 0.0).expect("enough points");
    println!("{:?} of {:?}: slope {:.3} ± {:.3}, {points:?}", fit.metric, fit.knob, fit.slope, fit.se);
    fit
}

/// White triangles that turn every way, none touching another, on black: a pixel of the picture is a unit.
fn scattered_triangles() -> Value {
    let mut rng = Random(40);
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for cell in 0..36 {
        let middle = [cell % 6, cell / 6].map(|n| (f64::from(n) - 2.5) * 26.0 + rng.between(-2.0, 2.0));
        let turn = rng.between(0.0, TAU);
        for corner in 0..3 {
            let angle = turn + TAU * f64::from(corner) / 3.0;
            positions.push([middle[0] + 10.5 * angle.cos(), middle[1] + 10.5 * angle.sin(), 0.0]);
        }
    }
    json!({
        "camera": { "position": [0, 0, 10], "orthographic": { "height": 160 } },
        "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
        "lights": {},
        "materials": { "white": { "shading": "unlit", "diffuse": [1, 1, 1] } },
        "meshes": { "t": { "type": "triangles", "positions": positions } },
        "instances": { "t": { "mesh": "t", "material": "white" } },
        "render": { "width": 160, "height": 160 },
    })
}

/// The errors at edges of 1 to 16 samples, each in its place but for `off` pixels.
fn coverage_errors(off: f64) -> Vec<[f64; 2]> {
    let scene = scene(&scattered_triangles());
    let effort = Effort { base: 4, most: 512, noise: 0.0, aim: Aim::Pixel };
    let truth = truth(&planned(&scene, output(Output::Radiance)), effort);
    let of = |samples: u32| {
        let mut plan = planned(&scene, FrameRequest { samples: Some(samples), ..output(Output::Radiance) });
        // The eye of a parallel view moves the picture: half a unit is half a pixel.
        plan.view.eye += (plan.view.right + plan.view.up) * off;
        difference(&radiance(&plan), &truth.radiance, Some(&truth.masks.edges)).rmse
    };
    [1, 2, 4, 8, 16].map(|samples| [f64::from(samples), of(samples)]).to_vec()
}

#[test]
fn coverage_falls_as_fast_as_its_patterns_promise() {
    let fit = fitted(&RMSE_OF_SAMPLES, &coverage_errors(0.0));
    assert_eq!(fit.pass, Some(true), "{fit:?}");
}

#[test]
fn samples_half_a_pixel_beside_their_place_are_caught() {
    let fit = fitted(&RMSE_OF_SAMPLES, &coverage_errors(0.5));
    assert_eq!(fit.pass, Some(false), "{fit:?}");
}

/// The errors of a picture of few pixels, interpolated, over the size of a drawn pixel.
fn scale_errors() -> Vec<(f64, Difference)> {
    let scene = scene(&scattered_triangles());
    let effort = Effort { base: 4, most: 512, noise: 0.0, aim: Aim::Pixel };
    let truth = truth(&planned(&scene, output(Output::Radiance)), effort);
    let of = |scale: f64| {
        let knobs = Knobs { render_scale: Some(scale), ..Knobs::default() };
        let request = FrameRequest { samples: Some(1), knobs, ..output(Output::Radiance) };
        let drawn = radiance(&planned(&scene, request));
        (1.0 / scale, difference(&drawn, &truth.radiance, None))
    };
    [0.25, 0.5, 0.75, 1.0].map(of).to_vec()
}

/// The windows of the report's own laws, whose derivation stands there.
#[test]
fn a_picture_of_few_pixels_blurs_edges_by_their_size() {
    let errors = scale_errors();
    let law = |metric, window| Law { knob: Knob::RenderScale, metric, region: Region::All, window };
    let fit = fitted(&law(Metric::Mae, Some([0.85, 1.15])), &of_metric(&errors, |error| error.mae));
    assert_eq!(fit.pass, Some(true), "{fit:?}");
    let fit = fitted(&law(Metric::Rmse, Some([0.55, 0.75])), &of_metric(&errors, |error| error.rmse));
    assert_eq!(fit.pass, Some(true), "{fit:?}");
}

/// A star of bars that hover over a floor, under a slanted sun; the camera looks straight down between them.
fn bars_over_a_floor() -> Value {
    let mut instances = json!({ "floor": { "mesh": "floor" } });
    for i in 0..7 {
        let angle = f64::from(i) * 25.0 + 3.0;
        instances[format!("bar{i}")] = json!({
            "mesh": "bar", "rotation_deg": [0, angle, 0],
            "translation": [0.9 * (f64::from(i) - 3.0) / 3.0, 0.5 + 0.03 * f64::from(i), 0.25 * f64::from(i % 3) - 0.2],
        });
    }
    json!({
        "camera": { "position": [0.7, 0.2, 0.35], "target": [0.7, 0, 0.35], "up": [0, 0, -1], "orthographic": { "height": 2.2 }, "near": 0.01 },
        "environment": { "ambient": [0.2, 0.2, 0.2] },
        "lights": { "sun": { "type": "directional", "direction": [0.55, -1, 0.31], "shadow": { "filter": "hard" } } },
        "meshes": { "floor": { "type": "plane", "size": [6, 6] }, "bar": { "type": "box", "size": [1.6, 0.05, 0.05] } },
        "instances": instances,
        "render": { "width": 384, "height": 384, "samples": 1 },
    })
}

/// World units that a caster is beside its place in the maps.
enum Beside {
    Nowhere,
    /// By this many texels of each map.
    OwnTexels(f64),
    /// By this many texels of the map with so many along a side.
    TexelsOf(u32, f64),
}

/// Texels along a side of the maps.
const SIDES: [u32; 5] = [256, 512, 1024, 2048, 4096];

/// The errors of shadow maps with so many texels along a side, over the size of a texel.
fn shadow_errors(sides: &[u32], beside: &Beside) -> Vec<(f64, Difference)> {
    let scene = scene(&bars_over_a_floor());
    let effort = Effort { base: 2, most: 2, noise: 0.0, aim: Aim::Centre };
    let truth = truth(&planned(&scene, output(Output::Radiance)), effort);
    let plan_of = |side: u32| {
        let knobs = Knobs { shadow_resolution: Some(side), ..Knobs::default() };
        planned(&scene, FrameRequest { knobs, ..output(Output::Radiance) })
    };
    let of = |&side: &u32| {
        let mut plan = plan_of(side);
        let offset = match beside {
            Beside::Nowhere => 0.0,
            Beside::OwnTexels(texels) => texels * texel(&plan),
            Beside::TexelsOf(side, texels) => texels * texel(&plan_of(*side)),
        };
        move_casters(&mut plan, offset);
        (texel(&plan), difference(&radiance(&plan), &truth.radiance, None))
    };
    sides.iter().map(of).collect()
}

/// Side of a texel in world units.
fn texel(plan: &Plan) -> f64 {
    256.0 / plan.shadows[0].faces()[0].view.scale[0]
}

/// Moves what the shadow map sees, and nothing else, along the map's diagonal.
fn move_casters(plan: &mut Plan, offset: f64) {
    let Maps::Directional(face) = &mut plan.shadows[0].maps else { panic!("a sun has one map") };
    let step: DVec3 = (face.view.right + face.view.up) * offset;
    face.items.iter_mut().for_each(|item| item.origin += step);
}

fn of_metric(errors: &[(f64, Difference)], metric: fn(&Difference) -> f64) -> Vec<[f64; 2]> {
    errors.iter().map(|(texel, error)| [*texel, metric(error)]).collect()
}

#[test]
fn the_edge_of_a_hard_shadow_nears_its_place_with_the_texels() {
    let errors = shadow_errors(&SIDES, &Beside::Nowhere);
    let fit = fitted(&MAE_OF_TEXELS, &of_metric(&errors, |error| error.mae));
    assert_eq!(fit.pass, Some(true), "{fit:?}");
    let fit = fitted(&RMSE_OF_TEXELS, &of_metric(&errors, |error| error.rmse));
    assert_eq!(fit.pass, Some(true), "{fit:?}");
}

#[test]
fn a_shadow_beside_its_place_is_caught() {
    let errors = shadow_errors(&SIDES, &Beside::TexelsOf(1024, 0.5));
    for (law, metric) in
        [(&MAE_OF_TEXELS, (|e| e.mae) as fn(&Difference) -> f64), (&RMSE_OF_TEXELS, |e| e.rmse)]
    {
        let fit = fitted(law, &of_metric(&errors, metric));
        assert_eq!(fit.pass, Some(false), "{fit:?}");
    }
}

/// What a map of `side` texels errs by where casters are half a texel of its beside their place, along the diagonal:
/// measured with the finest map, whose own texels hardly add to that.
fn error_of_half_a_texel(side: u32) -> f64 {
    shadow_errors(&SIDES[4..], &Beside::TexelsOf(side, 0.5))[0].1.mae
}

/// What is off by half a texel of each map shrinks with it, so its slope is right; but it is too large.
///
/// A map moves an edge by the way to the middle of the nearest texel, which is uniform in a square of side t.
/// Across an edge at an angle θ to the texels that is |u cos θ + v sin θ| with u and v in ±t/2: t/4 in the mean at
/// 0°, t √2/6 at 45°, 0.24 t over all angles. A step by half a texel along the diagonal moves an edge by
/// (t/2) |cos θ + sin θ|, 0.45 t in the mean. A map that is read in its place errs by 0.54 of that. What receivers
/// are moved by along their normals, here 0.2 t on the map, adds its square: 0.03. A map that is read half a texel
/// beside its place errs by the step itself and more where its own error is larger. Between the two lies 0.75.
#[test]
fn a_shadow_that_is_off_with_its_texels_is_larger_than_it_may_be() {
    const MOST: f64 = 0.75;
    let coarse = &SIDES[..3];
    let yardsticks: Vec<f64> = coarse.iter().map(|&side| error_of_half_a_texel(side)).collect();
    let in_half_texels = |beside: Beside| -> Vec<f64> {
        let errors = shadow_errors(coarse, &beside);
        errors.iter().zip(&yardsticks).map(|((_, error), yardstick)| error.mae / yardstick).collect()
    };
    let right = in_half_texels(Beside::Nowhere);
    println!("in half texels: {right:.3?}");
    assert!(right.iter().all(|error| *error < MOST), "{right:?} half texels");
    for step in [0.5, -0.5] {
        let off = in_half_texels(Beside::OwnTexels(step));
        println!("in half texels, {step} texels off: {off:.3?}");
        assert!(off.iter().all(|error| *error > MOST), "{off:?} half texels, {step} texels off");
    }
}

/// Values of a smooth texture, and the texture as `n × n` texels.
fn smooth(u: f64, v: f64) -> f64 {
    0.5 + 0.45 * (TAU * u).sin() * (TAU * v).sin()
}

/// The root mean square error of a magnified texture over its texels' size, `off` texels beside its place.
fn texture_errors(filter: &str, off: f64) -> Vec<[f64; 2]> {
    const SIDE: u32 = 240;
    let of = |n: u32| {
        let code = |x: u32, y: u32| {
            let [u, v] = [x, n - 1 - y].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "codes are in 0–255")]
            let code = (255.0 * smooth(u, v) + 0.5).floor() as u8;
            code
        };
        let files = file("smooth.png", png(n, n, |x, y| [code(x, y), code(x, y), code(x, y), 255]));
        let document = json!({
            "camera": { "position": [0, 0, 1], "orthographic": { "height": 1 } },
            "lights": {},
            "textures": { "smooth": { "file": "smooth.png", "filter": filter, "color_space": "linear" } },
            "materials": { "m": { "shading": "unlit", "diffuse": [1, 1, 1], "diffuse_map": "smooth" } },
            "meshes": { "quad": { "type": "plane", "size": [1, 1] } },
            "instances": { "quad": { "mesh": "quad", "material": "m", "rotation_deg": [90, 0, 0] } },
            "render": { "width": SIDE, "height": SIDE, "samples": 1 },
        });
        let scene = scene_with(&document, &files);
        let plan = planned(&scene, output(Output::Radiance));
        let step = off / f64::from(n);
        let square = |(at, pixel): (u32, &[f32; 4])| {
            let (x, y) = (at % SIDE, at / SIDE);
            let [u, v] = [x, SIDE - 1 - y].map(|i| (f64::from(i) + 0.5) / f64::from(SIDE) + step);
            (f64::from(pixel[0]) - smooth(u, v)).powi(2)
        };
        let squares: f64 = (0..).zip(&radiance(&plan)).map(square).sum();
        [1.0 / f64::from(n), (squares / f64::from(SIDE * SIDE)).sqrt()]
    };
    [6, 8, 10, 12, 16].map(of).to_vec()
}

fn texture_law(window: [f64; 2]) -> Law {
    Law { knob: Knob::TextureFilter, metric: Metric::Rmse, region: Region::All, window: Some(window) }
}

#[test]
fn a_magnified_texture_nears_what_it_shows() {
    let nearest = fitted(&texture_law([0.9, 1.1]), &texture_errors("nearest", 0.0));
    assert_eq!(nearest.pass, Some(true), "{nearest:?}");
    let bilinear = fitted(&texture_law([1.8, 2.2]), &texture_errors("bilinear", 0.0));
    assert_eq!(bilinear.pass, Some(true), "{bilinear:?}");
}

#[test]
fn a_texture_half_a_texel_beside_its_place_is_caught() {
    let bilinear = fitted(&texture_law([1.8, 2.2]), &texture_errors("bilinear", 0.5));
    assert_eq!(bilinear.pass, Some(false), "{bilinear:?}");
}
