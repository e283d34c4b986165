//! Which pixels a surface covers, and how much of each.

use crate::closed_form::{Camera, Ray, area_in_pixel, decode, hit_plane};
use crate::draw::{Picture, frame, samples, scene};
use crate::measure::{Worst, at_most, none_of};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// A white floor, unlit, on black.
fn floor(camera: &Camera, size: [f64; 2], samples: u32) -> Value {
    json!({
        "camera": camera.document(),
        "environment": { "background": { "type": "color", "color": "#000" } },
        "lights": {},
        "materials": { "white": { "shading": "unlit", "diffuse": [1, 1, 1], "double_sided": true } },
        "meshes": { "floor": { "type": "plane", "size": size } },
        "instances": { "floor": { "mesh": "floor", "material": "white" } },
        "render": camera.render(samples),
    })
}

/// The distance of the near plane where a document names none.
const NEAR: f64 = 0.1;

/// Whether a line of sight meets the floor beyond the near plane.
fn on_floor(ray: Ray, size: [f64; 2]) -> bool {
    hit_plane(ray, DVec3::ZERO, DVec3::Y).filter(|&s| s >= NEAR).is_some_and(|s| {
        let p = ray.at(s);
        p.x.abs() < size[0] / 2.0 && p.z.abs() < size[1] / 2.0
    })
}

/// Checks every pixel whose centre lies farther than 1.5 sub-pixels from the outline.
fn assert_outline(case: &str, camera: &Camera, size: [f64; 2]) {
    let picture = Picture::of(&floor(camera, size, 1));
    let mut wrong = 0;
    let mut checked = 0;
    for (x, y, pixel) in picture.iter() {
        if let Some(inside) = camera.steady(x, y, 1.5 / 256.0, |ray| on_floor(ray, size)) {
            checked += 1;
            wrong += usize::from(pixel != if inside { [255; 4] } else { [0, 0, 0, 255] });
        }
    }
    let total = (camera.width * camera.height) as usize;
    assert!(checked > total - total / 50, "{case}: only {checked} of {total} lie clear of the outline");
    none_of(case, "wrong pixels", wrong, checked);
}

#[test]
fn a_plane_has_the_outline_of_its_projection() {
    let above = Camera::perspective([1.3, 2.1, 3.4], [0.1, 0.0, 0.2], 41.0, 161, 97);
    assert_outline("plane from above", &above, [3.0, 2.0]);
    let below = Camera::perspective([-2.0, -1.1, 1.7], [0.1, 0.0, 0.2], 50.0, 130, 130);
    assert_outline("plane from below", &below, [3.0, 2.0]);
    let aslant = Camera::orthographic([3.0, 2.0, 1.0], [0.0, 0.0, 0.0], 2.6, 128, 96);
    assert_outline("plane, orthographic", &aslant, [2.0, 1.5]);
}

#[test]
fn a_floor_from_behind_the_camera_to_the_horizon_covers_all_below_the_horizon() {
    for (name, eye, target) in [
        ("level view", [0.0, 1.0, 0.0], [0.3, 1.0, -5.0]),
        ("cut by the near plane", [5.0, 0.02, 3.0], [0.0, 0.02, -40.0]),
        ("looking down past the near plane", [0.0, 0.15, 0.0], [1.0, -1.0, -1.0]),
    ] {
        let camera = Camera::perspective(eye, target, 60.0, 160, 120);
        assert_outline(name, &camera, [2e5, 2e5]);
    }
}

#[test]
fn a_diagonal_shared_by_two_triangles_shows_no_seam() {
    for samples in [1, 2, 4, 8, 16] {
        let mut seen = 0;
        let mut wrong = 0;
        for turn in [0.0f64, 17.0, 45.0, 60.3] {
            let (sin, cos) = turn.to_radians().sin_cos();
            let camera = Camera::perspective([2.0 * sin, 3.0, 2.0 * cos], [0.0, 0.0, 0.0], 40.0, 96, 96);
            let picture = Picture::of(&floor(&camera, [50.0, 50.0], samples));
            seen += picture.pixels.len();
            wrong += picture.pixels.iter().filter(|pixel| **pixel != [255; 4]).count();
        }
        none_of(&format!("shared diagonal, {samples} samples"), "pixels with background", wrong, seen);
    }
}

/// Corners of the floor on the screen.
fn outline(camera: &Camera, size: [f64; 2]) -> Vec<DVec2> {
    let corner = |[x, z]: [f64; 2]| camera.project(DVec3::new(x * size[0] / 2.0, 0.0, z * size[1] / 2.0));
    [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(corner).to_vec()
}

#[test]
fn edge_pixels_show_the_covered_share_of_their_area() {
    // The published patterns leave 0.246, 0.161, 0.092, 0.057 and 0.044 on edges of all directions.
    for (count, bound) in [(1, 0.27), (2, 0.18), (4, 0.105), (8, 0.068), (16, 0.06)] {
        let (mut sum, mut edges) = (0.0, 0.0);
        for turn in 0..12 {
            let (sin, cos) = f64::from(turn * 31 + 3).to_radians().sin_cos();
            let camera = Camera::perspective([3.0 * sin, 2.3, 3.0 * cos], [0.05, 0.0, 0.02], 40.0, 90, 70);
            let size = [2.1, 1.7];
            let polygon = outline(&camera, size);
            let picture = Picture::new(frame(&scene(&floor(&camera, size, count)), &samples(count)));
            for (x, y, pixel) in picture.iter() {
                let area = area_in_pixel(&polygon, x, y);
                if area > 1e-9 && area < 1.0 - 1e-9 {
                    edges += 1.0;
                    sum += (decode(pixel[0]) - area).powi(2);
                }
            }
        }
        let rmse: f64 = (sum / edges).sqrt();
        at_most(&format!("coverage, {count} samples, {edges} edge pixels"), "RMSE", rmse, bound);
    }
}

#[test]
fn alpha_is_the_covered_share_and_colour_is_straight() {
    let camera = Camera::perspective([1.1, 2.3, 2.7], [0.05, 0.0, 0.02], 40.0, 90, 70);
    let size = [2.1, 1.7];
    let polygon = outline(&camera, size);
    let mut document = floor(&camera, size, 16);
    document["environment"]["background"] = json!({ "type": "transparent" });
    document["materials"]["white"]["diffuse"] = json!("#c86432");
    let picture = Picture::of(&document);
    let (mut sum, mut edges, mut largest, mut tinted) = (0.0, 0.0, Worst::default(), 0);
    for (x, y, [r, g, b, a]) in picture.iter() {
        let (area, alpha) = (area_in_pixel(&polygon, x, y), f64::from(a) / 255.0);
        tinted += usize::from([r, g, b] != if a == 0 { [0; 3] } else { [0xc8, 0x64, 0x32] });
        largest.note((alpha - area).abs());
        if area > 1e-9 && area < 1.0 - 1e-9 {
            edges += 1.0;
            sum += (alpha - area).powi(2);
        }
    }
    none_of("transparent background", "pixels whose colour is not straight", tinted, picture.pixels.len());
    at_most("transparent background", "RMSE of alpha", f64::sqrt(sum / edges), 0.06);
    // The largest error of the pattern is 0.17; half a code more for rounding.
    at_most("transparent background", "largest error of alpha", largest.largest(), 0.17 + 0.5 / 255.0);
}
