//! Surface descriptions.

use super::Texture;
use glam::Vec3;
use std::sync::Arc;

/// How a surface answers to light. The formulas stand in the API's "What the numbers mean".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Ambient, Lambert's cosine, and a highlight from the half vector (Blinn 1977).
    BlinnPhong,
    /// Blinn-Phong without the highlight.
    Lambert,
    /// `emissive + diffuse`.
    Unlit,
    /// The vertex colour alone.
    VertexColor,
    /// The world normal as a colour.
    Normal,
}

/// A surface. Colours are linear RGB; a map multiplies its factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// How it answers to light.
    pub shading: Shading,
    /// Diffuse reflectance.
    pub diffuse: Vec3,
    /// Specular reflectance.
    pub specular: Vec3,
    /// Exponent of the highlight, ≥ 0.
    pub shininess: f32,
    /// Reflectance of ambient light; `None`: the diffuse colour with its map.
    pub ambient: Option<Vec3>,
    /// Light it gives off.
    pub emissive: Vec3,
    /// 0 (clear) to 1 (opaque).
    pub opacity: f32,
    /// Below this alpha a fragment does not exist.
    pub alpha_cutoff: Option<f32>,
    /// Drawn from both sides, whatever the frame culls.
    pub double_sided: bool,
    /// Multiplies `diffuse`; its alpha multiplies `opacity`.
    pub diffuse_map: Option<Arc<Texture>>,
    /// Multiplies `specular`.
    pub specular_map: Option<Arc<Texture>>,
    /// Multiplies `emissive`.
    pub emissive_map: Option<Arc<Texture>>,
    /// Tangent-space normals.
    pub normal_map: Option<Arc<Texture>>,
    /// Heights.
    pub bump_map: Option<Arc<Texture>>,
    /// Height in world units at texel value 1.
    pub bump_scale: f32,
    /// Red channel multiplies `opacity`.
    pub opacity_map: Option<Arc<Texture>>,
}

impl Material {
    /// Every map it has.
    pub fn maps(&self) -> impl Iterator<Item = &Arc<Texture>> {
        let colors = [&self.diffuse_map, &self.specular_map, &self.emissive_map];
        colors.into_iter().chain([&self.normal_map, &self.bump_map, &self.opacity_map]).flatten()
    }

    /// Its normal map, unless that is flat.
    #[must_use]
    pub fn normals(&self) -> Option<&Arc<Texture>> {
        self.normal_map.as_ref().filter(|map| !map.is_flat_normal_map())
    }

    /// Its bump map, unless that is level everywhere.
    #[must_use]
    pub fn heights(&self) -> Option<&Arc<Texture>> {
        self.bump_map.as_ref().filter(|map| self.bump_scale != 0.0 && map.constant.is_none())
    }

    /// Whether any map tilts its normals.
    #[must_use]
    pub fn has_relief(&self) -> bool {
        self.normals().is_some() || self.heights().is_some()
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            shading: Shading::BlinnPhong,
            diffuse: Vec3::splat(0.8),
            specular: Vec3::ZERO,
            shininess: 32.0,
            ambient: None,
            emissive: Vec3::ZERO,
            opacity: 1.0,
            alpha_cutoff: None,
            double_sided: false,
            diffuse_map: None,
            specular_map: None,
            emissive_map: None,
            normal_map: None,
            bump_map: None,
            bump_scale: 0.02,
            opacity_map: None,
        }
    }
}
