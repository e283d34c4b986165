//! What a job works by: its turns, and the time of each of its frames.

use super::JobError;
use super::queue::Turn;
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::time::timeout_at;

/// The time of one frame after another.
#[derive(Debug)]
pub(super) struct Clock {
    limit: Duration,
    end: Mutex<Instant>,
}

impl Clock {
    /// From now on `limit` runs.
    pub(super) fn start(limit: Duration) -> Self {
        Self { limit, end: Mutex::new(Instant::now() + limit) }
    }

    /// From now on it runs anew.
    fn restart(&self) {
        *self.end.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now() + self.limit;
    }

    fn end(&self) -> Instant {
        *self.end.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for `work`, which may set the clock anew.
    ///
    /// # Errors
    /// [`JobError::Deadline`].
    pub(super) async fn wait<T>(&self, work: impl Future<Output = T>) -> Result<T, JobError> {
        let mut work = pin!(work);
        loop {
            let end = self.end();
            match timeout_at(end.into(), &mut work).await {
                Ok(done) => return Ok(done),
                Err(_) if self.end() > end => {}
                Err(_) => return Err(JobError::Deadline(self.limit)),
            }
        }
    }
}

/// The turn that a job has, on the thread that it runs on.
#[derive(Debug)]
pub(super) struct Shift {
    turn: Turn,
    clock: Arc<Clock>,
    waited: Duration,
}

impl Shift {
    /// Of a job that has `waited` for its first turn.
    pub(super) fn new(turn: Turn, clock: Arc<Clock>, waited: Duration) -> Self {
        Self { turn, clock, waited }
    }

    /// How long it has waited for all its turns.
    pub(super) fn waited(&self) -> Duration {
        self.waited
    }

    /// Between two frames: starts the next one's time, and lets those who wait go first.
    ///
    /// # Errors
    /// [`JobError::Deadline`].
    pub(super) fn next_frame(&mut self) -> Result<(), JobError> {
        let began = Instant::now();
        self.clock.restart();
        Handle::current().block_on(self.clock.wait(self.turn.pass_on()))??;
        self.waited += began.elapsed();
        Ok(())
    }

    /// Before the frames are put into one file: that has the time of a frame too.
    pub(super) fn last_step(&self) {
        self.clock.restart();
    }
}
