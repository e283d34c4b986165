//! Materials: those of the document, those of the meshes' MTL files, and the default one.

use super::SceneError;
use crate::model::{Material, Mesh};
use crate::scene::assets::{Loader, NamedMesh, NamedTextures};
use crate::scene::document::{MapUse, MaterialPart};
use crate::scene::{Document, Warning};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Every material of a scene, and how to find them.
pub(super) struct Surfaces {
    /// Index 0 is the default material.
    pub materials: Vec<Arc<Material>>,
    /// Their names in the document; `None` for the default one and those of files.
    pub names: Vec<Option<String>>,
    /// What the client should know.
    pub warnings: Vec<Warning>,
    by_name: BTreeMap<String, u32>,
    /// For each mesh by index, the materials of its own MTL, one for each slot.
    by_mesh: Vec<Vec<u32>>,
}

/// The material of what names none.
const DEFAULT: u32 = 0;

impl Surfaces {
    /// Compiles the document's materials, and the MTL materials of meshes that are drawn with them.
    pub(super) fn compile(
        document: &Document,
        meshes: &[NamedMesh],
        loader: &mut Loader,
    ) -> Result<Self, SceneError> {
        let mut surfaces = Self {
            materials: vec![Arc::new(Material::default())],
            names: vec![None],
            warnings: Vec::new(),
            by_name: BTreeMap::new(),
            by_mesh: Vec::new(),
        };
        let textures = loader.textures(document)?;
        for (name, part) in &document.materials {
            let index = surfaces.push(Some(name), material(part, &textures));
            surfaces.by_name.insert(name.clone(), index);
        }
        let own: BTreeSet<_> = document
            .instances
            .values()
            .filter(|instance| instance.material.is_none())
            .map(|instance| instance.mesh.as_str())
            .collect();
        let mut of_files = BTreeMap::new();
        for mesh in meshes {
            let slots = match &mesh.file {
                Some(file) if own.contains(mesh.name.as_str()) => match of_files.get(file) {
                    Some(slots) => Vec::clone(slots),
                    None => {
                        let slots = surfaces.own_slots(mesh, loader)?;
                        of_files.insert(file.clone(), slots.clone());
                        slots
                    }
                },
                // What is not from a file names no materials.
                _ => vec![DEFAULT; mesh.mesh.slots.len()],
            };
            surfaces.by_mesh.push(slots);
        }
        surfaces.warn_of_missing_uvs(document, meshes);
        Ok(surfaces)
    }

    fn push(&mut self, name: Option<&String>, material: Material) -> u32 {
        let index = u32::try_from(self.materials.len()).expect("invariant: entries are limited");
        self.materials.push(Arc::new(material));
        self.names.push(name.cloned());
        index
    }

    /// The MTL materials of `mesh`, one for each slot.
    fn own_slots(&mut self, mesh: &NamedMesh, loader: &mut Loader) -> Result<Vec<u32>, SceneError> {
        let named = loader.mtl_materials(mesh)?;
        let mut slots = Vec::with_capacity(mesh.mesh.slots.len());
        for (i, slot) in mesh.mesh.slots.iter().enumerate() {
            let index = match slot.as_ref().map(|name| (name, named.get(name))) {
                None => DEFAULT,
                Some((_, Some(material))) => self.push(None, material.clone()),
                Some((name, None)) => {
                    let line = mesh.loaded.slot_lines.get(i).copied().flatten();
                    let detail = format!("no MTL file has the material {name:?}; it is neutral");
                    loader.warn(mesh.file.as_deref(), line, detail);
                    DEFAULT
                }
            };
            slots.push(index);
        }
        Ok(slots)
    }

    /// One material for each slot of the mesh at `index`.
    pub(super) fn slots(&self, given: Option<&str>, index: usize, mesh: &Mesh) -> Vec<u32> {
        match given {
            Some(name) => {
                vec![self.by_name.get(name).copied().unwrap_or(DEFAULT); mesh.slots.len()]
            }
            None => self.by_mesh[index].clone(),
        }
    }

    /// Warns of maps on meshes that have no texture coordinates to read them at.
    fn warn_of_missing_uvs(&mut self, document: &Document, meshes: &[NamedMesh]) {
        for (name, instance) in &document.instances {
            let Ok(index) = meshes.binary_search_by(|loaded| loaded.name.as_str().cmp(&instance.mesh)) else {
                continue;
            };
            let mesh = &meshes[index].mesh;
            let slots = self.slots(instance.material.as_deref(), index, mesh);
            if mesh.uvs.is_none() && slots.iter().any(|&slot| has_maps(&self.materials[slot as usize])) {
                let detail = format!(
                    "instance {name:?}: the mesh {:?} has no texture coordinates; its maps are read at (0, 0)",
                    instance.mesh
                );
                self.warnings.push(Warning { file: None, line: None, detail });
            }
        }
    }
}

fn has_maps(material: &Material) -> bool {
    let maps = [
        &material.diffuse_map,
        &material.specular_map,
        &material.emissive_map,
        &material.normal_map,
        &material.bump_map,
        &material.opacity_map,
    ];
    maps.into_iter().any(Option::is_some)
}

fn material(part: &MaterialPart, textures: &NamedTextures) -> Material {
    let map = |map_use: MapUse| textures.get(part.map(map_use)?, map_use.color_space()).cloned();
    Material {
        shading: part.shading,
        diffuse: part.diffuse.to_linear(),
        specular: part.specular.to_linear(),
        shininess: narrowed(part.shininess),
        ambient: part.ambient.as_ref().map(|ambient| ambient.to_linear()),
        emissive: part.emissive.to_linear(),
        opacity: narrowed(part.opacity),
        alpha_cutoff: part.alpha_cutoff.map(narrowed),
        double_sided: part.double_sided,
        diffuse_map: map(MapUse::Diffuse),
        specular_map: map(MapUse::Specular),
        emissive_map: map(MapUse::Emissive),
        normal_map: map(MapUse::Normal),
        bump_map: map(MapUse::Bump),
        bump_scale: narrowed(part.bump_scale),
        opacity_map: map(MapUse::Opacity),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is meant; the check keeps it in f32's range"
)]
fn narrowed(n: f64) -> f32 {
    n as f32
}
