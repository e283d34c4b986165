//! From f64 to f32.

/// Rounds to the nearest f32 (ties to even; beyond its range: infinite).
#[inline(always)]
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "rounding is what is asked for")]
pub fn round_to_f32(x: f64) -> f32 {
    x as f32
}
