//! The gallery: listed, shown, and made into scenes.

use crate::client::{Client, triangle};
use axum::body::Body;
use axum::http::Method;
use serde_json::{Value, json};
use std::collections::BTreeSet;

async fn list(client: &Client) -> Vec<Value> {
    client.get("/gallery").await.json().as_array().expect("a list").clone()
}

fn text<'a>(piece: &'a Value, member: &str) -> &'a str {
    piece[member].as_str().filter(|text| !text.is_empty()).expect(member)
}

/// A call with neither content type nor body.
async fn bare(client: &Client, method: Method, path: &str) -> crate::client::Reply {
    client.call(method, path, "", &[], Body::empty()).await
}

#[tokio::test]
async fn the_list_names_every_document_in_the_folder() {
    let client = Client::new();
    let pieces = list(&client).await;
    let listed: BTreeSet<String> = pieces.iter().map(|piece| text(piece, "name").to_owned()).collect();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/gallery");
    let paths = std::fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path());
    let documents = paths.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    let stems = documents.map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned());
    assert_eq!(listed, stems.collect());
}

#[tokio::test]
async fn every_piece_has_a_small_picture() {
    let client = Client::new();
    for piece in list(&client).await {
        let path = text(&piece, "picture");
        let picture = client.get(path).await;
        assert_eq!((picture.status.as_u16(), picture.header("content-type")), (200, "image/jpeg"), "{path}");
        assert!(picture.body.len() <= 60 << 10, "{path}: {} bytes", picture.body.len());
        let image = image::load_from_memory(&picture.body).expect("a JPEG");
        assert_eq!((image.width(), image.height()), (480, 360), "{path}");
        let again = client.get_with(path, &[("if-none-match", picture.header("etag"))]).await;
        assert_eq!((again.status.as_u16(), again.body.len()), (304, 0), "{path}");
    }
    client.get("/gallery/none/picture").await.problem(404);
}

#[tokio::test]
async fn every_piece_becomes_a_scene_by_its_name() {
    let client = Client::new();
    for piece in list(&client).await {
        let name = text(&piece, "name");
        let reply = bare(&client, Method::POST, &format!("/scenes?from={name}")).await;
        assert_eq!(reply.status, 201, "{name}: {}", String::from_utf8_lossy(&reply.body));
        let summary = reply.json();
        assert_eq!(summary["name"], piece["title"], "{name}");
        assert_eq!(summary["warnings"], json!([]), "{name}");
        assert_eq!(client.get(reply.header("location")).await.json()["name"], piece["title"]);
    }
}

#[tokio::test]
async fn a_piece_can_be_put_under_a_name_and_drawn_once() {
    let client = Client::new();
    let put = bare(&client, Method::PUT, "/scenes/birds?from=triangles").await;
    assert_eq!((put.status.as_u16(), put.header("location")), (201, "/scenes/birds"));
    let drawn = bare(&client, Method::POST, "/render.png?from=triangles&width=40&height=30").await;
    assert_eq!(drawn.png_size(), (40, 30));
    assert_eq!(drawn.body, client.get("/scenes/birds/frame.png?width=40&height=30").await.body);
}

#[tokio::test]
async fn an_unknown_piece_is_refused_with_the_nearest_and_all() {
    let problem = bare(&Client::new(), Method::POST, "/scenes?from=trinagles").await.problem(422);
    assert_eq!(problem["errors"][0]["parameter"], "from");
    let detail = problem["errors"][0]["detail"].as_str().expect("a detail");
    assert!(detail.contains("did you mean \"triangles\"?") && detail.contains("figure"), "{detail}");
}

#[tokio::test]
async fn a_piece_goes_with_neither_a_body_nor_options_of_models() {
    let client = Client::new();
    let problem = client.json(Method::POST, "/scenes?from=figure", &triangle()).await.problem(422);
    assert_eq!(problem["errors"][0]["parameter"], "from");
    let problem = bare(&client, Method::POST, "/scenes?from=figure&up=z&floor=false").await.problem(422);
    let parameters: Vec<_> =
        problem["errors"].as_array().expect("faults").iter().map(|f| &f["parameter"]).collect();
    assert_eq!(parameters, ["up", "floor"]);
    assert_eq!(client.get("/scenes").await.json(), json!([]));
}
