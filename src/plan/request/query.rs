//! Reads a query string's pairs, checked, collecting every fault.

use crate::limits::MAX_COORDINATE;
use glam::DVec3;
use std::fmt::Display;
use std::ops::RangeInclusive;

/// One thing that is wrong with a query.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct QueryFault {
    /// The parameter's name.
    pub parameter: String,
    /// What must hold and what is there: `must lie in [1, 100], is 200`.
    pub detail: String,
}

impl QueryFault {
    /// A fault of `parameter`.
    pub fn new(parameter: impl Into<String>, detail: impl Into<String>) -> Self {
        Self { parameter: parameter.into(), detail: detail.into() }
    }
}

impl Display for QueryFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.parameter, self.detail)
    }
}

/// The pairs of a query and what was found wrong with them so far.
///
/// Asking for a parameter makes it a known one; what nobody asked for is a fault of
/// [`Query::finish`], so the list of known names can't differ from what is read.
#[derive(Debug)]
pub struct Query {
    pairs: Vec<(String, String)>,
    asked: Vec<&'static str>,
    faults: Vec<QueryFault>,
}

impl Query {
    /// A query of decoded pairs; a name given twice is a fault.
    pub fn new<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let mut query = Self { pairs: Vec::new(), asked: Vec::new(), faults: Vec::new() };
        for (name, value) in pairs {
            if query.pairs.iter().any(|(known, _)| known == name) {
                query.fault(name, "is given more than once");
            } else {
                query.pairs.push((name.to_owned(), value.to_owned()));
            }
        }
        query
    }

    /// Notes a fault of `parameter`.
    pub fn fault(&mut self, parameter: &str, detail: impl Into<String>) {
        self.faults.push(QueryFault::new(parameter, detail));
    }

    /// The text of `name`, if it is given.
    pub fn text(&mut self, name: &'static str) -> Option<String> {
        self.asked.push(name);
        self.pairs.iter().find(|(given, _)| given == name).map(|(_, value)| value.clone())
    }

    /// `name` as `parse` reads it; what it refuses is a fault with its detail.
    pub fn parsed<T>(
        &mut self,
        name: &'static str,
        parse: impl FnOnce(&str) -> Result<T, String>,
    ) -> Option<T> {
        let text = self.text(name)?;
        parse(&text).map_err(|detail| self.fault(name, detail)).ok()
    }

    /// A finite number.
    pub fn number(&mut self, name: &'static str) -> Option<f64> {
        self.parsed(name, number)
    }

    /// A number in `range`.
    pub fn number_in(&mut self, name: &'static str, range: RangeInclusive<f64>) -> Option<f64> {
        self.parsed(name, |text| in_range(number(text)?, &range))
    }

    /// A number above 0.
    pub fn positive(&mut self, name: &'static str) -> Option<f64> {
        self.parsed(name, |text| positive(number(text)?))
    }

    /// An integer from `range`. What no u32 holds counts as its maximum, so that a bound beyond
    /// `range` is what names it.
    pub fn integer_in(&mut self, name: &'static str, range: RangeInclusive<u32>) -> Option<u32> {
        self.parsed(name, |text| in_range(integer(text)?, &range))
    }

    /// Three coordinates, `x,y,z`.
    pub fn point(&mut self, name: &'static str) -> Option<DVec3> {
        self.parsed(name, |text| {
            let numbers = numbers(text)?;
            let [x, y, z] = *numbers.as_slice() else {
                return Err(format!("must be three numbers, x,y,z, is {}", quoted(text)));
            };
            let range = -MAX_COORDINATE..=MAX_COORDINATE;
            Ok(DVec3::new(in_range(x, &range)?, in_range(y, &range)?, in_range(z, &range)?))
        })
    }

    /// One of a few words.
    pub fn one_of<T: Copy>(&mut self, name: &'static str, words: &[(&str, T)]) -> Option<T> {
        self.parsed(name, |text| match words.iter().find(|(word, _)| *word == text) {
            Some((_, value)) => Ok(*value),
            None => Err(not_one_of(text, words.iter().map(|(word, _)| *word))),
        })
    }

    /// `true` or `false`.
    pub fn flag(&mut self, name: &'static str) -> Option<bool> {
        self.one_of(name, &[("true", true), ("false", false)])
    }

    /// Every name asked for so far, in that order.
    #[must_use]
    pub fn known(&self) -> &[&'static str] {
        &self.asked
    }

    /// Ends the reading.
    ///
    /// # Errors
    /// Every fault at once, with those of names that nobody asked for.
    pub fn finish(mut self) -> Result<(), Vec<QueryFault>> {
        let unknown = self.pairs.iter().filter(|(name, _)| !self.asked.contains(&name.as_str()));
        let unknown: Vec<QueryFault> =
            unknown.map(|(name, _)| unknown_parameter(name, &self.asked)).collect();
        self.faults.extend(unknown);
        if self.faults.is_empty() { Ok(()) } else { Err(self.faults) }
    }
}

