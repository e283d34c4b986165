//! Typed values back to JSON, in a stable order of fields.

use super::words::Word;
use glam::DVec3;
use serde_json::{Map, Number, Value};
use std::collections::BTreeMap;

/// What can stand in a document.
pub(super) trait ToJson {
    fn to_json(&self) -> Value;
}

impl ToJson for f64 {
    /// Whole numbers without a fraction (`65`, not `65.0`); every f64 comes back exactly.
    fn to_json(&self) -> Value {
        let whole = self.fract() == 0.0 && self.abs() < 1e15 && !(*self == 0.0 && self.is_sign_negative());
        if whole {
            #[expect(clippy::cast_possible_truncation, reason = "whole and below 10¹⁵")]
            return Value::from(*self as i64);
        }
        Number::from_f64(*self).map_or(Value::Null, Value::Number)
    }
}

impl ToJson for u64 {
    fn to_json(&self) -> Value {
        Value::from(*self)
    }
}

impl ToJson for u32 {
    fn to_json(&self) -> Value {
        Value::from(*self)
    }
}

impl ToJson for bool {
    fn to_json(&self) -> Value {
        Value::Bool(*self)
    }
}

impl ToJson for String {
    fn to_json(&self) -> Value {
        Value::String(self.clone())
    }
}

impl ToJson for DVec3 {
    fn to_json(&self) -> Value {
        self.to_array().to_json()
    }
}

impl<T: ToJson, const N: usize> ToJson for [T; N] {
    fn to_json(&self) -> Value {
        Value::Array(self.iter().map(ToJson::to_json).collect())
    }
}

impl<T: ToJson> ToJson for Vec<T> {
    fn to_json(&self) -> Value {
        Value::Array(self.iter().map(ToJson::to_json).collect())
    }
}

impl<T: ToJson> ToJson for BTreeMap<String, T> {
    fn to_json(&self) -> Value {
        Value::Object(self.iter().map(|(name, entry)| (name.clone(), entry.to_json())).collect())
    }
}

/// Builds an object field by field.
#[derive(Default)]
pub(super) struct Fields(Map<String, Value>);

impl Fields {
    pub(super) fn new() -> Self {
        Self::default()
    }

    /// An object that begins with its `type`.
    pub(super) fn of_type(word: &str) -> Self {
        Self::new().with("type", &word.to_owned())
    }

    pub(super) fn with(mut self, name: &str, value: &impl ToJson) -> Self {
        self.0.insert(name.to_owned(), value.to_json());
        self
    }

    /// Leaves the field out where there is nothing.
    pub(super) fn with_some(self, name: &str, value: Option<&impl ToJson>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    pub(super) fn with_word<W: Word>(self, name: &str, word: W) -> Self {
        self.with(name, &word.word().to_owned())
    }

    pub(super) fn finish(self) -> Value {
        Value::Object(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_exactly() {
        for n in [0.0, -0.0, 65.0, 0.1, 1e-300, -1e15, 1e16, 2.1e37, f64::MIN_POSITIVE, 1.0 / 3.0] {
            let text = serde_json::to_string(&n.to_json()).unwrap();
            let back: f64 = serde_json::from_str(&text).unwrap();
            assert_eq!(back.to_bits(), n.to_bits(), "{text}");
        }
    }
}
