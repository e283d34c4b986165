//! Live streams: pictures and events without end.

use crate::client::{Client, Counts, PATIENCE, endless, settings, still, triangle, until};
use crate::socket::Server;
use axum::body::Body;
use axum::http::{Method, Response};
use http_body_util::BodyExt;
use rasterd::jobs::Draw;
use rasterd::metrics::FrameKind;
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpSocket;
use tokio::time::timeout;

const IMAGES: &[(&str, &str)] = &[("accept", "image/avif,image/webp,*/*;q=0.8")];

/// Behind each picture of the framing `advance`.
const NEXT: &[u8] = b"\r\n--frame\r\nContent-Type: image/jpeg\r\n\r\n";

/// The triangle, turning.
fn spinning() -> Value {
    let mut document = triangle();
    document["instances"]["only"]["spin"] = json!({ "axis": [0, 0, 1], "deg_per_s": 90 });
    document
}

async fn client(document: &Value) -> Client {
    let client = Client::new();
    assert_eq!(client.json(Method::PUT, "/scenes/t", document).await.status, 201);
    client
}

/// A body that is read bit by bit.
struct Live {
    body: Body,
    read: Vec<u8>,
}

/// What a picture's comment says.
#[derive(Clone, Debug, PartialEq)]
struct Shown {
    number: u64,
    revision: u64,
    t: f64,
    jpeg: Vec<u8>,
}

impl Live {
    fn of(response: Response<Body>) -> Self {
        assert_eq!(response.status(), 200);
        Self { body: response.into_body(), read: Vec::new() }
    }

    async fn open(client: &Client, path: &str) -> Self {
        let mut live = Self::of(client.open(path, IMAGES).await);
        if path.contains("stream.mjpg") {
            live.take(&NEXT[2..]).await;
        }
        live
    }

    /// Reads more; `false` at the end.
    async fn more(&mut self) -> bool {
        match timeout(PATIENCE, self.body.frame()).await.expect("bytes or an end") {
            Some(frame) => {
                self.read.extend(frame.expect("no error").into_data().expect("data"));
                true
            }
            None => false,
        }
    }

    async fn exactly(&mut self, length: usize) -> Vec<u8> {
        while self.read.len() < length {
            assert!(self.more().await, "the stream has ended");
        }
        self.read.drain(..length).collect()
    }

    async fn take(&mut self, expected: &[u8]) {
        let read = self.exactly(expected.len()).await;
        assert_eq!(String::from_utf8_lossy(&read), String::from_utf8_lossy(expected));
    }

    /// All before `mark`, which is left out.
    async fn until(&mut self, mark: &[u8]) -> Vec<u8> {
        loop {
            if let Some(at) = self.read.windows(mark.len()).position(|window| window == mark) {
                let before = self.read.drain(..at).collect();
                self.read.drain(..mark.len());
                return before;
            }
            assert!(self.more().await, "the stream has ended");
        }
    }

    async fn picture(&mut self) -> Shown {
        Shown::of(self.until(NEXT).await)
    }

    async fn event(&mut self) -> (String, Value) {
        let event = String::from_utf8(self.until(b"\n\n").await).expect("text");
        let (name, data) = event.split_once('\n').expect("two lines");
        let field = |line: &str, name: &str| line.strip_prefix(name).expect("a field").to_owned();
        (field(name, "event: "), serde_json::from_str(&field(data, "data: ")).expect("JSON"))
    }

    async fn ends(mut self) {
        while self.more().await {}
    }
}

impl Shown {
    fn of(jpeg: Vec<u8>) -> Self {
        assert_eq!((&jpeg[..2], &jpeg[jpeg.len() - 2..]), (&[0xFF, 0xD8][..], &[0xFF, 0xD9][..]));
        assert_eq!(jpeg[20..22], [0xFF, 0xFE], "a comment behind the JFIF segment");
        let end = 22 + usize::from(u16::from_be_bytes([jpeg[22], jpeg[23]]));
        let comment = std::str::from_utf8(&jpeg[24..end]).expect("text");
        let value = |name: &str| {
            let field = comment.split(' ').find_map(|field| field.strip_prefix(name)?.strip_prefix('='));
            field.unwrap_or_else(|| panic!("no {name} in {comment}"))
        };
        Self {
            number: value("frame").parse().expect("a number"),
            revision: value("revision").parse().expect("a number"),
            t: value("t").parse().expect("a number"),
            jpeg: [&jpeg[..20], &jpeg[end..]].concat(),
        }
    }
}

