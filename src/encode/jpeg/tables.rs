//! The tables of ITU-T T.81, annex K, and what a quality makes of them.

/// The order in which the coefficients of a block are coded, as places in its rows (figure A.6).
pub(super) const ZIGZAG: [u8; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7,
    14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39,
    46, 53, 60, 61, 54, 47, 55, 62, 63,
];

/// Table K.1, row by row.
const LUMA_STEPS: [u8; 64] = [
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17,
    22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78,
    87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
];

/// Table K.2, row by row: what is not in its upper left corner is 99.
const CHROMA_STEPS: [[u8; 4]; 4] = [[17, 18, 24, 47], [18, 21, 26, 66], [24, 26, 56, 99], [47, 66, 99, 99]];

/// A Huffman table as its segment has it.
pub(super) struct HuffmanSpec {
    /// How many codes there are of 1, 2, … 16 bits.
    pub(super) counts: [u8; 16],
    /// What they stand for, shortest first.
    pub(super) symbols: &'static [u8],
}

/// Tables K.3 and K.5: differences of the first coefficient, and the others, of brightness.
pub(super) const LUMA: [HuffmanSpec; 2] = [
    HuffmanSpec {
        counts: [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0],
        symbols: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11],
    },
    HuffmanSpec {
        counts: [0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 125],
        symbols: &[
            0x01, 0x02, 0x03, 0x00, 0x04, 0x11, 0x05, 0x12, 0x21, 0x31, 0x41, 0x06, 0x13, 0x51, 0x61, 0x07,
            0x22, 0x71, 0x14, 0x32, 0x81, 0x91, 0xa1, 0x08, 0x23, 0x42, 0xb1, 0xc1, 0x15, 0x52, 0xd1, 0xf0,
            0x24, 0x33, 0x62, 0x72, 0x82, 0x09, 0x0a, 0x16, 0x17, 0x18, 0x19, 0x1a, 0x25, 0x26, 0x27, 0x28,
            0x29, 0x2a, 0x34, 0x35, 0x36, 0x37, 0x38, 0x39, 0x3a, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48, 0x49,
            0x4a, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0x5a, 0x63, 0x64, 0x65, 0x66, 0x67, 0x68, 0x69,
            0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x83, 0x84, 0x85, 0x86, 0x87, 0x88, 0x89,
            0x8a, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98, 0x99, 0x9a, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6, 0xa7,
            0xa8, 0xa9, 0xaa, 0xb2, 0xb3, 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xc2, 0xc3, 0xc4, 0xc5,
            0xc6, 0xc7, 0xc8, 0xc9, 0xca, 0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9, 0xda, 0xe1, 0xe2,
            0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea, 0xf1, 0xf2, 0xf3, 0xf4, 0xf5, 0xf6, 0xf7, 0xf8,
            0xf9, 0xfa,
        ],
    },
];

