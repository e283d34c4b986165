//! One version of a scene, and how the next one is made.

use super::StoreError;
use crate::limits::Limits;
use crate::scene::document::Fault;
use crate::scene::import_model::{self, ModelOptions};
use crate::scene::{Assets, Compiled, Document, Files, Scene, SceneError, compile, patch, summary};
use serde_json::Value;
use std::sync::Arc;
use std::time::SystemTime;

/// What a client sends to make a scene of.
#[derive(Clone, Debug, Default)]
pub struct NewScene {
    /// The document; without it, one is made of the OBJ files.
    pub document: Option<Value>,
    /// Files that came with it, in place of those that are there; `None`: a document alone, which
    /// leaves a scene in whose place it is put its files.
    pub files: Option<Files>,
    /// How to make a document of OBJ files.
    pub options: ModelOptions,
}

impl NewScene {
    /// Compiles it without keeping it.
    ///
    /// # Errors
    /// As [`compile()`].
    pub fn compile(&self, limits: &Limits) -> Result<Scene, SceneError> {
        self.build(&self.files_over(None), None, limits).map(|(_, compiled)| compiled.scene)
    }

    /// The files of the scene that is made of it in place of `before`.
    pub(super) fn files_over(&self, before: Option<&Entry>) -> Arc<Files> {
        match (&self.files, before) {
            (Some(files), _) => Arc::new(files.clone()),
            (None, Some(entry)) => entry.files.clone(),
            (None, None) => Arc::default(),
        }
    }

    pub(super) fn build(
        &self,
        files: &Files,
        previous: Option<&Assets>,
        limits: &Limits,
    ) -> Result<(Document, Compiled), SceneError> {
        match &self.document {
            Some(json) => {
                let document = Document::from_json_with_files(json, files).map_err(SceneError::Document)?;
                let compiled = compile(&document, files, previous, limits)?;
                Ok((document, compiled))
            }
            None => import_model::build(files, self.options, previous, limits),
        }
    }
}

/// One version of a scene. Cheap to clone; what it shows stays as it is whatever happens to the
/// store.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Matches `[A-Za-z0-9_-]{1,64}`.
    pub id: String,
    /// Counts the versions under this id, from 1.
    pub revision: u64,
    /// What frames are drawn from.
    pub scene: Arc<Scene>,
    /// The document with its defaults filled in.
    pub document: Arc<Value>,
    /// The files it came with.
    pub files: Arc<Files>,
    /// Of the document; quoted, strong.
    pub etag: String,
    /// Bytes of files, meshes, textures and document.
    pub bytes: u64,
    /// When the first version was made: the zero of a stream's time.
    pub created: SystemTime,
    pub(super) assets: Arc<Assets>,
    /// Tells scenes apart that had the same id one after the other.
    pub incarnation: u64,
}

impl Entry {
    /// What the API calls the summary.
    #[must_use]
    pub fn summary(&self) -> Value {
        summary::of(self)
    }

    /// The BLAKE3 hash of the file of exactly this name.
    #[must_use]
    pub fn file_hash(&self, name: &str) -> Option<blake3::Hash> {
        self.assets.file_hashes().find(|(stored, _)| *stored == name).map(|(_, hash)| (*hash).into())
    }

    /// Textures that only MTL files name.
    pub(in crate::scene) fn textures_of_files(&self) -> usize {
        self.assets.textures_of_files()
    }

    /// The scene with a merge patch applied, for one frame.
    ///
    /// # Errors
    /// As [`compile()`].
    pub fn patched(&self, patch: &Value, limits: &Limits) -> Result<Arc<Scene>, SceneError> {
        self.build_patched(patch, limits).map(|(_, compiled)| Arc::new(compiled.scene))
    }

    pub(super) fn build_patched(
        &self,
        patch: &Value,
        limits: &Limits,
    ) -> Result<(Document, Compiled), SceneError> {
        let merged =
            patch::apply(&self.document, patch).map_err(|too_deep| whole_fault(too_deep.to_string()))?;
        let document = Document::from_patched(&merged.json, merged.carried, &self.files)
            .map_err(SceneError::Document)?;
        let compiled = compile(&document, &self.files, Some(&self.assets), limits)?;
        Ok((document, compiled))
    }

    pub(super) fn is_version(&self, other: &Self) -> bool {
        self.incarnation == other.incarnation && self.revision == other.revision
    }
}

/// `If-Match` or `If-None-Match` of a change.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Precondition {
    /// None given.
    #[default]
    None,
    /// `*`: the scene must be there.
    Any,
    /// It must be there in one of these versions.
    OneOf(Vec<String>),
    /// `If-None-Match: *`: the scene must not be there yet.
    Absent,
    /// It must not be there in one of these versions.
    NoneOf(Vec<String>),
}

impl Precondition {
    pub(super) fn check(&self, entry: Option<&Entry>) -> Result<(), StoreError> {
        let holds = match (self, entry) {
            (Self::None, _) => true,
            (Self::Any, entry) => entry.is_some(),
            (Self::OneOf(tags), Some(entry)) => tags.contains(&entry.etag),
            (Self::OneOf(_), None) => false,
            (Self::Absent, entry) => entry.is_none(),
            (Self::NoneOf(tags), entry) => entry.is_none_or(|entry| !tags.contains(&entry.etag)),
        };
        if holds { Ok(()) } else { Err(StoreError::PreconditionFailed) }
    }
}

/// A version that is not in the store yet.
pub(super) struct Draft {
    pub scene: Scene,
    pub document: Value,
    pub files: Arc<Files>,
    pub assets: Assets,
    pub bytes: u64,
}

impl Draft {
    pub(super) fn of(document: &Document, compiled: Compiled, files: Arc<Files>) -> Self {
        let Compiled { scene, assets } = compiled;
        let document = document.to_json();
        let bytes = files.total_bytes() + assets.bytes() + json_bytes(&document);
        Self { scene, document, files, assets, bytes }
    }
}

/// About the memory that a JSON value takes.
fn json_bytes(json: &Value) -> u64 {
    let inner = match json {
        Value::String(text) => text.len() as u64,
        Value::Array(items) => items.iter().map(json_bytes).sum(),
        // A key, its place and its hash.
        Value::Object(map) => map.iter().map(|(key, value)| 40 + key.len() as u64 + json_bytes(value)).sum(),
        _ => 0,
    };
    size_of::<Value>() as u64 + inner
}

/// A fault of the document as a whole.
pub(super) fn whole_fault(detail: String) -> SceneError {
    SceneError::Document(vec![Fault { pointer: String::new(), detail }])
}