async fn patch(client: &Client, patch: Value) {
    let reply = client.json(Method::PATCH, "/scenes/t", &patch).await;
    assert_eq!(reply.status, 200, "{}", String::from_utf8_lossy(&reply.body));
}

fn rendered(client: &Client) -> u64 {
    client.app.renderer.metrics().frames_rendered(FrameKind::Stream).get()
}

/// The file of a single frame, with the comment of a stream's.
async fn commented(client: &Client, comment: &str) -> Vec<u8> {
    let mut jpeg = client.get("/scenes/t/frame.jpg").await.body.to_vec();
    let length = u8::try_from(comment.len() + 2).expect("short");
    jpeg.splice(20..20, [&[0xFF, 0xFE, 0, length], comment.as_bytes()].concat());
    jpeg
}

#[tokio::test]
async fn with_advance_the_next_head_follows_each_picture() {
    let client = client(&triangle()).await;
    let jpeg = commented(&client, "rasterd frame=1 revision=1 t=0").await;
    let mut live = Live::of(client.open("/scenes/t/stream.mjpg?t=0", IMAGES).await);
    let expected = [&NEXT[2..], &jpeg, NEXT, &jpeg, NEXT].concat();
    assert!(live.exactly(expected.len()).await == expected);
}

#[tokio::test]
async fn with_length_each_picture_has_its_length_and_the_boundary_follows() {
    let client = client(&triangle()).await;
    let jpeg = commented(&client, "rasterd frame=1 revision=1 t=0").await;
    let mut live = Live::of(client.open("/scenes/t/stream.mjpg?t=0", &[("accept", "*/*")]).await);
    let head = format!("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
    let part = [head.as_bytes(), &jpeg, b"\r\n--frame\r\n"].concat();
    let expected = [b"--frame\r\n", &part[..], &part[..]].concat();
    assert!(live.exactly(expected.len()).await == expected);
}

#[tokio::test]
async fn the_framing_follows_accept_unless_the_query_has_it() {
    let client = client(&triangle()).await;
    for (query, accept, has_length) in [
        ("", "image/*", false),
        ("", "text/html,image/webp,*/*;q=0.8", false),
        ("", "*/*", true),
        ("", "multipart/x-mixed-replace", true),
        ("?framing=length", "image/*", true),
        ("?framing=advance", "*/*", false),
    ] {
        let path = format!("/scenes/t/stream.mjpg{query}");
        let response = client.open(&path, &[("accept", accept)]).await;
        let header = |name: &str| response.headers()[name].to_str().expect("text").to_owned();
        assert_eq!(header("content-type"), "multipart/x-mixed-replace; boundary=frame");
        assert_eq!(header("cache-control"), "no-store");
        assert_eq!(header("x-accel-buffering"), "no");
        let head = Live::of(response).until(b"\r\n\r\n").await;
        let head = String::from_utf8(head).expect("text");
        assert!(head.starts_with("--frame\r\nContent-Type: image/jpeg"), "{head}");
        assert_eq!(head.contains("Content-Length"), has_length, "{query} {accept}");
    }
    client.open("/scenes/t/stream.mjpg", &[]).await;
    client.get_with("/scenes/t/stream.mjpg", &[("accept", "application/json")]).await.problem(406);
    client.get_with("/scenes/t/events", &[("accept", "application/json")]).await.problem(406);
}

#[tokio::test]
async fn a_moving_scene_shows_the_pictures_of_its_times() {
    let client = client(&spinning()).await;
    let mut live = Live::open(&client, "/scenes/t/stream.mjpg?width=40&quality=95&fps=60").await;
    let mut before = None;
    for _ in 0..4 {
        let shown = live.picture().await;
        let single = client.get(&format!("/scenes/t/frame.jpg?width=40&quality=95&t={}", shown.t)).await;
        assert!(single.body == shown.jpeg, "t={}", shown.t);
        if let Some((number, t)) = before.replace((shown.number, shown.t)) {
            assert!(shown.number > number && shown.t > t);
        }
    }
}

#[tokio::test]
async fn time_counts_from_the_making_of_the_scene_for_all() {
    let client = client(&spinning()).await;
    let age = || {
        let created = client.app.store.get("t").expect("a scene").created;
        created.elapsed().expect("a clock that is not set").as_secs_f64()
    };
    tokio::time::sleep(Duration::from_millis(50)).await;
    patch(&client, json!({ "name": "another version" })).await;
    for query in ["", "?samples=4"] {
        let earliest = age();
        let shown = Live::open(&client, &format!("/scenes/t/stream.mjpg{query}")).await.picture().await;
        assert!((earliest..=age()).contains(&shown.t) && earliest >= 0.05, "{} {}", shown.t, age());
    }
}

#[tokio::test]
async fn a_stream_is_no_faster_than_asked_for() {
    let client = client(&spinning()).await;
    let mut live = Live::open(&client, "/scenes/t/stream.mjpg?fps=20").await;
    let began = Instant::now();
    let first = live.picture().await.number;
    let last = loop {
        let number = live.picture().await.number;
        if number >= first + 10 {
            break number;
        }
    };
    // The first was made before this was asked, at most one period.
    let periods = u32::try_from(last - first).expect("few") - 1;
    assert!(began.elapsed() >= Duration::from_millis(45) * periods, "{:?} for {periods}", began.elapsed());
}

#[tokio::test]
async fn a_still_scene_is_drawn_once_and_shown_every_second() {
    let client = client(&triangle()).await;
    let mut live = Live::open(&client, "/scenes/t/stream.mjpg").await;
    let first = live.picture().await;
    let began = Instant::now();
    for _ in 0..2 {
        assert_eq!(live.picture().await, first);
    }
    let took = began.elapsed();
    assert!((Duration::from_millis(1800)..Duration::from_secs(15)).contains(&took), "{took:?}");
    assert_eq!(rendered(&client), 1);
}

#[tokio::test]
async fn a_frozen_time_stands_still() {
    let client = client(&spinning()).await;
    let mut live = Live::open(&client, "/scenes/t/stream.mjpg?t=1.5").await;
    let first = live.picture().await;
    assert_eq!((first.number, first.t), (1, 1.5));
    assert_eq!(live.picture().await, first);
    assert_eq!(rendered(&client), 1);
}

#[tokio::test]
async fn a_patch_is_seen_with_its_revision() {
    let client = client(&triangle()).await;
    let mut live = Live::open(&client, "/scenes/t/stream.mjpg").await;
    let first = live.picture().await;
    assert_eq!((first.number, first.revision), (1, 1));
    patch(&client, json!({ "camera": { "position": [0, 0, 9] } })).await;
    let mut second = live.picture().await;
    while second.number == 1 {
        second = live.picture().await; // repeated before the patch was drawn
    }
    assert_eq!((second.number, second.revision), (2, 2));
    assert_ne!(second.jpeg, first.jpeg);
}

#[tokio::test]
async fn a_budget_is_settled_anew_for_each_revision() {
    let client = client(&triangle()).await;
    let high = client.get("/scenes/t/frame.jpg?preset=high").await;
    let ms = high.header("render-settings").split(", ").find_map(|pair| pair.strip_prefix("ms="));
    // Enough for the best of a small picture, and not of a large one.
    let query = format!("max_ms={}", ms.expect("milliseconds"));
    let settled = async || {
        let frame = client.get(&format!("/scenes/t/frame.jpg?{query}")).await;
        let settings = frame.header("render-settings").split(", error=").next().map(str::to_owned);
        (settings.expect("settings"), frame.body)
    };
    let mut live = Live::open(&client, &format!("/scenes/t/stream.mjpg?t=0&{query}")).await;
    let (settings, single) = settled().await;
    assert!(live.picture().await.jpeg == single, "{settings}");

    patch(&client, json!({ "render": { "width": 640, "height": 480 } })).await;
    let (others, single) = settled().await;
    assert_ne!(others, settings);
    let mut shown = live.picture().await;
    while shown.revision == 1 {
        shown = live.picture().await;
    }
    assert!(shown.jpeg == single, "{others}");
}

#[tokio::test]
async fn many_watchers_cost_as_much_as_one() {
    let client = client(&triangle()).await;
    let mut watchers = Vec::new();
    for _ in 0..50 {
        let mut live = Live::open(&client, "/scenes/t/stream.mjpg").await;
        assert_eq!(live.picture().await.number, 1);
        watchers.push(live);
    }
    assert_eq!((rendered(&client), client.app.streams.count()), (1, 1));
    patch(&client, json!({ "camera": { "position": [0, 0, 9] } })).await;
    for live in &mut watchers {
        while live.picture().await.revision == 1 {}
    }
    assert_eq!(rendered(&client), 2);
    let metrics = client.get("/metrics").await;
    let metrics = String::from_utf8(metrics.body.to_vec()).expect("text");
    for line in [
        "rasterd_frames_rendered_total{kind=\"stream\"} 2",
        "rasterd_frames_rendered_total{kind=\"frame\"} 0",
        "rasterd_stream_watchers 50",
        "rasterd_stream_frames_dropped_total 0",
    ] {
        assert!(metrics.lines().any(|other| other == line), "{line}: {metrics}");
    }
    let sent = metrics.lines().find_map(|line| line.strip_prefix("rasterd_stream_frames_sent_total "));
    assert!(sent.and_then(|sent| sent.parse::<u64>().ok()).is_some_and(|sent| sent >= 100), "{metrics}");

    drop(watchers);
    until(|| client.app.streams.count() == 0).await;
    assert_eq!(client.app.renderer.metrics().stream_watchers.get(), 0);
}

#[tokio::test]
async fn other_queries_are_other_streams() {
    let client = client(&triangle()).await;
    let paths = ["?", "?width=20", "?fps=10", "?t=1"].map(|query| format!("/scenes/t/stream.mjpg{query}"));
    let mut watchers = Vec::new();
    for path in &paths {
        watchers.push(Live::open(&client, path).await);
    }
    // What means the same is the same.
    watchers.push(Live::open(&client, "/scenes/t/stream.mjpg?quality=80&fps=30").await);
    assert_eq!(client.app.streams.count(), paths.len());
}

#[tokio::test]
async fn the_end_of_a_scene_ends_its_streams() {
    for document in [triangle(), spinning()] {
        let client = client(&document).await;
        let mut pictures = Live::open(&client, "/scenes/t/stream.mjpg").await;
        let events = Live::open(&client, "/scenes/t/events").await;
        pictures.picture().await;
        assert_eq!(client.call(Method::DELETE, "/scenes/t", "", &[], "").await.status, 204);
        client.put_triangle().await;
        // Another scene by now, which streams of the old one don't show.
        let mut new = Live::open(&client, "/scenes/t/stream.mjpg").await;
        assert_eq!(new.picture().await.number, 1);
        pictures.ends().await;
        events.ends().await;
        until(|| client.app.streams.count() == 1).await;
    }
}

#[tokio::test]
async fn a_scene_that_is_replaced_goes_on_in_its_streams() {
    let client = client(&triangle()).await;
    let mut live = Live::open(&client, "/scenes/t/stream.mjpg?fps=60").await;
    live.picture().await;
    client.json(Method::PUT, "/scenes/t", &spinning()).await;
    let mut numbers = 0;
    while numbers < 5 {
        let shown = live.picture().await;
        numbers += u32::from(shown.revision == 2);
    }
}

#[tokio::test]
async fn when_the_last_watcher_leaves_nothing_is_drawn_any_more() {
    let client = client(&spinning()).await;
    let mut one = Live::open(&client, "/scenes/t/stream.mjpg").await;
    let mut other = Live::open(&client, "/scenes/t/events").await;
    one.picture().await;
    drop(one);
    other.event().await;
    assert_eq!(client.app.streams.count(), 1, "a listener keeps it");
    drop(other);
    until(|| client.app.streams.count() == 0).await;
    until(|| client.app.renderer.queue().depth().running == 0).await;
    let drawn = rendered(&client);
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert_eq!(rendered(&client), drawn);
}

#[tokio::test]
async fn a_frame_that_nobody_waits_for_is_cancelled() {
    let counts = Arc::new(Counts::default());
    let client = Client::drawing_with(settings(), endless(&counts));
    client.put_triangle().await;
    let waiting = tokio::spawn({
        let client = client.clone();
        async move { client.get("/scenes/t/stream.mjpg").await }
    });
    until(|| counts.begun.load(Ordering::SeqCst) == 1).await;
    waiting.abort();
    until(|| counts.cancelled.load(Ordering::SeqCst) == 1).await;
    assert_eq!(client.app.streams.count(), 0);
}

#[tokio::test]
async fn events_tell_what_each_frame_was() {
    let client = client(&triangle()).await;
    let response = client.open("/scenes/t/events?width=40", &[]).await;
    assert_eq!(response.headers()["content-type"], "text/event-stream");
    assert_eq!(response.headers()["cache-control"], "no-store");
    let mut events = Live::of(response);
    let (name, first) = events.event().await;
    assert_eq!(name, "frame");
    assert_eq!((&first["number"], &first["revision"], &first["watchers"]), (&json!(1), &json!(1), &json!(0)));
    assert_eq!((&first["width"], &first["height"], &first["fps"]), (&json!(40), &json!(24), &json!(1)));
    assert_eq!(first["counts"]["triangles"], 1);
    assert_eq!((&first["work"]["triangles_set_up"], &first["spared"]["clipping"]), (&json!(1), &json!(1)));
    for pass in ["queue", "plan", "raster", "shade", "encode"] {
        assert!(first["milliseconds"][pass].is_number(), "{pass}: {first}");
    }

    let mut pictures = Live::open(&client, "/scenes/t/stream.mjpg?width=40").await;
    assert_eq!(
        first["bytes"],
        client.get("/scenes/t/frame.jpg?width=40").await.body.len() + comment_of(&first)
    );
    pictures.picture().await;
    let (_, repeated) = events.event().await;
    assert_eq!((&repeated["number"], &repeated["watchers"]), (&json!(1), &json!(1)));
    patch(&client, json!({ "camera": { "position": [0, 0, 9] } })).await;
    let mut event = events.event().await.1;
    while event["number"] == 1 {
        event = events.event().await.1;
    }
    assert_eq!((&event["number"], &event["revision"]), (&json!(2), &json!(2)));
    assert_eq!(rendered(&client), 2);
}

/// Bytes that the comment of an event's picture takes.
fn comment_of(event: &Value) -> usize {
    4 + format!("rasterd frame={} revision={} t={}", event["number"], event["revision"], event["t"]).len()
}

#[tokio::test]
async fn a_scene_that_can_t_be_drawn_for_a_while_is_drawn_again() {
    let mut document = triangle();
    document["environment"] = json!({ "backgrounds": { "red": { "type": "color", "color": "#f00" } } });
    let client = client(&document).await;
    let mut pictures = Live::open(&client, "/scenes/t/stream.mjpg?background=red").await;
    let mut events = Live::open(&client, "/scenes/t/events?background=red").await;
    let first = pictures.picture().await;
    patch(&client, json!({ "environment": { "backgrounds": null } })).await;
    let problem = loop {
        if let (name, problem) = events.event().await
            && name == "problem"
        {
            break problem;
        }
    };
    assert_eq!((&problem["status"], &problem["errors"][0]["parameter"]), (&json!(422), &json!("background")));
    assert_eq!(pictures.picture().await, first, "what there is, as before");
    client.get("/scenes/t/stream.mjpg?background=red").await.problem(422);

    patch(
        &client,
        json!({ "environment": { "backgrounds": { "red": { "type": "color", "color": "#800" } } } }),
    )
    .await;
    while pictures.picture().await.revision != 3 {}
    while events.event().await.0 != "frame" {}
    assert_eq!(rendered(&client), 2);
}

#[tokio::test]
async fn what_fails_is_not_tried_again_at_once() {
    let mut document = spinning();
    document["environment"] = json!({ "backgrounds": { "red": { "type": "color", "color": "#f00" } } });
    let client = client(&document).await;
    let mut events = Live::open(&client, "/scenes/t/events?background=red&fps=60").await;
    patch(&client, json!({ "environment": { "backgrounds": null } })).await;
    while events.event().await.0 != "problem" {}
    // The pause is a second, and then two; what there is to tell is told once a second.
    let (began, mut told) = (Instant::now(), 0);
    while began.elapsed() < Duration::from_millis(2500) {
        events.event().await;
        told += 1;
    }
    assert!(told <= 8, "{told}");
}

#[tokio::test]
async fn every_output_can_be_watched() {
    let client = client(&triangle()).await;
    let outputs =
        ["depth", "normal", "albedo", "instance", "wireframe", "ids", "shadow_map", "tiles", "shaded"];
    for output in outputs {
        let query = format!("output={output}&t=0");
        let shown = Live::open(&client, &format!("/scenes/t/stream.mjpg?{query}")).await.picture().await;
        let frame = client.get(&format!("/scenes/t/frame.jpg?{query}")).await;
        assert!(shown.jpeg == frame.body, "{output}");
    }
}

#[tokio::test]
async fn queries_that_make_no_sense_are_refused_by_name() {
    let client = client(&triangle()).await;
    for (query, parameter) in [
        ("fps=0", "fps"),
        ("fps=61", "fps"),
        ("fps=fast", "fps"),
        ("quality=0", "quality"),
        ("output=radiance", "output"),
        ("speed=2", "speed"),
        ("background=none", "background"),
        ("fps=1&fps=2", "fps"),
    ] {
        for route in ["stream.mjpg", "events"] {
            let problem = client.get(&format!("/scenes/t/{route}?{query}")).await.problem(422);
            assert_eq!(problem["errors"][0]["parameter"], parameter, "{route}?{query}");
        }
    }
    let problem = client.get("/scenes/t/stream.mjpg?framing=loose&fps=99").await.problem(422);
    assert_eq!(problem["errors"].as_array().map(Vec::len), Some(2), "{problem}");
    // Events have no framing.
    client.get("/scenes/t/events?framing=length").await.problem(422);
    client.get("/scenes/t/stream.mjpg?width=99999").await.problem(413);
    client.get("/scenes/none/stream.mjpg").await.problem(404);
    client.get("/scenes/none/events").await.problem(404);
    client.call(Method::POST, "/scenes/t/stream.mjpg", "", &[], "").await.problem(405);
    until(|| client.app.streams.count() == 0).await;
}

#[tokio::test]
async fn a_head_ends() {
    let client = client(&triangle()).await;
    let reply = client.call(Method::HEAD, "/scenes/t/stream.mjpg", "", &[], "").await;
    assert_eq!((reply.status.as_u16(), reply.body.len()), (200, 0));
    until(|| client.app.streams.count() == 0).await;
}

#[tokio::test]
async fn streams_leave_a_turn_to_single_frames() {
    // Two frames at a time, and none of a stream ends.
    let draw: Box<Draw> = Box::new(|plans, work| {
        if plans[0].view.width > 32 {
            loop {
                work.check()?;
                std::thread::sleep(Duration::from_millis(2));
            }
        }
        Ok(vec![still(1, 1, |_| [0, 0, 0, 255])])
    });
    let settings = rasterd::settings::Settings { queue: 2, ..settings() };
    assert_eq!(settings.renders, NonZeroUsize::new(2).expect("two"));
    let client = Client::drawing_with(settings, draw);
    client.put_triangle().await;
    let waiting: Vec<_> = (33..48)
        .map(|width| {
            let client = client.clone();
            tokio::spawn(
                async move { client.get(&format!("/scenes/t/stream.mjpg?width={width}")).await.status },
            )
        })
        .collect();
    until(|| client.app.streams.count() == waiting.len()).await;
    until(|| client.app.renderer.queue().depth().running == 1).await;
    assert_eq!(client.get("/scenes/t/frame.png").await.status, 200);
    assert_eq!(client.app.renderer.queue().depth().waiting, 0);
    client.app.close();
    for status in waiting {
        assert_eq!(status.await.expect("no panic"), 503);
    }
}

const WATCH: &str = "GET /scenes/t/stream.mjpg?fps=60 HTTP/1.1\r\nhost: localhost\r\naccept: image/*\r\n\r\n";

/// A side of a picture of noise that is far more than what sockets hold.
const LARGE: u32 = 512;

/// And of one that they could hold many of.
const SMALL: u32 = 56;

/// Noise in every picture.
fn noise(side: u32) -> Box<Draw> {
    Box::new(move |_, _| {
        let mut state = 1u32;
        let noise = still(side, side, |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state ^ state >> 15).to_be_bytes()
        });
        Ok(vec![noise])
    })
}

