//! Pictures of the pipeline against the reference in f64.
//!
//! Away from edges, from the ends of shadows and from textures that are smaller than pixels both have
//! the same to say. What is left is that the pipeline shades a pixel at one point and the reference all
//! over it: they differ where the picture bends within a pixel.

use crate::draw::{Picture, file, frame, plan, png, scene, scene_with, work};
use crate::measure::{Worst, at_most};
use crate::random::Random;
use rasterd::math::colour::srgb_from_linear;
use rasterd::pipeline::Pixels;
use rasterd::plan::{FrameRequest, Output};
use rasterd::report::reference::{Aim, Effort, Masks, Reference, Subject};
use rasterd::scene::{Files, Scene, demo, gallery};
use serde_json::{Value, json};
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 120];

/// Enough for smooth pixels; the others are not looked at.
const EFFORT: Effort = Effort { base: 16, most: 64, noise: 1.0 / 512.0, aim: Aim::Pixel };

fn request(output: Output) -> FrameRequest {
    let [width, height] = SIZE.map(Some);
    FrameRequest { width, height, samples: Some(16), output, ..FrameRequest::default() }
}

fn reference(scene: &Arc<Scene>) -> Reference {
    let plan = plan(scene, &request(Output::Radiance));
    let subject = Subject {
        scene,
        camera: plan.camera,
        size: SIZE,
        t: plan.t,
        background: &plan.background,
        shading: plan.shading(),
    };
    Reference::draw(&subject, EFFORT, &|_| (), &work()).expect("nobody cancels")
}

/// Premultiplied radiance of the pipeline's picture.
fn radiance(scene: &Arc<Scene>) -> Vec<[f64; 4]> {
    let Pixels::Rgba32F { pixels, .. } = frame(scene, &request(Output::Radiance)).pixels else {
        panic!("a picture of codes")
    };
    let premultiplied = |[r, g, b, a]: [f32; 4]| [r * a, g * a, b * a, a].map(f64::from);
    pixels.into_iter().map(premultiplied).collect()
}

/// Pixels that are farther than `reach` from any of `mask`.
fn away_from(mask: &[bool], reach: i64) -> Vec<bool> {
    let [width, height] = SIZE.map(i64::from);
    let is_set = |x: i64, y: i64| {
        let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
        is_inside && mask[usize::try_from(y * width + x).expect("inside")]
    };
    let around =
        |x: i64, y: i64| (-reach..=reach).any(|dy| (-reach..=reach).any(|dx| is_set(x + dx, y + dy)));
    (0..width * height).map(|i| !around(i % width, i / width)).collect()
}

/// Errors in 1/255: of the mean pixel, and of all but one in a hundred.
struct Bound {
    mean: f64,
    most: f64,
}

/// Where only light bends: an eighth of a code, and a code in highlights.
const SMOOTH: Bound = Bound { mean: 0.125, most: 1.0 };

/// With texels of about twelve pixels. A line between two of them bends by up to 2 · 255 / 12 a pixel, by
/// a third of that in the mean of random ones; where that happens within a pixel its mean is an eighth of
/// that off its middle, 5.3 at the most. One pixel in six has such a bend, and one in 144 one each way.
const BLOTCHED: Bound = Bound { mean: 0.3, most: 5.3 };

/// Compares radiance, clamped to 0–1, in those pixels of `of` that are no edge of anything. `least` is the
/// share of the picture that they must be.
fn compare(case: &str, scene: &Arc<Scene>, bound: &Bound, of: impl Fn(&Masks, usize) -> bool, least: f64) {
    let (reference, drawn) = (reference(scene), radiance(scene));
    let masks = &reference.masks;
    let (edges, penumbrae) = (away_from(&masks.edges, 2), away_from(&masks.penumbrae, 2));
    let is_compared = |&i: &usize| edges[i] && penumbrae[i] && of(masks, i);
    let error = |i: usize| {
        let apart = |c: usize| drawn[i][c].clamp(0.0, 1.0) - reference.radiance[i][c].clamp(0.0, 1.0);
        (0..4).map(|c| apart(c).abs()).sum::<f64>() / 4.0 * 255.0
    };
    let mut errors: Vec<f64> = (0..drawn.len()).filter(is_compared).map(error).collect();
    errors.sort_unstable_by(f64::total_cmp);
    let share = errors.len() as f64 / drawn.len() as f64;
    assert!(share >= least, "{case}: only {share} of the picture is left");
    at_most(case, "mean error in 1/255", errors.iter().sum::<f64>() / errors.len() as f64, bound.mean);
    at_most(case, "error of 99 % in 1/255", errors[errors.len() * 99 / 100], bound.most);
}

