//! The vertex stage: clip space to snapped screen space, in f64, each vertex once.

use super::Primitives;
use crate::math::Viewport;
use crate::math::simd::*;
use crate::pipeline::shader::{ClipBlock, VERTEX_BLOCK};
use crate::pipeline::work::{Cancelled, Work};
use std::ops::Range;

/// The guard band in sub-pixels: the largest coordinate of a 24.8 number inside ±32,768 px.
pub const GUARD: f64 = 8_388_607.0;

/// Where triangles are cut: what lies within snaps to [`GUARD`] at most, and what lies there but for
/// the rounding of its projection is left whole.
pub const GUARD_PLANE: f64 = GUARD + 0.25;

/// Where a vertex lies. A triangle whose vertices share one of the first six bits is invisible; one
/// with any of [`outcode::CLIP`] must be cut.
pub mod outcode {
    /// Left of the viewport.
    pub const LEFT: u8 = 1;
    /// Right of it.
    pub const RIGHT: u8 = 2;
    /// Above it.
    pub const ABOVE: u8 = 4;
    /// Below it.
    pub const BELOW: u8 = 8;
    /// Before the near plane.
    pub const NEAR: u8 = 16;
    /// Beyond the far plane.
    pub const FAR: u8 = 32;
    /// Outside the guard band, or not a number.
    pub const GUARD: u8 = 64;
    /// Outside the view volume, as far as it can be told from single vertices.
    pub const OUTSIDE: u8 = LEFT | RIGHT | ABOVE | BELOW | NEAR | FAR;
    /// Reasons to clip.
    pub const CLIP: u8 = NEAR | FAR | GUARD;
}

/// The vertices of one item in screen space. Values of a vertex with an [`outcode::CLIP`] bit are
/// meaningless.
#[derive(Debug, Default)]
pub struct ScreenVertices {
    /// Snapped screen x: whole sub-pixels, exact in f64.
    pub x: Vec<f64>,
    /// Snapped screen y, down.
    pub y: Vec<f64>,
    /// Depth, 1 at the near plane; linear in screen space.
    pub depth: Vec<f64>,
    /// Bits of [`outcode`].
    pub outcode: Vec<u8>,
}

/// Vertices of one task: a multiple of [`VERTEX_BLOCK`].
const CHUNK_VERTICES: usize = 8192;

/// Runs the vertex shaders of `all` and snaps what they give.
///
/// # Errors
/// [`Cancelled`].
pub fn transform(
    all: &[Primitives],
    viewport: &Viewport,
    work: &Work,
) -> Result<Vec<ScreenVertices>, Cancelled> {
    let tasks = all.iter().flat_map(|primitives| {
        let count = primitives.vertex_count;
        (0..count)
            .step_by(CHUNK_VERTICES)
            .map(move |from| (primitives, from..count.min(from + CHUNK_VERTICES)))
    });
    let parts = work.map(tasks.collect(), ClipBlock::default, |block, (primitives, range)| {
        transform_range(work.level, primitives, range, viewport, block)
    })?;
    let mut parts = parts.into_iter();
    Ok(all.iter().map(|primitives| join(&mut parts, primitives.vertex_count)).collect())
}

/// Joins the parts of one item; most meshes are a single part.
fn join(parts: &mut impl Iterator<Item = ScreenVertices>, count: usize) -> ScreenVertices {
    let Some(mut all) = (count > 0).then(|| parts.next()).flatten() else { return ScreenVertices::default() };
    while all.x.len() < count {
        let part = parts.next().expect("the parts cover all vertices");
        all.x.extend_from_slice(&part.x);
        all.y.extend_from_slice(&part.y);
        all.depth.extend_from_slice(&part.depth);
        all.outcode.extend_from_slice(&part.outcode);
    }
    all
}

fn transform_range(
    level: Level,
    primitives: &Primitives,
    range: Range<usize>,
    viewport: &Viewport,
    block: &mut ClipBlock,
) -> ScreenVertices {
    let padded = range.len().next_multiple_of(LANES);
    let mut out = ScreenVertices {
        x: vec![0.0; padded],
        y: vec![0.0; padded],
        depth: vec![0.0; padded],
        outcode: vec![0; padded],
    };
    let number = |vertex: usize| u32::try_from(vertex).expect("a mesh has fewer than 2³² vertices");
    for from in range.clone().step_by(VERTEX_BLOCK) {
        let to = range.end.min(from + VERTEX_BLOCK);
        primitives.vertices.positions(level, number(from)..number(to), block);
        let first = from - range.start;
        dispatch!(level, simd => snap_block(simd, block, to - from, viewport, &mut out, first));
    }
    out.x.truncate(range.len());
    out.y.truncate(range.len());
    out.depth.truncate(range.len());
    out.outcode.truncate(range.len());
    out
}

/// Divides, maps to the viewport and snaps `count` positions, to index `first` and on.
#[inline(always)]
fn snap_block<S: Simd>(
    simd: S,
    block: &ClipBlock,
    count: usize,
    viewport: &Viewport,
    out: &mut ScreenVertices,
    first: usize,
) {
    let [half_w, half_h] = viewport.half_extent();
    for at in (0..count).step_by(LANES) {
        let load = always(
            #[inline(always)]
            |component: &[f64; VERTEX_BLOCK]| f64x8::from_slice(simd, &component[at..at + LANES]),
        );
        let zero = f64x8::splat(simd, 0.0);
        // Homogeneous screen position: (x, y) / w, in sub-pixels, y down.
        let (x, y) = (load(&block.x) * half_w, zero - load(&block.y) * half_h);
        let (z, w) = (load(&block.z), load(&block.w));
        let to = first + at..first + at + LANES;
        ((x / w + 0.5).floor()).store_slice(&mut out.x[to.clone()]);
        ((y / w + 0.5).floor()).store_slice(&mut out.y[to.clone()]);
        (z / w).store_slice(&mut out.depth[to.clone()]);

        let (limit_x, limit_y, guard) = (w * half_w, w * half_h, w * GUARD_PLANE);
        let inside_guard = x.abs().simd_le(guard) & y.abs().simd_le(guard);
        let codes = [
            (x.simd_lt(zero - limit_x), outcode::LEFT),
            (x.simd_gt(limit_x), outcode::RIGHT),
            (y.simd_lt(zero - limit_y), outcode::ABOVE),
            (y.simd_gt(limit_y), outcode::BELOW),
            (z.simd_gt(w), outcode::NEAR),
            (z.simd_lt(w * viewport.farthest), outcode::FAR),
            (!inside_guard, outcode::GUARD),
        ];
        for (mask, bit) in codes {
            let mask = mask.to_bitmask();
            // Most vertices have no bit at all.
            for lane in 0..if mask == 0 { 0 } else { LANES } {
                out.outcode[to.start + lane] |= if mask >> lane & 1 == 1 { bit } else { 0 };
            }
        }
    }
}