/// A service with a moving scene of such pictures.
async fn noisy(settings: rasterd::settings::Settings, side: u32) -> (Client, Server) {
    let client = Client::drawing_with(settings, noise(side));
    let server = Server::start(client.app.clone()).await;
    client.json(Method::PUT, "/scenes/t", &spinning()).await;
    (client, server)
}

/// A connection whose own buffer is small, so that what is held is held by the server.
async fn watch(server: &Server) -> tokio::net::TcpStream {
    let socket = TcpSocket::new_v4().expect("a socket");
    socket.set_recv_buffer_size(4 << 10).expect("a small buffer");
    let mut stream = socket.connect(server.address).await.expect("a connection");
    stream.write_all(WATCH.as_bytes()).await.expect("a writable connection");
    stream
}

#[tokio::test(flavor = "multi_thread")]
async fn a_watcher_that_does_not_read_holds_nobody_up_and_then_sees_what_is_new() {
    // The client's own buffer, which no server sees, has room for more than one small picture.
    for (side, old) in [(LARGE, 2), (SMALL, 3)] {
        holds_nobody_up(side, old).await;
    }
}

/// And holds at most so many `old` pictures itself.
async fn holds_nobody_up(side: u32, old: usize) {
    let (client, server) = noisy(settings(), side).await;
    let mut deaf = watch(&server).await;
    // Its first picture is on the way.
    deaf.readable().await.expect("bytes");
    let mut other = Live::open(&client, "/scenes/t/stream.mjpg?fps=60").await;
    let first = other.picture().await.number;
    let latest = loop {
        let number = other.picture().await.number;
        if number >= first + 30 {
            break number;
        }
    };
    drop(other);

    let mut read = Vec::new();
    let numbers = loop {
        let mut bytes = [0; 64 << 10];
        let length = timeout(PATIENCE, deaf.read(&mut bytes)).await.expect("bytes").expect("a connection");
        read.extend(&bytes[..length]);
        let numbers = numbers(&read);
        if numbers.last().is_some_and(|last| *last >= latest) {
            break numbers;
        }
    };
    println!("{side} x {side}: {numbers:?}, after {latest}");
    assert!(numbers.len() <= old + 1, "{old} old ones at most: {numbers:?}, after {latest}");
    assert!(client.app.renderer.metrics().stream_frames_dropped.get() >= 20);
}

