//! Textures: 8-bit texels, a mip chain in linear light, and how they are sampled.

pub mod checker;
pub(in crate::model) mod mips;

use crate::math::colour::{SRGB_DECODE, UNORM_DECODE};
use std::mem::size_of_val;
use std::sync::Arc;

/// What happens between texels and mip levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The nearest texel of level 0.
    Nearest,
    /// Bilinear in the nearest mip level.
    Bilinear,
    /// Bilinear in the two nearest levels, then between them.
    Trilinear,
}

/// What happens outside the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture repeats.
    Repeat,
    /// The border texel goes on.
    Clamp,
    /// The picture repeats, every second time mirrored.
    Mirror,
}

/// How the bytes of a level 0 texel become numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// Red, green and blue are sRGB-encoded; alpha is linear.
    Srgb,
    /// All four channels are `code / 255`.
    Linear,
}

/// Level 0 as it was decoded. Rows run top to bottom, texels are red, green, blue, alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Texels in a row, 1–16384.
    pub width: u32,
    /// Rows, 1–16384.
    pub height: u32,
    /// `width × height` texels.
    pub texels: Vec<[u8; 4]>,
}

/// A mip level below 0, in linear light: 16 bits a channel, `65535` is 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MipLevel {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width × height` texels, red, green, blue, alpha.
    pub texels: Vec<[u16; 4]>,
}

/// Texels and how to sample them.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Level 0, shared by every texture made of the same file.
    pub image: Arc<Image>,
    /// How level 0 is decoded; the mips are linear already.
    pub color_space: ColorSpace,
    /// Levels 1, 2, … down to 1 × 1; empty for [`Filter::Nearest`].
    pub mips: Arc<Vec<MipLevel>>,
    /// Between texels.
    pub filter: Filter,
    /// Outside the unit square, along u and v.
    pub wrap: [Wrap; 2],
    /// Texture coordinates are scaled by this, then moved by `offset` (MTL `-s` and `-o`); 1 and 0 else.
    pub scale: [f64; 2],
    /// See `scale`.
    pub offset: [f64; 2],
    /// The one texel that all of the image consists of, if it does: what a map that changes nothing
    /// is known by.
    pub constant: Option<[u8; 4]>,
    /// Least code of each channel of level 0: a channel whose least is 255 reads as exactly 1 wherever it
    /// is sampled.
    pub least: [u8; 4],
}

impl Image {
    /// The one texel that all of it consists of, if it does.
    #[must_use]
    pub fn constant(&self) -> Option<[u8; 4]> {
        let first = *self.texels.first()?;
        self.texels.iter().all(|texel| *texel == first).then_some(first)
    }

    /// Whether every texel has alpha 255.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.texels.iter().all(|texel| texel[3] == u8::MAX)
    }

    /// Least code of each channel.
    #[must_use]
    pub fn least(&self) -> [u8; 4] {
        let least = |least: [u8; 4], texel: &[u8; 4]| std::array::from_fn(|c| least[c].min(texel[c]));
        self.texels.iter().fold([u8::MAX; 4], least)
    }

    /// The same size, with channel `channel` (0–3) of every texel as an opaque grey.
    #[must_use]
    pub fn channel_as_grey(&self, channel: usize) -> Self {
        let grey = |texel: &[u8; 4]| {
            let value = texel[channel.min(3)];
            [value, value, value, u8::MAX]
        };
        Self { width: self.width, height: self.height, texels: self.texels.iter().map(grey).collect() }
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        size_of_val(self.texels.as_slice()) as u64
    }
}

impl Texture {
    /// A texture over the unit square, with the mip chain that `filter` needs.
    #[must_use]
    pub fn new(image: Arc<Image>, color_space: ColorSpace, filter: Filter, wrap: [Wrap; 2]) -> Self {
        let mips = match filter {
            Filter::Nearest => Vec::new(),
            Filter::Bilinear | Filter::Trilinear => mips::chain(&image, color_space),
        };
        let (constant, least) = (image.constant(), image.least());
        let (scale, offset) = ([1.0; 2], [0.0; 2]);
        Self { image, color_space, mips: Arc::new(mips), filter, wrap, scale, offset, constant, least }
    }

    /// A linear texture that is `texel` everywhere.
    #[must_use]
    pub fn of_one_texel(texel: [u8; 4]) -> Self {
        let image = Image { width: 1, height: 1, texels: vec![texel] };
        Self::new(Arc::new(image), ColorSpace::Linear, Filter::Trilinear, [Wrap::Repeat; 2])
    }

    /// How the codes of red, green and blue of level 0 are decoded.
    #[must_use]
    pub fn decode(&self) -> &'static [f32; 256] {
        match self.color_space {
            ColorSpace::Srgb => &SRGB_DECODE,
            ColorSpace::Linear => &UNORM_DECODE,
        }
    }

    /// What it reads as wherever it is sampled, in linear light, if that is the same to the bit everywhere:
    /// mips of one colour are that colour but for their rounding.
    #[must_use]
    pub fn factor(&self) -> Option<[f32; 4]> {
        let [r, g, b, a] = self.constant.filter(|_| self.mips.is_empty())?.map(usize::from);
        let decode = self.decode();
        Some([decode[r], decode[g], decode[b], UNORM_DECODE[a]])
    }

    /// The same texture under scaled and moved coordinates; texels and mips are shared.
    #[must_use]
    pub fn placed(&self, scale: [f64; 2], offset: [f64; 2]) -> Self {
        Self { scale, offset, ..self.clone() }
    }

    /// Whether, as a normal map, it leaves every normal as it is: x and y are 0 everywhere.
    #[must_use]
    pub fn is_flat_normal_map(&self) -> bool {
        let flat = |[r, g, b, _]: [u8; 4]| (r, g) == (128, 128) && b > 128;
        self.color_space == ColorSpace::Linear && self.constant.is_some_and(flat)
    }

    /// Bytes of memory its image and mips hold, whoever shares them.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let mips: usize = self.mips.iter().map(|level| size_of_val(level.texels.as_slice())).sum();
        self.image.bytes() + mips as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Arc<Image> {
        Arc::new(Image { width: 4, height: 2, texels: vec![[10, 20, 30, 255]; 8] })
    }

    #[test]
    fn nearest_needs_no_mips() {
        let texture = Texture::new(image(), ColorSpace::Srgb, Filter::Nearest, [Wrap::Repeat; 2]);
        assert!(texture.mips.is_empty());
        assert_eq!(texture.bytes(), 32);
    }

    #[test]
    fn least_is_that_of_each_channel() {
        let texels = vec![[10, 200, 30, 255], [20, 100, 40, 255]];
        assert_eq!(Image { width: 2, height: 1, texels }.least(), [10, 100, 30, 255]);
    }

    #[test]
    fn bytes_count_the_mips() {
        let texture = Texture::new(image(), ColorSpace::Srgb, Filter::Trilinear, [Wrap::Clamp; 2]);
        assert_eq!(texture.mips.len(), 2);
        assert_eq!(texture.bytes(), 32 + 2 * 8 + 8);
    }
}
