//! O2: which triangle each sample sees, by casting a ray in f64 at the triangles as they were before
//! they were cut and snapped.
//!
//! Snapping moves a corner by half a sub-pixel a side, so next to an edge the answer is open: a
//! sample nearer than [`BAND`] to one, or with two hits too close to tell apart in f32, is
//! uncertain.
//!
//! Source of the test: S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT
//! 2(1), 2013 (shear the triangle so that the ray becomes an axis).

use super::super::worst::U;
use super::sample_positions;
use crate::math::{Projection, View};
use glam::{DVec2, DVec3};

/// Half the width of the band about an edge in which snapping may decide, in sub-pixels. It moves
/// an edge by at most √½; the rest is for the rounding of both sides.
pub const BAND: f64 = 1.5;

/// Two hits closer than this, relative to their distance, may swap in f32.
const SAME_DEPTH: f64 = 16.0 * U;

/// A triangle in the space of [`View::eye`].
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    /// Counter-clockwise as seen from its front.
    pub corners: [DVec3; 3],
    /// What a sample that sees it shows; not 0.
    pub id: u32,
    /// Whether its back is seen too.
    pub two_sided: bool,
}

/// The answer for one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// [`Solid::id`] of the nearest, 0 for none.
    pub id: u32,
    /// View-space distance of the hit; infinite for none.
    pub distance: f64,
    /// Whether snapping or the precision of the depth buffer may change it.
    pub uncertain: bool,
}

/// Triangles of a mesh, each its own id from 1 on, both sides seen.
pub fn solids(triangles: &[[DVec3; 3]]) -> Vec<Solid> {
    let solid = |(corners, id): (&[DVec3; 3], u32)| Solid { corners: *corners, id, two_sided: true };
    triangles.iter().zip(1..).map(solid).collect()
}

/// The answer for every sample, in the order of [`super::super::stage::Seen`].
pub fn seen(solids: &[Solid], view: &View, samples: u32) -> Vec<Answer> {
    let pattern = sample_positions(samples);
    let nothing = Answer { id: 0, distance: f64::INFINITY, uncertain: false };
    let mut answers = vec![nothing; view.width as usize * view.height as usize * pattern.len()];
    let mut second = vec![f64::INFINITY; answers.len()];
    for solid in solids {
        let in_view = solid.corners.map(|p| to_view(p, view));
        let outline = Outline::new(&in_view, view);
        for_each_near(&outline, view, &pattern, |at, p| {
            let answer = &mut answers[at];
            answer.uncertain |= outline.distance(p) < BAND;
            let Some((w, front)) = hit(&in_view, p, view) else {
                return;
            };
            if !(front || solid.two_sided) {
                return;
            }
            if w < answer.distance {
                (second[at], answer.distance, answer.id) = (answer.distance, w, solid.id);
            } else if w < second[at] {
                second[at] = w;
            }
        });
    }
    for (answer, second) in answers.iter_mut().zip(second) {
        answer.uncertain |= second <= answer.distance * (1.0 + SAME_DEPTH) && second.is_finite();
    }
    answers
}

/// How an answer of the pipeline differs from the oracle's.
#[derive(Debug, Default)]
pub struct Differences {
    /// Samples that differ although nothing could excuse it.
    pub certain: u32,
    /// Samples that differ where snapping decides.
    pub uncertain: u32,
    /// Index of the first of `certain`.
    pub first: Option<usize>,
}

/// Compares ids sample by sample.
pub fn compare(ids: &[u32], answers: &[Answer]) -> Differences {
    let mut differences = Differences::default();
    assert_eq!(ids.len(), answers.len());
    for (at, (&id, answer)) in ids.iter().zip(answers).enumerate() {
        if id != answer.id {
            if answer.uncertain {
                differences.uncertain += 1;
            } else {
                differences.certain += 1;
                differences.first.get_or_insert(at);
            }
        }
    }
    differences
}

/// Length of all outlines within the picture, in pixels.
pub fn perimeter(solids: &[Solid], view: &View) -> f64 {
    let of = |solid: &Solid| Outline::new(&solid.corners.map(|p| to_view(p, view)), view).length(view);
    solids.iter().map(of).sum()
}

/// (x, y, w): right, up, and along the line of sight.
fn to_view(p: DVec3, view: &View) -> DVec3 {
    let p = p - view.eye;
    DVec3::new(p.dot(view.right), p.dot(view.up), p.dot(view.forward))
}

