//! What a live stream needs of the connection under it: to hold little that has not left yet.
//!
//! A client that reads slowly must see what is new, not a queue of what was. By default the system would
//! hold 29 pictures of 100 kB for it, and hyper a few more. So the socket's buffer is made small once a
//! stream begins ([`Shallow`]), and the stream gives the next picture only when the last one has left
//! hyper's ([`Drained`]).

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::sync::watch;

/// Bytes that the system may hold for a stream.
const SEND_BUFFER_BYTES: usize = 64 << 10;

/// Bytes that may wait in the system before a socket counts as full: none, for small pictures would be many in
/// any number. What has left and is on its way does not count, so a fast line stays busy.
#[cfg(any(target_os = "android", target_os = "linux"))]
const UNSENT_BYTES: u32 = 1;

/// Between the replies of one connection and its socket.
#[derive(Clone, Debug, Default)]
pub(super) struct Link(Arc<State>);

#[derive(Debug)]
struct State {
    live: AtomicBool,
    flushes: watch::Sender<()>,
}

impl Default for State {
    fn default() -> Self {
        Self { live: AtomicBool::new(false), flushes: watch::Sender::new(()) }
    }
}

impl Link {
    /// Another request came; what it asks for need not be a stream.
    pub(super) fn begin(&self) {
        self.0.live.store(false, Ordering::Relaxed);
    }

    /// From now on the connection carries a stream.
    pub(super) fn begin_live(&self) -> Drained {
        self.0.live.store(true, Ordering::Relaxed);
        Drained(self.0.flushes.subscribe())
    }

    /// Whether its last reply is a stream.
    pub(super) fn is_live(&self) -> bool {
        self.0.live.load(Ordering::Relaxed)
    }
}

/// Tells when what was said has left.
#[derive(Debug)]
pub(super) struct Drained(watch::Receiver<()>);

impl Drained {
    /// Waits until the system has taken all that was said before this is first polled.
    pub(super) async fn wait(&mut self) {
        self.0.mark_unchanged();
        // It closes with the connection, and whoever waits here goes with it.
        let _ = self.0.changed().await;
    }
}

/// A socket whose buffer is small once its connection carries a stream.
#[derive(Debug)]
pub(super) struct Shallow {
    stream: TcpStream,
    link: Link,
    is_shallow: bool,
}

impl Shallow {
    /// The socket of the connection that `link` belongs to.
    pub(super) fn new(stream: TcpStream, link: Link) -> Self {
        Self { stream, link, is_shallow: false }
    }

    /// The socket itself.
    pub(super) fn into_inner(self) -> TcpStream {
        self.stream
    }

    fn settle(&mut self) {
        if self.link.is_live() && !self.is_shallow {
            self.is_shallow = true;
            make_shallow(&self.stream);
        }
    }
}

/// It works without, with older pictures for slow readers; so a refusal is no matter.
fn make_shallow(stream: &TcpStream) {
    let socket = socket2::SockRef::from(stream);
    let _ = socket.set_send_buffer_size(SEND_BUFFER_BYTES);
    #[cfg(any(target_os = "android", target_os = "linux"))]
    let _ = socket.set_tcp_notsent_lowat(UNSENT_BYTES);
}

impl AsyncWrite for Shallow {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.settle();
        Pin::new(&mut self.stream).poll_write(context, bytes)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.settle();
        Pin::new(&mut self.stream).poll_write_vectored(context, parts)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    /// hyper asks for this when its own buffer is empty, and not before.
    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(Pin::new(&mut self.stream).poll_flush(context))?;
        if self.link.is_live() {
            self.link.0.flushes.send_replace(());
        }
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

impl AsyncRead for Shallow {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}
