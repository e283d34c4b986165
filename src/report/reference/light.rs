//! Lights: from where and how strongly they shine on a point, and whether it sees them.

use super::bvh::Ray;
use super::point::Point;
use super::world::World;
use crate::scene::{Light, LightKind, Scene, Shadow, ShadowFilter};
use glam::DVec3;
use std::f64::consts::TAU;

/// A light that shines.
pub struct Lamp<'a> {
    kind: LightKind,
    /// Linear RGB.
    pub radiance: DVec3,
    /// `None`: it casts no shadow.
    shadow: Option<&'a Shadow>,
}

/// Light that arrives at a point.
pub struct Incoming {
    /// Unit vector towards the light's centre.
    pub towards: DVec3,
    /// The share of its radiance that is left at this distance.
    pub attenuation: f64,
}

/// How far off a surface a ray to a light begins, as a part of its triangle's size: enough for the point
/// not to shade itself, and no more.
const OFFSET: f64 = 1e-9;

/// The same as a part of the point's coordinates: a few roundings of theirs.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl<'a> Lamp<'a> {
    /// Every light of a scene that shines.
    pub fn all(scene: &'a Scene) -> Vec<Self> {
        let shines = |light: &&Light| light.enabled && light.radiance != glam::Vec3::ZERO;
        let lamp = |light: &'a Light| Self {
            kind: light.kind,
            radiance: light.radiance.as_dvec3(),
            shadow: light.shadow.as_ref().filter(|_| scene.render.shadows),
        };
        scene.lights.iter().filter(shines).map(lamp).collect()
    }

    /// What arrives at a place if nothing is in the way.
    pub fn incoming(&self, position: DVec3) -> Incoming {
        match self.kind {
            LightKind::Directional { direction } => Incoming { towards: -direction, attenuation: 1.0 },
            LightKind::Point { position: lamp, attenuation: a } => {
                let distance = lamp.distance(position);
                let falloff = a.constant + a.linear * distance + a.quadratic * distance * distance;
                let towards = (lamp - position).normalize_or_zero();
                Incoming { towards, attenuation: 1.0 / falloff.max(1e-6) }
            }
        }
    }

    /// Whether a point sees the place of the light that `chance` in [0, 1)² picks; `None` if the light
    /// casts no shadow there.
    pub fn is_seen(&self, world: &World, point: &Point, chance: [f64; 2]) -> Option<bool> {
        let shadow = self.shadow.filter(|_| point.instance.receives_shadow)?;
        Some(world.is_lit(&self.ray(shadow, point, chance), shadow.cull))
    }

    /// The ray from just off a point to a place of the light: its centre, or for PCSS one of a disc.
    fn ray(&self, shadow: &Shadow, point: &Point, chance: [f64; 2]) -> Ray {
        let radius = if shadow.filter == ShadowFilter::Pcss { shadow.light_radius } else { 0.0 };
        let towards = self.incoming(point.position).towards;
        let aside = on_disc(towards, chance) * radius;
        let side = 1.0_f64.copysign(point.geometric.dot(towards));
        let offset = OFFSET * point.extent + ROUNDING * point.position.abs().max_element();
        let origin = point.position + point.geometric * (side * offset);
        match self.kind {
            // As wide as a disc at distance 1.
            LightKind::Directional { .. } => {
                Ray { origin, direction: towards + aside, nearest: 0.0, farthest: f64::INFINITY }
            }
            LightKind::Point { position, .. } => {
                Ray { origin, direction: position + aside - origin, nearest: 0.0, farthest: 1.0 }
            }
        }
    }
}

/// A point of the unit disc around zero that faces along the unit vector `axis`; evenly spread over it as
/// `chance` is over the unit square.
fn on_disc(axis: DVec3, chance: [f64; 2]) -> DVec3 {
    let (radius, angle) = (chance[0].sqrt(), chance[1] * TAU);
    let (a, b) = axis.any_orthonormal_pair();
    (a * angle.cos() + b * angle.sin()) * radius
}
