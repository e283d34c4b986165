//! Meshes, images, textures and backgrounds of a scene: built once, shared by every version that has them alike.

mod backgrounds;
mod build;
mod cache;
mod textures;

pub(super) use backgrounds::BackgroundPlace;
pub use cache::Assets;
pub(super) use textures::NamedTextures;

use super::compile::SceneError;
use super::document::{MeshPart, missing_file};
use super::{Document, Files, Warning};
use crate::limits::Limits;
use crate::model::{Mesh, Tangents};
use build::LoadedMesh;
use bytes::Bytes;
use cache::{HashedFile, MeshAsset};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A mesh on its way into a scene.
#[derive(Clone, Debug)]
pub(super) struct NamedMesh {
    pub name: String,
    pub mesh: Arc<Mesh>,
    /// The file it came from.
    pub file: Option<String>,
    /// What that file says beside the mesh.
    pub loaded: Arc<LoadedMesh>,
}

/// Builds what a document names, or finds it among the assets of the version before.
pub(super) struct Loader<'a> {
    files: &'a Files,
    previous: Option<&'a Assets>,
    limits: &'a Limits,
    assets: Assets,
    warnings: Vec<Warning>,
    /// Models loaded so far, by the name of their file.
    models: BTreeMap<String, Arc<LoadedMesh>>,
    /// Bytes of everything built or shared so far.
    bytes: u64,
}

impl<'a> Loader<'a> {
    pub(super) fn new(files: &'a Files, previous: Option<&'a Assets>, limits: &'a Limits) -> Self {
        let bytes = files.total_bytes();
        let hashed = |(name, bytes): (&str, &Bytes)| {
            let before = previous.and_then(|previous| previous.files.get(name));
            (name.to_owned(), HashedFile::of(bytes, before))
        };
        let assets = Assets { files: files.iter().map(hashed).collect(), ..Assets::default() };
        let warnings = Vec::new();
        let models = BTreeMap::new();
        Self { files, previous, limits, assets, warnings, models, bytes }
    }

    /// What was built, and what the client should know.
    pub(super) fn finish(self) -> (Assets, Vec<Warning>) {
        (self.assets, self.warnings)
    }

    /// Warns of something in `file`.
    pub(super) fn warn(&mut self, file: Option<&str>, line: Option<u64>, detail: String) {
        let file = file.map(str::to_owned);
        self.warnings.push(Warning { file, line, detail });
    }

    /// Every mesh in order of name.
    pub(super) fn meshes(&mut self, document: &Document) -> Result<Vec<NamedMesh>, SceneError> {
        document.meshes.iter().map(|(name, part)| self.mesh(name, part)).collect()
    }

    fn mesh(&mut self, name: &str, part: &MeshPart) -> Result<NamedMesh, SceneError> {
        let file = match part {
            MeshPart::Obj { file } => self.look_up(file),
            _ => None,
        };
        let loaded = self.load_mesh(name, part, file.as_ref())?;
        let asset = MeshAsset { part: part.clone(), file: file.clone(), loaded: loaded.clone() };
        self.assets.meshes.insert(name.to_owned(), asset);
        let mesh = loaded.mesh.clone();
        Ok(NamedMesh { name: name.to_owned(), mesh, file: file.map(|(stored, _)| stored), loaded })
    }

    fn load_mesh(
        &mut self,
        name: &str,
        part: &MeshPart,
        file: Option<&(String, Bytes)>,
    ) -> Result<Arc<LoadedMesh>, SceneError> {
        if let Some(loaded) = file.and_then(|(stored, _)| self.models.get(stored)) {
            return Ok(loaded.clone());
        }
        let before = self.previous.and_then(|previous| previous.meshes.get(name));
        let loaded = match before.filter(|asset| asset.is_of(part, file)) {
            Some(asset) => asset.loaded.clone(),
            None => Arc::new(build::mesh(part, file, self.limits)?),
        };
        self.count_bytes(loaded.mesh.bytes())?;
        self.warnings.extend(loaded.warnings.iter().cloned());
        if let Some((stored, _)) = file {
            self.models.insert(stored.clone(), loaded.clone());
        }
        Ok(loaded)
    }

    /// The tangents of `mesh`; `None` if it has no texture coordinates.
    pub(super) fn tangents(&mut self, mesh: &Arc<Mesh>) -> Result<Option<Arc<Tangents>>, SceneError> {
        let key = Arc::as_ptr(mesh).addr();
        if let Some((_, tangents)) = self.assets.tangents.get(&key) {
            return Ok(Some(tangents.clone()));
        }
        let before = self.previous.and_then(|previous| previous.tangents.get(&key));
        let Some(tangents) = (match before {
            Some((_, tangents)) => Some(tangents.clone()),
            None => Tangents::of(mesh).map(Arc::new),
        }) else {
            return Ok(None);
        };
        self.count_bytes(tangents.bytes())?;
        self.assets.tangents.insert(key, (mesh.clone(), tangents.clone()));
        Ok(Some(tangents))
    }

    /// The picture that `path` names; a warning where it is missing, since a scene can do without.
    fn find_picture(&mut self, path: &str, what: &str) -> Option<(String, Bytes)> {
        let found = self.look_up(path);
        if found.is_none() {
            let missing = missing_file(self.files, path);
            self.warn(None, None, format!("{what}: {missing}; it is left out until there is"));
        }
        found
    }

    /// The file that `path` names, with the name it is stored under.
    fn look_up(&self, path: &str) -> Option<(String, Bytes)> {
        self.files.find(path).map(|(name, bytes)| (name.to_owned(), bytes.clone()))
    }

    fn count_bytes(&mut self, bytes: u64) -> Result<(), SceneError> {
        self.check_room(bytes)?;
        self.bytes += bytes;
        Ok(())
    }

    /// Refuses what `bytes` more would be too many for, before it is there.
    fn check_room(&self, bytes: u64) -> Result<(), SceneError> {
        let (limit, value) = (self.limits.scene_bytes, self.bytes.saturating_add(bytes));
        if value <= limit {
            return Ok(());
        }
        let setting = Some("RASTERD_MAX_SCENE_BYTES");
        Err(SceneError::TooLarge {
            what: "bytes of the scene's meshes and textures".to_owned(),
            limit,
            value,
            setting,
        })
    }
}
