//! The flag that stops a job.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Held by the caller while it waits. axum drops a handler's future when its client leaves, and this
/// with it; setting the flag of a job that has ended does nothing.
#[derive(Debug, Default)]
pub(crate) struct CancelOnDrop(Arc<AtomicBool>);

impl CancelOnDrop {
    /// The flag, for the job to read.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
