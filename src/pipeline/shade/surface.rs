//! The pixel shaders of a scene's surfaces.

use super::light::{self, LightSource, Reflectance};
use super::varyings::{self, Records, Source, Varyings};
use super::{BLOCK, Fragment, Lighting, Scratch, alpha, relief, texture};
use crate::math::colour::{BRIGHTEST, SRGB_DECODE};
use crate::math::simd::*;
use crate::model::{self, Texture};
use crate::pipeline::shader::{Outputs, PixelShader, Shading, Visible};
use crate::plan::{Elision, Surface, Tally, Unit};
use glam::Vec3;

/// A surface under the lights of its scene: writes its radiance and its alpha to target 0.
pub struct SurfaceShader<'a> {
    /// The surface and where it is.
    pub source: Source<'a>,
    /// The lights.
    pub lighting: &'a Lighting<'a>,
}

/// The holes of a surface: writes no colours, and discards what is less opaque than a cut-off.
pub struct HoleShader<'a> {
    /// A surface of alpha alone, and where it is.
    pub source: Source<'a>,
    /// The least alpha that is there.
    pub cutoff: f32,
}

/// A run of fragments with the records of their triangles.
struct Run<'a, T> {
    of: &'a T,
    records: Records,
}

impl<'a, T> Run<'a, T>
where
    Self: Shading,
{
    fn open(
        of: &'a T,
        source: &Source,
        triangles: &mut dyn Iterator<Item = Visible<'a>>,
    ) -> Box<dyn Shading + 'a> {
        let mut records = Records::new(source);
        triangles.for_each(|visible| records.push(source, visible));
        Box::new(Self { of, records })
    }
}

impl PixelShader for SurfaceShader<'_> {
    fn open<'a>(&'a self, triangles: &mut dyn Iterator<Item = Visible<'a>>) -> Box<dyn Shading + 'a> {
        Run::open(self, &self.source, triangles)
    }
}

impl Shading for Run<'_, SurfaceShader<'_>> {
    fn shade(&mut self, level: Level, fragments: &[Fragment], scratch: &mut Scratch, out: &mut Outputs) {
        let SurfaceShader { source, lighting } = self.of;
        let (color, rest) = out.colors[0].split_first_chunk_mut().expect("a colour has four channels");
        shade_block(level, fragments, &self.records, source, lighting, scratch, color);
        alpha::of_shaded(level, source, fragments.len(), scratch, &mut rest[0]);
        out.discarded = 0;
    }
}

impl PixelShader for HoleShader<'_> {
    fn open<'a>(&'a self, triangles: &mut dyn Iterator<Item = Visible<'a>>) -> Box<dyn Shading + 'a> {
        Run::open(self, &self.source, triangles)
    }
}

impl Shading for Run<'_, HoleShader<'_>> {
    fn shade(&mut self, level: Level, fragments: &[Fragment], scratch: &mut Scratch, out: &mut Outputs) {
        let mut alpha = [0.0; BLOCK];
        alpha::probe_block(level, fragments, &self.records, &self.of.source, scratch, &mut alpha);
        let holes = alpha.iter().enumerate().filter(|(_, alpha)| **alpha < self.of.cutoff);
        out.discarded = holes.fold(0, |bits, (i, _)| bits | 1 << i);
    }
}

/// Shades up to [`BLOCK`] fragments of one draw: interpolate, tilt normals, read maps, add lights.
fn shade_block(
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
    let Scratch { varyings, visibility, tally } = scratch;
    count_samples(surface, count as u64, tally);
    if let Some(relief) = &surface.relief {
        relief::tilt(level, relief, varyings, count);
    }
    match surface.shading {
        model::Shading::VertexColor => {
            *out = if surface.vertex_colors { varyings.color } else { [[1.0; BLOCK]; 3] }
        }
        model::Shading::Normal => *out = varyings.normal.map(|axis| axis.map(normal_as_colour)),
        model::Shading::BlinnPhong | model::Shading::Lambert | model::Shading::Unlit => {
            let mut diffuse = [[0.0; BLOCK]; 3];
            diffuse_colour(level, surface, varyings, count, &mut diffuse);
            fill(&mut *out, surface.emissive);
            if let Some(map) = &surface.emissive_map {
                multiply(level, map, varyings, count, out);
            }
            if surface.lit {
                add_lights(level, surface, varyings, &diffuse, lighting, count, (visibility, tally), out);
            } else {
                for (sum, term) in out.iter_mut().flatten().zip(diffuse.iter().flatten()) {
                    *sum += term;
                }
            }
        }
    }
    bound(level, count, out);
}

