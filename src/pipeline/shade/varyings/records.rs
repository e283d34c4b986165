//! One record a visible triangle: everything that interpolation reads, laid out for it.

use super::corners::{CornerFrames, Corners};
use super::{RayFrame, ShadowFrame, Source};
use crate::math::{Projection, round_to_f32};
use crate::pipeline::geometry::setup::Triangle;
use crate::pipeline::shade::table::{self, Table};
use crate::pipeline::shader::Visible;
use crate::plan::{Relief, Surface};
use glam::{DMat3, DVec2, DVec3, Vec3};

/// Where the parts of a record are. Parts that a surface does not need have no room.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) shadow_planes: usize,
    pub(super) normal: usize,
    pub(super) position: usize,
    pub(super) uv: usize,
    pub(super) tangent: usize,
    pub(super) uv_per_world: usize,
    pub(super) color: usize,
    pub(super) singles: usize,
    /// In the f64 part: texture coordinates, behind the shadow maps'.
    pub(super) uv_place: usize,
    pub(super) doubles: usize,
}

impl Layout {
    fn new(surface: &Surface, shadows: usize) -> Self {
        let mut at = 0;
        let mut room = |needed: bool, n: usize| {
            let start = at;
            at += if needed { n } else { 0 };
            start
        };
        // The plane as each light sees it; three corner normals, the geometric one, and how far they
        // round the triangle; three positions; the numerators of the derivatives of (u, v); three
        // directions of u, then of v; u and v to a world unit at three corners; three colours.
        let shadow_planes = room(true, 3 * shadows);
        let normal = room(surface.needs_normal(), 13);
        let position = room(surface.lit, 9);
        let uv = room(surface.needs_uv(), 6);
        let tangent = room(surface.relief.is_some(), 18);
        let uv_per_world = room(surface.needs_uv_per_world(), 6);
        let color = room(surface.vertex_colors, 9);
        let uv_place = SHADOW + 9 * shadows;
        let doubles = uv_place + if surface.needs_uv() { 6 } else { 0 };
        Self {
            shadow_planes,
            normal,
            position,
            uv,
            tangent,
            uv_per_world,
            color,
            singles: at,
            uv_place,
            doubles,
        }
    }
}

/// Where the f64 part goes on behind its head: what each light's map is asked with.
pub(super) const SHADOW: usize = table::HEAD;

/// Records of the visible triangles of one draw in one tile.
#[derive(Debug)]
pub struct Records {
    pub(super) layout: Layout,
    pub(super) table: Table,
}

impl Records {
    /// No records yet.
    #[must_use]
    pub fn new(source: &Source) -> Self {
        let layout = Layout::new(source.surface, source.shadows.len());
        Self { layout, table: Table::new(layout.doubles, layout.singles) }
    }

    /// Adds the record of a triangle.
    pub fn push(&mut self, source: &Source, (chunk, t): Visible) {
        let corners = Corners::new(source, t, chunk);
        let scale = self.table.begin(t, homogeneous(source, &corners));
        let shadow_normal = corners.geometric_normal;
        for frame in source.shadows {
            self.push_shadow(source, frame, &corners, shadow_normal, scale);
        }
        let facing = if t.is_back() { -1.0 } else { 1.0 };
        if source.surface.needs_normal() {
            let normals = corners.normals(source);
            for n in normals.into_iter().chain([corners.geometric_normal]) {
                self.push_vec3((n * facing).as_vec3());
            }
            self.table.extend_singles(&[round_to_f32(rise(&corners, &normals))]);
        }
        if source.surface.lit {
            corners.positions.iter().for_each(|p| self.push_vec3((p - source.anchor).as_vec3()));
        }
        if source.surface.needs_uv() {
            self.push_uvs(&corners.uvs(source), t, scale);
        }
        if let Some(relief) = &source.surface.relief {
            self.push_frames(&corners.frames(source, relief.tangents.as_deref()), relief, facing);
        }
        if source.surface.vertex_colors {
            corners.colors(source).into_iter().for_each(|c| self.push_vec3(c));
        }
    }

    /// Directions of u and of v and, for heights, how much of them is a world unit.
    ///
    /// A back is the front turned inside out, relief and all: with its normals, its directions change
    /// sign.
    fn push_frames(&mut self, frames: &CornerFrames, relief: &Relief, facing: f64) {
        for along in frames.along_u.iter().chain(&frames.along_v) {
            self.push_vec3((along * facing).as_vec3());
        }
        if relief.heights.is_some() {
            frames.per_world.iter().for_each(|per| self.table.extend_singles(&per.as_vec2().to_array()));
        }
    }

