//! The whole of it against closed forms.

use super::*;
use crate::limits::Limits;
use crate::math::colour::linear_from_srgb;
use crate::math::simd::Level;
use crate::pipeline::Order;
use crate::plan::FrameRequest;
use crate::scene::{Document, Files, compile, framing};
use glam::DVec3;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

fn scene(document: &Value) -> Scene {
    scene_with(document, &Files::default())
}

fn scene_with(document: &Value, files: &Files) -> Scene {
    let document = Document::from_json(document).expect("a valid document");
    compile(&document, files, None, &Limits::default()).expect("a scene").scene
}

fn draw_with(threads: usize, scene: &Scene, size: [u32; 2], effort: Effort) -> Reference {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let camera = framing::resolve(scene, &FrameRequest::default(), size[0], size[1]).expect("a camera");
    let subject = Subject { scene, camera, size, t: 0.0, background: &scene.background, shading: None };
    Reference::draw(&subject, effort, &|_| (), &work).expect("nobody cancels")
}

fn evenly(samples: u32) -> Effort {
    Effort { base: samples, most: samples, noise: 0.0, aim: Aim::Pixel }
}

fn draw(scene: &Scene, size: [u32; 2], samples: u32) -> Reference {
    draw_with(2, scene, size, evenly(samples))
}

/// A camera above the origin that looks down on `height` units, x to the right and −z up.
fn from_above(height: f64) -> Value {
    json!({ "position": [0, 10, 0], "target": [0, 0, 0], "up": [0, 0, -1], "near": 0.01,
            "orthographic": { "height": height } })
}

/// A quad in the plane at height `y`, from one corner (x, z) to the other; it faces up, or down if
/// `x` falls from the first to the second.
fn level_quad(y: f64, from: [f64; 2], to: [f64; 2]) -> Value {
    let [[x0, z0], [x1, z1]] = [from, to];
    json!({ "type": "triangles", "positions": [[x0, y, z0], [x0, y, z1], [x1, y, z1], [x1, y, z0]],
            "indices": [[0, 1, 2], [0, 2, 3]] })
}

/// The root of the mean square.
fn rms(errors: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = errors.len() as f64;
    (errors.map(|e| e * e).sum::<f64>() / count).sqrt()
}

