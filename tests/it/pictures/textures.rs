//! Textures: perspective, addressing, filters, levels.

use super::sampler::{Reference, Wrap};
use crate::closed_form::{Camera, Ray, code, codes_apart, decode, hit_plane};
use crate::draw::{Picture, file, frame, png, scene_with};
use crate::measure::{Worst, at_most, none_of};
use glam::{DVec2, DVec3};
use rasterd::plan::FrameRequest;
use rasterd::scene::Files;
use serde_json::{Value, json};

/// A checkered floor, unlit.
fn checkered(camera: &Camera, size: f64, repeat: f64, filter: &str) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "background": { "type": "color", "color": "#f00" } },
        "lights": {},
        "textures": { "checker": { "checker": { "colors": ["#000", "#fff"], "cells": 8 }, "filter": filter } },
        "materials": { "checker": { "shading": "unlit", "diffuse": [1, 1, 1], "diffuse_map": "checker" } },
        "meshes": { "floor": { "type": "plane", "size": [size, size], "uv_repeat": [repeat, repeat] } },
        "instances": { "floor": { "mesh": "floor", "material": "checker" } },
        "render": camera.render(1),
    })
}

/// Texture coordinates of the floor on a line of sight: u along +x, v along −z.
fn floor_uv(ray: Ray, size: f64, repeat: f64) -> Option<DVec2> {
    let p = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Y)?);
    let uv = DVec2::new(p.x, -p.z) / size + 0.5;
    (uv.min_element() > 0.0 && uv.max_element() < 1.0).then_some(uv * repeat)
}

/// Which of the two colours a checker of 8 × 8 cells has at `uv`.
fn is_white(uv: DVec2) -> bool {
    let cell = (uv * 8.0).floor();
    (cell.x + cell.y).rem_euclid(2.0) == 1.0
}

#[test]
fn a_checker_is_perspective_correct_at_every_pixel_away_from_its_lines() {
    for (name, camera, size, repeat) in [
        ("floor", Camera::perspective([0.3, 1.0, 2.0], [0.1, 0.0, -0.4], 50.0, 160, 120), 4.0, 1.0),
        ("repeated", Camera::perspective([1.0, 0.7, 2.0], [-0.4, 0.0, -0.4], 70.0, 160, 120), 6.0, 3.0),
        (
            "from behind the camera",
            Camera::perspective([0.0, 0.4, 0.0], [0.2, 0.0, -1.0], 80.0, 160, 120),
            40.0,
            8.0,
        ),
        ("orthographic", Camera::orthographic([0.3, 1.0, 2.0], [0.1, 0.0, -0.4], 3.0, 160, 120), 4.0, 1.0),
    ] {
        let picture = Picture::of(&checkered(&camera, size, repeat, "nearest"));
        let (mut wrong, mut checked) = (0, 0);
        for (x, y, pixel) in picture.iter() {
            let cell = |ray: Ray| floor_uv(ray, size, repeat).map(|uv| (uv * 8.0).floor());
            let Some(Some(cell)) = camera.steady(x, y, 0.02, cell) else {
                continue;
            };
            checked += 1;
            let expected = if is_white(cell / 8.0) { [255; 4] } else { [0, 0, 0, 255] };
            if pixel != expected {
                println!("({x}, {y}) shows {pixel:?}, not {expected:?}");
                wrong += 1;
            }
        }
        assert!(checked > 4000, "{name}: {checked}");
        none_of(&format!("checker, {name}"), "wrong pixels", wrong, checked);
    }
}

#[test]
fn a_close_look_at_a_huge_floor_shows_its_texture_where_it_is() {
    for repeat in [1e2, 1e3, 1e4, 1e5] {
        let size = repeat * 2.0;
        let camera = Camera::perspective([0.63, 0.5, 0.41], [0.8, 0.0, 0.1], 20.0, 160, 120);
        let picture = Picture::of(&checkered(&camera, size, repeat, "nearest"));
        let (mut wrong, mut checked) = (0, 0);
        for (x, y, pixel) in picture.iter() {
            let cell = |ray: Ray| floor_uv(ray, size, repeat).map(|uv| (uv * 8.0).floor());
            let Some(Some(cell)) = camera.steady(x, y, 0.05, cell) else {
                continue;
            };
            checked += 1;
            wrong += usize::from((pixel[0] == 255) != is_white(cell / 8.0));
        }
        none_of(&format!("close look, repeated {repeat:e}"), "wrong pixels", wrong, checked);
    }
}