fn all(_: &Masks, _: usize) -> bool {
    true
}

/// What is read from no map: the scene's textures are smaller than pixels.
fn plain(masks: &Masks, pixel: usize) -> bool {
    !masks.textured[pixel]
}

/// A picture of 16 × 16 texels, all four channels anything from `least` on.
fn blotches(least: u64) -> Files {
    let mut random = Random(0x0b10_7c4e);
    let mut code = || u8::try_from(least + random.bits() % (256 - least)).expect("a code");
    let texels: Vec<[u8; 4]> = (0..256).map(|_| [code(), code(), code(), code()]).collect();
    file("map.png", png(16, 16, |x, y| texels[(y * 16 + x) as usize]))
}

/// The document's shadows, hard and fine.
fn with_hard_shadows(mut document: Value) -> Value {
    let lights = document["lights"].as_object_mut().expect("lights");
    for shadow in lights.values_mut().filter_map(|light| light.get_mut("shadow")) {
        *shadow = json!({ "filter": "hard", "resolution": 4096 });
    }
    document
}

#[test]
fn the_demo_is_what_the_reference_says() {
    let scene = scene_with(&with_hard_shadows(demo::document()), &demo::files());
    compare("reference: demo", &scene, &SMOOTH, plain, 0.15);
}

#[test]
fn gallery_pieces_are_what_the_reference_says() {
    for (name, least) in [("triangles", 0.6), ("village", 0.3)] {
        let piece = gallery::find(name).expect("a piece").to_scene();
        let (document, files) = (piece.document.expect("a document"), piece.files.expect("files"));
        let scene = scene_with(&with_hard_shadows(document), &files);
        compare(&format!("reference: {name}"), &scene, &SMOOTH, plain, least);
    }
}

#[test]
fn a_lamp_is_what_the_reference_says() {
    let scene = scene(&with_hard_shadows(json!({
        "camera": { "position": [2, 3, 4], "target": [0, 0.3, 0], "fov_y_deg": 40 },
        "environment": { "background": { "type": "sky", "sun_direction": [-1, -1, 0.5] } },
        "lights": { "lamp": { "type": "point", "position": [1.2, 2, 0.8], "color": [1, 0.8, 0.6], "intensity": 3, "shadow": {} } },
        "materials": { "shiny": { "diffuse": [0.2, 0.3, 0.6], "specular": [0.5, 0.5, 0.5], "shininess": 20 } },
        "meshes": { "floor": { "type": "plane", "size": [6, 6] }, "box": { "type": "box" }, "ball": { "type": "sphere", "segments": 128, "rings": 64 } },
        "instances": {
            "ball": { "mesh": "ball", "material": "shiny", "translation": [-0.5, 0.5, 0.9] },
            "box": { "mesh": "box", "material": "shiny", "translation": [-0.6, 0.5, -0.7], "rotation_deg": [0, 30, 0], "scale": [-1, 1, 1] },
            "floor": { "mesh": "floor" },
        },
    })));
    compare("reference: lamp", &scene, &SMOOTH, all, 0.7);
}

/// A textured floor from close by, and a ball; their `material` reads the texture `map`.
fn close_by(material: &Value) -> Value {
    with_hard_shadows(json!({
        "camera": { "position": [0.5, 0.9, 1.3], "target": [0, 0.1, 0], "fov_y_deg": 45 },
        "environment": { "background": { "type": "gradient", "top": [0.1, 0.2, 0.6], "bottom": [0.9, 0.8, 0.7] } },
        "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.2], "shadow": {} } },
        "textures": { "map": { "file": "map.png" } },
        "materials": { "mapped": material },
        "meshes": { "floor": { "type": "plane", "size": [2, 2] }, "ball": { "type": "sphere", "radius": 0.3, "segments": 128, "rings": 64 } },
        "instances": {
            "ball": { "mesh": "ball", "material": "mapped", "translation": [0.1, 0.4, 0] },
            "floor": { "mesh": "floor", "material": "mapped" },
        },
    }))
}

#[test]
fn textures_are_what_the_reference_says() {
    let document = close_by(
        &json!({ "diffuse_map": "map", "emissive": [0.3, 0.3, 0.3], "emissive_map": "map", "alpha_cutoff": 0 }),
    );
    compare("reference: texture", &scene_with(&document, &blotches(0)), &BLOTCHED, all, 0.5);
}

