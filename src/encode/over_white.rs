//! Transparent pixels over white, for formats without alpha.

use crate::math::approx::srgb_from_linear;
use crate::math::colour::SRGB_DECODE;
use crate::math::simd::*;

/// Lays straight-alpha sRGB pixels over white, mixing in linear light: `c·α + 1 − α`. What is opaque
/// keeps its codes.
pub(crate) fn over_white(level: Level, pixels: &[[u8; 4]]) -> Vec<[u8; 4]> {
    let mut over = pixels.to_vec();
    dispatch!(level, simd => over_white_kernel(simd, &SRGB_DECODE, &mut over));
    over
}

#[inline(always)]
fn over_white_kernel<S: Simd>(simd: S, linear: &[f32; 256], pixels: &mut [[u8; 4]]) {
    for pixels in pixels.chunks_mut(LANES) {
        if pixels.iter().all(|pixel| pixel[3] == 255) {
            continue;
        }
        let (mut colors, mut alpha) = ([[0.0; LANES]; 3], [0.0; LANES]);
        for (lane, pixel) in pixels.iter().enumerate() {
            for c in 0..3 {
                colors[c][lane] = linear[usize::from(pixel[c])];
            }
            alpha[lane] = f32::from(pixel[3]) / 255.0;
        }
        let alpha = f32x8::simd_from(simd, alpha);
        for (c, color) in colors.into_iter().enumerate() {
            let mixed = f32x8::simd_from(simd, color) * alpha + (1.0 - alpha);
            let codes = (srgb_from_linear(mixed) * 255.0 + 0.5).floor().to_array();
            pixels.iter_mut().zip(codes).for_each(|(pixel, code)| pixel[c] = byte(code));
        }
        pixels.iter_mut().for_each(|pixel| pixel[3] = 255);
    }
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "codes are in 0–255")]
fn byte(code: f32) -> u8 {
    code as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::colour::linear_from_srgb8;
    use crate::math::colour::srgb_from_linear;

    #[test]
    fn the_mix_is_linear_and_within_a_code_of_f64() {
        let pixels: Vec<[u8; 4]> = (0..=255)
            .flat_map(|alpha| [0, 1, 40, 127, 200, 255].map(|code| [code, 255 - code, code / 2, alpha]))
            .collect();
        let over = over_white(Level::new(), &pixels);
        for (from, to) in pixels.iter().zip(over) {
            let alpha = f64::from(from[3]) / 255.0;
            for c in 0..3 {
                let mixed = linear_from_srgb8(from[c]) * alpha + 1.0 - alpha;
                let exact = (srgb_from_linear(mixed) * 255.0 + 0.5).floor();
                assert!((f64::from(to[c]) - exact).abs() <= 1.0, "{from:?} → {to:?}, {exact}");
            }
            assert_eq!(to[3], 255);
        }
    }

    #[test]
    fn nothing_is_white_and_the_opaque_is_kept() {
        let pixels: Vec<[u8; 4]> =
            (0..=255).map(|code| [code, 0, 255, if code % 3 == 0 { 0 } else { 255 }]).collect();
        for (from, to) in pixels.iter().zip(over_white(Level::new(), &pixels)) {
            assert_eq!(to, if from[3] == 0 { [255; 4] } else { *from });
        }
    }
}
