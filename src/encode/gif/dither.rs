//! From pixels to indices, with an ordered pattern where colours are too few.
//!
//! The pattern stands still while the picture moves: unlike diffused errors it does not crawl, and what
//! does not change keeps its bytes. Source: B. E. Bayer, "An optimum method for two-level rendition of
//! continuous-tone pictures", 1973.

use super::palette::Palette;

const SIDE: usize = 8;

/// Offsets beyond are visible as a pattern by themselves.
const MAX_SPACING: f64 = 32.0;

/// Indices of a frame of `width` pixels a row.
pub(super) fn indices(palette: &Palette, pixels: &[[u8; 4]], width: usize) -> Vec<u8> {
    let offsets = offsets(palette.spacing());
    let rows = pixels.chunks(width).zip(offsets.iter().cycle());
    rows.flat_map(|(row, offsets)| {
        row.iter().zip(offsets.iter().cycle()).map(|(&pixel, &offset)| palette.index(pixel, offset))
    })
    .collect()
}

/// Codes to add at each place of the pattern: from −½ to ½ of the distance between colours.
#[expect(clippy::cast_possible_truncation, reason = "at most ±16")]
fn offsets(spacing: f64) -> [[i8; SIDE]; SIDE] {
    let spacing = if spacing < MAX_SPACING { spacing } else { MAX_SPACING };
    let mut offsets = [[0; SIDE]; SIDE];
    for (y, row) in offsets.iter_mut().enumerate() {
        for (x, offset) in row.iter_mut().enumerate() {
            let share = (f64::from(threshold(x, y)) + 0.5) / 64.0 - 0.5;
            *offset = (share * spacing + 0.5).floor() as i8;
        }
    }
    offsets
}

/// 0–63: the bits of x ⊕ y and y, interleaved from the last.
fn threshold(x: usize, y: usize) -> u8 {
    let bit = |n: usize, at: usize| u8::from(n >> at & 1 == 1);
    (0..3).fold(0, |sum, at| sum << 2 | bit(x ^ y, at) << 1 | bit(y, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_has_every_threshold_once() {
        let mut all: Vec<u8> = (0..64).map(|i| threshold(i % 8, i / 8)).collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..64));
        // The corner of Bayer's matrix.
        assert_eq!([threshold(0, 0), threshold(1, 0), threshold(0, 1), threshold(1, 1)], [0, 32, 48, 16]);
    }

    #[test]
    fn offsets_are_even_about_zero() {
        let sum = |spacing| offsets(spacing).as_flattened().iter().map(|&o| i32::from(o)).sum::<i32>();
        assert_eq!(sum(0.0), 0);
        assert!(sum(16.0).abs() <= 32, "{}", sum(16.0));
        let large = offsets(1e9);
        assert!(large.as_flattened().iter().all(|offset| (-16..=16).contains(offset)));
    }
}
