//! How a pass goes over a plane: bands of rows on all threads, strips of 32 columns in registers.

use super::frame::Plane;
use crate::math::simd::*;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::PostChain;

/// Rows of one task.
pub const BAND: usize = 16;

/// Columns that a kernel holds in registers.
pub const STRIP: usize = PostChain::STRIP;

/// [`STRIP`] samples of one row.
pub type Strip<S> = [f32x8<S>; STRIP / LANES];

/// Buffers of one worker, kept between rows.
#[derive(Default)]
pub struct Scratch {
    /// A strip and its neighbours.
    pub window: Vec<f32>,
    /// A row.
    pub row: Vec<f32>,
}

/// What writes one plane out of others.
pub trait RowPass: Sync {
    /// Writes the row `y`, or changes it. To be inlined, with all it calls on vectors.
    fn row<S: Simd>(&self, simd: S, y: usize, out: &mut [f32], scratch: &mut Scratch);
}

/// Runs a pass over every row of `out`.
pub fn over_rows<P: RowPass>(pass: &P, out: &mut Plane, work: &Work) -> Result<(), Cancelled> {
    let stride = out.stride();
    work.map(out.bands().collect(), Scratch::default, |scratch, (top, rows): (usize, &mut [f32])| {
        dispatch!(work.level, simd => {
            for (y, row) in (top..).zip(rows.chunks_exact_mut(stride)) {
                pass.row(simd, y, row, scratch);
            }
        });
    })?;
    Ok(())
}

/// The strip of `row` from `x` with `reach` samples more on either side. Only `width` samples of a row
/// are pixels; beyond its ends they repeat.
pub fn window<'a>(
    row: &'a [f32],
    width: usize,
    x: usize,
    reach: usize,
    buffer: &'a mut Vec<f32>,
) -> &'a [f32] {
    if x >= reach && x + STRIP + reach <= width {
        return &row[x - reach..x + STRIP + reach];
    }
    buffer.clear();
    buffer.extend((x..x + STRIP + 2 * reach).map(|x| row[x.saturating_sub(reach).min(width - 1)]));
    buffer
}

/// The first [`STRIP`] samples of `from`.
#[inline(always)]
pub fn load<S: Simd>(simd: S, from: &[f32]) -> Strip<S> {
    let from = &from[..STRIP];
    let eight = always(
        #[inline(always)]
        |at: usize| f32x8::from_slice(simd, &from[at..at + LANES]),
    );
    [eight(0), eight(LANES), eight(2 * LANES), eight(3 * LANES)]
}

/// Writes the first [`STRIP`] samples of `to`.
#[inline(always)]
pub fn store<S: Simd>(strip: Strip<S>, to: &mut [f32]) {
    for (eight, to) in strip.into_iter().zip(to[..STRIP].chunks_exact_mut(LANES)) {
        eight.store_slice(to);
    }
}

/// `sum + weight · strip`, sample by sample.
#[inline(always)]
pub fn add_scaled<S: Simd>(sum: &mut Strip<S>, strip: Strip<S>, weight: f32) {
    for (sum, sample) in sum.iter_mut().zip(strip) {
        *sum += sample * weight;
    }
}
