//! `Output::Radiance`: linear colour before `post`, in floats.

use crate::closed_form::{Camera, encode};
use crate::draw::{frame, output, scene};
use rasterd::pipeline::Pixels;
use rasterd::plan::{FrameRequest, Output};
use serde_json::{Value, json};

/// A square of one linear colour that fills the left half of the picture, before a background.
fn half(color: [f64; 3], background: Value, samples: u32) -> Value {
    let camera = Camera::orthographic([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], 2.0, 70, 66);
    json!({
        "camera": camera.document(),
        "environment": { "background": background },
        "lights": {},
        "materials": { "m": { "shading": "unlit", "diffuse": [0, 0, 0], "emissive": color } },
        "meshes": { "m": { "type": "triangles", "indices": [0, 1, 2, 0, 2, 3],
            "positions": [[-2, -2, 0], [0.0152, -2, 0], [0.0152, 2, 0], [-2, 2, 0]] } },
        "instances": { "m": { "mesh": "m", "material": "m" } },
        "render": camera.render(samples),
    })
}

fn radiance(document: &Value) -> (Vec<[f32; 4]>, bool) {
    let Pixels::Rgba32F { pixels, opaque } = frame(&scene(document), &output(Output::Radiance)).pixels else {
        panic!("asked for radiance")
    };
    assert_eq!(pixels.len(), 70 * 66);
    (pixels, opaque)
}

#[test]
fn radiance_is_linear_and_beyond_one() {
    let (pixels, opaque) =
        radiance(&half([2.5, 0.25, 0.0], json!({ "type": "color", "color": [3, 0, 0.5] }), 4));
    assert!(opaque);
    assert_eq!(pixels[0], [2.5, 0.25, 0.0, 1.0]);
    assert_eq!(pixels[69], [3.0, 0.0, 0.5, 1.0]);
}

#[test]
fn radiance_is_that_before_post() {
    let mut document = half([2.5, 0.25, 0.0], json!({ "type": "color", "color": [3, 0, 0.5] }), 4);
    let before = radiance(&document);
    document["post"] = json!([{ "type": "blur" }, { "type": "tonemap" }, { "type": "grayscale" }]);
    assert_eq!(radiance(&document), before);
}

#[test]
fn radiance_is_finite_whatever_shines() {
    let (pixels, _) =
        radiance(&half([1e18, 1e-30, 7e4], json!({ "type": "color", "color": [1e18, 65504, 1] }), 2));
    assert!(pixels.iter().flatten().all(|value| (0.0..=65504.0).contains(value)));
    assert_eq!(pixels[0], [65504.0, 1e-30, 65504.0, 1.0]);
    assert_eq!(pixels[69], [65504.0, 65504.0, 1.0, 1.0]);
}

#[test]
fn radiance_is_finite_through_glass() {
    let mut document = half([1e18, 1e-30, 7e4], json!({ "type": "color", "color": [1e18, 65504, 1] }), 4);
    document["materials"]["glass"] = json!({ "opacity": 0.25, "shading": "unlit", "diffuse": [0, 0, 0] });
    document["instances"]["glass"] =
        json!({ "mesh": "m", "material": "glass", "translation": [0, 0, 0.5], "scale": [3, 1, 1] });
    let (pixels, _) = radiance(&document);
    assert!(pixels.iter().flatten().all(|value| (0.0..=65504.0).contains(value)));
    assert_eq!(pixels[0][0], 65504.0 * 0.75);
    // Through the pixels that the edge behind the glass goes through.
    assert!(pixels[35][0] <= 65504.0 * 0.75 && pixels[35][2] > pixels[34][2].min(pixels[36][2]));
}

#[test]
fn radiance_before_a_transparent_background_is_straight() {
    let (pixels, opaque) = radiance(&half([2.5, 0.25, 0.0], json!({ "type": "transparent" }), 4));
    assert!(!opaque);
    assert_eq!((pixels[0], pixels[69]), ([2.5, 0.25, 0.0, 1.0], [0.0; 4]));
    let edge: Vec<_> = pixels.iter().filter(|pixel| pixel[3] > 0.0 && pixel[3] < 1.0).collect();
    assert_eq!(edge.len(), 66, "the square ends within a column");
    assert!(edge.iter().all(|pixel| pixel[..3] == [2.5, 0.25, 0.0]));
}

#[test]
fn radiance_encodes_to_the_bytes_of_the_picture() {
    let document = half([0.3, 0.02, 0.7], json!({ "type": "gradient" }), 8);
    let (pixels, _) = radiance(&document);
    let Pixels::Rgba8 { pixels: bytes, .. } = frame(&scene(&document), &FrameRequest::default()).pixels
    else {
        panic!("asked for colours")
    };
    let code = |linear: f32| (encode(f64::from(linear)) * 255.0 + 0.5).floor();
    let differing = pixels
        .iter()
        .flatten()
        .zip(bytes.iter().flatten())
        .filter(|(linear, byte)| **byte < 255 && code(**linear) != f64::from(**byte));
    assert!(differing.count() <= 1, "encoding may differ from f64 in one of 100,000 numbers");
}
