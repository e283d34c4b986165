//! Where the samples of a pixel lie.

/// Sample positions from the pixel's upper left corner in sub-pixels (1/256 px), x right, y down.
///
/// The standard patterns (Direct3D 11, `D3D11_STANDARD_MULTISAMPLE_PATTERN`; the same as Vulkan's
/// `standardSampleLocations`), given there in 1/16 px from the centre. All lie on the snap grid, so
/// coverage stays exact.
#[must_use]
pub fn pattern(samples: u32) -> &'static [[i32; 2]] {
    match samples {
        2 => &PATTERN_2,
        4 => &PATTERN_4,
        8 => &PATTERN_8,
        16 => &PATTERN_16,
        _ => &PATTERN_1,
    }
}

const PATTERN_1: [[i32; 2]; 1] = from_sixteenths([[0, 0]]);
const PATTERN_2: [[i32; 2]; 2] = from_sixteenths([[4, 4], [-4, -4]]);
const PATTERN_4: [[i32; 2]; 4] = from_sixteenths([[-2, -6], [6, -2], [-6, 2], [2, 6]]);
const PATTERN_8: [[i32; 2]; 8] =
    from_sixteenths([[1, -3], [-1, 3], [5, 1], [-3, -5], [-5, 5], [-7, -1], [3, 7], [7, -7]]);
const PATTERN_16: [[i32; 2]; 16] = from_sixteenths([
    [1, 1],
    [-1, -3],
    [-3, 2],
    [4, -1],
    [-5, -2],
    [2, 5],
    [5, 3],
    [3, -5],
    [-2, 6],
    [0, -7],
    [-4, -6],
    [-6, 4],
    [-8, 0],
    [7, -4],
    [6, 7],
    [-7, -8],
]);

const fn from_sixteenths<const N: usize>(offsets: [[i32; 2]; N]) -> [[i32; 2]; N] {
    let mut out = offsets;
    let mut i = 0;
    while i < N {
        out[i] = [128 + offsets[i][0] * 16, 128 + offsets[i][1] * 16];
        i += 1;
    }
    out
}

/// For each sample, its index in order of distance from the pixel's centre (lowest index first among
/// equals): the order in which a shading point is looked for where the centre is not covered.
#[must_use]
pub fn nearest_to_centre(samples: u32) -> Vec<usize> {
    let pattern = pattern(samples);
    let mut order: Vec<usize> = (0..pattern.len()).collect();
    order.sort_by_key(|&i| {
        let [x, y] = pattern[i].map(|c| c - 128);
        (x * x + y * y, i)
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_has_its_number_of_distinct_samples_inside_the_pixel() {
        for n in [1, 2, 4, 8, 16] {
            let mut all = pattern(n).to_vec();
            assert!(all.iter().flatten().all(|c| (0..256).contains(c)));
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), n as usize);
        }
    }

    #[test]
    fn no_two_samples_share_a_row_or_column_so_axis_aligned_edges_see_all_levels() {
        for n in [2, 4, 8, 16] {
            for axis in [0, 1] {
                let mut c: Vec<i32> = pattern(n).iter().map(|s| s[axis]).collect();
                c.sort_unstable();
                c.dedup();
                assert_eq!(c.len(), n as usize);
            }
        }
    }

    #[test]
    fn centroids_are_those_of_the_published_patterns() {
        for (n, sum) in [(2, [0, 0]), (4, [0, 0]), (8, [0, 0]), (16, [-8, -8])] {
            for axis in [0, 1] {
                let total: i32 = pattern(n).iter().map(|s| s[axis] - 128).sum();
                assert_eq!(total, sum[axis] * 16, "{n} samples");
            }
        }
    }
}
