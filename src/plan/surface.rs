//! Settling a surface: a material, reduced to what changes the picture.

use super::opacity::{Alpha, Transparency};
use super::request::Output;
use super::{Elision, Elisions, Heights, Relief, Spared, Specular, Surface};
use crate::model::{Material, Mesh, Shading, Tangents, Texture, Wrap};
use glam::Vec3;
use std::sync::{Arc, LazyLock};

/// The largest reflectance: beyond, the sum of two could be infinite, and nothing times 0 is then 0.
const LARGEST: f32 = 1e18;

/// What a colour map that is not there reads as.
static WHITE: LazyLock<Arc<Texture>> = LazyLock::new(|| Arc::new(Texture::of_one_texel([255; 4])));

/// What a normal map that is not there reads as.
static UPRIGHT: LazyLock<Arc<Texture>> =
    LazyLock::new(|| Arc::new(Texture::of_one_texel([128, 128, 255, 255])));

/// The surface that `material` makes of `mesh`, which shows through as `transparency` says and whose
/// `tangents` are there if any of its materials has a relief and it has texture coordinates. `shading`
/// overrides the material's; data outputs override both. What `elide` leaves out, the surface goes without.
#[expect(clippy::too_many_arguments, reason = "what a surface follows from")]
#[must_use]
pub fn settle(
    material: &Material,
    mesh: &Mesh,
    tangents: Option<&Arc<Tangents>>,
    receives_shadow: bool,
    shading: Option<Shading>,
    output: Output,
    elide: Elisions,
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
    let mut factors = Factors { elide, spared: Spared::default() };
    let (diffuse, diffuse_map) = factors.settle(material.diffuse, &material.diffuse_map, colored);
    let glows = emissive != Vec3::ZERO;
    let (emissive, emissive_map) = factors.settle(emissive, &material.emissive_map, glows);
    let specular = factors.specular(material, shading);
    let mut surface = Surface {
        shading,
        diffuse,
        ambient: material.ambient.map(|ambient| ambient.min(Vec3::splat(LARGEST))),
        emissive,
        specular,
        diffuse_map,
        emissive_map,
        relief: None,
        alpha: match transparency {
            Transparency::Blended(alpha) => Some(alpha.clone()),
            Transparency::Opaque | Transparency::CutOut(_) => None,
        },
        vertex_colors: mesh.colors.is_some() && shading != Shading::Normal,
        lit,
        receives_shadow,
        periodic_uv: false,
        spared: factors.spared,
    };
    if surface.needs_normal() {
        surface.relief = relief(material, tangents, elide);
        surface.spared.flat_relief = whole_relief(material, tangents).maps() - surface.relief_maps();
    }
    surface.settle_periods(material);
    surface
}

/// Settles colours and the maps that multiply them.
struct Factors {
    elide: Elisions,
    spared: Spared,
}

impl Factors {
    /// A colour and its map, as far as they are read at all.
    fn settle(
        &mut self,
        color: Vec3,
        map: &Option<Arc<Texture>>,
        is_read: bool,
    ) -> (Vec3, Option<Arc<Texture>>) {
        let color = color.min(Vec3::splat(LARGEST));
        match map {
            _ if !is_read => (color, None),
            None if self.elide.contains(Elision::AbsentMaps) => {
                self.spared.absent_maps += 1;
                (color, None)
            }
            None => (color, Some(WHITE.clone())),
            Some(map) => match map.factor().filter(|_| self.elide.contains(Elision::ConstantMaps)) {
                Some([r, g, b, _]) => {
                    self.spared.constant_maps += 1;
                    (color * Vec3::new(r, g, b), None)
                }
                None => (color, Some(map.clone())),
            },
        }
    }

    /// The highlight of a material that is shaded as `shading` says.
    fn specular(&mut self, material: &Material, shading: Shading) -> Option<Specular> {
        if shading != Shading::BlinnPhong {
            return None;
        }
        if material.specular == Vec3::ZERO && self.elide.contains(Elision::BlackSpecular) {
            self.spared.highlights = 1;
            return None;
        }
        let (color, map) = self.settle(material.specular, &material.specular_map, true);
        Some(Specular { color, shininess: material.shininess, map })
    }
}

/// What tilts the normals of `material`; `None` where its maps change none.
fn relief(material: &Material, tangents: Option<&Arc<Tangents>>, elide: Elisions) -> Option<Relief> {
    if !elide.contains(Elision::FlatRelief) {
        return Some(whole_relief(material, tangents));
    }
    let normal_map = material.normals().cloned();
    // Without texture coordinates all of the surface has one height.
    let map = material.heights().filter(|_| tangents.is_some());
    let heights = map.map(|map| Heights { map: map.clone(), scale: material.bump_scale });
    let tilts = normal_map.is_some() || heights.is_some();
    tilts.then(|| Relief { tangents: tangents.cloned(), normal_map, heights })
}

/// The same with maps that tilt nothing: at least a flat one.
fn whole_relief(material: &Material, tangents: Option<&Arc<Tangents>>) -> Relief {
    // A slope times a scale of 0 is no number where it is infinite.
    let map = material.bump_map.as_ref().filter(|_| tangents.is_some() && material.bump_scale != 0.0);
    Relief {
        tangents: tangents.cloned(),
        normal_map: Some(material.normal_map.as_ref().unwrap_or(&UPRIGHT).clone()),
        heights: map.map(|map| Heights { map: map.clone(), scale: material.bump_scale }),
    }
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
            spared: Spared::default(),
        };
        let periodic = surface.maps().all(|map| is_periodic(map));
        surface.periodic_uv = periodic;
        surface
    }

    /// Every map of the material that could be read has its say, also where it is left out: what is left out
    /// must not change how the others are rounded.
    fn settle_periods(&mut self, material: &Material) {
        let colors = [&material.diffuse_map, &material.emissive_map, &material.specular_map];
        let relief = [&material.normal_map, &material.bump_map];
        let of_color = colors.into_iter().filter(|_| self.lit || self.shading == Shading::Unlit);
        let maps = of_color.chain(relief.into_iter().filter(|_| self.needs_normal()));
        let of_alpha = self.alpha.iter().flat_map(Alpha::maps);
        let periodic = maps.flatten().chain(of_alpha).all(|map| is_periodic(map));
        self.periodic_uv = periodic;
    }
}

/// Whether whole turns of the texture coordinates change nothing.
fn is_periodic(texture: &Texture) -> bool {
    texture.wrap.iter().all(|wrap| *wrap != Wrap::Clamp)
        && texture.scale.iter().all(|scale| scale.fract() == 0.0)
}
