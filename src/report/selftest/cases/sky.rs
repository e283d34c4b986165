//! Backgrounds at their stiffest: seams, poles, the widest view, no geometry and nothing but geometry.

use crate::math::simd::*;
use crate::math::{Projection, View};
use crate::model::sky::Daylight;
use crate::model::sky::daylight::{COLUMNS, ROWS, SUN_RADIUS, haze_phase, rayleigh_phase};
use crate::pipeline::Pixels;
use crate::pipeline::sky::rays::Rays;
use crate::plan::{FrameRequest, Output};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::closed_form::{Camera, codes_apart, encode};
use crate::report::selftest::instruments::draw::{
    Picture, file, frame, level, output, plan, png, scene_with,
};
use crate::report::selftest::instruments::worst::{U, Worst};
use crate::scene::Files;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// A smooth colour in every direction, 0.07–0.93.
fn smooth(d: DVec3) -> DVec3 {
    let d = d.normalize();
    DVec3::splat(0.5) + DVec3::new(d.x + d.y, d.y - d.z, d.z + d.x) * 0.3
}

/// By how many codes [`smooth`] can change over an angle: its gradient is at most 0.3 √2, and sRGB
/// codes change by at most 1.95 · 255 per unit of light from 0.07 on.
fn codes_of(radians: f64) -> f64 {
    radians * 0.3 * 2f64.sqrt() * 1.95 * 255.0
}

/// Texels and pixels are rounded to codes: half of one each.
const ROUNDING: f64 = 1.0;

fn codes(color: DVec3) -> [u8; 4] {
    let code = |c: f64| (encode(c) * 255.0 + 0.5).floor() as u8;
    [code(color.x), code(color.y), code(color.z), 255]
}

/// The direction of a place on a face, s and t in −1 to 1, t down (OpenGL 4.6 specification, table 8.19).
fn on_face(face: usize, s: f64, t: f64) -> DVec3 {
    match face {
        0 => DVec3::new(1.0, -t, -s),
        1 => DVec3::new(-1.0, -t, s),
        2 => DVec3::new(s, 1.0, t),
        3 => DVec3::new(s, -1.0, -t),
        4 => DVec3::new(s, -t, 1.0),
        _ => DVec3::new(-s, -t, -1.0),
    }
}

const SIDE: u32 = 128;

fn cube() -> (Value, Files) {
    let (mut files, mut faces) = (Files::default(), json!({}));
    for (face, name) in ["px", "nx", "py", "ny", "pz", "nz"].into_iter().enumerate() {
        let bytes = png(SIDE, SIDE, |x, y| {
            let [s, t] = [x, y].map(|i| (2.0 * f64::from(i) + 1.0) / f64::from(SIDE) - 1.0);
            codes(smooth(on_face(face, s, t)))
        });
        faces[name] = json!(name);
        files.insert(name, bytes.into()).expect("a sound name");
    }
    (json!({ "type": "cubemap", "faces": faces }), files)
}

fn panorama() -> (Value, Files) {
    let bytes = png(4 * SIDE, 2 * SIDE, |x, y| {
        let azimuth = ((f64::from(x) + 0.5) / f64::from(4 * SIDE) - 0.5) * std::f64::consts::TAU;
        let elevation = (0.5 - (f64::from(y) + 0.5) / f64::from(2 * SIDE)) * std::f64::consts::PI;
        let (sin, cos) = elevation.sin_cos();
        codes(smooth(DVec3::new(azimuth.sin() * cos, sin, -azimuth.cos() * cos)))
    });
    (json!({ "type": "equirect", "file": "around" }), file("around", bytes))
}

fn document(camera: &Camera, background: &Value) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "background": background },
        "lights": {},
        "render": camera.render(1),
    })
}

fn picture(camera: &Camera, (background, files): &(Value, Files)) -> Picture {
    Picture::new(frame(&scene_with(&document(camera, background), files), &FrameRequest::default()))
}

