//! Texels of skies: 8-bit or floating point, and how they become linear light.

use crate::model::texture::Image;
use std::mem::size_of_val;

/// A picture as its file has it. Rows run top to bottom; alpha means nothing in a sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Texels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `width × height` texels.
    pub texels: Texels,
}

/// What is known of a picture before it is decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    /// Texels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Whether its texels are [`Texels::Linear`].
    pub is_linear: bool,
}

impl PictureSize {
    /// Bytes of its texels.
    #[must_use]
    pub fn bytes(self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * texel_bytes(self.is_linear)
    }
}

/// Bytes of a texel of [`Texels::Linear`], else of [`Texels::Srgb8`].
pub(super) fn texel_bytes(is_linear: bool) -> u64 {
    if is_linear { 12 } else { 4 }
}

/// Texels as they are kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Red, green, blue, sRGB-encoded, and an alpha that is not read.
    Srgb8(Vec<[u8; 4]>),
    /// Linear red, green, blue in 0–[`BRIGHTEST`](crate::math::colour::BRIGHTEST).
    Linear(Vec<[f32; 3]>),
}

impl From<Image> for Picture {
    fn from(image: Image) -> Self {
        Self { width: image.width, height: image.height, texels: Texels::Srgb8(image.texels) }
    }
}

impl Texels {
    /// The texel at `index` in linear light; `decode` is [`SRGB_DECODE`](crate::math::colour::SRGB_DECODE).
    #[inline(always)]
    #[must_use]
    pub fn linear(&self, index: usize, decode: &[f32; 256]) -> [f32; 3] {
        match self {
            Self::Srgb8(codes) => {
                let [r, g, b, _] = codes[index];
                [decode[usize::from(r)], decode[usize::from(g)], decode[usize::from(b)]]
            }
            Self::Linear(values) => values[index],
        }
    }

    /// Bytes of memory they hold.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (match self {
            Self::Srgb8(codes) => size_of_val(codes.as_slice()),
            Self::Linear(values) => size_of_val(values.as_slice()),
        }) as u64
    }
}
