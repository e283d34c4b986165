//! Numbers, vectors, colours and long lists of them.

use super::Node;
use super::messages::{plain, shown};
use crate::limits::MAX_COORDINATE;
use crate::scene::document::color::Color;
use glam::DVec3;
use serde_json::Value;

impl<'a> Node<'a> {
    pub(in crate::scene::document) fn number(self) -> Option<f64> {
        // serde_json holds no NaN and no infinity, and with float_roundtrip every number is an f64.
        self.value.as_f64().filter(|n| n.is_finite()).or_else(|| self.mismatch("a number"))
    }

    pub(in crate::scene::document) fn number_in(self, min: f64, max: f64) -> Option<f64> {
        let n = self.clone().number()?;
        self.within(n, (min..=max).contains(&n), || format!("lie in [{}, {}]", plain(min), plain(max)))
    }

    /// A number with the magnitude of a coordinate.
    pub(in crate::scene::document) fn coordinate(self) -> Option<f64> {
        self.number_in(-MAX_COORDINATE, MAX_COORDINATE)
    }

    /// ≥ 0 and no larger than a coordinate.
    pub(in crate::scene::document) fn not_negative(self) -> Option<f64> {
        let n = self.clone().coordinate()?;
        self.within(n, n >= 0.0, || "be at least 0".to_owned())
    }

    /// > 0 and no larger than a coordinate.
    pub(in crate::scene::document) fn positive(self) -> Option<f64> {
        let n = self.clone().coordinate()?;
        self.within(n, n > 0.0, || "be greater than 0".to_owned())
    }

    fn within(self, n: f64, holds: bool, rule: impl FnOnce() -> String) -> Option<f64> {
        if !holds {
            self.fault(format!("must {}, is {}", rule(), plain(n)));
        }
        holds.then_some(n)
    }

