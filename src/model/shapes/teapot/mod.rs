//! The Utah teapot.

mod data;

use super::Mesh;
use super::bezier::{Parameter, Patch};
use super::builder::{Builder, Vertex, around_y, fraction, pole_shift, steps};
use crate::limits::MAX_TEAPOT_SEGMENTS;
use data::{HANDLE, HEIGHT, LID, POT, Ring, SPOUT, Section};
use glam::{DVec2, DVec3};

/// Where the borders between the pot's patches lie in v: about as along its profile, so that a
/// picture is not stretched over the rim.
const POT_BORDERS_V: [f64; 5] = [0.0, 0.35, 0.56, 0.94, 1.0];
/// As [`POT_BORDERS_V`], for the lid.
const LID_BORDERS_V: [f64; 3] = [0.0, 0.6, 1.0];
/// As [`POT_BORDERS_V`], for handle and spout.
const SWEPT_BORDERS_V: [f64; 3] = [0.0, 0.5, 1.0];

/// Newell's teapot of the given `height`, its spout towards +x, the middle of its bounds at the
/// origin; `segments` (at least 1) along each side of its 32 patches.
///
/// It is no closed surface: a slit runs around the lid, and handle and spout begin inside the pot.
/// Each of pot, lid, handle and spout fills the unit square of texture coordinates: u around, v
/// from bottom to top, from the upper to the lower end of the handle, from the pot to the lip.
#[must_use]
pub fn teapot(height: f64, segments: u32) -> Mesh {
    let segments = steps(segments, 1).min(MAX_TEAPOT_SEGMENTS);
    let mut builder = Builder::default();
    add_turned(&mut builder, &POT, &POT_BORDERS_V, segments);
    add_turned(&mut builder, &LID, &LID_BORDERS_V, segments);
    add_swept(&mut builder, &HANDLE, &SWEPT_BORDERS_V, segments);
    add_swept(&mut builder, &SPOUT, &SWEPT_BORDERS_V, segments);
    // From 0–HEIGHT to exactly −height/2–height/2.
    builder.map_positions(|p| (p / HEIGHT - DVec3::Y * 0.5) * height);
    builder.centre();
    builder.build()
}

/// A profile turned around y: four patches for every three rings.
fn add_turned(builder: &mut Builder, profile: &[Ring], borders_v: &[f64], segments: u32) {
    for (i, v) in borders_v.windows(2).enumerate() {
        for quarter in 0..4 {
            let rows = std::array::from_fn(|row| quarter_ring(profile[3 * i + row], quarter));
            let u = [fraction(quarter, 4), fraction(quarter + 1, 4)];
            add_patch(builder, &Patch(rows), [u, [v[0], v[1]]], segments);
        }
    }
}

/// Halves of sections led along a curve, and their mirror images in z: two patches for every three
/// sections.
fn add_swept(builder: &mut Builder, sections: &[Section], borders_v: &[f64], segments: u32) {
    for (i, v) in borders_v.windows(2).enumerate() {
        let front: [[DVec3; 4]; 4] = std::array::from_fn(|row| half_section(sections[3 * i + row]));
        // Mirrored columns run the other way, and with that stay left to right.
        let back = front.map(|[a, b, c, d]| [d, c, b, a].map(|p| DVec3::new(p.x, p.y, -p.z)));
        add_patch(builder, &Patch(front), [[0.0, 0.5], [v[0], v[1]]], segments);
        add_patch(builder, &Patch(back), [[0.5, 1.0], [v[0], v[1]]], segments);
    }
}

/// Control points of one quarter of a ring.
fn quarter_ring([radius, tangent, height]: Ring, quarter: u32) -> [DVec3; 4] {
    let (from, to) = (around_y(quarter, 4), around_y(quarter + 1, 4));
    [from * radius, from * radius + to * tangent, from * tangent + to * radius, to * radius]
        .map(|p| p + DVec3::Y * height)
}

/// Control points of the half of a section on the side of +z.
fn half_section([start_x, start_y, end_x, end_y, width]: Section) -> [DVec3; 4] {
    [
        DVec3::new(start_x, start_y, 0.0),
        DVec3::new(start_x, start_y, width),
        DVec3::new(end_x, end_y, width),
        DVec3::new(end_x, end_y, 0.0),
    ]
}

