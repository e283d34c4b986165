//! Vertex normals for meshes that come without.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Faces whose normals differ by more than this meet in a crease.
pub const CREASE_DEG: f64 = 60.0;

/// Cosine of [`CREASE_DEG`], a little less so that 60° exactly, give or take rounding, is smooth.
const COS_CREASE: f64 = 0.5 - 1e-9;

/// Cosine of 15°: above [`MAX_GROUPS`] faces at one point, those closer than this count as one.
const COS_POOL: f64 = 0.965_925_826_289_068_3;

/// Faces that are told apart at one point. At most 233 directions can be 15° or more apart (that
/// many caps of 7.5° have the area of the sphere), so pooling never leaves more groups than this.
const MAX_GROUPS: usize = 256;

/// Normals of triangle corners: indices into a list of distinct ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CornerNormals {
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// An index into `normals` for each corner of each triangle.
    pub corners: Vec<[u32; 3]>,
}

/// `v` scaled to length 1; `None` for zero and what is not finite.
///
/// Scaled by its largest component first, or the squares of 1e-200 and 1e200 leave the range of f64.
#[must_use]
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !v.is_finite() || largest == 0.0 {
        return None;
    }
    let scaled = v / largest;
    Some(scaled / scaled.length())
}

/// Normals for every corner of `triangles`, which index `positions`.
///
/// A corner's normal is the mean of the normals of all faces at its position that lie within
/// [`CREASE_DEG`] of its own face, each weighted by its angle there (G. Thürmer, C. A. Wüthrich,
/// "Computing Vertex Normals from Polygonal Facets", 1998), so that the result does not depend on
/// how faces are split into triangles. Faces meet where their positions are equal, whether or not
/// they share an index. Corners of triangles without area take the mean of all faces there.
///
/// At points with more than 256 faces, those within 15° of each other are pooled first: the time
/// stays proportional to the number of corners.
///
/// # Panics
/// If an index lies outside `positions`.
#[must_use]
pub fn generate(positions: &[DVec3], triangles: &[[u32; 3]]) -> CornerNormals {
    let faces: Vec<Option<Face>> =
        triangles.par_iter().map(|triangle| Face::of(positions, *triangle)).collect();
    let around = Incidence::new(&weld(positions), triangles);
    let mut normals = Vec::new();
    let mut corners = vec![[0; 3]; triangles.len()];
    let mut groups = Groups::default();
    for meeting in around.points() {
        let face = |corner: &CornerId| {
            faces[corner.triangle()].map(|face| (face.normal, face.angles[corner.place()]))
        };
        groups.settle(meeting.iter().map(face), &mut normals);
        for (corner, group) in meeting.iter().zip(&groups.of_corner) {
            corners[corner.triangle()][corner.place()] = groups.normal_of(*group);
        }
    }
    CornerNormals { normals, corners }
}

/// Unit normal of a counter-clockwise triangle; `None` without area.
#[must_use]
pub fn face_normal(positions: &[DVec3], [a, b, c]: [u32; 3]) -> Option<DVec3> {
    let [a, b, c] = [a, b, c].map(|i| positions[i as usize]);
    let (ab, ac) = (b - a, c - a);
    let extent = ab.abs().max(ac.abs()).max_element();
    if extent == 0.0 {
        return None;
    }
    unit((ab / extent).cross(ac / extent))
}

/// One of the three corners of a triangle.
#[derive(Clone, Copy)]
pub(super) struct CornerId(u32);

impl CornerId {
    pub(super) fn triangle(self) -> usize {
        self.0 as usize / 3
    }

    pub(super) fn place(self) -> usize {
        self.0 as usize % 3
    }
}

/// A triangle that has area.
#[derive(Clone, Copy)]
pub(super) struct Face {
    /// Unit normal.
    normal: DVec3,
    /// Angles at its corners in radians.
    pub(super) angles: [f64; 3],
}

impl Face {
    pub(super) fn of(positions: &[DVec3], triangle: [u32; 3]) -> Option<Self> {
        let normal = face_normal(positions, triangle)?;
        let corners = triangle.map(|i| positions[i as usize]);
        let angle = |k: usize| {
            let [at, next, last] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
            let (a, b) = (unit(next - at)?, unit(last - at)?);
            Some(libm::atan2(a.cross(b).length(), a.dot(b)))
        };
        let angles = [0, 1, 2].map(|k| angle(k).unwrap_or(0.0));
        Some(Self { normal, angles })
    }
}

