//! Every status of the error table, each as a whole problem.

use crate::client::{Client, Counts, endless, settings, until};
use axum::body::Body;
use axum::http::Method;
use futures_util::stream;
use rasterd::settings::Settings;
use serde_json::json;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

#[tokio::test]
async fn status_400_for_what_is_not_json() {
    let client = Client::new();
    let post = |body: &'static str| client.call(Method::POST, "/scenes", "application/json", &[], body);
    let problem = post("{\n \"name\": }").await.problem(400);
    assert!(
        problem["detail"].as_str().is_some_and(|detail| detail.contains("line 2 column 10")),
        "{problem}"
    );
    for body in ["", "{\"camera\": {\"near\": 1e999}}", "{} {}", "{\"a\": NaN}"] {
        post(body).await.problem(400);
    }
    client.call(Method::POST, "/scenes", "", &[], "").await.problem(400);
}

#[tokio::test]
async fn status_400_for_a_broken_form() {
    let client = Client::new();
    let form = "multipart/form-data; boundary=x";
    for (content_type, body) in [
        ("multipart/form-data", "--x--\r\n"),
        (form, "--x\r\nContent-Disposition: form-data; name=\"scene\"\r\n\r\n{"),
        (form, "--x--\r\n"),
        (form, "--x\r\nContent-Disposition: form-data; name=\"a\"\r\n\r\nb\r\n--x--\r\n"),
        (form, "--x\r\nContent-Disposition: form-data; name=\"a\"; filename=\"\"\r\n\r\nb\r\n--x--\r\n"),
    ] {
        client.call(Method::POST, "/scenes", content_type, &[], body).await.problem(400);
    }
}

#[tokio::test]
async fn status_400_for_a_model_that_cannot_be_read() {
    let problem = Client::new()
        .call(Method::POST, "/scenes", "model/obj", &[], "v 0 0 0\nf 1 2 3\n")
        .await
        .problem(400);
    assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains("line 2")), "{problem}");
}

#[tokio::test]
async fn status_404_for_what_is_not_there() {
    let client = Client::new();
    for path in
        ["/none", "/scenes/none", "/scenes/none/frame.png", "/scenes/none/files", "/scenes/none/pick?x=0&y=0"]
    {
        client.get(path).await.problem(404);
    }
    client.json(Method::PATCH, "/scenes/none", &json!({})).await.problem(404);
    client.call(Method::DELETE, "/scenes/none", "", &[], Body::empty()).await.problem(404);
    client.call(Method::PUT, "/scenes/none/files/a", "", &[], "a").await.problem(404);
}

#[tokio::test]
async fn status_405_names_what_is_allowed() {
    let client = Client::new();
    let reply = client.call(Method::DELETE, "/scenes", "", &[], Body::empty()).await;
    reply.problem(405);
    assert!(reply.header("allow").contains("POST"));
}

#[tokio::test]
async fn status_408_for_a_body_that_does_not_come() {
    let client = Client::with(Settings { body_seconds: Duration::from_millis(30), ..settings() });
    for content_type in ["application/json", "multipart/form-data; boundary=x"] {
        let body = Body::from_stream(stream::pending::<Result<bytes::Bytes, Infallible>>());
        client.call(Method::POST, "/scenes", content_type, &[], body).await.problem(408);
    }
}

#[tokio::test]
async fn status_413_names_limit_value_and_setting() {
    let client = Client::with(Settings { max_body_bytes: 64, ..settings() });
    let large = json!({ "name": "x".repeat(100) }).to_string();
    let length = large.len().to_string();
    let announced = [("content-length", length.as_str())];
    let problem = client
        .call(Method::POST, "/scenes", "application/json", &announced, large.clone())
        .await
        .problem(413);
    for part in ["64", length.as_str(), "RASTERD_MAX_BODY_BYTES"] {
        assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains(part)), "{part}: {problem}");
    }
    let chunks = || Body::from_stream(stream::iter([Ok::<_, Infallible>(bytes::Bytes::from(large.clone()))]));
    client.call(Method::POST, "/scenes", "application/json", &[], chunks()).await.problem(413);
    let form = "multipart/form-data; boundary=x";
    let parts = format!("--x\r\nContent-Disposition: form-data; name=\"scene\"\r\n\r\n{large}\r\n--x--\r\n");
    client.call(Method::POST, "/scenes", form, &[], parts).await.problem(413);
}

#[tokio::test]
async fn status_413_for_a_picture_beyond_the_limit() {
    let client = Client::new();
    client.put_triangle().await;
    client.get("/scenes/t/frame.png?width=100000&height=4").await.problem(413);
    client.get("/scenes/t/frame.png?width=99999999999999&height=4").await.problem(413);
}

#[tokio::test]
async fn status_415_for_a_body_of_another_type() {
    let client = Client::new();
    client.put_triangle().await;
    client.call(Method::POST, "/scenes", "image/png", &[], "x").await.problem(415);
    client.call(Method::PATCH, "/scenes/t", "text/plain", &[], "{}").await.problem(415);
    client.call(Method::PATCH, "/scenes/t", "", &[], "{}").await.problem(415);
}