/// Tables K.4 and K.6: the same of chroma.
pub(super) const CHROMA: [HuffmanSpec; 2] = [
    HuffmanSpec {
        counts: [0, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0],
        symbols: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11],
    },
    HuffmanSpec {
        counts: [0, 2, 1, 2, 4, 4, 3, 4, 7, 5, 4, 4, 0, 1, 2, 119],
        symbols: &[
            0x00, 0x01, 0x02, 0x03, 0x11, 0x04, 0x05, 0x21, 0x31, 0x06, 0x12, 0x41, 0x51, 0x07, 0x61, 0x71,
            0x13, 0x22, 0x32, 0x81, 0x08, 0x14, 0x42, 0x91, 0xa1, 0xb1, 0xc1, 0x09, 0x23, 0x33, 0x52, 0xf0,
            0x15, 0x62, 0x72, 0xd1, 0x0a, 0x16, 0x24, 0x34, 0xe1, 0x25, 0xf1, 0x17, 0x18, 0x19, 0x1a, 0x26,
            0x27, 0x28, 0x29, 0x2a, 0x35, 0x36, 0x37, 0x38, 0x39, 0x3a, 0x43, 0x44, 0x45, 0x46, 0x47, 0x48,
            0x49, 0x4a, 0x53, 0x54, 0x55, 0x56, 0x57, 0x58, 0x59, 0x5a, 0x63, 0x64, 0x65, 0x66, 0x67, 0x68,
            0x69, 0x6a, 0x73, 0x74, 0x75, 0x76, 0x77, 0x78, 0x79, 0x7a, 0x82, 0x83, 0x84, 0x85, 0x86, 0x87,
            0x88, 0x89, 0x8a, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98, 0x99, 0x9a, 0xa2, 0xa3, 0xa4, 0xa5,
            0xa6, 0xa7, 0xa8, 0xa9, 0xaa, 0xb2, 0xb3, 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xc2, 0xc3,
            0xc4, 0xc5, 0xc6, 0xc7, 0xc8, 0xc9, 0xca, 0xd2, 0xd3, 0xd4, 0xd5, 0xd6, 0xd7, 0xd8, 0xd9, 0xda,
            0xe2, 0xe3, 0xe4, 0xe5, 0xe6, 0xe7, 0xe8, 0xe9, 0xea, 0xf2, 0xf3, 0xf4, 0xf5, 0xf6, 0xf7, 0xf8,
            0xf9, 0xfa,
        ],
    },
];

/// Steps of the coefficients: of brightness, and of chroma.
pub(super) struct Quantization {
    /// Row by row.
    pub(super) luma: [u8; 64],
    /// Row by row.
    pub(super) chroma: [u8; 64],
}

impl Quantization {
    /// The tables of annex K, scaled as all programs do since libjpeg: 50 leaves them as they are, 100
    /// makes every step 1.
    pub(super) fn of_quality(quality: u8) -> Self {
        let quality = u32::from(quality.clamp(1, 100));
        let percent = if quality < 50 { 5000 / quality } else { 200 - 2 * quality };
        let scaled = |step: u8| -> u8 {
            let step = (u32::from(step) * percent + 50) / 100;
            u8::try_from(step.clamp(1, 255)).expect("clamped to a byte")
        };
        let mut chroma = [scaled(99); 64];
        for (row, steps) in CHROMA_STEPS.into_iter().enumerate() {
            chroma[row * 8..row * 8 + 4].copy_from_slice(&steps.map(scaled));
        }
        Self { luma: LUMA_STEPS.map(scaled), chroma }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zigzag_meets_every_place_once() {
        let mut places = ZIGZAG;
        places.sort_unstable();
        assert!(places.into_iter().eq(0..64));
        // Each step goes to a neighbour.
        let (row, column) = (|at: u8| i16::from(at / 8), |at: u8| i16::from(at % 8));
        for step in ZIGZAG.windows(2) {
            assert!(
                (row(step[0]) - row(step[1])).abs() <= 1 && (column(step[0]) - column(step[1])).abs() <= 1
            );
        }
    }

    #[test]
    fn the_codes_of_a_table_are_as_many_as_its_symbols_and_fit_its_bits() {
        for spec in LUMA.iter().chain(&CHROMA) {
            let counts = spec.counts.map(usize::from);
            assert_eq!(counts.iter().sum::<usize>(), spec.symbols.len());
            // Kraft's sum leaves out the code of all ones, which T.81 does not allow.
            let taken: usize = counts.iter().enumerate().map(|(at, count)| count << (15 - at)).sum();
            assert!(taken < 1 << 16);
            let mut symbols = spec.symbols.to_vec();
            symbols.sort_unstable();
            symbols.dedup();
            assert_eq!(symbols.len(), spec.symbols.len());
        }
    }

    #[test]
    fn quality_scales_the_steps() {
        assert_eq!(Quantization::of_quality(50).luma, LUMA_STEPS);
        assert!(Quantization::of_quality(100).chroma.iter().all(|step| *step == 1));
        assert_eq!(Quantization::of_quality(1).luma[0], 255);
        assert_eq!(Quantization::of_quality(80).chroma[..4], [7, 7, 10, 19]);
    }
}
