//! The bounded queue: so many run, so many wait, one more is refused.
//!
//! A series of frames gives its turn back after each, and goes to the end of those who wait: what it
//! takes does not keep single frames from their turn. It keeps its frames meanwhile; so only as many
//! series are under way as jobs may run.

use super::JobError;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// First come, first served. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Queue {
    /// One permit for each job that may be here, running or waiting.
    places: Arc<Semaphore>,
    /// One permit for each job that may run.
    slots: Arc<Semaphore>,
    /// One permit for each series that may be under way.
    series: Arc<Semaphore>,
    running: usize,
    waiting: usize,
}

/// How full a queue is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueueDepth {
    /// Jobs that run.
    pub running: usize,
    /// Jobs that wait.
    pub waiting: usize,
}

/// The right to run; ends when dropped.
#[derive(Debug)]
pub(super) struct Turn {
    slots: Arc<Semaphore>,
    slot: Option<OwnedSemaphorePermit>,
    _series: Option<OwnedSemaphorePermit>,
    _place: OwnedSemaphorePermit,
}

impl Turn {
    /// Lets those who wait run first, and waits for the next turn.
    ///
    /// # Errors
    /// [`JobError::Closing`]
    pub(super) async fn pass_on(&mut self) -> Result<(), JobError> {
        self.slot = None;
        self.slot = Some(permit(&self.slots).await?);
        Ok(())
    }
}

async fn permit(of: &Arc<Semaphore>) -> Result<OwnedSemaphorePermit, JobError> {
    Arc::clone(of).acquire_owned().await.map_err(|_| JobError::Closing)
}

impl Queue {
    /// A queue of `waiting` places before `running` slots.
    #[must_use]
    pub fn new(running: usize, waiting: usize) -> Self {
        let (running, places) =
            (running.min(Semaphore::MAX_PERMITS / 2), waiting.min(Semaphore::MAX_PERMITS / 2));
        Self {
            places: Arc::new(Semaphore::new(running + places)),
            slots: Arc::new(Semaphore::new(running)),
            series: Arc::new(Semaphore::new(running)),
            running,
            waiting: places,
        }
    }

    /// Waits for a turn; `is_series`: for the first of several.
    ///
    /// # Errors
    /// [`JobError::Full`] and [`JobError::Closing`], both at once, never after a wait.
    pub(super) async fn turn(&self, is_series: bool) -> Result<Turn, JobError> {
        let place = Arc::clone(&self.places).try_acquire_owned().map_err(|_| self.refusal())?;
        let series = if is_series { Some(permit(&self.series).await?) } else { None };
        let slot = Some(permit(&self.slots).await?);
        Ok(Turn { slots: Arc::clone(&self.slots), slot, _series: series, _place: place })
    }

    /// Takes no more jobs. Those that run or wait keep their place.
    pub fn close(&self) {
        self.places.close();
    }

    /// How full it is.
    #[must_use]
    pub fn depth(&self) -> QueueDepth {
        let inside = (self.running + self.waiting).saturating_sub(self.places.available_permits());
        let running = self.running.saturating_sub(self.slots.available_permits());
        QueueDepth { running, waiting: inside.saturating_sub(running) }
    }

    fn refusal(&self) -> JobError {
        if self.places.is_closed() { JobError::Closing } else { JobError::Full(self.waiting) }
    }
}