#[tokio::test]
async fn status_415_for_a_body_that_is_compressed() {
    let client = Client::new();
    client.put_triangle().await;
    for (method, path, content_type) in [
        (Method::POST, "/scenes", "application/json"),
        (Method::POST, "/scenes", "multipart/form-data; boundary=x"),
        (Method::PATCH, "/scenes/t", "application/json"),
        (Method::PUT, "/scenes/t/files/a", ""),
        (Method::POST, "/render.png", "model/obj"),
    ] {
        let packed = [("content-encoding", "identity, GZIP")];
        let problem = client.call(method, path, content_type, &packed, "{}").await.problem(415);
        assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains("GZIP")), "{problem}");
    }
    let plain = [("content-encoding", "identity")];
    assert_eq!(client.call(Method::PATCH, "/scenes/t", "application/json", &plain, "{}").await.status, 200);
}

#[tokio::test]
async fn status_422_lists_all_faults_of_a_document() {
    let document = json!({ "cam": {}, "lamps": {} });
    let problem = Client::new().json(Method::POST, "/scenes", &document).await.problem(422);
    let pointers: Vec<&str> =
        problem["errors"].as_array().expect("errors").iter().filter_map(|e| e["pointer"].as_str()).collect();
    assert_eq!(pointers, ["/cam", "/lamps"]);
}

#[tokio::test]
async fn status_422_lists_all_faults_of_a_query() {
    let client = Client::new();
    client.put_triangle().await;
    let problem = client
        .get("/scenes/t/frame.png?width=0&height=0&samples=3&fov=180&widht=3&t=1&t=2")
        .await
        .problem(422);
    let mut named: Vec<&str> = problem["errors"]
        .as_array()
        .expect("errors")
        .iter()
        .filter_map(|e| e["parameter"].as_str())
        .collect();
    named.sort_unstable();
    assert_eq!(named, ["fov", "height", "samples", "t", "widht", "width"]);
    client.get("/scenes/t/frame.png?background=nowhere").await.problem(422);
    let problem = client.get("/scenes/t/frame.png?elide=shadow").await.problem(422);
    assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains("decided_taps")), "{problem}");
}

#[tokio::test]
async fn status_422_for_an_unknown_parameter_of_any_call() {
    let client = Client::new();
    client.put_triangle().await;
    for path in [
        "/scenes",
        "/scenes/t",
        "/scenes/t/files",
        "/scenes/t/frame.png",
        "/scenes/t/pick",
        "/healthz",
        "/readyz",
        "/version",
        "/openapi.json",
    ] {
        client.get(&format!("{path}?colour=red")).await.problem(422);
    }
    let problem =
        client.call(Method::POST, "/scenes?flor=true", "application/json", &[], "{}").await.problem(422);
    assert!(
        problem["errors"][0]["detail"].as_str().is_some_and(|detail| detail.contains("\"floor\"")),
        "{problem}"
    );
}

#[tokio::test]
async fn status_431_for_a_head_that_is_too_large() {
    let long = "x".repeat(40 << 10);
    Client::new().get_with("/scenes", &[("x-padding", &long)]).await.problem(431);
    Client::new().get(&format!("/scenes?a={long}")).await.problem(431);
}

#[tokio::test]
async fn status_500_for_a_panic_and_the_server_goes_on() {
    let client = Client::drawing_with(settings(), Box::new(|_, _| panic!("a test's panic")));
    client.put_triangle().await;
    for _ in 0..3 {
        let problem = client.get("/scenes/t/frame.png").await.problem(500);
        assert!(!problem.to_string().contains("a test's panic"));
    }
    assert_eq!(client.get("/healthz").await.status, 200);
}

#[tokio::test]
async fn status_503_for_a_full_queue_while_health_answers() {
    let counts = Arc::new(Counts::default());
    let narrow = Settings { renders: NonZeroUsize::MIN, queue: 0, ..settings() };
    let client = Client::drawing_with(narrow, endless(&counts));
    client.put_triangle().await;
    let busy = tokio::spawn({
        let client = client.clone();
        async move { client.get("/scenes/t/frame.png").await }
    });
    until(|| counts.begun.load(Ordering::SeqCst) == 1).await;
    let reply = client.get("/scenes/t/frame.png").await;
    reply.problem(503);
    reply.header("retry-after");
    assert_eq!(client.get("/healthz").await.status, 200);
    busy.abort();
    until(|| counts.cancelled.load(Ordering::SeqCst) == 1).await;
}

#[tokio::test]
async fn status_503_when_the_server_goes_down() {
    let client = Client::new();
    client.put_triangle().await;
    client.app.close();
    let reply = client.get("/scenes/t/frame.png").await;
    reply.problem(503);
    reply.header("retry-after");
}

#[tokio::test]
async fn status_504_for_a_frame_beyond_its_deadline() {
    let counts = Arc::new(Counts::default());
    let client = Client::drawing_with(
        Settings { frame_seconds: Duration::from_millis(30), ..settings() },
        endless(&counts),
    );
    client.put_triangle().await;
    client.get("/scenes/t/frame.png").await.problem(504);
    until(|| counts.cancelled.load(Ordering::SeqCst) == 1).await;
}

#[tokio::test]
async fn status_507_when_the_memory_for_scenes_is_full() {
    let client = Client::with(Settings { max_total_bytes: 1 << 16, ..settings() });
    client.put_triangle().await;
    let problem = client.call(Method::PUT, "/scenes/t/files/a", "", &[], vec![0; 1 << 17]).await.problem(507);
    assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains("RASTERD_MAX_TOTAL_BYTES")));
    assert_eq!(client.get("/scenes/t/files").await.json(), json!([]));
}
