//! A picture to a budget: `preset`, `max_ms`, `max_error`.

use crate::client::{Client, PATIENCE, Reply};
use axum::body::Body;
use axum::http::{Method, Response};
use serde_json::{Value, json};

/// A textured floor with a ball and the shadow of a sun.
fn ball() -> Value {
    json!({
        "camera": { "position": [2, 1.5, 3], "target": [0, 0.3, 0] },
        "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "shadow": { "filter": "pcf" } } },
        "textures": { "tiles": { "checker": {} } },
        "materials": { "floor": { "diffuse_map": "tiles" } },
        "meshes": { "floor": { "type": "plane", "size": [6, 6] }, "ball": { "type": "sphere" } },
        "instances": { "floor": { "mesh": "floor", "material": "floor" }, "ball": { "mesh": "ball", "translation": [0, 0.5, 0] } },
        "render": { "width": 64, "height": 48 },
    })
}

async fn client() -> Client {
    let client = Client::new();
    client.json(Method::PUT, "/scenes/b", &ball()).await;
    client
}

/// The members of `Render-Settings`.
fn settings(reply: &Reply) -> Vec<(String, String)> {
    let members = reply.header("render-settings").split(", ");
    members
        .map(|member| member.split_once('=').expect("a member"))
        .filter(|member| *member != ("budget", "missed"))
        .map(|(k, v)| (k.into(), v.into()))
        .collect()
}

fn setting(reply: &Reply, name: &str) -> String {
    let found = settings(reply).into_iter().find(|(known, _)| known == name);
    found.unwrap_or_else(|| panic!("no {name}: {:?}", settings(reply))).1
}

fn number(reply: &Reply, name: &str) -> f64 {
    setting(reply, name).parse().expect("a number")
}

#[tokio::test]
async fn a_budget_is_settled_into_an_explicit_query_with_the_same_bytes() {
    let client = client().await;
    for budget in
        ["preset=draft", "preset=normal", "preset=high", "preset=reference", "max_ms=5", "max_error=0.02"]
    {
        let reply = client.get(&format!("/scenes/b/frame.png?{budget}&orbit=10,20&background=ff8800")).await;
        assert_eq!(reply.png_size(), (64, 48), "{budget}");
        let location = reply.header("content-location");
        assert!(
            location.starts_with("/scenes/b/frame.png?orbit=10%2C20&background=ff8800&samples="),
            "{location}"
        );
        let explicit = client.get(location).await;
        assert_eq!(
            (&explicit.body, explicit.header("etag")),
            (&reply.body, reply.header("etag")),
            "{budget}"
        );
        assert!(explicit.headers.get("render-settings").is_none());
        assert_eq!(setting(&reply, "source"), "model");
        assert!(number(&reply, "error") > 0.0 && number(&reply, "ms") > 0.0);
        let again = client.get_with(location, &[("if-none-match", reply.header("etag"))]).await;
        assert_eq!(again.status, 304);
    }
}

#[tokio::test]
async fn what_a_body_has_a_part_in_has_no_place_of_its_own() {
    let client = client().await;
    let head = client.call(Method::HEAD, "/scenes/b/frame.png?preset=draft", "", &[], "").await;
    assert!(head.header("content-location").starts_with("/scenes/b/frame.png?samples="));
    for (path, body) in [
        ("/scenes/b/frame.png?preset=draft", json!({ "render": { "shading": "unlit" } })),
        ("/scenes/b/frame.zip?preset=draft", json!({})),
        ("/render.png?preset=draft", ball()),
    ] {
        let reply = client.json(Method::POST, path, &body).await;
        assert_eq!((reply.status.as_u16(), setting(&reply, "samples")), (200, "1".to_owned()), "{path}");
        assert!(reply.headers.get("content-location").is_none(), "{path}: {:?}", reply.headers);
    }
}

#[tokio::test]
async fn presets_go_from_little_work_to_much() {
    let client = client().await;
    let mut last: Option<Reply> = None;
    for preset in ["draft", "normal", "high", "reference"] {
        let reply = client.get(&format!("/scenes/b/frame.png?preset={preset}")).await;
        if let Some(last) = &last {
            assert!(number(&reply, "error") < number(last, "error"), "{preset}");
            assert!(number(&reply, "ms") > number(last, "ms"), "{preset}");
            assert!(number(&reply, "samples") >= number(last, "samples"), "{preset}");
        }
        last = Some(reply);
    }
    let normal = client.get("/scenes/b/frame.png?preset=normal").await;
    assert_eq!(normal.body, client.get("/scenes/b/frame.png").await.body, "what a scene gets by default");
}