/// Numbers of the pictures whose beginning is there.
fn numbers(bytes: &[u8]) -> Vec<u64> {
    let text: Vec<u8> = bytes.iter().map(|byte| if byte.is_ascii() { *byte } else { b'?' }).collect();
    let text = String::from_utf8(text).expect("ASCII");
    let comments = text.split("rasterd frame=").skip(1);
    comments.filter_map(|rest| rest.split_once(' ')?.0.parse().ok()).collect()
}

#[tokio::test]
async fn a_watcher_that_never_reads_is_given_up() {
    let settings = rasterd::settings::Settings { body_seconds: Duration::from_millis(300), ..settings() };
    let (client, server) = noisy(settings, LARGE).await;
    let deaf = watch(&server).await;
    until(|| client.app.renderer.metrics().stream_watchers.get() == 1).await;
    until(|| client.app.renderer.metrics().stream_watchers.get() == 0).await;
    drop(deaf);
}

#[tokio::test]
async fn a_client_that_leaves_is_no_watcher_any_more() {
    let (client, server) = noisy(settings(), LARGE).await;
    let gone = watch(&server).await;
    until(|| client.app.renderer.metrics().stream_frames_sent.get() > 0).await;
    drop(gone);
    until(|| client.app.streams.count() == 0).await;
}

