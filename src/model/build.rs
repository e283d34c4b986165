//! From corners with separate indices to the one vertex array of a [`Mesh`].

use super::mesh::{Mesh, Part};
use super::normals;
use crate::limits::MAX_TRIANGLES;
use crate::math::Bounds;
use glam::{DVec2, DVec3, Vec3};

/// An index that says "none".
pub const NONE: u32 = u32::MAX;

/// Vertices of one position that a corner is compared with before it gets a vertex of its own. A
/// double vertex does no harm; comparing with all could take quadratic time.
const MAX_COMPARISONS: usize = 64;

/// A corner of a triangle: indices into the lists of a [`MeshSource`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Index into [`MeshSource::positions`] (and `colors`).
    pub position: u32,
    /// Index into [`MeshSource::uvs`], or [`NONE`].
    pub uv: u32,
    /// Index into [`MeshSource::normals`], or [`NONE`]: generated.
    pub normal: u32,
}

/// Triangles whose corners index positions, texture coordinates and normals separately, as in OBJ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshSource {
    /// Model-space positions, finite.
    pub positions: Vec<DVec3>,
    /// Linear RGB for every position; `None`: the mesh has no vertex colours.
    pub colors: Option<Vec<Vec3>>,
    /// Texture coordinates, v up.
    pub uvs: Vec<DVec2>,
    /// Unit normals; a zero vector counts as [`NONE`].
    pub normals: Vec<Vec3>,
    /// Counter-clockwise triangles.
    pub triangles: Vec<[Corner; 3]>,
    /// Runs of triangles by material, as in [`Mesh::parts`].
    pub parts: Vec<Part>,
    /// As in [`Mesh::slots`]; empty is read as the one slot `None`.
    pub slots: Vec<Option<String>>,
}

/// A mesh with more triangles than its indices can count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the mesh has {triangles} triangles, more than {MAX_TRIANGLES}")]
pub struct MeshTooLarge {
    /// What it has.
    pub triangles: usize,
}

impl Mesh {
    /// Unifies the corners of `source`: one vertex for each distinct combination of position, texture
    /// coordinate and normal that a triangle uses, in order of first use. Missing normals are
    /// generated ([`normals::generate`]). Triangles stay as they are and in their order.
    ///
    /// # Errors
    /// If it has more than [`MAX_TRIANGLES`].
    ///
    /// # Panics
    /// If an index that is not [`NONE`] lies outside its list.
    pub fn build(mut source: MeshSource) -> Result<Self, MeshTooLarge> {
        if source.triangles.len() > MAX_TRIANGLES {
            return Err(MeshTooLarge { triangles: source.triangles.len() });
        }
        complete_normals(&mut source);
        let Unified { vertices, triangles } = unify(&source);
        let used = || vertices.iter().map(|vertex| source.positions[vertex.position as usize]);
        let bounds = Bounds::around(used());
        let origin = bounds.map_or(DVec3::ZERO, |bounds| bounds.min);
        let has_uvs = vertices.iter().any(|vertex| vertex.uv != NONE);
        let uv = |corner: &Corner| source.uvs.get(corner.uv as usize).copied().unwrap_or_default();
        Ok(Self {
            origin,
            positions: [0, 1, 2].map(|axis| used().map(|p| (p - origin)[axis]).collect()),
            normals: vertices.iter().map(|vertex| source.normals[vertex.normal as usize]).collect(),
            uvs: has_uvs.then(|| vertices.iter().map(uv).collect()),
            colors: source
                .colors
                .as_ref()
                .map(|colors| vertices.iter().map(|vertex| colors[vertex.position as usize]).collect()),
            triangles,
            parts: merged(source.parts),
            slots: if source.slots.is_empty() { vec![None] } else { source.slots },
            bounds: bounds.map(|bounds| bounds.translated(-origin)),
        })
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let vertex = 3 * size_of::<f64>()
            + size_of::<Vec3>()
            + self.uvs.as_ref().map_or(0, |_| size_of::<DVec2>())
            + self.colors.as_ref().map_or(0, |_| size_of::<Vec3>());
        let indices = size_of_val(self.triangles.as_slice()) + size_of_val(self.parts.as_slice());
        (self.vertex_count() * vertex + indices) as u64
    }
}

/// Gives every corner a normal.
fn complete_normals(source: &mut MeshSource) {
    let given = |normals: &[Vec3], corner: &Corner| {
        normals.get(corner.normal as usize).is_some_and(|n| *n != Vec3::ZERO)
    };
    let corners = source.triangles.as_flattened();
    if corners.iter().all(|corner| given(&source.normals, corner)) {
        return;
    }
    let indices: Vec<[u32; 3]> = source.triangles.iter().map(|t| t.map(|corner| corner.position)).collect();
    let generated = normals::generate(&source.positions, &indices);
    let first = u32::try_from(source.normals.len()).expect("invariant: normals are counted in u32");
    for (corner, normal) in
        source.triangles.as_flattened_mut().iter_mut().zip(generated.corners.as_flattened())
    {
        if !given(&source.normals, corner) {
            corner.normal = first.checked_add(*normal).expect("invariant: normals are counted in u32");
        }
    }
    source.normals.extend(generated.normals);
}

