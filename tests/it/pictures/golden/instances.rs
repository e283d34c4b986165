//! Golden pictures of what an instance, the camera and `render` say: faces, colours of vertices, shadows
//! that are not thrown or not received, and what moves.

use super::{assert_golden, check, draw, shadow_study, still_life};
use rasterd::plan::FrameRequest;
use rasterd::plan::request::Orbit;
use rasterd::scene::Files;
use serde_json::{Value, json};

/// Four walls without lid and bottom, each of its own colour outside and inside, seen from above the
/// corner between the red wall and the green one.
fn walls() -> Value {
    let (mut positions, mut colors) = (Vec::new(), Vec::new());
    let corners = [[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]];
    for (wall, color) in
        [[0.9, 0.15, 0.1], [0.1, 0.7, 0.2], [0.15, 0.25, 0.9], [0.9, 0.8, 0.1]].into_iter().enumerate()
    {
        let (a, b) = (corners[wall], corners[(wall + 1) % 4]);
        let at = |c: [f64; 2], y: f64| [c[0], y, c[1]];
        positions.extend([at(a, -0.4), at(b, -0.4), at(b, 0.4), at(a, 0.4)]);
        colors.extend([color; 4]);
    }
    let indices: Vec<_> =
        (0..4).flat_map(|wall| [0, 1, 2, 0, 2, 3].map(|corner| 4 * wall + corner)).collect();
    json!({
        "camera": { "position": [1.1, 1.5, 1.7], "target": [0, -0.05, 0], "fov_y_deg": 36 },
        "environment": { "background": { "type": "color", "color": "#222" } },
        "lights": {},
        "materials": { "m": { "shading": "vertex_color" } },
        "meshes": { "walls": { "type": "triangles", "positions": positions, "colors": colors, "indices": indices } },
        "instances": { "walls": { "mesh": "walls", "material": "m" } },
        "render": { "width": 80, "height": 64, "samples": 4 },
    })
}

#[test]
fn golden_faces() {
    for cull in ["back", "front", "none"] {
        let mut document = walls();
        document["render"]["cull"] = json!(cull);
        check(&format!("cover/walls_without_a_lid_cull_{cull}"), &document);
    }
    let mut document = walls();
    document["materials"]["m"]["double_sided"] = json!(true);
    check("cover/double_sided_walls_are_never_culled", &document);
}

#[test]
fn golden_vertex_colours() {
    let mut fan = walls();
    fan["camera"] = json!({ "position": [0, 0, 5], "target": [0, 0, 0], "orthographic": { "height": 2.2 } });
    let rim = [[1.0, 0.0], [0.5, 0.87], [-0.5, 0.87], [-1.0, 0.0], [-0.5, -0.87], [0.5, -0.87]];
    let mut positions = vec![[0.0; 3]];
    positions.extend(rim.map(|[x, y]| [x, y, 0.0]));
    fan["meshes"]["walls"] = json!({ "type": "triangles", "positions": positions,
        "colors": [[1, 1, 1], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1], [1, 0, 1]],
        "indices": (1..=6).flat_map(|i| [0, i, i % 6 + 1]).collect::<Vec<_>>() });
    check("shade/vertex_colours_mix_in_linear_light", &fan);
}

#[test]
fn golden_shadows_of_instances() {
    let mut document =
        shadow_study(json!({ "type": "directional", "direction": [0.9, -1, 0.35], "intensity": 0.9,
        "shadow": { "filter": "hard", "resolution": 512 } }));
    document["instances"]["pole"]["casts_shadow"] = json!(false);
    document["materials"]["pale"] = json!({ "diffuse": "#e8d8a0" });
    document["meshes"]["tile"] = json!({ "type": "plane", "size": [0.7, 0.9] });
    // Half of the ball's shadow would fall on it.
    document["instances"]["tile"] = json!({ "mesh": "tile", "material": "pale", "translation": [1.25, 0.01, -0.4],
        "receives_shadow": false });
    check("shadow/a_pole_that_casts_none_and_a_tile_that_receives_none", &document);
}

#[test]
fn golden_motion() {
    let at = |document: &Value, request: &FrameRequest| draw(document, &Files::default(), request);
    let mut document = still_life();
    document["instances"]["crate"]["rotation_deg"] = json!([0, 0, 0]);
    document["instances"]["crate"]["spin"] = json!({ "axis": [0, 1, 0], "deg_per_s": 90 });
    let later = FrameRequest { t: 0.5, ..FrameRequest::default() };
    assert_golden("motion/a_crate_before_it_spins", &at(&document, &FrameRequest::default()));
    assert_golden("motion/a_crate_has_spun_by_45_degrees", &at(&document, &later));

    let mut document = still_life();
    document["camera"]["orbit_deg_per_s"] = json!(120);
    assert_golden("motion/a_camera_has_gone_round_by_60_degrees", &at(&document, &later));
    let orbit = Some(Orbit { yaw_deg: -60.0, pitch_deg: 55.0, distance: None });
    let above = FrameRequest { orbit, ..FrameRequest::default() };
    assert_golden("motion/a_camera_put_above_by_query", &at(&still_life(), &above));
}

#[test]
fn golden_model_scale() {
    let mut document = still_life();
    document["render"]["model_scale"] = json!(0.5);
    check("cover/model_scale_halves_all_about_the_origin", &document);
}

#[test]
fn golden_lights() {
    let mut document = shadow_study(json!({ "type": "directional", "direction": [0.9, -1, 0.35],
        "color": [1, 0.25, 0.15], "intensity": 0.6, "shadow": { "filter": "hard", "resolution": 512 } }));
    document["lights"]["second"] = json!({ "type": "directional", "direction": [-0.7, -1, 0.5],
        "color": [0.2, 1, 0.3], "intensity": 0.5, "shadow": { "filter": "pcf", "resolution": 256 } });
    document["lights"]["third"] = json!({ "type": "point", "position": [0, 2, -1.6], "color": [0.25, 0.3, 1],
        "intensity": 2.5, "shadow": { "filter": "hard", "resolution": 256 } });
    document["environment"]["ambient"] = json!([0.03, 0.03, 0.03]);
    check("shade/three_lights_add_up_and_each_has_its_shadow", &document);
}
