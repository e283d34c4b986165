//! The numbers of a line.

use super::error::ObjError;
use crate::import::notes::quoted;
use crate::import::text::without_comment;
use crate::limits::MAX_COORDINATE;

/// Up to seven numbers of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Numbers {
    values: [f64; Self::MOST],
    count: usize,
}

impl Numbers {
    /// No line has more.
    const MOST: usize = 7;

    /// Reads what stands after a keyword; a count beyond seven is kept, the numbers are not.
    ///
    /// # Errors
    /// For a word that is no number, or one beyond ±`limit`, which covers infinity and NaN.
    pub(super) fn read(rest: &str, line: u64, limit: f64) -> Result<Self, ObjError> {
        let mut numbers = Self { values: [0.0; Self::MOST], count: 0 };
        for word in without_comment(rest).split_ascii_whitespace() {
            let value = number(word, line, limit)?;
            if let Some(slot) = numbers.values.get_mut(numbers.count) {
                *slot = value;
            }
            numbers.count += 1;
        }
        Ok(numbers)
    }

    /// How many there are on the line.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Those from `first` on; 0 for what the line does not have.
    pub(super) fn from<const N: usize>(&self, first: usize) -> [f64; N] {
        std::array::from_fn(|i| self.values.get(first + i).copied().unwrap_or(0.0))
    }
}

/// Largest magnitude of coordinates and colours.
pub(super) const COORDINATE: f64 = MAX_COORDINATE;

/// Largest magnitude where only the direction counts.
pub(super) const FINITE: f64 = f64::MAX;

fn number(word: &str, line: u64, limit: f64) -> Result<f64, ObjError> {
    let value: f64 = word.parse().map_err(|_| ObjError::NotANumber { line, text: quoted(word) })?;
    if value.abs() <= limit {
        Ok(value)
    } else {
        Err(ObjError::NumberOutOfRange { line, text: quoted(word), limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_usual_forms_are_read() {
        let numbers = Numbers::read("1 -2.5e-3 +.5\t5. -0 # 7 x", 1, COORDINATE).unwrap();
        assert_eq!(numbers.count(), 5);
        assert_eq!(numbers.from::<6>(0), [1.0, -0.0025, 0.5, 5.0, 0.0, 0.0]);
    }

    #[test]
    fn what_is_not_finite_or_too_large_is_refused() {
        for word in ["nan", "-inf", "Infinity", "1e999", "2.2e37", "-1e38"] {
            assert!(
                matches!(Numbers::read(word, 3, COORDINATE), Err(ObjError::NumberOutOfRange { line: 3, .. })),
                "{word}"
            );
        }
        for word in ["1,5", "0x10", "1e", "--1", "1f"] {
            assert!(
                matches!(Numbers::read(word, 3, COORDINATE), Err(ObjError::NotANumber { line: 3, .. })),
                "{word}"
            );
        }
        assert!(Numbers::read("2.1e37", 3, COORDINATE).is_ok());
        assert!(Numbers::read("1e300", 3, FINITE).is_ok());
    }
}