    fn push_vec3(&mut self, v: Vec3) {
        self.table.extend_singles(&v.to_array());
    }

    /// What a light sees: the place of corner 0, how much those of corners 1 and 2 differ from it, times
    /// their scale; and the plane.
    fn push_shadow(
        &mut self,
        source: &Source,
        frame: &ShadowFrame,
        corners: &Corners,
        normal: DVec3,
        scale: [f64; 3],
    ) {
        let from_origin = source.eye - frame.origin;
        let (base, clearance, plane) = match frame.rays {
            RayFrame::Parallel { direction, offset, clearance } => {
                // The offset points to the side that the light comes from.
                let towards = if normal.dot(direction) > 0.0 { -1.0 } else { 1.0 };
                let along = |axis: usize| normal.dot(offset[axis]).abs();
                let lift = normal * (towards * (along(0) + along(1)));
                (from_origin + lift, clearance, depth_per_texel(&frame.linear, normal))
            }
            RayFrame::FromPoint => {
                (from_origin, 0.0, plane_over_distance(normal, corners.positions.map(|p| p + from_origin)))
            }
        };
        let clearance = DVec3::new(0.0, 0.0, clearance);
        let [s0, s1, s2] = corners.positions.map(|p| frame.linear * (p + base) + clearance);
        for v in [s0, (s1 - s0) * scale[1], (s2 - s0) * scale[2]] {
            self.table.extend_doubles(&v.to_array());
        }
        self.push_vec3(plane.as_vec3());
    }

    /// Coordinates at corner 0, how much corners 1 and 2 differ from them, times their scale, and the
    /// numerators of their screen derivatives.
    fn push_uvs(&mut self, uv: &[DVec2; 3], t: &Triangle, scale: [f64; 3]) {
        for v in [uv[0], (uv[1] - uv[0]) * scale[1], (uv[2] - uv[0]) * scale[2]] {
            self.table.extend_doubles(&v.to_array());
        }
        for axis in 0..2 {
            self.table.extend_derivatives(t, scale, uv.map(|uv| uv[axis]));
        }
    }
}

/// Planes that lie closer to the light's rays than this (as a sine) count as no closer: their slope
/// stays a number.
const GRAZING: f64 = 1e-6;

/// Depth that a plane gains per texel along x and y of a map with these rows, which are orthogonal.
fn depth_per_texel(linear: &DMat3, normal: DVec3) -> DVec3 {
    let along = |axis: usize| linear.row(axis).dot(normal) / linear.row(axis).length_squared();
    let depth = along(2);
    let depth = depth.abs().max(GRAZING / linear.row(2).length()).copysign(depth);
    DVec3::new(-along(0) / depth, -along(1) / depth, 0.0)
}

/// The normal of the plane through `corners`, divided by the plane's distance from zero.
fn plane_over_distance(normal: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let distance = normal.dot(corners[0]);
    let reach = corners.iter().map(|p| p.length()).fold(f64::MIN_POSITIVE, f64::max);
    normal / distance.abs().max(GRAZING * reach).copysign(distance)
}

/// Homogeneous coordinates of the corners.
fn homogeneous(source: &Source, corners: &Corners) -> [f64; 3] {
    match source.projection {
        Projection::Orthographic => [1.0; 3],
        Projection::Perspective => corners.positions.map(|p| p.dot(source.forward)),
    }
}

/// The most that the rounded surface can rise above a flat triangle, if its corner normals say that it
/// stands for one: they lean apart, but no more than a smooth surface's would. Between two normals
/// that differ by φ an arc of length e rises by e φ / 8; the estimate of [`super::interpolate`] by
/// up to twice that.
fn rise(corners: &Corners, normals: &[DVec3; 3]) -> f64 {
    let smooth = normals.iter().all(|n| n.dot(corners.geometric_normal) > 0.8);
    let apart =
        |f: &dyn Fn(usize) -> DVec3| (0..3).map(|i| (f(i) - f((i + 1) % 3)).length()).fold(0.0, f64::max);
    if smooth { apart(&|i| normals[i]) * apart(&|i| corners.positions[i]) * 0.25 } else { 0.0 }
}
