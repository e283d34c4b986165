//! The bounded queue: so many run, so many wait, one more is refused.
//!
//! A series of frames gives its turn back after each, and goes to the end of those who wait: what it
//! takes does not keep single frames from their turn. It keeps its frames meanwhile; so only as many
//! series are under way as jobs may run.
//!
//! Streams draw for ever. Their frames line up among themselves first, and come in only as many at a time as
//! leave a slot for others, where there are two or more: however many streams there are, a single frame finds a
//! place, and a turn after those before it.

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
    /// One permit for each frame of a stream that may be here.
    streams: Arc<Semaphore>,
    running: usize,
    waiting: usize,
}

/// What a turn is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One frame.
    Single,
    /// The first of several frames.
    Series,
    /// The next frame of a stream.
    Stream,
}

/// The right to ask for a turn.
#[derive(Debug)]
pub(super) struct Line {
    kind: Kind,
    share: Option<OwnedSemaphorePermit>,
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
    _share: Option<OwnedSemaphorePermit>,
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
            streams: Arc::new(Semaphore::new(running.saturating_sub(1).max(1))),
            running,
            waiting: places,
        }
    }

    /// Where a frame of a stream stands in line with those of other streams, before it comes in. Others
    /// come in as they are.
    ///
    /// # Errors
    /// [`JobError::Closing`]
    pub(super) async fn line_up(&self, kind: Kind) -> Result<Line, JobError> {
        let share = if kind == Kind::Stream { Some(permit(&self.streams).await?) } else { None };
        Ok(Line { kind, share })
    }

    /// Waits for a turn.
    ///
    /// # Errors
    /// [`JobError::Full`] and [`JobError::Closing`], both at once, never after a wait. A frame of a stream
    /// finds no queue full, it waits; while it does, the queue may close.
    pub(super) async fn turn(&self, Line { kind, share }: Line) -> Result<Turn, JobError> {
        let place = match kind {
            Kind::Single | Kind::Series => self.place()?,
            Kind::Stream => permit(&self.places).await?,
        };
        let share = if kind == Kind::Series { Some(permit(&self.series).await?) } else { share };
        let slot = Some(permit(&self.slots).await?);
        Ok(Turn { slots: Arc::clone(&self.slots), slot, _share: share, _place: place })
    }

    /// A place now, or none.
    fn place(&self) -> Result<OwnedSemaphorePermit, JobError> {
        Arc::clone(&self.places).try_acquire_owned().map_err(|_| self.refusal())
    }

    /// Takes no more jobs. Those that run or wait keep their place.
    pub fn close(&self) {
        self.places.close();
        self.streams.close();
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
