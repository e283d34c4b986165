//! `/scenes/{id}/plan` and `/scenes/{id}/instances`.

use crate::client::Client;
use axum::body::Body;
use axum::http::Method;
use serde_json::{Value, json};

/// A box and a floor in view under a sun and a lamp, with something of every kind that is left out.
fn studio() -> Value {
    let plain = |translation: [f64; 3]| json!({ "mesh": "box", "translation": translation });
    json!({
        "camera": { "position": [100, 3, 8], "target": [100, 0.5, 0], "fov_y_deg": 40, "far": 30 },
        "lights": {
            "lamp": { "type": "point", "position": [103, 2, 1], "shadow": { "filter": "pcss", "resolution": 64 } },
            "off": { "type": "point", "position": [100, 3, 0], "enabled": false },
            "out": { "type": "point", "position": [100, 3, 0], "intensity": 0 },
            "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "shadow": { "filter": "pcf", "resolution": 128 } },
        },
        "textures": { "tiles": { "checker": { "colors": ["#888", "#eee"], "cells": 8 }, "filter": "nearest" } },
        "materials": {
            "clear": { "opacity": 0 },
            "glass": { "opacity": 0.5, "shading": "unlit" },
            "tiled": { "diffuse_map": "tiles", "specular": [0.2, 0.2, 0.2] },
        },
        "meshes": { "box": { "type": "box" }, "floor": { "type": "plane", "size": [8, 8] },
                    "none": { "type": "triangles", "positions": [], "indices": [] } },
        "instances": {
            "a": plain([100.0, 0.5, 0.0]),
            "behind": plain([100.0, 0.5, 90.0]),
            "clear": { "mesh": "box", "material": "clear", "translation": [100, 0.5, 0] },
            "floor": { "mesh": "floor", "material": "tiled", "translation": [100, 0, 0] },
            "hidden": { "mesh": "box", "visible": false },
            "pane": { "mesh": "box", "material": "glass", "translation": [101, 0.5, 2], "casts_shadow": false },
        },
        "post": [
            { "type": "vignette" }, { "type": "tonemap" }, { "type": "blur", "radius": 0 },
            { "type": "fxaa" }, { "type": "grayscale", "amount": 0.5 },
        ],
        "render": { "width": 64, "height": 48, "samples": 4 },
    })
}

async fn planned(document: &Value, query: &str) -> (Client, Value) {
    let client = Client::new();
    let put = client.json(Method::PUT, "/scenes/t", document).await;
    assert_eq!(put.status, 201, "{}", String::from_utf8_lossy(&put.body));
    let reply = client.get(&format!("/scenes/t/plan{query}")).await;
    assert_eq!(reply.status, 200, "{}", String::from_utf8_lossy(&reply.body));
    let plan = reply.json();
    (client, plan)
}

/// Why `what` is left out.
#[track_caller]
fn reason<'a>(plan: &'a Value, what: &str) -> &'a str {
    let all = plan["left_out"].as_array().expect("a list");
    let found: Vec<&Value> = all.iter().filter(|left| left["what"] == what).collect();
    assert_eq!(found.len(), 1, "{what} in {all:#?}");
    found[0]["reason"].as_str().expect("a reason")
}

fn pass<'a>(plan: &'a Value, name: &str) -> &'a Value {
    let passes = plan["passes"].as_array().expect("a list");
    passes.iter().find(|pass| pass["name"] == name).expect("a pass of that name")
}

#[tokio::test]
async fn it_says_what_is_left_out_and_why() {
    let (_, plan) = planned(&studio(), "").await;
    for (what, why) in [
        ("instance \"hidden\"", "not visible"),
        ("instance \"behind\"", "outside of the view"),
        ("instance \"clear\"", "opacity"),
        ("light \"off\"", "switched off"),
        ("light \"out\"", "black"),
        ("post effect 2 (blur)", "radius"),
        ("instance \"pane\" in the shadow of light \"sun\"", "casts_shadow"),
        ("instance \"floor\" in the shadow of light \"sun\"", "behind it"),
        ("instance \"clear\" in the shadow of light \"lamp\"", "opacity"),
        ("shadow map px around light \"lamp\"", "casts a shadow on this side"),
    ] {
        assert!(reason(&plan, what).contains(why), "{what}: {}", reason(&plan, what));
    }
}

