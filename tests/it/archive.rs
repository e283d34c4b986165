//! `/scenes/{id}/frame.zip`.

use crate::client::{Client, Reply};
use axum::http::Method;
use glam::{DMat4, DVec4};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};

/// A service with a box before a far plane, away from the origin.
async fn boxed() -> Client {
    let client = Client::new();
    let document = json!({
        "camera": { "position": [102, 3, 8], "target": [100, 0.5, 0], "fov_y_deg": 40, "far": 30 },
        "meshes": { "box": { "type": "box" }, "floor": { "type": "plane", "size": [8, 8] } },
        "instances": {
            "z floor": { "mesh": "floor", "translation": [100, 0, 0] },
            "a box": { "mesh": "box", "translation": [100, 0.5, 0] },
            "hidden": { "mesh": "box", "visible": false },
        },
        "render": { "width": 64, "height": 48, "samples": 4 },
    });
    client.json(Method::PUT, "/scenes/t", &document).await;
    client
}

/// The entries by name.
fn entries(reply: &Reply) -> BTreeMap<String, Vec<u8>> {
    assert_eq!(reply.status, 200, "{}", String::from_utf8_lossy(&reply.body));
    assert_eq!(reply.header("content-type"), "application/zip");
    let mut archive = zip::ZipArchive::new(Cursor::new(reply.body.as_ref())).expect("an archive");
    let mut entries = BTreeMap::new();
    for at in 0..archive.len() {
        let mut entry = archive.by_index(at).expect("an entry");
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("a matching checksum");
        entries.insert(entry.name().expect("UTF-8").into_owned(), bytes);
    }
    entries
}

fn frame_json(entries: &BTreeMap<String, Vec<u8>>) -> Value {
    serde_json::from_slice(&entries["frame.json"]).expect("JSON")
}

#[tokio::test]
async fn its_pictures_are_the_frames_of_their_outputs() {
    let client = boxed().await;
    let all = entries(&client.get("/scenes/t/frame.zip").await);
    for output in ["color", "depth", "normal", "albedo", "instance", "wireframe"] {
        let frame = client.get(&format!("/scenes/t/frame.png?output={output}")).await;
        assert!(all[&format!("{output}.png")] == frame.body, "{output}");
        assert_eq!(frame_json(&all)["files"][output], format!("{output}.png"));
    }
    assert_eq!(all.len(), 7, "stages are there on request alone: {:?}", all.keys());
    let stages = entries(&client.get("/scenes/t/frame.zip?outputs=ids,shadow_map,tiles,shaded,color").await);
    for output in ["ids", "shadow_map", "tiles", "shaded", "color"] {
        let frame = client.get(&format!("/scenes/t/frame.png?output={output}")).await;
        assert!(stages[&format!("{output}.png")] == frame.body, "{output}");
    }
    let two = client.get("/scenes/t/frame.zip?outputs=depth,normal&width=20&height=10").await;
    assert_eq!(two.header("render-depth-range"), "0.1, 30");
    let two = entries(&two);
    assert_eq!(two.keys().collect::<Vec<_>>(), ["depth.png", "frame.json", "normal.png"]);
    assert_eq!(frame_json(&two)["width"], 20);
}

#[tokio::test]
async fn its_matrices_lead_from_the_world_to_the_pixel_that_shows_it() {
    let client = boxed().await;
    for query in ["", "?ortho=6"] {
        let all = entries(&client.get(&format!("/scenes/t/frame.zip{query}")).await);
        let description = frame_json(&all);
        let rows: [[f64; 4]; 4] =
            serde_json::from_value(description["camera"]["clip_from_world"].clone()).expect("rows");
        let clip_from_world = DMat4::from_cols_array_2d(&rows).transpose();
        let size = if query.is_empty() { "?" } else { "?ortho=6&" };
        let pick = client.get(&format!("/scenes/t/pick{size}x=30&y=20")).await.json();
        let position: [f64; 3] = serde_json::from_value(pick["position"].clone()).expect("a point");
        let clip = clip_from_world * DVec4::new(position[0], position[1], position[2], 1.0);
        let pixel = [64.0 * (0.5 + clip.x / clip.w / 2.0), 48.0 * (0.5 - clip.y / clip.w / 2.0)];
        assert!((pixel[0] - 30.5).abs() < 1e-6 && (pixel[1] - 20.5).abs() < 1e-6, "{pixel:?}");
        assert!((0.0..=1.0).contains(&(clip.z / clip.w)));
    }
}

