//! One line for every bound that a test checks, and the check.

/// f32 unit roundoff.
pub const U: f64 = 1.0 / 16_777_216.0;

/// Prints `case, metric, value, bound, margin` and fails if the value is over its bound.
///
/// The margin is `bound / value`: how many times worse it could be. A bound of 0 leaves none.
#[track_caller]
pub fn at_most(case: &str, metric: &str, value: f64, bound: f64) {
    let margin = if value == 0.0 { f64::INFINITY } else { bound / value };
    println!("{case}, {metric}, {value:.4e}, {bound:.4e}, {margin:.2}");
    assert!(value <= bound, "{case}: {metric} is {value:e}, over {bound:e}");
}

/// The largest of the errors that a test has looked at.
///
/// What is not a number fails at once: `f64::max` would drop it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    largest: f64,
    noted: usize,
}

impl Worst {
    /// Looks at one more error; below 0 is none.
    #[track_caller]
    pub fn note(&mut self, error: f64) {
        assert!(!error.is_nan(), "error {} is not a number", self.noted);
        self.noted += 1;
        if error > self.largest {
            self.largest = error;
        }
    }

    /// The largest error of at least one.
    #[track_caller]
    pub fn largest(&self) -> f64 {
        assert!(self.noted > 0, "nothing was looked at");
        self.largest
    }
}

impl FromIterator<f64> for Worst {
    fn from_iter<I: IntoIterator<Item = f64>>(errors: I) -> Self {
        let mut worst = Self::default();
        errors.into_iter().for_each(|error| worst.note(error));
        worst
    }
}

/// The same for a number of pixels that must be none; `of` pixels were looked at, and that must be
/// more than none.
#[track_caller]
pub fn none_of(case: &str, metric: &str, count: usize, of: usize) {
    assert!(of > 0, "{case}: nothing was looked at");
    at_most(case, &format!("{metric} of {of}"), count as f64, 0.0);
}
