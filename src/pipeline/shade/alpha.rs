//! The alpha of a block of fragments.

use super::varyings::{self, Records, Source, Varyings};
use super::{BLOCK, Fragment, Scratch, texture};
use crate::math::simd::*;
use crate::plan::Alpha;

/// The alpha of up to [`BLOCK`] fragments of a surface of which nothing else is asked.
pub fn probe_block(
    level: Level,
    fragments: &[Fragment],
    records: &Records,
    source: &Source,
    scratch: &mut Scratch,
    out: &mut [f32; BLOCK],
) {
    varyings::interpolate(level, records, source, fragments, &mut scratch.varyings);
    of_shaded(level, source, fragments.len(), scratch, out);
}

/// The alpha of the `count` fragments that `scratch` shaded last.
pub fn of_shaded(level: Level, source: &Source, count: usize, scratch: &Scratch, out: &mut [f32; BLOCK]) {
    match &source.surface().alpha {
        Some(alpha) => sample(level, alpha, &scratch.varyings, count, out),
        None => *out = [1.0; BLOCK],
    }
}

/// `opacity · opacity_map · alpha of diffuse_map`.
fn sample(level: Level, alpha: &Alpha, varyings: &Varyings, count: usize, out: &mut [f32; BLOCK]) {
    *out = [alpha.opacity; BLOCK];
    let maps = [(&alpha.opacity_map, 0), (&alpha.diffuse_map, 3)];
    for (map, channel) in maps.into_iter().filter_map(|(map, channel)| Some((map.as_ref()?, channel))) {
        let mut texels = [[0.0; BLOCK]; 4];
        texture::sample(level, map, &varyings.texture, count, &mut texels);
        for (factor, texel) in out.iter_mut().zip(&texels[channel]) {
            *factor *= texel;
        }
    }
}
