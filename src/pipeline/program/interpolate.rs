//! Interpolation of a program's varyings.

use super::records::Records;
use crate::math::simd::*;
use crate::pipeline::shade::table::{Lanes, Weights};
use crate::pipeline::shade::{BLOCK, Fragment};

/// Interpolates every varying for up to [`BLOCK`] fragments, and the screen derivatives of those that
/// have them. Lanes beyond hold copies of the last fragment.
pub(super) fn interpolate(
    level: Level,
    records: &Records,
    fragments: &[Fragment],
    values: &mut [[f32; BLOCK]],
    derivatives: &mut [[[f32; BLOCK]; 2]],
) {
    dispatch!(level, simd => records.table.for_each_eight(simd, fragments, always(
        #[inline(always)]
        |lanes: &Lanes, weights: &Weights<_>, at: usize| {
            interpolate_eight(simd, records, lanes, weights, values, derivatives, at);
        },
    )));
}

#[inline(always)]
fn interpolate_eight<S: Simd>(
    simd: S,
    records: &Records,
    lanes: &Lanes,
    weights: &Weights<S>,
    values: &mut [[f32; BLOCK]],
    derivatives: &mut [[[f32; BLOCK]; 2]],
    at: usize,
) {
    let count = records.varyings;
    for (i, value) in values.iter_mut().enumerate() {
        lanes.mix(simd, weights, i, count).store_slice(&mut value[at..at + LANES]);
    }
    for (i, of_value) in derivatives.iter_mut().enumerate() {
        let along = lanes.derivatives(simd, weights, 3 * (count + i));
        for (along, to) in along.into_iter().zip(of_value) {
            along.store_slice(&mut to[at..at + LANES]);
        }
    }
}
