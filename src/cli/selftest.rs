//! `rasterd selftest`

use super::Failure;
use rasterd::pipeline::Order;
use rasterd::report::selftest::instruments::engine::Engine;
use rasterd::report::selftest::{self, Effort, Measurement, Outcome, Progress};
use rasterd::settings::{Machine, Simd};
use std::io::{IsTerminal, Write};
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// The arguments of `rasterd selftest`.
#[derive(Debug, clap::Args)]
pub(super) struct Selftest {
    /// Cases to run, such as B13; all of them if none is named
    #[arg(value_name = "CASE")]
    cases: Vec<String>,

    /// Run the largest inputs too, and the whole of what is otherwise sampled
    #[arg(long)]
    exhaustive: bool,

    /// Print the measurements as JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    machine: Machine,
}

impl Selftest {
    /// Runs the cases and prints their measurements, the worst margin first.
    pub(super) fn run(&self) -> Result<(), Failure> {
        let cases = selftest::named(&self.cases).map_err(|unknown| Failure(unknown.to_string()))?;
        let effort = if self.exhaustive { Effort::Exhaustive } else { Effort::Quick };
        let is_watched = std::io::stderr().is_terminal();
        let progress = |progress: Progress| {
            if is_watched {
                say_progress(progress);
            }
        };
        let never = AtomicBool::new(false);
        let rows = selftest::run(&cases, effort, &self.engine(), &never, &progress);
        let rows = rows.map_err(|cancelled| Failure(cancelled.to_string()))?;
        let text = if self.json { json(&rows) } else { selftest::table(&rows) };
        std::io::stdout()
            .write_all(text.as_bytes())
            .map_err(|error| Failure::new("standard output", error))?;
        verdict(&rows)
    }

    /// What the flags say, and the machine's own where they do not.
    fn engine(&self) -> Engine {
        let Machine { threads, simd, elide } = self.machine.clone();
        let threads = threads.or_else(|| std::thread::available_parallelism().ok());
        Engine {
            threads: threads.map_or(1, NonZeroUsize::get),
            level: simd.unwrap_or_else(Simd::best).level(),
            order: Order::Rows,
            elide,
        }
    }
}

/// Writes one line over the last.
fn say_progress(progress: Progress) {
    let Progress { done, of, last } = progress;
    let end = if done == of { "\r\x1b[K" } else { "" };
    let _ = write!(std::io::stderr(), "\r{done} of {of} checks, {last}\x1b[K{end}");
}

fn json(rows: &[Measurement]) -> String {
    let text = serde_json::to_string_pretty(rows).expect("rows of numbers and text");
    format!("{text}\n")
}

/// Says how many hold, and fails if not all do.
fn verdict(rows: &[Measurement]) -> Result<(), Failure> {
    let out: Vec<&Measurement> = rows.iter().filter(|row| row.is_out()).collect();
    if out.is_empty() {
        let held = rows.iter().filter(|row| row.outcome == Outcome::Holds);
        let settings: usize = held.clone().map(|row| row.settings).sum();
        super::say(format_args!("all {} measurements hold, in {settings} settings", held.count()));
        return Ok(());
    }
    let mut cases: Vec<&str> = out.iter().map(|row| row.case).collect();
    cases.dedup();
    Err(Failure(format!("{} of {} measurements are out: {}", out.len(), rows.len(), cases.join(", "))))
}
