//! Resolve: the samples of a shared pixel to its colour.

use super::tiles::fragments::{Fragments, SharedPixel};

/// Fills the places of all pixels that more than one surface share, or none covers: with the mean of
/// their samples. Uncovered samples show `sky`.
pub fn resolve(
    fragments: &Fragments,
    sky: &[Vec<f32>; 3],
    samples: u32,
    side: usize,
    colors: &mut [Vec<f32>; 3],
) {
    let own = side * side;
    for (channel, sky) in colors.iter_mut().zip(sky) {
        for &pixel in &fragments.sky {
            channel[pixel as usize] = sky[pixel as usize];
        }
    }
    for shared in &fragments.shared {
        for (channel, sky) in colors.iter_mut().zip(sky) {
            let pixel = shared.pixel as usize;
            let mut values = values(fragments, shared, &channel[own..], sky[pixel]);
            channel[pixel] = mean(&mut values[..samples as usize]);
        }
    }
}

/// One channel of every sample of a shared pixel: that of its fragment in `channel`, or `uncovered`.
pub fn values(fragments: &Fragments, shared: &SharedPixel, channel: &[f32], uncovered: f32) -> [f32; 16] {
    let mut values = [uncovered; 16];
    let range = shared.first as usize..(shared.first + shared.count) as usize;
    for (mask, color) in fragments.masks[range.clone()].iter().zip(&channel[range]) {
        for (s, value) in values.iter_mut().enumerate() {
            if mask >> s & 1 == 1 {
                *value = *color;
            }
        }
    }
    values
}

/// Share of each pixel's samples that a surface covers.
pub fn coverage(fragments: &Fragments, samples: u32, side: usize) -> Vec<f32> {
    let mut coverage = vec![1.0; side * side];
    for &pixel in &fragments.sky {
        coverage[pixel as usize] = 0.0;
    }
    for shared in &fragments.shared {
        let masks = &fragments.masks[shared.first as usize..(shared.first + shared.count) as usize];
        let covered: u32 = masks.iter().map(|mask| mask.count_ones()).sum();
        coverage[shared.pixel as usize] = small(covered) / small(samples);
    }
    coverage
}

#[expect(clippy::cast_precision_loss, reason = "at most 16")]
fn small(n: u32) -> f32 {
    n as f32
}

/// Plain mean of 2ᵐ values, summed as a pairwise tree: exact if all are equal, so that a pixel with one
/// surface can go without.
pub fn mean(values: &mut [f32]) -> f32 {
    let mut count = values.len();
    let mut share = 1.0;
    while count > 1 {
        count /= 2;
        share *= 0.5;
        for i in 0..count {
            values[i] = values[2 * i] + values[2 * i + 1];
        }
    }
    values[0] * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_equal_samples_is_that_sample() {
        for count in [1, 2, 4, 8, 16] {
            for value in [0.1f32, 0.3, 65504.0, 1e-30] {
                assert_eq!(mean(&mut [value; 16][..count]), value);
            }
        }
    }
}
