//! Texture coordinates and their derivatives at every ratio of distances.

use super::interpolated::{corners, document, look, weights};
use crate::model::texture::{ColorSpace, Filter, Image, Texture, Wrap};
use crate::pipeline::geometry::setup::NOT_CLIPPED;
use crate::pipeline::shade::BLOCK;
use crate::pipeline::shade::texture::{Coordinates, sample};
use crate::plan::FrameRequest;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::{Picture, level, plan, scene};
use crate::report::selftest::instruments::worst::{U, Worst};
use serde_json::json;
use std::sync::Arc;

/// B21.
pub fn texture_coordinates_stay_within_sixteen_roundings_at_any_ratio_of_distances(ledger: &mut Ledger) {
    for ratio in [1.0, 1e2, 1e4, 1e6] {
        for extent in [30.0, 1000.0, 15_000.0] {
            let mut random = ledger.random(0xb21);
            let triangles: Vec<_> = (0..400).map(|_| corners(&mut random, ratio, extent)).collect();
            let positions = triangles.as_flattened();
            let uvs: Vec<_> =
                positions.iter().map(|_| [random.between(0.0, 1.0), random.between(0.0, 1.0)]).collect();
            let plan = plan(&scene(&document(positions, json!({ "uvs": uvs }))), &FrameRequest::default());
            let (mut worst, mut outside) = (Worst::default(), Worst::default());
            let looked = look(&plan, &mut random, |t, point, lane, varyings| {
                assert_eq!(t.clipped, NOT_CLIPPED);
                let corner = t.corners().map(|c| 3 * t.source as usize + c);
                let e = weights(t, point);
                let share = [0, 1, 2].map(|i| e[i] as f64 / -positions[corner[i]].z);
                for (axis, value) in varyings.texture.uv.iter().enumerate() {
                    let value = f64::from(value[lane]);
                    let at = corner.map(|c| uvs[c][axis]);
                    let exact = (0..3).map(|i| share[i] * at[i]).sum::<f64>() / share.iter().sum::<f64>();
                    let largest = at.into_iter().fold(0.0, f64::max);
                    let least = at.into_iter().fold(1.0, f64::min);
                    worst.note((value - exact).abs() / largest / U);
                    outside.note((value - largest).max(least - value) / largest / U);
                }
            });
            assert!(looked > 500, "{looked} points");
            let case = format!("w ratio {ratio:e}, {extent} px, {looked} points");
            ledger.at_most(&case, "error of u in u·max|u|", worst.largest(), 16.0);
            // B12: an interpolated value stays between those of its corners.
            ledger.at_most(&case, "excess over the corners in u·max|u|", outside.largest(), 4.0);
        }
    }
}

/// Texels of [`levels`] along a side, as in the [`document`]'s texture.
const SIDE: u32 = 1024;

/// The last level of it.
const LAST: f64 = 10.0;

/// What one level is brighter than the one above, in 65535ths.
const BRIGHTER: u16 = 4095;

/// A texture that shows the level at which it is read: each is of one grey, and trilinear filtering
/// mixes two of them.
fn levels() -> Texture {
    let black = Image { width: SIDE, height: SIDE, texels: vec![[0, 0, 0, 255]; (SIDE * SIDE) as usize] };
    let wrap = [Wrap::Repeat; 2];
    let mut texture = Texture::new(Arc::new(black), ColorSpace::Linear, Filter::Trilinear, wrap);
    for (mip, level) in Arc::make_mut(&mut texture.mips).iter_mut().zip(1..) {
        mip.texels.fill([BRIGHTER * level; 4]);
    }
    texture
}

/// The level at which [`levels`] is read for one of a block's fragments.
fn level_of(levels: &Texture, coordinates: &Coordinates, lane: usize) -> f64 {
    let mut out = [[f32::NAN; BLOCK]; 4];
    sample(level(), levels, coordinates, lane + 1, &mut out);
    f64::from(out[0][lane]) * 65535.0 / f64::from(BRIGHTER)
}

pub fn b24_the_level_of_detail_is_right_to_a_256th_and_stays_within_the_levels(ledger: &mut Ledger) {
    let levels = levels();
    let mut between = 0;
    for ratio in [1.0, 1e2, 1e4, 1e6] {
        for (extent, turns) in [(30.0, 1.0), (1000.0, 1.0), (15_000.0, 1.0), (1000.0, 1e5)] {
            let mut random = ledger.random(0xb24);
            let triangles: Vec<_> = (0..400).map(|_| corners(&mut random, ratio, extent)).collect();
            let positions = triangles.as_flattened();
            let uvs: Vec<_> =
                positions.iter().map(|_| [random.between(0.0, turns), random.between(0.0, turns)]).collect();
            let plan = plan(&scene(&document(positions, json!({ "uvs": uvs }))), &FrameRequest::default());
            let mut worst = Worst::default();
            let looked = look(&plan, &mut random, |t, point, lane, varyings| {
                let corner = t.corners().map(|c| 3 * t.source as usize + c);
                let e = weights(t, point);
                // U = Σ Eᵢ uᵢ / wᵢ and D = Σ Eᵢ / wᵢ; ∂(U/D) = (∂U − (U/D) ∂D) / D, in units per pixel.
                let step = |axis: usize| {
                    let mut next = point;
                    next[axis] += 1;
                    let there = weights(t, next);
                    [0, 1, 2].map(|i| (there[i] - e[i]) as f64 * 256.0)
                };
                let per_w = corner.map(|c| 1.0 / -positions[c].z);
                let sum =
                    |e: [f64; 3], value: [f64; 3]| (0..3).map(|i| e[i] * per_w[i] * value[i]).sum::<f64>();
                let here = e.map(|e| e as f64);
                let d = sum(here, [1.0; 3]);
                let squared = |axis: usize| {
                    let de = step(axis);
                    let along = [0, 1].map(|c| {
                        // From one of the corners, so that whole turns do not cancel.
                        let value = corner.map(|at| uvs[at][c] - uvs[corner[0]][c]);
                        (sum(de, value) - sum(here, value) / d * sum(de, [1.0; 3])) / d
                    });
                    along[0] * along[0] + along[1] * along[1]
                };
                let exact = squared(0).max(squared(1)).log2() / 2.0 + f64::from(SIDE).log2();
                worst.note((level_of(&levels, &varyings.texture, lane) - exact.clamp(0.0, LAST)).abs());
                between += usize::from(exact > 0.0 && exact < LAST);
            });
            assert!(looked > 500, "{looked} points");
            let case = format!("w ratio {ratio:e}, {extent} px, {turns:e} turns, {looked} points");
            ledger.at_most(&case, "error of the level", worst.largest(), 1.0 / 256.0);
        }
    }
    assert!(between > 2000, "{between} points between the first level and the last");
}