/// Largest difference from [`smooth`] in codes.
fn worst(camera: &Camera, sky: &(Value, Files)) -> f64 {
    let apart = |(x, y, pixel)| codes_apart(pixel, smooth(camera.centre(x, y).direction));
    picture(camera, sky).iter().map(apart).collect::<Worst>().largest()
}

pub fn b46_rays_point_where_they_should(ledger: &mut Ledger) {
    let mut rng = ledger.random(46);
    for fov_y_deg in [0.001, 45.0, 120.0, 179.9_f64] {
        let mut worst = Worst::default();
        for _ in 0..200 {
            let mut any = || rng.between(-1.0, 1.0);
            let forward = DVec3::new(any(), any(), any()).normalize();
            let right = forward.any_orthonormal_vector();
            let scale = 600.0 * 128.0 / (fov_y_deg.to_radians() * 0.5).tan();
            let view = View {
                eye: DVec3::ZERO,
                right,
                up: right.cross(forward),
                forward,
                projection: Projection::Perspective,
                scale: [scale; 2],
                near: 0.1,
                far: f64::INFINITY,
                width: 800,
                height: 600,
            };
            let rays = Rays::new(&view);
            let xs: [f64; 8] = std::array::from_fn(|_| (any() * 400.0).floor() * 256.0 + 128.0);
            let ys: [f64; 8] = std::array::from_fn(|_| (any() * 300.0).floor() * 256.0 + 128.0);
            let seen = dispatch!(level(), simd => {
                let ray = rays.through(f64x8::simd_from(simd, xs), f64x8::simd_from(simd, ys));
                [ray.x.to_array(), ray.y.to_array(), ray.z.to_array()]
            });
            for lane in 0..8 {
                let seen = DVec3::from_array([0, 1, 2].map(|c| f64::from(seen[c][lane])));
                let exact = view.ray([xs[lane], ys[lane]]);
                worst.note(seen.cross(exact).length() / (seen.length() * exact.length()));
            }
        }
        ledger.at_most(&format!("rays, fov {fov_y_deg}"), "direction error", worst.largest(), 4.0 * U);
    }
}

pub fn b46_cube_maps_have_no_seams(ledger: &mut Ledger) {
    let cube = cube();
    // Beyond an edge a texel of the neighbour stands in for one of the face's own plane: up to half a
    // texel (1/SIDE) aside, with half the weight.
    let bound = codes_of(0.5 / f64::from(SIDE)) + ROUNDING;
    for face in 0..6 {
        for [s, t] in [
            [1.0, 0.0],
            [-1.0, 0.0],
            [0.0, 1.0],
            [0.0, -1.0],
            [1.0, 1.0],
            [-1.0, 1.0],
            [1.0, -1.0],
            [-1.0, -1.0],
        ] {
            let target = on_face(face, s, t).to_array();
            let camera = Camera::perspective([0.0; 3], target, 4.0, 48, 48);
            ledger.at_most(&format!("face {face} at {s} {t}"), "codes off", worst(&camera, &cube), bound);
        }
    }
}

pub fn b46_poles_and_the_turn_of_a_panorama_are_clean(ledger: &mut Ledger) {
    let sky = panorama();
    for (name, target) in [
        ("zenith", [1e-6, 1.0, 0.0]),
        ("zenith itself", [0.0, 1.0, 0.0]),
        ("nadir", [0.0, -1.0, 1e-6]),
        ("where it begins and ends", [1e-9, 0.0, 1.0]),
    ] {
        for fov in [1.0, 20.0] {
            let camera = Camera::perspective([0.0; 3], target, fov, 49, 48);
            // At the pole the first row stands for what lies half a row beyond it.
            let bound = codes_of(std::f64::consts::PI / f64::from(4 * SIDE)) + ROUNDING;
            ledger.at_most(&format!("{name}, fov {fov}"), "codes off", worst(&camera, &sky), bound);
        }
    }
}