/// What the plan says that an elision saves.
fn saves<'a>(plan: &'a Value, name: &str) -> Option<&'a str> {
    let elisions = plan["elisions"].as_array().expect("a list");
    elisions.iter().find(|elision| elision["name"] == name)?["saves"].as_str()
}

#[tokio::test]
async fn it_says_what_is_saved() {
    let (client, plan) = planned(&studio(), "").await;
    for (name, what) in [
        ("dark_lights", "one term of the sum of light"),
        ("cube_sides", "64² texels of depth"),
        ("outside_instances", "12 triangles"),
        ("absent_maps", "a fragment in 3 of 3 draws"),
        ("black_specular", "for each of 2 lights on each fragment of 1 of 3 draws"),
        ("decided_taps", "18 + 36 and 16 taps"),
        ("covered_sky", "64 × 48 pixels"),
        ("uniform_pixels", "a mean of 4 samples"),
        ("neutral_effects", "a pass over 64 × 48 pixels"),
        ("pointwise_passes", "a pass for each of 3 steps"),
    ] {
        let told = saves(&plan, name).unwrap_or_default();
        assert!(told.contains(what), "{name}: {told}");
    }
    assert_eq!((saves(&plan, "unseen_shadows"), saves(&plan, "constant_maps")), (None, None));
    let left_out = plan["left_out"].as_array().expect("a list");
    let behind = left_out.iter().find(|left| left["what"] == "instance \"behind\"").expect("an entry");
    assert_eq!(behind["elision"], "outside_instances");
    assert!(behind["saves"].as_str().is_some_and(|saves| saves.contains("12 triangles")), "{behind}");
    let hidden = left_out.iter().find(|left| left["what"] == "instance \"hidden\"").expect("an entry");
    assert_eq!((&hidden["elision"], &hidden["saves"]), (&Value::Null, &Value::Null));

    let general = client.get("/scenes/t/plan?elide=none").await.json();
    assert_eq!(general["elisions"], json!([]));
    let kept = general["left_out"].as_array().expect("a list");
    assert!(kept.iter().all(|left| left["elision"].is_null()), "{kept:#?}");
    let lights: Vec<&Value> =
        general["lights"].as_array().expect("a list").iter().map(|light| &light["name"]).collect();
    assert_eq!(lights, ["lamp", "off", "out", "sun"]);
}

#[tokio::test]
async fn what_is_left_out_changes_no_byte_and_no_tag() {
    let (client, _) = planned(&studio(), "").await;
    let elided = client.get("/scenes/t/frame.png").await;
    for elide in ["none", "all", "clipping,decided_taps"] {
        let frame = client.get(&format!("/scenes/t/frame.png?elide={elide}")).await;
        assert!(frame.body == elided.body, "{elide}");
        assert_eq!(frame.header("etag"), elided.header("etag"), "{elide}");
    }
}

#[tokio::test]
async fn it_says_what_is_drawn_and_how() {
    let (_, plan) = planned(&studio(), "").await;
    let draws = plan["draws"].as_array().expect("a list");
    let names: Vec<&Value> = draws.iter().map(|draw| &draw["instance"]).collect();
    assert_eq!(names, ["a", "floor", "pane"]);
    let [a, floor, pane] = [&draws[0], &draws[1], &draws[2]];
    assert_eq!((&a["mesh"], &a["material"], &a["triangles"]), (&json!("box"), &Value::Null, &json!(12)));
    assert_eq!(floor["material"], "tiled");
    assert_eq!(floor["variant"], json!(["blinn_phong", "diffuse map (nearest)", "specular", "shadows"]));
    assert_eq!(pane["variant"], json!(["unlit", "alpha"]));
    assert_eq!((&a["transparent"], &pane["transparent"]), (&json!(false), &json!(true)));
    assert_eq!(
        plan["post"],
        json!([
            { "effects": ["vignette", "tonemap"], "kind": "pointwise" },
            { "effects": ["fxaa"], "kind": "neighbourhood" },
            { "effects": ["grayscale"], "kind": "pointwise" },
        ])
    );
    assert!(plan["bytes"].as_u64().expect("bytes") > 64 * 48 * 4);
}

