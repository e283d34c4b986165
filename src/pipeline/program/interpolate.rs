//! Interpolation of a program's varyings.

use super::records::{AREA, DOUBLES, EDGES, ORIGIN, Records, SCALE};
use crate::math::simd::*;
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
    dispatch!(level, simd => {
        for (group, at) in fragments.chunks(LANES).zip((0..).step_by(LANES)) {
            interpolate_eight(simd, records, group, values, derivatives, at);
        }
    });
}

#[inline(always)]
fn interpolate_eight<S: Simd>(
    simd: S,
    records: &Records,
    group: &[Fragment],
    values: &mut [[f32; BLOCK]],
    derivatives: &mut [[[f32; BLOCK]; 2]],
    at: usize,
) {
    let lane = always(
        #[inline(always)]
        |i: usize| &group[i.min(group.len() - 1)],
    );
    let double = always(
        #[inline(always)]
        |field: usize| {
            f64x8::from_fn(
                simd,
                #[inline(always)]
                |i| records.doubles[lane(i).record as usize * DOUBLES + field],
            )
        },
    );
    let stride = records.singles_a_record();
    let single = always(
        #[inline(always)]
        |field: usize| {
            f32x8::from_fn(
                simd,
                #[inline(always)]
                |i| records.singles[lane(i).record as usize * stride + field],
            )
        },
    );
    let screen = always(
        #[inline(always)]
        |of: fn(&Fragment) -> i32| {
            f64x8::from_fn(
                simd,
                #[inline(always)]
                |i| f64::from(of(lane(i))),
            )
        },
    );
    // Edge functions relative to corner 0: whole numbers below 2⁵⁰, exact.
    let (dx, dy) = (screen(|f| f.x) - double(ORIGIN), screen(|f| f.y) - double(ORIGIN + 1));
    let edge = always(
        #[inline(always)]
        |i: usize| dx * double(EDGES + 2 * i) + dy * double(EDGES + 2 * i + 1),
    );
    let (e1, e2) = (edge(0), edge(1));
    let e0 = double(AREA) - e1 - e2;
    let l = [e0 * double(SCALE), e1 * double(SCALE + 1), e2 * double(SCALE + 2)];
    let sum = (l[0] + l[1]) + l[2];
    let share = f64x8::splat(simd, 1.0) / sum;
    let weights = [narrow(l[0] * share), narrow(l[1] * share), narrow(l[2] * share)];

    let count = records.varyings;
    for (i, value) in values.iter_mut().enumerate() {
        let corner = always(
            #[inline(always)]
            |c: usize| weights[c] * single(c * count + i),
        );
        ((corner(0) + corner(1)) + corner(2)).store_slice(&mut value[at..at + LANES]);
    }
    let depth = narrow(sum);
    let squared = depth * depth;
    let (fx, fy) = (narrow(dx), narrow(dy));
    for (i, [along_x, along_y]) in derivatives.iter_mut().enumerate() {
        let field = 3 * (count + i);
        let cross = single(field + 2);
        ((single(field) + cross * fy) / squared).store_slice(&mut along_x[at..at + LANES]);
        ((single(field + 1) - cross * fx) / squared).store_slice(&mut along_y[at..at + LANES]);
    }
}