/// A patch as a sheet over the part `u × v` of the unit square.
fn add_patch(builder: &mut Builder, patch: &Patch, [u, v]: [[f64; 2]; 2], segments: u32) {
    let is_pole = |row: u32| {
        let border = &patch.0[if row == 0 { 0 } else { 3 }];
        border[1..] == [border[0]; 3]
    };
    builder.sheet(segments, segments, |column, row| {
        let (along_u, along_v) = (Parameter::new(column, segments), Parameter::new(row, segments));
        let shift = if is_pole(row) { pole_shift(row, segments) } else { 0.0 };
        let local = DVec2::new((f64::from(column) + shift) / f64::from(segments), fraction(row, segments));
        Vertex {
            position: patch.point(along_u, along_v),
            normal: patch.normal(along_u, along_v),
            uv: DVec2::new(u[0] + (u[1] - u[0]) * local.x, v[0] + (v[1] - v[0]) * local.y),
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::check;
    use super::*;

    #[test]
    fn faces_outwards_and_fills_the_unit_square() {
        // Below 8 segments the flat triangles of lip and rim cut off more than a right angle.
        for segments in [8, 10, 16] {
            let mesh = teapot(1.0, segments);
            check::assert_well_formed(&mesh);
            check::assert_uvs_fill_the_unit_square(&mesh);
        }
    }

    /// Both measures are those of the public-domain tessellation of 6320 triangles with 10 segments
    /// a patch, whose vertices are rounded to 1e-6. They move with every number of the tables.
    #[test]
    fn has_area_and_flux_of_the_published_tessellation() {
        let mesh = teapot(HEIGHT, 10);
        let area: f64 = mesh.triangles.iter().map(|t| check::face_normal(&mesh, *t).length() / 2.0).sum();
        assert!((area - 52.660_793).abs() < 1e-5, "{area}");

        // Flux of p/3 out of the open surface, p from the middle of its bounds.
        let flux: f64 = mesh
            .triangles
            .iter()
            .map(|t| check::model_position(&mesh, t[0]).dot(check::face_normal(&mesh, *t)) / 6.0)
            .sum();
        assert!((flux - 26.219_745).abs() < 1e-5, "{flux}");
    }

    #[test]
    fn has_the_size_of_the_published_tessellation() {
        let (lower, upper) = check::extent(&teapot(HEIGHT, 10));
        assert!((upper - lower - DVec3::new(6.434, 3.15, 4.0)).abs().max_element() < 1e-5);
    }

    #[test]
    fn is_its_own_mirror_image_in_z() {
        let mesh = teapot(1.0, 8);
        let points = |mirror: f64| {
            let all =
                (0..u32::try_from(mesh.vertex_count()).unwrap()).map(|i| check::model_position(&mesh, i));
            // Positions went through the lower corner of the bounds and back: equal to about 1e-16.
            let mut rounded: Vec<_> =
                all.map(|p| [p.x, p.y, p.z * mirror].map(|c| (c * 1e12).round())).collect();
            rounded.sort_by(|a, b| a.partial_cmp(b).unwrap());
            rounded
        };
        assert_eq!(points(1.0), points(-1.0));
    }

    #[test]
    fn the_knob_points_straight_up() {
        let mesh = teapot(1.0, 8);
        let top: Vec<u32> =
            (0..).take(mesh.vertex_count()).filter(|i| check::model_position(&mesh, *i).y == 0.5).collect();
        assert_eq!(top.len(), 4 * 8);
        assert!(top.iter().all(|i| mesh.normals[*i as usize].y == 1.0));
    }

    #[test]
    fn has_two_triangles_a_quad_but_one_at_the_poles() {
        for segments in [1, 8, 10] {
            let expected = 32 * 2 * segments * segments - 8 * segments;
            assert_eq!(teapot(1.0, segments).triangles.len(), expected as usize);
        }
    }

    #[test]
    fn is_open_only_at_lid_rim_handle_and_spout() {
        for segments in [2, 3, 8] {
            let open = 2 * 4 * segments + 2 * 2 * segments + 2 * 2 * segments;
            assert_eq!(check::open_edges(&teapot(1.0, segments)), open as usize);
        }
    }

    #[test]
    fn is_centred_and_of_the_given_height() {
        for height in [1.0, 0.7, 3.15] {
            let (lower, upper) = check::extent(&teapot(height, 8));
            assert_eq!((lower.y, upper.y), (-height / 2.0, height / 2.0));
            assert_eq!(lower.z, -upper.z);
            assert!((lower.x + upper.x).abs() < 1e-15);
        }
    }
}
