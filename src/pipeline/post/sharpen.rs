//! Sharpening by an unsharp mask.

use super::frame::{LinearFrame, Plane};
use super::passes::{RowPass, STRIP, Scratch, Strip, load, over_rows, window};
use super::{Effect, finite};
use crate::math::simd::*;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::Sharpen;

/// Weights of the blurred picture in each direction, in quarters.
const MASK: [f32; 3] = [1.0, 2.0, 1.0];

/// Adds `amount` times the difference to the picture blurred by 3 × 3 binomial weights.
impl Effect for Sharpen {
    fn spare_planes(&self) -> usize {
        Self::SPARE_PLANES
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let (width, height) = (frame.width, frame.height);
        let spare = &mut frame.spare[0];
        for plane in frame.planes.iter_mut().take(3) {
            over_rows(&AddDetail { from: plane, width, height, amount: self.amount }, spare, work)?;
            std::mem::swap(plane, spare);
        }
        Ok(())
    }
}

struct AddDetail<'a> {
    from: &'a Plane,
    width: usize,
    height: usize,
    amount: f32,
}

impl RowPass for AddDetail<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], scratch: &mut Scratch) {
        let rows = [y.saturating_sub(1), y, (y + 1).min(self.height - 1)].map(|y| self.from.row(y));
        for (x, out) in (0..).step_by(STRIP).zip(out.chunks_exact_mut(STRIP)) {
            let centre: Strip<S> = load(simd, &rows[1][x..]);
            // What a pixel has over those around it: nothing, to the bit, where all are equal.
            let mut detail: Strip<S> = [f32x8::splat(simd, 0.0); STRIP / LANES];
            for (row, down) in rows.into_iter().zip(MASK) {
                let samples = window(row, self.width, x, 1, &mut scratch.window);
                for (column, across) in MASK.into_iter().enumerate() {
                    let around: Strip<S> = load(simd, &samples[column..]);
                    for i in 0..detail.len() {
                        detail[i] += (centre[i] - around[i]) * (across * down);
                    }
                }
            }
            for (i, to) in out.chunks_exact_mut(LANES).enumerate() {
                finite(centre[i] + detail[i] * (1.0 / 16.0) * self.amount).store_slice(to);
            }
        }
    }
}
