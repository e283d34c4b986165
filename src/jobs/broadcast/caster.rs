//! The task behind a stream: it draws frames, and encodes each while the next is drawn.

use super::{Broadcast, News, Picture};
use crate::jobs::draw::Drawn;
use crate::jobs::{Encoded, JobError, Renderer};
use crate::plan::FrameRequest;
use crate::report::choose::Choice;
use crate::scene::Entry;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::{mpsc, watch};
use tokio::time::{Interval, MissedTickBehavior, interval, timeout};

/// After a frame that failed, before the next try; each failure in a row doubles it, up to [`LONGEST_PAUSE`].
const PAUSE: Duration = Duration::from_secs(1);

/// A frame that runs into its deadline has cost half a minute of every thread.
const LONGEST_PAUSE: Duration = Duration::from_secs(64);

/// What a stream's task has.
pub(super) struct Caster {
    renderer: Renderer,
    versions: watch::Receiver<Entry>,
    broadcast: Arc<Broadcast>,
    news: watch::Sender<News>,
    clock: Clock,
}

/// Seconds since a scene was made.
#[derive(Clone, Copy, Debug)]
struct Clock {
    /// When the stream began, by the system's clock.
    at_start: Duration,
    /// From then on by one that nobody sets.
    started: Instant,
}

impl Clock {
    fn of(entry: &Entry) -> Self {
        Self { at_start: entry.created.elapsed().unwrap_or_default(), started: Instant::now() }
    }

    /// In whole microseconds, so that it is short to write down.
    fn seconds(&self) -> f64 {
        (self.at_start + self.started.elapsed()).as_micros() as f64 / 1e6
    }
}

/// Which moment a frame shows.
#[derive(Clone, Copy, Debug)]
struct Moment {
    revision: u64,
    t: f64,
    /// Whether the next moment looks different.
    moves: bool,
    /// What the budget was settled into, if there is one, and how many fronts were measured by then.
    choice: Option<Choice>,
    fronts: u64,
}

/// A drawn frame on its way to the encoder.
type Take = (Drawn, Moment);

impl Caster {
    pub(super) fn new(
        renderer: Renderer,
        versions: watch::Receiver<Entry>,
        broadcast: Arc<Broadcast>,
        news: watch::Sender<News>,
    ) -> Self {
        let clock = Clock::of(&versions.borrow());
        Self { renderer, versions, broadcast, news, clock }
    }

    /// Works until the last watcher has left, the scene is removed, or the server goes down. What is under
    /// way then is cancelled.
    pub(super) async fn run(self) {
        let over = self.broadcast.over.clone();
        // Room for one frame while the one before is encoded; a faster pace would be of no use.
        let (takes, drawn) = mpsc::channel(1);
        tokio::select! {
            () = over.cancelled() => {}
            () = removed(self.versions.clone()) => {}
            ((), ()) = async { tokio::join!(self.draw(takes), self.encode(drawn)) } => {}
        }
    }

    /// Draws a frame whenever there is something new to see, no faster than the stream's pace.
    async fn draw(&self, takes: mpsc::Sender<Take>) {
        let mut pace = ticks(self.broadcast.request.period());
        let mut failures = 0;
        let mut last = None;
        while let Ok(place) = takes.reserve().await {
            pace.tick().await;
            let before = self.versions.borrow().revision;
            match self.draw_now(last).await {
                Ok(take) => {
                    failures = 0;
                    let moment = take.1;
                    last = Some(moment);
                    place.send(take);
                    if !moment.moves {
                        tokio::select! {
                            () = self.another_than(moment.revision) => {}
                            () = self.measured_since(moment) => {}
                        }
                    }
                }
                Err(JobError::Closing) => return,
                Err(error) => {
                    self.tell(error);
                    failures += 1;
                    if timeout(pause(failures), self.another_than(before)).await.is_ok() {
                        failures = 0;
                    }
                }
            }
        }
    }

    /// The scene as it is when its turn comes. A budget's settings stay those of the `last` frame until the scene
    /// is another or something was measured: no picture flickers because its time has changed.
    async fn draw_now(&self, last: Option<Moment>) -> Result<Take, JobError> {
        let (versions, clock, renderer) = (self.versions.clone(), self.clock, self.renderer.clone());
        let request = self.broadcast.request.clone();
        let settle = move || {
            let (scene, revision) = {
                let entry = versions.borrow();
                (Arc::clone(&entry.scene), entry.revision)
            };
            let fronts = *renderer.fronts_measured().borrow();
            let frame = request.at(clock.seconds());
            let (t, moves) = (frame.t, request.runs() && scene.moves());
            let holds = |last: &Moment| last.revision == revision && last.fronts == fronts;
            let (frame, choice) = match last.filter(holds).and_then(|last| last.choice) {
                Some(choice) => (settled(&frame, &choice), Some(choice)),
                None => renderer.to_budget_now(&scene, frame)?,
            };
            Ok((scene, frame, Moment { revision, t, moves, choice, fronts }))
        };
        self.renderer.draw_live(settle).await
    }

    /// Encodes what comes and shows it to all.
    async fn encode(&self, mut takes: mpsc::Receiver<Take>) {
        let mut number = 0;
        while let Some((drawn, Moment { revision, t, choice, .. })) = takes.recv().await {
            number += 1;
            let comment = format!("rasterd frame={number} revision={revision} t={t}");
            match self.renderer.encode_live(drawn, self.broadcast.request.quality(), comment).await {
                Ok(Encoded { jpeg, size, timings, stats, tally }) => {
                    let picture = Picture { number, revision, t, jpeg, size, timings, stats, tally, choice };
                    self.broadcast.pace().push_back(Instant::now());
                    self.news.send_replace(News { picture: Some(Arc::new(picture)), failure: None });
                }
                Err(error) => self.tell(error),
            }
        }
    }

    /// Waits until the scene has another revision; for ever, if it is removed.
    async fn another_than(&self, revision: u64) {
        let mut versions = self.versions.clone();
        if versions.wait_for(|entry| entry.revision != revision).await.is_err() {
            std::future::pending::<()>().await;
        }
    }

    /// Waits until a report has measured what the budget of `moment` was settled without; for ever, if it has none.
    async fn measured_since(&self, moment: Moment) {
        let mut fronts = self.renderer.fronts_measured();
        if moment.choice.is_none() || fronts.wait_for(|count| *count != moment.fronts).await.is_err() {
            std::future::pending::<()>().await;
        }
    }

    fn tell(&self, failure: JobError) {
        tracing::warn!(error = %failure, "a frame of a stream failed");
        self.news.send_modify(|news| news.failure = Some(failure));
    }
}

/// `frame` with the settings of `choice` in place of its budget.
fn settled(frame: &FrameRequest, choice: &Choice) -> FrameRequest {
    FrameRequest { budget: None, ..choice.setting.of_request(frame) }
}

/// Ends when the scene is not there any more.
async fn removed(mut versions: watch::Receiver<Entry>) {
    while versions.changed().await.is_ok() {}
}

/// The first at once, and after a late one a whole period: never two within less.
fn ticks(period: Duration) -> Interval {
    let mut ticks = interval(period);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

/// After the last of so many failures in a row.
fn pause(failures: u32) -> Duration {
    PAUSE.saturating_mul(1 << (failures - 1).min(6)).min(LONGEST_PAUSE)
}
