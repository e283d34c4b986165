//! Mip chains: every level is the area-exact mean of the one above, in linear light.

use super::{ColorSpace, Image, MipLevel};
use crate::math::colour::linear_from_srgb8;
use rayon::prelude::*;

/// A level on its way down the chain: linear f32, not yet rounded to 16 bits.
pub(in crate::model) struct LinearLevel {
    width: usize,
    pub(in crate::model) texels: Vec<[f32; 4]>,
}

/// Levels 1, 2, … of `image` down to 1 × 1; none for a 1 × 1 image.
///
/// Each side of a level is `max(1, ⌊N/2⌋)` of the one above, and each texel the mean over exactly
/// the area it covers there, so the mean of the picture stays (to 2⁻²³ a level) also for sides that
/// are no powers of two. A level is made from the unrounded one above. Colour is not weighted by
/// alpha: what an author painted under clear texels bleeds as it does in every graphics API.
pub(super) fn chain(image: &Image, color_space: ColorSpace) -> Vec<MipLevel> {
    let (mut width, mut height) = (image.width as usize, image.height as usize);
    let mut levels = Vec::new();
    if width.max(height) <= 1 {
        return levels;
    }
    let decode = DecodeTable::new(color_space);
    let mut above = halve(width, height, |x, y| decode.texel(image.texels[y * width + x]));
    loop {
        (width, height) = (half(width), half(height));
        levels.push(rounded(&above, width, height));
        if width.max(height) <= 1 {
            return levels;
        }
        above = halve(width, height, |x, y| above.texels[y * above.width + x]);
    }
}

/// Side of the next level.
pub(in crate::model) fn half(side: usize) -> usize {
    (side / 2).max(1)
}

/// Linear values of the 256 codes, for colour and for alpha.
struct DecodeTable {
    color: [f32; 256],
    alpha: [f32; 256],
}

impl DecodeTable {
    fn new(color_space: ColorSpace) -> Self {
        let table = |value: fn(u8) -> f64| {
            let mut table = [0.0; 256];
            for (code, entry) in (0..=u8::MAX).zip(&mut table) {
                *entry = narrow(value(code));
            }
            table
        };
        let linear: fn(u8) -> f64 = |code| f64::from(code) / 255.0;
        let color = match color_space {
            ColorSpace::Srgb => table(linear_from_srgb8),
            ColorSpace::Linear => table(linear),
        };
        Self { color, alpha: table(linear) }
    }

    fn texel(&self, [r, g, b, a]: [u8; 4]) -> [f32; 4] {
        let color = |code: u8| self.color[usize::from(code)];
        [color(r), color(g), color(b), self.alpha[usize::from(a)]]
    }
}

/// The next level of a `width × height` level whose texels `above(x, y)` gives.
pub(in crate::model) fn halve(
    width: usize,
    height: usize,
    above: impl Fn(usize, usize) -> [f32; 4] + Sync,
) -> LinearLevel {
    let columns: Vec<Footprint> = (0..half(width)).map(|x| Footprint::of(x, width)).collect();
    let mut texels = vec![[0.0; 4]; half(width) * half(height)];
    texels.par_chunks_mut(half(width)).enumerate().for_each(|(y, row)| {
        let rows = Footprint::of(y, height);
        for (texel, columns) in row.iter_mut().zip(&columns) {
            *texel = mean(rows, *columns, &above);
        }
    });
    LinearLevel { width: half(width), texels }
}

/// Which texels of the level above one texel covers along an axis: `taps` of them from `first`,
/// with weights that sum up to 1.
#[derive(Clone, Copy)]
struct Footprint {
    first: usize,
    taps: usize,
    weights: [f64; 3],
}

impl Footprint {
    /// The footprint of texel `i` of the level below one of `above` texels.
    ///
    /// With `above = 2m + 1`, texel `i` covers `[i, i+1) · (2 + 1/m)`: the part `1 − i/m` of texel
    /// `2i`, all of `2i + 1`, and `(i+1)/m` of `2i + 2`.
    fn of(i: usize, above: usize) -> Self {
        let m = half(above);
        let share = |numerator: usize| count(numerator) / count(above);
        match above {
            1 => Self { first: 0, taps: 1, weights: [1.0, 0.0, 0.0] },
            _ if above.is_multiple_of(2) => Self { first: 2 * i, taps: 2, weights: [0.5, 0.5, 0.0] },
            _ => Self { first: 2 * i, taps: 3, weights: [share(m - i), share(m), share(i + 1)] },
        }
    }