#[tokio::test]
async fn more_time_buys_less_error_and_more_error_less_time() {
    let client = client().await;
    let of = async |query: &str| client.get(&format!("/scenes/b/frame.png?{query}")).await;
    let (hasty, patient) = (of("max_ms=0.001").await, of("max_ms=100000").await);
    assert!(number(&hasty, "error") > number(&patient, "error"));
    assert!(number(&hasty, "ms") < number(&patient, "ms"));
    let (rough, exact) = (of("max_error=0.5").await, of("max_error=0.000001").await);
    assert_eq!(settings(&rough), settings(&hasty), "the fastest there is");
    assert_eq!(settings(&exact), settings(&patient), "the best there is");
    assert!(
        hasty.header("render-settings").ends_with("budget=missed"),
        "{}",
        hasty.header("render-settings")
    );
    let between = of("max_error=0.02").await;
    assert!(
        between.header("render-settings").ends_with("source=model"),
        "{}",
        between.header("render-settings")
    );
    assert!(number(&between, "error") <= 0.02, "{:?}", settings(&between));
}

#[tokio::test]
async fn what_the_query_sets_itself_stays() {
    let client = client().await;
    let reply = client.get("/scenes/b/frame.png?preset=draft&samples=8&pcf_taps=5").await;
    assert_eq!((setting(&reply, "samples"), setting(&reply, "pcf_taps")), ("8".into(), "5".into()));
    assert_eq!(setting(&reply, "shadow_resolution"), "512");
}

#[tokio::test]
async fn a_scene_is_not_told_of_knobs_that_it_lacks() {
    let client = Client::new();
    client.put_triangle().await;
    let reply = client.get("/scenes/t/frame.png?preset=high").await;
    let names: Vec<String> = settings(&reply).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["samples", "render_scale", "error", "ms", "source"]);
}

#[tokio::test]
async fn a_plan_shows_what_a_budget_buys() {
    let client = client().await;
    let plan = client.get("/scenes/b/plan?preset=draft").await.json();
    assert_eq!(plan["settings"]["samples"], 1);
    assert_eq!(plan["settings"]["drawn"], json!([32, 24]));
    assert_eq!(plan["lights"][0]["shadow"]["resolution"], 512);
}

#[tokio::test]
async fn a_budget_that_makes_no_sense_is_refused() {
    let client = client().await;
    for (query, parameter) in [
        ("preset=best", "preset"),
        ("max_ms=0", "max_ms"),
        ("max_error=-1", "max_error"),
        ("preset=high&max_ms=3", "max_ms"),
    ] {
        let problem = client.get(&format!("/scenes/b/frame.png?{query}")).await.problem(422);
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{problem}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_report_decides_for_pictures_like_its_own() {
    let client = client().await;
    let stream = "/scenes/b/stream.mjpg?preset=draft&shading=unlit";
    let watched = client.open(stream, &[]).await;
    let said = |response: &Response<Body>| {
        response.headers()["render-settings"].to_str().expect("text").rsplit('=').next().map(str::to_owned)
    };
    assert_eq!(said(&watched).as_deref(), Some("model"));

    let query = "budget_s=10&width=48&knobs=samples&shading=unlit&orbit=10,20";
    assert_eq!(client.get(&format!("/scenes/b/report.json?{query}")).await.status, 200);
    for (query, source) in [
        ("shading=unlit&orbit=10,20", "measured"),
        // The same seen from elsewhere, in another size, at another time.
        ("shading=unlit", "measured"),
        ("shading=unlit&orbit=40,10&width=32&t=3", "measured"),
        // Others.
        ("orbit=10,20", "model"),
        ("shading=lambert", "model"),
        ("shading=unlit&background=ff8800", "model"),
        ("shading=unlit&elide=none", "model"),
    ] {
        let reply = client.get(&format!("/scenes/b/frame.png?max_error=0.003&{query}")).await;
        assert_eq!(setting(&reply, "source"), source, "{query}");
    }

    // Who watched before watches the same as who comes now, by what is measured.
    let measured = async {
        while said(&client.open(stream, &[]).await).as_deref() != Some("measured") {
            tokio::time::sleep(std::time::Duration::from_millis(20)).await;
        }
    };
    tokio::time::timeout(PATIENCE, measured).await.expect("the stream is settled anew");
    let _joined = client.open(stream, &[]).await;
    assert_eq!(client.app.streams.count(), 1);
    drop(watched);
}

#[tokio::test]
async fn data_takes_no_settings() {
    let client = client().await;
    for output in ["depth", "normal", "instance", "shadow_map"] {
        let plain = client.get(&format!("/scenes/b/frame.png?output={output}")).await;
        let reply = client.get(&format!("/scenes/b/frame.png?output={output}&preset=draft")).await;
        assert!(
            !reply.headers.contains_key("render-settings"),
            "{output}: {}",
            reply.header("render-settings")
        );
        assert!(reply.body == plain.body, "{output}");
    }
}
