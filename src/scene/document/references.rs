//! Names that refer to other entries of the document.

use super::reader::{Faults, clipped, suggestion, token};
use super::surfaces::MapUse;
use super::{Document, MeshPart};
use crate::model::texture::ColorSpace;
use crate::scene::Files;
use serde_json::Value;
use std::collections::BTreeMap;

/// Reports every reference to an entry that is not there.
///
/// What is there is read off the JSON: an entry with faults of its own is missing from `document`,
/// but a reference to it does not dangle.
pub(super) fn check(document: &Document, json: &Value, faults: &Faults) {
    let check = |part: &str, name: &str, pointer: String| {
        let entries = json.get(part).and_then(Value::as_object);
        if !faults.is_full() && !entries.is_some_and(|entries| entries.contains_key(name)) {
            let nearest =
                suggestion(name, entries.into_iter().flat_map(|map| map.keys()).map(String::as_str));
            faults.add(pointer, format!("there is no {:?} in {part}{nearest}", clipped(name)));
        }
    };
    for (name, material) in &document.materials {
        for map_use in MapUse::ALL {
            if let Some(texture) = material.map(map_use) {
                check("textures", texture, format!("/materials/{}/{}", token(name), map_use.field()));
            }
        }
    }
    for (name, instance) in &document.instances {
        check("meshes", &instance.mesh, format!("/instances/{}/mesh", token(name)));
        if let Some(material) = &instance.material {
            check("materials", material, format!("/instances/{}/material", token(name)));
        }
    }
}

/// Reports every model that is not among `files`. Pictures may be missing: a scene can do without.
pub(in crate::scene) fn check_files(document: &Document, files: &Files, faults: &Faults) {
    for (name, mesh) in &document.meshes {
        if let MeshPart::Obj { file } = mesh
            && !faults.is_full()
            && files.find(file).is_none()
        {
            faults.add(format!("/meshes/{}/file", token(name)), missing_file(files, file));
        }
    }
}

/// What is said of a file that is not there.
pub(in crate::scene) fn missing_file(files: &Files, path: &str) -> String {
    let name = Files::reduce(path);
    let nearest = suggestion(name, files.iter().map(|(stored, _)| stored));
    format!("there is no file {name:?} in the scene{nearest}")
}

impl Document {
    /// The colour spaces that every texture is read in: the one given; else that of each use, see
    /// [`MapUse::color_space`], and sRGB where there is none.
    #[must_use]
    pub fn color_spaces(&self) -> BTreeMap<&str, Vec<ColorSpace>> {
        let mut spaces: BTreeMap<&str, Vec<ColorSpace>> = BTreeMap::new();
        for material in self.materials.values() {
            for map_use in MapUse::ALL {
                let Some((name, part)) =
                    material.map(map_use).and_then(|name| self.textures.get_key_value(name))
                else {
                    continue;
                };
                let space = part.color_space.unwrap_or(map_use.color_space());
                let known = spaces.entry(name).or_default();
                if !known.contains(&space) {
                    known.push(space);
                }
            }
        }
        for (name, part) in &self.textures {
            spaces.entry(name).or_insert_with(|| vec![part.color_space.unwrap_or(ColorSpace::Srgb)]);
        }
        spaces
    }
}
