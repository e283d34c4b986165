//! exp2, log2, pow, asin and atan2 from `+ − × ÷ √` alone, eight lanes at a time.
//!
//! The platform's own differ between C libraries and so between machines; these give the same bits
//! on every one. Bounds are checked against `libm` in the tests.

use crate::math::simd::*;
use std::f32::consts::FRAC_PI_2;

/// π/4 to so few bits that its multiples up to π are exact, and the rest.
const EIGHTH: f32 = 0.785_156_25;
const EIGHTH_TAIL: f32 = 2.419_134e-4;

/// `log2(1 + d)` where `x = 1 + d` is its rounded value; `x` must be positive and normal.
///
/// Taking `d` apart from `x` keeps the digits that `1 + d` loses, which is what a narrow highlight
/// is made of. Absolute error 2.1e-7 (relative to 1, or to the result where |d| < 0.29).
#[inline(always)]
pub fn log2_1p<S: Simd>(x: f32x8<S>, d: f32x8<S>) -> f32x8<S> {
    let simd = x.token();
    // x = 2^e · m with m in [√½, √2): the exponent field of x / √½.
    let offset = x.to_bits() - 0x3f35_04f3_u32;
    let e = i32x8::from_bytes(offset.to_bytes()) >> 23;
    let e_bits = u32x8::from_bytes((e << 23).to_bytes());
    let m = f32x8::from_bits(x.to_bits() - e_bits);
    let unscaled = e.simd_eq(i32x8::splat(simd, 0));
    let f = unscaled.select(d, m - 1.0);
    // log2(1 + f) = 2/ln 2 · atanh(z), z = f / (2 + f), |z| ≤ 0.172.
    let z = f / (f + 2.0);
    let t = z * z;
    let series = ((((t * (1.0 / 11.0) + 1.0 / 9.0) * t + 1.0 / 7.0) * t + 1.0 / 5.0) * t + 1.0 / 3.0) * t;
    f32x8::float_from(e) + z * (series + 1.0) * (2.0 * std::f32::consts::LOG2_E)
}

/// `log2(x)` for positive normal `x`.
#[inline(always)]
pub fn log2<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    log2_1p(x, x - 1.0)
}

/// `2^x`, relative error 1e-7; 0 below −126, and x above 127 counts as 127.
#[inline(always)]
pub fn exp2<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let simd = x.token();
    let clamped = min(max(x, f32x8::splat(simd, -126.0)), f32x8::splat(simd, 127.0));
    let n = (clamped + 0.5).floor();
    let f = clamped - n;
    // Taylor series of 2^f = e^(f ln 2) on [−½, ½], to the eighth power.
    let mut p = f32x8::splat(simd, 1.321_548_7e-6);
    for c in [
        1.525_273_4e-5,
        1.540_353e-4,
        1.333_355_8e-3,
        9.618_129e-3,
        5.550_411e-2,
        0.240_226_5,
        std::f32::consts::LN_2,
        1.0,
    ] {
        p = p * f + c;
    }
    let n: i32x8<S> = n.to_int_precise();
    let scale = f32x8::from_bits(u32x8::from_bytes(((n + 127) << 23).to_bytes()));
    x.simd_lt(f32x8::splat(simd, -126.0)).select(f32x8::splat(simd, 0.0), p * scale)
}

/// `x^y` for x ≥ 0: 0⁰ is 1, subnormal `x` counts as the smallest normal number.
///
/// The relative error grows as `0.69 · |log2(result)| · 4.2e-7`.
#[inline(always)]
pub fn pow<S: Simd>(x: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    let floor = f32x8::splat(x.token(), f32::MIN_POSITIVE);
    exp2(y * log2(max(x, floor)))
}

