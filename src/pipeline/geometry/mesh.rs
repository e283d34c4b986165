//! The vertex shader of a scene: a mesh's stored positions to clip space, in f64.

use crate::math::simd::*;
use crate::math::{Projection, View};
use crate::pipeline::shader::{ClipBlock, VertexShader};
use crate::plan::Item;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// One item as a viewer sees it.
pub struct MeshVertices<'a> {
    positions: &'a [Vec<f64>; 3],
    from_model: ViewFromModel,
    projection: Projection,
    /// Clip-space x and y per unit of view-space x and y.
    focal: [f64; 2],
    near: f64,
    depth_slope: f64,
}

/// From a mesh's stored positions to view space: `linear · p + offset` is (x, y, w).
#[derive(Clone, Copy, Debug)]
struct ViewFromModel {
    linear: DMat3,
    /// View-space position of the stored zero.
    offset: DVec3,
}

impl ViewFromModel {
    /// Composes the item's placement with the view. The camera is subtracted before anything is
    /// rotated, so a scene far from the origin loses nothing.
    fn new(item: &Item, view: &View) -> Self {
        let view_from_world = view.view_from_world();
        Self { linear: view_from_world * item.linear, offset: view_from_world * (item.origin - view.eye) }
    }
}

impl<'a> MeshVertices<'a> {
    /// The vertices of `item` before `view`.
    #[must_use]
    pub fn new(item: &'a Item, view: &View) -> Self {
        let half = view.half_extent();
        Self {
            positions: &item.mesh.positions,
            from_model: ViewFromModel::new(item, view),
            projection: view.projection,
            focal: [view.scale[0] / half[0], view.scale[1] / half[1]],
            near: view.near,
            depth_slope: view.depth_slope(),
        }
    }

    #[inline(always)]
    fn kernel<S: Simd>(&self, simd: S, vertices: Range<usize>, out: &mut ClipBlock) {
        let positions = self.positions.each_ref().map(|axis| &axis[vertices.clone()]);
        let count = vertices.len();
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
            self.eight(simd, p, out, at);
        }
    }

    #[inline(always)]
    fn eight<S: Simd>(&self, simd: S, p: [f64x8<S>; 3], out: &mut ClipBlock, at: usize) {
        let ViewFromModel { linear, offset } = &self.from_model;
        let (a, b, c) = (linear.x_axis, linear.y_axis, linear.z_axis);
        let row = always(
            #[inline(always)]
            |i: usize| ((p[0] * a[i] + p[1] * b[i]) + p[2] * c[i]) + offset[i],
        );
        let distance = row(2);
        let one = f64x8::splat(simd, 1.0);
        let (z, w) = match self.projection {
            Projection::Perspective => (f64x8::splat(simd, self.near), distance),
            Projection::Orthographic => (one - (distance - self.near) * self.depth_slope, one),
        };
        (row(0) * self.focal[0]).store_slice(&mut out.x[at..at + LANES]);
        (row(1) * self.focal[1]).store_slice(&mut out.y[at..at + LANES]);
        z.store_slice(&mut out.z[at..at + LANES]);
        w.store_slice(&mut out.w[at..at + LANES]);
    }
}

impl VertexShader for MeshVertices<'_> {
    fn positions(&self, level: Level, vertices: Range<u32>, out: &mut ClipBlock) {
        let vertices = vertices.start as usize..vertices.end as usize;
        dispatch!(level, simd => self.kernel(simd, vertices, out));
    }
}