/// For every position the index of the first one with the same coordinates.
fn weld(positions: &[DVec3]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let bits = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits); // −0 + 0 is 0: both zeros are one place
    (0..).zip(positions).map(|(i, p)| *first.entry(bits(*p)).or_insert(i)).collect()
}

/// Which corners meet at each welded position: `corners[ends[p − 1]..ends[p]]` for position p.
pub(super) struct Incidence {
    ends: Vec<u32>,
    corners: Vec<CornerId>,
}

impl Incidence {
    /// Counts, then scatters; corners stay in the order of triangles.
    pub(super) fn new(welded: &[u32], triangles: &[[u32; 3]]) -> Self {
        let place = |index: u32| welded[index as usize] as usize;
        let mut ends = vec![0u32; welded.len() + 1];
        for index in triangles.as_flattened() {
            ends[place(*index) + 1] += 1;
        }
        for p in 0..welded.len() {
            ends[p + 1] += ends[p];
        }
        let mut corners = vec![CornerId(0); triangles.len() * 3];
        for (corner, index) in (0..).zip(triangles.as_flattened()) {
            let slot = &mut ends[place(*index)];
            corners[*slot as usize] = CornerId(corner);
            *slot += 1;
        }
        // Every entry has moved on to where the next position's corners begin.
        ends.pop();
        Self { ends, corners }
    }

    /// The corners at each position that has any.
    pub(super) fn points(&self) -> impl Iterator<Item = &[CornerId]> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        begins
            .zip(&self.ends)
            .map(|(begin, end)| &self.corners[begin as usize..*end as usize])
            .filter(|corners| !corners.is_empty())
    }
}

/// The faces at one point, each with what it adds to a normal.
#[derive(Default)]
struct Groups {
    list: Vec<Group>,
    /// Group of each corner added; `None` for faces without area.
    of_corner: Vec<Option<usize>>,
    /// Index of the normal that corners without area get.
    fallback: u32,
}

struct Group {
    /// Unit normal of its first face.
    direction: DVec3,
    /// Sum of unit normal × angle over its faces.
    sum: DVec3,
    /// Index of its corners' normal.
    normal: u32,
}

impl Groups {
    /// Groups the faces of a point, each a unit normal and an angle there, or `None` without area, and
    /// appends the normals of its corners to `normals`, equal ones once.
    fn settle(
        &mut self,
        faces: impl ExactSizeIterator<Item = Option<(DVec3, f64)>>,
        normals: &mut Vec<Vec3>,
    ) {
        self.list.clear();
        self.of_corner.clear();
        let pooled = faces.len() > MAX_GROUPS;
        for face in faces {
            let group = face.map(|(normal, angle)| self.join(normal, normal * angle, pooled));
            self.of_corner.push(group);
        }
        let first_normal = normals.len();
        for group in 0..self.list.len() {
            let direction = self.list[group].direction;
            let smooth = self.list.iter().filter(|other| other.direction.dot(direction) >= COS_CREASE);
            let sum: DVec3 = smooth.map(|other| other.sum).sum();
            self.list[group].normal = push_distinct(normals, first_normal, unit(sum).unwrap_or(direction));
        }
        if self.of_corner.contains(&None) {
            let sum: DVec3 = self.list.iter().map(|group| group.sum).sum();
            self.fallback = push_distinct(normals, first_normal, unit(sum).unwrap_or(DVec3::Y));
        }
    }

    /// The group of a face: one of its own, or when `pooled` the first within 15°.
    fn join(&mut self, direction: DVec3, sum: DVec3, pooled: bool) -> usize {
        let is_near = |group: &Group| group.direction.dot(direction) >= COS_POOL;
        let near = if pooled { self.list.iter().position(is_near) } else { None };
        if let Some(group) = near {
            self.list[group].sum += sum;
            return group;
        }
        self.list.push(Group { direction, sum, normal: 0 });
        self.list.len() - 1
    }

    fn normal_of(&self, group: Option<usize>) -> u32 {
        group.map_or(self.fallback, |group| self.list[group].normal)
    }
}

