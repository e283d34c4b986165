//! The accept loop: connections in, each served by the router, until a shutdown drains them.
//!
//! `axum::serve` knows no time-out for request heads, no connection limit, and waits for ever for open
//! connections; so the loop is our own, on hyper.

use super::App;
use super::connection::Connection;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::sync::CancellationToken;

/// Time for replies to leave once the last frame is drawn.
const LAST_WORDS: Duration = Duration::from_secs(5);

/// After a failed accept (no file descriptor left, mostly), before the next.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Serves `app` until `shutdown` ends: then it is not ready at once, what is under way is finished,
/// and no connection is left, at the latest when the last frame's deadline has passed.
pub async fn serve(listener: TcpListener, app: App, shutdown: impl Future<Output = ()>) {
    let server = Server::new(&app);
    tokio::select! {
        () = server.accept(&listener) => {}
        () = shutdown => {}
    }
    drop(listener);
    app.close();
    server.drain(app.settings.frame_seconds + LAST_WORDS).await;
}

struct Server {
    connection: Connection,
    places: Arc<Semaphore>,
    places_total: u32,
    closing: CancellationToken,
}

impl Server {
    fn new(app: &App) -> Self {
        let places_total =
            u32::try_from(app.settings.connections.get()).unwrap_or(u32::MAX >> 4).min(u32::MAX >> 4);
        let closing = CancellationToken::new();
        Self {
            connection: Connection::new(app, closing.clone()),
            places: Arc::new(Semaphore::new(places_total as usize)),
            places_total,
            closing,
        }
    }

    /// Accepts for ever, as long as there are places.
    async fn accept(&self, listener: &TcpListener) {
        while let Ok(place) = Arc::clone(&self.places).acquire_owned().await {
            match listener.accept().await {
                Ok((stream, _)) => self.spawn(stream, place),
                Err(error) => {
                    tracing::warn!(%error, "a connection was not accepted");
                    tokio::time::sleep(ACCEPT_PAUSE).await;
                }
            }
        }
    }

    fn spawn(&self, stream: TcpStream, place: OwnedSemaphorePermit) {
        let talk = self.connection.clone();
        tokio::spawn(async move {
            talk.converse(stream).await;
            drop(place);
        });
    }

    /// Waits until every connection has ended, but no longer than `patience`.
    async fn drain(&self, patience: Duration) {
        self.closing.cancel();
        let all = self.places.acquire_many(self.places_total);
        if tokio::time::timeout(patience, all).await.is_err() {
            tracing::warn!("connections were cut off");
        }
    }
}
