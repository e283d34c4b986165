//! `/scenes/{id}/turntable.gif` and `.png`.

use crate::client::{Client, Counts, endless, settings, until};
use axum::http::Method;
use image::AnimationDecoder;
use image::codecs::{gif::GifDecoder, png::PngDecoder};
use serde_json::json;
use std::io::Cursor;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// A service with a coloured corner of boxes, different from every side.
async fn corner() -> Client {
    let client = Client::new();
    let document = json!({
        "camera": { "position": [3, 2, 4] },
        "environment": { "background": { "type": "color", "color": "#204060" } },
        "materials": {
            "red": { "diffuse": "#f00", "shading": "unlit" },
            "green": { "diffuse": "#0f0", "shading": "unlit" },
        },
        "meshes": { "box": { "type": "box" } },
        "instances": {
            "a": { "mesh": "box", "material": "red", "translation": [1, 0, 0] },
            "b": { "mesh": "box", "material": "green", "translation": [0, 0.5, 0.5] },
        },
        "render": { "width": 48, "height": 36, "samples": 1 },
    });
    client.json(Method::PUT, "/scenes/t", &document).await;
    client
}

/// The pictures as a player shows them, with their times.
fn shown(frames: image::Frames) -> Vec<(image::RgbaImage, Duration)> {
    let frames = frames.collect_frames().expect("whole frames").into_iter();
    frames.map(|frame| (frame.buffer().clone(), frame.delay().into())).collect()
}

fn gif(bytes: &[u8]) -> Vec<(image::RgbaImage, Duration)> {
    shown(GifDecoder::new(Cursor::new(bytes)).expect("a GIF").into_frames())
}

fn apng(bytes: &[u8]) -> Vec<(image::RgbaImage, Duration)> {
    let decoder = PngDecoder::new(Cursor::new(bytes)).expect("a PNG");
    shown(decoder.apng().expect("an animation").into_frames())
}

async fn png(client: &Client, query: &str) -> image::RgbaImage {
    let reply = client.get(&format!("/scenes/t/frame.png?{query}")).await;
    image::load_from_memory(&reply.body).expect("a picture").into_rgba8()
}

#[tokio::test]
async fn its_frames_are_those_of_the_orbit_query() {
    let client = corner().await;
    let turn = client.get("/scenes/t/turntable.png?frames=5&orbit=30,20").await;
    assert_eq!(turn.header("content-type"), "image/png");
    let frames = apng(&turn.body);
    assert_eq!(frames.len(), 5);
    for (yaw, (picture, delay)) in [30, 102, 174, 246, 318].into_iter().zip(&frames) {
        assert!(*picture == png(&client, &format!("orbit={yaw},20")).await, "yaw {yaw}");
        assert_eq!(*delay, Duration::from_millis(500));
    }
}

#[tokio::test]
async fn without_an_orbit_the_scenes_own_camera_turns() {
    let client = corner().await;
    let frames = apng(&client.get("/scenes/t/turntable.png?frames=4").await.body);
    // (3, 2, 4) by quarter turns to the right of the target.
    for (eye, (picture, _)) in ["3,2,4", "4,2,-3", "-3,2,-4", "-4,2,3"].into_iter().zip(&frames) {
        assert!(*picture == png(&client, &format!("eye={eye}")).await, "from {eye}");
    }
    assert!(frames[0].0 == png(&client, "").await);
}

#[tokio::test]
async fn a_gif_of_few_colours_has_the_pixels_of_the_frames() {
    let client = corner().await;
    let reply = client.get("/scenes/t/turntable.gif").await;
    assert_eq!(reply.header("content-type"), "image/gif");
    let frames = gif(&reply.body);
    assert_eq!(frames.len(), 36);
    let exact = apng(&client.get("/scenes/t/turntable.png").await.body);
    for ((gif, delay), (apng, _)) in frames.iter().zip(&exact) {
        assert!(gif == apng);
        assert_eq!(*delay, Duration::from_millis(70));
    }
}

#[tokio::test]
async fn the_bytes_depend_on_nothing_but_the_request() {
    let (one, other) = (corner().await, corner().await);
    for path in ["turntable.gif?frames=6&shading=normal&samples=4", "turntable.png?frames=3"] {
        let path = format!("/scenes/t/{path}");
        let (a, b) = (one.get(&path).await, other.get(&path).await);
        assert!(a.body == b.body && a.header("etag") == b.header("etag"), "{path}");
    }
    let tag = |path: &'static str| {
        let one = &one;
        async move { one.get(path).await.header("etag").to_owned() }
    };
    let tags = [
        tag("/scenes/t/turntable.gif?frames=1").await,
        tag("/scenes/t/turntable.gif?frames=2").await,
        tag("/scenes/t/turntable.png?frames=1").await,
        tag("/scenes/t/frame.png").await,
    ];
    assert!((1..tags.len()).all(|i| !tags[..i].contains(&tags[i])), "{tags:?}");
}

#[tokio::test]
async fn depth_turns_where_all_sides_share_a_range() {
    let client = corner().await;
    let problem = client.get("/scenes/t/turntable.png?output=depth&frames=3").await.problem(422);
    assert_eq!(problem["errors"][0]["parameter"], "far", "{problem}");
    let reply = client.get("/scenes/t/turntable.png?output=depth&frames=3&far=10").await;
    assert_eq!(reply.header("render-depth-range"), "0.1, 10");
}

#[tokio::test]
async fn the_number_of_frames_is_bounded_and_so_is_their_memory() {
    let client = corner().await;
    for frames in ["0", "361", "many"] {
        let problem = client.get(&format!("/scenes/t/turntable.gif?frames={frames}")).await.problem(422);
        assert_eq!(problem["errors"][0]["parameter"], "frames");
    }
    let problem = client.get("/scenes/t/turntable.gif?width=8192&height=8192").await.problem(413);
    assert!(
        problem["detail"].as_str().is_some_and(|detail| detail.contains("RASTERD_MAX_FRAME_BYTES")),
        "{problem}"
    );
}

#[tokio::test]
async fn a_frame_that_is_late_ends_them_all() {
    let counts = Arc::new(Counts::default());
    let settings = rasterd::settings::Settings { frame_seconds: Duration::from_millis(20), ..settings() };
    let client = Client::drawing_with(settings, endless(&counts));
    client.put_triangle().await;
    let problem = client.get("/scenes/t/turntable.gif?frames=3").await.problem(504);
    assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains("0.02 s")), "{problem}");
    until(|| counts.cancelled.load(Ordering::SeqCst) == 1).await;
}
