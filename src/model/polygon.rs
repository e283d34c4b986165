//! Polygons → triangles, by ear clipping.
//!
//! Source: G. H. Meisters, "Polygons Have Ears", The American Mathematical Monthly 82 (1975);
//! M. E. Newell's normal as in I. Sutherland, R. Sproull, R. Schumacker, "A Characterization of Ten
//! Hidden-Surface Algorithms" (1974).

use glam::{DVec2, DVec3};

/// How much testing of possible ears is left. A polygon of n corners, r of them reflex, takes about
/// n·r tests; without a bound a small file could keep a core busy for hours.
#[derive(Debug)]
pub struct Effort(pub u64);

/// Why a polygon was given up: its ears are too expensive to find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooComplex;

/// Splits a polygon of n ≥ 3 corners into n − 2 triangles of the same winding, as corner indices.
///
/// Works in the plane of the polygon's Newell normal; what is convex there becomes a fan from the
/// first corner. Simple polygons are covered exactly once. For what has no right answer
/// (self-intersecting, no area) the triangles are still n − 2, over the same corners.
///
/// # Errors
/// When `effort` runs out.
pub fn triangulate(corners: &[DVec3], effort: &mut Effort) -> Result<Vec<[usize; 3]>, TooComplex> {
    let fan = || (2..corners.len()).map(|i| [0, i - 1, i]).collect();
    if corners.len() <= 3 {
        return Ok(fan());
    }
    match flatten(corners) {
        Some(flat) if !is_fan(&flat) => clip_ears(&flat, effort),
        _ => Ok(fan()),
    }
}

/// The polygon in its own plane, counter-clockwise, scaled to a size near 1; `None` without area.
///
/// One axis is dropped, the one in which the normal is longest, and the scale is a power of two, so
/// that the coordinates stay exact relative to the first corner.
fn flatten(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let first = corners[0];
    let extent = corners.iter().map(|p| (*p - first).abs().max_element()).fold(0.0, f64::max);
    if extent == 0.0 {
        return None;
    }
    // Beyond 2¹⁰⁰⁰ the scale of a subnormal extent would be infinite.
    let scale = libm::exp2(-f64::from(libm::ilogb(extent).max(-1000)));
    let relative: Vec<DVec3> = corners.iter().map(|p| (*p - first) * scale).collect();
    let normal = newell_normal(&relative);
    let size = normal.abs();
    let project = |project: fn(DVec3) -> DVec2| Some(relative.iter().copied().map(project).collect());
    match size.max_element() {
        0.0 => None,
        length if length == size.x && normal.x > 0.0 => project(|p| DVec2::new(p.y, p.z)),
        length if length == size.x => project(|p| DVec2::new(p.z, p.y)),
        length if length == size.y && normal.y > 0.0 => project(|p| DVec2::new(p.z, p.x)),
        length if length == size.y => project(|p| DVec2::new(p.x, p.z)),
        _ if normal.z > 0.0 => project(|p| DVec2::new(p.x, p.y)),
        _ => project(|p| DVec2::new(p.y, p.x)),
    }
}

/// Twice the polygon's vector area.
fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a.cross(*b)).sum()
}

/// Twice the signed area of the triangle, positive when counter-clockwise.
fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether the fan from the first corner covers the polygon: no corner and no triangle turns back.
fn is_fan(flat: &[DVec2]) -> bool {
    let n = flat.len();
    let turns_left = |i: usize| orient(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0;
    let fans_left = |i: usize| orient(flat[0], flat[i - 1], flat[i]) > 0.0;
    (0..n).all(turns_left) && (2..n).all(fans_left)
}

/// A polygon that loses one corner after the other: a ring of the corners that are left.
struct Ring<'a> {
    flat: &'a [DVec2],
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Corners that are left and not strictly convex: the only ones that can lie in an ear.
    reflex: Vec<usize>,
}

impl<'a> Ring<'a> {
    fn new(flat: &'a [DVec2]) -> Self {
        let n = flat.len();
        let next = (0..n).map(|i| (i + 1) % n).collect();
        let previous = (0..n).map(|i| (i + n - 1) % n).collect();
        let mut ring = Self { flat, next, previous, reflex: Vec::new() };
        ring.reflex = (0..n).filter(|i| ring.turn(*i) <= 0.0).collect();
        ring
    }

