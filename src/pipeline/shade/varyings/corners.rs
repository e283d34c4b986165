//! The corners of one visible triangle: places, normals, texture coordinates and their directions, colours.

use super::Source;
use crate::model::normals::{face_normal, unit};
use crate::model::tangents::{Frame, Tangents};
use crate::pipeline::geometry::bin::Chunk;
use crate::pipeline::geometry::setup::{NOT_CLIPPED, Triangle};
use glam::{DVec2, DVec3, Vec3};

/// The corners of a triangle, in the order of its set-up.
pub(super) struct Corners {
    /// Index in the mesh.
    triangle: u32,
    vertices: [u32; 3],
    /// Which source corner (or which corner of the clipped piece) each is.
    order: [usize; 3],
    /// Weights of the source corners at the piece's corners, if it was clipped.
    weights: Option<[[f64; 3]; 3]>,
    /// Relative to the eye, in world axes.
    pub(super) positions: [DVec3; 3],
    /// Unit normal of its plane, on the side of the mesh's front.
    pub(super) geometric_normal: DVec3,
}

impl Corners {
    pub(super) fn new(source: &Source, t: &Triangle, chunk: &Chunk) -> Self {
        let vertices = source.item.mesh.triangles[t.source as usize];
        let weights = (t.clipped != NOT_CLIPPED).then(|| chunk.clipped[t.clipped as usize]);
        let at = |v: u32| source.item.linear * source.item.mesh.position(v) + source.offset;
        let corners = vertices.map(at);
        let (triangle, order) = (t.source, t.corners());
        let geometric_normal = DVec3::ZERO;
        let mut this = Self { triangle, vertices, order, weights, positions: corners, geometric_normal };
        this.positions = this.pick(corners, |c, w| c[0] * w[0] + c[1] * w[1] + c[2] * w[2]);
        let plane = face_normal(&vertices.map(|v| source.item.mesh.position(v)), [0, 1, 2]);
        this.geometric_normal = unit_or_zero(source.world_from_normal * plane.unwrap_or(DVec3::ZERO));
        this
    }

    /// Brings a value of the source triangle's corners into the order of the set-up, interpolated
    /// where the triangle was clipped.
    fn pick<T: Copy>(&self, value: [T; 3], mix: impl Fn([T; 3], [f64; 3]) -> T) -> [T; 3] {
        match &self.weights {
            None => self.order.map(|corner| value[corner]),
            Some(weights) => self.order.map(|corner| mix(value, weights[corner])),
        }
    }

    /// Unit normals in world axes, on the side of the mesh's front.
    pub(super) fn normals(&self, source: &Source) -> [DVec3; 3] {
        let normals = self.vertices.map(|v| {
            let n = unit_or_zero(source.world_from_normal * source.item.mesh.normals[v as usize].as_dvec3());
            if n == DVec3::ZERO { self.geometric_normal } else { n }
        });
        self.pick(normals, |n, w| n[0] * w[0] + n[1] * w[1] + n[2] * w[2])
    }

    /// Texture coordinates.
    pub(super) fn uvs(&self, source: &Source) -> [DVec2; 3] {
        let Some(uvs) = &source.item.mesh.uvs else { return [DVec2::ZERO; 3] };
        let uv = self.vertices.map(|v| uvs[v as usize]);
        self.pick(uv, |c, w| c[0] * w[0] + c[1] * w[1] + c[2] * w[2])
    }

    /// How the texture lies on the surface, in world axes.
    pub(super) fn frames(&self, source: &Source, tangents: Option<&Tangents>) -> CornerFrames {
        let none = [Frame::default(); 3];
        let frames = tangents.map_or(none, |tangents| tangents.of_triangle(self.triangle));
        let world = frames
            .map(|frame| [frame.along_u, frame.along_v].map(|along| source.item.linear * along.as_dvec3()));
        let direction = |axis: usize| {
            let unit = world.map(|along| unit_or_zero(along[axis]));
            self.pick(unit, |t, w| t[0] * w[0] + t[1] * w[1] + t[2] * w[2])
        };
        let per_world = world.map(|along| DVec2::from_array(along.map(inverse_length)));
        CornerFrames {
            along_u: direction(0),
            along_v: direction(1),
            per_world: self.pick(per_world, |s, w| s[0] * w[0] + s[1] * w[1] + s[2] * w[2]),
        }
    }

    /// Vertex colours, linear RGB.
    pub(super) fn colors(&self, source: &Source) -> [Vec3; 3] {
        let Some(colors) = &source.item.mesh.colors else { return [Vec3::ONE; 3] };
        let c = self.vertices.map(|v| colors[v as usize].as_dvec3());
        self.pick(c, |c, w| c[0] * w[0] + c[1] * w[1] + c[2] * w[2]).map(|c| c.as_vec3())
    }
}

/// How the texture lies on a triangle's corners, in world axes.
pub(super) struct CornerFrames {
    /// Unit directions of u; zero where it has none.
    pub(super) along_u: [DVec3; 3],
    /// Those of v.
    pub(super) along_v: [DVec3; 3],
    /// Units of u and of v to a world unit along them.
    pub(super) per_world: [DVec2; 3],
}

/// 0 for what has no length; at most 1e30, so that f32 holds its product with any slope of a picture.
fn inverse_length(v: DVec3) -> f64 {
    let length = v.abs().max_element();
    if length > 0.0 && length.is_finite() { (1.0 / (v / length).length() / length).min(1e30) } else { 0.0 }
}

/// Unit length, or zero where there is no direction.
fn unit_or_zero(v: DVec3) -> DVec3 {
    unit(v).unwrap_or(DVec3::ZERO)
}
