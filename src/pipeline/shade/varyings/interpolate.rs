//! Interpolation: records and fragments in, attributes of a block out.

use super::records::{Layout, Records, SHADOW};
use super::{Receivers, Source};
use crate::math::simd::*;
use crate::pipeline::shade::table::{Lanes, Weights};
use crate::pipeline::shade::texture::Coordinates;
use crate::pipeline::shade::{BLOCK, Fragment};

/// Interpolated attributes of a block of fragments. Lanes beyond its length hold copies of the last.
pub struct Varyings {
    /// Unit normal in world axes, towards the viewer's side of the surface.
    pub normal: [[f32; BLOCK]; 3],
    /// Position relative to [`anchor`](crate::pipeline::shade::anchor), in world axes.
    pub position: [[f32; BLOCK]; 3],
    /// Texture coordinates and their derivatives.
    pub texture: Coordinates,
    /// Direction in which u grows, in world axes; about a unit vector, neither exactly so nor exactly in
    /// the surface, and zero where the texture has no direction. Of a back face: negated.
    pub along_u: [[f32; BLOCK]; 3],
    /// The same for v.
    pub along_v: [[f32; BLOCK]; 3],
    /// Units of u and of v to a world unit along them.
    pub uv_per_world: [[f32; BLOCK]; 2],
    /// Vertex colour, linear RGB.
    pub color: [[f32; BLOCK]; 3],
    /// As each light with a shadow sees them.
    pub shadow: Vec<Receivers>,
}

impl Default for Varyings {
    fn default() -> Self {
        Self {
            normal: [[0.0; BLOCK]; 3],
            position: [[0.0; BLOCK]; 3],
            texture: Coordinates::default(),
            along_u: [[0.0; BLOCK]; 3],
            along_v: [[0.0; BLOCK]; 3],
            uv_per_world: [[0.0; BLOCK]; 2],
            color: [[0.0; BLOCK]; 3],
            shadow: Vec::new(),
        }
    }
}

/// Interpolates the attributes of up to [`BLOCK`] fragments of one draw.
pub fn interpolate(
    level: Level,
    records: &Records,
    source: &Source,
    fragments: &[Fragment],
    out: &mut Varyings,
) {
    out.shadow.resize(source.shadows.len(), Receivers::default());
    dispatch!(level, simd => records.table.for_each_eight(simd, fragments, always(
        #[inline(always)]
        |lanes: &Lanes, weights: &Weights<_>, at: usize| {
            interpolate_eight(simd, lanes, &records.layout, source, weights, out, at);
        },
    )));
}