#[tokio::test]
async fn it_says_which_lights_shine_and_how_their_shadows_are_drawn() {
    let (_, plan) = planned(&studio(), "").await;
    let [lamp, sun] = [&plan["lights"][0], &plan["lights"][1]];
    assert_eq!((&lamp["name"], &lamp["type"]), (&json!("lamp"), &json!("point")));
    assert_eq!(lamp["shadow"]["filter"], "pcss");
    assert_eq!((&sun["name"], &sun["type"]), (&json!("sun"), &json!("directional")));
    let (a_and_behind, maps) = (2, 1);
    assert_eq!(
        sun["shadow"],
        json!({ "filter": "pcf", "resolution": 128, "maps": maps, "casters": a_and_behind })
    );
    assert_eq!(plan["lights"].as_array().map(Vec::len), Some(2));
    let maps = 1 + lamp["shadow"]["maps"].as_u64().expect("a number");
    let expected = format!("Shadows of 2 lights: 2 instances drawn into {maps} maps of depth.");
    assert_eq!(pass(&plan, "shadow")["reason"], expected);
}

#[tokio::test]
async fn its_camera_is_the_documents_or_the_one_that_was_framed() {
    let (client, plan) = planned(&studio(), "").await;
    assert_eq!(
        plan["camera"],
        json!({ "position": [100.0, 3.0, 8.0], "target": [100.0, 0.5, 0.0], "up": [0.0, 1.0, 0.0],
                "fov_y_deg": 40.0, "near": 0.1, "far": 30.0 })
    );
    let parallel = client.get("/scenes/t/plan?ortho=3").await.json();
    assert_eq!(parallel["camera"]["orthographic"], json!({ "height": 3.0 }));
    assert!(parallel["camera"].get("fov_y_deg").is_none());

    let framed = json!({ "camera": null });
    client.json(Method::PATCH, "/scenes/t", &framed).await;
    let plan = client.get("/scenes/t/plan").await.json();
    let camera = &plan["camera"];
    assert!(camera["far"].is_null());
    let before = client.get("/scenes/t/frame.png").await;
    let as_document = json!({ "camera": { "position": camera["position"], "target": camera["target"],
        "up": camera["up"], "fov_y_deg": camera["fov_y_deg"], "near": camera["near"] } });
    client.json(Method::PATCH, "/scenes/t", &as_document).await;
    assert!(before.body == client.get("/scenes/t/frame.png").await.body);
}

#[tokio::test]
async fn the_settings_are_those_of_the_frame() {
    let (client, plan) = planned(&studio(), "?samples=8&t=1.5&shading=lambert&width=80").await;
    assert_eq!(
        plan["settings"],
        json!({ "width": 80, "height": 48, "samples": 8, "t": 1.5, "output": "color", "shading": "lambert" })
    );
    let data = client.get("/scenes/t/plan?output=depth&samples=8&shading=lambert").await.json();
    assert_eq!((&data["settings"]["samples"], &data["settings"]["shading"]), (&json!(1), &Value::Null));
    for what in ["samples", "background", "light \"sun\"", "post effect 0 (vignette)"] {
        assert!(!reason(&data, what).is_empty());
    }
}

/// What the plan says of a pass is what the frame's own stopwatch says.
#[tokio::test]
async fn the_passes_that_run_are_those_that_take_time() {
    let mut pointwise = studio();
    pointwise["post"] = json!([{ "type": "vignette" }]);
    let mut empty = studio();
    empty["instances"] = json!({});
    let mut bare = studio();
    bare["lights"] = json!({});
    bare["post"] = json!([]);
    for document in [studio(), pointwise, empty, bare] {
        let (client, _) = planned(&document, "").await;
        let scene_and_stages = ["color", "depth", "normal", "albedo", "instance", "wireframe"]
            .into_iter()
            .chain(["ids", "shadow_map", "tiles", "shaded"]);
        for output in scene_and_stages {
            let plan = client.get(&format!("/scenes/t/plan?output={output}")).await.json();
            let passes = plan["passes"].as_array().expect("a list");
            let frame = client.get(&format!("/scenes/t/frame.png?output={output}")).await;
            let timed: Vec<&str> = frame
                .header("server-timing")
                .split(", ")
                .map(|entry| entry.split(';').next().expect("a name"))
                .filter(|name| !["queue", "plan", "total"].contains(name))
                .collect();
            let run = passes.iter().filter(|pass| pass["runs"] == true);
            let run: Vec<&str> = run.map(|pass| pass["name"].as_str().expect("a name")).collect();
            assert_eq!(run, timed, "{output}");
            assert!(passes.iter().all(|pass| pass["reason"].as_str().is_some_and(|why| why.ends_with('.'))));
        }
    }
}

