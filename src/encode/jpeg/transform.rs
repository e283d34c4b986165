//! Pixels to quantized blocks: YCbCr, the discrete cosine transform, and its quantization.
//!
//! In f32 without fused operations, eight lanes at a time: the same coefficients at every SIMD level.

use super::Chroma;
use super::huffman::Block;
use super::tables::{Quantization, ZIGZAG};
use crate::math::round_to_f32;
use crate::math::simd::*;

/// What AAN's transform gives too much along each axis: `√2·cos(kπ/16)`, 1 for k = 0; and 8 on the whole.
const AAN_SCALES: [f64; 8] = [
    1.0,
    1.387_039_845_322_147_5,
    1.306_562_964_876_376_4,
    1.175_875_602_419_358_7,
    1.0,
    0.785_694_958_387_102_1,
    0.541_196_100_146_196_9,
    0.275_899_379_282_943_1,
];

/// Largest magnitude of a coefficient that baseline JPEG codes.
const LARGEST: f32 = 1023.0;

/// Rows of coefficients by horizontal frequency, in each the vertical ones: as the transform leaves them.
type Transposed = [[f32; LANES]; LANES];

/// Quantized blocks of a strip of `width` pixels a row, unit by unit: 1 or 4 of brightness, blue and red
/// chroma. Beyond right and lower border the last pixels go on.
pub(super) fn blocks(
    level: Level,
    pixels: &[[u8; 4]],
    width: usize,
    chroma: Chroma,
    quantization: &Quantization,
) -> Vec<Block> {
    let side = chroma.unit();
    let factors = [factors(&quantization.luma), factors(&quantization.chroma)];
    let mut blocks = Vec::new();
    for rows in pixels.chunks(side * width) {
        let units = Units::new(rows, width, side);
        dispatch!(level, simd => {
            for at in (0..units.stride).step_by(side) {
                match chroma {
                    Chroma::Full => units.full(simd, at, &factors, &mut blocks),
                    Chroma::Quarter => units.quarter(simd, at, &factors, &mut blocks),
                }
            }
        });
    }
    blocks
}

/// What turns a coefficient of the transform into steps.
fn factors(steps: &[u8; 64]) -> Transposed {
    let mut factors = [[0.0; LANES]; LANES];
    for (u, row) in factors.iter_mut().enumerate() {
        for (v, factor) in row.iter_mut().enumerate() {
            let step = f64::from(steps[v * 8 + u]);
            *factor = round_to_f32(1.0 / (8.0 * step * AAN_SCALES[u] * AAN_SCALES[v]));
        }
    }
    factors
}

/// A row of coded units: 8 or 16 rows of pixels, in whole units.
struct Units {
    /// Red in the lowest byte, then green and blue.
    pixels: Vec<u32>,
    /// Pixels in a row.
    stride: usize,
}

/// Red, green and blue of eight pixels in a row.
type Rgb<S> = [f32x8<S>; 3];

impl Units {
    fn new(pixels: &[[u8; 4]], width: usize, side: usize) -> Self {
        let stride = width.next_multiple_of(side);
        let mut padded = Vec::with_capacity(stride * side);
        for row in pixels.chunks(width) {
            padded.extend(row.iter().map(|pixel| u32::from_le_bytes(*pixel)));
            let last = padded[padded.len() - 1];
            padded.resize(padded.len().next_multiple_of(stride), last);
        }
        while padded.len() < stride * side {
            padded.extend_from_within(padded.len() - stride..);
        }
        Self { pixels: padded, stride }
    }

    #[inline(always)]
    fn rgb<S: Simd>(&self, simd: S, x: usize, y: usize) -> Rgb<S> {
        let at = y * self.stride + x;
        let packed = u32x8::from_slice(simd, &self.pixels[at..at + LANES]);
        let [r, g, b] = [packed & 255, (packed >> 8) & 255, (packed >> 16) & 255];
        [f32x8::float_from(r), f32x8::float_from(g), f32x8::float_from(b)]
    }

