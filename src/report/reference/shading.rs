//! What a point of a surface sends to the viewer: the sum over all lights, as the API has it.

use super::light::Lamp;
use super::point::Point;
use super::{relief, texture};
use crate::math::colour::{BRIGHTEST, linear_from_srgb};
use crate::model::{Material, Shading, Texture};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// What all points are shaded with.
pub struct Lighting<'a> {
    /// Ambient radiance.
    pub ambient: DVec3,
    /// Every light that shines.
    pub lamps: Vec<Lamp<'a>>,
    /// Overrides every material.
    pub shading: Option<Shading>,
}

/// A point as it is seen.
pub struct View<'a> {
    /// The point.
    pub point: &'a Point<'a>,
    /// Unit vector towards the viewer.
    pub towards: DVec3,
    /// Whether its back is seen.
    pub is_back: bool,
}

/// Whether a point sees a light: asked for the number of the light.
pub type Visibility<'a> = &'a mut dyn FnMut(usize) -> bool;

impl Lighting<'_> {
    /// How a material answers to light.
    pub fn shading_of(&self, material: &Material) -> Shading {
        self.shading.unwrap_or(material.shading)
    }

    /// Radiance towards the viewer, linear RGB, at most [`BRIGHTEST`].
    pub fn radiance(&self, view: &View, is_seen: Visibility) -> DVec3 {
        let (point, material) = (view.point, view.point.material);
        let shading = self.shading_of(material);
        let radiance = match shading {
            Shading::VertexColor => point.color,
            Shading::Normal => normal(view).to_array().map(|n| linear_from_srgb(n / 2.0 + 0.5)).into(),
            Shading::Unlit => emissive(point) + diffuse(point),
            Shading::Lambert => self.lit(view, DVec3::ZERO, is_seen),
            Shading::BlinnPhong => self.lit(view, specular(point), is_seen),
        };
        radiance.clamp(DVec3::ZERO, DVec3::splat(f64::from(BRIGHTEST)))
    }

    /// `emissive + environment · ambient + Σ (diffuse · N·L + specular · (N·H)^shininess) · visibility ·
    /// radiance · attenuation`, over the lights with N·L > 0.
    fn lit(&self, view: &View, specular: DVec3, is_seen: Visibility) -> DVec3 {
        let (point, normal, diffuse) = (view.point, normal(view), diffuse(view.point));
        let ambient = point.material.ambient.map_or(diffuse, |ambient| ambient.as_dvec3());
        let mut sum = emissive(point) + self.ambient * ambient;
        for (number, lamp) in self.lamps.iter().enumerate() {
            let incoming = lamp.incoming(point.position);
            let cosine = normal.dot(incoming.towards);
            if cosine > 0.0 && is_seen(number) {
                let half = (incoming.towards + view.towards).normalize_or_zero();
                let lobe = lobe(normal.dot(half), f64::from(point.material.shininess));
                sum += (diffuse * cosine + specular * lobe) * lamp.radiance * incoming.attenuation;
            }
        }
        sum
    }
}

/// `cosine ^ shininess`; everywhere 1 for a shininess of 0, else 0 on the far side.
fn lobe(cosine: f64, shininess: f64) -> f64 {
    cosine.max(0.0).powf(shininess)
}

/// The normal of the side that is seen, with its relief: a back is the front turned inside out.
fn normal(view: &View) -> DVec3 {
    let front = relief::tilted(view.point);
    if view.is_back { -front } else { front }
}

fn emissive(point: &Point) -> DVec3 {
    times(point.material.emissive, point.material.emissive_map.as_ref(), point)
}

fn diffuse(point: &Point) -> DVec3 {
    times(point.material.diffuse, point.material.diffuse_map.as_ref(), point) * point.color
}

fn specular(point: &Point) -> DVec3 {
    times(point.material.specular, point.material.specular_map.as_ref(), point)
}

/// A factor and its map.
fn times(factor: Vec3, map: Option<&Arc<Texture>>, point: &Point) -> DVec3 {
    let texel = map.map_or(DVec3::ONE, |map| texture::color(map, point.uv).truncate());
    factor.as_dvec3() * texel
}

/// Whether the colour of a material is read from a map anywhere.
pub fn reads_maps(material: &Material, shading: Shading) -> bool {
    let is_colored = !matches!(shading, Shading::VertexColor | Shading::Normal);
    let is_lit = matches!(shading, Shading::BlinnPhong | Shading::Lambert);
    let of_alpha = material.opacity_map.is_some()
        || material.diffuse_map.as_ref().is_some_and(|map| map.least[3] < u8::MAX);
    let of_color = material.diffuse_map.is_some() || material.emissive_map.is_some();
    let of_highlight = shading == Shading::BlinnPhong && material.specular_map.is_some();
    let of_relief = (is_lit || shading == Shading::Normal) && material.has_relief();
    of_alpha || is_colored && of_color || of_highlight || of_relief
}