/// Area of the part of the square from (x, y) to (x + 1, y + 1) on which `a · x + b · y < c`.
fn half_plane_area([x, y]: [f64; 2], [a, b, c]: [f64; 3]) -> f64 {
    let square = [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
    let height = |p: [f64; 2]| c - a * p[0] - b * p[1];
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for (p, q) in square.into_iter().zip(square.into_iter().cycle().skip(1)) {
        let (hp, hq) = (height(p), height(q));
        if hp > 0.0 {
            kept.push(p);
        }
        if (hp > 0.0) != (hq > 0.0) {
            let s = hp / (hp - hq);
            kept.push([p[0] + (q[0] - p[0]) * s, p[1] + (q[1] - p[1]) * s]);
        }
    }
    let next = kept.iter().cycle().skip(1);
    kept.iter().zip(next).map(|(p, q)| (p[0] * q[1] - q[0] * p[1]) / 2.0).sum()
}

#[test]
fn half_a_plane_covers_its_exact_area() {
    // Its edge runs through (−0.3, 0.2) (x, z) along (0.35, 1); all that is left of it is white.
    let far = |s: f64, aside: f64| [-0.3 + 0.35 * s + aside, 0.0, 0.2 + s];
    let scene = scene(&json!({
        "camera": from_above(16.0),
        "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
        "lights": {},
        "materials": { "white": { "shading": "unlit", "diffuse": [1, 1, 1] } },
        "meshes": { "half": { "type": "triangles", "positions": [far(-60.0, 0.0), far(-60.0, -90.0), far(60.0, -90.0), far(60.0, 0.0)],
                              "indices": [[0, 1, 2], [0, 2, 3]] } },
        "instances": { "half": { "mesh": "half", "material": "white" } },
    }));
    let reference = draw(&scene, [16, 16], 256);
    // x − 0.35 z < −0.3 − 0.07, with x = column − 8 and z = row − 8.
    let line = [1.0, -0.35, -0.37 + 8.0 - 0.35 * 8.0];
    let area = |i: usize| half_plane_area([(i % 16) as f64, (i / 16) as f64], line);
    let errors: Vec<f64> = (0..256).map(|i| reference.radiance[i][0] - area(i)).collect();
    let edges: Vec<usize> = (0..256).filter(|&i| area(i) > 0.0 && area(i) < 1.0).collect();
    assert!(edges.len() > 16, "{}", edges.len());
    // Numerics C.2: an edge pixel of 256 low-discrepancy samples is off by 0.0050 in the mean.
    let rmse = rms(edges.iter().map(|&i| errors[i]));
    assert!(rmse < 0.0055, "{rmse}");
    for (i, error) in errors.iter().enumerate() {
        assert!(error.abs() < 0.02, "{i}: {error}");
        // Not all slivers are seen by a sample.
        let is_clear = area(i) > 0.02 && area(i) < 0.98;
        assert!(!is_clear || reference.masks.edges[i], "{i}");
        assert!(reference.masks.edges[i] <= (area(i) > 0.0 && area(i) < 1.0), "{i}");
    }
    let actual = rms(errors.iter().copied());
    assert!(reference.noise > actual / 2.0 && reference.noise < actual * 2.0, "{} {actual}", reference.noise);
}

#[test]
fn a_hard_shadow_ends_where_geometry_says() {
    // Light along (2, −1, 0) takes the edge of the roof at x = −1.35, y = 1 to x = 0.65.
    let scene = scene(&json!({
        "camera": from_above(2.0),
        "environment": { "ambient": [0, 0, 0] },
        "lights": { "sun": { "type": "directional", "direction": [2, -1, 0], "shadow": { "filter": "hard" } } },
        "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
        "meshes": { "floor": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]), "roof": level_quad(1.0, [-3.1, -9.0], [-1.35, 9.0]) },
        "instances": { "floor": { "mesh": "floor", "material": "white" }, "roof": { "mesh": "roof", "material": "white" } },
    }));
    let reference = draw(&scene, [8, 8], 256);
    // N·L is 1/√5; the edge is at (0.65 + 1) / 0.25 = 6.6 columns.
    let lit = 0.2_f64.sqrt();
    for (i, pixel) in reference.radiance.iter().enumerate() {
        let expected = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.4, 1.0][i % 8];
        // Along an axis each of 256 columns of samples has one: off by at most one in each half.
        assert!((pixel[0] / lit - expected).abs() <= 2.0 / 256.0, "{i}: {pixel:?}");
        assert_eq!(reference.masks.penumbrae[i], i % 8 == 6);
        assert!(!reference.masks.edges[i]);
    }
}

/// The share of a disc on the side `u > 0` of a line, its centre at `u` radii.
fn share_of_disc(u: f64) -> f64 {
    let u = u.clamp(-1.0, 1.0);
    0.5 + (u * (1.0 - u * u).sqrt() + u.asin()) / PI
}

/// The mean of `f` over a pixel of a picture of 2 units in 16 pixels, seen from above: by x and z.
fn pixel_mean(i: usize, f: impl Fn(f64, f64) -> f64) -> f64 {
    let at = |pixel: usize, step: u32| (pixel as f64 + (f64::from(step) + 0.5) / 16.0) / 8.0 - 1.0;
    let places = (0..256).map(|k| (at(i % 16, k % 16), at(i / 16, k / 16)));
    places.map(|(x, z)| f(x, z)).sum::<f64>() / 256.0
}

