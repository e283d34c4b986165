//! Shading: visible fragments in, linear RGB out. Each triangle is shaded once a pixel.
//!
//! Fragments come sorted by draw and triangle. A block of up to [`BLOCK`] of them goes through a
//! short sequence of kernels: interpolate, tilt normals, read maps, add lights.

pub mod alpha;
pub mod light;
pub mod relief;
pub mod texture;
pub mod varyings;
pub(super) mod weights;

use super::shadow::ShadowMap;
use crate::math::simd::*;
use crate::math::{Bounds, View};
use crate::model::Shading;
use crate::plan::Surface;
use glam::{DVec3, Vec3};
use light::{LightSource, Reflectance};
use varyings::{Records, Source, Varyings};

/// Fragments of one block.
pub const BLOCK: usize = 64;

/// The largest radiance: that of a half float, so that every format downstream can hold it.
pub const BRIGHTEST: f32 = 65504.0;

/// One triangle's share of one pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fragment {
    /// Which of the draw's records is its triangle.
    pub record: u32,
    /// Where its colour goes.
    pub target: u32,
    /// Screen x of its shading point in sub-pixels.
    pub x: i32,
    /// Screen y.
    pub y: i32,
}

/// What is the same for a whole frame.
pub struct Lighting<'a> {
    /// Ambient radiance.
    pub ambient: Vec3,
    /// Every light that shines.
    pub lights: Vec<LightSource>,
    /// The lights' shadows.
    pub maps: &'a [ShadowMap],
    /// The camera.
    pub view: &'a View,
    /// What positions are relative to: an offset from the eye, see [`anchor`].
    pub anchor: DVec3,
}

/// What positions are shaded relative to, as an offset from the eye: the point of the viewing axis that
/// is as far as the nearest corner of the scene's `bounds`, culled or not.
///
/// Seen through a narrow lens everything is far from the eye and close to everything else: there
/// f32 positions relative to the eye could not tell one pixel from the next.
#[must_use]
pub fn anchor(bounds: Option<Bounds>, view: &View) -> DVec3 {
    let corners = bounds.into_iter().flat_map(Bounds::corners);
    let distances = corners.map(|p| (p - view.eye).dot(view.forward));
    let nearest = distances.fold(f64::INFINITY, f64::min);
    if nearest.is_finite() { view.forward * nearest.max(0.0) } else { DVec3::ZERO }
}

/// Buffers of one block, kept between blocks.
pub struct Scratch {
    varyings: Varyings,
    visibility: [f32; BLOCK],
}

impl Default for Scratch {
    fn default() -> Self {
        Self { varyings: Varyings::default(), visibility: [1.0; BLOCK] }
    }
}

/// Shades up to [`BLOCK`] fragments of one draw.
pub fn shade_block(
    level: Level,
    fragments: &[Fragment],
    records: &Records,
    source: &Source,
    lighting: &Lighting,
    scratch: &mut Scratch,
    out: &mut [[f32; BLOCK]; 3],
) {
    let (count, surface) = (fragments.len(), source.surface());
    varyings::interpolate(level, records, source, fragments, &mut scratch.varyings);
    let Scratch { varyings, visibility } = scratch;
    if let Some(relief) = &surface.relief {
        relief::tilt(level, relief, varyings, count);
    }
    match surface.shading {
        Shading::VertexColor => *out = if surface.vertex_colors { varyings.color } else { [[1.0; BLOCK]; 3] },
        Shading::Normal => *out = varyings.normal.map(|axis| axis.map(normal_as_colour)),
        Shading::BlinnPhong | Shading::Lambert | Shading::Unlit => {
            let mut diffuse = [[0.0; BLOCK]; 3];
            diffuse_colour(level, surface, varyings, count, &mut diffuse);
            fill(&mut *out, surface.emissive);
            if let Some(map) = &surface.emissive_map {
                multiply(level, map, varyings, count, out);
            }
            if surface.lit {
                add_lights(level, surface, varyings, &diffuse, lighting, count, visibility, out);
            } else {
                for (sum, term) in out.iter_mut().flatten().zip(diffuse.iter().flatten()) {
                    *sum += term;
                }
            }
        }
    }
    for c in out.iter_mut().flatten() {
        // Written so that what is no number becomes 0.
        *c = if *c > 0.0 { if *c < BRIGHTEST { *c } else { BRIGHTEST } } else { 0.0 };
    }
}

/// The diffuse colour of a block, with map and vertex colours.
fn diffuse_colour(
    level: Level,
    surface: &Surface,
    varyings: &Varyings,
    count: usize,
    out: &mut [[f32; BLOCK]; 3],
) {
    fill(out, surface.diffuse);
    if let Some(map) = &surface.diffuse_map {
        multiply(level, map, varyings, count, out);
    }
    if surface.vertex_colors {
        for (factor, color) in out.iter_mut().flatten().zip(varyings.color.iter().flatten()) {
            // Infinite light would come to nothing where it meets a cosine of 0.
            *factor = (*factor * color).min(BRIGHTEST);
        }
    }
}

fn fill(out: &mut [[f32; BLOCK]; 3], color: Vec3) {
    for (channel, value) in out.iter_mut().zip(color.to_array()) {
        *channel = [value; BLOCK];
    }
}

/// Multiplies a colour by a map.
fn multiply(
    level: Level,
    map: &crate::model::Texture,
    varyings: &Varyings,
    count: usize,
    out: &mut [[f32; BLOCK]; 3],
) {
    let mut texels = [[0.0; BLOCK]; 4];
    texture::sample(level, map, &varyings.texture, count, &mut texels);
    for (channel, texel) in out.iter_mut().zip(&texels) {
        for (factor, t) in channel.iter_mut().zip(texel) {
            *factor *= t;
        }
    }
}

/// Adds ambient light and that of every light.
#[expect(clippy::too_many_arguments, reason = "the lighting sum, with all it depends on")]
fn add_lights(
    level: Level,
    surface: &Surface,
    varyings: &Varyings,
    diffuse: &[[f32; BLOCK]; 3],
    lighting: &Lighting,
    count: usize,
    visibility: &mut [f32; BLOCK],
    out: &mut [[f32; BLOCK]; 3],
) {
    let mut specular = [[0.0; BLOCK]; 3];
    let specular = surface.specular.as_ref().map(|s| {
        fill(&mut specular, s.color);
        if let Some(map) = &s.map {
            multiply(level, map, varyings, count, &mut specular);
        }
        (&specular, s.shininess)
    });
    let reflectance = Reflectance { ambient: surface.ambient, diffuse, specular };
    light::add_ambient(level, lighting.ambient, &reflectance, count, out);
    for source in &lighting.lights {
        let facing = light::facing(level, source, varyings, count);
        if facing == 0 {
            continue;
        }
        match source.shadow {
            Some(map) if surface.receives_shadow => {
                lighting.maps[map].visibility(level, &varyings.shadow[map], facing, visibility);
            }
            _ => *visibility = [1.0; BLOCK],
        }
        light::add_light(level, source, visibility, varyings, lighting, &reflectance, count, out);
    }
}

/// A normal's component as a colour: the linear value of the code that `output=normal` shows.
fn normal_as_colour(component: f32) -> f32 {
    texture::SRGB_DECODE[usize::from(normal_code(component))]
}

/// `floor(255 · (n/2 + ½) + ½)`.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float-to-integer cast saturates; NaN is 0"
)]
pub fn normal_code(component: f32) -> u8 {
    (255.0 * (component * 0.5 + 0.5) + 0.5).floor() as u8
}
