//! Coverage: every sample belongs to exactly the triangle that covers it (B1 – B6).

use crate::math::View;
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw;
use crate::report::selftest::instruments::oracle::{coverage, geometric, sample_positions};
use crate::report::selftest::instruments::stage::*;
use glam::DVec3;
use serde_json::json;
use std::time::Instant;

/// Differing pixel centres per pixel of perimeter: snapping moves a corner by at most half a
/// sub-pixel an axis, 0.2 sub-pixels across an edge in the mean.
pub const SNAP_BOUND: f64 = 1.2e-3;

const PATTERNS: [u32; 5] = [1, 2, 4, 8, 16];

/// Triangles of about `size` pixels, one in each cell of the picture, none touching another.
fn scattered(rng: &mut Random, view: &View, size: f64) -> Vec<[[f64; 2]; 3]> {
    let cell = (size * 1.6).max(2.0);
    let count = |n: u32| (f64::from(n) / cell) as i32;
    let mut triangles = Vec::new();
    for row in 0..count(view.height) {
        for column in 0..count(view.width) {
            let middle = [(column, view.width), (row, view.height)].map(|(at, n)| {
                let slack = (cell - size) * 0.45;
                let within = rng.between(-slack, slack);
                ((f64::from(at) + 0.5) * cell + within - f64::from(n) / 2.0) * 256.0
            });
            let mut corner = || middle.map(|c| c + rng.between(-size / 2.0, size / 2.0) * 256.0);
            triangles.push([corner(), corner(), corner()]);
        }
    }
    triangles
}

/// Draws triangles as they are and compares with O2. Returns differing samples and perimeter.
fn against_the_ray_cast(
    view: &View,
    drawn: &[[DVec3; 3]],
    meant: &[[DVec3; 3]],
) -> (geometric::Differences, f64) {
    let bins = bins(two_sided(soup(drawn)), view, 1);
    let solids = geometric::solids(meant);
    let answers = geometric::seen(&solids, view, 1);
    let ids = visible(&bins, 1).sources(&bins);
    (geometric::compare(&ids, &answers), geometric::perimeter(&solids, view))
}

pub fn b1_snapping_changes_no_more_pixels_than_it_must(ledger: &mut Ledger) {
    let mut rng = ledger.random(1);
    let frames = ledger.effort.pick(6, 24);
    for (size, side, frames) in [(0.7, 512, 1), (3.0, 1024, 1), (30.0, 1024, 4), (1000.0, 1664, frames)] {
        let view = flat_view(side, side);
        let (mut differing, mut certain, mut perimeter) = (0, 0, 0.0);
        for _ in 0..frames {
            let triangles = scattered(&mut rng, &view, size);
            let corners: Vec<_> = triangles.iter().map(|t| t.map(|p| on_screen(p, 0.5))).collect();
            let (differences, length) = against_the_ray_cast(&view, &corners, &corners);
            differing += differences.certain + differences.uncertain;
            certain += differences.certain;
            perimeter += length;
        }
        let case = format!("{size} px");
        ledger.at_most(&case, "pixels differing outside the band", f64::from(certain), 0.0);
        ledger.at_most(
            &case,
            "differing pixels per px of perimeter",
            f64::from(differing) / perimeter,
            SNAP_BOUND,
        );
    }
}

pub fn b1_would_notice_four_lost_bits(ledger: &mut Ledger) {
    let mut rng = ledger.random(2);
    let view = flat_view(1024, 1024);
    let triangles = scattered(&mut rng, &view, 30.0);
    let corners = |snap: f64| -> Vec<_> {
        let to = |c: f64| (c / snap + 0.5).floor() * snap;
        triangles.iter().map(|t| t.map(|p| on_screen(p.map(to), 0.5))).collect()
    };
    let meant: Vec<_> = triangles.iter().map(|t| t.map(|p| on_screen(p, 0.5))).collect();
    let (coarse, perimeter) = against_the_ray_cast(&view, &corners(16.0), &meant);
    let of = |differences: geometric::Differences| {
        f64::from(differences.certain + differences.uncertain) / perimeter
    };
    ledger.at_least("", "control: differing pixels per px with 4 bits lost", of(coarse), 4.0 * SNAP_BOUND);
    let (fine, _) = against_the_ray_cast(&view, &corners(1.0), &meant);
    ledger.at_most("", "control: differing pixels per px with none lost", of(fine), SNAP_BOUND);
}

