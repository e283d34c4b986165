//! The background, where nothing else is.

use super::tiles::cover::Region;
use crate::math::simd::*;
use crate::math::{Projection, View, approx, round_to_f32};
use crate::scene;
use glam::Vec3;

/// A background as the tiles draw it.
#[derive(Clone, Copy, Debug)]
pub enum Background {
    /// One colour.
    Color(Vec3),
    /// By the elevation of the line of sight.
    Gradient {
        /// Colour at the nadir, and what it gains towards the zenith.
        bottom: Vec3,
        /// Zenith less nadir.
        rise: Vec3,
        /// World y of the line of sight's component per sub-pixel in x and y, and of the axis.
        elevation: [f32; 3],
        /// 1 / sub-pixels per unit of x/w and y/w.
        unit: [f32; 2],
    },
    /// Nothing: alpha 0.
    Transparent,
}

impl Background {
    /// Prepares a scene's background for a view.
    #[must_use]
    pub fn new(background: &scene::Background, view: &View) -> Self {
        match background {
            scene::Background::Color(color) => Self::Color(*color),
            scene::Background::Transparent => Self::Transparent,
            scene::Background::Gradient { top, bottom } => {
                let unit = match view.projection {
                    Projection::Perspective => view.scale.map(|scale| 1.0 / scale),
                    Projection::Orthographic => [0.0; 2],
                };
                let elevation = [view.right.y * unit[0], -view.up.y * unit[1], view.forward.y];
                Self::Gradient {
                    bottom: *bottom,
                    rise: *top - *bottom,
                    elevation: elevation.map(round_to_f32),
                    unit: unit.map(round_to_f32),
                }
            }
        }
    }

    /// Whether the picture has alpha.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        matches!(self, Self::Transparent)
    }

    /// Writes the colours of `pixels` (`y · side + x` within the tile) to their places.
    pub fn draw(&self, level: Level, pixels: &[u32], region: &Region, side: usize, out: &mut [Vec<f32>; 3]) {
        if !pixels.is_empty() {
            dispatch!(level, simd => self.draw_kernel(simd, pixels, region, side, out));
        }
    }

    #[inline(always)]
    fn draw_kernel<S: Simd>(
        &self,
        simd: S,
        pixels: &[u32],
        region: &Region,
        side: usize,
        out: &mut [Vec<f32>; 3],
    ) {
        match *self {
            Self::Color(color) => fill(pixels, color, out),
            Self::Transparent => fill(pixels, Vec3::ZERO, out),
            Self::Gradient { bottom, rise, elevation, unit } => {
                for group in pixels.chunks(LANES) {
                    let pixel = always(
                        #[inline(always)]
                        |lane: usize| group[lane.min(group.len() - 1)] as usize,
                    );
                    let x = f32x8::from_fn(
                        simd,
                        #[inline(always)]
                        |lane| centre(region.origin[0], pixel(lane) % side),
                    );
                    let y = f32x8::from_fn(
                        simd,
                        #[inline(always)]
                        |lane| centre(region.origin[1], pixel(lane) / side),
                    );
                    let height = x * elevation[0] + y * elevation[1] + elevation[2];
                    let (a, b) = (x * unit[0], y * unit[1]);
                    let length = (a * a + b * b + 1.0).sqrt();
                    let one = f32x8::splat(simd, 1.0);
                    let sine = min(max(height / length, one * -1.0), one);
                    let t = approx::asin(sine) * std::f32::consts::FRAC_1_PI + 0.5;
                    for (lane, &pixel) in group.iter().enumerate() {
                        let color = bottom + rise * t[lane];
                        for c in 0..3 {
                            out[c][pixel as usize] = color[c];
                        }
                    }
                }
            }
        }
    }
}

fn fill(pixels: &[u32], color: Vec3, out: &mut [Vec<f32>; 3]) {
    for (channel, value) in out.iter_mut().zip(color.to_array()) {
        for &pixel in pixels {
            channel[pixel as usize] = value;
        }
    }
}

/// Screen coordinate of a pixel's centre: exact in f32, below 2²² sub-pixels.
#[expect(clippy::cast_precision_loss, reason = "a picture has at most 2²² sub-pixels a side")]
fn centre(origin: i32, pixel: usize) -> f32 {
    (origin + i32::try_from(pixel).expect("a tile is small") * 256 + 128) as f32
}
