//! Settling a surface: a material, reduced to what changes the picture.

use super::request::Output;
use super::{Specular, Surface};
use crate::model::{Material, Mesh, Shading, Texture, Wrap};
use glam::Vec3;
use std::sync::Arc;

/// The surface that `material` makes of `mesh`. `shading` overrides the material's; data outputs
/// override both.
#[must_use]
pub fn settle(
    material: &Material,
    mesh: &Mesh,
    receives_shadow: bool,
    shading: Option<Shading>,
    output: Output,
) -> Surface {
    let shading = match output {
        Output::Color | Output::Radiance => shading.unwrap_or(material.shading),
        Output::Normal => Shading::Normal,
        // The diffuse colour alone; what depth and instances show needs no colour at all.
        Output::Albedo | Output::Depth | Output::Instance | Output::Wireframe => Shading::Unlit,
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
        vertex_colors: mesh.colors.is_some() && shading != Shading::Normal,
        lit,
        receives_shadow,
        periodic_uv: false,
    };
    let periodic = surface.maps().all(|map| is_periodic(map));
    surface.periodic_uv = periodic;
    surface
}

/// Whether whole turns of the texture coordinates change nothing.
fn is_periodic(texture: &Texture) -> bool {
    texture.wrap.iter().all(|wrap| *wrap != Wrap::Clamp)
        && texture.scale.iter().all(|scale| scale.fract() == 0.0)
}
