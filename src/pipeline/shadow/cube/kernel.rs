//! Discs around receivers, as a cube sees them.

use super::super::WIDEST_CONE;
use super::super::penumbra::Verdict;
use super::receiver::{Receiver, dot};
use super::{Lens, PcfKernel, SoftKernel};
use crate::math::simd::*;
use crate::pipeline::shadow::pyramid::DepthRange;
use crate::plan::WIDEST_TANGENT;
use glam::Vec3;

/// A disc across the light's ray through a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    /// Two vectors from its centre to its rim.
    pub(super) axes: [Vec3; 2],
    radius: f32,
    /// How much the receiver's plane is taken to rise towards the light from the kernel's centre to its
    /// rim: what is flatter than that is no shadow.
    pub(super) rise: f32,
}

/// The part of a side that a kernel covers.
pub(super) enum Footprint {
    /// Possibly all of it.
    Whole,
    /// Between these tangents to the right, and these upwards.
    Part([[f32; 2]; 2]),
}

/// Where eight directions meet the cube.
pub(super) struct Spot<S: Simd> {
    /// Which side.
    pub(super) side: i32x8<S>,
    /// Tangents to the right and upwards.
    pub(super) right: f32x8<S>,
    pub(super) up: f32x8<S>,
    /// Length along the side's axis.
    pub(super) distance: f32x8<S>,
}

/// Covers what rounding adds to the bounds of a kernel's taps: a few units in the last place.
const SLACK: f32 = 1.0 + 1e-5;

impl<S: Simd> Spot<S> {
    /// On the side ± axis i, ± axis i + 2 runs to the right and axis i + 1 upwards.
    #[inline(always)]
    pub(super) fn of(simd: S, v: Vec3x8<S>) -> Self {
        let (x, y, z) = (v.x.abs(), v.y.abs(), v.z.abs());
        let on_x = x.simd_ge(y) & x.simd_ge(z);
        let on_y = !on_x & y.simd_ge(z);
        let pick = always(
            #[inline(always)]
            |x, y, z| on_x.select(x, on_y.select(y, z)),
        );
        let along = pick(v.x, v.y, v.z);
        let distance = along.abs();
        let axis = always(
            #[inline(always)]
            |side| i32x8::splat(simd, side),
        );
        let positive = on_x.select(axis(0), on_y.select(axis(2), axis(4)));
        let negative = along.simd_lt(f32x8::splat(simd, 0.0));
        Self {
            side: negative.select(positive + 1, positive),
            right: pick(v.z, v.x, v.y) / along,
            up: pick(v.y, v.z, v.x) / distance,
            distance,
        }
    }
}

impl Kernel {
    /// A disc of a radius in the receiver's unit; what is flatter than the slope `cone` is no shadow.
    ///
    /// Texels grow with the distance along their side's axis, so a tap beyond the receiver's needs more
    /// offset than the receiver: by as much as it is farther.
    #[inline(always)]
    fn new(receiver: &Receiver, radius: f32, cone: f32) -> Self {
        let [a, b] = tangents(receiver.place / receiver.length);
        Self { axes: [a * radius, b * radius], radius, rise: radius * (cone + receiver.cleared) }
    }

    /// How far its taps can lie from its centre.
    #[inline(always)]
    pub(super) fn reach(&self) -> f32 {
        self.radius * SLACK
    }

    /// What every tap of the kernel over texels of such depths must say.
    #[inline(always)]
    pub(super) fn verdict(&self, receiver: &Receiver, lens: &Lens, range: DepthRange) -> Verdict {
        let reach = self.reach();
        if range.greatest * ((receiver.distance + reach) * receiver.scale) <= lens.nearest_blocker() {
            return Verdict::Lit;
        }
        let slope = dot(receiver.plane, receiver.plane).sqrt() * reach;
        let plane = (slope + lens.nearest_blocker() + self.rise) * SLACK;
        let nearest = (receiver.distance - reach) * receiver.scale;
        if range.least * nearest > plane { Verdict::Dark } else { Verdict::Mixed }
    }

