//! What has happened since the start, in numbers.

use std::sync::atomic::{AtomicU64, Ordering};

/// A number that any thread changes.
#[derive(Debug, Default)]
pub struct Counter(AtomicU64);

impl Counter {
    /// `n` more.
    pub(super) fn add(&self, n: u64) {
        self.0.fetch_add(n, Ordering::Relaxed);
    }

    /// One less, of what was added before.
    pub(super) fn take_one(&self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }

    /// The number now.
    #[must_use]
    pub fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Counts over all jobs.
#[derive(Debug, Default)]
pub struct Counters {
    /// Frames drawn for pictures, turntables and archives; those of an archive's outputs are one.
    pub frames: Counter,
    /// Frames drawn for streams.
    pub stream_frames: Counter,
    /// Who watches a stream now, as a picture or as events.
    pub watchers: Counter,
    /// Pictures handed to watchers of streams, repeated ones too.
    pub pictures_sent: Counter,
    /// Pictures that a watcher was too slow for, so that it was given a newer one.
    pub pictures_dropped: Counter,
}
