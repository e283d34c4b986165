//! What the data outputs show, and `pick`.

use crate::closed_form::{Camera, Lens, Ray, hit_box, hit_plane, hit_sphere};
use crate::draw::{Picture, frame, output, pick, plan, scene, values, work};
use crate::measure::{Worst, at_most, none_of};
use glam::DVec3;
use rasterd::pipeline;
use rasterd::plan::Output;
use serde_json::{Value, json};

/// A ball and a box on a floor; their names in order are ball, crate, floor.
fn still_life(camera: &Camera) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "background": { "type": "color", "color": "#fff" } },
        "lights": { "sun": { "type": "directional", "direction": [-1, -2, -1], "shadow": { "filter": "hard" } } },
        "materials": {
            "blue": { "diffuse": "#2040c0", "emissive": [1, 1, 1] }, "green": { "diffuse": "#30a050", "shading": "unlit" },
            "grey": { "diffuse": "#808080" },
        },
        "meshes": {
            "ball": { "type": "sphere", "radius": 0.5, "segments": 256, "rings": 128 },
            "box": { "type": "box" }, "floor": { "type": "plane", "size": [8, 8] },
        },
        "instances": {
            "floor": { "mesh": "floor", "material": "grey" },
            "crate": { "mesh": "box", "material": "green", "translation": [0.9, 0.5, 0.2] },
            "ball": { "mesh": "ball", "material": "blue", "translation": [-0.6, 0.5, 0] },
        },
        "render": camera.render(4),
    })
}

/// 1 + an instance's place in the sorted names, and the distance along the axis.
type Hit = (u16, f64);

