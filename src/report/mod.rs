//! Error against run time: the same pipeline, beside an f64 reference that shares no code with it.
//!
//! ```text
//! subject ─ sweep ─ reference ─ errors ─ timing ─ fits, front ─ report ─ JSON, SVG, HTML
//! ```
//!
//! A report is about one frame of one scene. It turns those knobs that the scene has, measures what each setting
//! errs by and what it costs, and says which settings no other beats.

pub mod choose;
mod component;
pub mod cost;
pub mod determinism;
pub mod error;
pub mod fit;
pub mod front;
pub mod html;
pub mod machine;
mod make;
mod options;
pub mod plot;
pub mod random;
pub mod reference;
mod schedule;
pub mod selftest;
pub mod setting;
pub mod statistics;
pub mod subject;
mod sweep;
mod timing;

pub use fit::{Fit, Law, Metric};
pub use make::make;
pub use options::Options;
pub use schedule::{Progress, Stage};
pub use setting::{Knob, Setting};
pub use subject::Subject;
pub use sweep::{Family, LeftOut};
pub use timing::Timing;

use crate::pipeline::Cancelled;
use crate::plan::PlanError;
use determinism::Determinism;
use error::PictureError;
use front::Between;
use machine::Machine;
use selftest::Measurement;
use serde::{Serialize, Serializer};

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum Failed {
    /// The frame cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Error against run time of one frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Of what, on what, and how long it took.
    pub meta: Meta,
    /// What errors are measured against.
    pub reference: Truth,
    /// Every setting that was measured; the default first.
    pub points: Vec<Point>,
    /// How the error of each component falls.
    pub fits: Vec<Fit>,
    /// Knobs that were not turned, each with its reason.
    pub left_out: Vec<LeftOut>,
    /// Settings that the budget did not reach, by family.
    pub unfinished: Vec<Family>,
    /// The front: error and milliseconds, from the least time on.
    pub front: Vec<[f64; 2]>,
    /// Time to reach an error.
    pub reach: Vec<Between>,
    /// Error at equal time.
    pub equal_time: Vec<AtTime>,
    /// What the default's error is made of; null where the budget ended before it was known.
    pub parts: Option<Parts>,
    /// Milliseconds of the default with fewer threads.
    pub threads: Vec<Threads>,
    /// Whether the default gives the same bytes however it is drawn.
    pub determinism: Determinism,
    /// The catalogue of stiff cases, worst margin first; empty where it was not asked for.
    pub stability: Vec<Measurement>,
    /// Of the default to itself, measured as two settings: half the width of its interval is the least difference that
    /// can be claimed.
    pub aa_ratio: statistics::Spread,
    /// Whether that interval holds 1, as it must if times are to be believed; null where there were too few rounds to
    /// know.
    pub aa_holds: Option<bool>,
}

impl Report {
    /// It as JSON, indented.
    #[must_use]
    pub fn json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a report is of strings and numbers");
        text.push('\n');
        text
    }
}

/// Of what a report is, on what, and how long it took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Meta {
    /// What drew.
    #[serde(flatten)]
    pub machine: Machine,
    /// What the scene is called.
    pub name: String,
    /// A hash of the scene's content.
    pub scene_hash: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Times that each setting was drawn.
    pub rounds: usize,
    /// Seconds that it was given.
    pub budget_s: f64,
    /// Seconds that it took.
    pub seconds: f64,
    /// Milliseconds of the very first frame.
    pub cold_ms: f64,
    /// Whether FLIP was measured, or why not.
    pub flip: &'static str,
}

/// What errors are measured against.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Truth {
    /// Its own error: what nothing below can be claimed of. Points within three times of it are marked.
    pub floor: f64,
    /// Samples a pixel, in the mean.
    pub mean_samples: f64,
    /// Samples of the pixel with most of them.
    pub most_samples: u32,
    /// Seconds that it took.
    pub seconds: f64,
    /// Parts of the picture: edges, borders of shadows, textures.
    pub masks: [f64; 3],
}

/// A setting that was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// What the scene is called.
    pub scene: String,
    /// Every family that it belongs to.
    pub families: Vec<Family>,
    /// What the knobs were turned to.
    pub knobs: Setting,
    /// How far it is from the reference.
    pub err: PictureError,
    /// The reference's own error.
    pub floor: f64,
    /// Whether its error is so small that the reference's own may hide it.
    pub near_floor: bool,
    /// Milliseconds, from the request to the last pixel.
    pub t: Timing,
    /// Medians of each pass in milliseconds, planning and encoding as PNG among them.
    #[serde(serialize_with = "as_map")]
    pub passes: Vec<(&'static str, f64)>,
    /// The short form of what was done, as a reply tells it.
    #[serde(serialize_with = "as_map")]
    pub counters: Vec<(&'static str, u64)>,
    /// What was done, by its units.
    #[serde(serialize_with = "as_map")]
    pub work: Vec<(&'static str, u64)>,
    /// What elisions spared, by their names.
    #[serde(serialize_with = "as_map")]
    pub spared: Vec<(&'static str, u64)>,
    /// Whether no other beats it in both error and time.
    pub pareto: bool,
}

/// The least error that a number of milliseconds buys.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtTime {
    /// Milliseconds.
    pub ms: f64,
    /// Error; null if everything takes longer.
    pub error: Option<f64>,
}

/// What the default's error is made of.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parts {
    /// Of the default.
    pub total: f64,
    /// Of everything at its best but one knob at the default.
    #[serde(serialize_with = "as_map")]
    pub degrade_one: Vec<(Knob, f64)>,
    /// Of the default but one knob at its best.
    #[serde(serialize_with = "as_map")]
    pub repair_one: Vec<(Knob, f64)>,
    /// Of everything at its best: what no knob mends.
    pub best: f64,
    /// What the parts add up to: the root of the best's square and of what each of `degrade_one` adds to it.
    pub sum: f64,
    /// Whether the parts are independent: their squares add up to the total's within 20 %.
    pub independent: bool,
}

impl Parts {
    fn new(total: f64, best: f64, degrade_one: Vec<(Knob, f64)>, repair_one: Vec<(Knob, f64)>) -> Self {
        let added: f64 = degrade_one.iter().map(|(_, error)| error * error - best * best).sum();
        let square = (best * best + added).max(0.0);
        let independent = (square / (total * total) - 1.0).abs() <= 0.2;
        Self { total, best, degrade_one, repair_one, sum: square.sqrt(), independent }
    }
}

/// The default with some threads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Threads {
    /// How many.
    pub threads: usize,
    /// Milliseconds.
    pub ms: f64,
}

/// Names and their numbers as an object, in their order.
fn as_map<K: Serialize, V: Serialize, S: Serializer>(
    pairs: &[(K, V)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(name, number)| (name, number)))
}
