//! Textures of odd sizes, and coordinates on borders and beyond all reason.

use crate::limits::Limits;
use crate::model::texture::{ColorSpace, Filter, Image, Texture, Wrap};
use crate::pipeline::shade::BLOCK;
use crate::pipeline::shade::texture::{Coordinates, sample};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::closed_form::{self, Camera};
use crate::report::selftest::instruments::draw::{Picture, file, level, levels, png};
use crate::report::selftest::instruments::worst::Worst;
use crate::scene::{Document, compile};
use fearless_simd::Level;
use glam::DVec3;
use serde_json::json;
use std::sync::Arc;

const FILTERS: [Filter; 3] = [Filter::Nearest, Filter::Bilinear, Filter::Trilinear];
const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];

/// A different code in every texel of a small image.
fn image(width: u32, height: u32) -> Arc<Image> {
    let code = |i: u32, salt: u32| u8::try_from((i * 37 + salt * 91 + 11) % 256).expect("a byte");
    let texels = (0..width * height).map(|i| [code(i, 0), code(i, 1), code(i, 2), code(i, 3)]).collect();
    Arc::new(Image { width, height, texels })
}

/// What a texture shows at a coordinate, seen at its own size: red, green, blue, alpha.
fn sampled(level: Level, texture: &Texture, u: f32, v: f32, step: f32) -> [f32; 4] {
    let coordinates = Coordinates {
        uv: [[u; BLOCK], [v; BLOCK]],
        per_pixel: [[step; BLOCK], [0.0; BLOCK], [0.0; BLOCK], [step; BLOCK]],
    };
    let mut out = [[f32::NAN; BLOCK]; 4];
    sample(level, texture, &coordinates, 1, &mut out);
    out.map(|channel| channel[0])
}

/// Coordinates on borders, next to them, and far beyond f32's whole numbers.
fn coordinates() -> Vec<f32> {
    let u = f32::EPSILON / 2.0;
    vec![
        -0.0,
        0.0,
        1.0 - u,
        1.0,
        1.0 + 2.0 * u,
        -1e-30,
        -u,
        1e20,
        -1e20,
        3e38,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ]
}

/// B23.
pub fn a_texture_of_one_texel_is_that_texel_everywhere(ledger: &mut Ledger) {
    let image = image(1, 1);
    for color_space in [ColorSpace::Srgb, ColorSpace::Linear] {
        let texel = image.texels[0].map(f64::from);
        let exact = [0, 1, 2, 3].map(|c| match color_space {
            ColorSpace::Srgb if c < 3 => closed_form::decode(image.texels[0][c]),
            _ => texel[c] / 255.0,
        });
        for filter in FILTERS {
            for wrap in WRAPS {
                let texture = Texture::new(image.clone(), color_space, filter, [wrap; 2]);
                let expected = sampled(level(), &texture, 0.5, 0.5, 0.0);
                let off = (0..4)
                    .map(|c| (f64::from(expected[c]) / exact[c] - 1.0).abs())
                    .collect::<Worst>()
                    .largest();
                // Decoding is rounded once.
                ledger.at_most(&format!("1×1 {filter:?} {wrap:?}"), "relative error", off, 6e-8);
                for u in coordinates() {
                    for step in [0.0, 1.0, 1e30, f32::INFINITY, f32::NAN] {
                        for [u, v] in [[u, 0.3], [0.3, u]] {
                            let is_texel = sampled(level(), &texture, u, v, step) == expected;
                            ledger.holds(&format!("at {u}, {v}"), "other than the one texel", is_texel);
                        }
                    }
                }
            }
        }
    }
}

/// B23.
pub fn coordinates_on_the_border_read_the_border_texel(ledger: &mut Ledger) {
    let image = image(5, 3);
    let u = f32::EPSILON / 2.0;
    for wrap in WRAPS {
        let texture = Texture::new(image.clone(), ColorSpace::Linear, Filter::Nearest, [wrap; 2]);
        let column = |at: f32| {
            let red = sampled(level(), &texture, at, 0.99, 0.0)[0];
            (0..5).find(|x| f32::from(image.texels[*x][0]) / 255.0 == red)
        };
        // Just above 1 the picture repeats, or goes on, or turns.
        let (repeats, turns) = (matches!(wrap, Wrap::Repeat), matches!(wrap, Wrap::Mirror));
        let last_or_first = if repeats { 0 } else { 4 };
        for (at, expected) in [
            (0.0, 0),
            (-0.0, 0),
            (1.0 - u, 4),
            (1.0, last_or_first),
            (1.0 + 2.0 * u, last_or_first),
            (-u, if repeats { 4 } else { 0 }),
            (
                1.3,
                if repeats {
                    1
                } else if turns {
                    3
                } else {
                    4
                },
            ),
        ] {
            let setting = format!("{wrap:?} at {at:e}");
            ledger.holds(&setting, "other texels on the border", column(at) == Some(expected));
        }
    }
}

/// B23.
pub fn whatever_is_asked_the_answer_lies_between_the_texels_at_every_simd_level(ledger: &mut Ledger) {
    let (mut outside, mut unlike, mut read) = (0, 0, 0);
    for (width, height) in [(1, 1), (1, 7), (3, 5), (64, 2)] {
        let image = image(width, height);
        for filter in FILTERS {
            for wrap in WRAPS {
                let texture = Texture::new(image.clone(), ColorSpace::Linear, filter, [wrap; 2]);
                for u in coordinates() {
                    for v in coordinates() {
                        for step in [0.0, 0.3, 1e30, f32::NAN] {
                            let texel = sampled(level(), &texture, u, v, step);
                            let within = texel.iter().all(|c| (0.0..=1.000_001).contains(c));
                            outside += usize::from(!within);
                            read += 1;
                            for (_, level) in levels() {
                                let same = sampled(level, &texture, u, v, step).map(f32::to_bits);
                                unlike += usize::from(same != texel.map(f32::to_bits));
                            }
                        }
                    }
                }
            }
        }
    }
    ledger.none_of("", "answers beyond 0 to 1", outside, read);
    ledger.none_of("every SIMD level", "answers of other bits", unlike, read);
}

