//! Enormous coordinates: the guard band, and numbers at the ends of their range (B7).

use super::coverage::SNAP_BOUND;
use crate::plan::{FrameRequest, Output};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw;
use crate::report::selftest::instruments::oracle::{coverage, geometric};
use crate::report::selftest::instruments::stage::{self, *};
use glam::DVec3;

pub fn b7_a_triangle_of_1e10_near_distances_is_cut_as_a_ray_sees_it(ledger: &mut Ledger) {
    let mut rng = ledger.random(7);
    let near = 0.5;
    let view = perspective_view(200, 128, 0.7, near);
    let (mut certain, mut uncertain, mut perimeter, mut edges) = (0, 0, 0.0, 0);
    for i in 0..300 {
        let size = near * if i % 2 == 0 { 1e10 } else { rng.magnitude(1.0, 1e10) };
        // The plane passes within a few near distances of the camera, the corners lie far off.
        let point = |p: [f64; 2], w: f64| at_distance(&view, p.map(|c| c * 256.0), w);
        let aim = point([rng.between(-90.0, 90.0), rng.between(-60.0, 60.0)], near * rng.between(1.0, 9.0));
        let mut direction = || {
            let v = DVec3::new(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), rng.between(-1.0, 1.0));
            v.normalize()
        };
        let (u, v) = (direction(), direction());
        let triangle = [aim + u * size, aim + v * size, aim - (u + v) * size * 0.6];
        let bins = bins(two_sided(soup(&[triangle])), &view, 1);
        let seen = visible(&bins, 1);
        ledger.holds("1e10", "pictures unlike O1", seen == coverage::seen(&bins, &view, 1));
        let solids = geometric::solids(&[triangle]);
        let differences = geometric::compare(&seen.sources(&bins), &geometric::seen(&solids, &view, 1));
        certain += differences.certain;
        uncertain += differences.uncertain;
        let length = geometric::perimeter(&solids, &view);
        perimeter += length;
        edges += u32::from(length > 0.0);
    }
    assert!(edges > 100, "only {edges} triangles have an edge in the picture");
    ledger.at_most("1e10", "pixels differing outside the band", f64::from(certain), 0.0);
    ledger.at_most(
        "1e10",
        "differing pixels per px of perimeter",
        f64::from(uncertain) / perimeter,
        SNAP_BOUND,
    );
}

pub fn b7_coordinates_to_the_limit_stay_finite_exact_and_repeatable(ledger: &mut Ledger) {
    let mut rng = ledger.random(8);
    let near = 1.0;
    for size in [1e10, 1e20, 1e30, crate::limits::MAX_COORDINATE] {
        for tan in [1e-8, 0.7, 1e3] {
            let view = perspective_view(70, 50, tan, near);
            let triangles: Vec<_> = (0..60)
                .map(|_| {
                    let mut corner = || {
                        let mut c = || rng.between(-1.0, 1.0) * if rng.below(3) == 0 { 1.0 } else { size };
                        DVec3::new(c(), c(), c())
                    };
                    [corner(), corner(), corner()]
                })
                .collect();
            let bins = bins(two_sided(soup(&triangles)), &view, 4);
            let limit = 1 << 23;
            let beyond =
                stage::triangles(&bins).flat_map(|t| t.x.into_iter().chain(t.y)).filter(|c| c.abs() >= limit);
            ledger.at_most("", "coordinates beyond the guard band", beyond.count() as f64, 0.0);
            let seen = visible(&bins, 4);
            let setting = format!("to {size:e}, tangent {tan:e}");
            let beyond = seen.depth.iter().filter(|d| !(0.0..=1.0).contains(*d)).count();
            ledger.none_of(&setting, "depths beyond 0 to 1", beyond, seen.depth.len());
            ledger.holds(&setting, "pictures unlike O1", seen == coverage::seen(&bins, &view, 4));
            ledger.holds(&setting, "pictures not repeated", seen == visible(&bins, 4));
        }
    }
}

