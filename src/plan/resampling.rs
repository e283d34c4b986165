//! From the pixels that are drawn to those of the picture: weights along each axis.

use crate::math::round_to_f32;
use std::ops::Range;

/// What each pixel of a picture takes from those that are drawn.
///
/// Separable. A picture with more pixels than are drawn is interpolated between their centres, one with fewer
/// takes the mean of what each of its pixels covers.
#[derive(Clone, Debug, PartialEq)]
pub struct Resampling {
    /// Of each column.
    pub columns: Vec<AxisTaps>,
    /// Of each row.
    pub rows: Vec<AxisTaps>,
}

/// The drawn pixels that a pixel takes along one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisTaps {
    /// The first of them.
    pub first: usize,
    /// Of it and those behind it; their sum is 1.
    pub weights: Vec<f32>,
}

impl AxisTaps {
    /// Them.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.weights.len()
    }
}

impl Resampling {
    /// From `drawn` to `size`, both width and height.
    #[must_use]
    pub fn new(drawn: [u32; 2], size: [u32; 2]) -> Self {
        Self { columns: axis(drawn[0], size[0]), rows: axis(drawn[1], size[1]) }
    }

    /// Working memory that it takes: the drawn picture, that of its rows resampled, and the result, each four
    /// channels of f32.
    #[must_use]
    pub fn frame_bytes(drawn: [u32; 2], size: [u32; 2]) -> u64 {
        let bytes = |width: u32, height: u32| u64::from(width) * u64::from(height) * 16;
        bytes(drawn[0], drawn[1]) + bytes(size[0], drawn[1]) + bytes(size[0], size[1])
    }
}

fn axis(drawn: u32, size: u32) -> Vec<AxisTaps> {
    let step = f64::from(drawn) / f64::from(size);
    let taps = |at| if step <= 1.0 { interpolated(at, step, drawn) } else { covered(at, step, drawn) };
    (0..size).map(taps).collect()
}

/// The two drawn pixels about the centre of the pixel `at`; the border goes on.
fn interpolated(at: u32, step: f64, drawn: u32) -> AxisTaps {
    let centre = ((f64::from(at) + 0.5) * step - 0.5).clamp(0.0, f64::from(drawn - 1));
    let first = whole(centre).min(drawn.saturating_sub(2) as usize);
    let share = round_to_f32(centre - index(first));
    let weights = if drawn == 1 { vec![1.0] } else { vec![1.0 - share, share] };
    AxisTaps { first, weights }
}

/// The drawn pixels that the pixel `at` covers, each by its part.
fn covered(at: u32, step: f64, drawn: u32) -> AxisTaps {
    let (from, to) = (f64::from(at) * step, (f64::from(at) + 1.0) * step);
    let first = whole(from);
    let last = whole(to.ceil()).clamp(first + 1, drawn as usize);
    let part = |i: usize| (to.min(index(i + 1)) - from.max(index(i))).max(0.0) / step;
    AxisTaps { first, weights: (first..last).map(|i| round_to_f32(part(i))).collect() }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a picture")]
fn whole(place: f64) -> usize {
    place as usize
}

#[expect(clippy::cast_precision_loss, reason = "a place in a picture")]
fn index(place: usize) -> f64 {
    place as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_add_up_to_one_and_stay_within_the_picture() {
        for (drawn, size) in [(1, 7), (2, 3), (3, 2), (7, 1), (100, 33), (33, 100), (5, 5), (640, 160)] {
            for taps in axis(drawn, size) {
                let sum: f64 = taps.weights.iter().map(|&weight| f64::from(weight)).sum();
                assert!((sum - 1.0).abs() < 1e-6, "{drawn} to {size}: {taps:?}");
                assert!(taps.range().end <= drawn as usize && taps.weights.iter().all(|w| *w >= 0.0));
            }
        }
    }

    #[test]
    fn four_drawn_pixels_are_one() {
        let expected = AxisTaps { first: 4, weights: vec![0.25; 4] };
        assert_eq!(axis(16, 4)[1], expected);
    }

    #[test]
    fn a_ramp_stays_a_ramp_within_the_border() {
        let ramp: Vec<f32> = (0..8u8).map(f32::from).collect();
        let taps = axis(8, 16);
        let value = |taps: &AxisTaps| -> f32 {
            taps.weights.iter().zip(&ramp[taps.range()]).map(|(weight, value)| weight * value).sum()
        };
        for (at, taps) in (0..16u8).zip(&taps).skip(1).take(14) {
            assert_eq!(value(taps), (f32::from(at) + 0.5) / 2.0 - 0.5);
        }
    }
}
