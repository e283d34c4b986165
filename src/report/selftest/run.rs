//! Runs checks of the catalogue on all threads.

use super::instruments::engine::Engine;
use super::ledger::{Effort, Ledger, Measurement, Outcome};
use super::{Case, Check};
use crate::pipeline::Cancelled;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Checks that have ended.
    pub done: usize,
    /// Checks of the run.
    pub of: usize,
    /// The case whose check ended last.
    pub last: &'static str,
}

/// Runs all checks of `cases`, each drawing with `engine`, as many at a time as that has threads. Returns
/// what they measured, the worst margin first.
///
/// # Errors
/// [`Cancelled`] if `cancel` was set before the last check began.
pub fn run(
    cases: &[&'static Case],
    effort: Effort,
    engine: &Engine,
    cancel: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Measurement>, Cancelled> {
    let of_case = |case: &&'static Case| case.checks.iter().map(|&check| (case.id, check));
    let checks: Vec<(&'static str, Check)> = cases.iter().flat_map(of_case).collect();
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let rows: Mutex<Vec<(usize, Measurement)>> = Mutex::default();
    let serve = || {
        while !cancel.load(Ordering::Relaxed) {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(&(case, check)) = checks.get(at) else { return };
            let measured = engine.drive(|| measure(case, check, effort));
            rows.lock().expect("panics are caught").extend(measured.into_iter().map(|row| (at, row)));
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(Progress { done, of: checks.len(), last: case });
        }
    };
    std::thread::scope(|scope| (0..engine.threads).for_each(|_| drop(scope.spawn(serve))));
    if done.into_inner() < checks.len() {
        return Err(Cancelled);
    }
    let mut of_checks = rows.into_inner().expect("panics are caught");
    // The check that ends first is not the same in every run.
    of_checks.sort_by_key(|(at, _)| *at);
    let not_offered = cases.iter().filter_map(|case| case.not_offered());
    let mut rows = Vec::new();
    of_checks.into_iter().for_each(|(_, row)| row.note_among(&mut rows));
    rows.extend(not_offered);
    rows.sort_by(|a, b| a.margin.total_cmp(&b.margin));
    Ok(rows)
}

/// What one check measures; a panic is a measurement too.
pub(super) fn measure(case: &'static str, check: Check, effort: Effort) -> Vec<Measurement> {
    let mut ledger = Ledger::new(case, effort);
    let ended = catch_unwind(AssertUnwindSafe(|| check(&mut ledger)));
    let mut rows = ledger.into_measurements();
    let broken = match ended {
        Ok(()) if rows.is_empty() => Some("nothing was measured".to_owned()),
        Ok(()) => None,
        Err(payload) => Some(message(payload.as_ref())),
    };
    rows.extend(broken.map(|why| Measurement::without_numbers(case, why, Outcome::Broken)));
    rows
}

/// What a panic says.
fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_owned()
}
