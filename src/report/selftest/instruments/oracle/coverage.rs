//! O1: which triangle each sample sees, exactly, from the snapped corners.
//!
//! Edge functions are plain differences and products in i128, evaluated anew for every sample;
//! nothing is stepped, tiled, blocked or skipped.

use super::super::stage::{Seen, triangles};
use super::sample_positions;
use crate::math::View;
use crate::pipeline::geometry::Bins;
use crate::pipeline::geometry::setup::Triangle;

/// Whether the triangle covers a point, both in sub-pixels: the point is inside, or on a left edge
/// (the inside lies to its right) or on a top edge (level, the inside lies below it).
pub fn covers(t: &Triangle, p: [i32; 2]) -> bool {
    let corner = |i: usize| [t.x[i % 3], t.y[i % 3]].map(i128::from);
    let p = p.map(i128::from);
    (0..3).all(|i| {
        let (a, b, opposite) = (corner(i), corner(i + 1), corner(i + 2));
        let side = |p: [i128; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        let inward = side(opposite).signum();
        let per_x = (a[1] - b[1]) * inward;
        let per_y = (b[0] - a[0]) * inward;
        let inside = side(p) * inward;
        inside > 0 || inside == 0 && (per_x > 0 || per_x == 0 && per_y > 0)
    })
}

/// Depth of a set-up triangle at a sample, as [`Triangle`]'s documentation defines it, rounded once.
pub fn depth(t: &Triangle, p: [i32; 2]) -> f32 {
    let d = |axis: usize, from: [i32; 3]| f64::from(p[axis]) - f64::from(from[0]);
    let (dx, dy) = (d(0, t.x), d(1, t.y));
    let [first, second] = t.depth.slope;
    let value = if t.is_stiff() {
        let side = |a: usize, b: usize| {
            let edge = [t.x[b] - t.x[a], t.y[b] - t.y[a]].map(f64::from);
            edge[0] * dy - edge[1] * dx
        };
        t.depth.base + (first * side(2, 0) + second * side(0, 1))
    } else {
        (t.depth.base + second * dy) + first * dx
    };
    value as f32
}

/// What every sample sees: the nearest depth, of equal ones the triangle submitted first; depth 0
/// is too far to be seen.
pub fn seen(bins: &Bins, view: &View, samples: u32) -> Seen {
    let pattern = sample_positions(samples);
    let count = view.width as usize * view.height as usize * pattern.len();
    let mut seen = Seen { id: vec![0; count], depth: vec![0.0; count] };
    for (t, id) in triangles(bins).zip(1..) {
        for_each_near(t, view, &pattern, |at, p| {
            if covers(t, p) {
                let depth = depth(t, p);
                if depth > seen.depth[at] {
                    seen.depth[at] = depth;
                    seen.id[at] = id;
                }
            }
        });
    }
    seen
}

/// How many triangles cover each sample.
pub fn cover_counts(bins: &Bins, view: &View, samples: u32) -> Vec<u32> {
    let pattern = sample_positions(samples);
    let mut counts = vec![0; view.width as usize * view.height as usize * pattern.len()];
    for t in triangles(bins) {
        for_each_near(t, view, &pattern, |at, p| counts[at] += u32::from(covers(t, p)));
    }
    counts
}

/// Calls `f` with index and position of every sample in the box of the triangle, made larger by one
/// pixel on each side: far outside of it nothing is covered, and a million triangles of dust
/// are tested in a second.
fn for_each_near(t: &Triangle, view: &View, pattern: &[[i32; 2]], mut f: impl FnMut(usize, [i32; 2])) {
    let pixels = |corners: [i32; 3], count: u32| {
        let half = i64::from(count) * 128;
        let pixel = |c: i32| (i64::from(c) + half).div_euclid(256);
        let (low, high) = (corners.iter().min(), corners.iter().max());
        let first = low.map_or(0, |&c| pixel(c) - 1).max(0);
        let end = high.map_or(0, |&c| pixel(c) + 2).min(i64::from(count));
        (first..end).map(move |i| (i as usize, (i * 256 - half) as i32))
    };
    for (y, top) in pixels(t.y, view.height) {
        for (x, left) in pixels(t.x, view.width) {
            for (s, offset) in pattern.iter().enumerate() {
                let at = (y * view.width as usize + x) * pattern.len() + s;
                f(at, [left + offset[0], top + offset[1]]);
            }
        }
    }
}
