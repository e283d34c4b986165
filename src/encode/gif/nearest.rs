//! The colour nearest to every cell.

use super::boxes::{CELLS, centre_of};
use crate::math::simd::*;
use crate::pipeline::{Cancelled, Work};

/// Colours with room for the index in the low byte of a distance.
const ENTRIES: usize = 256;

/// A code so far away that it is never nearest, and whose square still fits.
const FAR: i32 = 1500;

/// Cells of one piece of work: a plane of equal red.
const PLANE: usize = CELLS / 32;

/// For every cell the index of the colour nearest to its centre; of equally near ones the first.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn nearest(colors: &[[u8; 3]], work: &Work) -> Result<Vec<u8>, Cancelled> {
    let mut channels = [[FAR; ENTRIES]; 3];
    for (at, color) in colors.iter().enumerate() {
        (0..3).for_each(|c| channels[c][at] = i32::from(color[c]));
    }
    let planes = (0..CELLS).step_by(PLANE).collect();
    let planes = work.map(
        planes,
        || (),
        |(), first| {
            let mut indices = vec![0; PLANE];
            dispatch!(work.level, simd => nearest_kernel(simd, &channels, first, &mut indices));
            indices
        },
    )?;
    Ok(planes.concat())
}

#[inline(always)]
fn nearest_kernel<S: Simd>(simd: S, channels: &[[i32; ENTRIES]; 3], first: usize, indices: &mut [u8]) {
    for (cell, index) in (first..).zip(indices) {
        let [r, g, b] = centre_of(cell);
        let mut least = i32x8::splat(simd, i32::MAX);
        let mut entry = ramp_i32(simd);
        for at in (0..ENTRIES).step_by(LANES) {
            let difference = always(
                #[inline(always)]
                |c: usize, code: i32| i32x8::from_slice(simd, &channels[c][at..at + LANES]) - code,
            );
            let [dr, dg, db] = [difference(0, r), difference(1, g), difference(2, b)];
            // At most 3 · 1500² · 2⁸ < 2³¹.
            let distance = dr * dr + dg * dg + db * db;
            least = least.min((distance << 8) | entry);
            entry += i32::try_from(LANES).expect("eight");
        }
        let least = least.to_array().into_iter().fold(i32::MAX, i32::min);
        *index = least.to_le_bytes()[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::Order;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn every_cell_has_the_nearest_colour() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let work =
            Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
        let colors: Vec<[u8; 3]> =
            (0..=254u8).map(|i| [i, i.wrapping_mul(37), i.wrapping_mul(101)]).collect();
        let indices = nearest(&colors, &work).unwrap();
        for cell in (0..CELLS).step_by(11) {
            let centre = centre_of(cell);
            let distance = |index: usize| -> i32 {
                (0..3).map(|c| centre[c] - i32::from(colors[index][c])).map(|d| d * d).sum()
            };
            let expected = (0..colors.len()).min_by_key(|index| distance(*index)).unwrap();
            assert_eq!(usize::from(indices[cell]), expected, "{cell}");
        }
    }
}
