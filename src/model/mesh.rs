//! Triangle meshes as structures of arrays.

use crate::math::Bounds;
use glam::{DVec2, DVec3, Vec3};

/// A run of triangles that share a material slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index of its first triangle; it ends where the next part begins.
    pub first_triangle: u32,
    /// Index into [`Mesh::slots`].
    pub slot: u32,
}

/// An indexed triangle mesh in model space, counter-clockwise triangles facing their viewer.
///
/// All vertex arrays have one length; every vertex is used by a triangle. Positions are stored
/// relative to [`Mesh::origin`], so that a mesh far from its own origin loses no digits on the way
/// to the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Model-space position of the stored positions' zero: the lower corner of the bounds.
    pub origin: DVec3,
    /// x, y and z of every vertex, relative to `origin`.
    pub positions: [Vec<f64>; 3],
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v up; `None` where the mesh has none, which reads as (0, 0).
    pub uvs: Option<Vec<DVec2>>,
    /// Linear RGB that multiplies the diffuse colour.
    pub colors: Option<Vec<Vec3>>,
    /// Three vertex indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of triangles by material, ascending; the first begins at 0. Empty only without triangles.
    pub parts: Vec<Part>,
    /// Distinct material names of the file in order of first use; `None` is "no material given".
    /// A mesh that names no material at all has the one slot `None`.
    pub slots: Vec<Option<String>>,
    /// Around all vertices, relative to `origin` (so `min` is zero); `None` without vertices.
    pub bounds: Option<Bounds>,
}

impl Mesh {
    /// Position of vertex `i` relative to [`Mesh::origin`].
    #[must_use]
    pub fn position(&self, i: u32) -> DVec3 {
        let i = i as usize;
        DVec3::new(self.positions[0][i], self.positions[1][i], self.positions[2][i])
    }

    /// Triangles of the material slot `slot`.
    #[must_use]
    pub fn triangles_of(&self, slot: usize) -> usize {
        let ends = self.parts.iter().skip(1).map(|next| next.first_triangle as usize);
        let runs = self.parts.iter().zip(ends.chain([self.triangles.len()]));
        runs.filter(|(part, _)| part.slot as usize == slot)
            .map(|(part, end)| end - part.first_triangle as usize)
            .sum()
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.normals.len()
    }
}