fn unknown_parameter(name: &str, known: &[&'static str]) -> QueryFault {
    let detail = match nearest(name, known.iter().copied()) {
        Some(near) => format!("unknown parameter; did you mean {}?", quoted(near)),
        None => "unknown parameter; this call takes none".to_owned(),
    };
    QueryFault::new(shortened(name), detail)
}

/// The word most like `given`.
pub(super) fn nearest<'a>(given: &str, words: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let given = shortened(given);
    words
        .map(|word| (strsim::jaro_winkler(&given, word), word))
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, word)| word)
}

pub(super) fn not_one_of<'a>(given: &str, words: impl Iterator<Item = &'a str>) -> String {
    let words: Vec<&str> = words.collect();
    format!("must be one of {}, is {}", words.join(", "), quoted(given))
}

pub(super) fn integer(text: &str) -> Result<u32, String> {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(format!("must be an integer, is {}", quoted(text)));
    }
    Ok(text.parse().unwrap_or(u32::MAX))
}

pub(super) fn number(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
        .ok_or_else(|| format!("must be a finite number, is {}", quoted(text)))
}

pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',').map(|part| number(part.trim())).collect()
}

pub(super) fn positive(value: f64) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("must be greater than 0, is {value}")) }
}

pub(super) fn in_range<T: PartialOrd + Display + Copy>(
    value: T,
    range: &RangeInclusive<T>,
) -> Result<T, String> {
    if range.contains(&value) {
        Ok(value)
    } else {
        Err(format!("must lie in [{}, {}], is {value}", range.start(), range.end()))
    }
}

/// `text` in quotes and short enough to be repeated to its author.
pub(in crate::plan) fn quoted(text: &str) -> String {
    format!("{:?}", shortened(text))
}

fn shortened(text: &str) -> String {
    text.chars().take(64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_given_twice_is_a_fault() {
        let mut query = Query::new([("t", "1"), ("t", "2")]);
        assert_eq!(query.number("t"), Some(1.0));
        assert_eq!(query.finish(), Err(vec![QueryFault::new("t", "is given more than once")]));
    }

    #[test]
    fn an_unknown_parameter_names_the_nearest_known_one() {
        let mut query = Query::new([("widht", "1")]);
        query.integer_in("height", 1..=9);
        query.integer_in("width", 1..=9);
        let faults = query.finish().unwrap_err();
        assert_eq!(faults, vec![QueryFault::new("widht", "unknown parameter; did you mean \"width\"?")]);
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for text in ["", "nan", "inf", "-inf", "1e999", "1,2", "0x10", "one"] {
            assert!(number(text).is_err(), "{text}");
        }
        assert_eq!(number("-1.5e3"), Ok(-1500.0));
    }

    #[test]
    fn an_integer_beyond_u32_counts_as_the_largest() {
        assert_eq!(integer("99999999999999999999999"), Ok(u32::MAX));
        assert!(integer("-1").is_err() && integer("1.0").is_err() && integer("").is_err());
    }
}
