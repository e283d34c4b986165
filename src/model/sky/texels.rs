//! Texels of skies: 8-bit or floating point, and how they become linear light.

use crate::math::colour::linear_from_srgb8;
use crate::math::round_to_f32;
use crate::model::texture::Image;
use std::mem::size_of_val;
use std::sync::LazyLock;

/// The largest value of a texel: that of a half float, as of every radiance that is drawn.
pub const BRIGHTEST: f32 = 65504.0;

/// Linear values of the 256 sRGB codes.
static SRGB_DECODE: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|c| round_to_f32(linear_from_srgb8(u8::try_from(c).unwrap_or(u8::MAX))))
});

/// The table that [`Texels::linear`] decodes with: linear values of the 256 sRGB codes.
#[must_use]
pub fn decode_table() -> &'static [f32; 256] {
    &SRGB_DECODE
}

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

/// Texels as they are kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Red, green, blue, sRGB-encoded, and an alpha that is not read.
    Srgb8(Vec<[u8; 4]>),
    /// Linear red, green, blue in 0–[`BRIGHTEST`].
    Linear(Vec<[f32; 3]>),
}

impl From<Image> for Picture {
    fn from(image: Image) -> Self {
        Self { width: image.width, height: image.height, texels: Texels::Srgb8(image.texels) }
    }
}

impl Texels {
    /// The texel at `index` in linear light; `decode` is [`decode_table`].
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
