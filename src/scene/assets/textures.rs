//! Textures and images, and the materials of MTL files that name them.

use super::cache::{ImageAsset, ImageSource, Sampling, mip_bytes};
use super::{Loader, NamedMesh, build};
use crate::import::MapRef;
use crate::model::texture::{ColorSpace, Image};
use crate::model::{Filter, Material, Texture, Wrap};
use crate::scene::compile::SceneError;
use crate::scene::document::{TexturePart, TextureSource};
use crate::scene::{Document, Files};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

/// Textures by name: one for each colour space that it is read in.
#[derive(Debug, Default)]
pub(in crate::scene) struct NamedTextures(BTreeMap<String, Vec<Arc<Texture>>>);

impl NamedTextures {
    /// The texture `name` in `space`, or in the only one that its document gives it.
    pub(in crate::scene) fn get(&self, name: &str, space: ColorSpace) -> Option<&Arc<Texture>> {
        let all = self.0.get(name)?;
        all.iter().find(|texture| texture.color_space == space).or(all.first())
    }
}

impl Loader<'_> {
    /// The document's textures, each in every colour space that it is read in. One whose file is missing
    /// is left out, with a warning.
    pub(in crate::scene) fn textures(&mut self, document: &Document) -> Result<NamedTextures, SceneError> {
        let mut textures = NamedTextures::default();
        let spaces = document.color_spaces();
        for (name, part) in &document.textures {
            let file = match &part.source {
                TextureSource::File(file) => {
                    let Some(found) = self.find_picture(file, &format!("the texture {name:?}")) else {
                        continue;
                    };
                    Some(found)
                }
                TextureSource::Checker { .. } => None,
            };
            for &space in &spaces[name.as_str()] {
                let source = match file.clone() {
                    Some((name, bytes)) => ImageSource::File { name, bytes, channel: None },
                    None => ImageSource::Made(part.source.clone(), space),
                };
                let texture = self.texture(source, sampling(part, space))?;
                textures.0.entry(name.clone()).or_default().push(texture);
            }
        }
        Ok(textures)
    }

    fn texture(&mut self, source: ImageSource, sampling: Sampling) -> Result<Arc<Texture>, SceneError> {
        let key = sampling.key(&source.key());
        let image = self.image(source)?;
        if let Some(texture) = self.assets.textures.get(&key) {
            return Ok(texture.clone());
        }
        let before = self.previous.and_then(|previous| previous.textures.get(&key));
        let texture = match before.filter(|texture| Arc::ptr_eq(&texture.image, &image)) {
            Some(texture) => texture.clone(),
            None => Arc::new(build::texture(image, sampling)),
        };
        self.count_bytes(mip_bytes(&texture))?;
        self.assets.textures.insert(key, texture.clone());
        Ok(texture)
    }

    fn image(&mut self, source: ImageSource) -> Result<Arc<Image>, SceneError> {
        let key = source.key();
        if let Some(asset) = self.assets.images.get(&key) {
            return Ok(asset.image.clone());
        }
        let before = self.previous.and_then(|previous| previous.images.get(&key));
        let image = match before.filter(|asset| asset.source.is_like(&source)) {
            Some(asset) => asset.image.clone(),
            None => Arc::new(self.new_image(&source)?),
        };
        self.count_bytes(image.bytes())?;
        self.assets.images.insert(key, ImageAsset { source, image: image.clone() });
        Ok(image)
    }

    fn new_image(&mut self, source: &ImageSource) -> Result<Image, SceneError> {
        match source {
            ImageSource::File { name, bytes, channel: None } => {
                self.check_room(build::picture_size(name, bytes, self.limits)?.bytes())?;
                build::image(name, bytes, self.limits)
            }
            ImageSource::File { name, bytes, channel: Some(channel) } => {
                let whole = ImageSource::File { name: name.clone(), bytes: bytes.clone(), channel: None };
                Ok(self.image(whole)?.channel_as_grey(*channel))
            }
            ImageSource::Made(made, space) => Ok(build::made_image(made, *space)),
        }
    }

    /// The materials of the MTL files that `mesh` names, by name; the first of a name counts.
    pub(in crate::scene) fn mtl_materials(
        &mut self,
        mesh: &NamedMesh,
    ) -> Result<BTreeMap<String, Material>, SceneError> {
        let mut materials = BTreeMap::new();
        let file = mesh.file.as_deref();
        for library in build::libraries(&mesh.loaded.libraries, self.files) {
            let Some((name, bytes)) = self.files.find(&library.name) else {
                let detail =
                    format!("the MTL file {:?} is not there; its materials are neutral", library.name);
                self.warn(file, Some(library.line), detail);
                continue;
            };
            for described in build::mtl(name, bytes, self.limits, &mut self.warnings)? {
                if let Entry::Vacant(place) = materials.entry(described.name.clone()) {
                    place.insert(build::mtl_material(described, name, self)?);
                }
            }
        }
        Ok(materials)
    }

    /// The texture that a material of the MTL file `mtl` names; `None`, with a warning, where its
    /// file is missing.
    pub(super) fn mtl_texture(
        &mut self,
        map: &MapRef,
        mtl: &str,
        space: ColorSpace,
    ) -> Result<Option<Arc<Texture>>, SceneError> {
        let Some((name, bytes)) = self.files.find(&map.file) else {
            let detail =
                format!("the texture {:?} is not there; the surface stays plain", Files::reduce(&map.file));
            self.warn(Some(mtl), Some(map.line), detail);
            return Ok(None);
        };
        let source = ImageSource::File { name: name.to_owned(), bytes: bytes.clone(), channel: map.channel };
        let sampling = Sampling {
            color_space: space,
            filter: Filter::Trilinear,
            wrap: [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2],
            scale: map.scale,
            offset: map.offset,
        };
        let count = self.assets.textures.len();
        let texture = self.texture(source, sampling)?;
        self.assets.textures_of_files += self.assets.textures.len() - count;
        Ok(Some(texture))
    }
}

fn sampling(part: &TexturePart, color_space: ColorSpace) -> Sampling {
    Sampling { color_space, filter: part.filter, wrap: [part.wrap; 2], scale: [1.0; 2], offset: [0.0; 2] }
}
