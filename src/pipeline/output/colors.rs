//! Linear colour to sRGB bytes, or to floats.

use crate::math::approx;
use crate::math::colour::BRIGHTEST;
use crate::math::simd::*;
use crate::pipeline::post::{BAND, LinearFrame, pointwise};
use crate::pipeline::tiles::{Resolved, Tile};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::Pointwise;
use glam::Vec3;

/// A row of linear colours, premultiplied with alpha. Every slice holds the row's pixels and goes on to
/// a multiple of eight.
pub struct Row<'a> {
    /// Red, green, blue.
    pub colors: [&'a [f32]; 3],
    /// Coverage; `None`: all of it.
    pub alpha: Option<&'a [f32]>,
}

impl Row<'_> {
    /// Straight colour of the eight pixels from `x`; of no meaning where alpha is 0.
    #[inline(always)]
    pub fn straight<S: Simd>(&self, simd: S, x: usize) -> Vec3x8<S> {
        let [r, g, b] = self.colors;
        let color = Vec3x8 { x: eight(simd, r, x), y: eight(simd, g, x), z: eight(simd, b, x) };
        let Some(alpha) = self.alpha else { return color };
        let alpha = eight(simd, alpha, x);
        Vec3x8 { x: color.x / alpha, y: color.y / alpha, z: color.z / alpha }
    }

    /// The straight colours of the eight pixels from `x`, premultiplied again.
    #[inline(always)]
    pub fn premultiplied<S: Simd>(&self, simd: S, x: usize, straight: Vec3x8<S>) -> Vec3x8<S> {
        let Some(alpha) = self.alpha else { return straight };
        self.visible(simd, x, straight.scale(eight(simd, alpha, x)))
    }

    /// `color`, but black where alpha is 0.
    #[inline(always)]
    fn visible<S: Simd>(&self, simd: S, x: usize, color: Vec3x8<S>) -> Vec3x8<S> {
        let Some(alpha) = self.alpha else { return color };
        let black = Vec3x8::splat(simd, Vec3::ZERO);
        color.select(eight(simd, alpha, x).simd_gt(f32x8::splat(simd, 0.0)), black)
    }

    /// Alpha of the eight pixels from `x`.
    #[inline(always)]
    fn alpha<S: Simd>(&self, simd: S, x: usize) -> f32x8<S> {
        self.alpha.map_or(
            f32x8::splat(simd, 1.0),
            always(
                #[inline(always)]
                |alpha| eight(simd, alpha, x),
            ),
        )
    }
}

#[inline(always)]
fn eight<S: Simd>(simd: S, from: &[f32], x: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &from[x..x + LANES])
}

impl Resolved<'_> {
    /// The row `y`.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, y: usize) -> Row<'_> {
        let range = y * self.side..(y + 1) * self.side;
        let [r, g, b] = self.colors;
        Row {
            colors: [&r[range.clone()], &g[range.clone()], &b[range.clone()]],
            alpha: self.alpha.map(|alpha| &alpha[range]),
        }
    }

    /// Column and row in the picture of the first pixel of the tile at `place`.
    #[must_use]
    pub fn corner(&self, place: [u32; 2]) -> [usize; 2] {
        place.map(|n| n as usize * self.side)
    }
}

/// Encodes a tile after `steps`: clamp to 0–1, sRGB, `floor(255 x + ½)`. Alpha is straight.
pub fn encode_tile(level: Level, resolved: &Resolved, steps: &[Pointwise], tile: Tile<[u8; 4]>) {
    let [left, top] = resolved.corner(tile.place);
    if resolved.plain && !steps.iter().any(Pointwise::needs_place) {
        return encode_plain(level, resolved, steps, tile);
    }
    dispatch!(level, simd => {
        for (y, row) in tile.rows.into_iter().enumerate() {
            encode_row(simd, &resolved.row(y), steps, [left, top + y], row);
        }
    });
}

/// Encodes eight pixels of a tile in which all are the same.
fn encode_plain(level: Level, resolved: &Resolved, steps: &[Pointwise], tile: Tile<[u8; 4]>) {
    let mut eight = [[0; 4]; LANES];
    dispatch!(level, simd => encode_row(simd, &resolved.row(0), steps, [0, 0], &mut eight));
    tile.rows.into_iter().for_each(|row| row.fill(eight[0]));
}

/// Encodes a picture after `steps`, as [`encode_tile`] does.
///
/// # Errors
/// [`Cancelled`].
pub fn encode_frame(
    frame: &LinearFrame,
    steps: &[Pointwise],
    pixels: &mut [[u8; 4]],
    work: &Work,
) -> Result<(), Cancelled> {
    let bands = (0..).step_by(BAND).zip(pixels.chunks_mut(frame.width * BAND)).collect();
    work.map(
        bands,
        || (),
        |(), (top, band): (usize, &mut [[u8; 4]])| {
            dispatch!(work.level, simd => {
                for (y, row) in (top..).zip(band.chunks_exact_mut(frame.width)) {
                    encode_row(simd, &frame.row(y), steps, [0, y], row);
                }
            });
        },
    )?;
    Ok(())
}

/// `place`: column and row of the first pixel.
#[inline(always)]
fn encode_row<S: Simd>(simd: S, from: &Row, steps: &[Pointwise], place: [usize; 2], to: &mut [[u8; 4]]) {
    for (x, pixels) in (0..).step_by(LANES).zip(to.chunks_mut(LANES)) {
        let color = pointwise::apply(simd, steps, from.straight(simd, x), [place[0] + x, place[1]]);
        let color = from.visible(simd, x, color);
        let code = always(
            #[inline(always)]
            |linear| unorm8(approx::srgb_from_linear(clamped(linear, 1.0))),
        );
        let (r, g, b) = (code(color.x), code(color.y), code(color.z));
        let alpha = unorm8(clamped(from.alpha(simd, x), 1.0));
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            *pixel = [byte(r[lane]), byte(g[lane]), byte(b[lane]), byte(alpha[lane])];
        }
    }
}

/// Writes a tile's straight colour in 0–65504, and its alpha.
pub fn write_radiance(level: Level, resolved: &Resolved, tile: Tile<[f32; 4]>) {
    dispatch!(level, simd => {
        for (y, row) in tile.rows.into_iter().enumerate() {
            radiance_row(simd, &resolved.row(y), row);
        }
    });
}

/// Writes a picture's colours as [`write_radiance`] does.
///
/// # Errors
/// [`Cancelled`].
pub fn write_radiance_frame(
    frame: &LinearFrame,
    pixels: &mut [[f32; 4]],
    work: &Work,
) -> Result<(), Cancelled> {
    let rows = (0..).zip(pixels.chunks_mut(frame.width)).collect();
    work.map(
        rows,
        || (),
        |(), (y, row): (usize, &mut [[f32; 4]])| {
            dispatch!(work.level, simd => radiance_row(simd, &frame.row(y), row));
        },
    )?;
    Ok(())
}

#[inline(always)]
fn radiance_row<S: Simd>(simd: S, from: &Row, to: &mut [[f32; 4]]) {
    for (x, pixels) in (0..).step_by(LANES).zip(to.chunks_mut(LANES)) {
        let color = from.visible(simd, x, from.straight(simd, x));
        // A quotient may round to a little more than the brightest.
        let bounded = always(
            #[inline(always)]
            |linear| clamped(linear, BRIGHTEST),
        );
        let (r, g, b) = (bounded(color.x), bounded(color.y), bounded(color.z));
        let alpha = from.alpha(simd, x);
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
