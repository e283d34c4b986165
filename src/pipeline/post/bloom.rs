//! Bloom: the light of what is brighter than a threshold, blurred, times an intensity, added.
//!
//! How bright a pixel is, its luminance Y says. It glows with `max(Y − threshold, 0) / Y` of its
//! colour: with its own hue, and nothing at the threshold itself, so that no edge shows there.

use super::frame::{LinearFrame, Plane};
use super::gaussian::{blur_down, blur_row};
use super::passes::{RowPass, STRIP, Scratch, load, over_rows};
use super::{Effect, finite, luminance};
use crate::math::simd::*;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Bloom, Gaussian};

/// Adds the glow.
impl Effect for Bloom {
    fn spare_planes(&self) -> usize {
        Self::SPARE_PLANES
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let (width, height) = (frame.width, frame.height);
        let Self { threshold, intensity, ref gaussian } = *self;
        let LinearFrame { planes, spare, .. } = frame;
        let [share, across] = spare.get_disjoint_mut([0, 1]).expect("invariant: bloom has two spare planes");
        over_rows(&Share { planes, threshold }, share, work)?;
        for plane in planes.iter_mut().take(3) {
            let Some(gaussian) = gaussian else {
                over_rows(&Brighten { share, intensity }, plane, work)?;
                continue;
            };
            over_rows(&Across { from: plane, share, width, gaussian }, across, work)?;
            over_rows(&AddDown { from: across, height, gaussian, intensity }, plane, work)?;
        }
        Ok(())
    }
}

/// Which share of its colour a pixel glows with.
struct Share<'a> {
    planes: &'a [Plane],
    threshold: f32,
}

impl RowPass for Share<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], _: &mut Scratch) {
        let [r, g, b] = [self.planes[0].row(y), self.planes[1].row(y), self.planes[2].row(y)];
        let threshold = f32x8::splat(simd, self.threshold);
        for (x, out) in (0..).step_by(LANES).zip(out.chunks_exact_mut(LANES)) {
            let eight = always(
                #[inline(always)]
                |from: &[f32]| f32x8::from_slice(simd, &from[x..x + LANES]),
            );
            let bright = luminance(Vec3x8 { x: eight(r), y: eight(g), z: eight(b) });
            let share = (bright - threshold) / bright;
            bright.simd_gt(threshold).select(share, f32x8::splat(simd, 0.0)).store_slice(out);
        }
    }
}

/// The glow, blurred along the rows.
struct Across<'a> {
    from: &'a Plane,
    share: &'a Plane,
    width: usize,
    gaussian: &'a Gaussian,
}

impl RowPass for Across<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], scratch: &mut Scratch) {
        let Scratch { window, row } = scratch;
        row.resize(out.len(), 0.0);
        let sources = self.from.row(y).chunks_exact(LANES).zip(self.share.row(y).chunks_exact(LANES));
        for (glow, (color, share)) in row.chunks_exact_mut(LANES).zip(sources) {
            (f32x8::from_slice(simd, color) * f32x8::from_slice(simd, share)).store_slice(glow);
        }
        blur_row(simd, row, self.width, self.gaussian, window, out);
    }
}

/// The glow, blurred along the columns, times the intensity, added.
struct AddDown<'a> {
    from: &'a Plane,
    height: usize,
    gaussian: &'a Gaussian,
    intensity: f32,
}

impl RowPass for AddDown<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], _: &mut Scratch) {
        for x in (0..out.len()).step_by(STRIP) {
            let glow = blur_down(simd, self.from, self.height, self.gaussian, [x, y]);
            let color = load(simd, &out[x..]);
            for (i, to) in out[x..x + STRIP].chunks_exact_mut(LANES).enumerate() {
                finite(color[i] + glow[i] * self.intensity).store_slice(to);
            }
        }
    }
}

/// The glow, not blurred, times the intensity, added.
struct Brighten<'a> {
    share: &'a Plane,
    intensity: f32,
}

impl RowPass for Brighten<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], _: &mut Scratch) {
        for (color, share) in out.chunks_exact_mut(LANES).zip(self.share.row(y).chunks_exact(LANES)) {
            let glow = f32x8::from_slice(simd, color) * f32x8::from_slice(simd, share);
            finite(f32x8::from_slice(simd, color) + glow * self.intensity).store_slice(color);
        }
    }
}
