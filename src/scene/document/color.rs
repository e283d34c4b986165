//! Colours as a document writes them.

use super::writer::ToJson;
use crate::limits::MAX_RADIANCE;
use crate::math::colour::linear_from_srgb8;
use glam::Vec3;
use serde_json::Value;

/// A colour, remembered the way it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Color {
    linear: [f64; 3],
    /// The sRGB string, where it came as one.
    hex: Option<String>,
}

impl Color {
    /// From linear RGB, each ≥ 0.
    #[must_use]
    pub const fn from_linear(linear: [f64; 3]) -> Self {
        Self { linear, hex: None }
    }

    /// The same in all channels.
    #[must_use]
    pub const fn grey(value: f64) -> Self {
        Self::from_linear([value; 3])
    }

    /// From an sRGB string, `#rrggbb` or `#rgb`.
    #[must_use]
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?;
        let codes = srgb_codes(digits)?;
        Some(Self { linear: codes.map(linear_from_srgb8), hex: Some(text.to_owned()) })
    }

    /// Linear RGB as the pipeline takes it.
    #[must_use]
    pub fn to_linear(&self) -> Vec3 {
        self.scaled(1.0)
    }

    /// Linear RGB times `factor` ≥ 0, no larger than [`MAX_RADIANCE`].
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Vec3 {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "rounding to f32 is meant; the bound keeps it finite"
        )]
        Vec3::from_array(self.linear.map(|channel| (channel * factor).min(MAX_RADIANCE) as f32))
    }

    /// The sRGB codes nearest to it.
    #[must_use]
    pub fn to_srgb8(&self) -> [u8; 3] {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255 by the clamp")]
        self.linear.map(|channel| {
            (crate::math::colour::srgb_from_linear(channel.clamp(0.0, 1.0)) * 255.0 + 0.5).floor() as u8
        })
    }
}

/// Red, green and blue of `rrggbb` or `rgb`.
#[must_use]
pub fn srgb_codes(digits: &str) -> Option<[u8; 3]> {
    if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let code = |text: &str| u8::from_str_radix(text, 16).ok();
    match digits.len() {
        3 => Some([code(&digits[0..1])? * 17, code(&digits[1..2])? * 17, code(&digits[2..3])? * 17]),
        6 => Some([code(&digits[0..2])?, code(&digits[2..4])?, code(&digits[4..6])?]),
        _ => None,
    }
}

impl ToJson for Color {
    fn to_json(&self) -> Value {
        self.hex.as_ref().map_or_else(|| self.linear.to_json(), |hex| Value::String(hex.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_long_strings_name_the_same_colour() {
        let short = Color::from_hex("#f80").unwrap();
        let long = Color::from_hex("#ff8800").unwrap();
        assert_eq!(short.to_linear(), long.to_linear());
        assert_eq!(long.to_srgb8(), [255, 136, 0]);
    }

    #[test]
    fn what_is_not_hexadecimal_is_no_colour() {
        for text in ["", "#", "#ff", "#ffff", "ff8800", "#ggg", "#ff880", "#+1+1+1", "#äö", "#日本"] {
            assert_eq!(Color::from_hex(text), None, "{text}");
        }
    }

    #[test]
    fn huge_radiance_stays_finite() {
        assert!(Color::grey(1e37).scaled(1e37).is_finite());
    }
}
