//! Height maps: slopes from differences of filtered texels.

use super::{Coordinates, Sampler, address, index, place, whole};
use crate::math::round_to_f32;
use crate::math::simd::*;
use crate::model::texture::{Filter, Texture};
use crate::pipeline::shade::BLOCK;

/// Samples the slopes of a height map, its red channel in linear light: ∂h/∂u and ∂h/∂v in heights a
/// unit of the mesh's texture coordinates.
///
/// Differences over one texel of the level that is read, half of it to each side: seen from close the
/// slope changes steadily across texels, where the exact derivative of a bilinear picture jumps at
/// each of them. [`Filter::Nearest`] is read as bilinear in level 0: a picture of steps has no slope.
pub fn sample_slopes(
    level: Level,
    texture: &Texture,
    coordinates: &Coordinates,
    count: usize,
    out: &mut [[f32; BLOCK]; 2],
) {
    dispatch!(level, simd => slopes_kernel(simd, texture, coordinates, count, out));
}

#[inline(always)]
fn slopes_kernel<S: Simd>(
    simd: S,
    texture: &Texture,
    coordinates: &Coordinates,
    count: usize,
    out: &mut [[f32; BLOCK]; 2],
) {
    let sampler = Sampler::of_colors(texture);
    let scale = texture.scale.map(round_to_f32);
    for at in (0..count).step_by(LANES) {
        let [u, v, level] = place(simd, texture, coordinates, at);
        for lane in 0..LANES.min(count - at) {
            let slopes = sampler.slopes(u[lane], v[lane], level[lane]);
            for axis in 0..2 {
                out[axis][at + lane] = slopes[axis] * scale[axis];
            }
        }
    }
}

impl Sampler<'_> {
    /// Slopes of the red channel in heights a unit of u and of v.
    #[inline(always)]
    fn slopes(&self, u: f32, v: f32, level: f32) -> [f32; 2] {
        match self.texture.filter {
            Filter::Nearest => self.level_slopes(0, u, v),
            Filter::Bilinear => self.level_slopes(whole(level + 0.5), u, v),
            Filter::Trilinear => {
                let below = self.level_slopes(whole(level), u, v);
                let t = level - level.floor();
                if t == 0.0 {
                    return below;
                }
                let above = self.level_slopes(whole(level) + 1, u, v);
                [below[0] + (above[0] - below[0]) * t, below[1] + (above[1] - below[1]) * t]
            }
        }
    }

    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "a texture has at most 2¹⁴ texels a side")]
    fn level_slopes(&self, level: usize, u: f32, v: f32) -> [f32; 2] {
        let ([w, h], [wrap_u, wrap_v]) = (self.size(level), self.texture.wrap);
        let ([left, right], [below, above]) = (around(u, 0.5 / w as f32), around(v, 0.5 / h as f32));
        let column = always(
            #[inline(always)]
            |u: f32| address(wrap_u, u, w, 0.5),
        );
        let row = always(
            #[inline(always)]
            |v: f32| address(wrap_v, v, h, 0.5),
        );
        let (x, y) = (column(u), row(v));
        let across = self.height(level, column(right), y) - self.height(level, column(left), y);
        let up = self.height(level, x, row(above)) - self.height(level, x, row(below));
        // Over the step as it was rounded; none is left where coordinates are beyond all texels.
        let slope = always(
            #[inline(always)]
            |rise: f32, step: f32| if step > 0.0 { rise / step } else { 0.0 },
        );
        [slope(across, right - left), slope(up, above - below)]
    }

    /// The red channel between two columns and two rows of a level.
    #[inline(always)]
    fn height(&self, level: usize, (x, fx): ([usize; 2], f32), (y, fy): ([usize; 2], f32)) -> f32 {
        let between = always(
            #[inline(always)]
            |y: usize| {
                let (a, b) = (self.red(level, x[0], y), self.red(level, x[1], y));
                a + (b - a) * fx
            },
        );
        let (a, b) = (between(y[0]), between(y[1]));
        a + (b - a) * fy
    }

    #[inline(always)]
    fn red(&self, level: usize, x: usize, y: usize) -> f32 {
        if level == 0 {
            let image = &self.texture.image;
            self.decode[usize::from(image.texels[index(x, y, image.width, image.height)][0])]
        } else {
            let mip = &self.texture.mips[level - 1];
            self.decode16(mip.texels[index(x, y, mip.width, mip.height)][0])
        }
    }
}

/// `c` less and plus `reach`.
#[inline(always)]
fn around(c: f32, reach: f32) -> [f32; 2] {
    [c - reach, c + reach]
}
