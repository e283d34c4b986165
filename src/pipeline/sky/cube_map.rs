//! Cube maps, filtered across their edges.

use super::Sight;
use super::filter::{Radiance, level_of_detail, mix, trilinear, whole};
use super::rays::Rays;
use crate::math::View;
use crate::math::colour::SRGB_DECODE;
use crate::math::simd::*;
use crate::model::sky::CubeMap;
use crate::model::sky::cube_map::CubeLevel;
use glam::Vec3;
use std::sync::Arc;

/// A cube map and the lines of sight it is seen along.
#[derive(Clone, Debug)]
pub struct CubeMapView {
    map: Arc<CubeMap>,
    rays: Rays,
    per_pixel: [Vec3; 2],
}

/// The face that each of eight rays meets: that of its largest component.
#[derive(Clone, Copy)]
struct Faces<S: Simd> {
    on_x: mask32x8<S>,
    on_y: mask32x8<S>,
    /// 1 or −1: that component's sign.
    sign: f32x8<S>,
}

impl<S: Simd> Faces<S> {
    /// Of equal components the first counts: x, y, z.
    #[inline(always)]
    fn of(simd: S, ray: Vec3x8<S>) -> Self {
        let (x, y, z) = (ray.x.abs(), ray.y.abs(), ray.z.abs());
        let on_x = x.simd_ge(y) & x.simd_ge(z);
        let on_y = !on_x & y.simd_ge(z);
        let largest = on_x.select(ray.x, on_y.select(ray.y, ray.z));
        Self { on_x, on_y, sign: f32x8::splat(simd, 1.0).copysign(largest) }
    }

    /// A vector's components across the face, down it, and away from the centre.
    /// Source: OpenGL 4.6 specification, table 8.19.
    #[inline(always)]
    fn components(self, v: Vec3x8<S>) -> [f32x8<S>; 3] {
        let Self { on_x, on_y, sign } = self;
        let across = on_x.select(v.z * sign * -1.0, on_y.select(v.x, v.x * sign));
        let down = on_y.select(v.z * sign, v.y * -1.0);
        let away = on_x.select(v.x, on_y.select(v.y, v.z)) * sign;
        [across, down, away]
    }

    /// Their numbers in the order +x, −x, +y, −y, +z, −z.
    #[inline(always)]
    fn numbers(self, simd: S) -> [usize; LANES] {
        let axis = |n: f32| f32x8::splat(simd, n);
        let first = self.on_x.select(axis(0.0), self.on_y.select(axis(2.0), axis(4.0)));
        let number = first + (axis(1.0) - self.sign) * 0.5;
        std::array::from_fn(
            #[inline(always)]
            |lane| whole(number[lane]),
        )
    }
}

impl CubeMapView {
    /// Prepares a cube map for a view.
    #[must_use]
    pub fn new(map: &Arc<CubeMap>, view: &View) -> Self {
        let rays = Rays::new(view);
        Self { map: map.clone(), rays, per_pixel: rays.per_pixel() }
    }

    /// Level of detail from the texels that a pixel steps over, from the derivatives of (s, t) along
    /// the screen's axes.
    #[inline(always)]
    fn level<S: Simd>(&self, simd: S, faces: Faces<S>, [s, t, away]: [f32x8<S>; 3]) -> f32x8<S> {
        let half_side = side(&self.map.levels[0]) * 0.5;
        let squared = always(
            #[inline(always)]
            |step: Vec3| {
                let [across, down, outward] = faces.components(Vec3x8::splat(simd, step));
                let (ds, dt) = ((across - s * outward) / away, (down - t * outward) / away);
                ds * ds + dt * dt
            },
        );
        let squared = max(squared(self.per_pixel[0]), squared(self.per_pixel[1]));
        level_of_detail(squared * (half_side * half_side), self.map.levels.len())
    }
}

impl Sight for CubeMapView {
    #[inline(always)]
    fn radiance<S: Simd>(&self, simd: S, x: f64x8<S>, y: f64x8<S>) -> Vec3x8<S> {
        let ray = self.rays.through(x, y);
        let faces = Faces::of(simd, ray);
        let [across, down, away] = faces.components(ray);
        let (s, t) = (across / away, down / away);
        let level = self.level(simd, faces, [s, t, away]);
        let numbers = faces.numbers(simd);
        let decode = &*SRGB_DECODE;
        let mut out = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let texel = trilinear(
                level[lane],
                #[inline(always)]
                |level| bilinear(&self.map.levels[level], numbers[lane], [s[lane], t[lane]], decode),
            );
            for c in 0..3 {
                out[c][lane] = texel[c];
            }
        }
        Vec3x8::load(simd, &out, 0)
    }
}

/// Texels along a side.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "a face has at most 2¹⁴ texels a side")]
fn side(level: &CubeLevel) -> f32 {
    level.side as f32
}

/// Between four texels of a face with its border; s and t in −1 to 1.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "a face has at most 2¹⁴ texels a side")]
fn bilinear(level: &CubeLevel, face: usize, st: [f32; 2], decode: &[f32; 256]) -> Radiance {
    let wide = level.side + 2;
    // The border's texel has its centre half a texel before the face: at ½ of the bordered picture.
    let [x, y] = st.map(|c| (c + 1.0) * 0.5 * side(level) + 0.5);
    let (column, row) = (whole(x).min(level.side), whole(y).min(level.side));
    let (fx, fy) = (x - column as f32, y - row as f32);
    let at = (face * wide + row) * wide + column;
    let between = always(
        #[inline(always)]
        |at: usize| mix(level.texels.linear(at, decode), level.texels.linear(at + 1, decode), fx),
    );
    mix(between(at), between(at + wide), fy)
}
