//! sRGB and linear RGB.

use super::round_to_f32;
use std::sync::LazyLock;

/// The largest radiance: that of a half float, so that every format downstream can hold it.
pub const BRIGHTEST: f32 = 65504.0;

/// Linear values of the 256 sRGB codes.
pub static SRGB_DECODE: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| round_to_f32(linear_from_srgb8(u8::try_from(code).unwrap_or(u8::MAX))))
});

/// `code / 255`.
pub static UNORM_DECODE: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| round_to_f32(f64::from(u8::try_from(code).unwrap_or(u8::MAX)) / 255.0))
});

/// Linear value of the sRGB code `c / 255` (IEC 61966-2-1), in f64.
#[must_use]
pub fn linear_from_srgb8(c: u8) -> f64 {
    linear_from_srgb(f64::from(c) / 255.0)
}

/// Linear value of an sRGB-encoded value in 0–1 (IEC 61966-2-1).
#[must_use]
pub fn linear_from_srgb(s: f64) -> f64 {
    if s <= 0.04045 { s / 12.92 } else { libm::pow((s + 0.055) / 1.055, 2.4) }
}

/// sRGB-encoded value of a linear value in 0–1 (IEC 61966-2-1).
#[must_use]
pub fn srgb_from_linear(l: f64) -> f64 {
    if l <= 0.003_130_8 { l * 12.92 } else { 1.055 * libm::pow(l, 1.0 / 2.4) - 0.055 }
}
