//! Why an OBJ file is refused.

use crate::import::{ImportError, TextError};
use crate::model::MeshTooLarge;

/// The lists that a face's indices refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// `v`
    Vertices,
    /// `vt`
    TextureCoordinates,
    /// `vn`
    Normals,
}

impl List {
    /// What one entry is called.
    fn entry(self) -> &'static str {
        match self {
            Self::Vertices => "vertex",
            Self::TextureCoordinates => "texture coordinate",
            Self::Normals => "normal",
        }
    }
}

/// Why an OBJ file was refused. `line` counts from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ObjError {
    /// It is no text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// It defines no vertex.
    #[error("there is no vertex in it: not an OBJ file, or an empty one")]
    NoVertices,
    /// A word that should be a number.
    #[error("{text} is not a number")]
    NotANumber {
        /// Where.
        line: u64,
        /// The word, quoted.
        text: String,
    },
    /// A number that is not finite, or so large that drawing it would overflow.
    #[error("{text} is out of range: numbers may have at most ±{limit:.1e}")]
    NumberOutOfRange {
        /// Where.
        line: u64,
        /// The word, quoted.
        text: String,
        /// Largest magnitude.
        limit: f64,
    },
    /// Too many or too few numbers.
    #[error("`{keyword}` has {found} numbers; it takes {expected}")]
    NumberCount {
        /// Where.
        line: u64,
        /// `v`, `vt` or `vn`.
        keyword: &'static str,
        /// How many there are.
        found: usize,
        /// How many there may be.
        expected: &'static str,
    },
    /// A face corner that is not `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[error("{text} is not a face corner (v, v/vt, v//vn or v/vt/vn)")]
    BadCorner {
        /// Where.
        line: u64,
        /// The word, quoted.
        text: String,
    },
    /// Index 0: indices count from 1, or from −1 backwards.
    #[error("face refers to {} 0; indices count from 1", list.entry())]
    ZeroIndex {
        /// Where.
        line: u64,
        /// In which list.
        list: List,
    },
    /// An index beyond its list.
    #[error("face refers to {} {index}, but {count} are defined", list.entry())]
    IndexOutOfRange {
        /// Where.
        line: u64,
        /// In which list.
        list: List,
        /// As the file has it.
        index: i64,
        /// Entries of that list: up to the line for a negative index, else in the whole file.
        count: usize,
    },
    /// A face with more corners than are split here.
    #[error("face has {corners} corners, more than {limit}")]
    TooManyCorners {
        /// Where.
        line: u64,
        /// What it has.
        corners: usize,
        /// [`MAX_POLYGON_CORNERS`](crate::limits::MAX_POLYGON_CORNERS).
        limit: usize,
    },
    /// Concave faces that take too long to split.
    #[error("the concave faces up to here take too long to split into triangles")]
    TooComplex {
        /// Where.
        line: u64,
    },
    /// More materials than a scene may have.
    #[error("the file uses more than {limit} materials")]
    TooManyMaterials {
        /// Where.
        line: u64,
        /// [`ObjOptions::max_materials`](super::ObjOptions::max_materials).
        limit: usize,
    },
    /// More than it may take in memory.
    #[error("the file takes more than {limit} bytes in memory")]
    TooManyBytes {
        /// Where the limit is passed.
        line: u64,
        /// [`ObjOptions::max_bytes`](super::ObjOptions::max_bytes).
        limit: u64,
    },
    /// More than indices can count.
    #[error(transparent)]
    MeshTooLarge(#[from] MeshTooLarge),
}

impl ObjError {
    /// Where it is, from 1; `None`: it is about the whole file.
    #[must_use]
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Text(error) => Some(error.line()),
            Self::NoVertices | Self::MeshTooLarge(_) => None,
            Self::NotANumber { line, .. }
            | Self::NumberOutOfRange { line, .. }
            | Self::NumberCount { line, .. }
            | Self::BadCorner { line, .. }
            | Self::ZeroIndex { line, .. }
            | Self::IndexOutOfRange { line, .. }
            | Self::TooManyCorners { line, .. }
            | Self::TooComplex { line }
            | Self::TooManyMaterials { line, .. }
            | Self::TooManyBytes { line, .. } => Some(*line),
        }
    }

    /// As the API reports it.
    #[must_use]
    pub fn in_file(self, file: &str) -> ImportError {
        let (file, line, detail) = (file.to_owned(), self.line(), self.to_string());
        match self {
            Self::TooManyBytes { limit, .. } => ImportError::TooLarge {
                file,
                detail,
                value: limit.saturating_add(1),
                limit,
                setting: Some("RASTERD_MAX_SCENE_BYTES"),
            },
            _ => ImportError::Unreadable { file, line, detail },
        }
    }
}
