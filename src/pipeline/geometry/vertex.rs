//! The vertex stage: model space to snapped screen space, in f64, each vertex once.

use crate::math::simd::*;
use crate::math::{Projection, View};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::Item;
use glam::{DMat3, DVec3};

/// The guard band in sub-pixels: the largest coordinate of a 24.8 number inside ±32,768 px.
pub const GUARD: f64 = 8_388_607.0;

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

/// From a mesh's stored positions to view space: `linear · p + offset` is (x, y, w).
#[derive(Clone, Copy, Debug)]
pub struct ViewFromModel {
    /// Linear part.
    pub linear: DMat3,
    /// View-space position of the stored zero.
    pub offset: DVec3,
}

impl ViewFromModel {
    /// Composes the item's placement with the view. The camera is subtracted before anything is
    /// rotated, so a scene far from the origin loses nothing.
    #[must_use]
    pub fn new(item: &Item, view: &View) -> Self {
        let view_from_world = view.view_from_world();
        Self { linear: view_from_world * item.linear, offset: view_from_world * (item.origin - view.eye) }
    }

    /// View-space (x, y, w) of a stored position.
    #[must_use]
    pub fn apply(&self, p: DVec3) -> DVec3 {
        let (a, b, c) = (self.linear.x_axis, self.linear.y_axis, self.linear.z_axis);
        // The same order of sums as the kernel below: a clipped triangle meets its unclipped
        // neighbour at the very same vertices.
        let row = |i: usize| ((a[i] * p.x + b[i] * p.y) + c[i] * p.z) + self.offset[i];
        DVec3::new(row(0), row(1), row(2))
    }
}

/// Vertices of one task.
const CHUNK_VERTICES: usize = 8192;

/// Transforms the vertices of every item.
///
/// # Errors
/// [`Cancelled`].
pub fn transform(items: &[Item], view: &View, work: &Work) -> Result<Vec<ScreenVertices>, Cancelled> {
    let tasks = items.iter().flat_map(|item| {
        let from_model = ViewFromModel::new(item, view);
        let count = item.mesh.vertex_count();
        (0..count)
            .step_by(CHUNK_VERTICES)
            .map(move |from| (item, from_model, from..count.min(from + CHUNK_VERTICES)))
    });
    let parts = work.map(
        tasks.collect(),
        || (),
        |(), (item, from_model, range)| {
            let positions = [0, 1, 2].map(|axis| &item.mesh.positions[axis][range.clone()]);
            dispatch!(work.level, simd => transform_kernel(simd, positions, &from_model, view))
        },
    )?;
    let mut parts = parts.into_iter();
    Ok(items.iter().map(|item| join(&mut parts, item.mesh.vertex_count())).collect())
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

#[inline(always)]
fn transform_kernel<S: Simd>(
    simd: S,
    positions: [&[f64]; 3],
    from_model: &ViewFromModel,
    view: &View,
) -> ScreenVertices {
    let count = positions[0].len();
    let padded = count.next_multiple_of(LANES);
    let mut out = ScreenVertices {
        x: vec![0.0; padded],
        y: vec![0.0; padded],
        depth: vec![0.0; padded],
        outcode: vec![0; padded],
    };
    let mut tail = [[0.0; LANES]; 3];
    for at in (0..count).step_by(LANES) {
        let p = if at + LANES <= count {
            let load = always(
                #[inline(always)]
                |axis: usize| f64x8::from_slice(simd, &positions[axis][at..at + LANES]),
            );
            [load(0), load(1), load(2)]
        } else {
            for axis in 0..3 {
                tail[axis][..count - at].copy_from_slice(&positions[axis][at..]);
            }
            [
                f64x8::simd_from(simd, tail[0]),
                f64x8::simd_from(simd, tail[1]),
                f64x8::simd_from(simd, tail[2]),
            ]
        };
        transform_eight(simd, p, from_model, view, &mut out, at);
    }
    out.x.truncate(count);
    out.y.truncate(count);
    out.depth.truncate(count);
    out.outcode.truncate(count);
    out
}

#[inline(always)]
fn transform_eight<S: Simd>(
    simd: S,
    p: [f64x8<S>; 3],
    from_model: &ViewFromModel,
    view: &View,
    out: &mut ScreenVertices,
    at: usize,
) {
    let (a, b, c) = (from_model.linear.x_axis, from_model.linear.y_axis, from_model.linear.z_axis);
    let row = always(
        #[inline(always)]
        |i: usize| ((p[0] * a[i] + p[1] * b[i]) + p[2] * c[i]) + from_model.offset[i],
    );
    let (view_x, view_y, w) = (row(0), row(1), row(2));
    let zero = f64x8::splat(simd, 0.0);

    // Homogeneous screen position: (x, y) / q, in sub-pixels, y down.
    let (x, y) = (view_x * view.scale[0], zero - view_y * view.scale[1]);
    let one = f64x8::splat(simd, 1.0);
    let (q, depth) = match view.projection {
        Projection::Perspective => (w, f64x8::splat(simd, view.near) / w),
        Projection::Orthographic => (one, one - (w - view.near) * view.depth_slope()),
    };
    ((x / q + 0.5).floor()).store_slice(&mut out.x[at..at + LANES]);
    ((y / q + 0.5).floor()).store_slice(&mut out.y[at..at + LANES]);
    depth.store_slice(&mut out.depth[at..at + LANES]);

    let [half_w, half_h] = view.half_extent();
    let (limit_x, limit_y, guard) = (q * half_w, q * half_h, q * GUARD);
    let inside_guard = x.abs().simd_le(guard) & y.abs().simd_le(guard);
    let codes = [
        (x.simd_lt(zero - limit_x), outcode::LEFT),
        (x.simd_gt(limit_x), outcode::RIGHT),
        (y.simd_lt(zero - limit_y), outcode::ABOVE),
        (y.simd_gt(limit_y), outcode::BELOW),
        (w.simd_lt(f64x8::splat(simd, view.near)), outcode::NEAR),
        (w.simd_gt(f64x8::splat(simd, view.far)), outcode::FAR),
        (!inside_guard, outcode::GUARD),
    ];
    for (mask, bit) in codes {
        let mask = mask.to_bitmask();
        // Most vertices have no bit at all.
        for lane in 0..if mask == 0 { 0 } else { LANES } {
            out.outcode[at + lane] |= if mask >> lane & 1 == 1 { bit } else { 0 };
        }
    }
}
