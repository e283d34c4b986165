//! Live streams: one rendering and one encoding for all who watch the same.
//!
//! In: a scene's versions and a [`StreamRequest`]. Out: a [`Watcher`] for each client, which is given the
//! newest [`Picture`] whenever it asks for the next.
//!
//! A [`Broadcast`] lives while it has watchers. Its task (`caster`) draws when the scene has changed or moves;
//! a `watch` channel carries the newest picture and nothing else, so a slow watcher skips pictures, holds no
//! more than the one it is taking, and delays nobody. What does not change is repeated to each once a
//! second: to proxies and to peers that have gone, a still picture would look like a dead connection.

mod caster;
mod request;

pub use request::StreamRequest;

use super::{JobError, Renderer};
use crate::plan::Tally;
use crate::report::choose::Choice;
use crate::scene::Entry;
use bytes::Bytes;
use caster::Caster;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

/// After this, a picture that has not changed is handed out again.
const REPEAT: Duration = Duration::from_secs(1);

/// The time that [`Watcher::fps`] looks back.
const PACE: Duration = Duration::from_secs(1);

/// All streams. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Streams(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    renderer: Renderer,
    /// Few enough to be looked through one by one: each has a connection at least.
    live: Mutex<Vec<Arc<Broadcast>>>,
    closing: CancellationToken,
}

/// One stream, with all who watch it.
#[derive(Debug)]
struct Broadcast {
    /// [`Entry::incarnation`] of its scene.
    incarnation: u64,
    request: StreamRequest,
    news: watch::Receiver<News>,
    /// All who keep it going. Changes under the lock of [`Shared::live`] alone.
    users: AtomicUsize,
    /// Those of them who see its pictures.
    watchers: AtomicUsize,
    /// When the pictures of the last second were made.
    pace: Mutex<VecDeque<Instant>>,
    /// Ends its task.
    over: CancellationToken,
}

/// What somebody wants of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// Its pictures.
    Watches,
    /// What is said of them.
    Listens,
}

/// How a stream stands.
#[derive(Clone, Debug, Default)]
pub struct News {
    /// The newest picture; from the first on there is one.
    pub picture: Option<Arc<Picture>>,
    /// Why there has been none since, if the last try failed. There will be others.
    pub failure: Option<JobError>,
}

