//! What is drawn: instances placed in the scene, and the surface of each of their material slots.

use super::opacity::{Alpha, AlphaTest, Opacity};
use crate::math::Bounds;
use crate::model::{Mesh, Shading, Tangents, Texture};
use crate::scene::{Cull, Instance, Scene};
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// One instance as the geometry stage draws it.
#[derive(Clone, Debug)]
pub struct Item {
    /// What to draw.
    pub mesh: Arc<Mesh>,
    /// Linear part of model → anchored space.
    pub linear: DMat3,
    /// Anchored position of the mesh's stored zero.
    pub origin: DVec3,
    /// Whether the placement turns right hands into left ones, so that fronts wind clockwise. It
    /// cannot be told from a `linear` that flattens.
    pub mirrored: bool,
    /// For each of the mesh's slots: what becomes of its triangles; `None`: they are left out.
    pub slots: Vec<Option<Slot>>,
}

impl Item {
    /// Places `instance` as it is at time `t` (seconds).
    #[must_use]
    pub fn new(scene: &Scene, instance: &Instance, t: f64, slots: Vec<Option<Slot>>) -> Self {
        let mesh = scene.mesh(instance).clone();
        let linear = instance.linear(t);
        let origin = instance.origin(&mesh, linear);
        Self { mesh, linear, origin, mirrored: instance.is_mirrored(), slots }
    }

    /// Whether both put the same triangles in the same place.
    #[must_use]
    pub fn places_the_triangles_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.linear == other.linear
            && self.origin == other.origin
            && self.slots == other.slots
    }

    /// Around it, anchored; `None` for a mesh without vertices.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        Some(self.mesh.bounds?.transformed(self.linear, self.origin))
    }

    /// Working memory that drawing it takes, about: 25 bytes a vertex; 64 a triangle and as many for its
    /// entries in tiles; and a list of tiles. What is blended may lie in one pixel with all of its
    /// triangles, each an entry to sort: 112 bytes at 16 samples, in eight pixels at a time.
    #[must_use]
    pub fn frame_bytes(&self) -> u64 {
        let is_blended = self.slots.iter().flatten().any(|slot| slot.opacity == Opacity::Blended);
        let a_triangle = 128 + if is_blended { 8 * 112 } else { 0 };
        self.mesh.vertex_count() as u64 * 25 + self.mesh.triangles.len() as u64 * a_triangle + 6144
    }

    /// Takes model-space normals to normals in world axes, whatever the scale: the cofactor matrix,
    /// which is the inverse transpose up to a factor and exists for a singular matrix too; negated
    /// under a mirror, so that what points out stays out. Source: E. Lengyel, "Transforming
    /// Normals", 2024.
    #[must_use]
    pub fn world_from_normal(&self) -> DMat3 {
        let (a, b, c) = (self.linear.x_axis, self.linear.y_axis, self.linear.z_axis);
        let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b));
        if self.mirrored { -cofactors } else { cofactors }
    }
}

/// What becomes of the triangles of one material slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Index into the plan's draws: what shades it.
    pub draw: u32,
    /// Which faces are left out.
    pub cull: Cull,
    /// How they meet what lies behind them.
    pub opacity: Opacity,
}

/// One material on one instance, reduced to what changes its picture.
#[derive(Clone, Debug)]
pub struct Draw {
    /// Index into the plan's items.
    pub item: u32,
    /// Index into the scene's instances.
    pub instance: u32,
    /// Index into the slots of its mesh.
    pub slot: u32,
    /// How it is shaded.
    pub surface: Surface,
    /// Which of its fragments exist; `None`: all.
    pub alpha_test: Option<AlphaTest>,
}

