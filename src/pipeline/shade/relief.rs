//! Relief: normal and bump maps tilt the interpolated normals of a block.
//!
//! What the maps hold is laid along the directions in which the texture grows over the surface
//! ([`Varyings::along_u`], `along_v`). Geometry stays as it is, and so does what shadow maps are asked.

use super::BLOCK;
use super::texture;
use super::varyings::Varyings;
use crate::math::simd::*;
use crate::model::Texture;
use crate::plan::{Heights, Relief};

/// The steepest slope, rise over run: 0.006° from upright. A height map of any scale leaves the normal
/// on its own side of the surface, further than f32 rounds (numerics: B29).
const STEEPEST: f32 = 1e4;

/// Squared sine of the angle to the normal (0.6°) below which a direction says nothing about how the
/// texture lies in the surface.
const LEAST_SINE_SQUARED: f32 = 1e-4;

/// Tilts the first `count` normals of a block. Both maps given, the heights lie on the surface that
/// the normal map describes.
pub fn tilt(level: Level, relief: &Relief, varyings: &mut Varyings, count: usize) {
    if let Some(map) = &relief.normal_map {
        follow_normals(level, map, varyings, count);
    }
    if let Some(heights) = &relief.heights {
        follow_heights(level, heights, varyings, count);
    }
}

/// Takes each normal to that of a normal map: red along u, green along v, blue along the normal.
fn follow_normals(level: Level, map: &Texture, varyings: &mut Varyings, count: usize) {
    let mut texels = [[0.0; BLOCK]; 4];
    texture::sample_normals(level, map, &varyings.texture, count, &mut texels);
    // A picture that is laid on turned round has its own directions turned round.
    let [turn_u, turn_v] = map.scale.map(|scale| if scale < 0.0 { -1.0 } else { 1.0 });
    dispatch!(level, simd => {
        for at in (0..count).step_by(LANES) {
            let normal = Vec3x8::load(simd, &varyings.normal, at);
            let along_u = Vec3x8::load(simd, &varyings.along_u, at);
            let along_v = Vec3x8::load(simd, &varyings.along_v, at);
            let [tangent, bitangent] = tangent_frame(simd, normal, along_u, along_v);
            let texel = always(
                #[inline(always)]
                |c: usize| f32x8::from_slice(simd, &texels[c][at..at + LANES]),
            );
            let (x, y, z) = (texel(0) * turn_u, texel(1) * turn_v, texel(2));
            let tilted = (tangent.scale(x) + bitangent.scale(y)) + normal.scale(z);
            // To the bit as without the map where it is flat, and where it shows no direction at all.
            let zero = f32x8::splat(simd, 0.0);
            let flat = (x.simd_eq(zero) & y.simd_eq(zero))
                | tilted.dot(tilted).simd_lt(f32x8::splat(simd, 1e-12));
            normal.select(flat, tilted.normalize()).store(&mut varyings.normal, at);
        }
    });
}

/// Takes each normal to that of the surface raised by a height map: `n − ∇h` with the gradient along
/// the surface. Sources: J. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978; M. Mikkelsen,
/// "Bump Mapping Unparametrized Surfaces on the GPU", 2010.
fn follow_heights(level: Level, heights: &Heights, varyings: &mut Varyings, count: usize) {
    let mut slopes = [[0.0; BLOCK]; 2];
    texture::sample_slopes(level, &heights.map, &varyings.texture, count, &mut slopes);
    // A scale beyond all slopes stays a number.
    let scale = heights.scale.clamp(-1e30, 1e30);
    dispatch!(level, simd => {
        for at in (0..count).step_by(LANES) {
            let normal = Vec3x8::load(simd, &varyings.normal, at);
            let along_u = Vec3x8::load(simd, &varyings.along_u, at);
            let along_v = Vec3x8::load(simd, &varyings.along_v, at);
            // World units of height a world unit along u and along v.
            let slope = always(
                #[inline(always)]
                |axis: usize| {
                    let per_uv = f32x8::from_slice(simd, &slopes[axis][at..at + LANES]);
                    let per_world = f32x8::from_slice(simd, &varyings.uv_per_world[axis][at..at + LANES]);
                    let steepest = f32x8::splat(simd, STEEPEST);
                    min(max(per_uv * per_world * scale, -steepest), steepest)
                },
            );
            let (rise_u, rise_v) = (slope(0), slope(1));
            let zero = f32x8::splat(simd, 0.0);
            let even = rise_u.simd_eq(zero) & rise_v.simd_eq(zero);
            let gradient = surface_gradient(simd, normal, [along_u, along_v], [rise_u, rise_v]);
            normal.select(even, (normal - gradient).normalize()).store(&mut varyings.normal, at);
        }
    });
}

