//! How long frames take: settings against each other, round by round.
//!
//! Every round draws each setting once, in another order, so that heat and neighbours fall on all of them alike.

use super::random::Random;
use super::setting::Setting;
use super::statistics::{Spread, median};
use super::subject::Subject;
use crate::encode;
use crate::pipeline::{self, Cancelled, Work};
use serde::Serialize;
use std::time::{Duration, Instant};

/// One frame, timed.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Milliseconds from the request to the last pixel: planning and drawing.
    pub total: f64,
    /// Milliseconds of all threads of the process together, those of other frames among them; `None` where the system
    /// does not tell.
    pub cpu: Option<f64>,
    /// Milliseconds of each pass, `plan` and `encode` among them.
    pub passes: Vec<(&'static str, f64)>,
}

/// What the samples of one setting say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Timing {
    /// Milliseconds from the request to the last pixel.
    #[serde(flatten)]
    pub total: Spread,
    /// Median of the milliseconds of all threads together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu: Option<f64>,
}

impl Subject {
    /// Draws and times one frame.
    ///
    /// # Errors
    /// [`Cancelled`].
    ///
    /// # Panics
    /// If `setting` cannot be planned, which is checked before anything is timed.
    pub fn sample(&self, setting: &Setting, work: &Work) -> Result<Sample, Cancelled> {
        let (cpu, began) = (thread_seconds(), Instant::now());
        let plan = self.plan(setting).expect("a setting that was planned before");
        let planned = began.elapsed();
        let frame = pipeline::render(&plan, work)?;
        let drawn = began.elapsed();
        // A thread that ended meanwhile took its time with it.
        let spent =
            thread_seconds().zip(cpu).map(|(after, before)| (after - before) * 1e3).filter(|ms| *ms > 0.0);
        std::hint::black_box(encode::png(&frame));
        let mut passes = vec![("plan", milliseconds(planned))];
        passes.extend(frame.timings.iter());
        passes.push(("encode", milliseconds(began.elapsed() - drawn)));
        Ok(Sample { total: milliseconds(drawn), cpu: spent, passes })
    }
}

/// Frames that a machine needs at most until it runs evenly.
const MOST_WARM_UPS: usize = 10;

/// Draws `setting` until three frames in a row take the same time within 5 %.
///
/// # Errors
/// [`Cancelled`].
pub fn warm_up(subject: &Subject, setting: &Setting, work: &Work) -> Result<(), Cancelled> {
    let mut last: Vec<f64> = Vec::new();
    for _ in 0..MOST_WARM_UPS {
        last.push(subject.sample(setting, work)?.total);
        let three = &last[last.len().saturating_sub(3)..];
        let most = three.iter().fold(0.0, |most: f64, t| most.max(*t));
        if three.len() == 3 && three.iter().all(|t| *t >= 0.95 * most) {
            break;
        }
    }
    Ok(())
}

/// Draws every setting once a round, each round in another order, until `rounds` are done or the time is up. A
/// round that began is finished. Returns the samples of each setting, in the order of the rounds.
///
/// # Errors
/// [`Cancelled`].
pub fn interleaved(
    subject: &Subject,
    settings: &[Setting],
    rounds: usize,
    until: Instant,
    progress: &dyn Fn(f64),
    work: &Work,
) -> Result<Vec<Vec<Sample>>, Cancelled> {
    let mut samples: Vec<Vec<Sample>> = vec![Vec::new(); settings.len()];
    let mut order: Vec<usize> = (0..settings.len()).collect();
    let mut random = Random(0x5eed);
    for round in 0..rounds {
        if round > 0 && Instant::now() >= until {
            break;
        }
        random.shuffle(&mut order);
        for &at in &order {
            samples[at].push(subject.sample(&settings[at], work)?);
        }
        #[expect(clippy::cast_precision_loss, reason = "a few rounds")]
        progress((round + 1) as f64 / rounds as f64);
    }
    Ok(samples)
}

impl Timing {
    /// Of at least one sample.
    #[must_use]
    pub fn of(samples: &[Sample]) -> Self {
        let totals: Vec<f64> = samples.iter().map(|sample| sample.total).collect();
        let cpu: Vec<f64> = samples.iter().filter_map(|sample| sample.cpu).collect();
        Self { total: Spread::of(&totals), cpu: (!cpu.is_empty()).then(|| median(&cpu)) }
    }
}

/// The median of each pass, in the order of the passes.
#[must_use]
pub fn passes(samples: &[Sample]) -> Vec<(&'static str, f64)> {
    let Some(first) = samples.first() else { return Vec::new() };
    let of = |name: &str| -> Vec<f64> {
        let passes = samples.iter().flat_map(|sample| &sample.passes);
        passes.filter(|(pass, _)| *pass == name).map(|(_, ms)| *ms).collect()
    };
    first.passes.iter().map(|(name, _)| (*name, median(&of(name)))).collect()
}

/// The ratio of two settings that were drawn in the same rounds: the spread of the ratios of each round.
#[must_use]
pub fn ratio(of: &[Sample], to: &[Sample]) -> Spread {
    let ratios: Vec<f64> = of.iter().zip(to).map(|(of, to)| of.total / to.total).collect();
    Spread::of(&ratios)
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Seconds that all threads of this process have run; `None` where the system does not tell.
///
/// The first number of `schedstat` is the time on a processor in nanoseconds. Source: Linux,
/// Documentation/scheduler/sched-stats.
fn thread_seconds() -> Option<f64> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let of = |task: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    let times: Vec<f64> = tasks.filter_map(of).collect();
    (!times.is_empty()).then(|| times.iter().sum::<f64>() * 1e-9)
}