pub fn b46_the_widest_view_shows_the_sky_to_its_edge(ledger: &mut Ledger) {
    for (name, sky) in [("cube map", cube()), ("panorama", panorama())] {
        for target in [[0.3, 0.2, -1.0], [0.0, 1.0, 0.0], [1.0, -1.0, 1.0]] {
            let camera = Camera::perspective([0.0; 3], target, 179.9, 201, 151);
            let (mut worst, mut looked_at) = (Worst::default(), 0);
            for (x, y, pixel) in picture(&camera, &sky).iter() {
                let here = camera.centre(x, y).direction.normalize();
                let beside = camera.ray(f64::from(x) + 1.5, f64::from(y) + 0.5).direction.normalize();
                // In the middle a pixel covers most of the sky, and no direction is its own.
                if here.angle_between(beside) < 0.03 {
                    worst.note(codes_apart(pixel, smooth(here)));
                    looked_at += 1;
                }
            }
            assert!(looked_at > 25_000, "{looked_at}");
            // The mip of a pixel's longer side takes the mean over up to two of them.
            ledger.at_most(
                &format!("{name} to {target:?}"),
                "codes off",
                worst.largest(),
                codes_of(0.06) + ROUNDING,
            );
        }
    }
}

pub fn b46_the_sky_is_only_where_nothing_else_is(ledger: &mut Ledger) {
    let camera = Camera::perspective([0.0, 0.0, 0.0], [0.4, 0.3, -1.0], 80.0, 70, 66);
    let of = |shape: Value, background: Value| {
        let mut document = document(&camera, &background);
        document["materials"] =
            json!({ "m": { "shading": "unlit", "diffuse": [0.2, 0.4, 0.6], "double_sided": true } });
        document["meshes"] = json!({ "m": shape });
        document["instances"] = json!({ "m": { "mesh": "m", "material": "m" } });
        document["camera"]["near"] = json!(0.01);
        Picture::new(frame(&scene_with(&document, &Files::default()), &FrameRequest::default()))
    };
    let room = json!({ "type": "box", "size": [4, 4, 4] });
    let (sky, red) = (json!({ "type": "sky" }), json!({ "type": "color", "color": "#f00" }));
    let (a, b) = (of(room.clone(), sky.clone()), of(room, red.clone()));
    let differ = |a: &Picture, b: &Picture| a.pixels.iter().zip(&b.pixels).filter(|(a, b)| a != b).count();
    ledger.none_of("a closed room", "pixels of sky", differ(&a, &b), a.pixels.len());

    let nothing = json!({ "type": "triangles", "positions": [] });
    let (a, b) = (of(nothing.clone(), sky), of(nothing, red));
    let solid = a.pixels.len() - differ(&a, &b);
    ledger.none_of("no geometry", "pixels without sky", solid, a.pixels.len());
}

/// A procedural sky in a direction, by its table, in f64. `turned` is added to the cosine of the angle
/// to the sun.
fn computed(sky: &Daylight, view: &View, ray: DVec3, turned: f64) -> DVec3 {
    let sight = ray.normalize();
    // Below the horizon the sky goes on as it is there.
    let above = DVec3::new(sight.x, sight.y.max(0.0), sight.z).normalize();
    let sun = sky.towards_sun;
    let azimuth = |d: DVec3| DVec2::new(d.x, d.z).normalize();
    let row = above.y.sqrt() * (ROWS - 1) as f64;
    let column = (1.0 - azimuth(above).dot(azimuth(sun))) / 2.0 * (COLUMNS - 1) as f64;
    let column = column.clamp(0.0, (COLUMNS - 1) as f64);
    let (i, j) = ((row as usize).min(ROWS - 2), (column as usize).min(COLUMNS - 2));
    let (s, t) = (row - i as f64, column - j as f64);
    let entry = |c: usize| {
        let at = |i: usize, j: usize| f64::from(sky.table[i * COLUMNS + j][c]);
        let between = |i: usize| at(i, j) * (1.0 - t) + at(i, j + 1) * t;
        between(i) * (1.0 - s) + between(i + 1) * s
    };
    let cosine = above.dot(sun) + turned;
    let molecules = DVec3::new(entry(0), entry(1), entry(2)) * rayleigh_phase(cosine);
    let haze = DVec3::new(entry(3), entry(4), entry(5)) * haze_phase(cosine);

    let unit = |x: f64| x.clamp(0.0, 1.0);
    let pixel = (256.0 / view.scale[0].min(view.scale[1]) / ray.length()).max(SUN_RADIUS / 10.0);
    let disc = unit((SUN_RADIUS - (sight - sun).length()) / pixel + 0.5) * unit(sight.y / pixel + 0.5);
    let seen = molecules + haze + sky.disc.as_dvec3() * disc;
    // Through haze, the plain is e⁻¹ of itself at a hundredth of straight down.
    let hidden = if sight.y < 0.0 { (-0.01 * (-1.0 / sight.y - 1.0)).exp() } else { 0.0 };
    seen.lerp(sky.ground.as_dvec3(), hidden) + sky.night.as_dvec3()
}