/// Overlapping triangles of all sizes; some tilted, some level and as near as others, some twice.
fn pile(rng: &mut Random, view: &View) -> Vec<[DVec3; 3]> {
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    // More than the geometry stage gives to one task.
    for i in 0..4500 {
        if i % 7 == 6 {
            triangles.push(triangles[rng.below(triangles.len())]);
            continue;
        }
        let largest = if i % 40 == 0 { 600.0 } else { 20.0 };
        let size = rng.magnitude(0.5, largest) * 256.0;
        let middle = [view.width, view.height].map(|n| rng.between(-0.6, 0.6) * f64::from(n) * 256.0);
        let level = (rng.below(8) + 4) as f64 / 16.0;
        let tilt = if i % 3 == 0 { 0.0 } else { 0.25 };
        triangles.push([0; 3].map(|_| {
            let p = middle.map(|c| c + rng.between(-size, size));
            let depth = level + (rng.between(0.0, tilt) * 1024.0).floor() / 1024.0;
            on_screen(p, depth)
        }));
    }
    triangles
}

pub fn b1_every_sample_sees_what_exact_arithmetic_says(ledger: &mut Ledger) {
    for (samples, seed) in PATTERNS.into_iter().zip(10..) {
        let mut rng = ledger.random(seed);
        let view = flat_view(333, 217);
        let bins = bins(two_sided(soup(&pile(&mut rng, &view))), &view, samples);
        let (drawn, exact) = (visible(&bins, samples), coverage::seen(&bins, &view, samples));
        let differing = drawn.id.iter().zip(&exact.id).filter(|(a, b)| a != b).count();
        ledger.at_most(&format!("{samples} samples"), "samples unlike O1", differing as f64, 0.0);
        let setting = format!("{samples} samples");
        ledger.holds(&setting, "pictures whose depths are unlike O1", drawn == exact);
        let counts = coverage::cover_counts(&bins, &view, samples);
        ledger.holds(&setting, "pictures whose counts are unlike O1", cover_counts(&bins, samples) == counts);
    }
}

pub fn b2_a_jittered_mesh_covers_every_sample_exactly_once(ledger: &mut Ledger) {
    let mut rng = ledger.random(3);
    let corner = |rng: &mut Random, column: i32, row: i32| {
        let place = [column, row].map(|n| f64::from(n - 30) * 5.0);
        if rng.below(2) == 0 {
            place.map(|c| (c * 256.0).floor() + 128.0)
        } else {
            place.map(|c| (c + rng.between(-1.2, 1.2)) * 256.0)
        }
    };
    let flat = flat_view(251, 240);
    let deep = perspective_view(251, 240, 0.5, 0.125);
    for (view, name) in [(flat, "flat"), (deep, "projected")] {
        for reversed in [false, true] {
            let (positions, mut triangles) = grid(60, &mut rng, |rng, column, row| {
                let p = corner(rng, column, row);
                if name == "flat" {
                    on_screen(p, 0.5)
                } else {
                    at_distance(&view, p, rng.magnitude(0.2, 50.0))
                }
            });
            if reversed {
                triangles.iter_mut().for_each(|t| t.swap(0, 1));
            }
            let item = two_sided(mesh(&positions, triangles));
            for samples in PATTERNS {
                let bins = bins(item.clone(), &view, samples);
                assert_eq!(bins.counts.clipped, 0);
                let counts = cover_counts(&bins, samples);
                let wrong = counts.iter().filter(|&&n| n != 1).count();
                let case = format!("{name}, reversed {reversed}, {samples} samples");
                ledger.at_most(&case, "samples not covered exactly once", wrong as f64, 0.0);
            }
        }
    }
}

