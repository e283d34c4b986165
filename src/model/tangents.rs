//! The directions in which texture coordinates grow over a mesh: what normal and bump maps are laid
//! along.

use super::Mesh;
use super::normals::{CornerId, Face, Incidence, unit};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Cosine of 60°: directions of u that are farther apart at a point than this stay apart, as around
/// the pole of a fan.
const COS_SMOOTH: f64 = 0.5;

/// Sine of the angle in the texture below which a triangle covers none of it.
const LEAST_SINE: f64 = 1e-12;

/// Lengths of [`Frame`]'s vectors are held to 1e-30–1e30, so that f32 takes them and their inverses.
const LONGEST: f64 = 1e30;

/// How texture coordinates lie on a surface at a corner, in model space; the vectors need not be
/// perpendicular to each other. Zero where the texture has no direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// ∂P/∂u: model units a unit of u, in the plane of the corner's normal.
    pub along_u: Vec3,
    /// ∂P/∂v.
    pub along_v: Vec3,
}

/// Frames of a mesh's triangle corners: indices into a list of distinct ones.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Tangents {
    frames: Vec<Frame>,
    /// An index into `frames` for each corner of each triangle.
    corners: Vec<[u32; 3]>,
}

impl Tangents {
    /// The frames of `mesh`; `None` if it has no texture coordinates.
    ///
    /// As MikkTSpace has them, which normal maps are baked for (M. Mikkelsen, "Simulation of Wrinkled
    /// Surfaces Revisited", 2008): triangles that meet with equal position, normal and texture
    /// coordinates share a direction, the mean of their own ones in the plane of the normal, weighted
    /// by their angles; mirrored ones stay apart from others, which keeps each triangle's
    /// handedness. Two things differ: coordinates that are whole turns apart count as equal, since a
    /// picture that repeats has no seam there, and directions more than 60° apart are not averaged.
    /// Lengths are the mean of the triangles' own. Corners of triangles without area, on the surface
    /// or in the texture, take the first frame at their point.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let uvs = mesh.uvs.as_ref()?;
        let count = u32::try_from(mesh.vertex_count()).expect("invariant: vertices are counted in u32");
        let positions: Vec<DVec3> = (0..count).map(|i| mesh.position(i)).collect();
        let slopes: Vec<Option<Slopes>> =
            mesh.triangles.par_iter().map(|triangle| Slopes::of(&positions, uvs, *triangle)).collect();
        let around = Incidence::new(&weld(mesh, &positions, uvs), &mesh.triangles);
        let mut tangents = Self { frames: Vec::new(), corners: vec![[0; 3]; mesh.triangles.len()] };
        let mut groups = Vec::new();
        for meeting in around.points() {
            let vertex = mesh.triangles[meeting[0].triangle()][meeting[0].place()];
            tangents.settle(meeting, &slopes, mesh.normals[vertex as usize].as_dvec3(), &mut groups);
        }
        Some(tangents)
    }

    /// The frames of a triangle's corners.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    #[must_use]
    pub fn of_triangle(&self, triangle: u32) -> [Frame; 3] {
        self.corners[triangle as usize].map(|i| self.frames[i as usize])
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.frames.as_slice()) + size_of_val(self.corners.as_slice())) as u64
    }

    /// Gives the corners that meet at one point, whose unit normal is `normal`, their frames.
    fn settle(
        &mut self,
        meeting: &[CornerId],
        slopes: &[Option<Slopes>],
        normal: DVec3,
        groups: &mut Vec<Group>,
    ) {
        groups.clear();
        let first = u32::try_from(self.frames.len()).expect("invariant: corners are counted in u32");
        for corner in meeting {
            let joined = slopes[corner.triangle()].as_ref().and_then(|s| join(groups, s, *corner, normal));
            self.corners[corner.triangle()][corner.place()] = first + joined.unwrap_or(0);
        }
        self.frames.extend(groups.iter().map(Group::frame));
        if groups.is_empty() {
            self.frames.push(Frame::default());
        }
    }
}