/// Arc sine in radians for |x| ≤ 1, absolute error 3e-7.
///
/// Coefficients: minimax fit of `asin(√t)/√t` on t in [0, ¼], error 5.1e-9.
#[inline(always)]
pub fn asin<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let simd = x.token();
    let a = x.abs();
    let far = a.simd_gt(f32x8::splat(simd, 0.5));
    // asin(a) = π/2 − 2 asin(√((1 − a)/2)) beyond ½.
    let t = far.select((f32x8::splat(simd, 1.0) - a) * 0.5, a * a);
    let s = far.select(t.sqrt(), a);
    let mut p = f32x8::splat(simd, 0.042_417_374);
    for c in [0.023_994, 0.045_520_637, 0.074_946_97, 0.166_667_82, 1.0] {
        p = p * t + c;
    }
    let near = p * s;
    let reflected = f32x8::splat(simd, FRAC_PI_2) - near * 2.0;
    far.select(reflected, near).copysign(x)
}

/// The angle of the point (x, y) from the x axis, in −π to π, absolute error 2.4e-7 (4 u); 0 for (0, 0).
///
/// Both must be finite. Coefficients: minimax fit of `atan(√t)/√t` on t in [0, tan²(π/8)], error 5.9e-10.
#[inline(always)]
pub fn atan2<S: Simd>(y: f32x8<S>, x: f32x8<S>) -> f32x8<S> {
    let simd = x.token();
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let (a, b) = (x.abs(), y.abs());
    let steep = b.simd_gt(a);
    let (long, short) = (steep.select(b, a), steep.select(a, b));
    // Of the first octant, atan(s/l) = π/4 + atan((s − l)/(s + l)) beyond π/8.
    let far = short.simd_gt(long * 0.414_213_56);
    let (over, under) = (far.select(short - long, short), far.select(short + long, long));
    let z = over / under.simd_gt(zero).select(under, one);
    let t = z * z;
    let mut p = f32x8::splat(simd, -0.060_401_764);
    for c in [0.105_757_89, -0.142_404_29, 0.199_982_37, -0.333_333_08] {
        p = p * t + c;
    }
    // z + z·t·p keeps the digits of z.
    let near = z + z * (t * p);
    // The angle is a multiple of π/4, plus or minus the rest: added in one step, rounded once.
    let eighths = far.select(one, zero);
    let (eighths, near) = (steep.select(eighths * -1.0 + 2.0, eighths), steep.select(near * -1.0, near));
    let left = x.simd_lt(zero);
    let (eighths, near) = (left.select(eighths * -1.0 + 4.0, eighths), left.select(near * -1.0, near));
    let angle = (near + eighths * EIGHTH_TAIL) + eighths * EIGHTH;
    angle.copysign(y)
}

