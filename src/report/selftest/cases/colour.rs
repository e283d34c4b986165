//! sRGB codes in, linear light, sRGB codes out.

use crate::math::approx;
use crate::math::simd::*;
use crate::plan::FrameRequest;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::closed_form::encode;
use crate::report::selftest::instruments::draw::{Picture, file, frame, level, png, scene_with};
use crate::report::selftest::instruments::worst::Worst;
use crate::scene::Files;
use serde_json::{Value, json};

/// Quads side by side in a row, one for each colour or texture coordinate.
fn row(count: usize) -> Value {
    let positions = (0..count).flat_map(|i| {
        let (left, right) = (i as f64, i as f64 + 1.0);
        [[left, 0.0, 0.0], [right, 0.0, 0.0], [right, 1.0, 0.0], [left, 1.0, 0.0]]
    });
    let indices = (0..count).flat_map(|i| [0, 1, 2, 0, 2, 3].map(|corner| 4 * i + corner));
    json!({
        "type": "triangles", "positions": positions.collect::<Vec<_>>(), "indices": indices.collect::<Vec<_>>(),
    })
}

fn document(count: usize, mesh: Value) -> Value {
    let middle = count as f64 / 2.0;
    json!({
        "camera": { "position": [middle, 0.5, 5], "target": [middle, 0.5, 0], "orthographic": { "height": 1 } },
        "lights": {},
        "materials": { "m": { "shading": "unlit", "diffuse": [1, 1, 1] } },
        "meshes": { "m": mesh },
        "instances": { "i": { "mesh": "m", "material": "m" } },
        "render": { "width": count, "height": 1, "samples": 1 },
    })
}

fn draw(document: &Value, files: &Files) -> Picture {
    Picture::new(frame(&scene_with(document, files), &FrameRequest::default()))
}

/// B41.
pub fn every_code_of_a_texture_survives_the_way_through_linear_light(ledger: &mut Ledger) {
    for filter in ["nearest", "bilinear", "trilinear"] {
        let mut document = document(
            256,
            json!({ "type": "triangles",
            "positions": [[0, 0, 0], [256, 0, 0], [256, 1, 0], [0, 1, 0]], "indices": [0, 1, 2, 0, 2, 3],
            "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]] }),
        );
        document["textures"] = json!({ "t": { "file": "codes.png", "filter": filter } });
        document["materials"]["m"]["diffuse_map"] = json!("t");
        let byte = |x: u32| u8::try_from(x).expect("256 codes");
        let texel = |x: u32, _: u32| [byte(x), byte(255 - x), byte(x / 2), 255];
        let picture = draw(&document, &file("codes.png", png(256, 1, texel)));
        let wrong = picture.iter().filter(|&(x, y, pixel)| pixel != texel(x, y)).count();
        ledger.none_of(&format!("texture, {filter}"), "differing codes", wrong, 256);
    }
}

/// B41.
pub fn every_code_of_a_colour_in_the_document_survives(ledger: &mut Ledger) {
    for code in 0..=255u8 {
        let camera = json!({ "position": [0, 0, 1], "target": [0, 0, 0] });
        let colour = format!("#{code:02x}{:02x}{:02x}", 255 - code, code / 2);
        let document = json!({
            "camera": camera, "environment": { "background": { "type": "color", "color": colour } },
            "render": { "width": 1, "height": 1, "samples": 4 },
        });
        let drawn = draw(&document, &Files::default()).at(0, 0);
        ledger.holds(&colour, "colours that came out as others", drawn == [code, 255 - code, code / 2, 255]);
    }
}

/// B41, through the whole pipeline: linear numbers as vertex colours.
pub fn linear_numbers_are_encoded_to_the_nearest_code(ledger: &mut Ledger) {
    let count = 4096usize;
    let mut mesh = row(count);
    let linear = |i: usize| i as f64 / (count - 1) as f64;
    let colors: Vec<_> =
        (0..count).flat_map(|i| [[linear(i), linear(i).powi(2), linear(i).powi(3)]; 4]).collect();
    mesh["colors"] = json!(colors);
    let picture = draw(&document(count, mesh), &Files::default());
    let apart = picture.iter().map(|(x, _, pixel)| {
        let value = linear(x as usize);
        let off = |c: usize, linear: f64| (f64::from(pixel[c]) - 255.0 * encode(linear)).abs();
        off(0, value).max(off(1, value.powi(2))).max(off(2, value.powi(3)))
    });
    // Half a code, and f32's share: 2⁻²⁴ of a value whose slope is at most 12.92 · 255.
    ledger.at_most("linear numbers", "difference in codes", apart.collect::<Worst>().largest(), 0.5 + 2e-4);
}

/// B41: every 257th of all f32 from 0 to 1.
pub fn encoding_is_within_one_code_and_differs_from_f64_in_one_of_100_000(ledger: &mut Ledger) {
    let (mut differing, mut tested, mut worst) = (0u32, 0u32, Worst::default());
    let end = 1.0f32.to_bits();
    for first in (0..=end).step_by(LANES * 257) {
        let xs: [f32; LANES] = std::array::from_fn(|i| {
            let offset = u32::try_from(i * 257).expect("eight lanes");
            f32::from_bits((first + offset).min(end))
        });
        let codes = dispatch!(level(), simd => {
            let codes: f32x8<_> = (approx::srgb_from_linear(f32x8::simd_from(simd, xs)) * 255.0 + 0.5).floor();
            codes.to_array()
        });
        for (x, code) in xs.into_iter().zip(codes) {
            let exact = (encode(f64::from(x)) * 255.0 + 0.5).floor();
            worst.note((f64::from(code) - exact).abs());
            differing += u32::from(f64::from(code) != exact);
            tested += 1;
        }
    }
    ledger.at_most(&format!("encoding, {tested} numbers"), "codes apart", worst.largest(), 1.0);
    ledger.at_most(
        &format!("encoding, {tested} numbers"),
        "share that differs",
        f64::from(differing) / f64::from(tested),
        1e-5,
    );
}
