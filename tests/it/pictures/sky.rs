//! Backgrounds.

#![allow(clippy::cast_possible_truncation, reason = "places in small pictures; a wrong one fails the test")]

use crate::closed_form::{Camera, codes_apart, decode};
use crate::draw::{Picture, file, frame, plan, png, scene, scene_with};
use crate::measure::{Worst, at_most};
use glam::DVec3;
use rasterd::limits::Limits;
use rasterd::plan::{FrameRequest, request::BackgroundRequest};
use rasterd::scene::{Background, Document, Files, SceneError, compile};
use serde_json::{Value, json};
use std::sync::Arc;

fn empty(camera: &Camera, background: Value) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "background": background },
        "lights": {},
        "render": camera.render(4),
    })
}

#[test]
fn a_gradient_mixes_by_the_elevation_of_the_line_of_sight() {
    let gradient = json!({ "type": "gradient", "top": "#6ea8e8", "bottom": "#dfe9f5" });
    let linear = |codes: [u8; 3]| DVec3::from_array(codes.map(decode));
    let (top, bottom) = (linear([0x6e, 0xa8, 0xe8]), linear([0xdf, 0xe9, 0xf5]));
    for (name, camera) in [
        ("level", Camera::perspective([1.0, 2.0, 3.0], [4.0, 2.0, -1.0], 60.0, 100, 80)),
        ("almost 180°", Camera::perspective([0.0, 0.0, 0.0], [0.3, 0.2, -1.0], 179.0, 100, 80)),
        ("zenith", Camera::perspective([0.0, 0.0, 0.0], [0.01, 1.0, 0.0], 50.0, 100, 80)),
        ("nadir", Camera::perspective([0.0, 0.0, 0.0], [0.0, -1.0, 0.02], 50.0, 100, 80)),
        ("orthographic", Camera::orthographic([0.0, 0.0, 0.0], [1.0, 0.7, 0.0], 3.0, 64, 48)),
    ] {
        let picture = Picture::of(&empty(&camera, gradient.clone()));
        let worst = picture.iter().map(|(x, y, pixel)| {
            let elevation = camera.centre(x, y).direction.normalize().y.asin().to_degrees();
            codes_apart(pixel, bottom.lerp(top, 0.5 + elevation / 180.0))
        });
        at_most(
            &format!("gradient, {name}"),
            "largest difference in codes",
            worst.collect::<Worst>().largest(),
            1.0,
        );
    }
}