    /// The texels it covers with their weights.
    fn taps(self) -> impl Iterator<Item = (usize, f64)> {
        self.weights.into_iter().take(self.taps).enumerate().map(move |(k, weight)| (self.first + k, weight))
    }
}

/// Weighted mean of the texels under `rows` × `columns`; sums run in a fixed order in f64.
fn mean(rows: Footprint, columns: Footprint, above: impl Fn(usize, usize) -> [f32; 4]) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for (y, row_weight) in rows.taps() {
        for (x, column_weight) in columns.taps() {
            let weight = row_weight * column_weight;
            for (sum, value) in sum.iter_mut().zip(above(x, y)) {
                *sum += weight * f64::from(value);
            }
        }
    }
    sum.map(narrow)
}

/// The level in 16 bits.
fn rounded(level: &LinearLevel, width: usize, height: usize) -> MipLevel {
    let side = |side: usize| u32::try_from(side).expect("invariant: no level is larger than its image");
    let texels = level.texels.iter().map(|texel| texel.map(unorm16_from_linear)).collect();
    MipLevel { width: side(width), height: side(height), texels }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a mean of values in 0–1 stays in 0–1, so the code lies in 0–65535"
)]
fn unorm16_from_linear(value: f32) -> u16 {
    (f64::from(value) * 65_535.0 + 0.5).floor() as u16
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is meant; values lie in 0–1")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[expect(clippy::cast_precision_loss, reason = "sides stay below 2⁵³")]
fn count(n: usize) -> f64 {
    n as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn image(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
        let texels =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
        Image { width, height, texels }
    }

    fn channel_mean(texels: &[[f32; 4]], channel: usize) -> f64 {
        texels.iter().map(|texel| f64::from(texel[channel])).sum::<f64>() / count(texels.len())
    }

    #[test]
    fn one_texel_has_no_mips() {
        assert!(chain(&image(1, 1, |_, _| [9, 9, 9, 9]), ColorSpace::Srgb).is_empty());
    }

    #[test]
    fn sides_halve_down_to_one() {
        let levels = chain(&image(7, 3, |_, _| [0; 4]), ColorSpace::Linear);
        let sides: Vec<_> = levels.iter().map(|level| (level.width, level.height)).collect();
        assert_eq!(sides, [(3, 1), (1, 1)]);
        assert!(levels.iter().all(|level| level.texels.len() == (level.width * level.height) as usize));
    }

    #[test]
    fn black_and_white_average_in_linear_light() {
        let levels =
            chain(&image(2, 1, |x, _| if x == 0 { [0, 0, 0, 0] } else { [255; 4] }), ColorSpace::Srgb);
        assert_eq!(levels[0].texels, [[32_768; 4]]);
    }

    #[test]
    fn odd_sides_weigh_by_area() {
        // Three columns 0, 1, 0: the one texel below covers each by a third.
        let levels = chain(&image(3, 1, |x, _| [if x == 1 { 255 } else { 0 }; 4]), ColorSpace::Linear);
        assert_eq!(levels[0].texels, [[21_845; 4]]);
    }

    #[test]
    fn a_constant_picture_stays_constant() {
        for level in chain(&image(13, 9, |_, _| [188, 64, 255, 128]), ColorSpace::Srgb) {
            let decode =
                DecodeTable::new(ColorSpace::Srgb).texel([188, 64, 255, 128]).map(unorm16_from_linear);
            assert!(level.texels.iter().all(|texel| *texel == decode));
        }
    }

    proptest! {
        #[test]
        fn every_level_keeps_the_mean_of_the_one_above(width in 1u32..40, height in 1u32..40, seed: u32) {
            let noise = |x: u32, y: u32| {
                let bits = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B) ^ seed).wrapping_mul(0xC2B2_AE35);
                (bits ^ (bits >> 15)).to_le_bytes()
            };
            let decode = DecodeTable::new(ColorSpace::Srgb);
            let (mut w, mut h) = (width as usize, height as usize);
            let mut level = image(width, height, noise).texels.into_iter().map(|t| decode.texel(t)).collect::<Vec<_>>();
            while w.max(h) > 1 {
                let below = halve(w, h, |x, y| level[y * w + x]).texels;
                for channel in 0..4 {
                    let (above_mean, below_mean) = (channel_mean(&level, channel), channel_mean(&below, channel));
                    prop_assert!((above_mean - below_mean).abs() <= 2.0 * above_mean * 2f64.powi(-24));
                }
                (w, h, level) = (half(w), half(h), below);
            }
        }
    }
}
