//! `/scenes` and `/scenes/{id}`.

use crate::client::{Client, TRIANGLE_OBJ, triangle};
use axum::body::Body;
use axum::http::Method;
use serde_json::json;

#[tokio::test]
async fn a_created_scene_has_a_place_and_a_summary() {
    let client = Client::new();
    let reply = client.json(Method::POST, "/scenes", &triangle()).await;
    assert_eq!(reply.status, 201);
    let summary = reply.json();
    let id = summary["id"].as_str().expect("an id");
    assert_eq!(reply.header("location"), format!("/scenes/{id}"));
    let read = client.get(reply.header("location")).await;
    assert_eq!(read.status, 200);
    assert_eq!(read.header("etag"), reply.header("etag"));
    assert_eq!(client.get("/scenes").await.json()[0]["id"], id);
}

#[tokio::test]
async fn a_model_without_a_document_becomes_a_scene() {
    let client = Client::new();
    for content_type in
        ["model/obj", "text/plain", "application/octet-stream", "application/x-www-form-urlencoded", ""]
    {
        let reply =
            client.call(Method::POST, "/scenes?floor=false&up=z", content_type, &[], TRIANGLE_OBJ).await;
        assert_eq!(reply.status, 201, "{content_type:?}: {:?}", reply.body);
    }
}

#[tokio::test]
async fn a_document_sent_by_curl_unasked_as_a_form_is_a_document() {
    let client = Client::new();
    let body = triangle().to_string();
    let reply = client.call(Method::PUT, "/scenes/t", "application/x-www-form-urlencoded", &[], body).await;
    assert_eq!(reply.status, 201);
    assert_eq!(client.get("/scenes/t").await.json()["render"]["width"], 32);
}

#[tokio::test]
async fn a_form_brings_document_and_files() {
    let client = Client::new();
    let document = json!({ "meshes": { "m": { "type": "obj", "file": "m.obj" } }, "instances": { "m": { "mesh": "m" } } });
    let body =
        form(&[("scene", None, &document.to_string()), ("file", Some("C:\\models\\m.obj"), TRIANGLE_OBJ)]);
    let reply = client.call(Method::PUT, "/scenes/t", FORM, &[], body).await;
    assert_eq!(reply.status, 201, "{:?}", reply.body);
    assert_eq!(
        client.get("/scenes/t/files").await.json(),
        json!([{ "name": "m.obj", "bytes": TRIANGLE_OBJ.len() }])
    );
}

#[tokio::test]
async fn a_form_without_a_document_is_its_models() {
    let client = Client::new();
    let body = form(&[("a", Some("m.obj"), TRIANGLE_OBJ)]);
    assert_eq!(client.call(Method::POST, "/scenes", FORM, &[], body).await.status, 201);
}

#[tokio::test]
async fn put_creates_and_replaces() {
    let client = Client::new();
    let created = client.put_triangle().await;
    assert_eq!((created.status.as_u16(), created.header("location")), (201, "/scenes/t"));
    let replaced = client.put_triangle().await;
    assert_eq!(replaced.status, 200);
    assert!(replaced.json()["revision"].as_u64() > created.json()["revision"].as_u64());
}

#[tokio::test]
async fn a_patch_changes_the_etag_and_a_failed_one_nothing() {
    let client = Client::new();
    let before = client.put_triangle().await;
    for content_type in ["application/json", "application/merge-patch+json; charset=utf-8"] {
        let patch = json!({ "name": content_type }).to_string();
        let reply = client.call(Method::PATCH, "/scenes/t", content_type, &[], patch).await;
        assert_eq!(reply.status, 200);
        assert_ne!(reply.header("etag"), before.header("etag"));
        assert_eq!(reply.json()["name"], content_type);
    }
    let settled = client.get("/scenes/t").await;
    client.json(Method::PATCH, "/scenes/t", &json!({ "lamps": {} })).await.problem(422);
    assert_eq!(client.get("/scenes/t").await.body, settled.body);
}