pub fn b7_the_guard_band_reaches_to_its_last_sub_pixel_and_no_farther(ledger: &mut Ledger) {
    const LAST: f64 = 8_388_607.0;
    let view = flat_view(48, 40);
    for beyond in [0.0, 1.0] {
        for sign in [-1.0, 1.0] {
            for axis in 0..2 {
                let mut corner = [40.0, -30.0];
                corner[axis] = sign * (LAST + beyond);
                let others = [[-2560.0, -2304.0], [1280.0, 2048.0]];
                let triangle = [corner, others[0], others[1]].map(|p| on_screen(p, 0.5));
                let bins = bins(two_sided(soup(&[triangle])), &view, 8);
                let setting = format!("guard band {corner:?}");
                ledger.holds(&setting, "cut or not cut wrongly", bins.counts.clipped == beyond as u64);
                let exact = coverage::seen(&bins, &view, 8);
                ledger.holds(&setting, "pictures unlike O1", visible(&bins, 8) == exact);
                let solids = geometric::solids(&[triangle]);
                let answers = geometric::seen(&solids, &view, 8);
                let differences = geometric::compare(&visible(&bins, 8).sources(&bins), &answers);
                let case = format!("guard band {corner:?}");
                ledger.at_most(
                    &case,
                    "samples differing outside the band",
                    f64::from(differences.certain),
                    0.0,
                );
            }
        }
    }
}

/// With a near plane so close that products with its distance lose their digits, or as far away as
/// the coordinates may reach.
pub fn b7_near_planes_at_the_ends_of_the_range_of_numbers_cut_without_trouble(ledger: &mut Ledger) {
    let mut rng = ledger.random(15);
    for near in [5e-324, 1e-322, 1e-310, 1e-300, 1e-38, 1e20, 1e37] {
        for _ in 0..2000 {
            let view = perspective_view(40, 30, 0.7, near);
            let mut corner = || {
                let size = [near, 1.0, 1e10, 1e37][rng.below(4)] * rng.between(0.0, 4.0);
                let mut c = || rng.between(-1.0, 1.0) * size.min(2e37);
                DVec3::new(c(), c(), c())
            };
            let triangle = [corner(), corner(), corner()];
            let bins = bins(two_sided(soup(&[triangle])), &view, 1);
            let limit = 1 << 23;
            let all = stage::triangles(&bins).flat_map(|t| t.x.into_iter().chain(t.y));
            let worst = all.map(i32::abs).max().unwrap_or(0);
            let setting = format!("near {near:e}");
            ledger.holds(&setting, "coordinates beyond the guard band", worst < limit);
            let seen = visible(&bins, 1);
            let beyond = seen.depth.iter().filter(|d| !(0.0..=1.0).contains(*d)).count();
            ledger.none_of(&setting, "depths beyond 0 to 1", beyond, seen.depth.len());
            ledger.holds(&setting, "pictures unlike O1", seen == coverage::seen(&bins, &view, 1));
        }
    }
}

pub fn b7_whole_frames_of_enormous_triangles_are_finite_and_repeatable(ledger: &mut Ledger) {
    let mut rng = ledger.random(16);
    for size in [1e10, 1e19, 1e30, 2e37] {
        for orthographic in [false, true] {
            let mut corners = || -> Vec<[f64; 3]> {
                (0..30).map(|_| [0; 3].map(|_| rng.between(-1.0, 1.0) * size)).collect()
            };
            let mut json = serde_json::json!({
                "camera": { "position": [0, 1, 5], "near": 1 },
                "lights": {
                    "sun": { "type": "directional", "direction": [-1, -1, -1], "shadow": { "filter": "hard", "resolution": 64 } },
                    "lamp": { "type": "point", "position": [0, size, 1] },
                },
                "textures": { "tiles": { "checker": { "colors": ["#123", "#fed"], "cells": 8 } } },
                "materials": { "tiled": { "diffuse_map": "tiles", "specular": [1, 1, 1] } },
                "meshes": {
                    "far": { "type": "triangles", "positions": corners() },
                    "box": { "type": "box" },
                    "floor": { "type": "plane", "size": [size, size], "uv_repeat": [1e6, 1e6] },
                },
                "instances": {
                    "a": { "mesh": "far", "material": "tiled" },
                    "b": { "mesh": "box", "material": "tiled" },
                    "c": { "mesh": "floor", "material": "tiled", "translation": [0, -1, 0] },
                    "d": { "mesh": "box", "material": "tiled", "scale": size / 2.0, "rotation_deg": [1, 2, 3] },
                },
                "render": { "width": 70, "height": 50, "cull": "none" },
            });
            if orthographic {
                json["camera"]["orthographic"] = serde_json::json!({ "height": 10 });
            }
            let scene = draw::scene(&json);
            for output in [Output::Color, Output::Normal, Output::Depth, Output::Instance, Output::Albedo] {
                let plan = draw::plan(&scene, &FrameRequest { output, ..FrameRequest::default() });
                let first = draw::render(&plan).pixels;
                let again = draw::render(&plan).pixels;
                ledger.holds(
                    &format!("frame to {size:e}, {output:?}"),
                    "pictures not repeated",
                    first == again,
                );
            }
        }
    }
}
