//! What a scene was built of, and how to find it again.

use super::build::LoadedMesh;
use crate::model::texture::{ColorSpace, Image};
use crate::model::{Filter, Mesh, Tangents, Texture, Wrap};
use crate::scene::Background;
use crate::scene::document::{MeshPart, TextureSource};
use bytes::Bytes;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a scene was built of, kept to build the next version from.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    /// By name of the mesh.
    pub(super) meshes: BTreeMap<String, MeshAsset>,
    /// By the address of the mesh, which is held beside them so that no other mesh takes it.
    pub(super) tangents: BTreeMap<usize, (Arc<Mesh>, Arc<Tangents>)>,
    /// By [`ImageSource::key`].
    pub(super) images: BTreeMap<String, ImageAsset>,
    /// By [`Sampling::key`].
    pub(super) textures: BTreeMap<String, Arc<Texture>>,
    /// Backgrounds that take memory, by what they were made of but for the bytes of files.
    pub(super) skies: BTreeMap<String, SkyAsset>,
    /// Textures that only MTL files name.
    pub(super) textures_of_files: usize,
    /// Every file with its hash, by name.
    pub(super) files: BTreeMap<String, HashedFile>,
}

/// A file and the BLAKE3 hash of its bytes.
#[derive(Clone, Debug)]
pub(super) struct HashedFile {
    bytes: Bytes,
    hash: blake3::Hash,
}

impl HashedFile {
    /// Hashes `bytes` unless `before` holds the same.
    pub(super) fn of(bytes: &Bytes, before: Option<&Self>) -> Self {
        let known = before.filter(|before| same_bytes(&before.bytes, bytes));
        let hash = known.map_or_else(|| blake3::hash(bytes), |known| known.hash);
        Self { bytes: bytes.clone(), hash }
    }
}

impl Assets {
    /// Textures that only MTL files name; the others are entries of the document.
    #[must_use]
    pub fn textures_of_files(&self) -> usize {
        self.textures_of_files
    }

    /// Name and hash of every file in order of name.
    pub(in crate::scene) fn file_hashes(&self) -> impl Iterator<Item = (&str, &[u8; 32])> {
        self.files.iter().map(|(name, file)| (name.as_str(), file.hash.as_bytes()))
    }

    /// Bytes of all meshes, tangents, images, textures and backgrounds, each counted once.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let mut meshes: Vec<_> = self.meshes.values().map(|asset| &asset.loaded.mesh).collect();
        meshes.sort_by_key(|mesh| Arc::as_ptr(mesh));
        meshes.dedup_by(|a, b| Arc::ptr_eq(a, b));
        let meshes: u64 = meshes.into_iter().map(|mesh| mesh.bytes()).sum();
        let tangents: u64 = self.tangents.values().map(|(_, tangents)| tangents.bytes()).sum();
        let images: u64 = self.images.values().map(|asset| asset.image.bytes()).sum();
        let mips: u64 = self.textures.values().map(|texture| mip_bytes(texture)).sum();
        let skies: u64 = self.skies.values().map(SkyAsset::bytes).sum();
        meshes + tangents + images + mips + skies
    }
}

/// A mesh and everything it was made of.
#[derive(Clone, Debug)]
pub(super) struct MeshAsset {
    pub part: MeshPart,
    /// Name and bytes of an OBJ.
    pub file: Option<(String, Bytes)>,
    pub loaded: Arc<LoadedMesh>,
}

impl MeshAsset {
    /// Whether it was made of the same.
    pub(super) fn is_of(&self, part: &MeshPart, file: Option<&(String, Bytes)>) -> bool {
        match (&self.file, file) {
            (Some((a, x)), Some((b, y))) => a == b && same_bytes(x, y),
            (None, None) => self.part == *part,
            _ => false,
        }
    }
}

/// An image and everything it was made of.
#[derive(Clone, Debug)]
pub(super) struct ImageAsset {
    pub source: ImageSource,
    pub image: Arc<Image>,
}

/// A background and the files it was made of.
#[derive(Clone, Debug)]
pub(super) struct SkyAsset {
    pub files: Vec<(String, Bytes)>,
    pub background: Background,
}

impl SkyAsset {
    /// Whether it was made of the same files.
    pub(super) fn is_of(&self, files: &[(String, Bytes)]) -> bool {
        let same = |((a, x), (b, y)): (&(String, Bytes), &(String, Bytes))| a == b && same_bytes(x, y);
        self.files.len() == files.len() && self.files.iter().zip(files).all(same)
    }

    /// Bytes of memory it holds beyond those of its files.
    pub(super) fn bytes(&self) -> u64 {
        match &self.background {
            Background::Sky(sky) => sky.bytes(),
            Background::CubeMap(map) => map.bytes(),
            Background::Panorama(panorama) => panorama.bytes(),
            Background::Color(_) | Background::Gradient { .. } | Background::Transparent => 0,
        }
    }
}

/// What an image is made of.
#[derive(Clone, Debug)]
pub(super) enum ImageSource {
    /// A file, or one channel of it as grey.
    File { name: String, bytes: Bytes, channel: Option<usize> },
    /// Painted, in the space its numbers are meant in.
    Made(TextureSource, ColorSpace),
}

impl ImageSource {
    /// Different for different sources but for the bytes of a file; see [`ImageSource::is_like`].
    pub(super) fn key(&self) -> String {
        match self {
            Self::File { name, channel, .. } => format!("file {channel:?} {name}"),
            Self::Made(source, space) => format!("made {source:?} {space:?}"),
        }
    }

    /// Whether two sources of one key make the same image.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::File { bytes: a, .. }, Self::File { bytes: b, .. }) => same_bytes(a, b),
            (Self::Made(a, s), Self::Made(b, t)) => a == b && s == t,
            _ => false,
        }
    }
}

/// How a texture is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sampling {
    pub color_space: ColorSpace,
    pub filter: Filter,
    pub wrap: [Wrap; 2],
    pub scale: [f64; 2],
    pub offset: [f64; 2],
}

impl Sampling {
    /// Different for different samplings or images.
    pub(super) fn key(&self, image: &str) -> String {
        format!("{self:?} {image}")
    }
}

/// Equal content; the same allocation, which is the common case, is told without reading it.
pub(super) fn same_bytes(a: &Bytes, b: &Bytes) -> bool {
    (a.as_ptr() == b.as_ptr() && a.len() == b.len()) || a == b
}

/// Bytes of a texture beyond those of its image, which others may share.
pub(super) fn mip_bytes(texture: &Texture) -> u64 {
    texture.bytes().saturating_sub(texture.image.bytes())
}
