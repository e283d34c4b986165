//! Checker textures.

use super::Image;
use crate::limits::MAX_CHECKER_CELLS;
use crate::math::colour::srgb_from_linear;
use glam::Vec3;

/// Texels a side that a checker has at least, so that its bilinear edges look sharp up close.
const MIN_SIDE: u32 = 1024;

impl Image {
    /// `cells` × `cells` squares over the unit square, `colors[0]` at the lower left corner.
    ///
    /// Colours are linear RGB, stored as sRGB codes and so clamped to 0–1. `cells` is clamped to
    /// 1–[`MAX_CHECKER_CELLS`]. The side is the least multiple of `cells` from 1024 texels on: every cell is
    /// the same whole number of texels.
    #[must_use]
    pub fn checker(colors: [Vec3; 2], cells: u32) -> Self {
        let cells = cells.clamp(1, MAX_CHECKER_CELLS);
        let texels_per_cell = MIN_SIDE.div_ceil(cells);
        let side = cells * texels_per_cell;
        let codes = colors.map(srgb8_from_linear);
        let row = |y: u32| {
            let cell_y = (side - 1 - y) / texels_per_cell; // rows run down, v runs up
            (0..side).map(move |x| codes[((x / texels_per_cell + cell_y) % 2) as usize])
        };
        Self { width: side, height: side, texels: (0..side).flat_map(row).collect() }
    }
}

/// The opaque texel of a linear colour.
fn srgb8_from_linear(color: Vec3) -> [u8; 4] {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to 0–1, so the code lies in 0–255"
    )]
    let code = |value: f32| (srgb_from_linear(f64::from(value).clamp(0.0, 1.0)) * 255.0 + 0.5).floor() as u8;
    [code(color.x), code(color.y), code(color.z), 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_color_is_at_the_lower_left() {
        let image = Image::checker([Vec3::X, Vec3::Y], 3);
        let at = |x: u32, y: u32| image.texels[(y * image.width + x) as usize];
        assert_eq!(image.width % 3, 0);
        assert_eq!(at(0, image.height - 1), [255, 0, 0, 255]);
        assert_eq!(at(image.width / 2, image.height - 1), [0, 255, 0, 255]);
        assert_eq!(at(0, image.height / 2), [0, 255, 0, 255]);
        assert_eq!(at(0, 0), [255, 0, 0, 255]);
    }

    #[test]
    fn sides_stay_between_1024_and_2048() {
        for cells in [0, 1, 2, 3, 7, 8, 100, 1000, 1023, 1024, 1025, 2048, 4_000_000_000] {
            let image = Image::checker([Vec3::ZERO, Vec3::ONE], cells);
            assert!((1024..=2048).contains(&image.width), "{cells} cells give {}", image.width);
            assert_eq!(image.texels.len(), (image.width * image.height) as usize);
        }
    }
}
