//! A stream that keeps back what hyper says without being asked.
//!
//! hyper refuses a head that it can't read by itself (garbage, a wrong `Content-Length`, too many
//! headers, too long a target), with a reply that has no body. The refusal is kept back here, and the
//! connection writes one that says why.
//!
//! How it is told from a reply of ours: between two replies hyper has nothing else to say. Each
//! reply is counted as it begins and as its body is handed over; once as many have ended as have begun and a flush has found nothing left, whatever is written before the next one begins is
//! hyper's own. Where a client sends the bad head before it has taken the reply before it, hyper may
//! write both in one go; then the refusal goes out as it is, without a body.

use axum::body::{Body, Bytes};
use hyper::body::{Body as HttpBody, Frame, SizeHint};
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

/// Counts the replies of one connection. They and its stream are driven by one task.
#[derive(Clone, Debug, Default)]
pub(super) struct Replies(Arc<Counts>);

#[derive(Debug, Default)]
struct Counts {
    begun: AtomicU64,
    ended: AtomicU64,
}

impl Replies {
    /// A reply begins, which ends when what this gives is dropped.
    pub(super) fn begin(&self) -> Reply {
        self.0.begun.fetch_add(1, Ordering::Relaxed);
        Reply(self.clone())
    }

    fn begun(&self) -> u64 {
        self.0.begun.load(Ordering::Relaxed)
    }

    fn ended(&self) -> u64 {
        self.0.ended.load(Ordering::Relaxed)
    }
}

/// A reply that is under way.
#[derive(Debug)]
pub(super) struct Reply(Replies);

impl Reply {
    /// A body that the reply lasts as long as.
    pub(super) fn with(self, body: Body) -> ReplyBody {
        ReplyBody { body, _reply: self }
    }
}

impl Drop for Reply {
    fn drop(&mut self) {
        self.0.0.ended.fetch_add(1, Ordering::Relaxed);
    }
}

/// A body with the reply that it belongs to.
#[derive(Debug)]
pub(super) struct ReplyBody {
    body: Body,
    _reply: Reply,
}

impl HttpBody for ReplyBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// Passes replies on, and keeps back what comes between them.
#[derive(Debug)]
pub(super) struct Reticent<S> {
    stream: S,
    replies: Replies,
    /// How many replies had begun when the last of them was flushed.
    flushed: u64,
    kept_back: bool,
}

impl<S> Reticent<S> {
    /// A stream of the connection whose replies `replies` counts.
    pub(super) fn new(stream: S, replies: Replies) -> Self {
        Self { stream, replies, flushed: 0, kept_back: false }
    }

    /// Whether something was kept back: a refusal, since which nothing was written.
    pub(super) fn has_kept_back(&self) -> bool {
        self.kept_back
    }

    /// The stream itself.
    pub(super) fn into_inner(self) -> S {
        self.stream
    }

    fn is_between_replies(&self) -> bool {
        self.flushed == self.replies.begun()
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Reticent<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        if self.is_between_replies() {
            self.kept_back = true;
            return Poll::Ready(Ok(bytes.len()));
        }
        Pin::new(&mut self.stream).poll_write(context, bytes)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        if self.is_between_replies() {
            self.kept_back = true;
            return Poll::Ready(Ok(parts.iter().map(|part| part.len()).sum()));
        }
        Pin::new(&mut self.stream).poll_write_vectored(context, parts)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(Pin::new(&mut self.stream).poll_flush(context))?;
        if self.replies.ended() == self.replies.begun() {
            self.flushed = self.replies.begun();
        }
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Reticent<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::io::{AsyncReadExt, AsyncWriteExt, duplex};

    #[tokio::test]
    async fn only_what_comes_between_replies_is_kept_back() {
        let (ours, mut theirs) = duplex(64);
        let replies = Replies::default();
        let mut stream = Reticent::new(ours, replies.clone());
        let reply = replies.begin();
        stream.write_all(b"head ").await.expect("written");
        stream.flush().await.expect("flushed");
        stream.write_all(b"body ").await.expect("written");
        drop(reply);
        stream.write_all(b"end").await.expect("what the reply has left");
        assert!(!stream.has_kept_back());

        stream.flush().await.expect("flushed");
        stream.write_all(b"refusal").await.expect("taken");
        assert!(stream.has_kept_back());
        // A reply that is over before its first byte is written is one all the same.
        drop(replies.begin());
        stream.write_all(b", next").await.expect("written");
        drop(stream);
        let mut seen = String::new();
        theirs.read_to_string(&mut seen).await.expect("text");
        assert_eq!(seen, "head body end, next");
    }
}