/// B23.
pub fn mips_of_every_size_keep_the_mean(ledger: &mut Ledger) {
    for (width, height) in [(1, 9), (3, 5), (7, 1), (33, 17), (255, 129), (16_384, 1), (1, 16_384)] {
        let image = image(width, height);
        let texture = Texture::new(image.clone(), ColorSpace::Linear, Filter::Trilinear, [Wrap::Repeat; 2]);
        let count = f64::from(width) * f64::from(height);
        let (mut side, mut worst) = ([width, height], Worst::default());
        for level in texture.mips.iter() {
            side = side.map(|n| (n / 2).max(1));
            assert_eq!([level.width, level.height], side);
            for c in 0..4 {
                let mean = image.texels.iter().map(|t| f64::from(t[c])).sum::<f64>() / count / 255.0;
                let size = level.texels.len() as f64;
                let here = level.texels.iter().map(|t| f64::from(t[c])).sum::<f64>() / size / 65535.0;
                worst.note((here - mean).abs());
            }
        }
        assert_eq!(side, [1, 1]);
        // 2u for each of at most 14 levels, and half a code of 16 bits once: a level is made from the
        // unrounded one above.
        let bound = 14.0 * 2.0 * 6e-8 + 0.5 / 65535.0;
        ledger.at_most(&format!("mips of {width}×{height}"), "shift of the mean", worst.largest(), bound);
    }
}

/// B23.
pub fn images_that_are_too_large_or_damaged_are_refused(ledger: &mut Ledger) {
    let document =
        json!({ "textures": { "t": { "file": "t.png" } }, "materials": { "m": { "diffuse_map": "t" } } });
    let document = Document::from_json(&document).expect("a valid document");
    let compiled = |bytes: Vec<u8>| compile(&document, &file("t.png", bytes), None, &Limits::default());
    let whole = png(9, 5, |_, _| [1, 2, 3, 255]);
    let nowhere = |side: u32| png(side, 1, |_, _| [0; 4]);
    for (name, bytes, is_good) in [
        ("whole", whole.clone(), true),
        ("half of the file", whole[..whole.len() / 2].to_vec(), false),
        ("no bytes", Vec::new(), false),
        ("no texels", without_texels(whole), false),
        ("16384 × 1", nowhere(16_384), true),
        ("16385 × 1", nowhere(16_385), false),
    ] {
        ledger.holds(name, "images taken or refused wrongly", compiled(bytes).is_ok() == is_good);
    }
    let side = ledger.effort.pick(4096, 16_384);
    let large = png(side, side, |x, y| [x as u8, y as u8, (x ^ y) as u8, 255]);
    let limits = Limits { scene_bytes: u64::MAX, ..Limits::default() };
    let is_taken = compile(&document, &file("t.png", large), None, &limits).is_ok();
    ledger.holds(&format!("{side} × {side}"), "images taken or refused wrongly", is_taken);
}

/// A PNG file whose head says that it is 0 × 0.
fn without_texels(mut png: Vec<u8>) -> Vec<u8> {
    // Behind 8 bytes of signature: length, "IHDR", width and height, 5 bytes more, and their checksum.
    png[16..24].fill(0);
    let checksum = crc32fast::hash(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.to_be_bytes());
    png
}

/// B24: where a pixel spans the whole texture many times over, it shows the mean of the texture in linear
/// light, up to the horizon.
pub fn a_floor_to_the_horizon_fades_to_its_mean(ledger: &mut Ledger) {
    let camera = Camera::perspective([0.0, 1.0, 0.0], [0.3, 0.8, -1.0], 60.0, 160, 120);
    let document = json!({
        "camera": camera.document(),
        "environment": { "background": { "type": "color", "color": "#f00" } },
        "lights": {},
        "textures": { "t": { "checker": { "colors": ["#000", "#fff"], "cells": 8 } } },
        "materials": { "m": { "shading": "unlit", "diffuse": [1, 1, 1], "diffuse_map": "t" } },
        "meshes": { "floor": { "type": "plane", "size": [2e5, 2e5], "uv_repeat": [1e5, 1e5] } },
        "instances": { "floor": { "mesh": "floor", "material": "m" } },
        "render": camera.render(1),
    });
    let mean = 255.0 * closed_form::encode(0.5);
    let on_floor = |x: u32, y: f64| {
        let ray = camera.ray(f64::from(x) + 0.5, y);
        closed_form::hit_plane(ray, DVec3::ZERO, DVec3::Y).map(|s| ray.at(s))
    };
    let (mut worst, mut looked) = (Worst::default(), 0);
    for (x, y, pixel) in Picture::of(&document).iter() {
        let [above, here, below] = [0.0, 0.5, 1.0].map(|part| on_floor(x, f64::from(y) + part));
        let (Some(here), Some(below)) = (here, below) else { continue };
        let is_inside = here.abs().max_element() < 0.9e5;
        // A turn of the texture is two units of the floor.
        let turns = above.map_or(f64::INFINITY, |above| (above - below).length() / 2.0);
        if is_inside && turns > 4.0 {
            looked += 1;
            worst.note((f64::from(pixel[0]) - mean).abs());
        }
    }
    assert!(looked > 500, "{looked} pixels are too few to show anything");
    ledger.at_most("", "difference from the mean in codes", worst.largest(), 1.0);
}
