//! Lights and their shadows.

use crate::model::normals::unit;
use crate::scene::document::{LightKindPart, LightPart, ShadowPart};
use crate::scene::{Document, Light, LightKind, Shadow};
use glam::DVec3;

/// Every light in order of name, switched off ones too.
pub(super) fn compile(document: &Document, anchor: DVec3) -> Vec<Light> {
    document.lights.iter().map(|(name, part)| light(name, part, anchor)).collect()
}

fn light(name: &str, part: &LightPart, anchor: DVec3) -> Light {
    Light {
        name: name.to_owned(),
        enabled: part.enabled,
        radiance: part.color.scaled(part.intensity),
        kind: match part.kind {
            LightKindPart::Directional { direction } => {
                // Documents have no direction that is zero.
                LightKind::Directional { direction: unit(direction).unwrap_or(DVec3::NEG_Y) }
            }
            LightKindPart::Point { position, attenuation } => {
                LightKind::Point { position: position - anchor, attenuation }
            }
        },
        shadow: part.shadow.as_ref().and_then(shadow),
    }
}

/// `None` where the filter is `none`.
fn shadow(part: &ShadowPart) -> Option<Shadow> {
    let small = |n: u64| u32::try_from(n).expect("invariant: checked against the limits");
    Some(Shadow {
        filter: part.filter?,
        resolution: small(part.resolution),
        bias: part.bias,
        radius: part.radius,
        pcf_taps: small(part.pcf_taps),
        light_radius: part.light_radius,
        search_radius: part.search_radius,
        search_taps: small(part.search_taps),
        filter_taps: small(part.filter_taps),
        cull: part.cull,
    })
}
