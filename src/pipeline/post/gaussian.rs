//! Gaussian blur: across the rows into a spare plane, then down its columns.

use super::Effect;
use super::frame::{LinearFrame, Plane};
use super::passes::{RowPass, STRIP, Scratch, Strip, load, over_rows, store, window};
use crate::math::simd::*;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::Gaussian;

/// Blurs every plane, alpha too.
impl Effect for Gaussian {
    fn spare_planes(&self) -> usize {
        Self::SPARE_PLANES
    }

    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        let (width, height) = (frame.width, frame.height);
        let spare = &mut frame.spare[0];
        for plane in &mut frame.planes {
            over_rows(&Across { from: plane, width, gaussian: self }, spare, work)?;
            over_rows(&Down { from: spare, height, gaussian: self }, plane, work)?;
        }
        Ok(())
    }
}

struct Across<'a> {
    from: &'a Plane,
    width: usize,
    gaussian: &'a Gaussian,
}

impl RowPass for Across<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], scratch: &mut Scratch) {
        blur_row(simd, self.from.row(y), self.width, self.gaussian, &mut scratch.window, out);
    }
}

struct Down<'a> {
    from: &'a Plane,
    height: usize,
    gaussian: &'a Gaussian,
}

impl RowPass for Down<'_> {
    #[inline(always)]
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], _: &mut Scratch) {
        for x in (0..out.len()).step_by(STRIP) {
            let strip = blur_down(simd, self.from, self.height, self.gaussian, [x, y]);
            store(strip, &mut out[x..]);
        }
    }
}

/// Blurs a row of which `width` samples are pixels along itself.
#[inline(always)]
pub fn blur_row<S: Simd>(
    simd: S,
    row: &[f32],
    width: usize,
    gaussian: &Gaussian,
    buffer: &mut Vec<f32>,
    out: &mut [f32],
) {
    let reach = gaussian.weights.len();
    for x in (0..out.len()).step_by(STRIP) {
        let samples = window(row, width, x, reach, buffer);
        let pair = always(
            #[inline(always)]
            |distance: usize| [&samples[reach - distance..], &samples[reach + distance..]],
        );
        store(weighted_mean(simd, gaussian, &samples[reach..], pair), &mut out[x..]);
    }
}

/// The strip at column and row `place`, blurred along the columns of a plane of `height` rows.
#[inline(always)]
pub fn blur_down<S: Simd>(
    simd: S,
    from: &Plane,
    height: usize,
    gaussian: &Gaussian,
    [x, y]: [usize; 2],
) -> Strip<S> {
    let pair = always(
        #[inline(always)]
        |distance: usize| {
            let (above, below) = (y.saturating_sub(distance), (y + distance).min(height - 1));
            [&from.row(above)[x..], &from.row(below)[x..]]
        },
    );
    weighted_mean(simd, gaussian, &from.row(y)[x..], pair)
}

/// The mean of a strip and its neighbours. `pair` gives the strips at a distance on both sides.
///
/// Written as the strip itself plus weighted differences from it, the smallest weights first: what
/// is constant stays as it is to the bit, although rounded weights do not sum to 1.
#[inline(always)]
fn weighted_mean<'a, S: Simd>(
    simd: S,
    gaussian: &Gaussian,
    centre: &[f32],
    pair: impl Fn(usize) -> [&'a [f32]; 2],
) -> Strip<S> {
    let centre: Strip<S> = load(simd, centre);
    let mut sum = [f32x8::splat(simd, 0.0); STRIP / LANES];
    for at in (0..gaussian.weights.len()).rev() {
        let [before, after] = pair(at + 1);
        let (before, after): (Strip<S>, Strip<S>) = (load(simd, before), load(simd, after));
        let weight = gaussian.weights[at];
        for i in 0..sum.len() {
            let difference = (before[i] + after[i]) - (centre[i] + centre[i]);
            sum[i] += difference * weight;
        }
    }
    [centre[0] + sum[0], centre[1] + sum[1], centre[2] + sum[2], centre[3] + sum[3]]
}