/// How texture coordinates grow over one triangle.
#[derive(Clone, Copy)]
struct Slopes {
    /// ∂P/∂u.
    along_u: DVec3,
    /// ∂P/∂v.
    along_v: DVec3,
    /// Whether the texture shows its back.
    mirrored: bool,
    /// Angles at the corners in radians.
    angles: [f64; 3],
}

impl Slopes {
    /// `None` without area, on the surface or in the texture.
    ///
    /// Solves `P₁ − P₀ = ∂P/∂u Δu₁ + ∂P/∂v Δv₁` and the same for corner 2.
    fn of(positions: &[DVec3], uvs: &[DVec2], triangle: [u32; 3]) -> Option<Self> {
        let angles = Face::of(positions, triangle)?.angles;
        let [p0, p1, p2] = triangle.map(|i| positions[i as usize]);
        let [c0, c1, c2] = triangle.map(|i| uvs[i as usize]);
        // Both scaled to order one, so that no product leaves the range of f64.
        let (edges, extent) = ([p1 - p0, p2 - p0], largest(&[p1 - p0, p2 - p0]));
        let (steps, span) = ([c1 - c0, c2 - c0], largest(&[(c1 - c0).extend(0.0), (c2 - c0).extend(0.0)]));
        if span == 0.0 || !span.is_finite() {
            return None;
        }
        let ([e1, e2], [d1, d2]) = (edges.map(|e| e / extent), steps.map(|d| d / span));
        let area = d1.perp_dot(d2);
        if area.abs() <= LEAST_SINE * d1.length() * d2.length() {
            return None;
        }
        let per_unit = extent / span / area;
        let along_u = (e1 * d2.y - e2 * d1.y) * per_unit;
        let along_v = (e2 * d1.x - e1 * d2.x) * per_unit;
        Some(Self { along_u, along_v, mirrored: area < 0.0, angles })
    }
}

/// Largest magnitude of a component.
fn largest(vectors: &[DVec3; 2]) -> f64 {
    vectors[0].abs().max(vectors[1].abs()).max_element()
}

/// Triangles around a point that share a frame.
struct Group {
    mirrored: bool,
    /// Unit direction of u in its first triangle.
    direction: DVec3,
    /// Sums of unit direction × angle, of u and of v.
    sums: [DVec3; 2],
    /// Sums of length × angle.
    lengths: [f64; 2],
    /// Sum of the angles.
    weight: f64,
}

/// Adds a triangle's corner to the first group that it fits into, or to one of its own; the group's
/// place in the list. `None` if u runs along the normal.
///
/// Groups of one handedness are 60° or more apart, so there are never more than a dozen.
fn join(groups: &mut Vec<Group>, slopes: &Slopes, corner: CornerId, normal: DVec3) -> Option<u32> {
    let in_plane = |v: DVec3| unit(v - normal * normal.dot(v));
    let directions = [in_plane(unit(slopes.along_u)?)?, in_plane(unit(slopes.along_v)?)?];
    let fits = |g: &Group| g.mirrored == slopes.mirrored && g.direction.dot(directions[0]) >= COS_SMOOTH;
    let place = groups.iter().position(fits).unwrap_or(groups.len());
    if place == groups.len() {
        let (sums, lengths) = ([DVec3::ZERO; 2], [0.0; 2]);
        let direction = directions[0];
        groups.push(Group { mirrored: slopes.mirrored, direction, sums, lengths, weight: 0.0 });
    }
    // A triangle so thin that its angle is lost still has a direction.
    let angle = slopes.angles[corner.place()].max(1e-9);
    let group = &mut groups[place];
    for (axis, along) in [slopes.along_u, slopes.along_v].into_iter().enumerate() {
        group.sums[axis] += directions[axis] * angle;
        group.lengths[axis] += along.length().min(LONGEST) * angle;
    }
    group.weight += angle;
    u32::try_from(place).ok()
}

