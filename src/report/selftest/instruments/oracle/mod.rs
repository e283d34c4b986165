//! Slow and obviously right answers to what each sample sees.

pub mod coverage;
pub mod geometric;

/// Sample positions from the pixel's upper left corner in sub-pixels, written down a second time.
///
/// Source: Vulkan specification, "Standard sample locations" (given there in parts of a pixel).
pub fn sample_positions(samples: u32) -> Vec<[i32; 2]> {
    let parts: &[[f64; 2]] = match samples {
        1 => &[[0.5, 0.5]],
        2 => &[[0.75, 0.75], [0.25, 0.25]],
        4 => &[[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]],
        8 => &[
            [0.5625, 0.3125],
            [0.4375, 0.6875],
            [0.8125, 0.5625],
            [0.3125, 0.1875],
            [0.1875, 0.8125],
            [0.0625, 0.4375],
            [0.6875, 0.9375],
            [0.9375, 0.0625],
        ],
        16 => &[
            [0.5625, 0.5625],
            [0.4375, 0.3125],
            [0.3125, 0.625],
            [0.75, 0.4375],
            [0.1875, 0.375],
            [0.625, 0.8125],
            [0.8125, 0.6875],
            [0.6875, 0.1875],
            [0.375, 0.875],
            [0.5, 0.0625],
            [0.25, 0.125],
            [0.125, 0.75],
            [0.0, 0.5],
            [0.9375, 0.25],
            [0.875, 0.9375],
            [0.0625, 0.0],
        ],
        _ => panic!("no pattern of {samples} samples"),
    };
    let su = |part: f64| (part * 256.0) as i32;
    parts.iter().map(|p| p.map(su)).collect()
}