/// Unit vectors along u and v that make an orthonormal basis with the unit vector `normal`: the
/// direction of u in the plane of the normal, and what is perpendicular to both on the side of v, so
/// that a mirrored texture stays mirrored. Where u has no direction: any basis.
///
/// Each is off the normal by less than 4u, u the rounding of f32 (numerics: B28).
#[inline(always)]
fn tangent_frame<S: Simd>(
    simd: S,
    normal: Vec3x8<S>,
    along_u: Vec3x8<S>,
    along_v: Vec3x8<S>,
) -> [Vec3x8<S>; 2] {
    let in_plane = along_u - normal.scale(normal.dot(along_u));
    let has_direction = in_plane.dot(in_plane).simd_gt(f32x8::splat(simd, LEAST_SINE_SQUARED));
    // What cancelled above left the plane by its rounding; the second time nothing cancels.
    let unit = in_plane.normalize();
    let unit = unit - normal.scale(normal.dot(unit));
    let tangent = unit.select(has_direction, any_tangent(simd, normal));
    let bitangent = cross(normal, tangent);
    let turned = cross(along_u, along_v).dot(normal).simd_lt(f32x8::splat(simd, 0.0));
    let opposite = Vec3x8 { x: -bitangent.x, y: -bitangent.y, z: -bitangent.z };
    [tangent, opposite.select(turned, bitangent)]
}

/// A unit vector perpendicular to the unit vector `n`. Source: as [`crate::plan::orthonormal_basis`].
#[inline(always)]
fn any_tangent<S: Simd>(simd: S, n: Vec3x8<S>) -> Vec3x8<S> {
    let one = f32x8::splat(simd, 1.0);
    let sign = one.copysign(n.z);
    let a = -one / (sign + n.z);
    Vec3x8 { x: one + sign * n.x * n.x * a, y: sign * (n.x * n.y * a), z: -(sign * n.x) }
}

/// The vector in the plane of `normal` that rises by `rises` a unit along the directions that `along`
/// have in that plane; no steeper than [`STEEPEST`], and zero where they are no two directions.
#[inline(always)]
fn surface_gradient<S: Simd>(
    simd: S,
    normal: Vec3x8<S>,
    along: [Vec3x8<S>; 2],
    rises: [f32x8<S>; 2],
) -> Vec3x8<S> {
    let least = f32x8::splat(simd, LEAST_SINE_SQUARED);
    let zero = f32x8::splat(simd, 0.0);
    let none = Vec3x8 { x: zero, y: zero, z: zero };
    let direction = always(
        #[inline(always)]
        |v: Vec3x8<S>| {
            let in_plane = v - normal.scale(normal.dot(v));
            in_plane.normalize().select(in_plane.dot(in_plane).simd_gt(least), none)
        },
    );
    let (u, v) = (direction(along[0]), direction(along[1]));
    // The sine between them; g · u = rise_u and g · v = rise_v by Cramer's rule.
    let sine = cross(u, v).dot(normal);
    let gradient = cross(v, normal).scale(rises[0] / sine) + cross(normal, u).scale(rises[1] / sine);
    let steepness = gradient.dot(gradient).sqrt();
    let held = min(f32x8::splat(simd, STEEPEST) / steepness, f32x8::splat(simd, 1.0));
    gradient.scale(held).select((sine * sine).simd_gt(least) & steepness.simd_gt(zero), none)
}

#[inline(always)]
fn cross<S: Simd>(a: Vec3x8<S>, b: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8 { x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x }
}