/// A floor under a roof that hides the light where x < 0, at height 1: it faces down, so that the
/// camera above does not see it.
fn under_a_roof(light: Value) -> Reference {
    let scene = scene(&json!({
        "camera": from_above(2.0),
        "environment": { "ambient": [0, 0, 0] },
        "lights": { "lamp": light },
        "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
        "meshes": { "floor": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]), "roof": level_quad(1.0, [0.0, -90.0], [-90.0, 90.0]) },
        "instances": { "floor": { "mesh": "floor", "material": "white" }, "roof": { "mesh": "roof", "material": "white" } },
    }));
    draw(&scene, [16, 16], 1024)
}

fn assert_close(reference: &Reference, expected: impl Fn(usize) -> f64, bound: f64) {
    let errors: Vec<f64> =
        reference.radiance.iter().enumerate().map(|(i, pixel)| pixel[0] - expected(i)).collect();
    let worst = errors.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
    let rmse = rms(errors.into_iter());
    println!("rmse {rmse:.5}, worst {worst:.5}, noise {:.5}", reference.noise);
    assert!(worst < bound && rmse < bound / 3.0, "{rmse} {worst}");
    assert!(rmse < reference.noise * 2.0, "{rmse} {}", reference.noise);
}

#[test]
fn the_penumbra_of_a_sun_is_a_part_of_its_disc() {
    let shadow = json!({ "filter": "pcss", "light_radius": 0.5 });
    let reference = under_a_roof(json!({ "type": "directional", "direction": [0, -1, 0], "shadow": shadow }));
    // On a plane 1 behind the edge the penumbra reaches `light_radius` to each side.
    let expected = |i: usize| pixel_mean(i, |x, _| share_of_disc(x / 0.5));
    assert_close(&reference, expected, 0.02);
    for (i, is_penumbra) in reference.masks.penumbrae.iter().enumerate() {
        assert_eq!(*is_penumbra, (4..12).contains(&(i % 16)), "{i}");
    }
}

#[test]
fn the_penumbra_of_a_lamp_is_a_part_of_its_disc() {
    let (lamp, radius) = (DVec3::new(0.2, 3.0, 0.1), 0.6);
    let attenuation = json!({ "constant": 1, "linear": 0, "quadratic": 0 });
    let shadow = json!({ "filter": "pcss", "light_radius": radius });
    let reference = under_a_roof(
        json!({ "type": "point", "position": lamp.to_array(), "attenuation": attenuation, "shadow": shadow }),
    );
    let radiance = |x: f64, z: f64| {
        let point = DVec3::new(x, 0.0, z);
        let towards = (lamp - point).normalize();
        // The plane through the point and the roof's edge cuts the disc in a line.
        let plane = DVec3::new(1.0, -x / -1.0, 0.0).normalize();
        let apart = plane.dot(lamp - point) / plane.cross(towards).length();
        share_of_disc(apart / radius) * towards.y
    };
    assert_close(&reference, |i| pixel_mean(i, radiance), 0.02);
}

#[test]
fn a_lit_pane_over_a_shadow_is_no_penumbra() {
    let scene = scene(&json!({
        "camera": from_above(2.0),
        "environment": { "ambient": [0, 0, 0] },
        "lights": { "sun": { "type": "directional", "direction": [0, -1, 0], "shadow": { "filter": "hard" } } },
        "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] }, "pane": { "shading": "lambert", "diffuse": [1, 1, 1], "opacity": 0.4 } },
        "meshes": { "floor": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]), "roof": level_quad(1.0, [0.0, -9.0], [-9.0, 9.0]), "pane": level_quad(2.0, [-9.0, -9.0], [9.0, 9.0]) },
        "instances": { "floor": { "mesh": "floor", "material": "white" }, "roof": { "mesh": "roof", "material": "white" }, "pane": { "mesh": "pane", "material": "pane" } },
    }));
    let reference = draw(&scene, [16, 16], 8);
    for (i, pixel) in reference.radiance.iter().enumerate() {
        let expected = if i % 16 < 8 { 0.4 } else { 1.0 };
        assert!((pixel[0] - expected).abs() < 1e-6, "{i}: {pixel:?}");
    }
    assert_eq!(reference.masks.penumbrae, [false; 256]);
}

