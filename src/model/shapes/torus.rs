//! A torus.

use super::Mesh;
use super::builder::{Builder, Vertex, around_y, fraction, steps, turn};
use glam::{DVec2, DVec3};

/// A ring around the y axis: `radius` reaches to the centre of its tube of radius `tube`;
/// `segments` (at least 3) around the axis, `sides` (at least 3) around the tube.
///
/// u runs around the axis, v around the tube: up on the outside, from the inner equator and back.
#[must_use]
pub fn torus(radius: f64, tube: f64, segments: u32, sides: u32) -> Mesh {
    let (segments, sides) = (steps(segments, 3), steps(sides, 3));
    let mut builder = Builder::default();
    builder.sheet(segments, sides, |column, row| {
        let outwards = around_y(column, segments);
        let (cos, sin) = turn(row, sides);
        let normal = -outwards * cos - DVec3::Y * sin;
        Vertex {
            position: outwards * (radius - tube * cos) - DVec3::Y * (tube * sin),
            normal,
            uv: DVec2::new(fraction(column, segments), fraction(row, sides)),
        }
    });
    builder.build()
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn is_closed_and_faces_outwards() {
        for (segments, sides) in [(3, 3), (7, 5), (64, 32)] {
            let mesh = torus(0.5, 0.2, segments, sides);
            check::assert_well_formed(&mesh);
            check::assert_watertight(&mesh);
            check::assert_uvs_fill_the_unit_square(&mesh);
            assert_eq!(mesh.triangles.len(), (2 * segments * sides) as usize);
        }
    }

    #[test]
    fn has_exact_bounds() {
        let upper = DVec3::new(0.75, 0.25, 0.75);
        assert_eq!(check::extent(&torus(0.5, 0.25, 64, 32)), (-upper, upper));
    }

    /// Pappus: the polygon's area times the way of its centre, with the sine of the chord angle in
    /// place of the angle, since the sweep is a polygon as well.
    #[test]
    fn volume_is_that_of_a_swept_polygon() {
        let (segments, sides) = (12_u32, 8_u32);
        let polygon_area = |n: u32| f64::from(n) / 2.0 * (TAU / f64::from(n)).sin();
        let mean_radius_sum = polygon_area(sides) * 0.2 * 0.2 * 0.5;
        let mesh = torus(0.5, 0.2, segments, sides);
        check::assert_close(check::volume(&mesh), 2.0 * polygon_area(segments) * mean_radius_sum);
    }

    #[test]
    fn normals_point_from_the_middle_of_the_tube() {
        let mesh = torus(0.5, 0.2, 16, 8);
        for (i, normal) in (0..).zip(&mesh.normals) {
            let p = check::model_position(&mesh, i);
            let middle = DVec3::new(p.x, 0.0, p.z).normalize() * 0.5;
            assert!(((p - middle) / 0.2 - normal.as_dvec3()).length() < 1e-6);
        }
    }
}