    /// The unit at `left` with a chroma sample for each pixel.
    #[inline(always)]
    fn full<S: Simd>(&self, simd: S, left: usize, factors: &[Transposed; 2], blocks: &mut Vec<Block>) {
        let [mut y, mut cb, mut cr] = [[f32x8::splat(simd, 0.0); 8]; 3];
        for row in 0..8 {
            let rgb = self.rgb(simd, left, row);
            y[row] = luma(rgb);
            [cb[row], cr[row]] = chroma(rgb);
        }
        blocks.push(quantized(simd, transformed(simd, y), &factors[0]));
        blocks.push(quantized(simd, transformed(simd, cb), &factors[1]));
        blocks.push(quantized(simd, transformed(simd, cr), &factors[1]));
    }

    /// The unit at `left` with a chroma sample for 2 × 2 pixels, their mean.
    #[inline(always)]
    fn quarter<S: Simd>(&self, simd: S, left: usize, factors: &[Transposed; 2], blocks: &mut Vec<Block>) {
        for (x, y) in [(0, 0), (8, 0), (0, 8), (8, 8)] {
            let mut rows = [f32x8::splat(simd, 0.0); 8];
            for (at, row) in rows.iter_mut().enumerate() {
                *row = luma(self.rgb(simd, left + x, y + at));
            }
            blocks.push(quantized(simd, transformed(simd, rows), &factors[0]));
        }
        let [mut cb, mut cr] = [[f32x8::splat(simd, 0.0); 8]; 2];
        for row in 0..8 {
            [cb[row], cr[row]] = chroma(self.mean_of_four(simd, left, row * 2));
        }
        blocks.push(quantized(simd, transformed(simd, cb), &factors[1]));
        blocks.push(quantized(simd, transformed(simd, cr), &factors[1]));
    }

    /// Means of 2 × 2 pixels, eight of them from (`left`, `top`).
    #[inline(always)]
    fn mean_of_four<S: Simd>(&self, simd: S, left: usize, top: usize) -> Rgb<S> {
        let mut means = self.rgb(simd, left, top);
        let below = self.rgb(simd, left, top + 1);
        let (right, right_below) = (self.rgb(simd, left + 8, top), self.rgb(simd, left + 8, top + 1));
        for c in 0..3 {
            let (a, b) = (means[c] + below[c], right[c] + right_below[c]);
            means[c] = (a.unzip_low(b) + a.unzip_high(b)) * 0.25;
        }
        means
    }
}

/// Brightness about 0 (ITU-T T.871).
#[inline(always)]
fn luma<S: Simd>([r, g, b]: Rgb<S>) -> f32x8<S> {
    r * 0.299 + g * 0.587 + b * 0.114 - 128.0
}

/// Blue and red chroma about 0 (ITU-T T.871).
#[inline(always)]
fn chroma<S: Simd>([r, g, b]: Rgb<S>) -> [f32x8<S>; 2] {
    [b * 0.5 - r * 0.168_735_89 - g * 0.331_264_1, r * 0.5 - g * 0.418_687_6 - b * 0.081_312_41]
}

/// The two-dimensional transform of a block, transposed and times [`AAN_SCALES`].
#[inline(always)]
fn transformed<S: Simd>(simd: S, rows: [f32x8<S>; 8]) -> [f32x8<S>; 8] {
    aan(transposed(simd, aan(rows)))
}

#[inline(always)]
fn transposed<S: Simd>(simd: S, rows: [f32x8<S>; 8]) -> [f32x8<S>; 8] {
    let mut from = [[0.0; LANES]; LANES];
    for (values, row) in from.iter_mut().zip(rows) {
        *values = row.to_array();
    }
    let mut columns = rows;
    for (at, column) in columns.iter_mut().enumerate() {
        let [a, b, c, d, e, f, g, h] = &from;
        *column = f32x8::simd_from(simd, [a[at], b[at], c[at], d[at], e[at], f[at], g[at], h[at]]);
    }
    columns
}

/// The discrete cosine transform along the rows' order, eight columns at a time. Source: Y. Arai, T. Agui,
/// M. Nakajima, "A Fast DCT-SQ Scheme for Images", Trans. IEICE E-71, 1988.
#[inline(always)]
fn aan<S: Simd>(x: [f32x8<S>; 8]) -> [f32x8<S>; 8] {
    const SQRT_HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;
    let (s07, d07) = (x[0] + x[7], x[0] - x[7]);
    let (s16, d16) = (x[1] + x[6], x[1] - x[6]);
    let (s25, d25) = (x[2] + x[5], x[2] - x[5]);
    let (s34, d34) = (x[3] + x[4], x[3] - x[4]);
    // Even part.
    let (s0, s3) = (s07 + s34, s07 - s34);
    let (s1, s2) = (s16 + s25, s16 - s25);
    let turned = (s2 + s3) * SQRT_HALF;
    // Odd part.
    let (a, b, c) = (d34 + d25, d25 + d16, d16 + d07);
    let shared = (a - c) * 0.382_683_43;
    let low = a * 0.541_196_1 + shared;
    let high = c * 1.306_563 + shared;
    let middle = b * SQRT_HALF;
    let (sum, difference) = (d07 + middle, d07 - middle);
    [s0 + s1, sum + high, s3 + turned, difference - low, s0 - s1, difference + low, s3 - turned, sum - high]
}

