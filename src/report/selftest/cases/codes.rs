//! Values as codes, and codes as values (B42).

use crate::encode;
use crate::pipeline::Pixels;
use crate::plan::{FrameRequest, Output};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::{
    Picture, file, frame, output, png, scene, scene_with, values,
};
use serde_json::{Value, json};

/// Triangles that fill pictures of 256 columns; x and y count pixels from the upper left corner.
fn document(height: u32, mesh: Value) -> Value {
    let (x, y) = (128.0, -0.5 * f64::from(height));
    json!({
        "camera": { "position": [x, y, 0], "target": [x, y, -1], "orthographic": { "height": height },
                    "near": 1, "far": 65536 },
        "environment": { "background": { "type": "transparent" } },
        "lights": {},
        "materials": { "m": { "shading": "unlit", "diffuse": [1, 1, 1], "double_sided": true } },
        "meshes": { "m": mesh },
        "instances": { "i": { "mesh": "m", "material": "m" } },
        "render": { "width": 256, "height": height, "samples": 1 },
    })
}

/// The distances of 256 × 256 pixels are those of the 65,536 codes, in order: each row is a slanted
/// strip. The first pixel and the last are level, since a strip would leave the range there.
pub fn b42_every_16_bit_code_survives_the_way_through_depth_and_a_file(ledger: &mut Ledger) {
    let mut positions = Vec::new();
    let mut quad = |row: u32, columns: [u32; 2], codes: [f64; 2]| {
        let corner = |side: usize, row: u32| [f64::from(columns[side]), -f64::from(row), -1.0 - codes[side]];
        positions.extend([corner(0, row), corner(0, row + 1), corner(1, row + 1), corner(1, row)]);
    };
    for row in 0..256 {
        let columns = [u32::from(row == 0), 256 - u32::from(row == 255)];
        quad(row, columns, columns.map(|column| f64::from(256 * row + column) - 0.5));
    }
    quad(0, [0, 1], [0.0; 2]);
    quad(255, [255, 256], [65535.0; 2]);
    let indices: Vec<_> = (0..positions.len() / 4)
        .flat_map(|quad| [0, 1, 2, 0, 2, 3].map(|corner| 4 * quad + corner))
        .collect();
    let mesh = json!({ "type": "triangles", "positions": positions, "indices": indices });
    let depth = frame(&scene(&document(256, mesh)), &output(Output::Depth));
    assert_eq!(depth.depth_range, Some([1.0, 65536.0]));
    let picture = image::load_from_memory(&encode::png(&depth)).expect("a PNG").into_luma16();
    let codes = values(depth);
    let wrong = |read: &[u16]| read.iter().zip(0u32..).filter(|(code, i)| u32::from(**code) != *i).count();
    ledger.none_of("depth", "differing codes", wrong(&codes), codes.len());
    ledger.none_of("depth in a file", "differing codes", wrong(picture.as_raw()), picture.as_raw().len());
}

/// Straight colour under every alpha but 0, which has none.
pub fn b42_every_code_of_alpha_survives_and_the_colour_under_it(ledger: &mut Ledger) {
    let byte = |x: u32| u8::try_from(x).expect("256 codes");
    let texel = |x: u32, _: u32| [byte(255 - x), 200, byte(x / 2), byte(x)];
    let files = file("codes.png", png(256, 1, texel));
    let mesh = json!({ "type": "triangles", "indices": [0, 1, 2, 0, 2, 3], "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]],
        "positions": [[0, -1, -2], [256, -1, -2], [256, 0, -2], [0, 0, -2]] });
    let mut document = document(1, mesh);
    document["textures"] = json!({ "t": { "file": "codes.png", "filter": "nearest" } });
    document["materials"]["m"]["diffuse_map"] = json!("t");
    for samples in [1, 4, 16] {
        document["render"]["samples"] = json!(samples);
        let drawn = frame(&scene_with(&document, &files), &FrameRequest::default());
        let read = image::load_from_memory(&encode::png(&drawn)).expect("a PNG").into_rgba8();
        let expected = |x: u32| if x == 0 { [0; 4] } else { texel(x, 0) };
        let wrong = Picture::new(drawn).iter().filter(|&(x, _, pixel)| pixel != expected(x)).count();
        ledger.none_of(&format!("alpha, {samples} samples"), "differing pixels", wrong, 256);
        let wrong = (0..256).filter(|&x| read.get_pixel(x, 0).0 != expected(x)).count();
        ledger.none_of(&format!("alpha in a file, {samples} samples"), "differing pixels", wrong, 256);
    }
}

/// Floats of a picture under a light beyond all brightness.
pub fn b42_radiance_in_floats_is_finite_and_clamped(ledger: &mut Ledger) {
    for intensity in [1e5, 1e20, 1e37] {
        let document = json!({
            "camera": { "position": [0, 1, 1], "target": [0, 0, 0] },
            "lights": { "lamp": { "type": "point", "position": [0, 1e-3, 0], "intensity": intensity } },
            "materials": { "m": { "specular": [1, 1, 1], "emissive": [1e30, 0, 1e-40] } },
            "meshes": { "floor": { "type": "plane", "size": [4, 4] } },
            "instances": { "floor": { "mesh": "floor", "material": "m" } },
            "render": { "width": 64, "height": 64 },
        });
        let drawn = frame(&scene(&document), &output(Output::Radiance));
        let Pixels::Rgba32F { pixels, .. } = drawn.pixels else { panic!("asked for floats") };
        let floats = pixels.as_flattened();
        let beyond = floats.iter().filter(|value| !(0.0..=65504.0).contains(*value)).count();
        ledger.none_of(
            &format!("intensity {intensity:e}"),
            "floats that are not in 0 to 65504",
            beyond,
            floats.len(),
        );
        let clamped = floats.iter().filter(|value| **value == 65504.0).count();
        ledger.at_least(
            &format!("intensity {intensity:e}"),
            "control: floats that are clamped",
            clamped as f64,
            64.0,
        );
    }
}