    /// The triangle of corner `i` and its neighbours.
    fn triangle(&self, i: usize) -> [usize; 3] {
        [self.previous[i], i, self.next[i]]
    }

    /// Positive where the polygon turns left at corner `i`.
    fn turn(&self, i: usize) -> f64 {
        let [a, b, c] = self.triangle(i).map(|i| self.flat[i]);
        orient(a, b, c)
    }

    /// Whether corner `i` can be cut off: strictly convex, and no other corner in its triangle. A
    /// corner at the same place as one of the triangle's does not count: where a hole is joined to
    /// the outline by a seam, corners lie upon each other.
    fn is_ear(&self, i: usize, effort: &mut Effort) -> Result<bool, TooComplex> {
        let is_convex = self.turn(i) > 0.0;
        let tests = if is_convex { self.reflex.len() as u64 } else { 0 };
        effort.0 = effort.0.checked_sub(1 + tests).ok_or(TooComplex)?;
        if !is_convex {
            return Ok(false);
        }
        let [a, b, c] = self.triangle(i).map(|i| self.flat[i]);
        let inside = |p: DVec2| orient(a, b, p) >= 0.0 && orient(b, c, p) >= 0.0 && orient(c, a, p) >= 0.0;
        let is_corner = |p: DVec2| p == a || p == b || p == c;
        Ok(!self.reflex.iter().map(|r| self.flat[*r]).any(|p| inside(p) && !is_corner(p)))
    }

    /// Takes corner `i` out.
    fn cut(&mut self, i: usize) {
        let [before, _, after] = self.triangle(i);
        self.next[before] = after;
        self.previous[after] = before;
        // A convex corner stays convex when a neighbour that is an ear goes.
        let reflex = std::mem::take(&mut self.reflex);
        let stays = |r: &usize| *r != i && ((*r != before && *r != after) || self.turn(*r) <= 0.0);
        self.reflex = reflex.into_iter().filter(stays).collect();
    }
}