pub fn b3_four_triangles_about_a_vertex_leave_no_gap(ledger: &mut Ledger) {
    let (view, half) = (flat_view(32, 32), 10 * 256);
    let mut wrong = 0;
    // The vertex at a pixel's centre, on its left border, on its upper border, on its corner; moved
    // by a sub-pixel in each direction.
    for middle in [[128, 128], [0, 128], [128, 0], [0, 0]] {
        for shift in 0..9 {
            let middle = [middle[0] + shift % 3 - 1, middle[1] + shift / 3 - 1];
            let point = |[x, y]: [i32; 2]| on_screen([f64::from(x), f64::from(y)], 0.5);
            let rim = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(|d| [0, 1].map(|i| middle[i] + d[i] * half));
            let triangles: Vec<_> = (0..4).map(|i| [middle, rim[i], rim[(i + 1) % 4]].map(point)).collect();
            for samples in PATTERNS {
                let bins = bins(two_sided(soup(&triangles)), &view, samples);
                let counts = cover_counts(&bins, samples);
                let exact = coverage::cover_counts(&bins, &view, samples);
                ledger.holds(&format!("{samples} samples"), "pictures unlike O1", counts == exact);
                let pattern = sample_positions(samples);
                let expected = (0..32 * 32).flat_map(|pixel| {
                    let corner = [pixel % 32, pixel / 32].map(|c| (c - 16) * 256);
                    pattern.iter().map(move |offset| {
                        let within = |i: usize| {
                            let from_middle = corner[i] + offset[i] - middle[i];
                            (-half..half).contains(&from_middle)
                        };
                        u32::from(within(0) && within(1))
                    })
                });
                wrong += counts.iter().zip(expected).filter(|(a, b)| **a != *b).count();
            }
        }
    }
    ledger.at_most("", "samples not covered exactly once", wrong as f64, 0.0);
}

pub fn b4_a_sliver_of_a_sub_pixel_is_covered_exactly(ledger: &mut Ledger) {
    let mut rng = ledger.random(4);
    let mut covered = 0;
    for i in 0..12 {
        let view = if i % 2 == 0 { flat_view(16_384, 40) } else { flat_view(40, 16_384) };
        let turned = |p: [f64; 2]| if i % 2 == 0 { p } else { [p[1], p[0]] };
        let (reach, tilt) = (15_000.0 * 256.0, rng.between(-20.0, 20.0) * 256.0);
        let (a, b) = ([-reach, -tilt.floor()], [reach, tilt.floor()]);
        let c = [b[0], b[1] + 1.0];
        let depth = [0.25, 0.5, 0.75];
        let triangle = [0, 1, 2].map(|i| on_screen(turned([a, b, c][i]), depth[i]));
        for samples in [1, 4] {
            let bins = bins(two_sided(soup(&[triangle])), &view, samples);
            let (drawn, exact) = (visible(&bins, samples), coverage::seen(&bins, &view, samples));
            let differing = drawn.id.iter().zip(&exact.id).filter(|(a, b)| a != b).count();
            ledger.at_most(&format!("{i}, {samples} samples"), "samples unlike O1", differing as f64, 0.0);
            covered += drawn.id.iter().filter(|&&id| id != 0).count();
        }
    }
    assert!(covered > 1000, "{covered} samples are too few to show anything");
}

