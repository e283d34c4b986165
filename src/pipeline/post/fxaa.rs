//! FXAA: fast approximate anti-aliasing.
//!
//! Source: T. Lottes, "FXAA", NVIDIA, 2009, in the form of FXAA 3.11 quality (2011). Where brightness
//! jumps, the direction of the edge and its two ends along the row or column are found; how far the
//! pixel lies from the nearer end tells how much of its neighbour across the edge it should show.
//!
//! Brightness is `√Y` of the colour clamped to 0–1: about as the eye and sRGB have it. What is mixed is
//! linear colour. Edges are followed pixel by pixel, not in growing steps, so that their ends are exact.
//! Alpha stays; before a transparent background a neighbour counts by its alpha, so that no edge takes
//! on black from where nothing is.

mod edge;

use super::frame::{LinearFrame, Plane};
use super::passes::{RowPass, STRIP, Scratch, Strip, load, over_rows, window};
use super::{Effect, luminance};
use crate::math::simd::*;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::Fxaa;
use edge::{EDGE_MIN, EDGE_SHARE, Luma, Mix};

/// Smooths the edges of a picture.
impl Effect for Fxaa {
    fn spare_planes(&self) -> usize {
        Self::SPARE_PLANES
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let (width, height) = (frame.width, frame.height);
        let LinearFrame { planes, spare, .. } = frame;
        let [luma, mixes] = spare.get_disjoint_mut([0, 1]).expect("invariant: FXAA has two spare planes");
        over_rows(&Brightness { planes }, luma, work)?;
        over_rows(&FindEdges { luma, width, height }, mixes, work)?;
        // From here on `luma` takes the channels' results, one after the other.
        let (colors, alpha) = planes.split_at_mut(3);
        for plane in colors {
            over_rows(&Blend { from: plane, alpha: alpha.first(), mixes, width, height }, luma, work)?;
            std::mem::swap(plane, luma);
        }
        Ok(())
    }
}

/// √Y of the colours clamped to 0–1.
struct Brightness<'a> {
    planes: &'a [Plane],
}

impl RowPass for Brightness<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], _: &mut Scratch) {
        let [r, g, b] = [self.planes[0].row(y), self.planes[1].row(y), self.planes[2].row(y)];
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        for (x, out) in (0..).step_by(LANES).zip(out.chunks_exact_mut(LANES)) {
            let eight = always(
                #[inline(always)]
                |from: &[f32]| min(max(f32x8::from_slice(simd, &from[x..x + LANES]), zero), one),
            );
            luminance(Vec3x8 { x: eight(r), y: eight(g), z: eight(b) }).sqrt().store_slice(out);
        }
    }
}

/// What each pixel shows of a neighbour, as [`Mix::code`] writes it.
struct FindEdges<'a> {
    luma: &'a Plane,
    width: usize,
    height: usize,
}

impl RowPass for FindEdges<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], scratch: &mut Scratch) {
        let (above, below) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
        let luma = Luma { plane: self.luma, width: self.width, height: self.height };
        for (x, out) in (0..).step_by(STRIP).zip(out.chunks_exact_mut(STRIP)) {
            out.fill(0.0);
            let row = window(self.luma.row(y), self.width, x, 1, &mut scratch.window);
            let centre: Strip<S> = load(simd, &row[1..]);
            let (west, east): (Strip<S>, Strip<S>) = (load(simd, row), load(simd, &row[2..]));
            let north: Strip<S> = load(simd, &self.luma.row(above)[x..]);
            let south: Strip<S> = load(simd, &self.luma.row(below)[x..]);
            for i in 0..centre.len() {
                let most = max(max(max(north[i], south[i]), max(west[i], east[i])), centre[i]);
                let least = min(min(min(north[i], south[i]), min(west[i], east[i])), centre[i]);
                let needed = max(most * EDGE_SHARE, f32x8::splat(simd, EDGE_MIN));
                for lane in set_bits((most - least).simd_ge(needed).to_bitmask()) {
                    let at = i * LANES + lane;
                    if x + at < self.width {
                        out[at] = edge::mix(&luma, x + at, y).code();
                    }
                }
            }
        }
    }
}

/// One channel with what its pixels show of their neighbours.
struct Blend<'a> {
    from: &'a Plane,
    alpha: Option<&'a Plane>,
    mixes: &'a Plane,
    width: usize,
    height: usize,
}

impl RowPass for Blend<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], _: &mut Scratch) {
        out.copy_from_slice(self.from.row(y));
        for (x, codes) in (0..).step_by(LANES).zip(self.mixes.row(y).chunks_exact(LANES)) {
            let none = f32x8::splat(simd, 0.0);
            for lane in set_bits(f32x8::from_slice(simd, codes).simd_gt(none).to_bitmask()) {
                out[x + lane] = self.blended(Mix::from_code(codes[lane]), x + lane, y);
            }
        }
    }
}

impl Blend<'_> {
    /// The pixel (x, y) with its share of a neighbour.
    fn blended(&self, mix: Mix, x: usize, y: usize) -> f32 {
        let [nx, ny] = mix.neighbour(x, y, self.width, self.height);
        let blend = |plane: &Plane| mix.blend(plane.row(y)[x], plane.row(ny)[nx]);
        match self.alpha {
            None => blend(self.from),
            // Both with their alpha, and the sum made to fit the pixel's own.
            Some(alpha) if blend(alpha) > 0.0 => blend(self.from) / blend(alpha) * alpha.row(y)[x],
            Some(_) => 0.0,
        }
    }
}
