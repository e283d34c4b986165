//! The procedural sky, pixel by pixel.

use super::Sight;
use super::rays::Rays;
use crate::math::simd::*;
use crate::math::{View, approx, round_to_f32};
use crate::model::sky::Daylight;
use crate::model::sky::daylight::{COLUMNS, HAZE_G, ROWS, SUN_RADIUS, haze_scale};
use glam::Vec3;
use std::sync::Arc;

/// How fast the plain shows through the haze: at this part of straight down, e⁻¹ of it.
const HAZE_OVER_GROUND: f32 = 0.01;

/// Phase of molecules: times `1 + cos²`.
const RAYLEIGH_SCALE: f32 = 3.0 / 16.0 * std::f32::consts::FRAC_1_PI;

/// A sky and the lines of sight it is seen along.
#[derive(Clone, Debug)]
pub struct DaylightView {
    sky: Arc<Daylight>,
    rays: Rays,
    towards_sun: Vec3,
    /// Unit vector (x, z) towards the sun's azimuth; any for a sun at the zenith.
    sun_azimuth: [f32; 2],
    /// Angle of a pixel in the middle of the picture.
    pixel_angle: f32,
    haze_scale: f32,
}

impl DaylightView {
    /// Prepares a sky for a view.
    #[must_use]
    pub fn new(sky: &Arc<Daylight>, view: &View) -> Self {
        let rays = Rays::new(view);
        let sun = sky.towards_sun;
        let across = libm::hypot(sun.x, sun.z);
        let azimuth = if across > 0.0 { [sun.x / across, sun.z / across] } else { [0.0, -1.0] };
        let [right, down] = rays.per_pixel().map(Vec3::length);
        Self {
            sky: sky.clone(),
            rays,
            towards_sun: Vec3::from_array(sun.to_array().map(round_to_f32)),
            sun_azimuth: azimuth.map(round_to_f32),
            pixel_angle: if right > down { right } else { down },
            haze_scale: round_to_f32(haze_scale()),
        }
    }

    /// Light scattered towards the viewer from a direction at or above the horizon.
    #[inline(always)]
    fn scattered<S: Simd>(&self, simd: S, sight: Vec3x8<S>) -> Vec3x8<S> {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let across = (sight.x * sight.x + sight.z * sight.z).sqrt();
        // At the zenith every azimuth is as good as any.
        let azimuth_cosine = (sight.x * self.sun_azimuth[0] + sight.z * self.sun_azimuth[1])
            / max(across, f32x8::splat(simd, 1e-20));
        let row = sight.y.sqrt() * last(ROWS);
        let column = (one - azimuth_cosine) * (0.5 * last(COLUMNS));
        let row = min(max(row, zero), f32x8::splat(simd, last(ROWS)));
        let column = min(max(column, zero), f32x8::splat(simd, last(COLUMNS)));

        let cosine = sight.dot(Vec3x8::splat(simd, self.towards_sun));
        let g = round_to_f32(HAZE_G);
        let lobe = cosine * cosine + 1.0;
        let wide = max(cosine * (-2.0 * g) + (1.0 + g * g), f32x8::splat(simd, (1.0 - g) * (1.0 - g)));
        let molecules = lobe * RAYLEIGH_SCALE;
        let haze = lobe * self.haze_scale / (wide * wide.sqrt());

        let mut out = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let entry = self.entry(simd, row[lane], column[lane]);
            for c in 0..3 {
                out[c][lane] = entry[c] * molecules[lane] + entry[3 + c] * haze[lane];
            }
        }
        Vec3x8::load(simd, &out, 0)
    }

    /// The table between its entries.
    #[inline(always)]
    fn entry<S: Simd>(&self, simd: S, row: f32, column: f32) -> f32x8<S> {
        let ((i, s), (j, t)) = (place(row, ROWS), place(column, COLUMNS));
        let load = always(
            #[inline(always)]
            |at: usize| f32x8::simd_from(simd, self.sky.table[at]),
        );
        let between = always(
            #[inline(always)]
            |i: usize| {
                let (a, b) = (load(i * COLUMNS + j), load(i * COLUMNS + j + 1));
                a + (b - a) * t
            },
        );
        let (a, b) = (between(i), between(i + 1));
        a + (b - a) * s
    }

    /// How much of a pixel the sun's disc covers: its edge is as soft as a pixel is wide.
    #[inline(always)]
    fn disc_coverage<S: Simd>(&self, simd: S, sight: Vec3x8<S>, length: f32x8<S>) -> f32x8<S> {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let radius = f32x8::splat(simd, round_to_f32(SUN_RADIUS));
        // The chord keeps the digits that the cosine of a small angle has lost.
        let away = sight - Vec3x8::splat(simd, self.towards_sun);
        let chord = away.dot(away).sqrt();
        let pixel = max(f32x8::splat(simd, self.pixel_angle) / length, radius * 0.1);
        let unit = always(
            #[inline(always)]
            |x: f32x8<S>| min(max(x, zero), one),
        );
        unit((radius - chord) / pixel + 0.5) * unit(sight.y / pixel + 0.5)
    }
}

impl Sight for DaylightView {
    #[inline(always)]
    fn radiance<S: Simd>(&self, simd: S, x: f64x8<S>, y: f64x8<S>) -> Vec3x8<S> {
        let splat = always(
            #[inline(always)]
            |v: f32| f32x8::splat(simd, v),
        );
        let ray = self.rays.through(x, y);
        let length = ray.dot(ray).sqrt();
        let sight = Vec3x8 { x: ray.x / length, y: ray.y / length, z: ray.z / length };

        // Below the horizon: the sky at the horizon, and the plain in front of it.
        let up = max(sight.y, splat(0.0));
        let above = Vec3x8 { y: up, ..sight };
        let level = max(above.dot(above).sqrt(), splat(f32::MIN_POSITIVE));
        let above = Vec3x8 { x: above.x / level, y: up / level, z: above.z / level };
        let sky = self.scattered(simd, above);
        let disc = Vec3x8::splat(simd, self.sky.disc).scale(self.disc_coverage(simd, sight, length));
        let hidden = ground_share(simd, sight.y);
        let ground = Vec3x8::splat(simd, self.sky.ground);
        let seen = sky + disc;
        seen + (ground - seen).scale(hidden) + Vec3x8::splat(simd, self.sky.night)
    }
}

/// Share of the plain in what is seen at a sine of elevation: haze dims it by `exp(−c / sin)`, as it
/// does on the way to a plain; 0 at the horizon with all its derivatives, 1 straight down.
#[inline(always)]
fn ground_share<S: Simd>(simd: S, up: f32x8<S>) -> f32x8<S> {
    let down = max(up * -1.0, f32x8::splat(simd, 1e-6));
    let depth = (f32x8::splat(simd, 1.0) / down - 1.0) * (HAZE_OVER_GROUND * std::f32::consts::LOG2_E);
    up.simd_lt(f32x8::splat(simd, 0.0)).select(approx::exp2(depth * -1.0), f32x8::splat(simd, 0.0))
}

/// Index of the last entry.
#[expect(clippy::cast_precision_loss, reason = "a few dozen")]
const fn last(count: usize) -> f32 {
    (count - 1) as f32
}

/// The entry before `x` in 0..=last, and how far it is to the next.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped to a table of a few dozen entries"
)]
fn place(x: f32, count: usize) -> (usize, f32) {
    let first = (x as usize).min(count - 2);
    (first, x - first as f32)
}
