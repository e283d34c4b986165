//! Settling a surface: a material, reduced to what changes the picture.

use super::opacity::{Alpha, Transparency};
use super::request::Output;
use super::{Heights, Relief, Specular, Surface};
use crate::model::{Material, Mesh, Shading, Tangents, Texture, Wrap};
use glam::Vec3;
use std::sync::Arc;

/// The surface that `material` makes of `mesh`, which shows through as `transparency` says and whose
/// `tangents` are there if any of its materials has a relief and it has texture coordinates. `shading`
/// overrides the material's; data outputs override both.
#[must_use]
pub fn settle(
    material: &Material,
    mesh: &Mesh,
    tangents: Option<&Arc<Tangents>>,
    receives_shadow: bool,
    shading: Option<Shading>,
    output: Output,
    transparency: &Transparency,
) -> Surface {
    let shading = match output {
        // Which lights have shadows follows from what they light.
        Output::Color | Output::Radiance | Output::ShadowMap => shading.unwrap_or(material.shading),
        Output::Normal => Shading::Normal,
        // The diffuse colour alone; the others need no colour at all.
        Output::Albedo | Output::Depth | Output::Instance | Output::Wireframe => Shading::Unlit,
        Output::Ids | Output::Tiles | Output::Shaded => Shading::Unlit,
    };
    let lit = matches!(shading, Shading::BlinnPhong | Shading::Lambert);
    let colored = lit || shading == Shading::Unlit;
    let emissive = if colored && output.is_shaded() { material.emissive } else { Vec3::ZERO };
    let map = |map: &Option<Arc<Texture>>, needed: bool| map.clone().filter(|_| needed);
    let specular = (shading == Shading::BlinnPhong && material.specular != Vec3::ZERO).then(|| Specular {
        color: material.specular,
        shininess: material.shininess,
        map: material.specular_map.clone(),
    });
    let mut surface = Surface {
        shading,
        diffuse: material.diffuse,
        ambient: material.ambient,
        emissive,
        specular,
        diffuse_map: map(&material.diffuse_map, colored),
        emissive_map: map(&material.emissive_map, emissive != Vec3::ZERO),
        relief: None,
        alpha: match transparency {
            Transparency::Blended(alpha) => Some(alpha.clone()),
            Transparency::Opaque | Transparency::CutOut(_) => None,
        },
        vertex_colors: mesh.colors.is_some() && shading != Shading::Normal,
        lit,
        receives_shadow,
        periodic_uv: false,
    };
    if surface.needs_normal() {
        surface.relief = relief(material, tangents);
    }
    surface.settle_periods();
    surface
}

/// What tilts the normals of `material`; `None` where its maps change none.
fn relief(material: &Material, tangents: Option<&Arc<Tangents>>) -> Option<Relief> {
    let normal_map = material.normals().cloned();
    // Without texture coordinates all of the surface has one height.
    let map = material.heights().filter(|_| tangents.is_some());
    let heights = map.map(|map| Heights { map: map.clone(), scale: material.bump_scale });
    let tilts = normal_map.is_some() || heights.is_some();
    tilts.then(|| Relief { tangents: tangents.cloned(), normal_map, heights })
}

impl Surface {
    /// A surface that has `alpha` and nothing else: what an alpha test reads.
    #[must_use]
    pub fn of_alpha(alpha: Alpha) -> Self {
        let mut surface = Self {
            shading: Shading::Unlit,
            diffuse: Vec3::ZERO,
            ambient: None,
            emissive: Vec3::ZERO,
            specular: None,
            diffuse_map: None,
            emissive_map: None,
            relief: None,
            alpha: Some(alpha),
            vertex_colors: false,
            lit: false,
            receives_shadow: false,
            periodic_uv: false,
        };
        surface.settle_periods();
        surface
    }

    fn settle_periods(&mut self) {
        let periodic = self.maps().all(|map| is_periodic(map));
        self.periodic_uv = periodic;
    }
}

/// Whether whole turns of the texture coordinates change nothing.
fn is_periodic(texture: &Texture) -> bool {
    texture.wrap.iter().all(|wrap| *wrap != Wrap::Clamp)
        && texture.scale.iter().all(|scale| scale.fract() == 0.0)
}