/// Distinct corners in order of first use, and the triangles over them.
struct Unified {
    vertices: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

/// The vertices of each position form a chain, youngest first.
fn unify(source: &MeshSource) -> Unified {
    let mut vertices: Vec<Corner> = Vec::with_capacity(source.positions.len());
    let mut older: Vec<u32> = Vec::with_capacity(source.positions.len());
    let mut youngest = vec![NONE; source.positions.len()];
    let mut vertex_of = |corner: Corner| {
        let head = &mut youngest[corner.position as usize];
        let chain = std::iter::successors(Some(*head), |i| older.get(*i as usize).copied());
        let mut compared = chain.take_while(|i| *i != NONE).take(MAX_COMPARISONS);
        if let Some(found) = compared.find(|i| vertices[*i as usize] == corner) {
            return found;
        }
        let vertex = u32::try_from(vertices.len()).expect("invariant: no more vertices than corners");
        vertices.push(corner);
        older.push(*head);
        *head = vertex;
        vertex
    };
    let triangles = source.triangles.iter().map(|triangle| triangle.map(&mut vertex_of)).collect();
    Unified { vertices, triangles }
}

/// Parts without neighbours of the same slot.
fn merged(mut parts: Vec<Part>) -> Vec<Part> {
    parts.dedup_by_key(|part| part.slot);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(position: u32) -> Corner {
        Corner { position, uv: NONE, normal: NONE }
    }

    fn square() -> MeshSource {
        let positions = [(9., 9.), (1., 1.), (2., 1.), (2., 2.), (1., 2.)];
        MeshSource {
            positions: positions.iter().map(|(x, y)| DVec3::new(*x, *y, 5.0)).collect(),
            triangles: vec![[1, 2, 3].map(corner), [1, 3, 4].map(corner)],
            parts: vec![Part { first_triangle: 0, slot: 0 }, Part { first_triangle: 1, slot: 0 }],
            ..MeshSource::default()
        }
    }

    #[test]
    fn unused_vertices_go_and_shared_ones_stay_one() {
        let mesh = Mesh::build(square()).unwrap();
        assert_eq!(mesh.vertex_count(), 4);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.normals, [Vec3::Z; 4]);
        assert_eq!(mesh.origin, DVec3::new(1., 1., 5.));
        assert_eq!(mesh.bounds, Some(Bounds { min: DVec3::ZERO, max: DVec3::new(1., 1., 0.) }));
        assert_eq!((mesh.parts.len(), mesh.slots, mesh.uvs), (1, vec![None], None));
    }

    #[test]
    fn seams_split_vertices_and_missing_uvs_read_as_zero() {
        let mut source = square();
        source.uvs = vec![DVec2::ONE];
        source.triangles[1][0].uv = 0;
        let mesh = Mesh::build(source).unwrap();
        assert_eq!(mesh.vertex_count(), 5);
        assert_eq!(mesh.uvs.unwrap(), [DVec2::ZERO, DVec2::ZERO, DVec2::ZERO, DVec2::ONE, DVec2::ZERO]);
    }

    #[test]
    fn zero_normals_count_as_missing() {
        let mut source = square();
        source.normals = vec![Vec3::X, Vec3::ZERO];
        source.triangles[0] = source.triangles[0].map(|corner| Corner { normal: 0, ..corner });
        source.triangles[1] = source.triangles[1].map(|corner| Corner { normal: 1, ..corner });
        let mesh = Mesh::build(source).unwrap();
        let normals: Vec<Vec3> = mesh.triangles[1].iter().map(|i| mesh.normals[*i as usize]).collect();
        assert_eq!(normals, [Vec3::Z; 3]);
        assert_eq!(mesh.normals[mesh.triangles[0][0] as usize], Vec3::X);
    }

    #[test]
    fn no_triangles_make_an_empty_mesh() {
        let mesh = Mesh::build(MeshSource { triangles: Vec::new(), parts: Vec::new(), ..square() }).unwrap();
        assert_eq!((mesh.vertex_count(), mesh.bounds, mesh.parts.len()), (0, None, 0));
        assert_eq!(mesh.bytes(), 0);
    }

    #[test]
    fn a_point_with_many_vertices_takes_linear_time() {
        let n = 300_000;
        let uvs = (0..n).map(|i| DVec2::splat(f64::from(i))).collect();
        let fan = |i: u32| [Corner { position: 0, uv: i, normal: NONE }, corner(1), corner(2)];
        let source = MeshSource { uvs, triangles: (0..n).map(fan).collect(), ..square() };
        assert_eq!(Mesh::build(source).unwrap().vertex_count(), n as usize + 2);
    }
}
