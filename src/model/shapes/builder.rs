//! Gathers vertices and triangles and turns them into a [`Mesh`].

use super::Mesh;
use crate::limits::MAX_SHAPE_SEGMENTS;
use crate::math::Bounds;
use crate::model::Part;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// A vertex of the true surface, in model space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// Where it is.
    pub position: DVec3,
    /// Away from the surface; of any length but zero.
    pub normal: DVec3,
    /// Texture coordinates, v up.
    pub uv: DVec2,
}

/// A shape under construction.
#[derive(Debug, Default)]
pub(super) struct Builder {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    /// A sheet of `columns × rows` quads, two triangles each, less those that have no area.
    ///
    /// `vertex(column, row)` is called for 0 to `columns` and 0 to `rows`, both ends included. Seen
    /// from the front, columns run to the right and rows up.
    ///
    /// Of a quad the lower left and the upper right corner belong to both triangles:
    ///
    /// ```text
    /// row + 1   d ── c
    ///           │  ╱ │
    /// row       a ── b
    /// ```
    pub fn sheet(&mut self, columns: u32, rows: u32, vertex: impl Fn(u32, u32) -> Vertex) {
        let first = self.next_index();
        for row in 0..=rows {
            self.vertices.extend((0..=columns).map(|column| vertex(column, row)));
        }
        let at = |column, row| first + row * (columns + 1) + column;
        for row in 0..rows {
            for column in 0..columns {
                let (a, b) = (at(column, row), at(column + 1, row));
                let (c, d) = (at(column + 1, row + 1), at(column, row + 1));
                self.triangle([a, b, c]);
                self.triangle([a, c, d]);
            }
        }
    }

    /// A flat fan around `centre` over the `rim` of a disc, counter-clockwise seen from the front.
    /// The rim is closed by giving its first vertex again as its last.
    pub fn fan(&mut self, centre: Vertex, rim: impl IntoIterator<Item = Vertex>) {
        let hub = self.next_index();
        self.vertices.push(centre);
        self.vertices.extend(rim);
        for b in hub + 2..self.next_index() {
            self.triangle([hub, b - 1, b]);
        }
    }

    /// Adds a triangle unless two of its corners lie in one point.
    fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|i| self.vertices[i as usize].position);
        if a != b && b != c && c != a {
            self.triangles.push(corners);
        }
    }

    fn next_index(&self) -> u32 {
        u32::try_from(self.vertices.len()).expect("invariant: MAX_SHAPE_SEGMENTS keeps vertices below 2³²")
    }

    /// The mesh of all triangles. Vertices that none of them uses (at poles) are left out.
    pub fn build(mut self) -> Mesh {
        self.drop_unused_vertices();
        let bounds = Bounds::around(self.vertices.iter().map(|v| v.position));
        let origin = bounds.map_or(DVec3::ZERO, |b| b.min);
        let along = |axis: usize| self.vertices.iter().map(|v| v.position[axis] - origin[axis]).collect();
        Mesh {
            origin,
            positions: [along(0), along(1), along(2)],
            normals: self.vertices.iter().map(|v| v.normal.normalize_or(DVec3::Y).as_vec3()).collect(),
            uvs: Some(self.vertices.iter().map(|v| v.uv).collect()),
            colors: None,
            parts: if self.triangles.is_empty() { vec![] } else { vec![Part { first_triangle: 0, slot: 0 }] },
            triangles: self.triangles,
            slots: vec![None],
            bounds: bounds.map(|b| b.translated(-origin)),
        }
    }

    /// Replaces every position `p` by `map(p)`; normals stay as they are.
    pub fn map_positions(&mut self, map: impl Fn(DVec3) -> DVec3) {
        self.vertices.iter_mut().for_each(|v| v.position = map(v.position));
    }

    /// Moves the middle of the bounds to the origin.
    pub fn centre(&mut self) {
        if let Some(bounds) = Bounds::around(self.vertices.iter().map(|v| v.position)) {
            let centre = bounds.centre();
            self.map_positions(|p| p - centre);
        }
    }

    fn drop_unused_vertices(&mut self) {
        let mut used = vec![false; self.vertices.len()];
        self.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);

        let mut next = 0;
        let new_index: Vec<u32> = used
            .iter()
            .map(|&is_used| {
                let index = next;
                next += u32::from(is_used);
                index
            })
            .collect();

        self.triangles.iter_mut().flatten().for_each(|i| *i = new_index[*i as usize]);
        let mut keep = used.iter();
        self.vertices.retain(|_| *keep.next().expect("invariant: one flag a vertex"));
    }
}