    /// The part of a side that its taps can meet; `None` if they meet none of it.
    #[inline(always)]
    pub(super) fn footprint(&self, receiver: &Receiver, side: usize) -> Option<Footprint> {
        let p = receiver.place.to_array();
        let reach = self.reach();
        let (axis, sign) = (side / 2, if side.is_multiple_of(2) { 1.0 } else { -1.0 });
        let far = p[axis] * sign + reach;
        // A tap's side is the axis along which it is longest, and none is shorter than this.
        let shortest = receiver.distance - reach;
        if far < shortest {
            return None;
        }
        let near = if far - 2.0 * reach > shortest { far - 2.0 * reach } else { shortest };
        // Not so where a number is none.
        let is_narrow = near > 1.0 / 16.0;
        if !is_narrow {
            return Some(Footprint::Whole);
        }
        let tangents = always(
            #[inline(always)]
            |c: f32| {
                let (low, high) = (c - reach, c + reach);
                let low = low / if low > 0.0 { far } else { near };
                let high = high / if high > 0.0 { near } else { far };
                // A tap beyond ±1 is on another side.
                [if low > -1.0 { low } else { -1.0 }, if high < 1.0 { high } else { 1.0 }]
            },
        );
        Some(Footprint::Part([tangents(p[(axis + 2) % 3] * sign), tangents(p[(axis + 1) % 3])]))
    }
}

impl PcfKernel {
    /// The kernel around a receiver: of the same angle in all directions.
    #[inline(always)]
    pub(super) fn around(&self, receiver: &Receiver) -> Kernel {
        let radius = limited(self.tangent * receiver.length, receiver);
        Kernel::new(receiver, radius, self.bias)
    }
}

impl SoftKernel {
    /// The disc of the light as seen from the receiver, where `ratio` is how many times as far from the
    /// light the receiver is as the blocker.
    #[inline(always)]
    pub(super) fn kernel(&self, receiver: &Receiver, ratio: f32) -> Kernel {
        let light_radius = self.light_radius / receiver.unit;
        self.sized(receiver, limited(light_radius * (ratio - 1.0), receiver), light_radius)
    }

    /// Where blockers are looked for, if that does not follow from their distance.
    #[inline(always)]
    pub(super) fn fixed_search(&self, receiver: &Receiver) -> Option<Kernel> {
        let radius = limited(self.search? * receiver.length, receiver);
        Some(self.sized(receiver, radius, self.light_radius / receiver.unit))
    }

    #[inline(always)]
    fn sized(&self, receiver: &Receiver, radius: f32, light_radius: f32) -> Kernel {
        #[expect(clippy::cast_possible_truncation, reason = "a constant that f32 holds")]
        let flattest = WIDEST_CONE as f32 / light_radius;
        let cone = if flattest < 1.0 { flattest } else { 1.0 };
        Kernel::new(receiver, radius, cone * self.bias)
    }
}

/// A radius, or the largest that a kernel may have.
#[inline(always)]
fn limited(radius: f32, receiver: &Receiver) -> f32 {
    let widest = WIDEST_TANGENT * receiver.length;
    if radius > 0.0 { if radius < widest { radius } else { widest } } else { 0.0 }
}

/// Two unit vectors across the unit vector `d`, which turn with it without a jump anywhere but straight
/// up. Source: J. R. Frisvad, "Building an Orthonormal Basis from a 3D Unit Vector Without
/// Normalization", Journal of Graphics Tools 16(3), 2012.
#[inline(always)]
fn tangents(d: Vec3) -> [Vec3; 2] {
    let across = d.x * d.x + d.z * d.z;
    // 1 / (1 − y), without cancellation close to y = 1.
    let a = if d.y < 0.0 { 1.0 / (1.0 - d.y) } else { (1.0 + d.y) / across };
    // Nearer than f32 can tell from upright 1 / across would overflow.
    let is_upright = across < 1e-30;
    if is_upright {
        return [Vec3::X, Vec3::Z];
    }
    let xz = d.x * d.z * a;
    [Vec3::new(1.0 - d.x * d.x * a, d.x, 0.0 - xz), Vec3::new(0.0 - xz, d.z, 1.0 - d.z * d.z * a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_are_unit_vectors_across() {
        let mut worst = 0.0f32;
        for i in 0u16..4000 {
            let angle = f32::from(i) * 2.399_963;
            let y = f32::from(i) / 1999.5 - 1.0;
            // Close to the poles as well.
            let y = if i % 3 == 0 { y.signum() * (1.0 - (1.0 - y.abs()) * 1e-6) } else { y };
            let radius = (1.0 - y * y).sqrt();
            let d = Vec3::new(radius * angle.cos(), y, radius * angle.sin()).normalize();
            let [a, b] = tangents(d);
            for error in [a.dot(d), b.dot(d), a.dot(b), a.length() - 1.0, b.length() - 1.0] {
                assert!(!error.is_nan(), "{d}");
                worst = worst.max(error.abs());
            }
        }
        assert!(worst < 1e-5, "{worst}");
        for almost in [Vec3::Y, Vec3::new(1e-20, 1.0, 0.0), Vec3::new(0.0, 1.0, -1e-16)] {
            assert_eq!(tangents(almost), [Vec3::X, Vec3::Z], "{almost}");
        }
    }
}
