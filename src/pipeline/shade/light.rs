//! Light on a block of fragments: Blinn-Phong and its relatives, in linear RGB.

use super::varyings::Varyings;
use super::{BLOCK, Lighting};
use crate::math::simd::*;
use crate::math::{Projection, View, approx, round_to_f32};
use crate::plan::{Elision, PlannedLight};
use crate::scene::LightKind;
use glam::{DVec3, Vec3};

/// A light as the kernels read it. Positions are relative to [`super::anchor`], in world axes.
#[derive(Clone, Copy, Debug)]
pub struct LightSource {
    radiance: Vec3,
    place: Place,
    /// Index of its shadow.
    pub shadow: Option<usize>,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    /// Unit vector towards the light.
    Towards(Vec3),
    /// Position, and the coefficients of 1, d and d².
    At(Vec3, [f32; 3]),
}

impl LightSource {
    /// Brings a light into the frame of the view and its [`super::anchor`].
    #[must_use]
    pub fn new(light: &PlannedLight, view: &View, anchor: DVec3) -> Self {
        let place = match light.kind {
            LightKind::Directional { direction } => Place::Towards(-direction.as_vec3()),
            LightKind::Point { position, attenuation: a } => Place::At(
                (position - view.eye - anchor).as_vec3(),
                [a.constant, a.linear, a.quadratic].map(round_to_f32),
            ),
        };
        Self { radiance: light.radiance, place, shadow: light.shadow.map(|index| index as usize) }
    }
}

/// What a surface reflects, fragment by fragment, linear RGB.
pub struct Reflectance<'a> {
    /// To ambient light; `None`: as `diffuse`.
    pub ambient: Option<Vec3>,
    /// Diffuse.
    pub diffuse: &'a [[f32; BLOCK]; 3],
    /// Specular and its exponent.
    pub specular: Option<(&'a [[f32; BLOCK]; 3], f32)>,
}

/// Adds what the surface makes of ambient light.
pub fn add_ambient(
    level: Level,
    ambient: Vec3,
    reflectance: &Reflectance,
    count: usize,
    out: &mut [[f32; BLOCK]; 3],
) {
    dispatch!(level, simd => {
        for at in (0..count).step_by(LANES) {
            let factor = match reflectance.ambient {
                Some(color) => Vec3x8::splat(simd, color),
                None => Vec3x8::load(simd, reflectance.diffuse, at),
            };
            (Vec3x8::load(simd, out, at) + factor * Vec3x8::splat(simd, ambient)).store(out, at);
        }
    });
}

/// One bit for each fragment of a block: whether it faces the light.
pub fn facing(level: Level, light: &LightSource, varyings: &Varyings, count: usize) -> u64 {
    dispatch!(level, simd => {
        let mut bits = 0;
        for at in (0..count).step_by(LANES) {
            let normal = Vec3x8::load(simd, &varyings.normal, at);
            let position = Vec3x8::load(simd, &varyings.position, at);
            let (towards, _) = incoming(simd, light, position);
            let lit = normal.dot(towards).simd_gt(f32x8::splat(simd, 0.0));
            bits |= lit.to_bitmask() << at;
        }
        bits
    })
}

/// Adds what a light contributes to a block; `visibility` is 1 where it is seen and 0 in its shadow. Returns
/// how many fragments were looked at.
#[expect(clippy::too_many_arguments, reason = "one term of the lighting sum, with all it depends on")]
pub fn add_light(
    level: Level,
    light: &LightSource,
    visibility: &[f32; BLOCK],
    varyings: &Varyings,
    lighting: &Lighting,
    reflectance: &Reflectance,
    count: usize,
    out: &mut [[f32; BLOCK]; 3],
) -> usize {
    dispatch!(level, simd => {
        let mut lit = 0;
        for at in (0..count).step_by(LANES) {
            let seen = f32x8::from_slice(simd, &visibility[at..at + LANES]);
            if add_to_eight(simd, light, seen, varyings, lighting, reflectance, at, out) {
                lit += LANES.min(count - at);
            }
        }
        lit
    })
}

