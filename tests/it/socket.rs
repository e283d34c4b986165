//! What only a real socket shows: slow heads, clients that leave, shutdown.

use crate::client::{Client, Counts, PATIENCE, endless, settings, still, triangle, until};
use rasterd::http::App;
use rasterd::http::serve::serve;
use rasterd::jobs::Draw;
use rasterd::scene::{ModelOptions, NewScene, Precondition, UpAxis};
use rasterd::settings::Settings;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::time::timeout;

/// A server on a port of its own.
pub struct Server {
    pub address: SocketAddr,
    pub stop: oneshot::Sender<()>,
    pub ended: JoinHandle<()>,
}

impl Server {
    pub async fn start(app: App) -> Self {
        let new = NewScene {
            document: Some(triangle()),
            files: None,
            options: ModelOptions { up: UpAxis::Y, floor: false },
        };
        app.store.put("t", new, &Precondition::None).expect("a scene");
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let (stop, stopped) = oneshot::channel::<()>();
        let ended = tokio::spawn(serve(listener, app, async {
            let _ = stopped.await;
        }));
        Self { address, stop, ended }
    }

    pub async fn say(&self, text: &str) -> TcpStream {
        let mut stream = TcpStream::connect(self.address).await.expect("a connection");
        stream.write_all(text.as_bytes()).await.expect("a writable connection");
        stream
    }
}

/// Everything until the server closes the connection.
async fn rest(mut stream: TcpStream) -> String {
    let mut reply = Vec::new();
    timeout(PATIENCE, stream.read_to_end(&mut reply)).await.expect("an end").expect("a readable connection");
    String::from_utf8_lossy(&reply).into_owned()
}

const FRAME: &str = "GET /scenes/t/frame.png HTTP/1.1\r\nhost: localhost\r\n\r\n";

#[tokio::test]
async fn a_head_that_does_not_end_is_answered_408() {
    let settings = Settings { header_seconds: Duration::from_millis(50), ..settings() };
    let server = Server::start(Client::with(settings).app).await;
    let reply = rest(server.say("GET /healthz HTTP/1.1\r\nhost: local").await).await;
    assert!(reply.starts_with("HTTP/1.1 408 "), "{reply}");
    let (head, body) = reply.split_once("\r\n\r\n").expect("a head");
    assert!(head.contains(&format!("content-length: {}", body.len())));
    assert_eq!(serde_json::from_str::<serde_json::Value>(body).expect("JSON")["status"], 408);
}

/// The problem that a whole reply holds.
#[track_caller]
fn problem_of(reply: &str) -> serde_json::Value {
    let (head, body) = reply.split_once("\r\n\r\n").expect("a head");
    assert!(head.contains("application/problem+json"), "{reply}");
    assert!(head.contains(&format!("content-length: {}", body.len())), "{reply}");
    serde_json::from_str(body).expect("JSON")
}

