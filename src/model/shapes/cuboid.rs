//! A box.

use super::Mesh;
use super::builder::{Builder, Vertex};
use glam::{DVec2, DVec3};

/// For each face: to its right, up, and outwards, seen by a viewer who faces it. The sides stand
/// upright; up on the top is away (−z), up on the bottom is towards the viewer at +z.
const FACES: [[DVec3; 3]; 6] = [
    [DVec3::NEG_Z, DVec3::Y, DVec3::X],
    [DVec3::Z, DVec3::Y, DVec3::NEG_X],
    [DVec3::X, DVec3::NEG_Z, DVec3::Y],
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z],
];

/// A box of the given `size` along x, y and z; the unit square of texture coordinates on each face.
#[must_use]
pub fn box_(size: [f64; 3]) -> Mesh {
    let size = DVec3::from(size);
    let mut builder = Builder::default();
    for [right, up, out] in FACES {
        builder.sheet(1, 1, |column, row| {
            let (u, v) = (f64::from(column), f64::from(row));
            let corner = right * (u - 0.5) + up * (v - 0.5) + out * 0.5;
            Vertex { position: corner * size, normal: out, uv: DVec2::new(u, v) }
        });
    }
    builder.build()
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;

    #[test]
    fn is_closed_and_faces_outwards() {
        let mesh = box_([1.0, 2.0, 3.0]);
        check::assert_well_formed(&mesh);
        check::assert_watertight(&mesh);
        check::assert_uvs_fill_the_unit_square(&mesh);
        assert_eq!((mesh.triangles.len(), mesh.vertex_count()), (12, 24));
    }

    #[test]
    fn has_exact_bounds_and_volume() {
        let mesh = box_([1.0, 2.0, 3.0]);
        assert_eq!(check::extent(&mesh), (DVec3::new(-0.5, -1.0, -1.5), DVec3::new(0.5, 1.0, 1.5)));
        assert_eq!(check::volume(&mesh), 6.0);
    }

    #[test]
    fn without_height_keeps_top_and_bottom_alone() {
        assert_eq!(box_([1.0, 0.0, 1.0]).triangles.len(), 4);
    }
}
