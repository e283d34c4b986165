//! A checked reader over JSON that collects every fault instead of stopping at the first.
//!
//! [`Node`] is a value with its JSON pointer; each `Node` method reads one kind of value, and on a
//! mismatch reports a fault and returns `None`. [`Object`] hands out the fields of an object, fills
//! in defaults, and at the end refuses every field that nobody asked for.

mod messages;
mod numbers;
mod object;

pub(in crate::scene) use messages::clipped;
pub(crate) use messages::{suggestion, token};
pub(super) use object::Object;

use super::words::{Word, word_list};
use super::{Fault, names};
use crate::limits::MAX_FAULTS;
use crate::scene::files::{Files, check_name};
use messages::shown;
use serde_json::Value;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashSet};

/// Where faults gather while a document is read.
#[derive(Debug, Default)]
pub(in crate::scene) struct Faults {
    found: RefCell<Vec<Fault>>,
    /// Pointers of members whose presence is no fault; see [`super::Document::from_patched`].
    tolerated: HashSet<String>,
}

impl Faults {
    pub(super) fn tolerating(tolerated: Vec<String>) -> Self {
        Self { found: RefCell::default(), tolerated: tolerated.into_iter().collect() }
    }

    /// Keeps a fault, the last of which says so when more are to come.
    pub(in crate::scene) fn add(&self, pointer: String, mut detail: String) {
        if self.is_full() {
            return;
        }
        let mut found = self.found.borrow_mut();
        if found.len() + 1 == MAX_FAULTS {
            detail += "; further faults are not listed";
        }
        found.push(Fault { pointer, detail });
    }

    /// Whether any further fault would be dropped, so that nobody need look for it.
    pub(in crate::scene) fn is_full(&self) -> bool {
        self.found.borrow().len() >= MAX_FAULTS
    }

    pub(in crate::scene) fn into_vec(self) -> Vec<Fault> {
        self.found.into_inner()
    }
}

/// A JSON value, where it stands, and where its faults go.
#[derive(Clone)]
pub(super) struct Node<'a> {
    value: &'a Value,
    pointer: String,
    faults: &'a Faults,
}

impl<'a> Node<'a> {
    pub(super) fn root(value: &'a Value, faults: &'a Faults) -> Self {
        Self { value, pointer: String::new(), faults }
    }

    pub(super) fn fault(&self, detail: impl Into<String>) {
        self.faults.add(self.pointer.clone(), detail.into());
    }

    /// Reports that this is not `expected`.
    pub(super) fn mismatch<T>(&self, expected: &str) -> Option<T> {
        self.fault(format!("must be {expected}, is {}", shown(self.value)));
        None
    }

    pub(super) fn is_string(&self) -> bool {
        self.value.is_string()
    }

    pub(super) fn is_number(&self) -> bool {
        self.value.is_number()
    }

    pub(super) fn is_array(&self) -> bool {
        self.value.is_array()
    }

    pub(super) fn flag(self) -> Option<bool> {
        self.value.as_bool().or_else(|| self.mismatch("true or false"))
    }

    /// Any text without control characters.
    pub(super) fn text(self) -> Option<String> {
        let Some(text) = self.value.as_str() else {
            return self.mismatch("a string");
        };
        match names::problem(text).filter(|_| !text.is_empty()) {
            None => Some(text.to_owned()),
            Some(problem) => {
                self.fault(problem);
                None
            }
        }
    }

    /// A path, of which the last component is the name of a file.
    pub(super) fn file(self) -> Option<String> {
        let Some(path) = self.value.as_str() else {
            return self.mismatch("a string");
        };
        match check_name(Files::reduce(path)) {
            Ok(()) => Some(path.to_owned()),
            Err(detail) => {
                self.fault(detail);
                None
            }
        }
    }

    /// The name of a map entry.
    pub(super) fn name(self) -> Option<String> {
        let Some(text) = self.value.as_str() else {
            return self.mismatch("a string");
        };
        match names::problem(text) {
            None => Some(text.to_owned()),
            Some(problem) => {
                self.fault(problem);
                None
            }
        }
    }

    /// One word of a fixed list.
    pub(super) fn one_of<W: Word>(self) -> Option<W> {
        let Some(text) = self.value.as_str() else {
            return self.mismatch(&format!("one of {}", word_list::<W>()));
        };
        let found = W::from_word(text);
        if found.is_none() {
            let nearest = suggestion(text, W::WORDS.iter().map(|(word, _)| *word));
            self.fault(format!("must be one of {}, is {:?}{nearest}", word_list::<W>(), clipped(text)));
        }
        found
    }

    /// The `type` of an object that comes in several.
    pub(super) fn tag(self, types: &[&'static str]) -> Option<&'static str> {
        let listed = || types.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", ");
        let Some(text) = self.value.as_str() else {
            return self.mismatch(&format!("one of {}", listed()));
        };
        let found = types.iter().find(|known| **known == text).copied();
        if found.is_none() {
            let nearest = suggestion(text, types.iter().copied());
            self.fault(format!("must be one of {}, is {:?}{nearest}", listed(), clipped(text)));
        }
        found
    }

    fn item(&self, index: usize, value: &'a Value) -> Self {
        Self { value, pointer: format!("{}/{index}", self.pointer), faults: self.faults }
    }

    /// Every element of an array.
    pub(super) fn items(self) -> Option<Vec<Self>> {
        let Some(items) = self.value.as_array() else {
            return self.mismatch("an array");
        };
        Some(items.iter().enumerate().map(|(i, item)| self.item(i, item)).collect())
    }

    /// A map with names: every entry is read by `read`; those with faults are left out.
    pub(super) fn map_of<T>(self, mut read: impl FnMut(Self) -> Option<T>) -> Option<BTreeMap<String, T>> {
        let Some(map) = self.value.as_object() else {
            return self.mismatch("an object of named entries");
        };
        let mut entries = BTreeMap::new();
        for (name, value) in map {
            let node = self.child(name, value);
            if let Some(problem) = names::problem(name) {
                node.fault(format!("the name {problem}"));
                continue;
            }
            if let Some(entry) = read(node) {
                entries.insert(name.clone(), entry);
            }
        }
        Some(entries)
    }

    fn child(&self, key: &str, value: &'a Value) -> Self {
        Self { value, pointer: format!("{}/{}", self.pointer, token(key)), faults: self.faults }
    }

    pub(super) fn object(self) -> Option<Object<'a>> {
        match self.value.as_object() {
            Some(fields) => Some(Object { fields, node: self, asked: Vec::new() }),
            None => self.mismatch("an object"),
        }
    }
}
