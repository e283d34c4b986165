//! A change that is refused leaves the scene byte for byte as it was.

use crate::client::{Client, Reply, TRIANGLE_OBJ, settings, triangle};
use axum::body::Body;
use axum::http::Method;
use bytes::Bytes;
use futures_util::stream;
use rasterd::settings::Settings;
use serde_json::{Value, json};
use std::time::Duration;

/// All that a client can see of a scene.
#[derive(Debug, PartialEq)]
struct Seen {
    document: Bytes,
    etag: String,
    summary: Value,
    files: Vec<(String, Bytes)>,
    picture: Bytes,
}

impl Seen {
    async fn of(client: &Client, id: &str) -> Self {
        let path = format!("/scenes/{id}");
        let read = client.get(&path).await;
        assert_eq!(read.status, 200);
        let summaries = client.get("/scenes").await.json();
        let summary = summaries.as_array().expect("a list").iter().find(|summary| summary["id"] == id);
        let mut files = Vec::new();
        for entry in client.get(&format!("{path}/files")).await.json().as_array().expect("a list") {
            let name = entry["name"].as_str().expect("a name").to_owned();
            let bytes = client.get(&format!("{path}/files/{name}")).await.body;
            files.push((name, bytes));
        }
        Self {
            etag: read.header("etag").to_owned(),
            document: read.body,
            summary: summary.expect("the scene is listed").clone(),
            files,
            picture: client.get(&format!("{path}/frame.png?width=16&height=16")).await.body,
        }
    }
}

/// Makes `change` and checks that it is refused with `status` and has changed nothing of scene `t`.
async fn refused(client: &Client, status: u16, change: impl Future<Output = Reply>) {
    let before = Seen::of(client, "t").await;
    change.await.problem(status);
    assert_eq!(Seen::of(client, "t").await, before, "after a {status}");
}

/// A scene `t` with a model that it needs, and a file that it does not.
async fn client_with(settings: Settings) -> Client {
    let client = Client::with(settings);
    let mut document = triangle();
    document["meshes"]["model"] = json!({ "type": "obj", "file": "m.obj" });
    document["instances"]["model"] = json!({ "mesh": "model" });
    let part = |disposition: &str, content: &str| {
        format!("--x\r\nContent-Disposition: form-data; {disposition}\r\n\r\n{content}\r\n")
    };
    let form = [
        part("name=\"scene\"", &document.to_string()),
        part("name=\"a\"; filename=\"m.obj\"", TRIANGLE_OBJ),
        part("name=\"b\"; filename=\"notes.txt\"", "notes"),
        "--x--\r\n".to_owned(),
    ];
    let reply = client.call(Method::PUT, "/scenes/t", FORM, &[], form.concat()).await;
    assert_eq!(reply.status, 201, "{:?}", reply.body);
    client
}

const FORM: &str = "multipart/form-data; boundary=x";
const JSON: &str = "application/json";

#[tokio::test]
async fn after_a_patch_that_makes_no_sense() {
    let client = client_with(settings()).await;
    for patch in [
        json!({ "name": "new", "lamps": {} }),
        json!({ "camera": { "fov_y_deg": 200 } }),
        json!({ "instances": { "only": { "mesh": "gone" } } }),
        json!({ "meshes": { "triangle": null } }),
        json!({ "meshes": { "model": { "file": "gone.obj" } } }),
        json!([]),
    ] {
        refused(&client, 422, client.json(Method::PATCH, "/scenes/t", &patch)).await;
    }
    refused(&client, 400, client.call(Method::PATCH, "/scenes/t", JSON, &[], "{\"name\":")).await;
    refused(&client, 415, client.call(Method::PATCH, "/scenes/t", "text/plain", &[], "{}")).await;
}

