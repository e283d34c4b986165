//! What a report is asked for.

use super::setting::Knob;
use std::ops::RangeInclusive;
use std::time::Duration;

/// What a report is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// What the scene is called.
    pub name: String,
    /// How long it may take.
    pub budget: Duration,
    /// What is turned; empty: every knob that the scene has.
    pub knobs: Vec<Knob>,
    /// Pixels in a row; the rows follow from the frame's shape.
    pub width: u32,
    /// Times that each setting is drawn, if the budget allows.
    pub rounds: usize,
    /// Whether the catalogue of stiff cases is run too, on top of the budget.
    pub selftest: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            name: String::new(),
            budget: Duration::from_secs(30),
            knobs: Vec::new(),
            width: 320,
            rounds: 15,
            selftest: false,
        }
    }
}

impl Options {
    /// Seconds that a report may be given.
    pub const BUDGETS: RangeInclusive<f64> = 2.0..=600.0;

    /// Reads a budget in seconds.
    ///
    /// # Errors
    /// What is wrong with it, for the client.
    pub fn budget(text: &str) -> Result<Duration, String> {
        let seconds = text.parse().ok().filter(|seconds| Self::BUDGETS.contains(seconds));
        let (least, most) = (Self::BUDGETS.start(), Self::BUDGETS.end());
        seconds.map(Duration::from_secs_f64).ok_or_else(|| format!("must be a number in [{least}, {most}]"))
    }
}
