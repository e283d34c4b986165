//! A free kernel: the correlation with a square of weights.

use super::frame::{LinearFrame, Plane};
use super::passes::{RowPass, STRIP, Scratch, Strip, add_scaled, load, over_rows, window};
use super::{Effect, finite};
use crate::math::simd::*;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::Kernel;

/// Replaces every colour by the weighted sum of those around it.
impl Effect for Kernel {
    fn spare_planes(&self) -> usize {
        Self::SPARE_PLANES
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let (width, height) = (frame.width, frame.height);
        let spare = &mut frame.spare[0];
        for plane in frame.planes.iter_mut().take(3) {
            over_rows(&Correlate { from: plane, width, height, kernel: self }, spare, work)?;
            std::mem::swap(plane, spare);
        }
        Ok(())
    }
}

struct Correlate<'a> {
    from: &'a Plane,
    width: usize,
    height: usize,
    kernel: &'a Kernel,
}

impl RowPass for Correlate<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], scratch: &mut Scratch) {
        let reach = self.kernel.reach;
        for (x, out) in (0..).step_by(STRIP).zip(out.chunks_exact_mut(STRIP)) {
            let mut sum: Strip<S> = [f32x8::splat(simd, 0.0); STRIP / LANES];
            for row in &self.kernel.rows {
                let source = self.from.row((y + row.row).saturating_sub(reach).min(self.height - 1));
                let samples = window(source, self.width, x, reach, &mut scratch.window);
                for &(column, weight) in &row.weights {
                    add_scaled(&mut sum, load(simd, &samples[column..]), weight);
                }
            }
            for (eight, to) in sum.into_iter().zip(out.chunks_exact_mut(LANES)) {
                finite(eight).store_slice(to);
            }
        }
    }
}
