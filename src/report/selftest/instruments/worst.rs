//! The largest of many errors.

/// f32 unit roundoff.
pub const U: f64 = 1.0 / 16_777_216.0;

/// The largest of the errors that a check has looked at.
///
/// What is not a number fails at once: `f64::max` would drop it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    largest: f64,
    noted: usize,
}

impl Worst {
    /// Looks at one more error; below 0 is none.
    ///
    /// # Panics
    /// If it is not a number.
    #[track_caller]
    pub fn note(&mut self, error: f64) {
        assert!(!error.is_nan(), "error {} is not a number", self.noted);
        self.noted += 1;
        if error > self.largest {
            self.largest = error;
        }
    }

    /// The largest error.
    ///
    /// # Panics
    /// If nothing was looked at.
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
