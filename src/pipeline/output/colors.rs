//! Linear colour to sRGB bytes, or to floats.

use crate::math::approx;
use crate::math::simd::*;
use crate::pipeline::shade::BRIGHTEST;
use crate::pipeline::tiles::Resolved;

/// A row of linear colours, premultiplied with alpha. Every slice holds the row's pixels and goes on to
/// a multiple of eight.
pub struct Row<'a> {
    /// Red, green, blue.
    pub colors: [&'a [f32]; 3],
    /// Coverage; `None`: all of it.
    pub alpha: Option<&'a [f32]>,
}

impl Row<'_> {
    /// Straight colour and alpha of the eight pixels from `x`; black where alpha is 0.
    #[inline(always)]
    fn straight<S: Simd>(&self, simd: S, x: usize) -> (Vec3x8<S>, f32x8<S>) {
        let load = always(
            #[inline(always)]
            |from: &[f32]| f32x8::from_slice(simd, &from[x..x + LANES]),
        );
        let [r, g, b] = self.colors;
        let color = Vec3x8 { x: load(r), y: load(g), z: load(b) };
        let Some(alpha) = self.alpha else { return (color, f32x8::splat(simd, 1.0)) };
        let (alpha, black) = (load(alpha), Vec3x8::splat(simd, glam::Vec3::ZERO));
        let straight = Vec3x8 { x: color.x / alpha, y: color.y / alpha, z: color.z / alpha };
        (straight.select(alpha.simd_gt(f32x8::splat(simd, 0.0)), black), alpha)
    }
}

impl Resolved<'_> {
    /// The row `y`.
    #[inline(always)]
    fn row(&self, y: usize) -> Row<'_> {
        let range = y * self.side..(y + 1) * self.side;
        let [r, g, b] = self.colors;
        Row {
            colors: [&r[range.clone()], &g[range.clone()], &b[range.clone()]],
            alpha: self.alpha.map(|alpha| &alpha[range]),
        }
    }
}

/// Encodes a tile: clamp to 0–1, sRGB, `floor(255 x + ½)`. Alpha is straight.
pub fn encode_tile(level: Level, resolved: &Resolved, rows: Vec<&mut [[u8; 4]]>) {
    dispatch!(level, simd => {
        for (y, row) in rows.into_iter().enumerate() {
            encode_row(simd, &resolved.row(y), row);
        }
    });
}

#[inline(always)]
fn encode_row<S: Simd>(simd: S, from: &Row, to: &mut [[u8; 4]]) {
    for (x, pixels) in (0..).step_by(LANES).zip(to.chunks_mut(LANES)) {
        let (color, alpha) = from.straight(simd, x);
        let code = always(
            #[inline(always)]
            |linear| unorm8(approx::srgb_from_linear(clamped(linear, 1.0))),
        );
        let (r, g, b, alpha) = (code(color.x), code(color.y), code(color.z), unorm8(alpha));
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            *pixel = [byte(r[lane]), byte(g[lane]), byte(b[lane]), byte(alpha[lane])];
        }
    }
}

/// Writes a tile's straight colour in 0–65504, and its alpha.
pub fn write_radiance(level: Level, resolved: &Resolved, rows: Vec<&mut [[f32; 4]]>) {
    dispatch!(level, simd => {
        for (y, row) in rows.into_iter().enumerate() {
            radiance_row(simd, &resolved.row(y), row);
        }
    });
}

#[inline(always)]
fn radiance_row<S: Simd>(simd: S, from: &Row, to: &mut [[f32; 4]]) {
    for (x, pixels) in (0..).step_by(LANES).zip(to.chunks_mut(LANES)) {
        let (color, alpha) = from.straight(simd, x);
        let clamped = always(
            #[inline(always)]
            |linear| clamped(linear, BRIGHTEST),
        );
        let (r, g, b) = (clamped(color.x), clamped(color.y), clamped(color.z));
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            *pixel = [r[lane], g[lane], b[lane], alpha[lane]];
        }
    }
}

/// Clamped to 0–`most`; what is no number is 0.
#[inline(always)]
fn clamped<S: Simd>(x: f32x8<S>, most: f32) -> f32x8<S> {
    let simd = x.token();
    min(max(x, f32x8::splat(simd, 0.0)), f32x8::splat(simd, most))
}

/// `floor(255 x + ½)` of values in 0–1.
#[inline(always)]
fn unorm8<S: Simd>(x: f32x8<S>) -> [i32; LANES] {
    let codes: i32x8<S> = (x * 255.0 + 0.5).floor().to_int_precise();
    codes.to_array()
}

/// A code as a byte.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "codes are in 0–255")]
fn byte(code: i32) -> u8 {
    code as u8
}
