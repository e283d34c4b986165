//! Fronts and backs: culling, mirrored instances, and what an orthographic camera keeps parallel.

use crate::closed_form::{Camera, hit_box};
use crate::draw::{Picture, frame, output, scene};
use crate::measure::none_of;
use glam::DVec3;
use rasterd::plan::Output;
use serde_json::{Value, json};

/// A lopsided triangle that faces +z.
fn triangle(camera: &Camera) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#000" } },
        "lights": { "sun": { "type": "directional", "direction": [0, 0, -1] } },
        "materials": { "white": { "diffuse": [1, 1, 1] } },
        "meshes": { "one": { "type": "triangles",
            "positions": [[-0.71, -0.52, 0], [0.93, -0.38, 0.2], [0.24, 0.83, -0.1]] } },
        "instances": { "one": { "mesh": "one", "material": "white" } },
        "render": camera.render(1),
    })
}

fn front() -> Camera {
    Camera::perspective([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 50.0, 64, 64)
}

fn behind() -> Camera {
    Camera::perspective([0.0, 0.0, -3.0], [0.0, 0.0, 0.0], 50.0, 64, 64)
}

/// Pixels that show anything.
fn covered(picture: &Picture) -> usize {
    picture.pixels.iter().filter(|pixel| pixel[..3] != [0; 3]).count()
}

#[test]
fn culling_leaves_out_backs_fronts_or_nothing() {
    for (cull, shows_front, shows_back) in
        [("back", true, false), ("front", false, true), ("none", true, true)]
    {
        for (camera, shows) in [(front(), shows_front), (behind(), shows_back)] {
            let mut document = triangle(&camera);
            document["render"]["cull"] = json!(cull);
            document["render"]["shading"] = json!("unlit");
            assert_eq!(covered(&Picture::of(&document)) > 100, shows, "cull {cull} from {}", camera.eye);
        }
    }
}

#[test]
fn double_sided_materials_are_exempt_from_culling() {
    for (cull, camera) in [("back", behind()), ("front", front())] {
        let mut document = triangle(&camera);
        document["render"]["cull"] = json!(cull);
        document["render"]["shading"] = json!("unlit");
        document["materials"]["white"]["double_sided"] = json!(true);
        assert!(covered(&Picture::of(&document)) > 100);
    }
}

#[test]
fn a_mirrored_instance_shows_the_mirrored_picture_of_its_front() {
    let camera = front();
    let mut document = triangle(&camera);
    let straight = Picture::of(&document);
    document["instances"]["one"]["scale"] = json!([-1, 1, 1]);
    let mirrored = Picture::of(&document);
    let wrong = straight.iter().filter(|&(x, y, pixel)| {
        // The interpolated light may round the other way.
        pixel[0].abs_diff(mirrored.at(camera.width - 1 - x, y)[0]) > 1
    });
    none_of("mirrored instance", "pixels that are no mirror image", wrong.count(), covered(&straight));
    let normals = |document: &Value| Picture::new(frame(&scene(document), &output(Output::Normal)));
    let turned = normals(&document);
    document["instances"]["one"]["scale"] = json!(1);
    let wrong = normals(&document)
        .iter()
        .filter(|&(x, y, [r, g, b, _])| {
            let [mr, mg, mb, _] = turned.at(camera.width - 1 - x, y);
            let is_there = [r, g, b] != [0; 3];
            // n and −n: codes c and 255 − c, one apart where they round.
            let across = if is_there { i16::from(mr) - (255 - i16::from(r)) } else { 0 };
            across.abs() > 1 || g.abs_diff(mg) > 1 || b.abs_diff(mb) > 1
        })
        .count();
    none_of("mirrored instance", "normals that are no mirror image", wrong, covered(&straight));
}

#[test]
fn every_sign_of_scale_shows_a_closed_box_from_outside() {
    let camera = Camera::perspective([1.7, 1.9, 2.6], [0.0, 0.0, 0.0], 45.0, 90, 90);
    let mut document = triangle(&camera);
    document["meshes"]["one"] = json!({ "type": "box", "size": [1.0, 0.8, 1.2] });
    let plain = Picture::new(frame(&scene(&document), &output(Output::Normal)));
    assert!(covered(&plain) > 500);
    for signs in 1..8 {
        let sign = |bit: i32| if signs >> bit & 1 == 1 { -1 } else { 1 };
        document["instances"]["one"]["scale"] = json!([sign(0), sign(1), sign(2)]);
        let mirrored = Picture::new(frame(&scene(&document), &output(Output::Normal)));
        let wrong = plain.iter().filter(|&(x, y, pixel)| mirrored.at(x, y) != pixel).count();
        none_of(&format!("box with signs {signs:03b}"), "differing pixels", wrong, plain.pixels.len());
    }
}

#[test]
fn an_orthographic_camera_keeps_sizes_at_every_distance() {
    let camera = Camera::orthographic([0.0, 0.0, 10.0], [0.0, 0.0, 0.0], 4.0, 120, 96);
    let mut document = triangle(&camera);
    document["meshes"]["one"] = json!({ "type": "box", "size": [0.7, 0.9, 0.5] });
    let at = |x: f64, z: f64| json!({ "mesh": "one", "material": "white", "translation": [x, 0.1, z] });
    document["instances"] = json!({ "near": at(-1.1, 8.0), "far": at(1.0, -90.0) });
    let picture = Picture::of(&document);
    let half = DVec3::new(0.35, 0.45, 0.25);
    let box_at = |ray, x: f64, z: f64| {
        let centre = DVec3::new(x, 0.1, z);
        hit_box(ray, centre - half, centre + half).is_some()
    };
    let (mut wrong, mut checked) = (0, 0);
    for (x, y, pixel) in picture.iter() {
        let inside = camera.steady(x, y, 0.01, |ray| box_at(ray, -1.1, 8.0) || box_at(ray, 1.0, -90.0));
        if let Some(inside) = inside {
            checked += 1;
            wrong += usize::from(pixel != if inside { [255; 4] } else { [0, 0, 0, 255] });
        }
    }
    none_of("orthographic boxes", "wrong pixels", wrong, checked);
}
