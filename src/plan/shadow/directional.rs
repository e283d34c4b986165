//! The map of parallel light.

use super::{Filter, orthonormal_basis};
use crate::math::{Bounds, Projection, View};
use crate::plan::Item;
use glam::DVec3;

/// A view along `direction` that holds all casters and, sideways, no more than receivers can ask for.
/// `None` if no caster can shade a receiver.
pub(super) fn fit(
    direction: DVec3,
    casters: &[&Item],
    receivers: &[&Item],
    resolution: u32,
    filter: &Filter,
) -> Option<View> {
    let (right, up) = orthonormal_basis(direction);
    // A viewer's right × up points backwards, to where the light comes from.
    let right = -right;
    let extent = |items: &[&Item]| {
        items.iter().filter_map(|item| extent_along(item, [right, up, direction])).reduce(Bounds::union)
    };
    let (cast, mut receive) = (extent(casters)?, extent(receivers)?);
    let around = kernel_reach(filter, &cast, &receive);
    receive = Bounds { min: receive.min - around, max: receive.max + around };
    let mut min = cast.min.max(DVec3::new(receive.min.x, receive.min.y, cast.min.z));
    let mut max = cast.max.min(DVec3::new(receive.max.x, receive.max.y, cast.max.z));
    if max.cmplt(min).any() {
        return None;
    }
    // Never thinner than a millionth of the casters: no division by nothing, no needle-shaped texels.
    // The receivers do not count here: a huge floor must not make small casters vanish in a texel.
    let least = ((cast.max - cast.min).max_element() * 1e-6).max(f64::MIN_POSITIVE * 1e16);
    let grow = (DVec3::splat(least) - (max - min)).max(DVec3::ZERO) * 0.5;
    (min, max) = (min - grow, max + grow);
    // A margin of texels on each side; 1 % of the depth range behind, so that no caster has depth 0.
    let texels = f64::from(resolution.max(1));
    let margin_texels = margin_texels(filter);
    let share = margin_texels / (texels - 2.0 * (margin_texels - 1.0)).max(texels * 0.5);
    let size = max - min;
    let margin = DVec3::new(size.x * share, size.y * share, size.z * 0.01);
    (min, max) = (min - margin, max + margin);
    let size = max - min;
    let centre = (min + max) * 0.5;
    Some(View {
        eye: right * centre.x + up * centre.y + direction * min.z,
        right,
        up,
        forward: direction,
        projection: Projection::Orthographic,
        scale: [texels * 256.0 / size.x, texels * 256.0 / size.y],
        near: 0.0,
        far: size.z,
        width: resolution,
        height: resolution,
    })
}

/// How far beside a receiver its shadow can be cast from, across the light, in world units.
fn kernel_reach(filter: &Filter, cast: &Bounds, receive: &Bounds) -> DVec3 {
    match filter {
        Filter::Hard | Filter::Pcf { .. } => DVec3::ZERO,
        Filter::Pcss(pcss) => {
            let reach = pcss.light_radius * (receive.max.z - cast.min.z).max(0.0);
            DVec3::new(reach, reach, 0.0)
        }
    }
}

/// Texels around the map beyond what is looked up: one, and those that a kernel of fixed size covers.
fn margin_texels(filter: &Filter) -> f64 {
    match filter {
        Filter::Hard | Filter::Pcss(_) => 1.0,
        Filter::Pcf { radius, .. } => 1.0 + radius,
    }
}

/// Bounds of an item along three axes, from the corners of its box.
fn extent_along(item: &Item, axes: [DVec3; 3]) -> Option<Bounds> {
    let corners = item.mesh.bounds?.corners().map(|p| item.linear * p + item.origin);
    Bounds::around(corners.map(|p| DVec3::from_array(axes.map(|axis| p.dot(axis)))))
}