/// At the horizon derivatives are infinite, or no numbers.
pub fn b24_derivatives_beyond_all_bounds_read_the_first_level_or_the_last(ledger: &mut Ledger) {
    let levels = levels();
    let texel = 1.0 / SIDE as f32;
    let all = [0..1, 1..2, 2..3, 3..4, 0..4];
    for (step, expected, fields) in [
        (0.0, 0.0, &all[..]),
        (1e-40, 0.0, &all),
        (texel, 0.0, &all[..4]),
        (texel * 8.0, 3.0, &all[..4]),
        (1.0, LAST, &all),
        (1e30, LAST, &all),
        (-f32::MAX, LAST, &all),
        (f32::INFINITY, LAST, &all),
        (f32::NAN, LAST, &all),
    ] {
        for fields in fields {
            let mut coordinates = Coordinates::default();
            coordinates.per_pixel[fields.clone()].fill([step; BLOCK]);
            let level = level_of(&levels, &coordinates, 0);
            let case = format!("derivatives {fields:?} {step:e}");
            ledger.at_most(&case, "error of the level", (level - expected).abs(), 1e-5);
        }
    }
}

/// Where a coordinate is in a picture that repeats every two units, between −1 and 1 from another.
fn apart(a: f64, b: f64) -> f64 {
    (a - b) - ((a - b) / 2.0).round() * 2.0
}

pub fn b22_coordinates_around_a_million_read_the_texel_that_they_name(ledger: &mut Ledger) {
    for offset in [0.0, 1e6, 1e6 + 1.0, 1e7, -1e7] {
        for (wrap, span) in [("repeat", 1.0), ("repeat", 32.0), ("mirror", 1.0), ("mirror", 32.0)] {
            let mut random = ledger.random(0xb22);
            let triangles: Vec<_> = (0..400).map(|_| corners(&mut random, 1e3, 1000.0)).collect();
            let positions = triangles.as_flattened();
            let uvs: Vec<_> =
                positions.iter().map(|_| [0; 2].map(|_| offset + random.between(0.0, span))).collect();
            let mut document = document(positions, json!({ "uvs": uvs }));
            document["textures"]["t"]["wrap"] = json!(wrap);
            let plan = plan(&scene(&document), &FrameRequest::default());
            let mut worst = Worst::default();
            let looked = look(&plan, &mut random, |t, point, lane, varyings| {
                let corner = t.corners().map(|c| 3 * t.source as usize + c);
                let e = weights(t, point);
                let share = [0, 1, 2].map(|i| e[i] as f64 / -positions[corner[i]].z);
                for (axis, value) in varyings.texture.uv.iter().enumerate() {
                    let at = corner.map(|c| uvs[c][axis]);
                    let exact = (0..3).map(|i| share[i] * at[i]).sum::<f64>() / share.iter().sum::<f64>();
                    worst.note(apart(f64::from(value[lane]), exact).abs());
                }
            });
            assert!(looked > 500, "{looked} points");
            let case = format!("{offset:e}, {wrap}, span {span}");
            ledger.at_most(&case, "texels of 1024", worst.largest() * 1024.0, 1.0 / 256.0);
        }
    }
}

pub fn b22_a_picture_is_the_same_a_million_turns_on(ledger: &mut Ledger) {
    let drawn = |turns: f64, wrap: &str| {
        let uvs = [[-1.3, 0.2], [2.1, 0.4], [0.3, 3.2]].map(|uv: [f64; 2]| uv.map(|c| c + turns));
        let positions =
            [[-1.5, -1.2, -2.0], [1.7, -1.0, -3.0], [0.1, 1.6, -2.2]].map(glam::DVec3::from_array);
        let mut document = document(&positions, json!({ "uvs": uvs }));
        document["textures"]["t"]["wrap"] = json!(wrap);
        document["materials"]["m"]["shading"] = json!("unlit");
        Picture::of(&document)
    };
    for wrap in ["repeat", "mirror"] {
        let near = drawn(0.0, wrap);
        for turns in [1e6, 1e7] {
            let far = drawn(turns, wrap);
            let apart = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|c| a[c].abs_diff(b[c])).max();
            let worst = near.pixels.iter().zip(&far.pixels).filter_map(apart).max();
            // 1/256 of a texel is worth 1/256 of the difference of two texels.
            ledger.at_most(&format!("{turns:e} {wrap}"), "codes", worst.map_or(0.0, f64::from), 1.0);
        }
    }
}
