//! Foreign bytes → [`model`](crate::model): OBJ, MTL and images.
//!
//! In: the bytes of an uploaded file. Out: meshes, material descriptions and images, with
//! [`Note`]s on what was not used as its author may have meant it; or why the file was refused.

pub mod image;
pub mod mtl;
mod notes;
pub mod obj;
mod text;

pub use image::ImageError;
pub use mtl::{MapRef, Mtl, MtlMaterial};
pub use notes::Note;
pub use obj::{Obj, ObjError, ObjOptions};
pub use text::TextError;

/// Why a file was refused, as the API reports it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// The file cannot be read (400).
    #[error("{file}{}: {detail}", line.map(|line| format!(", line {line}")).unwrap_or_default())]
    Unreadable {
        /// Its name.
        file: String,
        /// Where in it, from 1.
        line: Option<u64>,
        /// What is wrong there.
        detail: String,
    },
    /// Decoded, the file is over a limit (413).
    #[error("{file}: {detail}")]
    TooLarge {
        /// Its name.
        file: String,
        /// What is too large, with value and limit.
        detail: String,
        /// What the file has.
        value: u64,
        /// What it may have.
        limit: u64,
        /// The environment variable that moves the limit; `None`: it is fixed.
        setting: Option<&'static str>,
    },
}

impl ImportError {
    /// The file that was refused.
    #[must_use]
    pub fn file(&self) -> &str {
        match self {
            Self::Unreadable { file, .. } | Self::TooLarge { file, .. } => file,
        }
    }

    /// The line in it, from 1, where there is one.
    #[must_use]
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Unreadable { line, .. } => *line,
            Self::TooLarge { .. } => None,
        }
    }

    /// What is wrong, without the file's name and line.
    #[must_use]
    pub fn detail(&self) -> &str {
        match self {
            Self::Unreadable { detail, .. } | Self::TooLarge { detail, .. } => detail,
        }
    }
}
