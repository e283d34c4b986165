//! The stages of a report, and when each has to be over.

use serde::Serialize;
use std::time::{Duration, Instant};

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The reference is drawn.
    Reference,
    /// Settings are compared with it.
    Errors,
    /// Components are compared with theirs.
    Components,
    /// Settings are timed against each other.
    Timing,
    /// The default is drawn in other ways: with fewer threads, other instructions, other orders.
    Ways,
    /// The catalogue of stiff cases is run.
    Stability,
}

/// How far a report is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// The part of the whole that is done, 0–1.
    pub done: f64,
}

/// Who is told, from any thread.
pub type Tell<'a> = &'a (dyn Fn(Progress) + Sync);

/// The budget of a report, and who is told what became of it.
///
/// A stage gets a part of what is left when it begins: what an earlier one took too long for, or left over, the later
/// ones share.
#[derive(Clone, Copy)]
pub(super) struct Schedule<'a> {
    began: Instant,
    end: Instant,
    tell: Tell<'a>,
}

impl<'a> Schedule<'a> {
    pub(super) fn new(budget: Duration, tell: Tell<'a>) -> Self {
        let began = Instant::now();
        Self { began, end: began + budget, tell }
    }

    pub(super) fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    /// When `part` of the time that is left is over.
    pub(super) fn part_of_the_rest(&self, part: f64) -> Instant {
        let now = Instant::now();
        now + self.end.saturating_duration_since(now).mul_f64(part)
    }

    /// Tells that `share` of a stage is done.
    pub(super) fn tell(&self, stage: Stage, share: f64) {
        let [from, to] = match stage {
            Stage::Reference => [0.0, 0.35],
            Stage::Errors => [0.35, 0.5],
            Stage::Components => [0.5, 0.65],
            Stage::Timing => [0.65, 0.9],
            Stage::Ways => [0.9, 1.0],
            // On top of the budget.
            Stage::Stability => [1.0, 1.0],
        };
        (self.tell)(Progress { stage, done: from + share * (to - from) });
    }
}