/// The variant of the shading kernels that a draw needs. What is `None` or zero is not computed.
#[derive(Clone, Debug)]
pub struct Surface {
    /// How it answers to light.
    pub shading: Shading,
    /// Diffuse reflectance; vertex colours and map multiply it.
    pub diffuse: Vec3,
    /// `None`: ambient light meets the diffuse colour.
    pub ambient: Option<Vec3>,
    /// Its own light.
    pub emissive: Vec3,
    /// The highlight; `None` where the material or its shading has none.
    pub specular: Option<Specular>,
    /// Multiplies `diffuse`.
    pub diffuse_map: Option<Arc<Texture>>,
    /// Multiplies `emissive`.
    pub emissive_map: Option<Arc<Texture>>,
    /// What tilts its normals; `None` where nothing does, or where no normal is read.
    pub relief: Option<Relief>,
    /// How much of it there is, where it is blended; `None`: 1.
    pub alpha: Option<Alpha>,
    /// Whether vertex colours are read.
    pub vertex_colors: bool,
    /// Whether lights fall on it.
    pub lit: bool,
    /// Whether shadows fall on it.
    pub receives_shadow: bool,
    /// Whether whole turns of u or v change nothing, because every map repeats or mirrors.
    pub periodic_uv: bool,
    /// What each of its fragments is spared.
    pub spared: Spared,
}

/// What elisions spare each fragment of a surface, in their units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spared {
    /// Maps that are not there.
    pub absent_maps: u64,
    /// Maps of one colour that became factors.
    pub constant_maps: u64,
    /// Relief maps that tilt nothing.
    pub flat_relief: u64,
    /// Highlights of no colour, under each light.
    pub highlights: u64,
}

/// A highlight.
#[derive(Clone, Debug)]
pub struct Specular {
    /// Specular reflectance.
    pub color: Vec3,
    /// Exponent.
    pub shininess: f32,
    /// Multiplies `color`.
    pub map: Option<Arc<Texture>>,
}

/// Detail finer than triangles: maps that tilt a surface's normal. At least one of the two is there; a
/// surface with both has the heights on top of what the normal map makes of it.
#[derive(Clone, Debug)]
pub struct Relief {
    /// How texture coordinates lie on the mesh; `None` where it has none.
    pub tangents: Option<Arc<Tangents>>,
    /// Normals in tangent space.
    pub normal_map: Option<Arc<Texture>>,
    /// A height map.
    pub heights: Option<Heights>,
}

/// A height map.
#[derive(Clone, Debug)]
pub struct Heights {
    /// Its red channel.
    pub map: Arc<Texture>,
    /// Height in world units at texel value 1; not zero.
    pub scale: f32,
}

impl Relief {
    /// How many maps are read.
    #[must_use]
    pub fn maps(&self) -> u64 {
        u64::from(self.normal_map.is_some()) + u64::from(self.heights.is_some())
    }
}

impl Surface {
    /// How many maps of colours are read.
    #[must_use]
    pub fn color_maps(&self) -> u64 {
        let specular = self.specular.as_ref().and_then(|s| s.map.as_ref());
        let maps = [self.diffuse_map.as_ref(), self.emissive_map.as_ref(), specular];
        maps.iter().flatten().count() as u64
    }

    /// How many maps of its relief are read.
    #[must_use]
    pub fn relief_maps(&self) -> u64 {
        self.relief.as_ref().map_or(0, Relief::maps)
    }

    /// Whether any map is read.
    #[must_use]
    pub fn needs_uv(&self) -> bool {
        self.maps().next().is_some()
    }

    /// Every map that is read.
    pub fn maps(&self) -> impl Iterator<Item = &Arc<Texture>> {
        let specular = self.specular.as_ref().and_then(|s| s.map.as_ref());
        let normals = self.relief.as_ref().and_then(|relief| relief.normal_map.as_ref());
        let heights = self.relief.as_ref().and_then(|relief| relief.heights.as_ref());
        let of_color = [self.diffuse_map.as_ref(), self.emissive_map.as_ref(), specular];
        let of_relief = [normals, heights.map(|heights| &heights.map)];
        let of_alpha = self.alpha.iter().flat_map(Alpha::maps);
        of_color.into_iter().chain(of_relief).flatten().chain(of_alpha)
    }

    /// Whether it is read how much of the texture's coordinates a world unit is: by heights.
    #[must_use]
    pub fn needs_uv_per_world(&self) -> bool {
        self.relief.as_ref().is_some_and(|relief| relief.heights.is_some())
    }

    /// Whether the interpolated normal is read.
    #[must_use]
    pub fn needs_normal(&self) -> bool {
        self.lit || self.shading == Shading::Normal
    }
}
