//! The gallery: scenes to open that come with the program.
//!
//! Each is a document in `assets/gallery/` with its files beside it, embedded: the command line draws the
//! same files from that folder. `examples/gallery_assets/` makes the models and images.

mod pieces;

use super::document::{clipped, suggestion};
use super::{Files, ModelOptions, NewScene};
use bytes::Bytes;

/// A scene of the gallery.
#[derive(Debug, PartialEq, Eq)]
pub struct Piece {
    /// What it is asked for by: its document's file name without `.json`.
    pub name: &'static str,
    /// The document's own `name`.
    pub title: &'static str,
    /// What there is to see, in a sentence or two.
    pub description: &'static str,
    document: &'static str,
    /// Names of [`pieces::FILES`].
    files: &'static [&'static str],
    picture: &'static [u8],
}

/// Every piece, in the order to show them in.
#[must_use]
pub fn pieces() -> &'static [Piece] {
    pieces::PIECES
}

/// The piece of this name.
///
/// # Errors
/// A sentence that names the nearest one and lists them all.
pub fn find(name: &str) -> Result<&'static Piece, String> {
    let names = || pieces().iter().map(|piece| piece.name);
    pieces().iter().find(|piece| piece.name == name).ok_or_else(|| {
        let all = names().collect::<Vec<_>>().join(", ");
        format!("must be one of {all}, is {:?}{}", clipped(name), suggestion(name, names()))
    })
}

impl Piece {
    /// The document with its files, as a client would send them.
    ///
    /// # Panics
    /// Never: a test reads every document and stores every file.
    #[must_use]
    pub fn to_scene(&self) -> NewScene {
        let document = serde_json::from_str(self.document).expect("invariant: the embedded document is JSON");
        let mut files = Files::default();
        for (name, bytes) in pieces::FILES.iter().filter(|(name, _)| self.files.contains(name)) {
            files.insert(name, Bytes::from_static(bytes)).expect("invariant: a literal name");
        }
        NewScene { document: Some(document), files: Some(files), options: ModelOptions::default() }
    }

    /// A small picture of it, a JPEG file of 480 × 360.
    #[must_use]
    pub fn picture(&self) -> Bytes {
        Bytes::from_static(self.picture)
    }
}

#[cfg(test)]
mod tests;