impl Group {
    fn frame(&self) -> Frame {
        let along = |axis: usize| {
            let length = (self.lengths[axis] / self.weight).clamp(1.0 / LONGEST, LONGEST);
            (unit(self.sums[axis]).unwrap_or(DVec3::ZERO) * length).as_vec3()
        };
        Frame { along_u: along(0), along_v: along(1) }
    }
}

/// For every vertex the index of the first one with the same position, normal and texture coordinates,
/// but for whole turns of these.
fn weld(mesh: &Mesh, positions: &[DVec3], uvs: &[DVec2]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let key = |i: usize| {
        // −0 + 0 is 0: both zeros are one place.
        let normal = (mesh.normals[i] + 0.0).to_array().map(f32::to_bits);
        let turned = uvs[i] - uvs[i].floor();
        ((positions[i] + 0.0).to_array().map(f64::to_bits), normal, turned.to_array().map(f64::to_bits))
    };
    (0..).zip(0..positions.len()).map(|(i, vertex)| *first.entry(key(vertex)).or_insert(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::shapes;
    use crate::model::{Corner, MeshSource, Part};

    /// Triangles with a position, a texture coordinate and a normal for each corner's index.
    fn mesh(positions: &[[f64; 3]], uvs: &[[f64; 2]], normal: Vec3, triangles: &[[u32; 3]]) -> Mesh {
        let corner = |i: u32| Corner { position: i, uv: i, normal: 0 };
        Mesh::build(MeshSource {
            positions: positions.iter().copied().map(DVec3::from_array).collect(),
            uvs: uvs.iter().copied().map(DVec2::from_array).collect(),
            normals: vec![normal],
            triangles: triangles.iter().map(|t| t.map(corner)).collect(),
            parts: vec![Part { first_triangle: 0, slot: 0 }],
            ..MeshSource::default()
        })
        .unwrap()
    }

    /// Two quads beside each other in the plane z = 0, their coordinates as given.
    fn quads(u: [f64; 3]) -> Mesh {
        let positions =
            [[-1., 0., 0.], [0., 0., 0.], [1., 0., 0.], [-1., 2., 0.], [0., 2., 0.], [1., 2., 0.]];
        let uvs = [[u[0], 0.], [u[1], 0.], [u[2], 0.], [u[0], 1.], [u[1], 1.], [u[2], 1.]];
        mesh(&positions, &uvs, Vec3::Z, &[[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    }

    #[test]
    fn a_plane_has_its_own_axes_and_lengths() {
        let tangents = Tangents::of(&shapes::plane([4.0, 6.0], [2.0, 0.5])).unwrap();
        for triangle in 0..2 {
            for frame in tangents.of_triangle(triangle) {
                assert!((frame.along_u - Vec3::X * 2.0).length() < 1e-6, "{frame:?}");
                assert!((frame.along_v + Vec3::Z * 12.0).length() < 1e-5, "{frame:?}");
            }
        }
    }

    #[test]
    fn both_sides_of_a_mirrored_seam_keep_their_handedness() {
        let tangents = Tangents::of(&quads([0.0, 1.0, 0.0])).unwrap();
        for (triangle, side) in [(0, 1.0), (1, 1.0), (2, -1.0), (3, -1.0)] {
            for frame in tangents.of_triangle(triangle) {
                assert!((frame.along_u - Vec3::X * side).length() < 1e-6, "{triangle}: {frame:?}");
                assert!((frame.along_v - Vec3::Y * 2.0).length() < 1e-6, "{triangle}: {frame:?}");
            }
        }
    }

    #[test]
    fn lengths_are_averaged_where_triangles_meet() {
        let tangents = Tangents::of(&quads([0.0, 1.0, 1.5])).unwrap();
        let [outer, seam, _] = tangents.of_triangle(0);
        assert!((outer.along_u - Vec3::X).length() < 1e-6);
        assert!(seam.along_u.x > 1.2 && seam.along_u.x < 1.8, "{seam:?}");
        assert_eq!(seam, tangents.of_triangle(2)[0]);
    }

    #[test]
    fn a_sphere_has_no_seam_and_no_facets() {
        let ball = shapes::sphere(1.0, 24, 12);
        let tangents = Tangents::of(&ball).unwrap();
        for (triangle, corners) in (0..).zip(&ball.triangles) {
            for (frame, vertex) in tangents.of_triangle(triangle).iter().zip(corners) {
                let normal = ball.normals[*vertex as usize].as_dvec3();
                let east = DVec3::Y.cross(normal);
                assert!(
                    frame.along_u.as_dvec3().dot(normal).abs() < 1e-6 * f64::from(frame.along_u.length())
                );
                if east.length() > 1e-3 {
                    let off = unit(frame.along_u.as_dvec3()).unwrap().cross(unit(east).unwrap()).length();
                    assert!(off < 1e-6, "{off} at {normal}");
                    assert!(frame.along_u.as_dvec3().dot(east) > 0.0 && frame.along_v.y > 0.0);
                } else {
                    assert!(frame.along_u.length() > 0.1, "a pole has a direction for each triangle");
                }
            }
        }
    }

    #[test]
    fn what_covers_no_texture_takes_its_neighbours_frame_or_none() {
        let positions = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [5., 0., 0.], [6., 0., 0.], [5., 1., 0.]];
        let uvs = [[0., 0.], [1., 0.], [0., 1.], [0.5, 0.5], [0.5, 0.5], [0.5, 0.5]];
        let tangents =
            Tangents::of(&mesh(&positions, &uvs, Vec3::Z, &[[0, 1, 2], [0, 1, 1], [3, 4, 5]])).unwrap();
        assert_eq!(tangents.of_triangle(1)[0], tangents.of_triangle(0)[0]);
        assert_eq!(tangents.of_triangle(2), [Frame::default(); 3]);
        assert_eq!(Tangents::of(&Mesh { uvs: None, ..shapes::plane([1.0; 2], [1.0; 2]) }), None);
    }

    #[test]
    fn coordinates_of_any_scale_and_place_have_a_direction() {
        for scale in [1e-200, 1e-30, 1.0, 1e30, 1e36] {
            for (repeat, from) in [(1e-30, 0.0), (1.0, 1e6), (1e30, -1e25)] {
                let positions = [[0., 0., 0.], [scale, 0., 0.], [0., scale, 0.]];
                let uvs = [[from, from], [from + repeat, from], [from, from + repeat]];
                let tangents = Tangents::of(&mesh(&positions, &uvs, Vec3::Z, &[[0, 1, 2]])).unwrap();
                for frame in tangents.of_triangle(0) {
                    let direction = unit(frame.along_u.as_dvec3()).expect("a direction");
                    assert!((direction - DVec3::X).length() < 1e-6, "{scale:e} {repeat:e}: {frame:?}");
                    assert!(frame.along_v.is_finite() && frame.along_v.y > 0.0);
                }
            }
        }
    }

    #[test]
    fn a_fan_of_many_triangles_takes_linear_time() {
        let n = 100_000u32;
        let rim = (0..n).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
            [cos, sin, 0.0]
        });
        let positions: Vec<_> = std::iter::once([0.0; 3]).chain(rim).collect();
        // u runs around, v outwards: at the hub every direction of u meets every other.
        let uvs: Vec<_> = (0..=n).map(|i| if i == 0 { [0.5, 0.0] } else { [f64::from(i), 1.0] }).collect();
        let triangles: Vec<_> = (1..n).map(|i| [0, i, i + 1]).collect();
        let tangents = Tangents::of(&mesh(&positions, &uvs, Vec3::Z, &triangles)).unwrap();
        assert_eq!(tangents.corners.len(), triangles.len());
        assert!(tangents.frames.iter().all(|frame| frame.along_u.is_finite()));
    }
}
