//! How a stage spreads its work over the threads, and how it is told to stop.

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
            let began = Instant::now();
            let mut scratch = scratch();
            while !over() && began.elapsed() < SLICE {
                let at = next.fetch_add(1, Ordering::Relaxed);
                let Some(slot) = items.get(at) else { return };
                let item = take(slot).expect("every index is handed out once");
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
        f(Work { pool: &pool, cancel, level: Level::new() })
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