#[test]
fn what_shows_through_is_what_the_reference_says() {
    let document = close_by(&json!({ "diffuse_map": "map", "opacity": 0.8, "double_sided": true }));
    compare("reference: blending", &scene_with(&document, &blotches(0)), &BLOTCHED, all, 0.3);
    let mut clear = document;
    clear["environment"]["background"] = json!({ "type": "transparent" });
    compare("reference: transparent", &scene_with(&clear, &blotches(0)), &BLOTCHED, all, 0.3);
}

#[test]
fn relief_is_what_the_reference_says() {
    // Blue from 128 on is all that a normal map asks for; a quarter of its range keeps slopes gentle.
    let files = blotches(100);
    let normals = close_by(&json!({ "normal_map": "map", "specular": [0.3, 0.3, 0.3], "shininess": 10 }));
    compare("reference: normal map", &scene_with(&normals, &files), &BLOTCHED, all, 0.3);
    let heights = close_by(&json!({ "bump_map": "map", "bump_scale": 0.02 }));
    compare("reference: bump map", &scene_with(&heights, &files), &BLOTCHED, all, 0.3);
}

/// A floor of one texel to a pixel, all of them anything, under an orthographic camera: every sample of
/// a pixel sees the same. It is one triangle: on an edge the pipeline would shade a pixel at a sample of its
/// border, where the next texel begins.
fn noise(post: &[Value]) -> Arc<Scene> {
    let mut random = Random(0x0b10_7c4e);
    let [width, height] = SIZE.map(|side| side + 2);
    let mut code = || u8::try_from(random.bits() % 256).expect("a code");
    let texels: Vec<[u8; 4]> = (0..width * height).map(|_| [code(), code(), code(), 255]).collect();
    let files = file("map.png", png(width, height, |x, y| texels[(y * width + x) as usize]));
    let [x, z] = [width, height].map(|side| f64::from(side) / 200.0);
    let positions = [[-x, 0.0, z], [3.0 * x, 0.0, z], [-x, 0.0, -3.0 * z]];
    let document = json!({
        "camera": { "position": [0, 5, 0], "target": [0, 0, 0], "up": [0, 0, -1], "orthographic": { "height": f64::from(SIZE[1]) / 100.0 } },
        "textures": { "map": { "file": "map.png", "filter": "nearest" } },
        "materials": { "mapped": { "shading": "unlit", "diffuse": [2, 2, 2], "diffuse_map": "map" } },
        "meshes": { "floor": { "type": "triangles", "positions": positions, "uvs": [[0, 0], [2, 0], [0, 2]] } },
        "instances": { "floor": { "mesh": "floor", "material": "mapped" } },
        "post": post,
    });
    scene_with(&document, &files)
}

#[test]
fn effects_are_what_the_reference_says() {
    let post = [
        json!({ "type": "bloom", "threshold": 0.5, "intensity": 0.4, "radius": 5 }),
        json!({ "type": "sharpen", "amount": 0.7 }),
        json!({ "type": "tonemap", "exposure": 1.4 }),
        json!({ "type": "blur", "radius": 2.5 }),
        json!({ "type": "kernel", "kernel": [[0, -0.3, 0], [0.2, 1.1, -0.1], [0, 0.2, 0]] }),
        json!({ "type": "vignette", "amount": 0.4 }),
        json!({ "type": "color_matrix", "matrix": [[0.9, 0.2, 0, 0.02], [0, 1.1, -0.1, 0], [0.1, 0, 0.8, 0]] }),
        json!({ "type": "grayscale", "amount": 0.3 }),
        json!({ "type": "tonemap", "operator": "reinhard", "exposure": 2 }),
    ];
    for count in 0..=post.len() {
        let scene = noise(&post[..count]);
        let reference = reference(&scene);
        let codes = Picture::new(frame(&scene, &request(Output::Color))).pixels;
        let errors = codes.iter().zip(reference.finished(&scene)).flat_map(|(code, color)| {
            (0..3).map(move |c| (f64::from(code[c]) - 255.0 * srgb_from_linear(color[c])).abs())
        });
        let worst: Worst = errors.collect();
        // Rounding to a code is half of one; f32 may take the other one at a tie.
        at_most(&format!("reference: {count} effects"), "error in codes", worst.largest(), 0.502);
    }
}
