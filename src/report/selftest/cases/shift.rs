//! Scenes far from the world's origin (B19).

use super::camera::{Camera, shells};
use super::coverage::SNAP_BOUND;
use crate::plan::{FrameRequest, Output};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw;
use crate::report::selftest::instruments::oracle::geometric;
use glam::DVec3;
use serde_json::{Value, json};

/// A scene with all that could depend on where it lies; every coordinate is a multiple of 2⁻²⁰.
fn scene_at(shift: [f64; 3], unit: f64) -> Value {
    let at = |p: [f64; 3]| -> Vec<f64> { (0..3).map(|i| p[i] * unit + shift[i]).collect() };
    json!({
        "camera": { "position": at([3.0, 2.25, 4.125]), "target": at([0.0, 0.5, 0.0]), "fov_y_deg": 40 },
        "lights": {
            "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "intensity": 2,
                     "shadow": { "filter": "hard", "resolution": 256 } },
            "lamp": { "type": "point", "position": at([1.0, 2.0, 1.5]) },
        },
        "textures": { "tiles": { "checker": { "colors": ["#123", "#fed"], "cells": 8 } } },
        "materials": { "tiled": { "diffuse_map": "tiles", "specular": [0.3, 0.3, 0.3] } },
        "meshes": {
            "box": { "type": "box" }, "floor": { "type": "plane", "size": [6, 6], "uv_repeat": [3, 3] },
            "torus": { "type": "torus" },
            "bent": { "type": "triangles", "positions": [[0.1, 0, 0], [0.7, 0.1, 0.2], [0.3, 0.9, 0], [1, 1, 1]],
                      "indices": [[0, 1, 2], [2, 1, 3]] },
        },
        "instances": {
            "a": { "mesh": "box", "material": "tiled", "translation": at([0.0, 0.75, 0.0]), "rotation_deg": [17, 33, 5] },
            "b": { "mesh": "floor", "material": "tiled", "translation": at([0.0, 0.0, 0.0]) },
            "c": { "mesh": "torus", "translation": at([1.0, 0.5, 0.5]), "rotation_deg": [70, 0, 11], "scale": [1, 0.7, 1.3] },
            "d": { "mesh": "bent", "translation": at([-1.0, 0.5, 0.75]), "rotation_deg": [3, 250, 0],
                   "spin": { "axis": [1, 1, 0], "deg_per_s": 30 } },
        },
        "render": { "width": 150, "height": 110, "cull": "none" },
    })
}

const FAR_AWAY: [f64; 3] = [1e7, -1e7, 1e7];

pub fn b19_a_scene_far_from_the_origin_has_the_same_bytes_where_its_numbers_are_exact(ledger: &mut Ledger) {
    let zero = draw::scene(&scene_at([0.0; 3], 1.0));
    for shift in [FAR_AWAY, [0.5, 1024.0, -2f64.powi(-20)], [-1e7, 3.0, 1e6 + 2f64.powi(-20)]] {
        let moved = draw::scene(&scene_at(shift, 1.0));
        for output in [Output::Color, Output::Normal, Output::Depth, Output::Instance] {
            for t in [0.0, 1.7] {
                let request = FrameRequest { output, t, ..FrameRequest::default() };
                let frames = [&zero, &moved].map(|scene| draw::render(&draw::plan(scene, &request)).pixels);
                let setting = format!("{output:?} at {shift:?}, t = {t}");
                ledger.holds(&setting, "frames with other bytes", frames[0] == frames[1]);
            }
        }
    }
}

pub fn b19_a_scene_far_from_the_origin_is_the_same_but_for_rounding_where_they_are_not(ledger: &mut Ledger) {
    let mut rng = ledger.random(33);
    let shift = DVec3::from_array(FAR_AWAY);
    let camera = Camera { eye: DVec3::new(2.1, 1.3, 3.7), ..Camera::STANDARD };
    let base = shells(&mut rng, 60, &camera, 0.08, 1e3);
    let moved = Camera { eye: camera.eye + shift, target: camera.target + shift, ..camera };
    let away: Vec<_> = base.iter().map(|t| t.map(|p| p + shift)).collect();
    moved.sees_what_rays_see(ledger, "rays", std::slice::from_ref(&away));
    // Each coordinate is rounded to 2⁻²⁹, which here is 10⁻⁴ sub-pixels: within the band everywhere.
    let drawn = draw::values_of(&moved.document(&away), Output::Instance);
    let unmoved = draw::values_of(&camera.document(&base), Output::Instance);
    let differing = drawn.iter().zip(&unmoved).filter(|(a, b)| a != b).count() as f64;
    let perimeter = geometric::perimeter(&camera.solids(&base), &camera.view());
    ledger.at_most(
        "",
        "pixels unlike the unmoved frame per px of perimeter",
        differing / perimeter,
        SNAP_BOUND,
    );
}
