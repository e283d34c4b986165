//! Lines of sight through the centres of pixels.

use crate::math::simd::*;
use crate::math::view::SUBPIXELS;
use crate::math::{Projection, View, round_to_f32};
use glam::{DVec3, Vec3};

/// The lines of sight of a view, in world axes.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// What a ray gains per sub-pixel to the right.
    right: DVec3,
    /// What it gains per sub-pixel down.
    down: DVec3,
    /// The ray through the middle of the picture, a unit vector.
    forward: DVec3,
}

impl Rays {
    /// The lines of sight of `view`; all alike if it is orthographic.
    #[must_use]
    pub fn new(view: &View) -> Self {
        let [right, down] = match view.projection {
            Projection::Perspective => [view.right / view.scale[0], -view.up / view.scale[1]],
            Projection::Orthographic => [DVec3::ZERO; 2],
        };
        Self { right, down, forward: view.forward }
    }

    /// Rays through eight screen points in sub-pixels; not of unit length, their component along the
    /// view's axis is 1.
    ///
    /// Computed in f64 and rounded once: the direction is off by at most 1 u.
    #[inline(always)]
    pub fn through<S: Simd>(&self, x: f64x8<S>, y: f64x8<S>) -> Vec3x8<S> {
        let component = always(
            #[inline(always)]
            |c: usize| narrow(x * self.right[c] + y * self.down[c] + self.forward[c]),
        );
        Vec3x8 { x: component(0), y: component(1), z: component(2) }
    }

    /// What a ray gains per pixel to the right, and per pixel down.
    #[must_use]
    pub fn per_pixel(&self) -> [Vec3; 2] {
        [self.right, self.down]
            .map(|step| Vec3::from_array((step * f64::from(SUBPIXELS)).to_array().map(round_to_f32)))
    }
}