#[tokio::test]
async fn after_a_put_that_makes_no_sense() {
    let client = client_with(settings()).await;
    let put = |content_type, body: &str| {
        let (client, body) = (client.clone(), body.to_owned());
        async move { client.call(Method::PUT, "/scenes/t", content_type, &[], body).await }
    };
    refused(&client, 422, put(JSON, "{\"lamps\":{}}")).await;
    refused(&client, 422, put(JSON, "{\"instances\":{\"a\":{\"mesh\":\"gone\"}}}")).await;
    refused(&client, 400, put(JSON, "{")).await;
    refused(&client, 400, put("model/obj", "v 0 0 0\nf 1 2 3\n")).await;
    let broken =
        "--x\r\nContent-Disposition: form-data; name=\"a\"; filename=\"new.txt\"\r\n\r\nb\r\n--x\r\nCont";
    refused(&client, 400, put(FORM, broken)).await;
    refused(&client, 415, put("image/png", "x")).await;
}

#[tokio::test]
async fn after_a_change_to_another_version() {
    let client = client_with(settings()).await;
    let stale = [("if-match", "\"stale\"")];
    for (method, path, body) in [
        (Method::PUT, "/scenes/t", "{}"),
        (Method::PATCH, "/scenes/t", "{\"name\":\"new\"}"),
        (Method::DELETE, "/scenes/t", ""),
        (Method::PUT, "/scenes/t/files/new.txt", "new"),
        (Method::DELETE, "/scenes/t/files/notes.txt", ""),
    ] {
        refused(&client, 412, client.call(method, path, JSON, &stale, body)).await;
    }
    let new = [("if-none-match", "*")];
    refused(&client, 412, client.call(Method::PUT, "/scenes/t", JSON, &new, "{}")).await;
    refused(&client, 412, client.call(Method::PUT, "/scenes/t/files/m.obj", "", &new, TRIANGLE_OBJ)).await;
}

#[tokio::test]
async fn after_a_change_beyond_the_limits() {
    let client = client_with(Settings { max_body_bytes: 2048, body_seconds: BODY_TIME, ..settings() }).await;
    let large = json!({ "name": "x".repeat(4096) }).to_string();
    let put = |path, body: Body| client.call(Method::PUT, path, JSON, &[], body);
    refused(&client, 413, put("/scenes/t", large.clone().into())).await;
    refused(&client, 413, put("/scenes/t/files/m.obj", large.clone().into())).await;
    refused(&client, 413, client.call(Method::PATCH, "/scenes/t", JSON, &[], large)).await;
    let breaks_off = stream::iter([Ok("{"), Err(std::io::Error::other("gone"))]);
    refused(&client, 400, put("/scenes/t", Body::from_stream(breaks_off))).await;
    let stalls = stream::pending::<Result<Bytes, std::io::Error>>();
    refused(&client, 408, put("/scenes/t/files/m.obj", Body::from_stream(stalls))).await;
}

const BODY_TIME: Duration = Duration::from_millis(200);

#[tokio::test]
async fn after_a_file_that_the_scene_cannot_do_with_or_without() {
    let client = client_with(settings()).await;
    let put = |body: &'static str| client.call(Method::PUT, "/scenes/t/files/m.obj", "", &[], body);
    refused(&client, 400, put("v 0 0 0\nf 1 2 3\n")).await;
    refused(&client, 400, put("\u{1}")).await;
    let remove = || client.call(Method::DELETE, "/scenes/t/files/m.obj", "", &[], Body::empty());
    refused(&client, 422, remove()).await;
}

#[tokio::test]
async fn after_a_change_that_does_not_fit_into_memory() {
    let client = client_with(Settings { max_total_bytes: 1 << 16, ..settings() }).await;
    let large = vec![0; 1 << 17];
    refused(&client, 507, client.call(Method::PUT, "/scenes/t/files/a", "", &[], large)).await;
    let fine = json!({ "meshes": { "fine": { "type": "sphere", "segments": 256, "rings": 128 } } });
    refused(&client, 507, client.json(Method::PATCH, "/scenes/t", &fine)).await;
}
