//! `/render.png`.

use crate::client::{Client, TRIANGLE_OBJ, triangle};
use axum::http::Method;

#[tokio::test]
async fn a_model_gives_its_picture_and_is_not_kept() {
    let client = Client::new();
    let path = "/render.png?width=20&height=10&up=z&floor=false";
    let reply = client.call(Method::POST, path, "model/obj", &[], TRIANGLE_OBJ).await;
    assert_eq!(reply.png_size(), (20, 10));
    assert_eq!(client.get("/scenes").await.json(), serde_json::json!([]));
}

#[tokio::test]
async fn a_document_gives_the_bytes_of_its_scenes_frame() {
    let client = Client::new();
    client.put_triangle().await;
    let once = client.json(Method::POST, "/render.png", &triangle()).await;
    assert_eq!(once.body, client.get("/scenes/t/frame.png").await.body);
}