#[tokio::test]
async fn if_match_holds_for_put_patch_and_delete() {
    let client = Client::new();
    let etag = client.put_triangle().await.header("etag").to_owned();
    let body = triangle().to_string();
    let call = |method, tag: &str| {
        let (client, body, tag) = (client.clone(), body.clone(), tag.to_owned());
        async move {
            client.call(method, "/scenes/t", "application/json", &[("if-match", tag.as_str())], body).await
        }
    };
    for method in [Method::PUT, Method::PATCH, Method::DELETE] {
        call(method.clone(), "\"other\"").await.problem(412);
        call(method, &format!("W/{etag}")).await.problem(412);
    }
    let reply = call(Method::PATCH, &format!("\"other\", {etag}")).await;
    assert_eq!(reply.status, 200);
    assert_eq!(call(Method::PUT, "*").await.status, 200);
    let etag = client.get("/scenes/t").await.header("etag").to_owned();
    assert_eq!(call(Method::DELETE, &etag).await.status, 204);
    client.get("/scenes/t").await.problem(404);
    call(Method::PUT, "*").await.problem(412);
}

#[tokio::test]
async fn if_none_match_keeps_a_put_from_replacing() {
    let client = Client::new();
    let put = |tag: &str| {
        let (client, tag) = (client.clone(), tag.to_owned());
        async move {
            let headers = [("if-none-match", tag.as_str())];
            client.call(Method::PUT, "/scenes/t", "application/json", &headers, triangle().to_string()).await
        }
    };
    let created = put("*").await;
    assert_eq!(created.status, 201);
    put("*").await.problem(412);
    put(created.header("etag")).await.problem(412);
    assert_eq!(client.get("/scenes/t").await.header("etag"), created.header("etag"));
    assert_eq!(put("\"other\"").await.status, 200);
}

#[tokio::test]
async fn an_unchanged_document_is_not_sent_again() {
    let client = Client::new();
    let etag = client.put_triangle().await.header("etag").to_owned();
    let reply = client.get_with("/scenes/t", &[("if-none-match", &etag)]).await;
    assert_eq!((reply.status.as_u16(), reply.body.len()), (304, 0));
}

#[tokio::test]
async fn head_gives_the_length_without_the_body() {
    let client = Client::new();
    client.put_triangle().await;
    for path in [
        "/",
        "/healthz",
        "/version",
        "/openapi.json",
        "/scenes",
        "/scenes/t",
        "/scenes/t/files",
        "/scenes/t/frame.png",
        "/scenes/none",
        "/none",
    ] {
        let get = client.get(path).await;
        let head = client
            .call(Method::HEAD, path, "", &[("x-request-id", get.header("x-request-id"))], Body::empty())
            .await;
        assert_eq!(head.status, get.status, "{path}");
        assert_eq!(head.header("content-length"), get.body.len().to_string(), "{path}");
        assert!(head.body.is_empty(), "{path}");
    }
}

#[tokio::test]
async fn an_id_must_be_plain() {
    let client = Client::new();
    for id in ["a%20b", "a.b", "%C3%A4", &"x".repeat(65)] {
        client.json(Method::PUT, &format!("/scenes/{id}"), &json!({})).await.problem(422);
    }
    assert_eq!(
        client.json(Method::PUT, &format!("/scenes/{}", "x".repeat(64)), &json!({})).await.status,
        201
    );
}

const FORM: &str = "multipart/form-data; boundary=x";

/// Parts of name, file name and content.
fn form(parts: &[(&str, Option<&str>, &str)]) -> String {
    let part = |(name, file, content): &(&str, Option<&str>, &str)| {
        let file = file.map_or_else(String::new, |file| format!("; filename=\"{file}\""));
        format!("--x\r\nContent-Disposition: form-data; name=\"{name}\"{file}\r\n\r\n{content}\r\n")
    };
    parts.iter().map(part).chain(["--x--\r\n".to_owned()]).collect()
}
