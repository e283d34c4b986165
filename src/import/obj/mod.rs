//! OBJ → [`Mesh`].
//!
//! Source: "Object Files (.obj)", Wavefront Advanced Visualizer manual, appendix B1; and what
//! exporters write beyond it (vertex colours, negative indices, names with blanks).
//!
//! The parser is our own: one pass that checks and numbers every line. A scanner strict enough to
//! stand in front of the `tobj` crate (which panics on legal MTL, rejects byte order marks and
//! continuations, accepts `nan` and names no lines) would have read every number already. `tobj` is
//! the test oracle instead, and `benches/import.rs` compares the two.

mod error;
mod face;
mod numbers;
mod reader;
mod slots;

pub use error::{List, ObjError};

use super::Note;
use super::notes::Notes;
use super::text::{self, Lines, keyword_and_rest};
use crate::limits::Limits;
use crate::model::Mesh;
use reader::Reader;

/// How to read an OBJ file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObjOptions {
    /// Bytes that its lists may take while it is read: two characters of a large face become fifty
    /// bytes.
    pub max_bytes: u64,
    /// Materials it may use.
    pub max_materials: usize,
}

impl ObjOptions {
    /// What `limits` leave to one file: a quarter of [`Limits::scene_bytes`], since building the mesh
    /// takes up to three times as much beside the lists.
    #[must_use]
    pub fn within(limits: &Limits) -> Self {
        Self { max_bytes: limits.scene_bytes / 4, max_materials: limits.entries }
    }
}

impl Default for ObjOptions {
    fn default() -> Self {
        Self::within(&Limits::default())
    }
}

/// A material library that an OBJ file names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Library {
    /// The rest of the `mtllib` line. Where there is no such file, the line may hold several names:
    /// the specification separates them by blanks.
    pub name: String,
    /// Where, from 1.
    pub line: u64,
}

/// What an OBJ file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Obj {
    /// All its faces as one mesh; [`Mesh::slots`] are the names of `usemtl`.
    pub mesh: Mesh,
    /// Line where each of [`Mesh::slots`] is first named; `None` for "no material given".
    pub slot_lines: Vec<Option<u64>>,
    /// Its `mtllib`s, each name once.
    pub libraries: Vec<Library>,
    /// What was not used as its author may have meant it.
    pub notes: Vec<Note>,
}

/// Reads an OBJ file.
///
/// Faces are split into triangles ([`polygon::triangulate`](crate::model::polygon::triangulate)), a
/// face of n corners into n − 2, in the order of the file. Missing normals are generated with a
/// crease of 60°, whatever the smoothing groups say. Lines that are not understood are noted.
///
/// # Errors
/// For structural faults, with their line.
pub fn read(bytes: &[u8], options: &ObjOptions) -> Result<Obj, ObjError> {
    let mut notes = Notes::default();
    let text = text::decode(bytes, &mut notes)?;
    let mut reader = Reader::new(*options, notes);
    for line in Lines::new(&text) {
        reader.line(&line)?;
    }
    drop(text);
    reader.finish()
}

/// The material libraries that an OBJ file names, as [`read`] finds them, without reading the rest.
/// None if it is no text.
#[must_use]
pub fn libraries(bytes: &[u8]) -> Vec<Library> {
    let mut notes = Notes::default();
    let Ok(text) = text::decode(bytes, &mut notes) else {
        return Vec::new();
    };
    let mut reader = Reader::new(ObjOptions::default(), notes);
    for line in Lines::new(&text).filter(|line| keyword_and_rest(&line.text).0 == "mtllib") {
        // Never refused: `mtllib` is not structure.
        let _ = reader.line(&line);
    }
    reader.into_libraries()
}

#[cfg(test)]
mod tests;
