//! One connection, from its first request to its last byte.

use super::link::{Link, Shallow};
use super::patience::Patient;
use super::problem::Problem;
use super::reticent::{Replies, ReplyBody, Reticent};
use super::{App, observe, router};
use axum::Router;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::response::Response;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::future::poll_fn;
use std::pin::Pin;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_util::sync::CancellationToken;
use tower::ServiceExt;

/// What a connection may buffer of one head. The router refuses smaller ones already; beyond this, and
/// beyond a hundred headers, hyper gives up reading.
const HEAD_BUFFER_BYTES: usize = 128 << 10;

/// For a client that still sends what was refused: closing under it would reset the connection, and
/// the client would lose the reply that says why.
const LINGER: Duration = Duration::from_secs(2);

/// How to talk on a connection. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Connection {
    router: Router,
    http: http1::Builder,
    /// Without a byte of the reply taken.
    patience: Duration,
    closing: CancellationToken,
}

impl Connection {
    /// Serves `app` until `closing`: then the request under way is the last.
    pub(super) fn new(app: &App, closing: CancellationToken) -> Self {
        let mut http = http1::Builder::new();
        http.timer(TokioTimer::new())
            .header_read_timeout(app.settings.header_seconds)
            .max_buf_size(HEAD_BUFFER_BYTES);
        Self { router: router(app.clone()), http, patience: app.settings.body_seconds, closing }
    }

    /// Answers every request of `stream`.
    pub(super) async fn converse(self, stream: TcpStream) {
        // A small reply must not wait for an acknowledgement. It works without, so a refusal is no
        // matter.
        let _ = stream.set_nodelay(true);
        let (replies, link) = (Replies::default(), Link::default());
        let service = service_fn(|request| answer(self.router.clone(), &replies, &link, request));
        let stream = Shallow::new(stream, link.clone());
        let stream = Reticent::new(Patient::new(stream, self.patience), replies.clone());
        let stream = TokioIo::new(stream);
        let mut connection = self.http.serve_connection(stream, service);

        let mut ended = None;
        tokio::select! {
            result = poll_fn(|context| connection.poll_without_shutdown(context)) => ended = Some(result),
            () = self.closing.cancelled() => Pin::new(&mut connection).graceful_shutdown(),
        }
        let ended = match ended {
            Some(result) => result,
            None => {
                let end = poll_fn(|context| connection.poll_without_shutdown(context));
                // A stream is over as it is; who has not taken its last picture by now won't.
                let patience = if link.is_live() { LINGER } else { Duration::MAX };
                match tokio::time::timeout(patience, end).await {
                    Ok(result) => result,
                    Err(_) => return,
                }
            }
        };

        let parts = connection.into_parts();
        let stream = parts.io.into_inner();
        let refusal = match &ended {
            // An idle connection that times out is closed without a word: nothing was asked.
            Err(error) if error.is_timeout() && !parts.read_buf.is_empty() => Some(too_slow()),
            Err(error) if stream.has_kept_back() => Some(no_request(error)),
            _ => None,
        };
        let stream = stream.into_inner().into_inner().into_inner();
        match (ended, refusal) {
            (_, Some(problem)) => refuse(stream, &problem).await,
            (Ok(()), None) if !self.closing.is_cancelled() => close_gently(stream).await,
            _ => {}
        }
    }
}

/// Says that nothing more comes, and lets the client finish its own sentence.
async fn close_gently(mut stream: TcpStream) {
    if stream.shutdown().await.is_err() {
        return;
    }
    let mut ignored = [0; 8 << 10];
    let rest = async { while stream.read(&mut ignored).await.is_ok_and(|bytes| bytes > 0) {} };
    let _ = tokio::time::timeout(LINGER, rest).await;
}

fn too_slow() -> Problem {
    Problem::new(StatusCode::REQUEST_TIMEOUT, "the request's headers took too long")
}

/// What to say to a head that is no request.
fn no_request(error: &hyper::Error) -> Problem {
    if error.is_parse_too_large() {
        let detail = "the request's target is too long, or its headers are too large or too many";
        return Problem::new(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, detail);
    }
    Problem::bad_request(format!("this is no HTTP request: {error}"))
}

/// Writes a reply that no router gives, and its line in the log.
async fn refuse(mut stream: TcpStream, problem: &Problem) {
    let (id, status) = (observe::fresh_id(), problem.status);
    tracing::info!(id, status = status.as_u16(), detail = problem.detail, "no request");
    let body = problem.to_json(Some(&id)).to_string();
    let reply = format!(
        "HTTP/1.1 {status}\r\ncontent-type: application/problem+json\r\nx-request-id: {id}\r\n\
         content-length: {}\r\nconnection: close\r\n\r\n{body}",
        body.len()
    );
    let _ = stream.write_all(reply.as_bytes()).await; // the client may have gone
    close_gently(stream).await;
}

type Answer = Pin<Box<dyn Future<Output = Result<Response<ReplyBody>, Infallible>> + Send>>;

/// Boxed, because only a movable future lets the connection be taken apart at its end.
fn answer(router: Router, replies: &Replies, link: &Link, request: hyper::Request<Incoming>) -> Answer {
    let reply = replies.begin();
    link.begin();
    let mut request: Request = request.map(axum::body::Body::new);
    request.extensions_mut().insert(link.clone());
    Box::pin(async move { Ok(router.oneshot(request).await?.map(|body| reply.with(body))) })
}
