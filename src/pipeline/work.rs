//! How a stage spreads its work over the threads, and how it is told to stop.

use crate::math::keeps_subnormals;
use crate::math::simd::Level;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// The frame is no longer wanted: its client left or its deadline passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the frame was cancelled")]
pub struct Cancelled;

/// How long a worker serves one frame before the others get their turn.
const SLICE: Duration = Duration::from_millis(2);

/// In which order the items of a stage are handed out.
///
/// No byte of a frame depends on it: every item has its own place for what it makes, and results come
/// back in the order of the items. Frames are drawn in [`Order::Rows`]; the others are there to prove it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// As the stage lists them: tiles from left to right, row by row.
    #[default]
    Rows,
    /// Along a Z-curve through a square that the list fills row by row.
    Morton,
    /// By a seed, in no order.
    Shuffled(u64),
}

impl Order {
    /// Which item comes first, second and so on; `None` for the order of the list.
    fn of(self, count: usize) -> Option<Vec<usize>> {
        let mut turns: Vec<usize> = (0..count).collect();
        let side = count.isqrt() + 1;
        match self {
            Self::Rows => return None,
            Self::Morton => turns.sort_by_key(|at| spread(at % side) | spread(at / side) << 1),
            Self::Shuffled(seed) => turns.sort_by_key(|at| mixed(seed.wrapping_add(*at as u64))),
        }
        Some(turns)
    }
}

/// Moves the bits of a number below 2³² to the even places.
fn spread(n: usize) -> u64 {
    (0..u32::BITS).map(|bit| (n as u64 >> bit & 1) << (2 * bit)).sum()
}

/// A number that looks random and is another for every `n`: the last step of SplitMix64.
/// Source: G. Steele et al., "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
fn mixed(n: u64) -> u64 {
    let z = n.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// What a frame is drawn with: threads, an instruction set, and a flag that stops it.
///
/// The caller of a stage must not be a thread of `pool`: it waits for the pool.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    /// The threads.
    pub pool: &'a rayon::ThreadPool,
    /// Set from outside to stop the frame.
    pub cancel: &'a AtomicBool,
    /// The instruction set of the kernels.
    pub level: Level,
    /// In which order tiles and the like are handed out.
    pub order: Order,
}

impl Work<'_> {
    /// Fails once the frame is no longer wanted.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.cancel.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }

    /// Calls `task(scratch, item)` for every item on all threads and returns the results in the
    /// order of the items. Each worker makes its own scratch.
    ///
    /// A worker takes one item at a time and hands its thread back after a few milliseconds, to the
    /// end of the pool's queue; so frames in flight take turns, and a small one does not wait for a
    /// long one.
    ///
    /// # Errors
    /// [`Cancelled`] if the flag was set before the last item was served.
    ///
    /// # Panics
    /// If a thread loses subnormal numbers: what it drew would differ, and nothing would say so.
    pub fn map<T, R, C>(
        &self,
        items: Vec<T>,
        scratch: impl Fn() -> C + Sync,
        task: impl Fn(&mut C, T) -> R + Sync,
    ) -> Result<Vec<R>, Cancelled>
    where
        T: Send,
        R: Send,
    {
        let count = items.len();
        let order = self.order.of(count);
        let items: Vec<Mutex<Option<T>>> = items.into_iter().map(|i| Mutex::new(Some(i))).collect();
        let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::new(None)).collect();
        let next = AtomicUsize::new(0);
        let broken = AtomicBool::new(false);
        let over = || {
            self.cancel.load(Ordering::Relaxed)
                || broken.load(Ordering::Relaxed)
                || next.load(Ordering::Relaxed) >= count
        };
        let serve = || {
            assert!(keeps_subnormals(), "something has made this thread lose subnormal numbers");
            let began = Instant::now();
            let mut scratch = scratch();
            while !over() && began.elapsed() < SLICE {
                let at = next.fetch_add(1, Ordering::Relaxed);
                if at >= count {
                    return;
                }
                let at = order.as_ref().map_or(at, |order| order[at]);
                let item = take(&items[at]).expect("every index is handed out once");
                let result = task(&mut scratch, item);
                *results[at].lock().expect("a panic ends the frame") = Some(result);
            }
        };
        let (stopped, stops) = mpsc::channel();
        self.pool.in_place_scope(|scope| {
            let start = || {
                let report = Report { stopped: stopped.clone(), broken: &broken };
                scope.spawn(|_| {
                    let _report = report;
                    serve();
                });
            };
            let mut running = self.pool.current_num_threads().min(count);
            (0..running).for_each(|_| start());
            while running > 0 {
                stops.recv().expect("this function holds a sender");
                if over() {
                    running -= 1;
                } else {
                    start();
                }
            }
        });
        self.check()?;
        Ok(results.iter().map(|slot| take(slot).expect("every item was served")).collect())
    }
}

