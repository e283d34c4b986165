//! Backgrounds.

use crate::closed_form::{Camera, codes_apart, decode};
use crate::draw::{Picture, frame, scene};
use crate::measure::at_most;
use glam::DVec3;
use rasterd::plan::{FrameRequest, request::BackgroundRequest};
use serde_json::{Value, json};

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
        at_most(&format!("gradient, {name}"), "largest difference in codes", worst.fold(0.0, f64::max), 1.0);
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