pub fn b5_triangles_without_area_are_dropped_and_counted(ledger: &mut Ledger) {
    let p = |x: i32, y: i32| on_screen([f64::from(x), f64::from(y)], 0.5);
    let whole = [p(-3000, -3000), p(3000, -2000), p(-1000, 3000)];
    let degenerate = [
        [p(0, 0), p(0, 0), p(0, 0)],
        [p(0, 0), p(0, 0), p(900, 500)],
        [p(0, 0), p(900, 500), p(0, 0)],
        [p(-900, -500), p(0, 0), p(900, 500)],
        [p(0, -700), p(0, 300), p(0, 301)],
        // A tenth of a sub-pixel wide: without area once it is snapped.
        [p(0, 0), p(900, 500), on_screen([900.1, 500.1], 0.5)],
    ];
    let view = flat_view(40, 40);
    let alone = bins(two_sided(soup(&[whole])), &view, 4);
    let mut all = degenerate.to_vec();
    all.insert(3, whole);
    let all = bins(two_sided(soup(&all)), &view, 4);
    let off = all.counts.degenerate.abs_diff(degenerate.len() as u64);
    ledger.at_most("", "triangles not counted as degenerate", off as f64, 0.0);
    ledger.at_most("", "drawn beside the one that has an area", all.counts.drawn.abs_diff(1) as f64, 0.0);
    ledger.holds("", "pictures that they change", visible(&alone, 4) == visible(&all, 4));
}

pub fn b5_a_frame_is_the_same_without_what_has_no_area(ledger: &mut Ledger) {
    let mut document = json!({
        "camera": { "position": [0, 0, 3] },
        "lights": { "sun": { "type": "directional", "direction": [0, -1, -1] } },
        "meshes": {
            "box": { "type": "box" },
            "none": { "type": "triangles",
                      "positions": [[0, 0, 1], [0.3, 0.1, 1], [0.6, 0.2, 1], [-0.5, 0.5, 1]],
                      "indices": [[0, 1, 2], [0, 0, 3], [3, 3, 3], [1, 3, 1]] },
        },
        "instances": { "a": { "mesh": "box", "rotation_deg": [20, 30, 0] } },
        "render": { "width": 90, "height": 70, "cull": "none" },
    });
    let without = draw::colors(&document);
    document["instances"]["b"] = json!({ "mesh": "none" });
    let with = draw::colors(&document);
    let differing = with.iter().zip(&without).filter(|(a, b)| a != b).count();
    ledger.none_of("", "pixels of a frame that they change", differing, without.len());
}

pub fn b6_dust_below_a_sub_pixel_is_covered_exactly(ledger: &mut Ledger) {
    let mut rng = ledger.random(5);
    let view = flat_view(64, 64);
    // A corner on the grid each, or hardly any of them would have an area after snapping.
    let triangles: Vec<_> = (0..ledger.effort.pick(100_000, 1_000_000))
        .map(|_| {
            let corner = [0; 2].map(|_| rng.between(-33.0 * 256.0, 33.0 * 256.0).floor() + 0.49);
            let mut near = || on_screen(corner.map(|c| c + rng.between(-0.9, 0.9)), 0.5);
            [near(), near(), near()]
        })
        .collect();
    let item = two_sided(soup(&triangles));
    let began = Instant::now();
    let bins = bins(item, &view, 16);
    let nanoseconds = began.elapsed().as_nanos() / triangles.len() as u128;
    ledger.report("nanoseconds for a triangle", nanoseconds as f64);
    let counts = &bins.counts;
    let fates = counts.outside + counts.degenerate + counts.no_sample + counts.drawn;
    ledger.at_most("", "triangles without a fate", fates.abs_diff(counts.triangles) as f64, 0.0);
    assert!(counts.no_sample > 0 && counts.drawn > 0, "{counts:?}");
    let seen = visible(&bins, 16);
    let wrong = seen.depth.iter().filter(|depth| ![0.0, 0.5].contains(*depth)).count();
    ledger.none_of("", "wrong depths", wrong, seen.depth.len());
    let differing = cover_counts(&bins, 16)
        .iter()
        .zip(coverage::cover_counts(&bins, &view, 16))
        .filter(|(a, b)| **a != *b)
        .count();
    ledger.at_most("", "samples unlike O1", differing as f64, 0.0);
}