/// Says that a worker stopped, also when it stopped by a panic (which the scope then hands on).
struct Report<'a> {
    stopped: mpsc::Sender<()>,
    broken: &'a AtomicBool,
}

impl Drop for Report<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.broken.store(true, Ordering::Relaxed);
        }
        // The coordinator outlives every worker.
        let _ = self.stopped.send(());
    }
}

fn take<T>(slot: &Mutex<Option<T>>) -> Option<T> {
    slot.lock().expect("a panic ends the frame").take()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_work<R>(threads: usize, cancel: &AtomicBool, f: impl FnOnce(Work) -> R) -> R {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        f(Work { pool: &pool, cancel, level: Level::new(), order: Order::Rows })
    }

    #[test]
    fn results_come_in_the_order_of_the_items() {
        for threads in [1, 2, 7] {
            let doubled = with_work(threads, &AtomicBool::new(false), |work| {
                work.map((0..1000).collect(), || (), |(), i: u32| 2 * i)
            });
            assert_eq!(doubled, Ok((0..1000).map(|i| 2 * i).collect()));
        }
    }

    #[test]
    fn every_order_hands_out_every_item_once() {
        for order in [Order::Morton, Order::Shuffled(1), Order::Shuffled(2)] {
            for count in [0, 1, 2, 5, 16, 1000] {
                let mut turns = order.of(count).expect("an order of its own");
                assert!(count < 5 || !turns.is_sorted(), "{order:?} of {count}");
                turns.sort_unstable();
                assert!(turns.into_iter().eq(0..count), "{order:?} of {count}");
            }
        }
        assert_ne!(Order::Shuffled(1).of(100), Order::Shuffled(2).of(100));
        assert_eq!(Order::Morton.of(9).expect("an order")[..4], [0, 1, 4, 5]);
    }

    #[test]
    fn results_come_in_the_order_of_the_items_whatever_the_order_of_work() {
        for order in [Order::Rows, Order::Morton, Order::Shuffled(7)] {
            let doubled = with_work(3, &AtomicBool::new(false), |work| {
                Work { order, ..work }.map((0..1000).collect(), || (), |(), i: u32| 2 * i)
            });
            assert_eq!(doubled, Ok((0..1000).map(|i| 2 * i).collect()));
        }
    }

    #[test]
    fn a_set_flag_cancels() {
        let cancel = AtomicBool::new(false);
        let result = with_work(2, &cancel, |work| {
            work.map(
                (0..100).collect(),
                || (),
                |(), i: u32| {
                    if i == 3 {
                        cancel.store(true, Ordering::Relaxed);
                    }
                },
            )
        });
        assert_eq!(result, Err(Cancelled));
    }

    #[test]
    fn a_panic_reaches_the_caller() {
        for threads in [1, 3] {
            let caught = std::panic::catch_unwind(|| {
                with_work(threads, &AtomicBool::new(false), |work| {
                    work.map((0..100).collect(), || (), |(), i: u32| assert_ne!(i, 50))
                })
            });
            assert!(caught.is_err());
        }
    }

    #[test]
    fn slow_items_outlive_a_slice() {
        let slept = with_work(2, &AtomicBool::new(false), |work| {
            work.map(vec![(); 8], || (), |(), ()| std::thread::sleep(SLICE))
        });
        assert_eq!(slept.map(|all| all.len()), Ok(8));
    }
}
