//! The vector types of the kernels: always eight lanes, whatever the machine's own width.
//!
//! A fixed width is what makes every SIMD level give the same bits: nothing is ever reduced over
//! the native width, and eight pixels are one row of a block.

pub use fearless_simd::prelude::*;
pub use fearless_simd::{Level, Simd, dispatch, f32x8, f64x4, f64x8, i32x8, mask32x8, u32x8};

/// Lanes of every kernel.
pub const LANES: usize = 8;

/// Marks a kernel's closure, as in `always(#[inline(always)] |x| …)`: what is not inlined into the
/// function that `dispatch!` made runs without its instruction set, and Rust takes the attribute on
/// arguments alone.
#[inline(always)]
pub fn always<F>(closure: F) -> F {
    closure
}

/// 0, 1, … 7.
#[inline(always)]
pub fn ramp_i32<S: Simd>(simd: S) -> i32x8<S> {
    i32x8::simd_from(simd, [0, 1, 2, 3, 4, 5, 6, 7])
}

/// 0, 1, … 7.
#[inline(always)]
pub fn ramp_f64<S: Simd>(simd: S) -> f64x8<S> {
    f64x8::simd_from(simd, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
}

/// Rounds to nearest even, lane by lane.
#[inline(always)]
pub fn narrow<S: Simd>(wide: f64x8<S>) -> f32x8<S> {
    let (low, high) = wide.split();
    low.narrow(high)
}

/// `min(a, b) = if a < b { a } else { b }` (the operand order of MINPS, written out: the same for
/// every level, NaN included).
#[inline(always)]
pub fn min<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
    a.simd_lt(b).select(a, b)
}

/// `max(a, b) = if a > b { a } else { b }`; a NaN in `a` gives `b`.
#[inline(always)]
pub fn max<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> f32x8<S> {
    a.simd_gt(b).select(a, b)
}

/// The numbers of the bits that are set in a mask, the lowest first.
#[inline(always)]
pub fn set_bits(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (lowest < u64::BITS).then_some(lowest as usize)
    })
}

/// Three vectors of eight: eight points, directions or colours.
#[derive(Clone, Copy)]
pub struct Vec3x8<S: Simd> {
    /// First components (x, red).
    pub x: f32x8<S>,
    /// Second components (y, green).
    pub y: f32x8<S>,
    /// Third components (z, blue).
    pub z: f32x8<S>,
}

impl<S: Simd> Vec3x8<S> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(simd: S, v: glam::Vec3) -> Self {
        Self { x: f32x8::splat(simd, v.x), y: f32x8::splat(simd, v.y), z: f32x8::splat(simd, v.z) }
    }

    /// Eight vectors from three arrays, from index `at`.
    #[inline(always)]
    pub fn load<const N: usize>(simd: S, from: &[[f32; N]; 3], at: usize) -> Self {
        let lane = always(
            #[inline(always)]
            |c: usize| f32x8::from_slice(simd, &from[c][at..at + LANES]),
        );
        Self { x: lane(0), y: lane(1), z: lane(2) }
    }

    /// Stores to three arrays, from index `at`.
    #[inline(always)]
    pub fn store<const N: usize>(self, to: &mut [[f32; N]; 3], at: usize) {
        self.x.store_slice(&mut to[0][at..at + LANES]);
        self.y.store_slice(&mut to[1][at..at + LANES]);
        self.z.store_slice(&mut to[2][at..at + LANES]);
    }

    /// Dot product, summed x, y, z.
    #[inline(always)]
    pub fn dot(self, o: Self) -> f32x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Every component times `f`.
    #[inline(always)]
    pub fn scale(self, f: f32x8<S>) -> Self {
        Self { x: self.x * f, y: self.y * f, z: self.z * f }
    }

    /// Lane by lane `if mask { self } else { other }`.
    #[inline(always)]
    pub fn select(self, mask: mask32x8<S>, other: Self) -> Self {
        Self {
            x: mask.select(self.x, other.x),
            y: mask.select(self.y, other.y),
            z: mask.select(self.z, other.z),
        }
    }

    /// Unit length; the caller guarantees a length that neither under- nor overflows when squared.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let length = self.dot(self).sqrt();
        Self { x: self.x / length, y: self.y / length, z: self.z / length }
    }
}

impl<S: Simd> std::ops::Add for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl<S: Simd> std::ops::Sub for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

/// Component by component.
impl<S: Simd> std::ops::Mul for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
}