#[tokio::test]
async fn its_description_says_what_the_values_mean() {
    let client = boxed().await;
    let description = frame_json(&entries(&client.get("/scenes/t/frame.zip").await));
    assert_eq!(description["depth_range"], json!([0.1, 30.0]));
    // Hidden ones keep their places in the order of names.
    let instances = json!({
        "a box": { "id": 1, "mesh": "box", "visible": true },
        "hidden": { "id": 2, "mesh": "box", "visible": false },
        "z floor": { "id": 3, "mesh": "floor", "visible": true },
    });
    assert_eq!(description["instances"], instances);
    let camera = &description["camera"];
    assert_eq!(camera["position"], json!([102.0, 3.0, 8.0]));
    assert_eq!((&camera["near"], &camera["far"]), (&json!(0.1), &json!(30.0)));
    assert_eq!(camera["projection"]["fov_y_deg"], 40.0);
    let focal = camera["projection"]["focal_length_px"][1].as_f64().expect("a number");
    assert!((focal - 24.0 / 20f64.to_radians().tan()).abs() < 1e-9);
    let without = frame_json(&entries(&client.get("/scenes/t/frame.zip?outputs=color&ortho=3").await));
    assert_eq!(without["depth_range"], Value::Null);
    assert_eq!(without["camera"]["projection"], json!({ "type": "orthographic", "height": 3.0 }));
}

#[tokio::test]
async fn the_triangles_of_all_its_pictures_are_counted_once() {
    let client = boxed().await;
    let counts = |reply: &Reply| {
        let stats = reply.header("render-stats").to_owned();
        ["triangles=", "drawn="]
            .map(|name| stats.split(", ").find_map(|s| s.strip_prefix(name)).map(str::to_owned))
    };
    let one = counts(&client.get("/scenes/t/frame.png?output=depth").await);
    assert_eq!(one[0].as_deref(), Some("14"));
    assert_eq!(counts(&client.get("/scenes/t/frame.zip?outputs=depth,instance,wireframe").await), one);
}

#[tokio::test]
async fn a_patch_gives_the_archive_of_a_changed_scene() {
    let client = boxed().await;
    let patch = json!({ "render": { "width": 20, "height": 10 } });
    let reply = client.json(Method::POST, "/scenes/t/frame.zip?outputs=color", &patch).await;
    assert_eq!(frame_json(&entries(&reply))["width"], 20);
}

#[tokio::test]
async fn what_it_cannot_hold_is_refused_by_name() {
    let client = boxed().await;
    for (query, parameter, part) in [
        ("outputs=color,sound", "outputs", "must be one of color, depth"),
        ("outputs=depth,depth", "outputs", "names depth more than once"),
        ("outputs=", "outputs", "must be one of"),
        ("output=depth", "output", "takes outputs"),
    ] {
        let problem = client.get(&format!("/scenes/t/frame.zip?{query}")).await.problem(422);
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{problem}");
        assert!(
            problem["errors"][0]["detail"].as_str().is_some_and(|detail| detail.contains(part)),
            "{problem}"
        );
    }
    client.get_with("/scenes/t/frame.zip", &[("accept", "image/png")]).await.problem(406);
}

#[tokio::test]
async fn the_same_request_gives_the_same_bytes() {
    let (one, other) = (boxed().await, boxed().await);
    let path = "/scenes/t/frame.zip";
    let (a, b) = (one.get(path).await, other.get(path).await);
    assert!(a.body == b.body && a.header("etag") == b.header("etag"));
    let fewer = one.get("/scenes/t/frame.zip?outputs=color").await;
    assert_ne!(fewer.header("etag"), a.header("etag"));
    let known = [("if-none-match", a.header("etag"))];
    assert_eq!(other.get_with(path, &known).await.status, 304);
}
