//! The scene document: what a client writes, checked and with its defaults filled in.
//!
//! In: JSON. Out: a [`Document`] whose every number is in range and whose every name refers to
//! something, or all faults at once. What depends on files or on [`crate::limits::Limits`] is checked when the
//! document is compiled.

mod camera;
mod color;
mod environment;
mod instances;
mod lights;
mod meshes;
pub(crate) mod names;
mod post;
mod reader;
mod references;
mod surfaces;
pub mod words;
mod writer;

#[cfg(test)]
pub(crate) mod tests;

pub use camera::{CameraPart, DEFAULT_NEAR, MAX_FOV_Y_DEG, MIN_FOV_Y_DEG};
pub use color::{Color, srgb_codes};
pub use environment::{BackgroundChoice, BackgroundPart, EnvironmentPart, FACES};
pub use instances::{InstancePart, RenderPart, ScalePart};
pub use lights::{LightKindPart, LightPart, ShadowPart, default_lights};
pub use meshes::{MeshPart, Triangles};
pub use post::{PostEffect, TonemapOperator};
pub use surfaces::{MapUse, MaterialPart, TexturePart, TextureSource};

pub(in crate::scene) use reader::{Faults, clipped};
pub(crate) use reader::{suggestion, token};
pub(in crate::scene) use references::{check_files, missing_file};

use super::Files;
use reader::Node;
use serde_json::Value;
use std::collections::BTreeMap;
use writer::Fields;

/// One thing that is wrong with a document.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Fault {
    /// JSON pointer (RFC 6901) to the value.
    pub pointer: String,
    /// What must hold and what is there: `must lie in [0.001, 179.9], is 200`.
    pub detail: String,
}

/// A scene document with its defaults filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// For people; may be empty.
    pub name: String,
    /// Where the picture is taken from.
    pub camera: CameraPart,
    /// Ambient light and background.
    pub environment: EnvironmentPart,
    /// Lights by name.
    pub lights: BTreeMap<String, LightPart>,
    /// Textures by name.
    pub textures: BTreeMap<String, TexturePart>,
    /// Materials by name.
    pub materials: BTreeMap<String, MaterialPart>,
    /// Meshes by name.
    pub meshes: BTreeMap<String, MeshPart>,
    /// Instances by name.
    pub instances: BTreeMap<String, InstancePart>,
    /// Effects in the order they are applied.
    pub post: Vec<PostEffect>,
    /// What a frame is drawn with unless its query says otherwise.
    pub render: RenderPart,
}

impl Default for Document {
    /// The document `{}`.
    fn default() -> Self {
        Self {
            name: String::new(),
            camera: CameraPart::default(),
            environment: EnvironmentPart::default(),
            lights: default_lights(),
            textures: BTreeMap::new(),
            materials: BTreeMap::new(),
            meshes: BTreeMap::new(),
            instances: BTreeMap::new(),
            post: Vec::new(),
            render: RenderPart::default(),
        }
    }
}

impl Document {
    /// Reads and checks a document.
    ///
    /// # Errors
    /// Every fault that can be told from the document alone, in the document's order.
    pub fn from_json(json: &Value) -> Result<Self, Vec<Fault>> {
        Self::checked(json, Vec::new(), None)
    }

    /// Like [`Document::from_json`], for a document that comes with `files`: a model that is not
    /// among them is a fault beside the others.
    ///
    /// # Errors
    /// As for [`Document::from_json`].
    pub fn from_json_with_files(json: &Value, files: &Files) -> Result<Self, Vec<Fault>> {
        Self::checked(json, Vec::new(), Some(files))
    }

    /// Like [`Document::from_json_with_files`], for what a merge patch has made.
    ///
    /// `carried` are pointers of members that stayed behind where the patch changed an object's
    /// `type`: they are dropped where the new type does not know them.
    ///
    /// # Errors
    /// As for [`Document::from_json`].
    pub fn from_patched(json: &Value, carried: Vec<String>, files: &Files) -> Result<Self, Vec<Fault>> {
        Self::checked(json, carried, Some(files))
    }

    fn checked(json: &Value, carried: Vec<String>, files: Option<&Files>) -> Result<Self, Vec<Fault>> {
        let faults = Faults::tolerating(carried);
        let document = Self::read(Node::root(json, &faults));
        if let Some(document) = &document {
            references::check(document, json, &faults);
            if let Some(files) = files {
                references::check_files(document, files, &faults);
            }
        }
        let faults = faults.into_vec();
        document.filter(|_| faults.is_empty()).ok_or(faults)
    }

    fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let document = Self {
            name: o.or("name", String::new(), Node::text),
            camera: o.or("camera", CameraPart::default(), CameraPart::read),
            environment: o.or("environment", EnvironmentPart::default(), EnvironmentPart::read),
            lights: o.optional("lights", |n| n.map_of(LightPart::read)).unwrap_or_else(default_lights),
            textures: o.or("textures", BTreeMap::new(), |n| n.map_of(TexturePart::read)),
            materials: o.or("materials", BTreeMap::new(), |n| n.map_of(MaterialPart::read)),
            meshes: o.or("meshes", BTreeMap::new(), |n| n.map_of(MeshPart::read)),
            instances: o.or("instances", BTreeMap::new(), |n| n.map_of(InstancePart::read)),
            post: o.or("post", Vec::new(), |n| {
                let effects: Vec<_> = n.items()?.into_iter().map(PostEffect::read).collect();
                effects.into_iter().collect()
            }),
            render: o.or("render", RenderPart::default(), RenderPart::read),
        };
        o.finish();
        Some(document)
    }

    /// The document with its defaults filled in, fields in a fixed order, entries in order of name.
    /// Reading it back gives an equal document.
    #[must_use]
    pub fn to_json(&self) -> Value {
        Fields::new()
            .with("name", &self.name)
            .with("camera", &self.camera)
            .with("environment", &self.environment)
            .with("lights", &self.lights)
            .with("textures", &self.textures)
            .with("materials", &self.materials)
            .with("meshes", &self.meshes)
            .with("instances", &self.instances)
            .with("post", &self.post)
            .with("render", &self.render)
            .finish()
    }
}