/// Bounds radiance to 0–[`BRIGHTEST`]; what is no number becomes 0.
fn bound(level: Level, count: usize, out: &mut [[f32; BLOCK]; 3]) {
    dispatch!(level, simd => {
        let (zero, brightest) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, BRIGHTEST));
        for channel in out {
            for eight in channel[..count.next_multiple_of(LANES)].chunks_exact_mut(LANES) {
                min(max(f32x8::from_slice(simd, eight), zero), brightest).store_slice(eight);
            }
        }
    });
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
fn multiply(level: Level, map: &Texture, varyings: &Varyings, count: usize, out: &mut [[f32; BLOCK]; 3]) {
    let mut texels = [[0.0; BLOCK]; 4];
    texture::sample(level, map, &varyings.texture, count, &mut texels);
    dispatch!(level, simd => {
        for (channel, texels) in out.iter_mut().zip(&texels) {
            for at in (0..count).step_by(LANES) {
                let factor = f32x8::from_slice(simd, &texels[at..at + LANES]);
                let color = &mut channel[at..at + LANES];
                (f32x8::from_slice(simd, color) * factor).store_slice(color);
            }
        }
    });
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
    (visibility, tally): (&mut [f32; BLOCK], &mut Tally),
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
        let is_faced = match source.shadow.filter(|_| surface.receives_shadow) {
            None => {
                *visibility = [1.0; BLOCK];
                true
            }
            Some(map) => {
                ask_map(level, source, map, varyings, lighting, count, (&mut *visibility, &mut *tally))
            }
        };
        let looked_at = if is_faced {
            light::add_light(level, source, visibility, varyings, lighting, &reflectance, count, out)
        } else {
            0
        };
        count_light(surface, looked_at as u64, count as u64, tally);
    }
}

/// Asks a shadow map for the visibility of its light; false if no fragment asks.
fn ask_map(
    level: Level,
    source: &LightSource,
    map: usize,
    varyings: &Varyings,
    lighting: &Lighting,
    count: usize,
    (visibility, tally): (&mut [f32; BLOCK], &mut Tally),
) -> bool {
    let asked = asking(level, source, varyings, lighting, count);
    if asked == 0 {
        return false;
    }
    let taps = lighting.maps[map].visibility(level, &varyings.shadow[map], asked, visibility);
    tally.count(Unit::Lookups, u64::from(asked.count_ones()));
    tally.count(Unit::Taps, taps.done);
    tally.spare(Elision::DecidedTaps, taps.spared);
    true
}

/// One bit for each fragment of a block that asks whether it is in a light's shadow.
fn asking(level: Level, source: &LightSource, varyings: &Varyings, lighting: &Lighting, count: usize) -> u64 {
    if lighting.elide.contains(Elision::TurnedAway) {
        light::facing(level, source, varyings, count)
    } else {
        u64::MAX >> (BLOCK - count)
    }
}

/// Counts a block's texture samples, and those it is spared.
fn count_samples(surface: &Surface, count: u64, tally: &mut Tally) {
    let spared = &surface.spared;
    tally.count(Unit::ColorSamples, surface.color_maps() * count);
    tally.spare(Elision::AbsentMaps, spared.absent_maps * count);
    tally.spare(Elision::ConstantMaps, spared.constant_maps * count);
    tally.count(Unit::ReliefSamples, surface.relief_maps() * count);
    tally.spare(Elision::FlatRelief, spared.flat_relief * count);
}

/// Counts the light on a block of which `lit` fragments were looked at.
fn count_light(surface: &Surface, lit: u64, count: u64, tally: &mut Tally) {
    tally.count(Unit::LitFragments, lit);
    tally.spare(Elision::TurnedAway, count - lit);
    tally.count(Unit::Highlights, u64::from(surface.specular.is_some()) * lit);
    tally.spare(Elision::BlackSpecular, surface.spared.highlights * lit);
}

/// A normal's component as a colour: the linear value of the code that `output=normal` shows.
fn normal_as_colour(component: f32) -> f32 {
    SRGB_DECODE[usize::from(normal_code(component))]
}

/// `floor(255 · (n/2 + ½) + ½)`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float-to-integer cast saturates; NaN is 0"
)]
fn normal_code(component: f32) -> u8 {
    (255.0 * (component * 0.5 + 0.5) + 0.5).floor() as u8
}
