//! Depth over a tile: eight samples at a time, and bounds for a block of them.

use super::cover::Region;
use crate::math::round_to_f32;
use crate::math::simd::*;
use crate::pipeline::geometry::setup::Triangle;

/// Depth of one triangle over a tile.
pub(super) trait DepthFunction {
    /// Greatest and least depth that samples of the 8×8 block at (left, top) can have.
    fn range(&self, left: usize, top: usize) -> (f32, f32);
    /// Depth of one sample of eight pixels in a row.
    fn row<S: Simd>(&self, simd: S, left: usize, y: usize, offset: &[i32; 2]) -> f32x8<S>;
}

/// `base + slope_y · Δy + slope_x · Δx`, in f64, rounded once.
///
/// Every step is monotonic in Δx and in Δy, rounding included, so the corners of a block bound what
/// lies in it exactly.
pub(super) struct Plane {
    base: f64,
    slope: [f64; 2],
    /// The tile's origin from the triangle's corner 0.
    origin: [f64; 2],
}

impl Plane {
    pub(super) fn new(t: &Triangle, region: &Region) -> Self {
        let origin = [f64::from(region.origin[0] - t.x[0]), f64::from(region.origin[1] - t.y[0])];
        Self { base: t.depth.base, slope: t.depth.slope, origin }
    }

    #[inline(always)]
    fn at(&self, x: f64, y: f64) -> f64 {
        (self.base + self.slope[1] * (self.origin[1] + y)) + self.slope[0] * (self.origin[0] + x)
    }
}

impl DepthFunction for Plane {
    #[inline(always)]
    fn range(&self, left: usize, top: usize) -> (f32, f32) {
        let (x, y) = (f64::from(small(left)) * 256.0, f64::from(small(top)) * 256.0);
        let far = always(
            #[inline(always)]
            |rising: bool| if rising { 2048.0 } else { 0.0 },
        );
        let (right, down) = (self.slope[0] > 0.0, self.slope[1] > 0.0);
        (
            round_to_f32(self.at(x + far(right), y + far(down))),
            round_to_f32(self.at(x + far(!right), y + far(!down))),
        )
    }

    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, left: usize, y: usize, offset: &[i32; 2]) -> f32x8<S> {
        let y = f64::from(small(y) * 256 + offset[1]);
        let x = f64::from(small(left) * 256 + offset[0]);
        let row = self.base + self.slope[1] * (self.origin[1] + y);
        let dx = ramp_f64(simd) * 256.0 + (self.origin[0] + x);
        narrow(dx * self.slope[0] + row)
    }
}

/// `base + gain₁ · E₁ + gain₂ · E₂` with the exact edge functions of corners 1 and 2: all terms ≥ 0
/// inside the triangle, so nothing cancels however far its corners lie apart.
pub(super) struct PositiveSum {
    base: f64,
    gain: [f64; 2],
    edges: [[f64; 2]; 2],
    origin: [f64; 2],
}

impl PositiveSum {
    pub(super) fn new(t: &Triangle, region: &Region) -> Self {
        let origin = [f64::from(region.origin[0] - t.x[0]), f64::from(region.origin[1] - t.y[0])];
        Self { base: t.depth.base, gain: t.depth.slope, edges: t.edges_from_corner_0(), origin }
    }
}

impl DepthFunction for PositiveSum {
    #[inline(always)]
    fn range(&self, _: usize, _: usize) -> (f32, f32) {
        // Rare enough to go without the hierarchy.
        (f32::INFINITY, 0.0)
    }

    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, left: usize, y: usize, offset: &[i32; 2]) -> f32x8<S> {
        let y = self.origin[1] + f64::from(small(y) * 256 + offset[1]);
        let x = self.origin[0] + f64::from(small(left) * 256 + offset[0]);
        let dx = ramp_f64(simd) * 256.0 + x;
        let e = always(
            #[inline(always)]
            |i: usize| dx * self.edges[i][0] + self.edges[i][1] * y,
        );
        narrow((e(0) * self.gain[0] + e(1) * self.gain[1]) + self.base)
    }
}

/// A pixel coordinate within a tile.
#[inline(always)]
pub(super) fn small(pixel: usize) -> i32 {
    i32::try_from(pixel).expect("a tile has at most 64 pixels a side")
}
