//! A cone.

use super::Mesh;
use super::builder::{Builder, Vertex, around_y, fraction, steps};
use super::cylinder::cap;
use glam::{DVec2, DVec3};

/// An upright cone with a flat base; `segments` (at least 3) around.
///
/// On the side u runs around and v up. The apex has no normal of its own: each triangle has an apex
/// vertex with the normal, and the u, of the triangle's middle.
#[must_use]
pub fn cone(radius: f64, height: f64, segments: u32) -> Mesh {
    let segments = steps(segments, 3);
    let mut builder = Builder::default();
    builder.sheet(segments, 1, |column, row| {
        let apex = row == 1;
        // The triangle of a quad whose upper corners coincide keeps the right one of them.
        let half_columns = if apex { (2 * column).saturating_sub(1) } else { 2 * column };
        let outwards = around_y(half_columns, 2 * segments);
        let (v, width) = if apex { (1.0, 0.0) } else { (0.0, radius) };
        Vertex {
            position: outwards * width + DVec3::Y * (height * (v - 0.5)),
            normal: outwards * height + DVec3::Y * radius,
            uv: DVec2::new(fraction(half_columns, 2 * segments), v),
        }
    });
    cap(&mut builder, DVec3::NEG_Y, radius, height, segments);
    builder.build()
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn is_closed_and_faces_outwards() {
        for segments in [3, 7, 64] {
            let mesh = cone(0.5, 1.0, segments);
            check::assert_well_formed(&mesh);
            check::assert_watertight(&mesh);
            check::assert_uvs_fill_the_unit_square(&mesh);
            assert_eq!(mesh.triangles.len(), (2 * segments) as usize);
        }
    }

    #[test]
    fn has_exact_bounds() {
        let upper = DVec3::new(0.3, 1.0, 0.3);
        assert_eq!(check::extent(&cone(0.3, 2.0, 64)), (-upper, upper));
    }

    #[test]
    fn volume_is_that_of_a_pyramid() {
        let n = 10.0;
        let base = n / 2.0 * (TAU / n).sin() * 0.3 * 0.3;
        check::assert_close(check::volume(&cone(0.3, 2.0, 10)), base * 2.0 / 3.0);
    }

    #[test]
    fn side_normals_are_square_to_the_slope() {
        let mesh = cone(3.0, 4.0, 16);
        let side = mesh.normals.iter().filter(|n| n.y > -1.0);
        side.for_each(|n| assert!((n.y - 0.6).abs() < 1e-6, "{n}"));
    }
}
