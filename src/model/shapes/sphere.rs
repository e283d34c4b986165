//! A sphere of longitudes and latitudes.

use super::Mesh;
use super::builder::{Builder, Vertex, around_y, fraction, pole_shift, steps, turn};
use glam::{DVec2, DVec3};

/// A sphere of `segments` (at least 3) around and `rings` (at least 2) from pole to pole.
///
/// u runs around it, v from 0 at the south pole to 1 at the north pole. Each triangle at a pole has
/// a pole vertex of its own, whose u lies in the middle of the triangle.
#[must_use]
pub fn sphere(radius: f64, segments: u32, rings: u32) -> Mesh {
    let (segments, rings) = (steps(segments, 3), steps(rings, 2));
    let mut builder = Builder::default();
    builder.sheet(segments, rings, |column, row| {
        // Half a turn leads from the south pole to the north pole.
        let (cos, sin) = turn(row, 2 * rings);
        let normal = around_y(column, segments) * sin - DVec3::Y * cos;
        let u = (f64::from(column) + pole_shift(row, rings)) / f64::from(segments);
        Vertex { position: normal * radius, normal, uv: DVec2::new(u, fraction(row, rings)) }
    });
    builder.build()
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn is_closed_and_faces_outwards() {
        for (segments, rings) in [(3, 2), (7, 5), (64, 32)] {
            let mesh = sphere(0.5, segments, rings);
            check::assert_well_formed(&mesh);
            check::assert_watertight(&mesh);
            check::assert_uvs_fill_the_unit_square(&mesh);
            assert_eq!(mesh.triangles.len(), (2 * segments * (rings - 1)) as usize);
        }
    }

    #[test]
    fn has_exact_bounds() {
        assert_eq!(check::extent(&sphere(0.7, 64, 32)), (DVec3::splat(-0.7), DVec3::splat(0.7)));
    }

    #[test]
    fn normals_point_from_the_centre() {
        let mesh = sphere(2.0, 16, 8);
        for (i, normal) in (0..).zip(&mesh.normals) {
            let outwards = check::model_position(&mesh, i) / 2.0;
            assert!((outwards - normal.as_dvec3()).length() < 1e-7);
        }
    }

    #[test]
    fn volume_approaches_the_closed_form() {
        let ideal = 4.0 / 3.0 * PI;
        let error = |n| 1.0 - check::volume(&sphere(1.0, 2 * n, n)) / ideal;
        assert!(error(32) > 0.0 && error(32) < 0.007);
        assert!((error(32) / error(64) - 4.0).abs() < 0.05, "falls with the square of the step");
    }

    #[test]
    fn the_middle_of_a_picture_faces_plus_z_and_u_runs_to_the_right() {
        let mesh = sphere(1.0, 8, 4);
        let uvs = mesh.uvs.as_ref().unwrap();
        let at = |u, v| (0..).zip(uvs).find(|(_, uv)| **uv == DVec2::new(u, v)).map(|(i, _)| i).unwrap();
        assert_eq!(check::model_position(&mesh, at(0.5, 0.5)), DVec3::Z);
        assert_eq!(check::model_position(&mesh, at(0.75, 0.5)), DVec3::X);
        assert_eq!(check::model_position(&mesh, at(0.0, 0.5)), DVec3::NEG_Z);
    }

    #[test]
    fn too_few_steps_are_raised_and_too_many_lowered() {
        assert_eq!(sphere(1.0, 0, 0).triangles.len(), sphere(1.0, 3, 2).triangles.len());
        assert_eq!(steps(u32::MAX, 3), crate::limits::MAX_SHAPE_SEGMENTS);
    }
}
