//! Which sides of a lamp's cube are drawn.

use crate::closed_form::Camera;
use crate::draw::{frame, scene};
use rasterd::pipeline::Pixels;
use rasterd::plan::FrameRequest;
use serde_json::{Value, json};

/// A wall on the +x side of a lamp that ends before the border to the +y side, and a sheet wholly beyond
/// that border which receives no shadow itself. `others` are more instances of planes.
fn document(shadow: &Value, others: &Value) -> Value {
    let camera = Camera::orthographic([-10.0, 3.0, 0.0], [4.0, 3.0, 0.0], 1.2, 48, 48);
    let mut instances = json!({
        "wall": { "mesh": "square", "scale": [1.2, 1, 2], "rotation_deg": [0, 0, 90],
            "translation": [4, 3.1, 0], "casts_shadow": false, "material": "white" },
        "sheet": { "mesh": "square", "scale": [2, 1, 4], "rotation_deg": [0, 0, 90],
            "translation": [2, 3.06, 0], "receives_shadow": false, "material": "white" },
    });
    let (all, more) = (instances.as_object_mut().expect("an object"), others.as_object().expect("an object"));
    all.extend(more.clone());
    // Only the wall is looked at: from before it, past the sheet.
    let mut view = camera.document();
    view["near"] = json!(13.0);
    json!({
        "camera": view,
        "environment": { "ambient": [0, 0, 0] },
        "lights": { "lamp": { "type": "point", "position": [0, 0, 0], "color": [0.8, 0.8, 0.8], "shadow": shadow } },
        "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1], "double_sided": true } },
        "meshes": { "square": { "type": "plane", "size": [1, 1] } },
        "instances": instances,
        "render": camera.render(1),
    })
}

fn pixels(document: &Value) -> Vec<[u8; 4]> {
    let Pixels::Rgba8 { pixels, .. } = frame(&scene(document), &FrameRequest::default()).pixels else {
        panic!("asked for colours")
    };
    pixels
}

#[test]
fn a_side_that_kernels_alone_reach_is_drawn() {
    let witness = json!({ "witness": { "mesh": "square", "translation": [0, 40, 0], "casts_shadow": false,
        "material": "white" } });
    for shadow in [
        json!({ "filter": "pcf", "radius": 24, "resolution": 256 }),
        json!({ "filter": "pcss", "light_radius": 1.2, "resolution": 256 }),
        json!({ "filter": "pcss", "light_radius": 1.2, "search_radius": 30, "resolution": 256 }),
    ] {
        let alone = pixels(&document(&shadow, &json!({})));
        // A receiver on the sheet's own side, out of the picture, makes that side be drawn in any case.
        assert_eq!(alone, pixels(&document(&shadow, &witness)), "{shadow}");
        let lit = pixels(&document(&json!({ "filter": "none" }), &json!({})));
        let shaded = alone.iter().zip(&lit).filter(|(shaded, lit)| shaded[0] < lit[0]).count();
        assert!(shaded > 48, "{shadow}: {shaded} pixels in the shadow");
    }
}