#[test]
fn a_highlight_is_what_the_formula_says() {
    let scene = scene(&json!({
        "camera": { "position": [0, 3, 4], "target": [0, 0, 0], "fov_y_deg": 0.001 },
        "environment": { "ambient": [0.1, 0.2, 0.3] },
        "lights": { "lamp": { "type": "point", "position": [0, 2, -1], "color": [1, 0.5, 0.25], "intensity": 3,
                              "attenuation": { "constant": 0.5, "linear": 0.25, "quadratic": 0.125 } } },
        "materials": { "red": { "diffuse": [0.5, 0.25, 0.125], "specular": [0.3, 0.6, 0.9], "shininess": 20, "emissive": [0.01, 0.02, 0.03] } },
        "meshes": { "floor": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]) },
        "instances": { "floor": { "mesh": "floor", "material": "red" } },
    }));
    let pixel = draw(&scene, [1, 1], 16).radiance[0];
    // At the origin L is (0, 2, −1)/√5, V (0, 3, 4)/5: H is their sum, scaled.
    let h = [2.0 / 5.0_f64.sqrt() + 0.6, -1.0 / 5.0_f64.sqrt() + 0.8];
    let (n_l, n_h) = (2.0 / 5.0_f64.sqrt(), h[0] / h[0].hypot(h[1]));
    let attenuation = 1.0 / (0.5 + 0.25 * 5.0_f64.sqrt() + 0.125 * 5.0);
    let expected = [(0.5, 0.3, 0.01, 0.1, 1.0), (0.25, 0.6, 0.02, 0.2, 0.5), (0.125, 0.9, 0.03, 0.3, 0.25)]
        .map(|(d, s, e, a, color)| e + a * d + (d * n_l + s * n_h.powi(20)) * 3.0 * color * attenuation);
    for c in 0..3 {
        // Colours are kept in f32, and the pixel is 4·10⁻⁵ units high.
        assert!((pixel[c] - expected[c]).abs() < 1e-5, "{c}: {} {}", pixel[c], expected[c]);
    }
}

/// Corners of a turned white card lie in pixels anywhere: four samples miss up to a third of some.
#[test]
fn few_samples_beside_an_edge_become_many() {
    let scene = scene(&json!({
        "camera": from_above(2.0),
        "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
        "materials": { "white": { "shading": "unlit", "diffuse": [1, 1, 1] } },
        "meshes": { "card": level_quad(0.0, [-0.5, -0.5], [0.5, 0.5]) },
        "instances": { "card": { "mesh": "card", "material": "white", "rotation_deg": [0, 17, 0] } },
    }));
    let adaptive = draw_with(2, &scene, [40, 40], Effort { base: 4, ..evenly(256) });
    let even = draw(&scene, [40, 40], 256);
    let off = |i: usize| (adaptive.radiance[i][0] - even.radiance[i][0]).abs();
    let worst = (0..1600).map(off).fold(0.0, f64::max);
    // Beside an edge there are 64: a part of a pixel that they miss is no larger than two of their strata.
    assert!(worst <= 2.0 / 64.0, "{worst}");
    assert!(
        adaptive.samples.iter().filter(|samples| **samples <= 4).count() > 1000,
        "empty pixels need no more"
    );
}

/// A red pane of alpha 0.4 above a blue one of 0.7, by name the other way round.
fn panes(background: &Value) -> Reference {
    let pane =
        |color: [f64; 3], opacity: f64| json!({ "shading": "unlit", "diffuse": color, "opacity": opacity });
    let scene = scene(&json!({
        "camera": from_above(2.0),
        "environment": { "background": background },
        "materials": { "red": pane([1.0, 0.0, 0.0], 0.4), "blue": pane([0.0, 0.0, 1.0], 0.7) },
        "meshes": { "low": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]), "high": level_quad(1.0, [-9.0, -9.0], [9.0, 9.0]) },
        "instances": { "a": { "mesh": "high", "material": "red" }, "b": { "mesh": "low", "material": "blue" } },
    }));
    draw(&scene, [2, 2], 4)
}