/// Index of `normal`, found among those from `first` on or appended.
fn push_distinct(normals: &mut Vec<Vec3>, first: usize, normal: DVec3) -> u32 {
    let normal = normal.as_vec3();
    let found = normals[first..].iter().position(|other| *other == normal);
    let index = found.map_or(normals.len(), |i| first + i);
    if found.is_none() {
        normals.push(normal);
    }
    u32::try_from(index).expect("invariant: no more normals than corners, which are counted in u32")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn box_corners() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1));
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    #[test]
    fn a_box_has_flat_faces() {
        let (positions, triangles) = box_corners();
        let generated = generate(&positions, &triangles);
        for (triangle, corners) in triangles.iter().zip(&generated.corners) {
            let flat = face_normal(&positions, *triangle).unwrap().as_vec3();
            assert!(corners.iter().all(|i| generated.normals[*i as usize] == flat));
        }
        assert_eq!(generated.normals.len(), 24);
    }

    #[test]
    fn a_shallow_roof_is_smooth_also_where_indices_differ() {
        let roof = |peak: f64| {
            let left = [DVec3::ZERO, DVec3::new(1., peak, 0.), DVec3::new(1., peak, -1.)];
            let right = [DVec3::new(2., 0., 0.), DVec3::new(1., peak, -1.), DVec3::new(1., peak, 0.)];
            generate(&[left, right].concat(), &[[0, 1, 2], [3, 4, 5]])
        };
        let smooth = roof(0.5);
        assert_eq!(smooth.corners[0][1], smooth.corners[1][2]);
        let sharp = roof(5.0);
        assert_ne!(sharp.normals[sharp.corners[0][1] as usize], sharp.normals[sharp.corners[1][2] as usize]);
    }

    #[test]
    fn the_tip_of_a_fine_cone_takes_linear_time() {
        let n = 20_000u32;
        let rim = |i: u32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
            DVec3::new(cos, 0.0, -sin)
        };
        let positions: Vec<DVec3> = std::iter::once(DVec3::Y).chain((0..n).map(rim)).collect();
        let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let generated = generate(&positions, &triangles);
        for (triangle, [tip, ..]) in triangles.iter().zip(&generated.corners) {
            let flat = face_normal(&positions, *triangle).unwrap().as_vec3();
            assert!(generated.normals[*tip as usize].dot(flat) > 0.8);
        }
    }

    #[test]
    fn triangles_without_area_get_a_unit_normal() {
        let generated = generate(&[DVec3::ZERO, DVec3::X], &[[0, 0, 1], [1, 1, 1]]);
        assert!(generated.normals.iter().all(|n| *n == Vec3::Y));
    }

    #[test]
    fn unit_takes_any_scale() {
        for scale in [5e-324, 1e-200, 1e-30, 1.0, 1e30, 1e200] {
            let n = unit(DVec3::new(scale, scale, 0.0)).unwrap();
            assert!((n.length() - 1.0).abs() < 1e-15 && (n.x - n.y).abs() < 1e-15);
        }
        assert_eq!(unit(DVec3::ZERO), None);
        assert_eq!(unit(DVec3::new(f64::NAN, 1.0, 0.0)), None);
        assert_eq!(unit(DVec3::new(f64::INFINITY, 1.0, 0.0)), None);
    }

    proptest! {
        #[test]
        fn normals_are_units_on_their_faces_side(
            points in prop::collection::vec((-2i8..3, -2i8..3, -2i8..3), 3..10),
            corners in prop::collection::vec(any::<[prop::sample::Index; 3]>(), 1..150),
        ) {
            let positions: Vec<DVec3> = points.iter().map(|(x, y, z)| DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z))).collect();
            let index = |i: &prop::sample::Index| u32::try_from(i.index(positions.len())).unwrap();
            let triangles: Vec<[u32; 3]> = corners.iter().map(|[a, b, c]| [index(a), index(b), index(c)]).collect();
            let generated = generate(&positions, &triangles);
            for (triangle, corners) in triangles.iter().zip(&generated.corners) {
                for i in corners {
                    let normal = generated.normals[*i as usize].as_dvec3();
                    prop_assert!((normal.length() - 1.0).abs() < 1e-6);
                    if let Some(flat) = face_normal(&positions, *triangle) {
                        prop_assert!(normal.dot(flat) > 0.0);
                    }
                }
            }
        }
    }
}