pub fn b46_a_computed_sky_is_read_as_its_table_says(ledger: &mut Ledger) {
    for (elevation_deg, turbidity) in [(55.0, 3.0), (5.0, 8.0), (-3.0, 1.5), (89.9, 2.0)] {
        let (sin, cos) = f64::to_radians(elevation_deg).sin_cos();
        let towards = DVec3::new(0.6 * cos, sin, -0.8 * cos);
        let sky = Daylight::new(towards.normalize(), turbidity);
        let (mut worst, mut looked_at) = (Worst::default(), 0);
        for (target, fov) in [
            ([0.6, 0.4, -0.8], 100.0),
            ([-0.5, -0.1, 1.0], 120.0),
            ([1.0, 0.0, 0.3], 2.0),
            (towards.to_array(), 3.0),
            ([1e-3, 1.0, 0.0], 60.0),
            ([0.1, -1.0, 0.2], 150.0),
        ] {
            let camera = Camera::perspective([0.0; 3], target, fov, 90, 70);
            let background = json!({ "type": "sky", "sun_direction": (-towards).to_array(),
                "turbidity": turbidity });
            let scene = scene_with(&document(&camera, &background), &Files::default());
            let plan = plan(&scene, &output(Output::Radiance));
            let Pixels::Rgba32F { pixels, .. } = frame(&scene, &output(Output::Radiance)).pixels else {
                panic!("asked for radiance")
            };
            for ((x, y), pixel) in camera.pixels().zip(pixels) {
                let at = [(x, camera.width), (y, camera.height)]
                    .map(|(n, size)| f64::from(n) * 256.0 + 128.0 - f64::from(size) * 128.0);
                let ray = plan.view.ray(at);
                let ray = ray / ray.dot(plan.view.forward);
                let exact = computed(&sky, &plan.view, ray, 0.0);
                // A direction of f32, and its length, are off by up to 4u; the cosine by three products,
                // two sums and both vectors; what follows is a few dozen steps of one rounding each.
                let off = |changed: DVec3| (changed - exact).abs();
                let moved = |axis: DVec3| {
                    let step = axis * ray.length() * 4.0 * U;
                    let [a, b] = [step, -step].map(|step| off(computed(&sky, &plan.view, ray + step, 0.0)));
                    a.max(b)
                };
                let turned = [8.0, -8.0].map(|u| off(computed(&sky, &plan.view, ray, u * U)));
                let bound = moved(DVec3::X)
                    + moved(DVec3::Y)
                    + moved(DVec3::Z)
                    + turned[0].max(turned[1])
                    + exact * 24.0 * U;
                for c in 0..3 {
                    worst.note((f64::from(pixel[c]) - exact[c]).abs() / bound[c]);
                }
                looked_at += 1;
            }
        }
        assert!(looked_at > 30_000);
        let case = format!("sky, sun at {elevation_deg}°, turbidity {turbidity}");
        ledger.at_most(&case, "error in parts of its bound", worst.largest(), 1.0);
    }
}
