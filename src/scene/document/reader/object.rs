//! Objects with known fields.

use super::Node;
use super::messages::{clipped, suggestion, token};
use serde_json::{Map, Value};

/// The fields of an object. Asking for a field makes it known.
pub(in crate::scene::document) struct Object<'a> {
    pub(super) node: Node<'a>,
    pub(super) fields: &'a Map<String, Value>,
    pub(super) asked: Vec<&'static str>,
}

impl<'a> Object<'a> {
    fn field(&mut self, name: &'static str) -> Option<Node<'a>> {
        self.asked.push(name);
        self.fields.get(name).map(|value| self.node.child(name, value))
    }

    /// Whether the field is there, faulty or not.
    pub(in crate::scene::document) fn has(&self, name: &str) -> bool {
        self.fields.contains_key(name)
    }

    /// `None` where the field is absent or faulty.
    pub(in crate::scene::document) fn optional<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(Node<'a>) -> Option<T>,
    ) -> Option<T> {
        self.field(name).and_then(read)
    }

    /// `default` where the field is absent (or faulty, which fails the document anyway).
    pub(in crate::scene::document) fn or<T>(
        &mut self,
        name: &'static str,
        default: T,
        read: impl FnOnce(Node<'a>) -> Option<T>,
    ) -> T {
        self.optional(name, read).unwrap_or(default)
    }

    /// A fault where the field is absent.
    pub(in crate::scene::document) fn required<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(Node<'a>) -> Option<T>,
    ) -> Option<T> {
        match self.field(name) {
            Some(node) => read(node),
            None => {
                self.node.fault(format!("the field {name:?} is missing"));
                None
            }
        }
    }

    /// Reports a fault at one of the fields, whether it is there or not.
    pub(in crate::scene::document) fn fault_at(&self, field: &str, detail: impl Into<String>) {
        self.node.faults.add(format!("{}/{}", self.node.pointer, token(field)), detail.into());
    }

    /// Reports a fault at the object itself.
    pub(in crate::scene::document) fn fault(&self, detail: impl Into<String>) {
        self.node.fault(detail);
    }

    /// Refuses the fields nobody asked for.
    pub(in crate::scene::document) fn finish(self) {
        let unknown = self.fields.iter().filter(|(name, _)| !self.asked.contains(&name.as_str()));
        for (name, value) in unknown {
            if self.node.faults.is_full() {
                return;
            }
            let node = self.node.child(name, value);
            if !node.faults.tolerated.contains(&node.pointer) {
                let nearest = suggestion(name, self.asked.iter().copied());
                node.fault(format!("unknown field {:?}{nearest}", clipped(name)));
            }
        }
    }
}
