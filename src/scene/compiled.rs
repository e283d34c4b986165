//! The compiled scene: immutable, checked, ready to be planned.

use super::document::PostEffect;
use crate::math::Bounds;
use crate::math::angle::rotation_about_deg;
use crate::model::sky::{CubeMap, Daylight, Panorama};
use crate::model::{Material, Mesh, Shading, Tangents};
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// A checked scene.
///
/// Everything here lives in *anchored space*: world space minus [`Scene::anchor`]. The anchor lies
/// at the scene, so a scene far from the world's origin loses no digits, and one moved as a whole
/// by an exactly representable offset gives the same bytes.
#[derive(Clone, Debug)]
pub struct Scene {
    /// World position of the zero of anchored space.
    pub anchor: DVec3,
    /// As the document gives it, anchored.
    pub camera: Camera,
    /// Ambient radiance, linear RGB.
    pub ambient: Vec3,
    /// What is drawn where nothing else is.
    pub background: Background,
    /// Named alternatives to `background`, in order of name.
    pub backgrounds: Vec<(String, Background)>,
    /// Every light in order of name, switched off ones too.
    pub lights: Vec<Light>,
    /// Every mesh in order of name.
    pub meshes: Vec<Arc<Mesh>>,
    /// Tangents of those meshes that are drawn with a relief and have texture coordinates.
    pub tangents: Vec<Option<Arc<Tangents>>>,
    /// Names of `meshes`.
    pub mesh_names: Vec<String>,
    /// Every material that an instance can refer to.
    pub materials: Vec<Arc<Material>>,
    /// Names of `materials` in the document; the default one has none, nor do those of files.
    pub material_names: Vec<Option<String>>,
    /// In order of name, which is the submission order; hidden ones too.
    pub instances: Vec<Instance>,
    /// Effects on the finished picture, in order.
    pub post: Vec<PostEffect>,
    /// The document's `render` part.
    pub render: RenderDefaults,
    /// What the client should know but what stops nothing.
    pub warnings: Vec<Warning>,
    /// A hash of the document but for its name, and of its files.
    pub content: [u8; 32],
}

/// Something about an input that is not as its author meant it, yet draws.
#[derive(Clone, Debug, PartialEq, Eq, Hash, serde::Serialize)]
pub struct Warning {
    /// The file it is in; absent for the document itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line in that file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    /// What was found and what happens instead.
    pub detail: String,
}

/// The document's camera. `None` means "framed automatically" (`position`) or "as the projection
/// has it" (`far`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands, anchored.
    pub position: Option<DVec3>,
    /// What it looks at, anchored; `None` where the document names none.
    pub target: Option<DVec3>,
    /// The direction that is up in the picture; not zero.
    pub up: DVec3,
    /// Perspective or orthographic.
    pub lens: Lens,
    /// Nearest view-space distance drawn, > 0; `None` where the document names none (0.1, or fitted
    /// by automatic framing).
    pub near: Option<f64>,
    /// Farthest view-space distance drawn; `None` is infinite.
    pub far: Option<f64>,
    /// Turns about the target, by time.
    pub orbit_deg_per_s: f64,
}

/// The shape of the view volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Full vertical opening angle in degrees, in (0, 180).
    Perspective {
        /// The angle.
        fov_y_deg: f64,
    },
    /// Full height of the view in world units.
    Orthographic {
        /// The height.
        height: f64,
    },
}

/// What is drawn where nothing else is. Colours are linear RGB.
///
/// Its `Debug` form tells any two backgrounds of one scene content apart: entity tags are made from it.
#[derive(Clone, Debug, PartialEq)]
pub enum Background {
    /// One colour.
    Color(Vec3),
    /// `mix(bottom, top, 1/2 + e/180°)` by the elevation e of the view ray.
    Gradient {
        /// Straight up.
        top: Vec3,
        /// Straight down.
        bottom: Vec3,
    },
    /// A procedural sky.
    Sky(Arc<Daylight>),
    /// Six pictures.
    CubeMap(Arc<CubeMap>),
    /// An equirectangular picture.
    Panorama(Arc<Panorama>),
    /// Alpha 0.
    Transparent,
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the document.
    pub name: String,
    /// Whether it shines.
    pub enabled: bool,
    /// `color · intensity`, linear RGB.
    pub radiance: Vec3,
    /// Where its light comes from.
    pub kind: LightKind,
    /// `None`: it casts no shadow.
    pub shadow: Option<Shadow>,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From infinitely far.
    Directional {
        /// The way the light travels, a unit vector.
        direction: DVec3,
    },
    /// From a point.
    Point {
        /// Where it is, anchored.
        position: DVec3,
        /// How it fades with distance.
        attenuation: Attenuation,
    },
}

/// `1 / max(constant + linear·d + quadratic·d², 1e-6)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attenuation {
    /// At distance 0.
    pub constant: f64,
    /// Per world unit.
    pub linear: f64,
    /// Per world unit squared.
    pub quadratic: f64,
}

/// How a light's shadow is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// How the map is read.
    pub filter: ShadowFilter,
    /// Texels along a side of the map (of each face, for a point light).
    pub resolution: u32,
    /// Multiple of the offset that is just enough; 1 is the derived offset, 0 none.
    pub bias: f64,
    /// PCF kernel radius in texels.
    pub radius: f64,
    /// PCF taps.
    pub pcf_taps: u32,
    /// PCSS: tangent of the half-angle (directional) or radius in world units (point).
    pub light_radius: f64,
    /// PCSS blocker search radius in texels; `None`: from `light_radius`.
    pub search_radius: Option<f64>,
    /// PCSS blocker taps.
    pub search_taps: u32,
    /// PCSS filter taps.
    pub filter_taps: u32,
    /// Which faces cast.
    pub cull: ShadowCull,
}

