//! Where a check writes down what it has measured.

use crate::report::random::Random;
use serde::Serialize;

/// How long a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// All cases within two minutes on two cores.
    Quick,
    /// The largest inputs too, and the whole of what is otherwise sampled.
    Exhaustive,
}

impl Effort {
    /// One of two sizes.
    pub fn pick<T>(self, quick: T, exhaustive: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Exhaustive => exhaustive,
        }
    }
}

/// What became of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Within its bound.
    Holds,
    /// Beyond its bound.
    Out,
    /// The check ended before it had measured; the metric says how.
    Broken,
    /// Measured and shown, without a bound.
    Reported,
    /// What the case is about does not exist here; the metric says why.
    NotOffered,
}

/// One number beside its bound: of all settings in which it was measured, the one with the least margin.
///
/// Numbers that are infinite or none are `null` in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// The case's name in the catalogue, such as `B14`.
    pub case: &'static str,
    /// What was measured.
    pub metric: String,
    /// What was measured, in units of the metric.
    pub value: f64,
    /// What it may be at most, or at least.
    pub bound: f64,
    /// How many times worse it could be: under 1 it is out. Infinite where nothing is allowed and nothing
    /// was found.
    pub margin: f64,
    /// Whether it is within its bound.
    pub outcome: Outcome,
    /// In which setting.
    pub setting: String,
    /// In how many settings it was measured.
    pub settings: usize,
}

impl Measurement {
    /// A row without numbers.
    pub(super) fn without_numbers(case: &'static str, metric: String, outcome: Outcome) -> Self {
        let margin = if outcome == Outcome::Broken { 0.0 } else { f64::NAN };
        Self {
            case,
            metric,
            value: f64::NAN,
            bound: f64::NAN,
            margin,
            outcome,
            setting: String::new(),
            settings: 1,
        }
    }

    /// Adds it to `rows`, where the same may have been measured in other settings.
    pub(super) fn note_among(mut self, rows: &mut Vec<Self>) {
        let same = |row: &&mut Self| row.case == self.case && row.metric == self.metric;
        match rows.iter_mut().find(same) {
            Some(row) if self.margin < row.margin => {
                self.settings += row.settings;
                *row = self;
            }
            Some(row) => row.settings += self.settings,
            None => rows.push(self),
        }
    }

    /// Whether it speaks against the program.
    #[must_use]
    pub fn is_out(&self) -> bool {
        matches!(self.outcome, Outcome::Out | Outcome::Broken)
    }
}

/// The measurements of one check.
#[derive(Debug)]
pub struct Ledger {
    case: &'static str,
    /// How long the check may take.
    pub effort: Effort,
    seed: Option<u64>,
    rows: Vec<Measurement>,
}

impl Ledger {
    /// An empty ledger of a case.
    #[must_use]
    pub fn new(case: &'static str, effort: Effort) -> Self {
        Self { case, effort, seed: None, rows: Vec::new() }
    }

    /// Notes a value that must not exceed its bound.
    pub fn at_most(&mut self, setting: &str, metric: &str, value: f64, bound: f64) {
        let margin = if value == 0.0 { f64::INFINITY } else { bound / value };
        self.note(setting, metric, [value, bound, margin], value <= bound);
    }

    /// Notes a value that must reach its bound.
    pub fn at_least(&mut self, setting: &str, metric: &str, value: f64, bound: f64) {
        self.note(setting, metric, [value, bound, value / bound], value >= bound);
    }

    /// Notes how many of those that were looked at, which must be more than none, are wrong.
    ///
    /// # Panics
    /// If nothing was looked at.
    pub fn none_of(&mut self, setting: &str, metric: &str, count: usize, of: usize) {
        assert!(of > 0, "{setting}: nothing was looked at for {metric}");
        self.at_most(setting, metric, count as f64, 0.0);
    }

    /// Notes whether all is well; `fault` names what is counted where it is not.
    pub fn holds(&mut self, setting: &str, fault: &str, is_well: bool) {
        self.none_of(setting, fault, usize::from(!is_well), 1);
    }

    /// Notes a value that has no bound.
    pub fn report(&mut self, metric: &str, value: f64) {
        let row = Measurement::without_numbers(self.case, metric.to_owned(), Outcome::Reported);
        self.rows.push(Measurement { value, ..row });
    }

    /// Numbers that look random; their seed is noted with what is out.
    pub fn random(&mut self, seed: u64) -> Random {
        self.seed = Some(seed);
        Random(seed)
    }

    /// All that was noted.
    #[must_use]
    pub fn into_measurements(self) -> Vec<Measurement> {
        self.rows
    }

    fn note(&mut self, setting: &str, metric: &str, [value, bound, margin]: [f64; 3], is_within: bool) {
        let (setting, outcome) = match (is_within, self.seed) {
            (true, _) => (setting.to_owned(), Outcome::Holds),
            (false, None) => (setting.to_owned(), Outcome::Out),
            (false, Some(seed)) => (format!("{setting} (seed {seed:#x})"), Outcome::Out),
        };
        // What is not a number has no margin at all.
        let margin = if margin.is_nan() { 0.0 } else { margin };
        let metric = metric.to_owned();
        let row =
            Measurement { case: self.case, metric, value, bound, margin, outcome, setting, settings: 1 };
        row.note_among(&mut self.rows);
    }
}
