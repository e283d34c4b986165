//! `/scenes/{id}/frame.png`.

use crate::client::{Client, Counts, endless, settings, triangle};
use axum::http::Method;
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::Ordering;

#[tokio::test]
async fn a_frame_has_the_documents_size_and_all_its_headers() {
    let client = Client::new();
    client.put_triangle().await;
    let reply = client.get("/scenes/t/frame.png").await;
    assert_eq!(reply.png_size(), (32, 24));
    assert_eq!(reply.header("cache-control"), "no-cache");
    assert!(reply.header("etag").starts_with('"'));
    for pass in ["queue;dur=", "plan;dur=", "encode;dur=", "total;dur="] {
        assert!(reply.header("server-timing").contains(pass), "{pass}");
    }
    assert!(reply.header("render-stats").contains("triangles="));
    assert!(reply.headers.get("render-depth-range").is_none());
}

#[tokio::test]
async fn the_query_overrides_the_document() {
    let client = Client::new();
    client.put_triangle().await;
    let reply =
        client.get("/scenes/t/frame.png?width=8&height=6&samples=4&orbit=30,20&background=ff8800").await;
    assert_eq!(reply.png_size(), (8, 6));
}

#[tokio::test]
async fn a_depth_picture_names_its_range() {
    let client = Client::new();
    client.put_triangle().await;
    let reply = client.get("/scenes/t/frame.png?output=depth").await;
    reply.png_size();
    let range = reply.header("render-depth-range");
    let (near, far) = range.split_once(", ").expect("two numbers");
    assert!(near.parse::<f64>().expect("near") < far.parse::<f64>().expect("far"));
}

#[tokio::test]
async fn a_patch_for_one_frame_is_not_kept() {
    let client = Client::new();
    client.put_triangle().await;
    let before = client.get("/scenes/t").await.body;
    let patch = json!({ "render": { "width": 10, "height": 5, "samples": 1 } });
    let reply = client.json(Method::POST, "/scenes/t/frame.png", &patch).await;
    assert_eq!(reply.png_size(), (10, 5));
    assert_eq!(client.get("/scenes/t").await.body, before);
    client.json(Method::POST, "/scenes/t/frame.png", &json!({ "lamps": {} })).await.problem(422);
}

#[tokio::test]
async fn a_known_picture_is_answered_without_drawing() {
    let client = Client::new();
    client.put_triangle().await;
    let etag = client.get("/scenes/t/frame.png").await.header("etag").to_owned();

    let counts = Arc::new(Counts::default());
    let idle = Client::drawing_with(settings(), endless(&counts));
    idle.put_triangle().await;
    for known in [etag.clone(), format!("W/{etag}"), format!("\"x\", {etag}"), "*".to_owned()] {
        let reply = idle.get_with("/scenes/t/frame.png", &[("if-none-match", &known)]).await;
        assert_eq!((reply.status.as_u16(), reply.body.len()), (304, 0), "{known}");
        assert_eq!(reply.header("etag"), etag);
        let headers = [("if-none-match", known.as_str())];
        let posted = idle.call(Method::POST, "/scenes/t/frame.png", "application/json", &headers, "{}").await;
        assert_eq!((posted.status.as_u16(), posted.header("etag")), (304, etag.as_str()), "{known}");
        let once = idle
            .call(Method::POST, "/render.png", "application/json", &headers, triangle().to_string())
            .await;
        assert_eq!((once.status.as_u16(), once.body.len()), (304, 0), "{known}");
    }
    assert_eq!(counts.begun.load(Ordering::SeqCst), 0);
}

#[tokio::test]
async fn the_same_inputs_give_the_same_etag_and_bytes() {
    let (one, other) = (Client::new(), Client::new());
    one.put_triangle().await;
    other.put_triangle().await;
    other.put_triangle().await; // another revision of the same document
    let path = "/scenes/t/frame.png?width=16&height=16";
    let (a, b) = (one.get(path).await, other.get(path).await);
    assert_eq!(a.header("etag"), b.header("etag"));
    assert_eq!(a.body, b.body);
    assert_ne!(a.header("etag"), one.get("/scenes/t/frame.png?width=17&height=16").await.header("etag"));
}

#[tokio::test]
async fn accept_decides_whether_a_picture_is_wanted() {
    let client = Client::new();
    client.put_triangle().await;
    for accept in ["*/*", "image/*", "text/html, image/png;q=0.5"] {
        client.get_with("/scenes/t/frame.png", &[("accept", accept)]).await.png_size();
    }
    client.get_with("/scenes/t/frame.png", &[("accept", "application/json")]).await.problem(406);
}