/// Holds a count of steps to `at_least..=MAX_SHAPE_SEGMENTS`. A document that asks for more is refused
/// before it gets here; this is for direct calls.
pub(super) fn steps(count: u32, at_least: u32) -> u32 {
    count.clamp(at_least, MAX_SHAPE_SEGMENTS)
}

/// How many columns a vertex at a pole lies beside the column that it stands for: in the middle of
/// its triangle. Of a quad at the lower end of a sheet the triangle at the left upper corner is
/// left, at the upper end that at the right lower one.
pub(super) fn pole_shift(row: u32, rows: u32) -> f64 {
    match row {
        0 => 0.5,
        _ if row == rows => -0.5,
        _ => 0.0,
    }
}

/// `step / steps` as a fraction, 0 and 1 exactly at the ends.
pub(super) fn fraction(step: u32, steps: u32) -> f64 {
    f64::from(step) / f64::from(steps)
}

/// Cosine and sine of `step / steps` of a full turn.
///
/// Exact at multiples of 90°, equal to the bit after a full turn, and mirror images of one another
/// across the axes and diagonals: bounds come out exact and seams close.
pub(super) fn turn(step: u32, steps: u32) -> (f64, f64) {
    let quarters = 4 * u64::from(step);
    let steps = u64::from(steps);
    let (cos, sin) = quarter_turn(quarters % steps, steps);
    match (quarters / steps) % 4 {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    }
}

/// Cosine and sine of `step / steps` of 90°, for `step < steps`.
fn quarter_turn(step: u64, steps: u64) -> (f64, f64) {
    use std::cmp::Ordering::{Equal, Greater, Less};
    // Both are at most 4 · 2³², exact in f64.
    let angle = |step: u64| FRAC_PI_2 * (step as f64 / steps as f64);
    match (2 * step).cmp(&steps) {
        Less => (libm::cos(angle(step)), libm::sin(angle(step))),
        Equal => (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
        Greater => (libm::sin(angle(steps - step)), libm::cos(angle(steps - step))),
    }
}

/// The horizontal unit vector at `step / steps` of the way around the y axis: from −z over −x, +z
/// (half-way) and +x back to −z, which is left to right for every viewer outside.
pub(super) fn around_y(step: u32, steps: u32) -> DVec3 {
    let (cos, sin) = turn(step, steps);
    DVec3::new(-sin, 0.0, -cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_exact_at_right_angles() {
        assert_eq!(turn(0, 7), (1.0, 0.0));
        assert_eq!(turn(3, 12), (0.0, 1.0));
        assert_eq!(turn(6, 12), (-1.0, 0.0));
        assert_eq!(turn(9, 12), (0.0, -1.0));
        assert_eq!(turn(7, 7), (1.0, 0.0));
    }

    #[test]
    fn turns_are_mirror_images_across_the_axes() {
        for steps in [4, 12, 64, 100] {
            for step in 0..=steps {
                let (cos, sin) = turn(step, steps);
                assert_eq!(turn(steps - step, steps), (cos, -sin), "{step}/{steps}");
                assert_eq!(turn(step + steps / 2, steps), (-cos, -sin), "{step}/{steps}");
            }
        }
    }

    #[test]
    fn turns_agree_with_the_standard_library() {
        for steps in [3, 5, 17, 64] {
            for step in 0..=steps {
                let angle = std::f64::consts::TAU * fraction(step, steps);
                let (cos, sin) = turn(step, steps);
                assert!((cos - angle.cos()).abs() < 1e-15 && (sin - angle.sin()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_shape_without_area_is_an_empty_mesh() {
        let mut builder = Builder::default();
        let point = Vertex { position: DVec3::ONE, normal: DVec3::Y, uv: DVec2::ZERO };
        builder.sheet(2, 2, |_, _| point);
        let mesh = builder.build();
        assert_eq!((mesh.vertex_count(), mesh.triangles.len(), mesh.parts.len()), (0, 0, 0));
        assert_eq!(mesh.bounds, None);
    }
}
