//! The materials of `usemtl`.

use super::error::ObjError;
use std::collections::HashMap;

/// Material slots: a material becomes one when a face uses it.
pub(super) struct Slots {
    /// How many there may be.
    limit: usize,
    /// Slot of each name in use; `None` is "no material given".
    by_name: HashMap<Option<String>, u32>,
    /// Material names in order of first use.
    pub(super) names: Vec<Option<String>>,
    /// Where each is named.
    pub(super) lines: Vec<Option<u64>>,
    /// What the next face has, and where it was named.
    selected: Option<String>,
    selected_line: Option<u64>,
    /// Its slot, once a face has used it.
    selected_slot: Option<u32>,
}

impl Slots {
    /// Up to `limit` slots.
    pub(super) fn new(limit: usize) -> Self {
        Self {
            limit,
            by_name: HashMap::new(),
            names: Vec::new(),
            lines: Vec::new(),
            selected: None,
            selected_line: None,
            selected_slot: None,
        }
    }

    /// Takes in a `usemtl`; without a name, none is given from here on.
    pub(super) fn select(&mut self, name: &str, line: u64) {
        let name = (!name.is_empty()).then(|| name.to_owned());
        self.selected_slot = self.by_name.get(&name).copied();
        self.selected_line = name.is_some().then_some(line);
        self.selected = name;
    }

    /// Slot of a face in `line`.
    pub(super) fn in_use(&mut self, line: u64) -> Result<u32, ObjError> {
        if let Some(slot) = self.selected_slot {
            return Ok(slot);
        }
        let limit = self.limit;
        let slot = u32::try_from(self.names.len()).ok().filter(|_| self.names.len() < limit);
        let slot = slot.ok_or(ObjError::TooManyMaterials { line, limit })?;
        self.names.push(self.selected.clone());
        self.lines.push(self.selected_line);
        self.by_name.insert(self.selected.clone(), slot);
        self.selected_slot = Some(slot);
        Ok(slot)
    }
}