#[tokio::test]
async fn a_shutdown_ends_streams() {
    let client = Client::new();
    let server = Server::start(client.app.clone()).await;
    let mut watching = server.say(WATCH).await;
    let mut listening = server.say("GET /scenes/t/events HTTP/1.1\r\nhost: localhost\r\n\r\n").await;
    for stream in [&watching, &listening] {
        stream.readable().await.expect("a reply that has begun");
    }
    server.stop.send(()).expect("a running server");
    for stream in [&mut watching, &mut listening] {
        let mut reply = Vec::new();
        timeout(PATIENCE, stream.read_to_end(&mut reply)).await.expect("an end").expect("no reset");
        assert!(reply.ends_with(b"\r\n0\r\n\r\n"), "the last chunk");
    }
    timeout(PATIENCE, server.ended).await.expect("an end").expect("no panic");
}

#[tokio::test]
async fn a_watcher_that_does_not_read_holds_no_shutdown_up() {
    let (client, server) = noisy(settings(), LARGE).await;
    let _deaf = watch(&server).await;
    until(|| client.app.renderer.metrics().stream_watchers.get() == 1).await;
    tokio::time::sleep(Duration::from_millis(100)).await;
    server.stop.send(()).expect("a running server");
    timeout(PATIENCE, server.ended).await.expect("an end").expect("no panic");
    assert_eq!(client.app.renderer.metrics().stream_watchers.get(), 0);
}
