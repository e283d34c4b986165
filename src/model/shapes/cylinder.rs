//! A cylinder, and the flat discs that cap it.

use super::Mesh;
use super::builder::{Builder, Vertex, around_y, fraction, steps};
use glam::{DVec2, DVec3};

/// An upright cylinder with flat caps; `segments` (at least 3) around.
///
/// On the side u runs around and v up; a cap shows the disc inscribed in the unit square.
#[must_use]
pub fn cylinder(radius: f64, height: f64, segments: u32) -> Mesh {
    let segments = steps(segments, 3);
    let mut builder = Builder::default();
    builder.sheet(segments, 1, |column, row| {
        let (normal, v) = (around_y(column, segments), f64::from(row));
        Vertex {
            position: normal * radius + DVec3::Y * (height * (v - 0.5)),
            normal,
            uv: DVec2::new(fraction(column, segments), v),
        }
    });
    cap(&mut builder, DVec3::Y, radius, height, segments);
    cap(&mut builder, DVec3::NEG_Y, radius, height, segments);
    builder.build()
}

/// The disc that faces `out` (+y or −y), half of `height` away from the origin.
///
/// Right is +x in its picture; up is −z on the upper and +z on the lower cap, like a box's.
pub(super) fn cap(builder: &mut Builder, out: DVec3, radius: f64, height: f64, segments: u32) {
    let vertex = |disc: DVec3| Vertex {
        position: disc * radius + out * (height * 0.5),
        normal: out,
        uv: DVec2::new(0.5 + 0.5 * disc.x, 0.5 - 0.5 * disc.z * out.y),
    };
    let rim = (0..=segments).map(|step| {
        // Columns run counter-clockwise seen from above, so clockwise from below.
        around_y(if out.y > 0.0 { step } else { segments - step }, segments)
    });
    builder.fan(vertex(DVec3::ZERO), rim.map(vertex));
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn is_closed_and_faces_outwards() {
        for segments in [3, 7, 64] {
            let mesh = cylinder(0.5, 2.0, segments);
            check::assert_well_formed(&mesh);
            check::assert_watertight(&mesh);
            check::assert_uvs_fill_the_unit_square(&mesh);
            assert_eq!(mesh.triangles.len(), (4 * segments) as usize);
        }
    }

    #[test]
    fn has_exact_bounds() {
        let upper = DVec3::new(0.3, 1.0, 0.3);
        assert_eq!(check::extent(&cylinder(0.3, 2.0, 64)), (-upper, upper));
    }

    #[test]
    fn volume_is_that_of_a_prism() {
        let n = 10.0;
        let base = n / 2.0 * (TAU / n).sin() * 0.3 * 0.3;
        check::assert_close(check::volume(&cylinder(0.3, 2.0, 10)), base * 2.0);
    }

    #[test]
    fn the_edge_between_side_and_cap_is_sharp() {
        let mesh = cylinder(0.5, 1.0, 16);
        assert!(mesh.normals.iter().all(|n| n.y == 0.0 || n.y.abs() == 1.0));
    }
}