    /// A whole number ≥ `min`; whether it is too large is for the limits to say.
    pub(in crate::scene::document) fn count_from(self, min: u32) -> Option<u64> {
        let n = self.clone().number()?;
        if n.fract() != 0.0 {
            self.fault(format!("must be a whole number, is {}", plain(n)));
            return None;
        }
        if n < f64::from(min) {
            self.fault(format!("must be at least {min}, is {}", plain(n)));
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and ≥ 0; what no u64 holds becomes its maximum, which is over every limit"
        )]
        Some(n as u64)
    }

    /// Samples a pixel.
    pub(in crate::scene::document) fn samples(self) -> Option<u32> {
        let n = self.clone().number()?;
        let known = [1_u32, 2, 4, 8, 16].into_iter().find(|&samples| f64::from(samples) == n);
        known.or_else(|| self.mismatch("one of 1, 2, 4, 8, 16"))
    }

    /// An array of exactly `N` coordinates.
    pub(in crate::scene::document) fn vector<const N: usize>(self) -> Option<[f64; N]> {
        let Some(items) = self.value.as_array().filter(|items| items.len() == N) else {
            return self.mismatch(&format!("an array of {N} numbers"));
        };
        self.coordinates(items)
    }

    /// Reads `items`, which hold `N` values, as coordinates.
    fn coordinates<const N: usize>(&self, items: &[Value]) -> Option<[f64; N]> {
        let mut out = [0.0; N];
        let mut whole = true;
        for (i, (slot, item)) in out.iter_mut().zip(items).enumerate() {
            // The fast path: large arrays come through here and need no pointer unless they fault.
            match item.as_f64().filter(|n| n.abs() <= MAX_COORDINATE) {
                Some(n) => *slot = n,
                None => whole &= self.item(i, item).coordinate().is_some(),
            }
        }
        whole.then_some(out)
    }

    pub(in crate::scene::document) fn point(self) -> Option<DVec3> {
        self.vector().map(DVec3::from_array)
    }

    /// A vector that is not zero.
    pub(in crate::scene::document) fn direction(self) -> Option<DVec3> {
        let v = self.clone().point()?;
        if v == DVec3::ZERO {
            self.fault("must not be the zero vector");
            return None;
        }
        Some(v)
    }

    /// Positive in every component.
    pub(in crate::scene::document) fn size<const N: usize>(self) -> Option<[f64; N]> {
        let size = self.clone().vector::<N>()?;
        if size.iter().any(|&side| side < 0.0) {
            self.fault(format!("must be at least 0 in every direction, is {}", shown(self.value)));
            return None;
        }
        Some(size)
    }

    /// Three linear numbers ≥ 0 or an sRGB string.
    pub(in crate::scene::document) fn color(self) -> Option<Color> {
        match self.value {
            Value::String(text) => Color::from_hex(text)
                .or_else(|| self.mismatch("a colour such as \"#ff8800\", \"#f80\" or [1, 0.5, 0]")),
            Value::Array(items) if items.len() == 3 => {
                let linear: [f64; 3] = self.coordinates(items)?;
                if linear.iter().any(|&channel| channel < 0.0) {
                    self.fault(format!("must be at least 0 in every channel, is {}", shown(self.value)));
                    return None;
                }
                Some(Color::from_linear(linear))
            }
            _ => self.mismatch("a colour such as \"#ff8800\", \"#f80\" or [1, 0.5, 0]"),
        }
    }

    /// Tuples of `N` coordinates, either nested (`[[0, 0, 0], …]`) or one after the other (`[0, 0, 0, …]`).
    pub(in crate::scene::document) fn tuples<const N: usize>(self) -> Option<Vec<[f64; N]>> {
        let Some(items) = self.value.as_array() else {
            return self.mismatch("an array");
        };
        if items.first().is_some_and(Value::is_number) {
            if items.len() % N != 0 {
                self.fault(format!("must hold {N} numbers for each element, holds {}", items.len()));
                return None;
            }
            return self.flat_tuples(items);
        }
        let tuples: Vec<_> = items.iter().enumerate().map(|(i, item)| self.tuple(i, item)).collect();
        tuples.into_iter().collect()
    }

    fn tuple<const N: usize>(&self, index: usize, item: &'a Value) -> Option<[f64; N]> {
        match item.as_array().filter(|inner| inner.len() == N) {
            // Only a fault needs the pointer of the element.
            Some(inner) if inner.iter().all(|n| n.as_f64().is_some_and(|n| n.abs() <= MAX_COORDINATE)) => {
                self.coordinates(inner)
            }
            _ => self.item(index, item).vector(),
        }
    }

    fn flat_tuples<const N: usize>(&self, items: &'a [Value]) -> Option<Vec<[f64; N]>> {
        let mut numbers = Vec::with_capacity(items.len());
        for (i, item) in items.iter().enumerate() {
            match item.as_f64().filter(|n| n.abs() <= MAX_COORDINATE) {
                Some(n) => numbers.push(n),
                None => drop(self.item(i, item).coordinate()),
            }
        }
        (numbers.len() == items.len()).then(|| numbers.as_chunks::<N>().0.to_vec())
    }

    /// Whole numbers below `end`, nested in triples or flat.
    pub(in crate::scene::document) fn triangle_indices(self, end: usize) -> Option<Vec<[u32; 3]>> {
        let tuples = self.clone().tuples::<3>()?;
        let mut triangles = Vec::with_capacity(tuples.len());
        for (i, corners) in tuples.iter().enumerate() {
            match corners.map(|n| index_below(n, end)) {
                [Some(a), Some(b), Some(c)] => triangles.push([a, b, c]),
                _ => self.fault(format!(
                    "triangle {i} must refer to vertices 0 to {}, refers to {}",
                    end.saturating_sub(1),
                    corners.map(plain).join(", ")
                )),
            }
        }
        (triangles.len() == tuples.len()).then_some(triangles)
    }
}

fn index_below(n: f64, end: usize) -> Option<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and within u32")]
    let index = (n.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&n)).then_some(n as u32)?;
    (usize::try_from(index).ok()? < end).then_some(index)
}