/// Where the line of sight through a screen point meets a triangle: the distance, and whether the
/// front is seen.
fn hit(corners: &[DVec3; 3], p: DVec2, view: &View) -> Option<(f64, bool)> {
    let slope = DVec2::new(p.x / view.scale[0], -p.y / view.scale[1]);
    let [a, b, c] = corners.map(|v| match view.projection {
        Projection::Perspective => v.truncate() - slope * v.z,
        Projection::Orthographic => v.truncate() - slope,
    });
    let weights = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let inside = weights.iter().all(|&n| n >= 0.0) || weights.iter().all(|&n| n <= 0.0);
    let sum: f64 = weights.iter().sum();
    if !inside || sum == 0.0 {
        return None;
    }
    let w = (weights[0] * corners[0].z + weights[1] * corners[1].z + weights[2] * corners[2].z) / sum;
    // A mean lies between what it is of; rounding must not push a corner on the near plane before it.
    let [a, b, c] = corners.map(|v| v.z);
    let w = w.clamp(a.min(b).min(c), a.max(b).max(c));
    (view.near <= w && w <= view.far).then_some((w, sum > 0.0))
}

/// The outline of a triangle's part between near and far, on the screen in sub-pixels.
struct Outline(Vec<DVec2>);

impl Outline {
    fn new(corners: &[DVec3; 3], view: &View) -> Self {
        let mut polygon = corners.to_vec();
        cut(&mut polygon, |v| v.z - view.near);
        if view.far.is_finite() {
            cut(&mut polygon, |v| view.far - v.z);
        }
        let screen = |v: &DVec3| {
            let q = if view.projection == Projection::Perspective { v.z } else { 1.0 };
            DVec2::new(v.x * view.scale[0] / q, -v.y * view.scale[1] / q)
        };
        Self(polygon.iter().map(screen).collect())
    }

    fn edges(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        let next = self.0.iter().cycle().skip(1);
        self.0.iter().copied().zip(next.copied())
    }

    /// From a point to the nearest edge.
    fn distance(&self, p: DVec2) -> f64 {
        let to_edge = |(a, b): (DVec2, DVec2)| {
            let (along, from) = (b - a, p - a);
            let length = along.length();
            if length == 0.0 {
                return from.length();
            }
            let t = (from.dot(along) / length / length).clamp(0.0, 1.0);
            if t > 0.0 && t < 1.0 {
                (along / length).perp_dot(from).abs()
            } else {
                (from - along * t).length()
            }
        };
        self.edges().map(to_edge).fold(f64::INFINITY, f64::min)
    }

    /// Length within the picture in pixels (Liang and Barsky's clipping of each edge).
    fn length(&self, view: &View) -> f64 {
        let half = [view.width, view.height].map(|n| f64::from(n) * 128.0);
        let visible = |(a, b): (DVec2, DVec2)| {
            let along = b - a;
            let (mut enter, mut leave) = (0.0f64, 1.0f64);
            for axis in 0..2 {
                let (d, from) = (along[axis], a[axis]);
                if d == 0.0 {
                    if from.abs() > half[axis] {
                        return 0.0;
                    }
                    continue;
                }
                let (t, u) = ((-half[axis] - from) / d, (half[axis] - from) / d);
                enter = enter.max(t.min(u));
                leave = leave.min(t.max(u));
            }
            (leave - enter).max(0.0) * along.length() / 256.0
        };
        self.edges().map(visible).sum()
    }
}

/// Cuts a convex polygon by a plane.
fn cut(polygon: &mut Vec<DVec3>, inside: impl Fn(DVec3) -> f64) {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (da, db) = (inside(a), inside(b));
        if da >= 0.0 {
            kept.push(a);
        }
        if (da < 0.0) != (db < 0.0) {
            // From the inside, so that nothing is lost to an outside that lies far away.
            let inwards =
                if da >= 0.0 { a + (b - a) * (da / (da - db)) } else { b + (a - b) * (db / (db - da)) };
            kept.push(inwards);
        }
    }
    *polygon = kept;
}

/// Calls `f` with index and position of every sample in the outline's box and two pixels around it.
fn for_each_near(outline: &Outline, view: &View, pattern: &[[i32; 2]], mut f: impl FnMut(usize, DVec2)) {
    let pixels = |axis: usize, count: u32| {
        let half = f64::from(count) * 128.0;
        let all = outline.0.iter().map(|p| (p[axis] + half) / 256.0);
        let low = all.clone().fold(f64::INFINITY, f64::min);
        let high = all.fold(f64::NEG_INFINITY, f64::max);
        // Float-to-integer casts saturate, which is what is wanted here.
        let first = (low.floor() - 2.0).max(0.0) as usize;
        let end = (high.floor() + 3.0).clamp(0.0, f64::from(count)) as usize;
        (first..end).map(move |i| (i, i as f64 * 256.0 - half))
    };
    for (y, top) in pixels(1, view.height) {
        for (x, left) in pixels(0, view.width) {
            for (s, offset) in pattern.iter().enumerate() {
                let at = (y * view.width as usize + x) * pattern.len() + s;
                let offset = DVec2::new(f64::from(offset[0]), f64::from(offset[1]));
                f(at, DVec2::new(left, top) + offset);
            }
        }
    }
}
