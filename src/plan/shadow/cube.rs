//! The six maps around a point light.

use super::Face;
use super::casters::Caster;
use crate::math::{Bounds, Projection, View};
use crate::plan::{Item, view};
use glam::DVec3;

/// Texels around each face beyond its 90°: a tap on the border of two faces finds its texel on either.
const GUARD_TEXELS: f64 = 2.0;

/// Casters nearer to the light than this part of the farthest one are not drawn.
const NEAREST: f64 = 1e-5;

/// Texels per unit of x / w on a face of `resolution` texels a side.
fn focal_length(resolution: u32) -> f64 {
    let side = f64::from(resolution);
    side * 0.5 - GUARD_TEXELS.min(side * 0.25)
}

/// Views along +x, −x, +y, −y, +z, −z from `position`: those that see a caster and a receiver.
pub(super) fn faces(position: DVec3, casters: &[&Caster], receivers: &[&Item], resolution: u32) -> Vec<Face> {
    let receive: Vec<Bounds> = receivers.iter().filter_map(|item| item.bounds()).collect();
    let Some(near) = near(position, casters) else { return Vec::new() };
    (0..6)
        .filter_map(|side| {
            let view = look_along(side, position, near, resolution);
            let seen =
                |caster: &&Caster| caster.item.bounds().is_some_and(|bounds| view::reaches(&view, bounds));
            let face = Face::new(side, view, casters.iter().copied().filter(seen));
            let asked = receive.iter().any(|&bounds| view::reaches(&view, bounds));
            (asked && !face.items.is_empty()).then_some(face)
        })
        .collect()
}

/// The view through one side of the cube: for the axis i, to the right is ± axis i + 2, up axis i + 1.
fn look_along(side: usize, position: DVec3, near: f64, resolution: u32) -> View {
    let axis = side / 2;
    let sign = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
    let unit = |axis: usize| DVec3::AXES[axis % 3];
    View {
        eye: position,
        right: unit(axis + 2) * sign,
        up: unit(axis + 1),
        forward: unit(axis) * sign,
        projection: Projection::Perspective,
        scale: [focal_length(resolution) * 256.0; 2],
        near,
        far: f64::INFINITY,
        width: resolution,
        height: resolution,
    }
}

/// A distance along any axis before which no caster lies, or next to nothing of the farthest one.
/// Reversed depth loses no digits by a near plane that is near.
fn near(position: DVec3, casters: &[&Caster]) -> Option<f64> {
    let boxes = || casters.iter().filter_map(|caster| caster.item.bounds());
    let nearest = boxes().map(|b| (b.min - position).max(position - b.max).max_element());
    let farthest = boxes().map(|b| (b.max - position).max(position - b.min).max_element());
    let (nearest, farthest) = (nearest.reduce(f64::min)?, farthest.reduce(f64::max)?);
    let near = (nearest * 0.99).max(farthest * NEAREST);
    (near > 0.0 && near.is_finite()).then_some(near)
}