/// Adds to eight fragments of a block; false if they are left out because none faces the light.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "eight fragments of `add_light`")]
fn add_to_eight<S: Simd>(
    simd: S,
    light: &LightSource,
    visibility: f32x8<S>,
    varyings: &Varyings,
    lighting: &Lighting,
    reflectance: &Reflectance,
    at: usize,
    out: &mut [[f32; BLOCK]; 3],
) -> bool {
    let normal = Vec3x8::load(simd, &varyings.normal, at);
    let position = Vec3x8::load(simd, &varyings.position, at);
    let (towards, attenuation) = incoming(simd, light, position);
    let zero = f32x8::splat(simd, 0.0);
    let cosine = normal.dot(towards);
    let lit = cosine.simd_gt(zero);
    if lit.all_false() && lighting.elide.contains(Elision::TurnedAway) {
        return false;
    }
    let mut reflected = Vec3x8::load(simd, reflectance.diffuse, at).scale(cosine);
    if let Some((color, shininess)) = reflectance.specular {
        let half = (towards + towards_viewer(simd, position, lighting)).normalize();
        let highlight = specular_lobe(simd, normal, half, shininess);
        reflected = reflected + Vec3x8::load(simd, color, at).scale(highlight);
    }
    let gain = Vec3x8::splat(simd, light.radiance).scale(attenuation * visibility);
    let dark = Vec3x8 { x: zero, y: zero, z: zero };
    let sum = Vec3x8::load(simd, out, at) + (reflected * gain).select(lit, dark);
    sum.store(out, at);
    true
}

/// Unit vectors towards the viewer.
#[inline(always)]
fn towards_viewer<S: Simd>(simd: S, position: Vec3x8<S>, lighting: &Lighting) -> Vec3x8<S> {
    match lighting.view.projection {
        Projection::Orthographic => Vec3x8::splat(simd, -lighting.view.forward.as_vec3()),
        Projection::Perspective => {
            let (v, _) =
                direction_and_length(simd, position + Vec3x8::splat(simd, lighting.anchor.as_vec3()));
            Vec3x8 { x: -v.x, y: -v.y, z: -v.z }
        }
    }
}

/// Unit vector and length, scaled by the largest component first, so that no square over- or
/// underflows. A vector of no length has no direction: zero.
#[inline(always)]
fn direction_and_length<S: Simd>(simd: S, v: Vec3x8<S>) -> (Vec3x8<S>, f32x8<S>) {
    let largest = max(max(v.x.abs(), v.y.abs()), v.z.abs());
    let largest = max(largest, f32x8::splat(simd, f32::MIN_POSITIVE));
    let scaled = Vec3x8 { x: v.x / largest, y: v.y / largest, z: v.z / largest };
    let length = scaled.dot(scaled).sqrt();
    let divisor = max(length, f32x8::splat(simd, f32::MIN_POSITIVE));
    let direction = Vec3x8 { x: scaled.x / divisor, y: scaled.y / divisor, z: scaled.z / divisor };
    (direction, length * largest)
}

/// Unit vector towards the light, and its attenuation.
#[inline(always)]
fn incoming<S: Simd>(simd: S, light: &LightSource, position: Vec3x8<S>) -> (Vec3x8<S>, f32x8<S>) {
    match light.place {
        Place::Towards(direction) => (Vec3x8::splat(simd, direction), f32x8::splat(simd, 1.0)),
        Place::At(place, [constant, linear, quadratic]) => {
            let to_light = Vec3x8::splat(simd, place) - position;
            let (towards, distance) = direction_and_length(simd, to_light);
            let falloff = distance * distance * quadratic + distance * linear + constant;
            (towards, f32x8::splat(simd, 1.0) / max(falloff, f32x8::splat(simd, 1e-6)))
        }
    }
}

/// `(N·H)^s` for unit vectors, 0 where N·H ≤ 0 and s > 0.
///
/// Near the peak N·H is taken as `1 − |N − H|²/2`, whose second term keeps the digits that the dot
/// product rounds away: at s = 10⁵ that is the difference between 1.5 % and 2 · 10⁻⁶.
#[inline(always)]
fn specular_lobe<S: Simd>(simd: S, normal: Vec3x8<S>, half: Vec3x8<S>, shininess: f32) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let cosine = normal.dot(half);
    let apart = normal - half;
    let q = apart.dot(apart) * 0.5;
    let peak = cosine.simd_gt(f32x8::splat(simd, 0.5));
    let x = peak.select(one - q, max(cosine, f32x8::splat(simd, f32::MIN_POSITIVE)));
    let d = peak.select(zero - q, x - one);
    let lobe = approx::exp2(approx::log2_1p(x, d) * shininess);
    if shininess == 0.0 { one } else { cosine.simd_gt(zero).select(lobe, zero) }
}

#[cfg(test)]
mod tests;