/// Coefficients in steps, to the nearest, in the order of the zigzag.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "clamped to ±1023")]
fn quantized<S: Simd>(simd: S, coefficients: [f32x8<S>; 8], factors: &Transposed) -> Block {
    let (least, most) = (f32x8::splat(simd, -LARGEST), f32x8::splat(simd, LARGEST));
    let mut steps = [0i16; 64];
    for ((row, factors), steps) in coefficients.into_iter().zip(factors).zip(steps.chunks_mut(LANES)) {
        let nearest = (row * f32x8::simd_from(simd, *factors) + 0.5).floor();
        let clamped: i32x8<S> = min(max(nearest, least), most).to_int_precise();
        steps.iter_mut().zip(clamped.to_array()).for_each(|(step, value)| *step = value as i16);
    }
    let mut block = [0; 64];
    for (value, at) in block.iter_mut().zip(ZIGZAG) {
        *value = steps[usize::from(at % 8 * 8 + at / 8)];
    }
    block
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The coefficient of T.81, A.3.3, at vertical frequency `v` and horizontal `u`.
    fn exact(block: &[[f64; 8]; 8], v: usize, u: usize) -> f64 {
        let scale = |k: usize| if k == 0 { 0.5f64.sqrt() } else { 1.0 };
        let wave = |x: usize, k: usize| ((2 * x + 1) as f64 * k as f64 * PI / 16.0).cos();
        let places = (0..64).map(|at| (at / 8, at % 8));
        let sum: f64 = places.map(|(y, x)| block[y][x] * wave(y, v) * wave(x, u)).sum();
        sum * scale(u) * scale(v) / 4.0
    }

    #[test]
    fn the_transform_is_the_cosine_transform() {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state.to_be_bytes()[0]) - 128.0
        };
        for _ in 0..50 {
            let mut block = [[0.0; 8]; 8];
            block.as_flattened_mut().iter_mut().for_each(|value| *value = random());
            let transposed = dispatch!(Level::new(), simd => {
                let mut rows = [f32x8::splat(simd, 0.0); 8];
                for (row, values) in rows.iter_mut().zip(&block) {
                    *row = f32x8::simd_from(simd, values.map(round_to_f32));
                }
                let columns = transformed(simd, rows);
                let mut arrays = [[0.0f32; 8]; 8];
                arrays.iter_mut().zip(columns).for_each(|(array, column)| *array = column.to_array());
                arrays
            });
            for (v, u) in (0..64).map(|at| (at / 8, at % 8)) {
                let value = f64::from(transposed[u][v]) / (8.0 * AAN_SCALES[u] * AAN_SCALES[v]);
                let exact = exact(&block, v, u);
                assert!((value - exact).abs() < 1e-3, "{v}, {u}: {value} {exact}");
            }
        }
    }

    #[test]
    fn every_level_gives_the_same_blocks() {
        let pixels: Vec<[u8; 4]> = (0..40u8)
            .flat_map(|y| {
                (0..50u8).map(move |x| [x.wrapping_mul(y), x.wrapping_mul(5), y.wrapping_mul(6), 255])
            })
            .collect();
        for chroma in [Chroma::Full, Chroma::Quarter] {
            let of = |level| blocks(level, &pixels, 50, chroma, &Quantization::of_quality(85));
            let expected = of(Level::new());
            assert_eq!(expected.len(), if chroma == Chroma::Full { 7 * 5 * 3 } else { 4 * 3 * 6 });
            for name in ["scalar", "sse2", "sse4.2", "avx2", "avx512", "neon"] {
                let level = name.parse::<crate::settings::Simd>();
                assert!(level.is_err() || level.is_ok_and(|level| of(level.level()) == expected), "{name}");
            }
        }
    }
}