fn clip_ears(flat: &[DVec2], effort: &mut Effort) -> Result<Vec<[usize; 3]>, TooComplex> {
    let mut ring = Ring::new(flat);
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    let mut left = flat.len();
    let (mut corner, mut refused) = (0, 0);
    while left > 3 {
        // A whole turn without an ear: the polygon crosses itself, or what is left has no area.
        // Any corner will do, the next one keeps the work bounded.
        if refused >= left || ring.is_ear(corner, effort)? {
            triangles.push(ring.triangle(corner));
            ring.cut(corner);
            // Going on two corners further keeps triangles from becoming a fan of slivers.
            corner = ring.next[ring.next[corner]];
            (left, refused) = (left - 1, 0);
        } else {
            corner = ring.next[corner];
            refused += 1;
        }
    }
    triangles.push(ring.triangle(corner));
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn split(corners: &[DVec3]) -> Vec<[usize; 3]> {
        triangulate(corners, &mut Effort(1 << 28)).unwrap()
    }

    fn area(corners: &[DVec3], [a, b, c]: [usize; 3]) -> DVec3 {
        (corners[b] - corners[a]).cross(corners[c] - corners[a]) * 0.5
    }

    /// Every triangle turns the same way as the polygon, and together they have its area.
    fn covers_exactly(corners: &[DVec3]) {
        let triangles = split(corners);
        assert_eq!(triangles.len(), corners.len() - 2);
        let whole = newell_normal(corners) * 0.5;
        let parts: Vec<DVec3> = triangles.iter().map(|t| area(corners, *t)).collect();
        assert!(parts.iter().all(|part| part.dot(whole) >= 0.0), "a triangle is turned over: {triangles:?}");
        let sum: f64 = parts.iter().map(|part| part.length()).sum();
        assert!((sum - whole.length()).abs() <= 1e-12 * sum, "{sum} instead of {}", whole.length());
    }

    fn xy(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect()
    }

    #[test]
    fn a_convex_quad_splits_along_its_first_diagonal() {
        assert_eq!(split(&xy(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)])), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_concave_quad_splits_along_its_reflex_corner() {
        for start in 0..4 {
            let mut dart = xy(&[(0., 0.), (4., -2.), (1., 0.), (4., 2.)]);
            dart.rotate_left(start);
            covers_exactly(&dart);
            dart.reverse();
            covers_exactly(&dart);
        }
    }

    #[test]
    fn combs_spirals_and_straight_corners_are_covered_once() {
        covers_exactly(&xy(&[
            (0., 0.),
            (9., 0.),
            (9., 5.),
            (8., 1.),
            (7., 5.),
            (6., 1.),
            (5., 5.),
            (4., 1.),
            (0., 5.),
        ]));
        covers_exactly(&xy(&[
            (0., 0.),
            (1., 0.),
            (2., 0.),
            (3., 0.),
            (3., 1.),
            (3., 2.),
            (0., 2.),
            (0., 1.),
        ]));
        covers_exactly(&xy(&[(0., 0.), (2., 0.), (1., 0.5), (2., 1.), (0., 1.), (0.25, 0.5)]));
    }

    #[test]
    fn a_hole_on_a_seam_stays_open() {
        let outline = [(0., 0.), (4., 0.), (4., 4.), (0., 4.), (0., 0.)];
        let hole = [(1., 1.), (1., 3.), (3., 3.), (3., 1.), (1., 1.)];
        covers_exactly(&xy(&[&outline[..], &hole[..]].concat()));
    }

    #[test]
    fn what_has_no_right_answer_still_ends() {
        let n2 = |corners: &[DVec3]| assert_eq!(split(corners).len(), corners.len() - 2);
        n2(&[DVec3::ONE; 7]);
        n2(&xy(&[(0., 0.), (1., 1.), (2., 2.), (3., 3.), (1., 1.)]));
        n2(&xy(&[(0., 0.), (1., 1.), (1., 0.), (0., 1.)]));
        n2(&xy(&[(0., 0.), (1e-320, 0.), (0., 1e-320), (1e-320, 1e-320)]));
        n2(&xy(&[(-2e37, 0.), (2e37, -2e37), (0., 0.), (2e37, 2e37)]));
    }

    #[test]
    fn effort_is_bounded() {
        // A star: every second corner is reflex.
        let star: Vec<DVec3> = (0..2000u32)
            .map(|i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 2000.0).sin_cos();
                DVec3::new(cos, sin, 0.0) * if i % 2 == 0 { 1.0 } else { 0.5 }
            })
            .collect();
        covers_exactly(&star);
        assert_eq!(triangulate(&star, &mut Effort(1000)), Err(TooComplex));
    }

    proptest! {
        /// Star-shaped polygons with corners on an integer grid, tilted into space.
        #[test]
        fn star_shaped_polygons_are_covered_once(
            radii in prop::collection::vec(1.0f64..10.0, 5..40),
            tilt in (-3.0f64..3.0, -3.0f64..3.0),
            start: prop::sample::Index,
            reversed: bool,
        ) {
            let n = f64::from(u32::try_from(radii.len()).unwrap());
            let mut angle = 0.0f64;
            let mut corners: Vec<DVec3> = radii.iter().map(|radius| {
                let (sin, cos) = angle.sin_cos();
                angle += std::f64::consts::TAU / n;
                let (x, y) = (radius * cos, radius * sin);
                DVec3::new(x, y, tilt.0 * x + tilt.1 * y)
            }).collect();
            let start = start.index(corners.len());
            corners.rotate_left(start);
            if reversed { corners.reverse(); }
            covers_exactly(&corners);
        }

        #[test]
        fn any_corners_give_n_minus_two_triangles(
            points in prop::collection::vec((-3i8..4, -3i8..4, -1i8..2), 3..24),
        ) {
            let corners: Vec<DVec3> = points.iter().map(|(x, y, z)| DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z))).collect();
            let triangles = split(&corners);
            prop_assert_eq!(triangles.len(), corners.len() - 2);
            prop_assert!(triangles.iter().flatten().all(|i| *i < corners.len()));
        }
    }
}
