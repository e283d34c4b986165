//! Whether a thread keeps the numbers nearest to 0.

use std::hint::black_box;

/// Whether this thread computes with subnormal numbers, those below the least normal f32, 2⁻¹²⁶.
///
/// No compiler turns them off, but a library can, for the thread that it runs on: there they are 0, and depths
/// are others than where they are kept.
#[must_use]
pub fn keeps_subnormals() -> bool {
    // 2⁻¹⁴⁰ and its half: the lowest bit is 2⁻¹⁴⁹. Bits are compared, since a thread that reads subnormal
    // numbers as 0 takes them for equal to it.
    let tiny = black_box(f32::from_bits(1 << 9));
    (tiny * black_box(0.5)).to_bits() == 1 << 8
}
