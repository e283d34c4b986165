//! A picture to a budget: what it may cost, or may err by, in place of settings.

use super::Query;
use serde::Serialize;

/// What a picture may cost, or may err by. It is settled into knobs before anything is planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// A place on the way from least time to least error.
    Preset(Preset),
    /// Milliseconds, from the request to the last pixel.
    MaxMs(f64),
    /// Root mean square error of linear light in 0–1.
    MaxError(f64),
}

/// A place on the way from least time to least error, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// A first look.
    Draft,
    /// What a scene gets by default.
    Normal,
    /// For a picture that stays.
    High,
    /// The least error that there is.
    Reference,
}

impl Preset {
    /// Them, with what a query calls them.
    pub const WORDS: [(&str, Self); 4] = [
        ("draft", Self::Draft),
        ("normal", Self::Normal),
        ("high", Self::High),
        ("reference", Self::Reference),
    ];

    /// What a query calls it.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, preset)| *preset == self).map_or("", |(word, _)| word)
    }
}

impl Budget {
    /// The parameters that hold one.
    pub const PARAMETERS: [&str; 3] = ["preset", "max_ms", "max_error"];

    /// Reads it out of a query that may hold other parameters too; two of them are a fault.
    pub fn read(query: &mut Query) -> Option<Self> {
        let preset = query.one_of("preset", &Preset::WORDS).map(Self::Preset);
        let max_ms = query.positive("max_ms").map(Self::MaxMs);
        let max_error = query.positive("max_error").map(Self::MaxError);
        let given: Vec<Self> = [preset, max_ms, max_error].into_iter().flatten().collect();
        if let [first, second, ..] = given.as_slice() {
            let detail =
                format!("cannot be given together with {}: both choose the settings", first.parameter());
            query.fault(second.parameter(), detail);
        }
        given.first().copied()
    }

    fn parameter(self) -> &'static str {
        match self {
            Self::Preset(_) => "preset",
            Self::MaxMs(_) => "max_ms",
            Self::MaxError(_) => "max_error",
        }
    }
}
