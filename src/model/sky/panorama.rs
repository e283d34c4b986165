//! Equirectangular pictures of everything around.

use super::texels::{Picture, PictureSize, Texels, texel_bytes};
use crate::math::colour::SRGB_DECODE;
use crate::model::texture::mips::{half, halve};
use std::fmt;

/// An equirectangular picture with its mips.
///
/// The top row is straight up, the centre column along −z, and columns run towards +x: texel (x, y)
/// has its centre at the azimuth `2π (x + ½) / width − π` (from −z towards +x) and the elevation
/// `π/2 − π (y + ½) / height`.
#[derive(Clone, PartialEq)]
pub struct Panorama {
    name: String,
    /// Level 0 is the picture; each side of the next is half, down to 1 × 1.
    pub levels: Vec<PanoramaLevel>,
}

/// A mip level.
#[derive(Clone, PartialEq)]
pub struct PanoramaLevel {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width × height` texels, rows from the top.
    pub texels: Texels,
}

impl Panorama {
    /// Adds the mips to a picture. Each texel of a level is the mean over the area it covers in the one
    /// above, in linear light.
    ///
    /// `name` tells it from other panoramas of one scene: see [`Panorama::name`].
    #[must_use]
    pub fn new(name: String, picture: Picture) -> Self {
        let (width, height) = (picture.width as usize, picture.height as usize);
        let mut levels = vec![PanoramaLevel { width, height, texels: picture.texels }];
        while let Some(level) = levels.last().and_then(PanoramaLevel::next) {
            levels.push(level);
        }
        Self { name, levels }
    }

    /// Bytes of memory that one of a picture of this size will hold.
    #[must_use]
    pub fn bytes_of(size: PictureSize) -> u64 {
        let mut sides = [size.width as usize, size.height as usize];
        let mut bytes = size.bytes();
        while sides != [1, 1] {
            sides = sides.map(half);
            bytes += sides[0] as u64 * sides[1] as u64 * texel_bytes(true);
        }
        bytes
    }

    /// What its picture is called: the same scene content and the same name make the same panorama.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| level.texels.bytes()).sum()
    }
}

impl PanoramaLevel {
    /// The level below; `None` below 1 × 1.
    fn next(&self) -> Option<Self> {
        if self.width.max(self.height) <= 1 {
            return None;
        }
        let decode = &*SRGB_DECODE;
        let above = |x: usize, y: usize| with_alpha(self.texels.linear(y * self.width + x, decode));
        let texels = halve(self.width, self.height, above).texels;
        let texels = Texels::Linear(texels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect());
        Some(Self { width: half(self.width), height: half(self.height), texels })
    }
}

/// Mip chains have a fourth channel; skies leave it alone.
pub(super) fn with_alpha([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0]
}

/// Name and size stand for the texels.
impl fmt::Debug for Panorama {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let size = self.levels.first().map(|level| [level.width, level.height]);
        f.debug_struct("Panorama").field("name", &self.name).field("size", &size).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mips_halve_to_the_mean() {
        let texels = Texels::Linear(vec![[0.0, 1.0, 65504.0], [4.0, 1.0, 0.0]]);
        let panorama = Panorama::new("x".to_owned(), Picture { width: 2, height: 1, texels });
        assert_eq!(panorama.levels.len(), 2);
        assert_eq!(panorama.levels[1].texels, Texels::Linear(vec![[2.0, 1.0, 32752.0]]));
        assert_eq!(panorama.bytes(), 36);
    }

    #[test]
    fn its_bytes_are_known_before_it_is_there() {
        for (width, height) in [(1, 1), (2, 1), (7, 3), (16, 8)] {
            for is_linear in [false, true] {
                let count = (width * height) as usize;
                let texels = match is_linear {
                    true => Texels::Linear(vec![[0.5; 3]; count]),
                    false => Texels::Srgb8(vec![[1; 4]; count]),
                };
                let known = Panorama::bytes_of(PictureSize { width, height, is_linear });
                assert_eq!(Panorama::new(String::new(), Picture { width, height, texels }).bytes(), known);
            }
        }
    }

    #[test]
    fn codes_average_in_linear_light() {
        let texels = Texels::Srgb8(vec![[0, 0, 255, 9], [255, 0, 255, 0]]);
        let panorama = Panorama::new("x".to_owned(), Picture { width: 1, height: 2, texels });
        assert_eq!(panorama.levels[1].texels, Texels::Linear(vec![[0.5, 0.0, 1.0]]));
    }

    #[test]
    fn debug_tells_names_apart_and_holds_no_texels() {
        let of = |name: &str| {
            let texels = Texels::Srgb8(vec![[1, 2, 3, 4]; 64]);
            format!("{:?}", Panorama::new(name.to_owned(), Picture { width: 8, height: 8, texels }))
        };
        assert_ne!(of("a"), of("b"));
        assert!(of("a").len() < 60);
    }
}