/// The sRGB encoding (IEC 61966-2-1) of linear values in 0–1.
#[inline(always)]
pub fn srgb_from_linear<S: Simd>(linear: f32x8<S>) -> f32x8<S> {
    let simd = linear.token();
    let curve = pow(linear, f32x8::splat(simd, 1.0 / 2.4)) * 1.055 - 0.055;
    linear.simd_le(f32x8::splat(simd, 0.003_130_8)).select(linear * 12.92, curve)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::round_to_f32;

    /// Applies an eight-lane function to every element.
    macro_rules! lanes {
        ($level:expr, $xs:expr, $f:expr) => {{
            let mut out = Vec::new();
            for chunk in $xs.chunks(LANES) {
                let mut padded = [1.0f32; LANES];
                padded[..chunk.len()].copy_from_slice(chunk);
                let y = dispatch!($level, simd => {
                    let y: f32x8<_> = $f(f32x8::simd_from(simd, padded));
                    y.to_array()
                });
                out.extend_from_slice(&y[..chunk.len()]);
            }
            out
        }};
    }

    fn grid(from: f64, to: f64, n: u32) -> Vec<f32> {
        (0..=n).map(|i| round_to_f32(from + (to - from) * f64::from(i) / f64::from(n))).collect()
    }

    #[test]
    fn log2_and_exp2_stay_within_their_bounds() {
        let level = Level::new();
        let xs = grid(1e-3, 40.0, 40_000);
        for (x, y) in xs.iter().zip(lanes!(level, xs, log2)) {
            let exact = libm::log2(f64::from(*x));
            assert!((f64::from(y) - exact).abs() <= 4.3e-7 * exact.abs().max(0.5), "{x}: {y} {exact}");
        }
        let xs = grid(-120.0, 120.0, 48_000);
        for (x, y) in xs.iter().zip(lanes!(level, xs, exp2)) {
            let exact = libm::exp2(f64::from(*x));
            assert!((f64::from(y) / exact - 1.0).abs() <= 2e-7, "{x}: {y} {exact}");
        }
    }

    #[test]
    fn log2_of_almost_one_keeps_its_digits() {
        let level = Level::new();
        let ds = grid(-1e-4, -1e-9, 5000);
        let ys = lanes!(level, ds, |d: f32x8<_>| log2_1p(d + 1.0, d));
        for (d, y) in ds.iter().zip(ys) {
            let exact = libm::log1p(f64::from(*d)) / std::f64::consts::LN_2;
            assert!((f64::from(y) / exact - 1.0).abs() < 4e-7, "{d}: {y} {exact}");
        }
    }

    #[test]
    fn zero_to_the_zero_is_one_and_zero_to_something_is_zero() {
        let level = Level::new();
        let zeros = [0.0f32; LANES];
        let one = lanes!(level, zeros, |x: f32x8<_>| pow(x, f32x8::splat(x.token(), 0.0)));
        let zero = lanes!(level, zeros, |x: f32x8<_>| pow(x, f32x8::splat(x.token(), 32.0)));
        assert_eq!((one[0], zero[0]), (1.0, 0.0));
    }

    #[test]
    fn asin_stays_within_its_bound() {
        let xs = grid(-1.0, 1.0, 20_000);
        for (x, y) in xs.iter().zip(lanes!(Level::new(), xs, asin)) {
            assert!((f64::from(y) - libm::asin(f64::from(*x))).abs() < 3e-7, "{x}: {y}");
        }
    }

    #[test]
    fn atan2_stays_within_its_bound() {
        let mut worst = 0.0f64;
        for radius in [1e-30, 1.0, 3e4] {
            for angles in grid(-3.2, 3.2, 80_000).chunks(LANES) {
                let [mut xs, mut ys] = [[1.0f32; LANES]; 2];
                for (i, angle) in angles.iter().enumerate() {
                    ys[i] = round_to_f32(libm::sin(f64::from(*angle)) * radius);
                    xs[i] = round_to_f32(libm::cos(f64::from(*angle)) * radius);
                }
                let zs = dispatch!(Level::new(), simd => {
                    let z: f32x8<_> = atan2(f32x8::simd_from(simd, ys), f32x8::simd_from(simd, xs));
                    z.to_array()
                });
                for i in 0..LANES {
                    let exact = libm::atan2(f64::from(ys[i]), f64::from(xs[i]));
                    assert!(!zs[i].is_nan(), "{} {}", ys[i], xs[i]);
                    worst = worst.max((f64::from(zs[i]) - exact).abs());
                }
            }
        }
        assert!(worst <= 2.4e-7, "{worst}");
        let zero = lanes!(Level::new(), [0.0f32; LANES], |z: f32x8<_>| atan2(z, z));
        assert_eq!(zero[0], 0.0);
    }

    #[test]
    fn every_srgb_code_survives_decoding_and_encoding() {
        let linear: Vec<f32> =
            (0..=255u8).map(|c| round_to_f32(crate::math::colour::linear_from_srgb8(c))).collect();
        let codes = lanes!(Level::new(), linear, srgb_from_linear);
        for (c, s) in (0..=255u8).zip(codes) {
            assert_eq!((s * 255.0 + 0.5).floor(), f32::from(c));
        }
    }

    #[test]
    fn srgb_encoding_differs_from_f64_in_at_most_one_input_of_100_000() {
        let xs = grid(0.0, 1.0, 1_000_000);
        let codes = lanes!(Level::new(), xs, srgb_from_linear);
        let mut differing = 0;
        for (x, s) in xs.iter().zip(codes) {
            let code = (s * 255.0 + 0.5).floor();
            let exact = (crate::math::colour::srgb_from_linear(f64::from(*x)) * 255.0 + 0.5).floor();
            assert!((f64::from(code) - exact).abs() <= 1.0);
            differing += u32::from(f64::from(code) != exact);
        }
        assert!(differing <= 10, "{differing} of 1,000,001 differ");
    }
}
