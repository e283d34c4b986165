//! Clipping: the near plane, and triangles along the planes themselves (B8, B9).

use super::coverage::SNAP_BOUND;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::oracle::{coverage, geometric, sample_positions};
use crate::report::selftest::instruments::stage::*;
use glam::DVec3;

/// Distances of a corner from the eye plane that are hard for a near plane at `n`.
fn stiff_distances(n: f64) -> [f64; 7] {
    [-1.0, 0.0, 1e-38, n * (1.0 - 1e-7), n, n * (1.0 + 1e-7), 10.0 * n]
}

pub fn b8_corners_about_the_eye_and_near_planes_are_cut_as_a_ray_sees_them(ledger: &mut Ledger) {
    let mut rng = ledger.random(6);
    let near = 0.1;
    let view = perspective_view(96, 80, 1.0, near);
    let distances = stiff_distances(near);
    let (mut certain, mut uncertain, mut perimeter, mut covered) = (0, 0, 0.0, 0);
    for case in 0..distances.len().pow(3) {
        let ws = [case / 49, case / 7 % 7, case % 7].map(|i| distances[i]);
        for _ in 0..3 {
            let triangle = ws.map(|w| {
                let mut side = || rng.between(-1.5, 1.5) * f64::max(w.abs(), near);
                DVec3::new(side(), side(), -w)
            });
            let bins = bins(two_sided(soup(&[triangle])), &view, 1);
            let seen = visible(&bins, 1);
            let setting = format!("{ws:?}");
            ledger.holds(&setting, "pictures unlike O1", seen == coverage::seen(&bins, &view, 1));
            let beyond = seen.depth.iter().filter(|d| !(0.0..=1.0).contains(*d)).count();
            ledger.none_of(&setting, "depths beyond 0 to 1", beyond, seen.depth.len());
            if ws.iter().all(|&w| w < near) {
                ledger.holds(&setting, "not dropped before the near plane", bins.counts.outside == 1);
            }
            if ws.iter().all(|&w| w >= near) {
                ledger.holds(&setting, "cut although w = near is inside", bins.counts.clipped == 0);
            }
            let solids = geometric::solids(&[triangle]);
            let ids = seen.sources(&bins);
            let differences = geometric::compare(&ids, &geometric::seen(&solids, &view, 1));
            certain += differences.certain;
            uncertain += differences.uncertain;
            perimeter += geometric::perimeter(&solids, &view);
            covered += ids.iter().filter(|&&id| id != 0).count();
        }
    }
    assert!(covered > 100_000, "{covered} pixels are too few to show anything");
    ledger.at_most("", "pixels differing outside the band", f64::from(certain), 0.0);
    ledger.at_most("", "differing pixels per px of perimeter", f64::from(uncertain) / perimeter, SNAP_BOUND);
}

/// A mesh in the plane 0.02 below the eye, cut by the near plane within the picture.
pub fn b9_a_mesh_cut_by_the_near_plane_is_covered_exactly_once(ledger: &mut Ledger) {
    const BELOW: f64 = 0.02;
    for (near, tan) in [(0.1, 0.5), (0.03, 1.0), (1e-3, 25.0)] {
        let mut rng = ledger.random(9);
        let view = perspective_view(400, 300, tan, near);
        let reach = 4.0 * f64::max(near, BELOW);
        let cell = reach / 30.0;
        let (sin, cos) = 0.3f64.sin_cos();
        let (positions, triangles) = grid(60, &mut rng, |rng, column, row| {
            let mut place = |n: i32| f64::from(n - 30) * cell + rng.between(-0.2, 0.2) * cell;
            let (x, z) = (place(column), place(row));
            DVec3::new(cos * x - sin * z, -BELOW, sin * x + cos * z)
        });
        for reversed in [false, true] {
            let mut triangles = triangles.clone();
            if reversed {
                triangles.iter_mut().for_each(|t| t.rotate_left(1));
                triangles.reverse();
            }
            let bins = bins(two_sided(mesh(&positions, triangles)), &view, 4);
            assert!(bins.counts.clipped > 10, "{:?}", bins.counts);
            let counts = cover_counts(&bins, 4);
            let exact = coverage::cover_counts(&bins, &view, 4);
            ledger.holds(&format!("n = {near}, reversed {reversed}"), "pictures unlike O1", counts == exact);
            let (mut wrong, mut inside) = (0, 0);
            for (i, &count) in counts.iter().enumerate() {
                let offset = sample_positions(4)[i % 4];
                let pixel = [i / 4 % 400, i / 4 / 400].map(|c| (c * 256) as f64);
                let x = pixel[0] + f64::from(offset[0]) - 200.0 * 256.0;
                let y = pixel[1] + f64::from(offset[1]) - 150.0 * 256.0;
                // The point of the plane that is seen there, and the row of the screen where the
                // near plane cuts it.
                let w = BELOW * view.scale[1] / y;
                let (x, z) = (x / view.scale[0] * w, -w);
                let within = |c: f64| c.abs() < reach - cell;
                let cut = BELOW * view.scale[1] / near;
                let on_mesh = within(cos * x + sin * z) && within(cos * z - sin * x);
                if y > 0.0 && on_mesh && y < cut - geometric::BAND {
                    inside += 1;
                    wrong += u32::from(count != 1);
                } else if y <= 0.0 || y > cut + geometric::BAND {
                    wrong += u32::from(count != 0);
                }
            }
            assert!(inside > 20_000, "{inside} samples are too few to show anything");
            let case = format!("n = {near}, reversed {reversed}");
            ledger.at_most(&case, "samples not covered exactly once", f64::from(wrong), 0.0);
        }
    }
}

/// Exact zeros on several planes at once, edge-on triangles, corners shared with the corners of the
/// view volume: a polygon never gets more corners than it has room for.
pub fn triangles_along_the_planes_themselves_are_cut_without_trouble(ledger: &mut Ledger) {
    let mut rng = ledger.random(14);
    let (guard, mut most) = (8_388_607.0, 0);
    for _ in 0..30_000 {
        let mut view = perspective_view(32, 32, rng.magnitude(1e-3, 1e3), rng.magnitude(1e-3, 1e3));
        view.far = view.near * (1.0 + rng.magnitude(1e-9, 1e3));
        let mut corner = || {
            let w = match rng.below(5) {
                0 => view.near,
                1 => view.far,
                2 => view.near * rng.between(-1.0, 1.0),
                3 => view.far * rng.between(1.0, 3.0),
                _ => rng.between(view.near, view.far),
            };
            let mut side = || match rng.below(4) {
                0 => guard,
                1 => -guard,
                2 => guard * rng.between(-3.0, 3.0),
                _ => rng.between(-4000.0, 4000.0),
            };
            at_distance(&view, [side(), side()], w)
        };
        let triangle = [corner(), corner(), corner()];
        let bins = bins(two_sided(soup(&[triangle])), &view, 1);
        most = most.max(triangles(&bins).count());
    }
    // A triangle that six planes cut has at most nine corners.
    ledger.at_most("", "triangles of one along the planes", most as f64, 7.0);
}
