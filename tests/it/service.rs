//! Health, version, the page, the description.

use crate::client::Client;
use serde_json::Value;

#[tokio::test]
async fn a_closing_server_lives_but_is_not_ready() {
    let client = Client::new();
    assert_eq!(client.get("/readyz").await.status, 200);
    client.app.close();
    let reply = client.get("/readyz").await;
    reply.problem(503);
    reply.header("retry-after");
    assert_eq!(client.get("/healthz").await.status, 200);
}

#[tokio::test]
async fn the_version_is_the_crates() {
    let version = Client::new().get("/version").await.json();
    assert_eq!(version["version"], env!("CARGO_PKG_VERSION"));
    assert!(version["simd"].is_string() && version["threads"] == 2);
}

#[tokio::test]
async fn the_page_and_its_parts_are_sent_once() {
    let client = Client::new();
    for (path, content_type) in
        [("/", "text/html"), ("/page.css", "text/css"), ("/js/main.js", "text/javascript")]
    {
        let part = client.get(path).await;
        assert_eq!(part.status, 200, "{path}");
        assert!(part.header("content-type").starts_with(content_type), "{path}");
        let again = client.get_with(path, &[("if-none-match", part.header("etag"))]).await;
        assert_eq!((again.status.as_u16(), again.body.len()), (304, 0), "{path}");
    }
}

#[tokio::test]
async fn all_that_the_page_refers_to_is_there() {
    let client = Client::new();
    let page = String::from_utf8(client.get("/").await.body.to_vec()).expect("text");
    let attributes = page.split(['"', '\'']).filter(|value| value.starts_with('/'));
    for path in attributes.filter(|path| !path.starts_with("/scenes/")) {
        assert_eq!(client.get(path).await.status, 200, "{path}");
    }
    assert!(!page.contains("://"), "the page loads from another host");
}

#[tokio::test]
async fn a_sane_request_id_is_kept_and_another_replaced() {
    let client = Client::new();
    let kept = client.get_with("/healthz", &[("x-request-id", "abc-123")]).await;
    assert_eq!(kept.header("x-request-id"), "abc-123");
    let replaced = client.get_with("/none", &[("x-request-id", "<script>")]).await;
    assert_ne!(replaced.header("x-request-id"), "<script>");
    replaced.problem(404);
}

#[tokio::test]
async fn the_description_has_every_route_with_its_statuses() {
    let api = Client::new().get("/openapi.json").await.json();
    assert_eq!(api["openapi"], "3.1.0");
    for (path, methods) in [
        ("/", "get"),
        ("/gallery", "get"),
        ("/gallery/{name}/picture", "get"),
        ("/healthz", "get"),
        ("/metrics", "get"),
        ("/openapi.json", "get"),
        ("/readyz", "get"),
        ("/render.jpg", "post"),
        ("/render.png", "post"),
        ("/render.webp", "post"),
        ("/scenes", "get post"),
        ("/scenes/{id}", "get put patch delete"),
        ("/scenes/{id}/events", "get"),
        ("/scenes/{id}/files", "get"),
        ("/scenes/{id}/files/{name}", "get put delete"),
        ("/scenes/{id}/frame.exr", "get post"),
        ("/scenes/{id}/frame.hdr", "get post"),
        ("/scenes/{id}/frame.jpg", "get post"),
        ("/scenes/{id}/frame.png", "get post"),
        ("/scenes/{id}/frame.webp", "get post"),
        ("/scenes/{id}/frame.zip", "get post"),
        ("/scenes/{id}/pick", "get"),
        ("/scenes/{id}/report.html", "get"),
        ("/scenes/{id}/report.json", "get"),
        ("/scenes/{id}/report.svg", "get"),
        ("/scenes/{id}/stream.mjpg", "get"),
        ("/scenes/{id}/turntable.gif", "get"),
        ("/scenes/{id}/turntable.png", "get"),
        ("/version", "get"),
    ] {
        for method in methods.split(' ') {
            let operation = &api["paths"][path][method];
            assert!(operation["summary"].is_string(), "{method} {path}");
            let parameters = operation.get("parameters");
            assert!(parameters.is_none_or(Value::is_array), "{method} {path}");
            assert!(operation["responses"]["500"].is_object(), "{method} {path}");
        }
    }
    for picture in ["frame.png", "frame.exr", "frame.zip", "turntable.gif"] {
        let responses = &api["paths"][format!("/scenes/{{id}}/{picture}")]["get"]["responses"];
        for status in ["200", "304", "403", "404", "406", "413", "422", "500", "503", "504"] {
            assert!(responses[status].is_object(), "{picture}: {status}");
        }
    }
    for report in ["report.json", "report.svg", "report.html"] {
        let responses = &api["paths"][format!("/scenes/{{id}}/{report}")]["get"]["responses"];
        for status in ["200", "404", "406", "413", "422", "503", "504"] {
            assert!(responses[status].is_object(), "{report}: {status}");
        }
    }
    for stream in ["stream.mjpg", "events"] {
        let operation = &api["paths"][format!("/scenes/{{id}}/{stream}")]["get"];
        for status in ["200", "404", "406", "413", "422", "503", "504"] {
            assert!(operation["responses"][status].is_object(), "{stream}: {status}");
        }
        let parameters = operation["parameters"].as_array().expect("a list");
        let output = parameters.iter().find(|parameter| parameter["name"] == "output").expect("output");
        assert!(output["schema"]["enum"].as_array().expect("words").contains(&"shaded".into()), "{stream}");
    }
    assert!(!api.to_string().contains("{format}"));
    assert!(api["paths"]["/scenes/{id}/report.png"].is_null(), "a report is no picture");
}

#[tokio::test]
async fn the_description_says_what_a_budget_adds_to_replies() {
    let api = Client::new().get("/openapi.json").await.json();
    let header = |method: &str, path: &str, name: &str| {
        api["paths"][path][method]["responses"]["200"]["headers"][name]["description"].is_string()
    };
    for picture in ["frame.png", "frame.exr", "frame.zip", "turntable.gif", "stream.mjpg"] {
        let path = format!("/scenes/{{id}}/{picture}");
        assert!(
            header("get", &path, "Render-Settings") && header("get", &path, "Content-Location"),
            "{path}"
        );
    }
    for path in ["/scenes/{id}/frame.png", "/scenes/{id}/frame.zip", "/render.png"] {
        assert!(
            header("post", path, "Render-Settings") && !header("post", path, "Content-Location"),
            "{path}"
        );
    }
}

#[tokio::test]
async fn operations_have_names_of_their_own() {
    let api = Client::new().get("/openapi.json").await.json();
    let operations = api["paths"]
        .as_object()
        .expect("paths")
        .values()
        .flat_map(|item| item.as_object().expect("an item").values());
    let mut names: Vec<&str> =
        operations.map(|operation| operation["operationId"].as_str().expect("a name")).collect();
    let all = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), all);
}