#[test]
fn panes_are_laid_over_each_other_from_the_back() {
    let behind = [0.5, 0.25, 0.75];
    let over = panes(&json!({ "type": "color", "color": behind }));
    let blue = [behind[0] * 0.3, behind[1] * 0.3, 0.7 + behind[2] * 0.3];
    let both = [0.4 + blue[0] * 0.6, blue[1] * 0.6, blue[2] * 0.6, 1.0];
    for pixel in &over.radiance {
        assert!((0..4).all(|c| (pixel[c] - both[c]).abs() < 1e-7), "{pixel:?}");
    }
    let clear = panes(&json!({ "type": "transparent" }));
    let finished = post::apply(&[], clear.size, &clear.radiance);
    for (pixel, color) in clear.radiance.iter().zip(&finished) {
        // Premultiplied: 0.7 blue under 0.4 red; what is left of white shows behind.
        let expected = [0.4, 0.0, 0.42, 0.82];
        assert!((0..4).all(|c| (pixel[c] - expected[c]).abs() < 1e-7), "{pixel:?}");
        let white = [0.58, 0.18, 0.6];
        assert!((0..3).all(|c| (color[c] - white[c]).abs() < 1e-7), "{color:?}");
    }
}

#[test]
fn only_what_lies_between_near_and_far_is_seen() {
    let seen = |near: f64, far: f64| {
        let mut document = json!({
            "camera": from_above(2.0),
            "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
            "materials": { "red": { "shading": "unlit", "diffuse": [1, 0, 0] }, "green": { "shading": "unlit", "diffuse": [0, 1, 0] } },
            "meshes": { "low": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]), "high": level_quad(4.0, [-9.0, -9.0], [9.0, 9.0]) },
            "instances": { "a": { "mesh": "high", "material": "red" }, "b": { "mesh": "low", "material": "green" } },
        });
        document["camera"]["near"] = json!(near);
        document["camera"]["far"] = json!(far);
        draw(&scene(&document), [1, 1], 2).radiance[0]
    };
    assert_eq!(seen(5.0, 20.0), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(seen(6.5, 20.0), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(seen(6.5, 9.5), [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn fronts_stay_fronts_under_a_mirror() {
    let seen = |scale: [f64; 3], cull: &str| {
        let document = json!({
            "camera": from_above(2.0),
            "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
            "materials": { "red": { "shading": "normal" } },
            "meshes": { "quad": level_quad(0.0, [-9.0, -9.0], [9.0, 9.0]) },
            "instances": { "a": { "mesh": "quad", "material": "red", "scale": scale } },
            "render": { "cull": cull },
        });
        draw(&scene(&document), [1, 1], 2).radiance[0]
    };
    let [half, one] = [linear_from_srgb(0.5), 1.0];
    assert_eq!(seen([1.0, 1.0, 1.0], "back"), [half, one, half, 1.0]);
    assert_eq!(seen([-1.0, 1.0, 1.0], "back"), [half, one, half, 1.0]);
    assert_eq!(seen([1.0, -1.0, 1.0], "back"), [0.0, 0.0, 0.0, 1.0]);
    // A back is the front turned inside out: seen from there, the normal comes towards the viewer.
    assert_eq!(seen([1.0, -1.0, 1.0], "front"), [half, one, half, 1.0]);
}

/// The world normal of a plane of 2 × 2 units with one relief, at its centre.
fn tilted(relief: &Value, texels: &[[u8; 4]], width: u32) -> DVec3 {
    let height = u32::try_from(texels.len()).expect("few") / width;
    let image =
        image::RgbaImage::from_fn(width, height, |x, y| image::Rgba(texels[(y * width + x) as usize]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("memory takes every byte");
    let mut files = Files::default();
    files.insert("map.png", bytes.into_inner().into()).expect("a sound name");
    let mut material = relief.clone();
    material["shading"] = json!("normal");
    let document = json!({
        "camera": from_above(1e-3),
        "textures": { "map": { "file": "map.png" } },
        "materials": { "relief": material },
        "meshes": { "floor": { "type": "plane", "size": [2, 2] } },
        "instances": { "floor": { "mesh": "floor", "material": "relief" } },
    });
    let [r, g, b, _] = draw(&scene_with(&document, &files), [1, 1], 4).radiance[0];
    let encode = crate::math::colour::srgb_from_linear;
    DVec3::new(r, g, b).map(|c| 2.0 * encode(c) - 1.0)
}

#[test]
fn a_normal_map_tilts_along_u_and_v() {
    // On a plane u runs along x and v along −z.
    let normal = tilted(&json!({ "normal_map": "map" }), &[[191, 96, 230, 255]], 1);
    let expected = DVec3::new(63.0, 102.0, 32.0).normalize();
    assert!(normal.distance(expected) < 1e-6, "{normal} {expected}");
}

#[test]
fn heights_tilt_by_their_slope() {
    let grey = |code: u8| [code, code, code, 255];
    // At u = ½ between the second and third of four texels, which rise by 50 codes in ¼ of 2 units.
    let ramp: Vec<[u8; 4]> = [10, 60, 110, 160].map(grey).to_vec();
    let normal = tilted(&json!({ "bump_map": "map", "bump_scale": 1.5 }), &ramp, 4);
    let slope = 50.0 / 255.0 * 1.5 / 0.5;
    let expected = DVec3::new(-slope, 1.0, 0.0).normalize();
    assert!(normal.distance(expected) < 1e-6, "{normal} {expected}");
}

#[test]
fn any_number_of_threads_gives_the_same_numbers() {
    let document =
        json!({ "meshes": { "ball": { "type": "sphere" } }, "instances": { "ball": { "mesh": "ball" } } });
    let scene = scene(&document);
    let one = draw_with(1, &scene, [24, 20], evenly(8));
    assert!(one.masks.edges.contains(&true));
    assert_eq!(one, draw_with(3, &scene, [24, 20], evenly(8)));
}

#[test]
fn samples_go_where_they_matter() {
    let document = json!({
        "environment": { "background": { "type": "color", "color": [0, 0, 0] } },
        "materials": { "white": { "shading": "unlit", "diffuse": [1, 1, 1] } },
        "meshes": { "ball": { "type": "sphere" } },
        "instances": { "ball": { "mesh": "ball", "material": "white" } },
    });
    let (scene, size) = (scene(&document), [24, 20]);
    let camera = framing::resolve(&scene, &FrameRequest::default(), size[0], size[1]).expect("a camera");
    let subject =
        Subject { scene: &scene, camera, size, t: 0.0, background: &scene.background, shading: None };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let (cancel, most) = (AtomicBool::new(false), std::sync::Mutex::new(0.0_f64));
    let work = Work { pool: &pool, cancel: &cancel, level: Level::new(), order: Order::Rows };
    let effort = Effort { base: 16, most: 256, noise: 1e-3, aim: Aim::Pixel };
    let progress = |share: f64| {
        let mut most = most.lock().expect("nobody panics");
        *most = most.max(share);
    };
    let reference = Reference::draw(&subject, effort, &progress, &work).expect("nobody cancels");
    for (samples, radiance) in reference.samples.iter().zip(&reference.radiance) {
        let is_partial = radiance[0] > 0.0 && radiance[0] < 1.0;
        assert!(if is_partial { *samples == 256 } else { *samples < 256 }, "{samples} of {radiance:?}");
    }
    assert!(reference.samples.contains(&256) && reference.samples.contains(&16));
    assert_eq!(*most.lock().expect("nobody panics"), 1.0);
    cancel.store(true, Ordering::Relaxed);
    assert_eq!(Reference::draw(&subject, effort, &progress, &work), Err(Cancelled));
}
