//! The entries of `instances`, and the `render` part.

use super::reader::Node;
use super::writer::{Fields, ToJson};
use crate::model::Shading;
use crate::scene::{Cull, Spin};
use glam::DVec3;
use serde_json::Value;

/// A mesh placed in the scene: `M = T · Rz·Ry·Rx · Spin(t) · S`.
#[derive(Clone, Debug, PartialEq)]
pub struct InstancePart {
    /// A name of `meshes`.
    pub mesh: String,
    /// A name of `materials`; `None`: those of the OBJ's MTL, else the default material.
    pub material: Option<String>,
    /// T.
    pub translation: DVec3,
    /// About x, then y, then z.
    pub rotation_deg: DVec3,
    /// S; negative mirrors, zero flattens.
    pub scale: ScalePart,
    /// Whether it is drawn.
    pub visible: bool,
    /// Whether automatic framing looks at it.
    pub framed: bool,
    /// Whether it is in shadow maps.
    pub casts_shadow: bool,
    /// Whether shadows fall on it.
    pub receives_shadow: bool,
    /// Turns by time, about an axis that is not zero and not normalised.
    pub spin: Option<Spin>,
}

/// A scale as it was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScalePart {
    /// The same in all directions.
    Uniform(f64),
    /// Along x, y and z.
    PerAxis(DVec3),
}

impl ScalePart {
    /// Along x, y and z.
    #[must_use]
    pub fn to_vector(self) -> DVec3 {
        match self {
            Self::Uniform(factor) => DVec3::splat(factor),
            Self::PerAxis(factors) => factors,
        }
    }

    fn read(node: Node) -> Option<Self> {
        if node.is_number() {
            node.coordinate().map(Self::Uniform)
        } else if node.is_array() {
            node.point().map(Self::PerAxis)
        } else {
            node.mismatch("a number or an array of 3 numbers")
        }
    }
}

impl InstancePart {
    /// `mesh` at the origin.
    #[must_use]
    pub fn of(mesh: &str) -> Self {
        Self {
            mesh: mesh.to_owned(),
            material: None,
            translation: DVec3::ZERO,
            rotation_deg: DVec3::ZERO,
            scale: ScalePart::Uniform(1.0),
            visible: true,
            framed: true,
            casts_shadow: true,
            receives_shadow: true,
            spin: None,
        }
    }

    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let mesh = o.required("mesh", Node::name);
        let instance = Self {
            material: o.optional("material", Node::name),
            translation: o.or("translation", DVec3::ZERO, Node::point),
            rotation_deg: o.or("rotation_deg", DVec3::ZERO, Node::point),
            scale: o.or("scale", ScalePart::Uniform(1.0), ScalePart::read),
            visible: o.or("visible", true, Node::flag),
            framed: o.or("framed", true, Node::flag),
            casts_shadow: o.or("casts_shadow", true, Node::flag),
            receives_shadow: o.or("receives_shadow", true, Node::flag),
            spin: o.optional("spin", spin),
            mesh: String::new(),
        };
        o.finish();
        Some(Self { mesh: mesh?, ..instance })
    }
}

fn spin(node: Node) -> Option<Spin> {
    let mut o = node.object()?;
    let axis = o.or("axis", DVec3::Y, Node::direction);
    let deg_per_s = o.required("deg_per_s", Node::coordinate);
    o.finish();
    Some(Spin { axis, deg_per_s: deg_per_s? })
}

impl ToJson for InstancePart {
    fn to_json(&self) -> Value {
        Fields::new()
            .with("mesh", &self.mesh)
            .with_some("material", self.material.as_ref())
            .with("translation", &self.translation)
            .with("rotation_deg", &self.rotation_deg)
            .with("scale", &self.scale)
            .with("visible", &self.visible)
            .with("framed", &self.framed)
            .with("casts_shadow", &self.casts_shadow)
            .with("receives_shadow", &self.receives_shadow)
            .with_some("spin", self.spin.as_ref())
            .finish()
    }
}

impl ToJson for ScalePart {
    fn to_json(&self) -> Value {
        match self {
            Self::Uniform(factor) => factor.to_json(),
            Self::PerAxis(factors) => factors.to_json(),
        }
    }
}

impl ToJson for Spin {
    fn to_json(&self) -> Value {
        Fields::new().with("axis", &self.axis).with("deg_per_s", &self.deg_per_s).finish()
    }
}

/// What a frame is drawn with unless its query says otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderPart {
    /// Pixels in a row.
    pub width: u64,
    /// Rows.
    pub height: u64,
    /// Samples a pixel: 1, 2, 4, 8 or 16.
    pub samples: u32,
    /// Whether shadows are drawn at all.
    pub shadows: bool,
    /// Overrides every material.
    pub shading: Option<Shading>,
    /// Which faces are left out; double-sided materials are exempt.
    pub cull: Cull,
    /// Scales all instances about the world's origin.
    pub model_scale: f64,
}

impl Default for RenderPart {
    fn default() -> Self {
        Self {
            width: 800,
            height: 600,
            samples: 4,
            shadows: true,
            shading: None,
            cull: Cull::Back,
            model_scale: 1.0,
        }
    }
}

impl RenderPart {
    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let default = Self::default();
        let render = Self {
            width: o.or("width", default.width, |n| n.count_from(1)),
            height: o.or("height", default.height, |n| n.count_from(1)),
            samples: o.or("samples", default.samples, Node::samples),
            shadows: o.or("shadows", default.shadows, Node::flag),
            shading: o.optional("shading", Node::one_of),
            cull: o.or("cull", default.cull, Node::one_of),
            model_scale: o.or("model_scale", default.model_scale, Node::coordinate),
        };
        o.finish();
        Some(render)
    }
}

impl ToJson for RenderPart {
    fn to_json(&self) -> Value {
        let fields = Fields::new()
            .with("width", &self.width)
            .with("height", &self.height)
            .with("samples", &self.samples)
            .with("shadows", &self.shadows);
        match self.shading {
            Some(shading) => fields.with_word("shading", shading),
            None => fields,
        }
        .with_word("cull", self.cull)
        .with("model_scale", &self.model_scale)
        .finish()
    }
}