/// The nearest instance on a line of sight.
fn seen(ray: Ray) -> Option<Hit> {
    let box_centre = DVec3::new(0.9, 0.5, 0.2);
    let floor = hit_plane(ray, DVec3::ZERO, DVec3::Y).filter(|&s| ray.at(s).abs().max_element() < 4.0);
    let hits = [
        (1, hit_sphere(ray, DVec3::new(-0.6, 0.5, 0.0), 0.5)),
        (2, hit_box(ray, box_centre - 0.5, box_centre + 0.5)),
        (3, floor.filter(|_| ray.direction.y < 0.0)),
    ];
    let known = hits.into_iter().filter_map(|(id, s)| s.map(|s| (id, s)));
    known.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn cameras() -> [Camera; 2] {
    let perspective = Camera::perspective([1.9, 2.2, 4.1], [0.1, 0.3, 0.0], 45.0, 120, 90);
    [perspective, Camera { lens: Lens::Orthographic(3.4), ..perspective }]
}

/// Pixels whose instance is beyond doubt. The ball's outline is that of its facets, 4·10⁻⁵ inside.
fn certain(camera: &Camera) -> Vec<(u32, u32, Option<Hit>)> {
    let id = |ray: Ray| seen(ray).map(|hit| hit.0);
    let steady = |&(x, y): &(u32, u32)| camera.steady(x, y, 0.05, id).is_some();
    camera.pixels().filter(steady).map(|(x, y)| (x, y, seen(camera.centre(x, y)))).collect()
}

#[test]
fn instance_ids_are_places_in_the_sorted_names_and_never_blended() {
    for camera in cameras() {
        let ids = values(frame(&scene(&still_life(&camera)), &output(Output::Instance)));
        assert!(ids.iter().all(|id| *id <= 3));
        let pixels = certain(&camera);
        let wrong = pixels
            .iter()
            .filter(|&&(x, y, hit)| ids[(y * camera.width + x) as usize] != hit.map_or(0, |(id, _)| id));
        none_of("output=instance", "wrong ids", wrong.count(), pixels.len());
        assert!((1..=3).all(|id| { pixels.iter().any(|(_, _, hit)| hit.is_some_and(|hit| hit.0 == id)) }));
    }
}

#[test]
fn albedo_is_the_diffuse_colour_whatever_the_shading() {
    let camera = cameras()[0];
    let picture = Picture::new(frame(&scene(&still_life(&camera)), &output(Output::Albedo)));
    let codes = [[0; 3], [0x20, 0x40, 0xc0], [0x30, 0xa0, 0x50], [0x80; 3]];
    let pixels = certain(&camera);
    let wrong = pixels
        .iter()
        .filter(|&&(x, y, hit)| picture.at(x, y)[..3] != codes[usize::from(hit.map_or(0, |(id, _)| id))]);
    none_of("output=albedo", "wrong pixels", wrong.count(), pixels.len());
}

/// Compares depths with the closed form.
fn assert_depths(case: &str, camera: &Camera, document: &Value, near: f64, far: f64) {
    let frame = frame(&scene(document), &output(Output::Depth));
    let range = frame.depth_range.expect("a depth picture names its range");
    at_most(case, "range", (range[0] - near).abs().max((range[1] / far - 1.0).abs()), 1e-12);
    let depths = values(frame);
    let (mut worst, mut checked) = (Worst::default(), 0);
    for (x, y, hit) in certain(camera) {
        // Where the ball is seen at a grazing angle its facets lie visibly deeper.
        let ray = camera.centre(x, y);
        let is_grazing = |s: f64| {
            let normal = (ray.at(s) - DVec3::new(-0.6, 0.5, 0.0)).normalize();
            normal.dot(ray.direction.normalize()) > -0.3
        };
        if hit.is_some_and(|(id, s)| id == 1 && is_grazing(s)) {
            continue;
        }
        let share = hit.map_or(1.0, |(_, z)| ((z - near) / (far - near)).clamp(0.0, 1.0));
        worst.note((f64::from(depths[(y * camera.width + x) as usize]) - 65535.0 * share).abs());
        checked += 1;
    }
    assert!(checked > 5000);
    at_most(case, "largest difference in codes", worst.largest(), 4.0);
}

#[test]
fn depth_is_the_distance_along_the_axis_between_near_and_far() {
    for (name, camera) in ["perspective", "orthographic"].into_iter().zip(cameras()) {
        let mut document = still_life(&camera);
        document["camera"]["near"] = json!(0.5);
        document["camera"]["far"] = json!(20);
        assert_depths(&format!("depth with far, {name}"), &camera, &document, 0.5, 20.0);
    }
}

#[test]
fn without_far_the_depth_range_ends_at_the_farthest_point() {
    for (name, camera) in ["perspective", "orthographic"].into_iter().zip(cameras()) {
        let forward = camera.axes()[2];
        let corner = |[x, y, z]: [f64; 3]| (DVec3::new(x * 4.0, y, z * 4.0) - camera.eye).dot(forward);
        let corners = [-1.0, 1.0].into_iter().flat_map(|x| [-1.0, 1.0].map(|z| corner([x, 0.0, z])));
        // The bounds are those of all instances together: the floor, and 1 high.
        let high = [-1.0, 1.0].into_iter().flat_map(|x| [-1.0, 1.0].map(|z| corner([x, 1.0, z])));
        let far = corners.chain(high).fold(0.0, f64::max);
        assert_depths(&format!("depth without far, {name}"), &camera, &still_life(&camera), 0.1, far);
    }
}

#[test]
fn nothing_outside_near_and_far_is_drawn() {
    for (name, camera) in ["perspective", "orthographic"].into_iter().zip(cameras()) {
        let (near, far) = (4.2, 5.3);
        let mut document = still_life(&camera);
        document["camera"]["near"] = json!(near);
        document["camera"]["far"] = json!(far);
        // The floor alone: what a cut opens in the others shows their inside.
        document["instances"] = json!({ "floor": document["instances"]["floor"] });
        let inside = |ray: Ray| {
            let hit = hit_plane(ray, DVec3::ZERO, DVec3::Y).filter(|&s| ray.at(s).abs().max_element() < 4.0);
            hit.is_some_and(|z| ray.direction.y < 0.0 && z > near && z < far)
        };
        let ids = values(frame(&scene(&document), &output(Output::Instance)));
        let certain = |&(x, y): &(u32, u32)| camera.steady(x, y, 0.02, inside).map(|known| (x, y, known));
        let pixels: Vec<_> = camera.pixels().filter_map(|pixel| certain(&pixel)).collect();
        let wrong =
            pixels.iter().filter(|&&(x, y, known)| (ids[(y * camera.width + x) as usize] > 0) != known);
        none_of(&format!("near and far, {name}"), "wrong pixels", wrong.count(), pixels.len());
    }
}

#[test]
fn pick_agrees_with_instance_and_depth_and_knows_the_position() {
    for (name, camera) in ["perspective", "orthographic"].into_iter().zip(cameras()) {
        let mut document = still_life(&camera);
        document["camera"]["far"] = json!(20);
        let scene = scene(&document);
        let ids = values(frame(&scene, &output(Output::Instance)));
        let depths = values(frame(&scene, &output(Output::Depth)));
        let (mut worst, mut off, mut hits) = (Worst::default(), Worst::default(), 0);
        for (x, y) in camera.pixels().filter(|(x, y)| x % 9 == 4 && y % 7 == 3) {
            let at = (y * camera.width + x) as usize;
            let Some(hit) = pick(&scene, x, y) else {
                assert_eq!((ids[at], depths[at]), (0, u16::MAX));
                continue;
            };
            hits += 1;
            assert_eq!(u32::from(ids[at]), hit.instance + 1);
            let code = (65535.0 * (hit.depth - 0.1) / (20.0 - 0.1) + 0.5).floor();
            assert_eq!(f64::from(depths[at]), code, "({x}, {y})");
            // A centre on a line of sight is where its instance is.
            let p = camera.centre(x, y).at(hit.depth);
            worst.note((hit.position - p).length());
            if hit.instance == 2 {
                off.note(hit.position.y.abs());
            }
        }
        assert!(hits > 50);
        at_most(&format!("pick, {name}"), "position off the line of sight", worst.largest(), 1e-9);
        // A sub-pixel is 1.5·10⁻⁴ units at this distance, foreshortened on the floor.
        at_most(&format!("pick, {name}"), "height over the floor", off.largest(), 3e-4);
    }
}

/// Whether each pixel is on a line.
fn lines(document: &Value) -> Vec<bool> {
    let picture = Picture::new(frame(&scene(document), &output(Output::Wireframe)));
    picture.pixels.iter().map(|pixel| pixel[0] == 255).collect()
}

/// Two cards, one behind the other, seen straight on: 10 pixels a unit.
fn cards() -> Value {
    let card = |x: f64, y: f64, half: f64, z: f64| json!({ "type": "triangles", "positions": [[x - half, y - half, z], [x + half, y - half, z], [x + half, y + half, z]] });
    json!({
        "camera": { "position": [0, 0, 5], "target": [0, 0, 0], "orthographic": { "height": 8 } },
        "lights": {},
        "meshes": { "near": card(0.0, 0.0, 2.03, 1.0), "far": card(1.0, -1.0, 2.03, 0.0) },
        "instances": { "near": { "mesh": "near" }, "far": { "mesh": "far" } },
        "render": { "width": 80, "height": 80 },
    })
}

#[test]
fn a_wireframe_has_the_edges_that_are_not_hidden() {
    // The legs of the near triangle are at x = 2.03 and y = −2.03, those of the far one at 3.03 and −3.03.
    // The hypotenuses run along y = x and y = x − 2.
    let lit = lines(&cards());
    let (mut right, mut wrong) = (0, 0);
    for (i, lit) in (0..).zip(lit) {
        let p = [f64::from(i % 80) / 10.0 - 3.95, 3.95 - f64::from(i / 80) / 10.0];
        let inside = |c: [f64; 2], p: [f64; 2]| {
            let (x, y) = (p[0] - c[0], p[1] - c[1]);
            (2.03 - x).min(y + 2.03).min((x - y) * std::f64::consts::FRAC_1_SQRT_2)
        };
        let (near, far) = (inside([0.0, 0.0], p), inside([1.0, -1.0], p));
        // Half a pixel is 0.05; what is as close to that as the snapping, or near a corner, is left out.
        let on = |distance: f64| distance.abs() < 0.05;
        if [near, far].iter().any(|d| (d.abs() - 0.05).abs() < 0.003) {
            continue;
        }
        let corner =
            [[2.03, -2.03], [2.03, 2.03], [-2.03, -2.03], [3.03, -3.03], [3.03, 1.03], [-1.03, -3.03]];
        if corner.iter().any(|c| (p[0] - c[0]).hypot(p[1] - c[1]) < 0.2) {
            continue;
        }
        // Where the far one's edge runs behind the near one it is hidden.
        let expected = on(near) || (on(far) && near < 0.0);
        right += usize::from(expected && lit);
        wrong += usize::from(expected != lit);
    }
    assert!(right > 120, "{right}");
    none_of("wireframe", "pixels that are wrongly lines or none", wrong, right);
}

#[test]
fn a_wireframe_line_has_no_gap() {
    // The hypotenuse of the near triangle, row by row.
    let lit = lines(&cards());
    for row in 22..58 {
        assert!((0..80).any(|x| lit[row * 80 + x] && x < 79 - row + 2), "row {row}");
    }
}

#[test]
fn a_cut_triangle_shows_its_own_edges_alone() {
    // A floor of two triangles under the eye, cut by the near plane: the cut is no line, nor are the
    // seams between its pieces.
    let floor = json!({
        "camera": { "position": [0, 1, 0], "target": [0, 1, -1], "fov_y_deg": 90, "near": 1 },
        "lights": {},
        "meshes": { "floor": { "type": "triangles", "positions": [[-900, 0, 900], [900, 0, 900], [0, 0, -900]] } },
        "instances": { "floor": { "mesh": "floor" } },
        "render": { "width": 64, "height": 64 },
    });
    let lit = lines(&floor);
    assert!(lit[40 * 64..].iter().all(|lit| !lit));
    assert!(lit.iter().any(|lit| *lit));
}

/// The still life behind a fence with holes.
fn fenced(camera: &Camera, samples: u32) -> Value {
    let mut document = still_life(camera);
    document["render"]["samples"] = json!(samples);
    document["textures"] = json!({ "holes": { "checker": { "colors": ["#fff", "#000"], "cells": 4 } } });
    document["materials"]["fence"] =
        json!({ "opacity_map": "holes", "alpha_cutoff": 0.5, "double_sided": true });
    document["instances"]["fence"] =
        json!({ "mesh": "box", "material": "fence", "translation": [-0.2, 0.7, 1.2], "scale": [2, 1, 0.2] });
    document
}

/// Draws every output of a document together, and compares each with what is drawn of it alone. Returns
/// how many passes over the triangles it took, and how many looks at the tiles.
fn draw_together(document: &Value) -> [usize; 2] {
    let all = [
        Output::Color,
        Output::Depth,
        Output::Normal,
        Output::Albedo,
        Output::Ids,
        Output::Instance,
        Output::Wireframe,
    ];
    let scene = scene(document);
    let plans = all.map(|what| plan(&scene, &output(what)));
    let together = pipeline::render_each(&plans, &work()).expect("nobody cancels");
    for ((what, frame), plan) in all.iter().zip(&together).zip(&plans) {
        let alone = pipeline::render(plan, &work()).expect("nobody cancels");
        assert!(frame.pixels == alone.pixels, "{what:?}");
    }
    let passes = together.iter().filter(|frame| frame.timings.iter().any(|(pass, _)| pass == "geometry"));
    assert_eq!(
        passes.clone().count(),
        together.iter().filter(|frame| frame.stats.geometry.triangles > 0).count()
    );
    let is_first = |at: &usize| !plans[..*at].iter().any(|earlier| plans[*at].looks_as(earlier));
    [passes.count(), (0..plans.len()).filter(is_first).count()]
}

#[test]
fn outputs_drawn_together_are_those_drawn_alone() {
    for camera in &cameras() {
        assert_eq!(draw_together(&fenced(camera, 1)), [1, 1]);
        assert_eq!(draw_together(&fenced(camera, 16)), [1, 2]);
        // Data outputs show glass as solid, so theirs are other triangles.
        let mut glassy = fenced(camera, 4);
        glassy["materials"]["green"]["opacity"] = json!(0.6);
        assert_eq!(draw_together(&glassy), [2, 2]);
    }
}
