//! Why a job gave no picture.

use crate::encode::Unfit;
use crate::pipeline::Cancelled;
use crate::plan::PlanError;
use std::time::Duration;

/// Why a job gave no picture.
#[derive(Clone, Debug, thiserror::Error)]
pub enum JobError {
    /// The request does not fit the scene or the limits.
    #[error("the frame cannot be planned")]
    Plan(PlanError),
    /// The file's format cannot hold what the request asks for.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// As many jobs wait as may.
    #[error("the render queue is full ({0} frames wait)")]
    Full(usize),
    /// As many reports wait as may.
    #[error("too many reports are asked for ({0} wait)")]
    FullOfReports(usize),
    /// No job is taken any more.
    #[error("the server is going down")]
    Closing,
    /// A frame of it took longer than this, waiting for its turn included.
    #[error("the frame took longer than its deadline of {} s", .0.as_secs_f64())]
    Deadline(Duration),
    /// Whoever asked has gone.
    #[error("the frame was cancelled")]
    Cancelled,
    /// A fault of ours; the panic's message is in the log.
    #[error("the frame could not be drawn")]
    Panicked,
}

impl From<PlanError> for JobError {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

impl From<Cancelled> for JobError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