#[test]
fn one_colour_fills_the_picture_exactly() {
    let camera = Camera::perspective([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 50.0, 70, 65);
    let picture = Picture::of(&empty(&camera, json!({ "type": "color", "color": "#123456" })));
    assert!(picture.pixels.iter().all(|pixel| *pixel == [0x12, 0x34, 0x56, 255]));
}

#[test]
fn a_transparent_background_is_clear_black() {
    let camera = Camera::perspective([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 50.0, 70, 65);
    let picture = Picture::of(&empty(&camera, json!({ "type": "transparent" })));
    assert!(picture.pixels.iter().all(|pixel| *pixel == [0; 4]));
}

#[test]
fn a_named_background_can_be_chosen_by_document_and_query() {
    let camera = Camera::perspective([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 50.0, 16, 8);
    let mut document = empty(&camera, json!("red"));
    document["environment"]["backgrounds"] = json!({
        "red": { "type": "color", "color": "#f00" }, "blue": { "type": "color", "color": "#00f" },
    });
    assert_eq!(Picture::of(&document).at(3, 4), [255, 0, 0, 255]);
    let background = Some(BackgroundRequest::Named("blue".to_owned()));
    let request = FrameRequest { background, ..FrameRequest::default() };
    assert_eq!(Picture::new(frame(&scene(&document), &request)).at(3, 4), [0, 0, 255, 255]);
}

/// The faces' names in the order of OpenGL's targets.
const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

/// Where OpenGL looks a direction up: the face, and s and t in 0–1, t down (4.6 specification, table 8.19).
fn cube_place(d: DVec3) -> (usize, [f64; 2]) {
    let a = d.abs();
    let (face, sc, tc, ma) = if a.x >= a.y && a.x >= a.z {
        if d.x > 0.0 { (0, -d.z, -d.y, a.x) } else { (1, d.z, -d.y, a.x) }
    } else if a.y >= a.z {
        if d.y > 0.0 { (2, d.x, d.z, a.y) } else { (3, d.x, -d.z, a.y) }
    } else if d.z > 0.0 {
        (4, d.x, -d.y, a.z)
    } else {
        (5, -d.x, -d.y, a.z)
    };
    (face, [sc, tc].map(|c| (c / ma + 1.0) / 2.0))
}

fn cube_map() -> Value {
    let faces = FACES.map(|face| (face.to_owned(), json!(format!("{face}.png"))));
    json!({ "type": "cubemap", "faces": Value::Object(faces.into_iter().collect()) })
}

/// Six faces whose texels a function of face, column and row gives.
fn cube_files(side: u32, texel: impl Fn(usize, u32, u32) -> [u8; 4]) -> Files {
    let mut files = Files::default();
    for (face, name) in FACES.iter().enumerate() {
        let bytes = png(side, side, |x, y| texel(face, x, y));
        files.insert(&format!("{name}.png"), bytes.into()).expect("a sound name");
    }
    files
}

fn picture(document: &Value, files: &Files) -> Picture {
    Picture::new(frame(&scene_with(document, files), &FrameRequest::default()))
}

fn small(n: u32) -> u8 {
    u8::try_from(n).expect("few texels")
}

#[test]
fn every_texel_of_a_cube_map_is_seen_where_opengl_has_it() {
    // Four pixels of 90° look straight at the centres of four texels.
    let texel = |face: usize, x: u32, y: u32| [small(40 * face as u32), small(60 * x), small(60 * y), 255];
    let files = cube_files(4, texel);
    let mut faces_seen = Vec::new();
    for axis in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        let camera = Camera::perspective([0.0; 3], axis.to_array(), 90.0, 4, 4);
        let picture = picture(&empty(&camera, cube_map()), &files);
        for (x, y, pixel) in picture.iter() {
            let (face, st) = cube_place(camera.centre(x, y).direction);
            let [column, row] = st.map(|c| (c * 4.0).floor() as u32);
            assert_eq!(pixel, texel(face, column, row), "{axis} {x} {y}");
            faces_seen.push(face);
        }
    }
    faces_seen.dedup();
    assert_eq!(faces_seen, [0, 1, 2, 3, 4, 5]);
}

#[test]
fn a_face_that_is_missing_warns_and_shows_the_default_gradient() {
    let camera = Camera::perspective([0.0; 3], [0.3, 0.1, -1.0], 60.0, 24, 24);
    let mut files = cube_files(2, |_, _, _| [255, 0, 0, 255]);
    files.remove("ny.png");
    let scene = scene_with(&empty(&camera, cube_map()), &files);
    assert!(scene.warnings.iter().any(|warning| warning.detail.contains("ny.png")), "{:?}", scene.warnings);
    let gradient = Picture::of(&empty(&camera, json!({ "type": "gradient" })));
    assert_eq!(Picture::new(frame(&scene, &FrameRequest::default())), gradient);
}

#[test]
fn faces_that_make_no_cube_are_named() {
    let camera = Camera::perspective([0.0; 3], [0.0, 0.0, -1.0], 60.0, 8, 8);
    let mut files = cube_files(4, |_, _, _| [9; 4]);
    files.insert("nx.png", png(4, 3, |_, _| [9; 4]).into()).expect("a sound name");
    files.insert("pz.png", png(8, 8, |_, _| [9; 4]).into()).expect("a sound name");
    let document = Document::from_json(&empty(&camera, cube_map())).expect("a valid document");
    let refused = compile(&document, &files, None, &Limits::default()).expect_err("no cube");
    let SceneError::Document(faults) = refused else { panic!("{refused}") };
    let pointers: Vec<_> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(pointers, ["/environment/background/faces/nx", "/environment/background/faces/pz"]);
}

fn equirect(file: &str) -> Value {
    json!({ "type": "equirect", "file": file })
}

/// Bilinear lookup in f64: wraps around, ends at the poles.
fn look_up(width: u32, height: u32, texel: impl Fn(u32, u32) -> DVec3, d: DVec3) -> DVec3 {
    let u = 0.5 + d.x.atan2(-d.z) / std::f64::consts::TAU;
    let v = 0.5 - d.normalize().y.asin() / std::f64::consts::PI;
    let (x, y) =
        (u * f64::from(width) - 0.5, (v * f64::from(height) - 0.5).clamp(0.0, f64::from(height - 1)));
    let column = |i: f64| i.rem_euclid(f64::from(width)) as u32;
    let row = |y: u32| {
        let (a, b) = (texel(column(x.floor()), y), texel(column(x.floor() + 1.0), y));
        a.lerp(b, x - x.floor())
    };
    let first = y.floor() as u32;
    row(first).lerp(row((first + 1).min(height - 1)), y - y.floor())
}

#[test]
fn a_panorama_is_seen_where_its_texels_are() {
    let (width, height) = (12, 6);
    let codes = |x: u32, y: u32| [small(20 * x), small(40 * y), small(255 - 20 * x), 255];
    let linear = |x: u32, y: u32| {
        let [r, g, b, _] = codes(x, y);
        DVec3::new(decode(r), decode(g), decode(b))
    };
    let files = file("around.png", png(width, height, codes));
    for (name, target, fov) in [
        ("centre", [0.0, 0.0, -1.0], 60.0),
        ("right", [1.0, 0.2, 0.0], 60.0),
        ("seam", [0.05, -0.3, 1.0], 60.0),
        ("up", [0.001, 1.0, 0.002], 70.0),
        ("down", [0.0, -1.0, 0.3], 70.0),
        ("wide", [-1.0, 0.3, 0.4], 150.0),
    ] {
        let camera = Camera::perspective([0.0; 3], target, fov, 96, 64);
        let picture = picture(&empty(&camera, equirect("around.png")), &files);
        let mut worst = Worst::default();
        for (x, y, pixel) in picture.iter() {
            let d = camera.centre(x, y).direction.normalize();
            // Around a pole pixels cover more than a texel, and show the mean of what they cover.
            if d.x.hypot(d.z) > 0.15 {
                worst.note(codes_apart(pixel, look_up(width, height, linear, d)));
            }
        }
        at_most(&format!("panorama, {name}"), "largest difference in codes", worst.largest(), 1.0);
    }
}

#[test]
fn columns_that_meet_at_a_pole_average() {
    let files = file("stripes.png", png(512, 256, |x, _| if x % 2 == 0 { [0, 0, 0, 255] } else { [255; 4] }));
    let camera = Camera::perspective([0.0; 3], [1e-4, 1.0, 0.0], 5.0, 65, 65);
    let picture = picture(&empty(&camera, equirect("stripes.png")), &files);
    let mut worst = Worst::default();
    for (x, y, pixel) in picture.iter() {
        let away = (f64::from(x) - 32.0).hypot(f64::from(y) - 32.0);
        if away < 20.0 {
            // A pixel that far from the pole covers `512 / (2π · away)` columns; the mean of so many of
            // either kind is off by at most one half of one.
            let columns = 512.0 / (std::f64::consts::TAU * (away + 1.0));
            worst.note((decode(pixel[0]) - 0.5).abs() * columns);
        }
    }
    at_most("stripes at the zenith", "difference from the mean in columns", worst.largest(), 0.75);
}

/// A Radiance picture, not compressed; values are whole numbers of 1/128 up to 255.
fn radiance_file(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        bytes.extend(texel(x, y));
        bytes.push(136 - 7);
    }
    bytes
}

#[test]
fn radiance_above_white_survives_until_it_is_averaged() {
    // 1.6 and nothing, by turns: 0.8 on the average, and 0.5 if white were the most there is.
    let texel = |x: u32, _| if x.is_multiple_of(2) { [0; 3] } else { [205, 205, 205] };
    let files = file("sun.hdr", radiance_file(256, 128, texel));
    let camera = Camera::perspective([0.0; 3], [0.0, 1.0, 0.0], 179.0, 9, 9);
    let seen = picture(&empty(&camera, equirect("sun.hdr")), &files).at(4, 4);
    at_most("1.6 and 0", "difference in codes", codes_apart(seen, DVec3::splat(205.0 / 256.0)), 0.6);
}

#[test]
fn an_even_sky_is_even_in_every_view() {
    let color = [188, 90, 33, 255];
    let mut files = cube_files(5, |_, _, _| color);
    files.insert("around.png", png(37, 19, |_, _| color).into()).expect("a sound name");
    for background in [cube_map(), equirect("around.png")] {
        for camera in [
            Camera::perspective([1e5, 0.0, 3.0], [1e5, 1.0, 3.0], 179.9, 33, 65),
            Camera::perspective([0.0; 3], [1.0, 1.0, 1.0], 0.001, 16, 16),
            Camera::perspective([0.0; 3], [0.0, -1.0, 1e-9], 120.0, 64, 70),
            Camera::orthographic([0.0; 3], [0.0, 1.0, 0.0], 3.0, 16, 16),
        ] {
            let picture = picture(&empty(&camera, background.clone()), &files);
            assert!(picture.pixels.iter().all(|pixel| *pixel == color), "{camera:?}");
        }
    }
}

#[test]
fn pictures_of_backgrounds_count_and_are_shared() {
    let camera = Camera::perspective([0.0; 3], [0.0, 0.0, -1.0], 60.0, 8, 8);
    let files = file("a.png", png(8, 4, |x, _| [small(x), 0, 0, 255]));
    let document = |background: Value| {
        let mut document = empty(&camera, json!("one"));
        document["environment"]["backgrounds"] = json!({ "one": background, "two": { "type": "sky" } });
        Document::from_json(&document).expect("a valid document")
    };
    let limits = Limits::default();
    let none = compile(&document(json!({ "type": "transparent" })), &files, None, &limits).expect("a scene");
    let first = compile(&document(equirect("a.png")), &files, None, &limits).expect("a scene");
    assert_eq!(first.assets.bytes() - none.assets.bytes(), 8 * 4 * 4 + (4 * 2 + 2 + 1) * 12);
    let again = compile(&document(equirect("a.png")), &files, Some(&first.assets), &limits).expect("a scene");
    match (&first.scene.background, &again.scene.background) {
        (Background::Panorama(a), Background::Panorama(b)) => assert!(Arc::ptr_eq(a, b)),
        other => panic!("{other:?}"),
    }
    match (&first.scene.backgrounds[1].1, &again.scene.backgrounds[1].1) {
        (Background::Sky(a), Background::Sky(b)) => assert!(Arc::ptr_eq(a, b)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn backgrounds_of_one_size_have_tags_of_their_own() {
    let camera = Camera::perspective([0.0; 3], [0.0, 0.0, -1.0], 60.0, 8, 8);
    let mut files = cube_files(2, |face, _, _| [small(face as u32), 0, 0, 255]);
    for name in ["a.png", "b.png"] {
        files.insert(name, png(4, 2, |_, _| [name.as_bytes()[0]; 4]).into()).expect("a sound name");
    }
    let mut turned = cube_map();
    turned["faces"]["px"] = json!("nx.png");
    let mut document = empty(&camera, json!({ "type": "sky" }));
    document["environment"]["backgrounds"] = json!({
        "a": equirect("a.png"), "b": equirect("b.png"), "cube": cube_map(), "turned": turned,
        "noon": { "type": "sky", "sun_direction": [0, -1, 0] },
        "hazy": { "type": "sky", "sun_direction": [0, -1, 0], "turbidity": 8 },
    });
    let scene = scene_with(&document, &files);
    let tag = |name: &str| {
        let background = Some(BackgroundRequest::Named(name.to_owned()));
        plan(&scene, &FrameRequest { background, ..FrameRequest::default() }).etag()
    };
    let names = ["a", "b", "cube", "turned", "noon", "hazy"];
    let tags: std::collections::BTreeSet<_> = names.into_iter().map(tag).collect();
    assert_eq!(tags.len(), names.len());
}

/// A view of a procedural sky with its sun at an elevation towards −z.
fn sky(elevation_deg: f64, turbidity: f64) -> Value {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    json!({ "type": "sky", "sun_direction": [0.0, -sin, cos], "turbidity": turbidity })
}

fn brightness(pixel: [u8; 4]) -> u32 {
    pixel[..3].iter().map(|&code| u32::from(code)).sum()
}

#[test]
fn the_sun_stands_where_its_light_comes_from() {
    for elevation in [85.0, 30.0, 4.0] {
        let (sin, cos) = f64::to_radians(elevation).sin_cos();
        let towards = DVec3::new(0.0, sin, -cos);
        // Half a degree of haze around it is as white as the disc: look with a narrow view.
        let camera = Camera::perspective([0.0; 3], (towards + DVec3::X * 0.001).to_array(), 2.0, 60, 60);
        let picture = picture(&empty(&camera, sky(elevation, 1.0)), &Files::default());
        let place = camera.project(towards);
        let radius = 0.2666_f64.to_radians().tan() / 1f64.to_radians().tan() * 30.0;
        for (x, y, pixel) in picture.iter() {
            let away = (place.x - f64::from(x) - 0.5).hypot(place.y - f64::from(y) - 0.5);
            if away < radius - 2.0 {
                assert_eq!(pixel[0], 255, "{elevation}: {x} {y}");
            } else if away > radius + 2.0 {
                assert!(pixel[0] < 250, "{elevation}: {x} {y} {pixel:?}");
            }
        }
    }
}

#[test]
fn without_a_direction_the_sun_is_that_of_the_first_enabled_directional_light() {
    let camera = Camera::perspective([0.0; 3], [0.0, 0.4, -1.0], 90.0, 32, 24);
    let mut document = empty(&camera, json!({ "type": "sky" }));
    document["lights"] = json!({
        "a": { "type": "point", "position": [0, 1, 0] },
        "b": { "type": "directional", "direction": [1, -1, 0], "enabled": false },
        "c": { "type": "directional", "direction": [0, -2, 4] },
        "d": { "type": "directional", "direction": [0, -1, 0] },
    });
    let by_light = picture(&document, &Files::default());
    document["environment"]["background"]["sun_direction"] = json!([0, -1, 2]);
    assert_eq!(by_light, picture(&document, &Files::default()));
    document["environment"]["background"]["sun_direction"] = json!([0, -1, 0]);
    assert_ne!(by_light, picture(&document, &Files::default()));
    document["environment"]["background"]["sun_direction"] = json!([-0.5, -1, -0.3]);
    let of_no_light = picture(&document, &Files::default());
    document["environment"]["background"] = json!({ "type": "sky" });
    document["lights"] = json!({});
    assert_eq!(of_no_light, picture(&document, &Files::default()));
}

#[test]
fn sky_and_plain_meet_without_a_line() {
    for elevation in [60.0, 10.0, 0.0, -4.0] {
        for turbidity in [1.0, 3.0, 10.0, 20.0] {
            // Twenty pixels a degree, the horizon in the middle of row 40.
            let camera = Camera::perspective([0.0; 3], [1.0, 0.0, -0.4], 4.0, 8, 81);
            let picture = picture(&empty(&camera, sky(elevation, turbidity)), &Files::default());
            let step = |y: u32| {
                let (above, below) = (picture.at(4, y - 1), picture.at(4, y));
                f64::from((0..3).map(|c| above[c].abs_diff(below[c])).max().unwrap_or(0))
            };
            let at_horizon = f64::max(step(40), step(41));
            let around = (30..40).chain(42..52).map(step).fold(0.0, f64::max);
            let case = format!("sun at {elevation}°, turbidity {turbidity}");
            // No steeper than the sky and the haze are there anyway, to one code of rounding.
            at_most(&case, "step at the horizon in codes", at_horizon, around + 1.0);
        }
    }
}

#[test]
fn a_sky_darkens_as_its_sun_sets() {
    let camera = Camera::perspective([0.0; 3], [0.0, 0.6, 1.0], 60.0, 16, 12);
    for turbidity in [1.0, 3.0, 10.0] {
        let light = |elevation: f64| {
            let picture = picture(&empty(&camera, sky(elevation, turbidity)), &Files::default());
            picture.pixels.iter().map(|&pixel| brightness(pixel)).sum::<u32>()
        };
        let by_elevation: Vec<u32> = [20.0, 5.0, 0.0, -4.0, -10.0, -90.0].map(light).to_vec();
        assert!(by_elevation.is_sorted_by(|a, b| a >= b), "{turbidity}: {by_elevation:?}");
        assert!(by_elevation[0] > 20 * by_elevation[5] && by_elevation[5] > 0, "{by_elevation:?}");
    }
}
