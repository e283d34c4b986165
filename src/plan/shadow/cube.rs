//! The six maps around a point light.

use super::casters::Caster;
use super::{Face, Filter, Notes};
use crate::math::{Bounds, Projection, View};
use crate::plan::{Item, Reason, view};
use crate::scene::Shadow;
use glam::DVec3;

/// Texels around each face beyond its 90°: a tap on the border of two faces finds its texel on either.
const GUARD_TEXELS: f64 = 2.0;

/// Casters nearer to the light than this part of the farthest one are not drawn.
const NEAREST: f64 = 1e-5;

/// The widest kernel, as the tangent of the angle from its centre to its rim: 27° to each side. A light
/// that is seen larger is beyond what one map can tell.
pub const WIDEST_TANGENT: f32 = 0.5;

/// Texels per unit of x / w on a face of `resolution` texels a side.
fn focal_length(resolution: u32) -> f64 {
    let side = f64::from(resolution);
    side * 0.5 - GUARD_TEXELS.min(side * 0.25)
}

/// Views along +x, −x, +y, −y, +z, −z from `position`: those that see a caster, and of which a receiver's
/// kernel can reach a part. The others are noted.
pub(super) fn faces(
    position: DVec3,
    casters: &[&Caster],
    receivers: &[&Item],
    shadow: &Shadow,
    filter: &Filter,
    notes: &mut Notes,
) -> Vec<Face> {
    let receive: Vec<Bounds> = receivers.iter().filter_map(|item| item.bounds()).collect();
    let Some(near) = near(position, casters) else { return Vec::new() };
    let reach = kernel_tangent(filter, focal_length(shadow.resolution), near);
    (0..6)
        .filter_map(|side| {
            let view = look_along(side, position, near, shadow.resolution);
            let seen =
                |caster: &&Caster| caster.item.bounds().is_some_and(|bounds| view::reaches(&view, bounds));
            let face = Face::new(side, view, shadow.cull, casters.iter().copied().filter(seen));
            let kernels = widened(&face.view, reach);
            let asked = receive.iter().any(|&bounds| view::reaches(&kernels, bounds));
            let without = if face.items.is_empty() {
                Some(Reason::NoCasterThere)
            } else {
                (!asked).then_some(Reason::NoReceiverThere)
            };
            let leaves_out = without.is_some_and(|reason| notes.leaves_out_side(side, reason));
            (!leaves_out).then_some(face)
        })
        .collect()
}

/// The tangent of the angle at the light between a receiver and the farthest tap of its kernel. No caster
/// is nearer than `near`.
fn kernel_tangent(filter: &Filter, focal_length: f64, near: f64) -> f64 {
    let tangent = match filter {
        Filter::Hard => 0.0,
        Filter::Pcf { radius, .. } => radius / focal_length,
        // The light's disc as the receiver sees it through the nearest blocker.
        Filter::Pcss(pcss) => {
            let search = pcss.search_radius.map_or(0.0, |radius| radius / focal_length);
            search.max(pcss.light_radius / near)
        }
    };
    tangent.min(f64::from(WIDEST_TANGENT))
}

/// A view of the same axis that sees by an angle of such a tangent more on each side.
fn widened(view: &View, tangent: f64) -> View {
    let half = f64::from(view.width) * 0.5 * 256.0 / view.scale[0];
    // tan(α + β), of at most a right angle.
    let wider = (half + tangent) / (1.0 - half * tangent).max(1e-6);
    View { scale: view.scale.map(|scale| scale * half / wider), ..*view }
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