#[test]
fn a_floor_to_the_horizon_is_right_near_the_eye() {
    let (size, repeat) = (2e5, 1e5);
    let camera = Camera::perspective([0.0, 1.0, 0.0], [0.3, 0.8, -1.0], 60.0, 160, 120);
    let picture = Picture::of(&checkered(&camera, size, repeat, "trilinear"));
    let (mut wrong, mut near) = (0, 0);
    for (x, y, pixel) in picture.iter() {
        let Some(uv) = floor_uv(camera.centre(x, y), size, repeat) else {
            continue;
        };
        let step = |dx: f64, dy: f64| {
            let there = floor_uv(camera.ray(f64::from(x) + 0.5 + dx, f64::from(y) + 0.5 + dy), size, repeat);
            there.map_or(f64::INFINITY, |there| (there - uv).length())
        };
        // Two texels of its level and a pixel away from a line, filtering sees one colour.
        let reach = 2.0 * step(1.0, 0.0).max(step(0.0, 1.0)) + 2.0 / 1024.0;
        let corners =
            [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[a, b]| uv + DVec2::new(a, b) * reach);
        if reach < 0.06 && corners.iter().all(|&corner| (corner * 8.0).floor() == (uv * 8.0).floor()) {
            near += 1;
            wrong += usize::from(pixel[0] != if is_white(uv) { 255 } else { 0 });
        }
    }
    none_of("floor to the horizon, near", "wrong pixels", wrong, near);
}