/// How a shadow map is read. `filter: "none"` compiles to no [`Shadow`] at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowFilter {
    /// One tap.
    Hard,
    /// A disc of taps of fixed size.
    Pcf,
    /// A disc whose size follows the distance to the blocker.
    Pcss,
}

/// Which faces are left out of a shadow map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowCull {
    /// All faces cast.
    None,
    /// Front faces do not cast.
    Front,
    /// Back faces do not cast.
    Back,
}

/// A mesh placed in the scene: `M = T · Rz·Ry·Rx · Spin(t) · S`.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Its name in the document.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// One material (index into [`Scene::materials`]) for each of the mesh's slots.
    pub materials: Vec<u32>,
    /// T, anchored: where model-space zero goes. `render.model_scale` is in it.
    pub translation: DVec3,
    /// Rz·Ry·Rx.
    pub rotation: DMat3,
    /// S; negative mirrors, zero flattens. `render.model_scale` is in it.
    pub scale: DVec3,
    /// Turns by time, between rotation and scale.
    pub spin: Option<Spin>,
    /// Around the vertices after [`Instance::linear`] at time 0, so relative to
    /// [`Instance::origin`]; `None`: the bounds are those of the mesh's turned box.
    pub extent: Option<Bounds>,
    /// Whether it is drawn.
    pub visible: bool,
    /// Whether automatic framing looks at it.
    pub framed: bool,
    /// Whether it is in shadow maps.
    pub casts_shadow: bool,
    /// Whether shadows fall on it.
    pub receives_shadow: bool,
}

/// A right-handed turn by time in the instance's own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// A unit vector.
    pub axis: DVec3,
    /// Speed.
    pub deg_per_s: f64,
}

/// The document's `render` part; a frame query overrides it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderDefaults {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples a pixel: 1, 2, 4, 8 or 16.
    pub samples: u32,
    /// Whether shadows are drawn at all.
    pub shadows: bool,
    /// Overrides every material.
    pub shading: Option<Shading>,
    /// Which faces are left out; double-sided materials are exempt.
    pub cull: Cull,
}

/// Which faces a frame leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cull {
    /// Back faces.
    Back,
    /// Front faces.
    Front,
    /// None.
    None,
}

impl Instance {
    /// The linear part of `M` at time `t` (seconds): `R · Spin(t) · S`.
    #[must_use]
    pub fn linear(&self, t: f64) -> DMat3 {
        let turned = match self.spin {
            None => self.rotation,
            Some(spin) => self.rotation * rotation_about_deg(spin.axis, t * spin.deg_per_s),
        };
        turned * DMat3::from_diagonal(self.scale)
    }

    /// Whether an odd number of axes is mirrored. An axis that is flattened is not.
    #[must_use]
    pub fn is_mirrored(&self) -> bool {
        self.scale.to_array().iter().filter(|&&s| s < 0.0).count() % 2 == 1
    }

    /// Where the mesh's stored zero goes, anchored: `linear · mesh.origin + T`.
    #[must_use]
    pub fn origin(&self, mesh: &Mesh, linear: DMat3) -> DVec3 {
        linear * mesh.origin + self.translation
    }

    /// Bounds at time `t`, anchored; `None` for a mesh without vertices.
    #[must_use]
    pub fn bounds(&self, mesh: &Mesh, t: f64) -> Option<Bounds> {
        let linear = self.linear(t);
        let origin = self.origin(mesh, linear);
        let at_rest = self.spin.is_none() || t == 0.0;
        match self.extent {
            Some(extent) if at_rest => Some(extent.translated(origin)),
            // A turning instance: no smaller box is worth transforming every vertex in every frame.
            _ => Some(mesh.bounds?.transformed(linear, origin)),
        }
    }
}

impl Scene {
    /// The mesh of `instance`.
    #[must_use]
    pub fn mesh(&self, instance: &Instance) -> &Arc<Mesh> {
        &self.meshes[instance.mesh as usize]
    }

    /// The tangents of `instance`'s mesh, if it has any.
    #[must_use]
    pub fn tangents(&self, instance: &Instance) -> Option<&Arc<Tangents>> {
        self.tangents[instance.mesh as usize].as_ref()
    }

    /// Instances that are drawn, with their index, in submission order.
    pub fn visible(&self) -> impl Iterator<Item = (usize, &Instance)> {
        self.instances.iter().enumerate().filter(|(_, instance)| instance.visible)
    }

    /// Whether its pictures change with time.
    #[must_use]
    pub fn moves(&self) -> bool {
        let turns = |instance: &Instance| instance.spin.is_some_and(|spin| spin.deg_per_s != 0.0);
        self.camera.orbit_deg_per_s != 0.0 || self.visible().any(|(_, instance)| turns(instance))
    }

    /// Around all visible instances at time `t`, anchored; `None` if nothing can be seen.
    #[must_use]
    pub fn bounds(&self, t: f64) -> Option<Bounds> {
        self.bounds_where(t, |_| true)
    }

    /// What automatic framing looks at: around the visible instances that are framed at time 0,
    /// anchored; around all visible ones where none of them is.
    #[must_use]
    pub fn framed_bounds(&self) -> Option<Bounds> {
        self.bounds_where(0.0, |instance| instance.framed).or_else(|| self.bounds(0.0))
    }

    fn bounds_where(&self, t: f64, counts: impl Fn(&Instance) -> bool) -> Option<Bounds> {
        self.visible()
            .filter(|(_, instance)| counts(instance))
            .filter_map(|(_, instance)| instance.bounds(self.mesh(instance), t))
            .reduce(Bounds::union)
    }
}