#[tokio::test]
async fn what_is_no_request_is_answered_with_a_problem() {
    let server = Server::start(Client::new().app).await;
    let headers = |count: usize| "a: b\r\n".repeat(count);
    let long = |length: usize| "x".repeat(length);
    for (text, status) in [
        ("\x16\x03\x01 no TLS here\r\n\r\n".to_owned(), 400),
        ("GET /healthz\r\n\r\n".to_owned(), 400),
        ("GET /healthz HTTP/1.1\r\nhost: localhost\r\ncontent-length: many\r\n\r\n".to_owned(), 400),
        (format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\n{}\r\n", headers(120)), 431),
        (format!("GET /{} HTTP/1.1\r\nhost: localhost\r\n\r\n", long(70_000)), 431),
        (format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\na: {}\r\n\r\n", long(300_000)), 431),
    ] {
        let reply = rest(server.say(&text).await).await;
        assert!(reply.starts_with(&format!("HTTP/1.1 {status} ")), "{text:.80}: {reply}");
        assert_eq!(reply.matches("HTTP/1.1").count(), 1, "{reply}");
        let problem = problem_of(&reply);
        assert_eq!(problem["status"], status);
        assert!(reply.contains(problem["request_id"].as_str().expect("an id")));
    }
}

#[tokio::test]
async fn after_a_good_request_a_bad_one_is_answered_too() {
    let server = Server::start(Client::new().app).await;
    let mut stream = server.say("GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n").await;
    let mut good = vec![0; 4096];
    let length = timeout(PATIENCE, stream.read(&mut good)).await.expect("a reply").expect("bytes");
    assert!(good[..length].starts_with(b"HTTP/1.1 200 OK") && good[..length].ends_with(b"ok\n"));
    stream.write_all(b"GET\r\n\r\n").await.expect("a writable connection");
    let reply = rest(stream).await;
    assert!(reply.starts_with("HTTP/1.1 400 "), "{reply}");
    assert_eq!(problem_of(&reply)["status"], 400);
}

#[tokio::test]
async fn an_idle_connection_is_closed_without_a_word() {
    let settings = Settings { header_seconds: Duration::from_millis(50), ..settings() };
    let server = Server::start(Client::with(settings).app).await;
    assert_eq!(rest(server.say("").await).await, "");
    let served = rest(server.say("GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n").await).await;
    assert!(served.starts_with("HTTP/1.1 200 OK") && served.ends_with("\r\n\r\nok\n"), "{served}");
}

#[tokio::test]
async fn a_client_that_leaves_cancels_its_frame() {
    let counts = Arc::new(Counts::default());
    let server = Server::start(Client::drawing_with(settings(), endless(&counts)).app).await;
    let stream = server.say(FRAME).await;
    until(|| counts.begun.load(Ordering::SeqCst) == 1).await;
    drop(stream);
    until(|| counts.cancelled.load(Ordering::SeqCst) == 1).await;
}

#[tokio::test]
async fn a_shutdown_finishes_the_frame_under_way() {
    let (begun, go) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    let draw: Box<Draw> = Box::new({
        let (begun, go) = (Arc::clone(&begun), Arc::clone(&go));
        move |_, _| {
            begun.store(true, Ordering::SeqCst);
            while !go.load(Ordering::SeqCst) {
                std::thread::sleep(Duration::from_millis(2));
            }
            Ok(vec![still(1, 1, |_| [0; 4])])
        }
    });
    let app = Client::drawing_with(settings(), draw).app;
    let server = Server::start(app).await;
    let idle = server.say("").await;
    let stream = server.say(FRAME).await;
    until(|| begun.load(Ordering::SeqCst)).await;

    server.stop.send(()).expect("a running server");
    assert_eq!(rest(idle).await, "");
    assert!(!server.ended.is_finished());
    go.store(true, Ordering::SeqCst);
    let reply = rest(stream).await;
    assert!(reply.starts_with("HTTP/1.1 200 OK") && reply.contains("IEND"), "{reply}");
    timeout(PATIENCE, server.ended).await.expect("an end").expect("no panic");
    assert!(TcpStream::connect(server.address).await.is_err());
}

#[tokio::test]
async fn a_refusal_reaches_a_client_that_is_still_sending() {
    let settings = Settings { max_body_bytes: 64, ..settings() };
    let server = Server::start(Client::with(settings).app).await;
    let mut body = vec![b'x'; 32 << 20];
    let head = format!(
        "PUT /scenes/a HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n",
        body.len()
    );
    body.splice(..0, head.into_bytes());
    let mut stream = TcpStream::connect(server.address).await.expect("a connection");
    stream.write_all(&body).await.expect("all of it is taken");
    let reply = rest(stream).await;
    assert!(reply.starts_with("HTTP/1.1 413 "), "{reply}");
}

#[tokio::test]
async fn a_client_that_does_not_read_is_given_up() {
    let settings = Settings {
        body_seconds: Duration::from_millis(100),
        connections: std::num::NonZeroUsize::MIN,
        ..settings()
    };
    // Noise, so that the file is as large as its pixels: more than the sockets between hold.
    let draw: Box<Draw> = Box::new(|_, _| {
        let mut state = 1u32;
        let noise = still(4096, 4096, |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state ^ state >> 15).to_be_bytes()
        });
        Ok(vec![noise])
    });
    let server = Server::start(Client::drawing_with(settings, draw).app).await;
    let _deaf = server.say(FRAME).await;
    // There is one place, and the deaf client has it until it is given up.
    let reply =
        rest(server.say("GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await).await;
    assert!(reply.starts_with("HTTP/1.1 200 OK"), "{reply}");
}
