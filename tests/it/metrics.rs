//! `/metrics`: what the server counts and times.

use crate::client::{Client, Counts, endless, settings, until};
use rasterd::settings::Settings;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// The value of one line.
async fn metric(client: &Client, line: &str) -> f64 {
    let text = String::from_utf8(client.get("/metrics").await.body.to_vec()).expect("text");
    let value = text.lines().find_map(|other| other.strip_prefix(line)?.strip_prefix(' '));
    value.unwrap_or_else(|| panic!("no {line} in {text}")).parse().expect("a number")
}

#[tokio::test]
async fn frames_and_their_passes_are_counted() {
    let client = Client::new();
    client.put_triangle().await;
    for _ in 0..3 {
        assert_eq!(client.get("/scenes/t/frame.png").await.status, 200);
    }
    assert_eq!(metric(&client, "rasterd_frames_rendered_total{kind=\"frame\"}").await, 3.0);
    for pass in ["plan", "geometry", "raster", "shade", "encode"] {
        assert_eq!(metric(&client, &format!("rasterd_pass_seconds_count{{pass=\"{pass}\"}}")).await, 3.0);
        assert!(
            metric(&client, &format!("rasterd_pass_seconds_sum{{pass=\"{pass}\"}}")).await > 0.0,
            "{pass}"
        );
    }
    assert_eq!(metric(&client, "rasterd_work_total{unit=\"triangles_set_up\"}").await, 3.0);
    assert_eq!(metric(&client, "rasterd_work_spared_total{elision=\"clipping\"}").await, 3.0);
    assert_eq!(metric(&client, "rasterd_pass_seconds_count{pass=\"post\"}").await, 0.0);
    assert_eq!(metric(&client, "rasterd_queue_wait_seconds_count").await, 3.0);
    assert_eq!(metric(&client, "rasterd_scenes").await, 1.0);
    assert!(metric(&client, "rasterd_scene_bytes").await > 0.0);
}

#[tokio::test]
async fn requests_are_counted_by_route_and_status() {
    let client = Client::new();
    client.put_triangle().await;
    client.get("/scenes/t").await;
    client.get("/scenes/other").await;
    client.get("/scenes/another").await;
    client.get("/nothing/like/this").await;
    let count = async |route: &str, status: u16| {
        let line = format!("rasterd_http_requests_total{{route=\"{route}\",status=\"{status}\"}}");
        metric(&client, &line).await
    };
    assert_eq!(count("/scenes/{id}", 201).await, 1.0);
    assert_eq!(count("/scenes/{id}", 200).await, 1.0);
    assert_eq!(count("/scenes/{id}", 404).await, 2.0);
    assert_eq!(count("-", 404).await, 1.0, "paths that clients make up are no labels");
}

#[tokio::test]
async fn what_waits_is_refused_or_given_up_is_counted() {
    let counts = Arc::new(Counts::default());
    let narrow = Settings { renders: NonZeroUsize::MIN, queue: 1, ..settings() };
    let client = Client::drawing_with(narrow, endless(&counts));
    client.put_triangle().await;
    let ask = || {
        let client = client.clone();
        tokio::spawn(async move { client.get("/scenes/t/frame.png").await })
    };
    let running = ask();
    until(|| counts.begun.load(Ordering::SeqCst) == 1).await;
    let waiting = ask();
    until(|| client.app.renderer.queue().depth().waiting == 1).await;
    assert_eq!(metric(&client, "rasterd_queue_depth").await, 1.0);
    assert_eq!(metric(&client, "rasterd_jobs_rejected_total{reason=\"queue_full\"}").await, 0.0);
    client.get("/scenes/t/frame.png").await.problem(503);
    assert_eq!(metric(&client, "rasterd_jobs_rejected_total{reason=\"queue_full\"}").await, 1.0);

    waiting.abort();
    running.abort();
    until(|| client.app.renderer.metrics().jobs_cancelled.get() == 1).await;
    client.app.close();
    client.get("/scenes/t/frame.png").await.problem(503);
    assert_eq!(metric(&client, "rasterd_jobs_rejected_total{reason=\"closing\"}").await, 1.0);
}