#[tokio::test]
async fn a_shadow_that_cannot_be_seen_says_what_is_missing() {
    let with = |part: &str, value: Value| {
        let mut document = studio();
        *document.pointer_mut(part).expect("a part") = value;
        document
    };
    let alone = json!({ "floor": { "mesh": "floor", "translation": [100, 0, 0] } });
    let refuses = json!({ "a": { "mesh": "box", "translation": [100, 0.5, 0], "receives_shadow": false } });
    for (document, why) in [
        (with("/instances", alone), "nothing throws a shadow"),
        (with("/instances", refuses), "takes shadows"),
        (with("/render", json!({ "width": 64, "height": 48, "shadows": false })), "render.shadows is off"),
    ] {
        let (_, plan) = planned(&document, "").await;
        assert!(reason(&plan, "shadow of light \"sun\"").contains(why), "{why}");
        let shadow = pass(&plan, "shadow");
        assert_eq!(shadow["runs"], false);
        assert!(shadow["reason"].as_str().is_some_and(|reason| reason.contains(why)), "{shadow}");
    }
    let (_, plan) = planned(&studio(), "?shading=unlit").await;
    assert!(reason(&plan, "light \"lamp\"").contains("lit"));
}

#[tokio::test]
async fn what_it_does_not_know_is_named() {
    let (client, _) = planned(&studio(), "").await;
    for route in ["plan", "instances"] {
        let problem = client.get(&format!("/scenes/t/{route}?tt=1")).await.problem(422);
        assert_eq!(problem["errors"][0]["parameter"], "tt");
        client.get(&format!("/scenes/nothing/{route}")).await.problem(404);
        let head = client.call(Method::HEAD, &format!("/scenes/t/{route}"), "", &[], Body::empty()).await;
        assert_eq!((head.status.as_u16(), head.body.len()), (200, 0));
        assert_eq!(head.header("content-type"), "application/json");
    }
    client.get("/scenes/t/plan?width=100000").await.problem(413);
    client.get("/scenes/t/plan?background=nowhere").await.problem(422);
    client.get("/scenes/t/instances?t=soon").await.problem(422);
}

#[tokio::test]
async fn instances_are_listed_where_they_are() {
    let mut document = studio();
    document["instances"]["a"]["spin"] = json!({ "axis": [0, 1, 0], "deg_per_s": 90 });
    document["instances"]["a"]["scale"] = json!([2, 1, 1]);
    document["instances"]["empty"] = json!({ "mesh": "none" });
    let (client, _) = planned(&document, "").await;
    let all = client.get("/scenes/t/instances").await.json();
    let names: Vec<&Value> = all.as_array().expect("a list").iter().map(|one| &one["name"]).collect();
    assert_eq!(names, ["a", "behind", "clear", "empty", "floor", "hidden", "pane"]);
    let half = json!({ "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5] });
    assert_eq!(
        all[0],
        json!({ "name": "a", "id": 1, "mesh": "box", "visible": true, "triangles": 12,
                "bounds": { "min": [99.0, 0.0, -0.5], "max": [101.0, 1.0, 0.5] }, "mesh_bounds": half })
    );
    assert_eq!((&all[3]["bounds"], &all[3]["mesh_bounds"]), (&Value::Null, &Value::Null));
    assert_eq!((&all[5]["visible"], &all[5]["id"]), (&json!(false), &json!(6)));
    let turned = client.get("/scenes/t/instances?t=1").await.json();
    assert_eq!(turned[0]["bounds"], json!({ "min": [99.5, 0.0, -1.0], "max": [100.5, 1.0, 1.0] }));
}
