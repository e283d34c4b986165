//! What checks draw with: threads, a SIMD level, an order of tiles, and what may be left out.

use crate::math::simd::Level;
use crate::pipeline::{Order, Work};
use crate::plan::Elisions;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

/// What checks draw with. No check asks for it: each thread has one, so that the whole catalogue can be run
/// with any.
#[derive(Clone, Debug)]
pub struct Engine {
    /// How many threads draw.
    pub threads: usize,
    /// The instruction set of the kernels.
    pub level: Level,
    /// In which order tiles are handed out.
    pub order: Order,
    /// What plans may leave out where a request does not say.
    pub elide: Elisions,
}

thread_local! {
    static CURRENT: RefCell<Engine> = RefCell::new(Engine::default());
}

/// Two threads at the machine's best SIMD level.
impl Default for Engine {
    fn default() -> Self {
        Self { threads: 2, level: Level::new(), order: Order::Rows, elide: Elisions::ALL }
    }
}

impl Engine {
    /// That of this thread.
    #[must_use]
    pub fn current() -> Self {
        CURRENT.with_borrow(Self::clone)
    }

    /// Calls `f` with this engine as that of the thread.
    pub fn drive<R>(&self, f: impl FnOnce() -> R) -> R {
        let _restored = Restored(CURRENT.replace(self.clone()));
        f()
    }

    /// As the stages take it. Nobody cancels.
    #[must_use]
    pub fn work(&self) -> Work<'static> {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Work { pool: pool(self.threads), cancel: &NEVER, level: self.level, order: self.order }
    }
}

/// The engine that a thread had before, until this is dropped.
struct Restored(Engine);

impl Drop for Restored {
    fn drop(&mut self) {
        CURRENT.set(std::mem::take(&mut self.0));
    }
}

/// A pool of `threads` threads, the same for all who ask: to start one takes longer than a small frame.
///
/// # Panics
/// If the machine gives no more threads.
#[must_use]
pub fn pool(threads: usize) -> &'static rayon::ThreadPool {
    static POOLS: Mutex<BTreeMap<usize, &rayon::ThreadPool>> = Mutex::new(BTreeMap::new());
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    pools.entry(threads).or_insert_with(|| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        Box::leak(Box::new(builder.build().expect("threads to start")))
    })
}