/// One picture of a stream.
#[derive(Debug)]
pub struct Picture {
    /// Counts from 1, as long as the stream has watchers.
    pub number: u64,
    /// Of the scene.
    pub revision: u64,
    /// Seconds: the `t` of a single frame that is the same picture.
    pub t: f64,
    /// The file, with these three in a comment segment.
    pub jpeg: Bytes,
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Milliseconds: `queue`, `plan`, the passes, `encode`.
    pub timings: Vec<(&'static str, f64)>,
    /// Counts, by the names of `Render-Stats`.
    pub stats: Vec<(&'static str, u64)>,
    /// What was done, and what elisions spared.
    pub tally: Tally,
    /// What the stream's budget was settled into, if it has one.
    pub choice: Option<Choice>,
}

impl Streams {
    /// No stream yet.
    #[must_use]
    pub fn new(renderer: Renderer) -> Self {
        Self(Arc::new(Shared { renderer, live: Mutex::default(), closing: CancellationToken::new() }))
    }

    /// Watches the scene of `versions` as `request` says, together with all who watch the same.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    #[must_use]
    pub fn watch(&self, versions: watch::Receiver<Entry>, request: StreamRequest) -> Watcher {
        self.join(versions, request, Role::Watches)
    }

    /// The same for who wants to know of the pictures and sees none of them.
    ///
    /// # Panics
    /// Outside of a tokio runtime.
    #[must_use]
    pub fn listen(&self, versions: watch::Receiver<Entry>, request: StreamRequest) -> Watcher {
        self.join(versions, request, Role::Listens)
    }

    fn join(&self, versions: watch::Receiver<Entry>, request: StreamRequest, role: Role) -> Watcher {
        let incarnation = versions.borrow().incarnation;
        let mut live = self.live();
        let joined = live.iter().find(|broadcast| broadcast.shows(incarnation, &request)).cloned();
        let broadcast = joined.unwrap_or_else(|| {
            let broadcast = self.begin(incarnation, versions, request);
            live.push(Arc::clone(&broadcast));
            broadcast
        });
        broadcast.users.fetch_add(1, Ordering::Relaxed);
        drop(live);
        if role == Role::Watches {
            broadcast.watchers.fetch_add(1, Ordering::Relaxed);
            self.0.renderer.metrics().stream_watchers.inc();
        }
        Watcher { news: broadcast.news.clone(), broadcast, streams: self.clone(), role, given: None }
    }

    /// Ends all streams, also those that begin from now on.
    pub fn close(&self) {
        self.0.closing.cancel();
    }

    /// How many different streams are watched.
    #[must_use]
    pub fn count(&self) -> usize {
        self.live().len()
    }

    fn begin(
        &self,
        incarnation: u64,
        versions: watch::Receiver<Entry>,
        request: StreamRequest,
    ) -> Arc<Broadcast> {
        let (sender, news) = watch::channel(News::default());
        let broadcast = Arc::new(Broadcast {
            incarnation,
            request,
            news,
            users: AtomicUsize::new(0),
            watchers: AtomicUsize::new(0),
            pace: Mutex::default(),
            over: self.0.closing.child_token(),
        });
        let caster = Caster::new(self.0.renderer.clone(), versions, Arc::clone(&broadcast), sender);
        let (streams, ended) = (self.clone(), Arc::clone(&broadcast));
        tokio::spawn(async move {
            caster.run().await;
            streams.remove(&ended);
        });
        broadcast
    }

    fn leave(&self, broadcast: &Arc<Broadcast>, role: Role) {
        if role == Role::Watches {
            broadcast.watchers.fetch_sub(1, Ordering::Relaxed);
            self.0.renderer.metrics().stream_watchers.dec();
        }
        let mut live = self.live();
        if broadcast.users.fetch_sub(1, Ordering::Relaxed) == 1 {
            broadcast.over.cancel();
            live.retain(|other| !Arc::ptr_eq(other, broadcast));
        }
    }

    fn remove(&self, broadcast: &Arc<Broadcast>) {
        self.live().retain(|other| !Arc::ptr_eq(other, broadcast));
    }

    // Every change of the list is one insertion or removal, so a poisoned lock is as good as any.
    fn live(&self) -> MutexGuard<'_, Vec<Arc<Broadcast>>> {
        self.0.live.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Broadcast {
    /// Whether a client that asks for this can join.
    fn shows(&self, incarnation: u64, request: &StreamRequest) -> bool {
        // A task that has ended by itself has closed the channel, and may not be off the list yet.
        let lives = self.news.has_changed().is_ok() && !self.over.is_cancelled();
        lives && self.incarnation == incarnation && self.request == *request
    }

    fn pace(&self) -> MutexGuard<'_, VecDeque<Instant>> {
        let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        while pace.front().is_some_and(|made| made.elapsed() > PACE) {
            pace.pop_front();
        }
        pace
    }
}

/// One client's view of a stream. When the last one is dropped, the stream ends.
#[derive(Debug)]
pub struct Watcher {
    news: watch::Receiver<News>,
    broadcast: Arc<Broadcast>,
    streams: Streams,
    role: Role,
    /// When it was given a picture last.
    given: Option<Instant>,
}

impl Watcher {
    /// The picture there is, or the first one when it is made.
    ///
    /// # Errors
    /// Why the last try failed; [`JobError::Closing`] if the stream has ended, with the server or with its
    /// scene.
    pub async fn first(&mut self) -> Result<Arc<Picture>, JobError> {
        let is_there = |news: &News| news.failure.is_some() || news.picture.is_some();
        let news = self.news.wait_for(is_there).await.map_err(|_| JobError::Closing)?.clone();
        match news {
            News { picture: Some(picture), failure: None } => {
                self.note_given();
                Ok(picture)
            }
            News { failure, .. } => Err(failure.unwrap_or(JobError::Closing)),
        }
    }

    /// What is new since the last call, or after a second what there is; `None` when the stream has ended.
    pub async fn next(&mut self) -> Option<News> {
        let repeat = self.given.map_or_else(Instant::now, |when| when + REPEAT);
        if let Ok(changed) = tokio::time::timeout_at(repeat.into(), self.news.changed()).await {
            changed.ok()?;
        }
        let news = self.news.borrow_and_update().clone();
        if news.picture.is_some() {
            self.note_given();
        }
        Some(news)
    }

    /// Waits until the stream has ended.
    pub async fn ended(&self) {
        // A receiver of its own: what it has seen does not count as seen here.
        let mut news = self.news.clone();
        while news.changed().await.is_ok() {}
    }

    /// Counts a picture as sent, and those before it that this watcher has never seen as dropped. `before`
    /// is the one sent last.
    pub fn count_sent(&self, picture: &Picture, before: Option<u64>) {
        let metrics = self.streams.0.renderer.metrics();
        metrics.stream_frames_sent.inc();
        metrics
            .stream_frames_dropped
            .inc_by(before.map_or(0, |before| (picture.number - before).saturating_sub(1)));
    }

    /// How many see the same pictures; who listens is not among them.
    #[must_use]
    pub fn watchers(&self) -> usize {
        self.broadcast.watchers.load(Ordering::Relaxed)
    }

    /// Pictures that the stream has made within the last second.
    #[must_use]
    pub fn fps(&self) -> usize {
        self.broadcast.pace().len()
    }

    fn note_given(&mut self) {
        self.given = Some(Instant::now());
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.streams.leave(&self.broadcast, self.role);
    }
}
