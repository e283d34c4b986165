//! The entries of `meshes`.

use super::reader::{Node, Object};
use super::writer::{Fields, ToJson};
use serde_json::Value;
use std::sync::Arc;

/// A mesh: a shape, a file, or triangles in the document itself. Sizes are in model units.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshPart {
    /// Centred on the origin.
    Box {
        /// Along x, y and z.
        size: [f64; 3],
    },
    /// In x and z, facing +y.
    Plane {
        /// Along x and z.
        size: [f64; 2],
        /// How often a texture repeats along x and z.
        uv_repeat: [f64; 2],
    },
    /// Poles on the y axis.
    Sphere {
        /// Its radius.
        radius: f64,
        /// Around the axis, ≥ 3.
        segments: u64,
        /// From pole to pole, ≥ 2.
        rings: u64,
    },
    /// Around the y axis.
    Torus {
        /// From the axis to the tube's centre.
        radius: f64,
        /// The tube's own radius.
        tube: f64,
        /// Around the axis, ≥ 3.
        segments: u64,
        /// Around the tube, ≥ 3.
        sides: u64,
    },
    /// Closed, around the y axis.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Along y.
        height: f64,
        /// Around the axis, ≥ 3.
        segments: u64,
    },
    /// Closed, its apex up.
    Cone {
        /// At the base.
        radius: f64,
        /// Along y.
        height: f64,
        /// Around the axis, ≥ 3.
        segments: u64,
    },
    /// The Utah teapot.
    Teapot {
        /// Along y.
        height: f64,
        /// Along a side of each patch, ≥ 1.
        segments: u64,
    },
    /// An OBJ file.
    Obj {
        /// Its name.
        file: String,
    },
    /// Written out.
    Triangles(Arc<Triangles>),
}

/// Triangles that stand in the document itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// In model space.
    pub positions: Vec<[f64; 3]>,
    /// `None`: 0, 1, 2, …
    pub indices: Option<Vec<[u32; 3]>>,
    /// `None`: smooth up to a crease of 60°.
    pub normals: Option<Vec<[f64; 3]>>,
    /// v up.
    pub uvs: Option<Vec<[f64; 2]>>,
    /// Linear RGB, ≥ 0.
    pub colors: Option<Vec<[f64; 3]>>,
}

const TYPES: [&str; 9] =
    ["box", "plane", "sphere", "torus", "cylinder", "cone", "teapot", "obj", "triangles"];

impl MeshPart {
    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let kind = o.required("type", |n| n.tag(&TYPES))?;
        let mesh = Self::read_kind(kind, &mut o);
        o.finish();
        mesh
    }

    fn read_kind(kind: &str, o: &mut Object) -> Option<Self> {
        Some(match kind {
            "box" => Self::Box { size: o.or("size", [1.0; 3], Node::size) },
            "plane" => Self::Plane {
                size: o.or("size", [1.0; 2], Node::size),
                uv_repeat: o.or("uv_repeat", [1.0; 2], Node::vector),
            },
            "sphere" => Self::Sphere {
                radius: length(o, "radius", 0.5),
                segments: count(o, "segments", 64, 3),
                rings: count(o, "rings", 32, 2),
            },
            "torus" => Self::Torus {
                radius: length(o, "radius", 0.5),
                tube: length(o, "tube", 0.2),
                segments: count(o, "segments", 64, 3),
                sides: count(o, "sides", 32, 3),
            },
            "cylinder" => Self::Cylinder {
                radius: length(o, "radius", 0.5),
                height: length(o, "height", 1.0),
                segments: count(o, "segments", 64, 3),
            },
            "cone" => Self::Cone {
                radius: length(o, "radius", 0.5),
                height: length(o, "height", 1.0),
                segments: count(o, "segments", 64, 3),
            },
            "teapot" => {
                Self::Teapot { height: length(o, "height", 1.0), segments: count(o, "segments", 8, 1) }
            }
            "obj" => Self::Obj { file: o.required("file", Node::file)? },
            _ => Self::Triangles(Arc::new(Triangles::read(o)?)),
        })
    }
}

fn length(o: &mut Object, name: &'static str, default: f64) -> f64 {
    o.or(name, default, Node::not_negative)
}

fn count(o: &mut Object, name: &'static str, default: u64, min: u32) -> u64 {
    o.or(name, default, |n| n.count_from(min))
}

impl Triangles {
    fn read(o: &mut Object) -> Option<Self> {
        let positions = o.required("positions", Node::tuples::<3>);
        let end = positions.as_ref().map_or(usize::MAX, Vec::len);
        let triangles = Self {
            indices: o.optional("indices", |n| n.triangle_indices(end)),
            normals: o.optional("normals", Node::tuples),
            uvs: o.optional("uvs", Node::tuples),
            colors: o.optional("colors", Node::tuples),
            positions: positions?,
        };
        triangles.check_lengths(o);
        let vertices = triangles.positions.len();
        // Indices with faults of their own are still indices.
        if !o.has("indices") && !vertices.is_multiple_of(3) {
            o.fault_at(
                "positions",
                format!("without indices, must hold three positions a triangle, holds {vertices}"),
            );
        }
        if triangles.colors.iter().flatten().flatten().any(|&channel| channel < 0.0) {
            o.fault_at("colors", "must be at least 0 in every channel");
        }
        Some(triangles)
    }

    fn check_lengths(&self, o: &Object) {
        let vertices = self.positions.len();
        let lengths = [
            ("normals", self.normals.as_ref().map(Vec::len)),
            ("uvs", self.uvs.as_ref().map(Vec::len)),
            ("colors", self.colors.as_ref().map(Vec::len)),
        ];
        for (field, length) in lengths {
            if let Some(length) = length.filter(|&length| length != vertices) {
                o.fault_at(
                    field,
                    format!("must hold one element for each of the {vertices} positions, holds {length}"),
                );
            }
        }
    }
}

impl ToJson for MeshPart {
    fn to_json(&self) -> Value {
        match self {
            Self::Box { size } => Fields::of_type("box").with("size", size),
            Self::Plane { size, uv_repeat } => {
                Fields::of_type("plane").with("size", size).with("uv_repeat", uv_repeat)
            }
            Self::Sphere { radius, segments, rings } => Fields::of_type("sphere")
                .with("radius", radius)
                .with("segments", segments)
                .with("rings", rings),
            Self::Torus { radius, tube, segments, sides } => Fields::of_type("torus")
                .with("radius", radius)
                .with("tube", tube)
                .with("segments", segments)
                .with("sides", sides),
            Self::Cylinder { radius, height, segments } => Fields::of_type("cylinder")
                .with("radius", radius)
                .with("height", height)
                .with("segments", segments),
            Self::Cone { radius, height, segments } => Fields::of_type("cone")
                .with("radius", radius)
                .with("height", height)
                .with("segments", segments),
            Self::Teapot { height, segments } => {
                Fields::of_type("teapot").with("height", height).with("segments", segments)
            }
            Self::Obj { file } => Fields::of_type("obj").with("file", file),
            Self::Triangles(triangles) => Fields::of_type("triangles")
                .with("positions", &triangles.positions)
                .with_some("indices", triangles.indices.as_ref())
                .with_some("normals", triangles.normals.as_ref())
                .with_some("uvs", triangles.uvs.as_ref())
                .with_some("colors", triangles.colors.as_ref()),
        }
        .finish()
    }
}