#[inline(always)]
fn interpolate_eight<S: Simd>(
    simd: S,
    lanes: &Lanes,
    layout: &Layout,
    source: &Source,
    weights: &Weights<S>,
    out: &mut Varyings,
    at: usize,
) {
    for (map, receivers) in out.shadow.iter_mut().enumerate() {
        for (c, plane) in receivers.plane.iter_mut().enumerate() {
            lanes.single(simd, layout.shadow_planes + 3 * map + c).store_slice(&mut plane[at..at + LANES]);
        }
        let field = SHADOW + 9 * map;
        for (c, coordinate) in receivers.place.iter_mut().enumerate() {
            narrow(lanes.mix_wide(simd, weights, field + c, 3)).store_slice(&mut coordinate[at..at + LANES]);
        }
    }
    if source.surface.needs_normal() {
        let n = lanes.mix3(simd, weights, layout.normal);
        let plane = Vec3x8 {
            x: lanes.single(simd, layout.normal + 9),
            y: lanes.single(simd, layout.normal + 10),
            z: lanes.single(simd, layout.normal + 11),
        };
        // Opposite normals cancel: there the plane's own normal holds.
        let cancelled = n.dot(n).simd_lt(f32x8::splat(simd, 1e-12));
        plane.select(cancelled, n.normalize()).store(&mut out.normal, at);
    }
    if source.surface.lit {
        let position = lanes.mix3(simd, weights, layout.position);
        position.store(&mut out.position, at);
        if !source.shadows.is_empty() {
            let lift = lift_to_round(simd, lanes, layout, weights, position);
            lift_receivers(simd, source, lift, out, at);
        }
    }
    if source.surface.relief.is_some() {
        lanes.mix3(simd, weights, layout.tangent).store(&mut out.along_u, at);
        lanes.mix3(simd, weights, layout.tangent + 9).store(&mut out.along_v, at);
    }
    if source.surface.needs_uv_per_world() {
        for c in 0..2 {
            let per_world = lanes.mix(simd, weights, layout.uv_per_world + c, 2);
            per_world.store_slice(&mut out.uv_per_world[c][at..at + LANES]);
        }
    }
    if source.surface.vertex_colors {
        lanes.mix3(simd, weights, layout.color).store(&mut out.color, at);
    }
    if source.surface.needs_uv() {
        for c in 0..2 {
            let mut coordinate = lanes.mix_wide(simd, weights, layout.uv_place + c, 2);
            if source.surface.periodic_uv {
                // Without its whole turns where they change nothing (an even number: a mirrored
                // texture repeats every second unit), so that f32 keeps the digits that count.
                coordinate -= (coordinate * 0.5).floor() * 2.0;
            }
            narrow(coordinate).store_slice(&mut out.texture.uv[c][at..at + LANES]);
            let [along_x, along_y] = lanes.derivatives(simd, weights, layout.uv + 3 * c);
            along_x.store_slice(&mut out.texture.per_pixel[c][at..at + LANES]);
            along_y.store_slice(&mut out.texture.per_pixel[2 + c][at..at + LANES]);
        }
    }
}

/// How far above its flat triangle the rounded surface runs that the corner normals stand for.
///
/// A light that grazes a sphere of triangles would find it in its own shadow as soon as it is behind
/// a triangle's plane, long before the rounded surface turns away. Source: J. Hanika, "Hacking the
/// Shadow Terminator", Ray Tracing Gems II, 2021.
#[inline(always)]
fn lift_to_round<S: Simd>(
    simd: S,
    lanes: &Lanes,
    layout: &Layout,
    weights: &Weights<S>,
    position: Vec3x8<S>,
) -> f32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let mut lift = zero;
    for (i, &weight) in weights.corners.iter().enumerate() {
        let field = always(
            #[inline(always)]
            |at: usize| Vec3x8 {
                x: lanes.single(simd, at),
                y: lanes.single(simd, at + 1),
                z: lanes.single(simd, at + 2),
            },
        );
        let (corner, normal) = (field(layout.position + 3 * i), field(layout.normal + 3 * i));
        lift += weight * max((corner - position).dot(normal), zero);
    }
    min(lift, lanes.single(simd, layout.normal + 12))
}

/// Moves eight receivers by `lift` along their normals, as every light sees them.
#[inline(always)]
fn lift_receivers<S: Simd>(simd: S, source: &Source, lift: f32x8<S>, out: &mut Varyings, at: usize) {
    if lift.simd_gt(f32x8::splat(simd, 0.0)).all_false() {
        return;
    }
    let offset = Vec3x8::load(simd, &out.normal, at).scale(lift);
    for (frame, receivers) in source.shadows.iter().zip(&mut out.shadow) {
        let columns = [frame.linear.x_axis, frame.linear.y_axis, frame.linear.z_axis].map(|c| c.as_vec3());
        for (row, coordinate) in receivers.place.iter_mut().enumerate() {
            let moved = offset.x * columns[0][row] + offset.y * columns[1][row] + offset.z * columns[2][row];
            let old = f32x8::from_slice(simd, &coordinate[at..at + LANES]);
            (old + moved).store_slice(&mut coordinate[at..at + LANES]);
        }
    }
}
