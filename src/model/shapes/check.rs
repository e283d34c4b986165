//! What must hold for every shape, and the measures that tests compare with closed forms.

use super::Mesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// A position as a key, with −0 and 0 as one.
type Point = [u64; 3];

fn point(mesh: &Mesh, vertex: u32) -> Point {
    (mesh.position(vertex) + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Position of a vertex in model space.
pub fn model_position(mesh: &Mesh, vertex: u32) -> DVec3 {
    mesh.position(vertex) + mesh.origin
}

/// Fails unless the arrays agree, normals are unit vectors on the side from which the triangle is
/// counter-clockwise, every vertex is used, and the bounds are those of the vertices.
pub fn assert_well_formed(mesh: &Mesh) {
    let count = mesh.vertex_count();
    assert!(mesh.positions.iter().all(|axis| axis.len() == count));
    assert_eq!(mesh.uvs.as_ref().map(Vec::len), Some(count));
    assert_eq!((mesh.parts.len(), mesh.slots.as_slice()), (1, [None].as_slice()));

    let mut used = vec![false; count];
    mesh.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
    assert!(used.iter().all(|&u| u), "a vertex belongs to no triangle");

    assert!(mesh.normals.iter().all(|n| (n.as_dvec3().length() - 1.0).abs() < 1e-6));
    for &triangle in &mesh.triangles {
        let face = face_normal(mesh, triangle);
        assert!(face.length() > 0.0, "{triangle:?} has no area");
        for i in triangle {
            let normal = mesh.normals[i as usize].as_dvec3();
            assert!(
                normal.dot(face) > 0.0,
                "{triangle:?} at {}: {normal} away from {face}",
                model_position(mesh, i)
            );
        }
    }

    let bounds = mesh.bounds.expect("has vertices");
    let (lower, upper) = extent(mesh);
    let near = |a: DVec3, b: DVec3| (a - b).length() <= 1e-12 * bounds.max.length();
    assert_eq!(bounds.min, DVec3::ZERO);
    assert!(near(bounds.max, upper - lower) && near(mesh.origin, lower));
}

/// Lower and upper corner in model space.
pub fn extent(mesh: &Mesh) -> (DVec3, DVec3) {
    let all = (0..u32::try_from(mesh.vertex_count()).unwrap()).map(|i| model_position(mesh, i));
    all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// Fails unless all texture coordinates lie in 0–1 and reach both ends.
pub fn assert_uvs_fill_the_unit_square(mesh: &Mesh) {
    let uvs = mesh.uvs.as_ref().unwrap();
    let (lower, upper) = uvs.iter().fold((uvs[0], uvs[0]), |(lo, hi), uv| (lo.min(*uv), hi.max(*uv)));
    assert_eq!((lower.to_array(), upper.to_array()), ([0.0, 0.0], [1.0, 1.0]));
}

/// Fails unless every edge is shared by exactly two triangles that run along it in opposite ways.
pub fn assert_watertight(mesh: &Mesh) {
    assert_eq!(open_edges(mesh), 0, "open edges");
}

/// Directed edges whose opposite is not there as often as they are themselves, by position.
pub fn open_edges(mesh: &Mesh) -> usize {
    let mut balance: BTreeMap<(Point, Point), i64> = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (point(mesh, from), point(mesh, to));
            let (key, sign) = if from < to { ((from, to), 1) } else { ((to, from), -1) };
            *balance.entry(key).or_default() += sign;
        }
    }
    balance.values().filter(|&&sum| sum != 0).count()
}

/// Twice the area of a triangle along its geometric normal.
pub fn face_normal(mesh: &Mesh, triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|i| mesh.position(i));
    (b - a).cross(c - a)
}

/// Enclosed volume, by the divergence theorem; for a closed mesh only.
pub fn volume(mesh: &Mesh) -> f64 {
    let tetrahedron = |t: &[u32; 3]| mesh.position(t[0]).dot(face_normal(mesh, *t)) / 6.0;
    mesh.triangles.iter().map(tetrahedron).sum()
}

/// Fails unless `a` and `b` agree to a relative 1e-12.
pub fn assert_close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} is not {b}");
}
