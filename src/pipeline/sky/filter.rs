//! What cube maps and panoramas share: levels of detail, and what lies between texels.

use crate::math::approx;
use crate::math::simd::*;

/// Linear red, green, blue.
pub type Radiance = [f32; 3];

/// `½ log2` of the squared number of texels that a pixel steps over, clamped to the levels there are.
#[inline(always)]
pub fn level_of_detail<S: Simd>(texels_squared: f32x8<S>, levels: usize) -> f32x8<S> {
    let simd = texels_squared.token();
    // What is not finite takes the last level.
    let (least, most) = (f32x8::splat(simd, 1.0), f32x8::splat(simd, f32::MAX));
    let bounded = texels_squared.simd_lt(most).select(max(texels_squared, least), most);
    min(approx::log2(bounded) * 0.5, f32x8::splat(simd, last(levels)))
}

#[expect(clippy::cast_precision_loss, reason = "at most 15 levels")]
fn last(levels: usize) -> f32 {
    (levels - 1) as f32
}

/// Between the two levels around a level of detail that [`level_of_detail`] gave.
#[inline(always)]
pub fn trilinear(level: f32, sample: impl Fn(usize) -> Radiance) -> Radiance {
    let part = level - level.floor();
    let near = sample(whole(level));
    if part == 0.0 { near } else { mix(near, sample(whole(level) + 1), part) }
}

/// `a` at 0, `b` at 1.
#[inline(always)]
pub fn mix(a: Radiance, b: Radiance, t: f32) -> Radiance {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t]
}

/// The whole part of a number that is not negative.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places within a picture")]
pub fn whole(x: f32) -> usize {
    x as usize
}