/// A picture of 64 × 64 pixels that shows texture coordinates from `from` to `to`.
fn chart(from: DVec2, to: DVec2, filter: &str, wrap: &str) -> Value {
    let camera = Camera::orthographic([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 2.0, 64, 64);
    json!({
        "camera": camera.document(),
        "environment": { "background": { "type": "color", "color": "#000" } },
        "lights": {},
        "textures": { "map": { "file": "map.png", "filter": filter, "wrap": wrap } },
        "materials": { "map": { "shading": "unlit", "diffuse": [1, 1, 1], "diffuse_map": "map" } },
        "meshes": { "chart": { "type": "triangles",
            "positions": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "indices": [0, 1, 2, 0, 2, 3],
            "uvs": [[from.x, from.y], [to.x, from.y], [to.x, to.y], [from.x, to.y]] } },
        "instances": { "chart": { "mesh": "chart", "material": "map" } },
        "render": camera.render(1),
    })
}

fn draw(document: &Value, files: &Files) -> Picture {
    Picture::new(frame(&scene_with(document, files), &FrameRequest::default()))
}

/// Texture coordinates of a pixel's centre in a [`chart`].
fn chart_uv(from: DVec2, to: DVec2, x: u32, y: u32) -> DVec2 {
    let at = DVec2::new(f64::from(x) + 0.5, 63.5 - f64::from(y)) / 64.0;
    from + (to - from) * at
}

/// Texels without order, of middling brightness: sRGB codes are coarse for dark ones.
fn motley(x: u32, y: u32) -> [u8; 4] {
    let noise = |salt: u32| {
        let h = (x * 0x9e37 + y * 0x85eb + salt * 0xc2b3).wrapping_mul(0x045d_9f3b);
        60 + ((h ^ h >> 15).wrapping_mul(0x27d4_eb2f) >> 24) as u8 / 4 * 3
    };
    [noise(1), noise(2), noise(3), 255]
}

/// Largest difference between a chart and a reference, in codes.
fn worst(picture: &Picture, from: DVec2, to: DVec2, expected: impl Fn(DVec2) -> DVec3) -> f64 {
    let apart = |(x, y, pixel): (u32, u32, [u8; 4])| codes_apart(pixel, expected(chart_uv(from, to, x, y)));
    picture.iter().map(apart).collect::<Worst>().largest()
}

#[test]
fn wrap_modes_repeat_clamp_and_mirror_for_every_filter() {
    // Generic ends: no pixel's centre lies on a texel's border.
    let (from, to) = (DVec2::new(-1.317, -2.213), DVec2::new(2.291, 1.471));
    for (width, height) in [(32, 32), (16, 64)] {
        let map = Reference::new(width as usize, height as usize, motley);
        let files = file("map.png", png(width, height, motley));
        let texels = DVec2::new(f64::from(width), f64::from(height)) * (to - from) / 64.0;
        let level = texels.max_element().log2();
        for (name, wrap) in Wrap::ALL {
            for filter in ["nearest", "bilinear", "trilinear"] {
                let picture = draw(&chart(from, to, filter, name), &files);
                let worst = worst(&picture, from, to, |uv| match filter {
                    "nearest" => map.nearest(wrap, uv),
                    "bilinear" => map.bilinear(level.max(0.0), wrap, uv),
                    _ => map.trilinear(level.max(0.0), wrap, uv),
                });
                // Rounding, and for trilinear 1/256 of a level.
                let bound = if filter == "trilinear" { 1.0 } else { 0.55 };
                let case = format!("{width}×{height} {name} {filter}");
                at_most(&case, "largest difference in codes", worst, bound);
            }
        }
    }
}

#[test]
fn the_level_is_log2_of_the_texels_a_pixel_steps_over() {
    let map = Reference::new(64, 64, motley);
    let files = file("map.png", png(64, 64, motley));
    for level in [-1.0, 0.0, 0.3, 0.49, 0.51, 1.0, 1.7, 2.4, 3.25, 4.6, 5.8, 6.0, 8.0] {
        // At level 0 a pixel steps over one texel: the picture shows the whole map.
        let span = f64::exp2(level) * 64.0 / 64.0;
        for aspect in [DVec2::ONE, DVec2::new(1.0, 0.3), DVec2::new(0.3, 1.0)] {
            let from = DVec2::new(0.137, 0.213);
            let to = from + aspect * span;
            for filter in ["bilinear", "trilinear"] {
                let picture = draw(&chart(from, to, filter, "repeat"), &files);
                let chosen = level.clamp(0.0, 6.0);
                let worst = worst(&picture, from, to, |uv| match filter {
                    "bilinear" => map.bilinear(chosen, Wrap::Repeat, uv),
                    _ => map.trilinear(chosen, Wrap::Repeat, uv),
                });
                let bound = if filter == "trilinear" { 1.0 } else { 0.55 };
                at_most(&format!("level {level} of aspect {aspect}, {filter}"), "codes", worst, bound);
            }
        }
    }
}

#[test]
fn colour_is_decoded_before_it_is_filtered() {
    let black_and_white = |x: u32, _: u32| if x == 0 { [0, 0, 0, 255] } else { [255; 4] };
    let files = file("map.png", png(2, 1, black_and_white));
    // All of the picture lies between the two texel centres, in the middle of it both weigh the same.
    let (from, to) = (DVec2::new(0.25, 0.0), DVec2::new(0.75, 1.0));
    let mut document = chart(from, to, "bilinear", "clamp");
    let decoded = draw(&document, &files);
    let linear = |x: u32| (f64::from(x) + 0.5) / 64.0;
    assert!((0..64).all(|x| decoded.at(x, 9)[0].abs_diff(code(linear(x))) <= 1));
    assert_eq!(decoded.at(32, 9)[0], code(linear(32)));
    // Data is not decoded: the codes themselves are the linear numbers.
    document["textures"]["map"]["color_space"] = json!("linear");
    let grey = |_: u32, _: u32| [64, 64, 64, 255];
    let data = draw(&document, &file("map.png", png(2, 1, grey)));
    assert_eq!(data.at(5, 5)[0], code(64.0 / 255.0));
}

#[test]
fn v_runs_up_and_u_to_the_right() {
    let corner = |x: u32, y: u32| match (x, y) {
        (0, 0) => [255, 0, 0, 255], // upper left of the image
        (1, 0) => [0, 255, 0, 255], // upper right
        (0, 1) => [0, 0, 255, 255], // lower left: (u, v) = (0, 0)
        _ => [255, 255, 255, 255],
    };
    let files = file("map.png", png(2, 2, corner));
    let picture = draw(&chart(DVec2::ZERO, DVec2::ONE, "nearest", "repeat"), &files);
    for (x, y, column, row) in [(0, 0, 0, 0), (63, 0, 1, 0), (0, 63, 0, 1), (63, 63, 1, 1), (31, 31, 0, 0)] {
        assert_eq!(picture.at(x, y), corner(column, row), "({x}, {y})");
    }
}

#[test]
fn a_map_multiplies_its_factor() {
    let files = file("map.png", png(1, 1, |_, _| [200, 100, 50, 255]));
    let mut document = chart(DVec2::ZERO, DVec2::ONE, "trilinear", "repeat");
    document["materials"]["map"]["diffuse"] = json!([0.5, 0.25, 1.5]);
    let picture = draw(&document, &files);
    let expected = DVec3::new(decode(200) * 0.5, decode(100) * 0.25, decode(50) * 1.5);
    at_most("map × factor", "codes", codes_apart(picture.at(7, 9), expected), 0.51);
}
