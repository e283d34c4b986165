//! Panoramas, filtered over what a pixel covers, also at the poles.

use super::Sight;
use super::filter::{Radiance, level_of_detail, mix, trilinear, whole};
use super::rays::Rays;
use crate::math::colour::SRGB_DECODE;
use crate::math::simd::*;
use crate::math::{View, approx};
use crate::model::sky::Panorama;
use crate::model::sky::panorama::PanoramaLevel;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

/// A panorama and the lines of sight it is seen along.
#[derive(Clone, Debug)]
pub struct PanoramaView {
    panorama: Arc<Panorama>,
    rays: Rays,
    per_pixel: [Vec3; 2],
}

/// Angles of eight rays, and by how much they change within a pixel.
struct Angles<S: Simd> {
    /// From −z towards +x, −π to π.
    azimuth: f32x8<S>,
    /// −π/2 to π/2.
    elevation: f32x8<S>,
    /// Per pixel, the larger of right and down; at most a whole turn.
    azimuth_step: f32x8<S>,
    /// Per pixel, the larger of right and down, squared.
    elevation_step_squared: f32x8<S>,
}

impl PanoramaView {
    /// Prepares a panorama for a view.
    #[must_use]
    pub fn new(panorama: &Arc<Panorama>, view: &View) -> Self {
        let rays = Rays::new(view);
        Self { panorama: panorama.clone(), rays, per_pixel: rays.per_pixel() }
    }

    /// Angles of rays with their derivatives along the screen's axes.
    #[inline(always)]
    fn angles<S: Simd>(&self, simd: S, ray: Vec3x8<S>) -> Angles<S> {
        let level_squared = ray.x * ray.x + ray.z * ray.z;
        let level = level_squared.sqrt();
        let squared = level_squared + ray.y * ray.y;
        // Straight up, where azimuths meet, a step is a whole turn.
        let guarded = max(level_squared, squared * 1e-12);
        let (per_azimuth, per_level) =
            (f32x8::splat(simd, 1.0) / guarded, f32x8::splat(simd, 1.0) / guarded.sqrt());
        let step = always(
            #[inline(always)]
            |d: Vec3| {
                let azimuth = (ray.x * d.z - ray.z * d.x) * per_azimuth;
                let outward = (ray.x * d.x + ray.z * d.z) * per_level;
                let elevation = (level * d.y - ray.y * outward) / squared;
                (azimuth.abs(), elevation * elevation)
            },
        );
        let (right, down) = (step(self.per_pixel[0]), step(self.per_pixel[1]));
        Angles {
            azimuth: approx::atan2(ray.x, ray.z * -1.0),
            elevation: approx::atan2(ray.y, level),
            azimuth_step: min(max(right.0, down.0), f32x8::splat(simd, TAU)),
            elevation_step_squared: max(right.1, down.1),
        }
    }
}

impl Sight for PanoramaView {
    /// Rows are filtered by mips, as far as a pixel reaches in elevation; along the row, texels are
    /// summed as far as it reaches in azimuth, which near a pole is far more.
    #[inline(always)]
    fn radiance<S: Simd>(&self, simd: S, x: f64x8<S>, y: f64x8<S>) -> Vec3x8<S> {
        let angles = self.angles(simd, self.rays.through(x, y));
        let levels = &self.panorama.levels;
        let rows_per_radian = count(levels[0].height) * FRAC_1_PI;
        let rows_squared = angles.elevation_step_squared * (rows_per_radian * rows_per_radian);
        let level = level_of_detail(rows_squared, levels.len());
        let u = angles.azimuth * (0.5 * FRAC_1_PI) + 0.5;
        let v = f32x8::splat(simd, 0.5) - angles.elevation * FRAC_1_PI;
        let reach = angles.azimuth_step * (0.5 * FRAC_1_PI);
        let decode = &*SRGB_DECODE;
        let mut out = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let texel = trilinear(
                level[lane],
                #[inline(always)]
                |level| between_rows(&levels[level], u[lane], v[lane], reach[lane], decode),
            );
            for c in 0..3 {
                out[c][lane] = texel[c];
            }
        }
        Vec3x8::load(simd, &out, 0)
    }
}

/// Between two rows of a level; beyond the first and last, these.
#[inline(always)]
fn between_rows(level: &PanoramaLevel, u: f32, v: f32, reach: f32, decode: &[f32; 256]) -> Radiance {
    let last = level.height - 1;
    let y = (v * count(level.height) - 0.5).clamp(0.0, count(last));
    let row = whole(y).min(last);
    let part = y - count(row);
    let above = along_row(level, row, u, reach, decode);
    if part == 0.0 { above } else { mix(above, along_row(level, row + 1, u, reach, decode), part) }
}

/// Mean of a row over `reach` turns around `u`, but at least one texel wide: which is the linear
/// interpolation between two.
#[inline(always)]
fn along_row(level: &PanoramaLevel, row: usize, u: f32, reach: f32, decode: &[f32; 256]) -> Radiance {
    let width = count(level.width);
    let texel = always(
        #[inline(always)]
        |column: usize| level.texels.linear(row * level.width + wrapped(column, level.width), decode),
    );
    // Columns are counted from a turn before, so that none is negative.
    if reach * width <= 1.0 {
        let x = u * width - 0.5 + width;
        let first = whole(x);
        return mix(texel(first), texel(first + 1), x - count(first));
    }
    let reach = (reach * width).min(width);
    let begin = u * width - reach * 0.5 + width;
    let end = begin + reach;
    let (first, last) = (whole(begin), whole(end));
    let mut sum = texel(first).map(|c| c * (count(first + 1) - begin));
    for column in first + 1..last {
        add(&mut sum, texel(column), 1.0);
    }
    add(&mut sum, texel(last), end - count(last));
    sum.map(|c| c / reach)
}

/// A column counted from up to three turns before.
#[inline(always)]
fn wrapped(mut column: usize, width: usize) -> usize {
    while column >= width {
        column -= width;
    }
    column
}

#[inline(always)]
fn add(sum: &mut Radiance, texel: Radiance, weight: f32) {
    for c in 0..3 {
        sum[c] += texel[c] * weight;
    }
}

#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "a panorama has at most 2¹⁴ texels a side")]
fn count(texels: usize) -> f32 {
    texels as f32
}
