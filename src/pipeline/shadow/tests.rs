//! What the filters' unit tests share.

use crate::math::simd::Level;
use crate::pipeline::work::{Order, Work};
use std::sync::atomic::AtomicBool;

/// A small random number generator (xorshift64*), so that a failure can be repeated.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        println!("seed {seed:#x}");
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A whole number below `n`.
    pub(super) fn below(&mut self, n: u32) -> u32 {
        u32::try_from((self.next() >> 33) % u64::from(n)).unwrap()
    }

    /// A number between two.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "24 bits")]
        let unit = (self.next() >> 40) as f32 / 16_777_216.0;
        low + (high - low) * unit
    }
}

/// Two threads at the machine's best SIMD level.
pub(super) fn with_work<R>(f: impl FnOnce(&Work) -> R) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    f(&Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows })
}
