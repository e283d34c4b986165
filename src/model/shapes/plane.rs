//! A floor.

use super::Mesh;
use super::builder::{Builder, Vertex};
use glam::{DVec2, DVec3};

/// A rectangle in x and z that faces +y; `size` along x and z.
///
/// u runs along +x and v along −z, from 0 to `uv_repeat`.
#[must_use]
pub fn plane(size: [f64; 2], uv_repeat: [f64; 2]) -> Mesh {
    let mut builder = Builder::default();
    builder.sheet(1, 1, |column, row| {
        let (right, away) = (f64::from(column), f64::from(row));
        Vertex {
            position: DVec3::new((right - 0.5) * size[0], 0.0, (0.5 - away) * size[1]),
            normal: DVec3::Y,
            uv: DVec2::new(right * uv_repeat[0], away * uv_repeat[1]),
        }
    });
    builder.build()
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;

    #[test]
    fn faces_up_with_u_to_the_right_and_v_away() {
        let mesh = plane([4.0, 6.0], [2.0, 3.0]);
        check::assert_well_formed(&mesh);
        assert_eq!(mesh.triangles.len(), 2);
        assert!(mesh.normals.iter().all(|n| *n == glam::Vec3::Y));
        for (i, uv) in (0..).zip(mesh.uvs.as_ref().unwrap()) {
            let p = check::model_position(&mesh, i);
            assert_eq!(*uv, DVec2::new((p.x + 2.0) / 4.0 * 2.0, (3.0 - p.z) / 6.0 * 3.0));
        }
    }

    #[test]
    fn is_centred() {
        let (lower, upper) = check::extent(&plane([4.0, 6.0], [1.0, 1.0]));
        assert_eq!((lower, upper), (DVec3::new(-2.0, 0.0, -3.0), DVec3::new(2.0, 0.0, 3.0)));
    }

    #[test]
    fn has_its_area() {
        let mesh = plane([4.0, 6.0], [1.0, 1.0]);
        let area: DVec3 = mesh.triangles.iter().map(|t| check::face_normal(&mesh, *t) / 2.0).sum();
        assert_eq!(area, DVec3::Y * 24.0);
    }
}
