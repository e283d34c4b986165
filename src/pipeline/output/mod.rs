//! Output: linear colour to bytes, and what the data outputs show.

use super::geometry::Bins;
use super::geometry::setup::Triangle;
use super::tiles::cover::Region;
use super::tiles::fragments::Fragments;
use super::tiles::{self, Scratch};
use super::work::{Cancelled, Work};
use crate::math::simd::*;
use crate::math::{View, approx};
use crate::plan::{Draw, Plan};

/// Encodes a tile's colours: clamp to 0–1, sRGB, `floor(255 x + ½)`. Alpha is the coverage where the
/// background is transparent, 255 else; colours are straight.
pub fn encode_tile(
    level: Level,
    fragments: &Fragments,
    colors: &[Vec<f32>; 3],
    samples: u32,
    opaque: bool,
    side: usize,
    rows: Vec<&mut [[u8; 4]]>,
) {
    let coverage = if opaque { Vec::new() } else { coverage_of(fragments, samples, side) };
    dispatch!(level, simd => encode_kernel(simd, colors, &coverage, opaque, side, rows));
}

#[inline(always)]
fn encode_kernel<S: Simd>(
    simd: S,
    colors: &[Vec<f32>; 3],
    coverage: &[f32],
    opaque: bool,
    side: usize,
    rows: Vec<&mut [[u8; 4]]>,
) {
    for (y, row) in rows.into_iter().enumerate() {
        for (x, pixels) in (0..).step_by(LANES).zip(row.chunks_mut(LANES)) {
            let at = y * side + x;
            let codes = always(
                #[inline(always)]
                |c: usize| {
                    let linear = f32x8::from_slice(simd, &colors[c][at..at + LANES]);
                    let straight = if opaque {
                        linear
                    } else {
                        linear / f32x8::from_slice(simd, &coverage[at..at + LANES])
                    };
                    srgb_codes(simd, straight)
                },
            );
            let codes = [codes(0), codes(1), codes(2)];
            for (lane, pixel) in pixels.iter_mut().enumerate() {
                let alpha = if opaque { 255 } else { alpha_code(coverage[at + lane]) };
                *pixel = [byte(codes[0][lane]), byte(codes[1][lane]), byte(codes[2][lane]), alpha];
            }
        }
    }
}

/// sRGB codes of eight linear values; what is no number is 0.
#[inline(always)]
fn srgb_codes<S: Simd>(simd: S, linear: f32x8<S>) -> [i32; LANES] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let clamped = min(max(linear, zero), one);
    let codes: i32x8<S> = (approx::srgb_from_linear(clamped) * 255.0 + 0.5).floor().to_int_precise();
    codes.to_array()
}

/// A code as a byte.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "codes are in 0–255")]
fn byte(code: i32) -> u8 {
    code as u8
}

/// Share of each pixel's samples that a surface covers.
fn coverage_of(fragments: &Fragments, samples: u32, side: usize) -> Vec<f32> {
    let mut coverage = vec![1.0; side * side];
    for &pixel in &fragments.sky {
        coverage[pixel as usize] = 0.0;
    }
    for shared in &fragments.shared {
        let masks = &fragments.masks[shared.first as usize..(shared.first + shared.count) as usize];
        let covered: u32 = masks.iter().map(|mask| mask.count_ones()).sum();
        coverage[shared.pixel as usize] = small(covered) / small(samples);
    }
    coverage
}

#[expect(clippy::cast_precision_loss, reason = "at most 16")]
fn small(n: u32) -> f32 {
    n as f32
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "coverage is in 0–1")]
fn alpha_code(coverage: f32) -> u8 {
    (255.0 * coverage + 0.5).floor() as u8
}

/// Draws a picture of 16-bit values.
///
/// # Errors
/// [`Cancelled`].
pub fn draw_values(plan: &Plan, bins: &Bins, pixels: &mut [u16], work: &Work) -> Result<(), Cancelled> {
    let side = 1usize << bins.grid.tile_shift;
    work.map(tiles::split(pixels, &bins.grid), Scratch::default, |scratch, tile| {
        scratch.find_visible(work.level, bins, tile.place, 1);
        let region = Region::of_tile(&bins.grid, tile.place[0], tile.place[1]);
        for (y, row) in tile.rows.into_iter().enumerate() {
            for (x, pixel) in row.iter_mut().enumerate() {
                let seen = scratch.seen(y * side + x, bins);
                *pixel = match plan.depth_range {
                    Some(range) => distance_code(seen, region.centre([x, y]), &plan.view, range),
                    None => instance_code(seen, &plan.draws),
                };
            }
        }
    })?;
    Ok(())
}

/// 65535 · (z − near) / (far − near) of the view-space distance z; 65535 for the background.
fn distance_code(seen: Option<&Triangle>, screen: [f64; 2], view: &View, range: [f64; 2]) -> u16 {
    let Some(seen) = seen else { return u16::MAX };
    let z = view.distance(seen.depth_at(screen[0], screen[1]));
    let share = ((z - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0);
    unorm16(share)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share is in 0–1")]
fn unorm16(share: f64) -> u16 {
    (65535.0 * share + 0.5).floor() as u16
}

/// 0 for the background, else 1 + the instance's place among all names in order.
fn instance_code(seen: Option<&Triangle>, draws: &[Draw]) -> u16 {
    seen.map_or(0, |seen| u16::try_from(draws[seen.draw as usize].instance + 1).unwrap_or(u16::MAX))
}
