//! The bridge between two worlds: tokio does I/O, rayon does pixels.
//!
//! In: a scene, a [`FrameRequest`] and the [`Product`] to make of it. Out: a finished file, or why there
//! is none. A job waits in a bounded [`Queue`], then runs on a thread of its own that drives the shared
//! pool; a frame's deadline and the caller that goes away both set the flag that the tile loop reads.
//!
//! [`Streams`] draw again and again while someone watches, each frame with a turn of its own.

mod broadcast;
mod cancel;
mod draw;
mod error;
mod fronts;
mod product;
mod queue;
mod report;
mod shift;

pub use crate::encode::{Animation, Format};
pub use broadcast::{News, Picture, StreamRequest, Streams, Watcher};
pub(crate) use cancel::CancelOnDrop;
pub use draw::Draw;
pub use error::JobError;
pub use product::{Product, Rendered};
pub use queue::{Queue, QueueDepth};
pub use report::Reports;

use crate::encode;
use crate::limits::Limits;
use crate::metrics::{Metrics, Rejection};
use crate::pipeline::{self, Hit, Order, Work};
use crate::plan::Output;
use crate::plan::request::QueryFault;
use crate::plan::{Elisions, FrameRequest, Plan, PlanError, Tally};
use crate::scene::Scene;
use crate::settings::{Machine, Settings, Simd};
use bytes::Bytes;
use draw::Drawn;
use fearless_simd::Level;
use fronts::Fronts;
use queue::Kind;
use shift::{Clock, Shift};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use tokio::sync::Semaphore;

/// Draws frames, a few at a time, on one pool of threads. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Renderer {
    engine: Arc<Engine>,
    queue: Queue,
    /// One permit for each plan that may be made at the same time without being drawn.
    planners: Arc<Semaphore>,
    deadline: Duration,
}

/// What a stream's frames are encoded as.
const LIVE_FORMAT: Format = Format::Jpeg { quality: Format::DEFAULT_QUALITY };

/// A frame of a stream as it is sent.
#[derive(Debug)]
struct Encoded {
    jpeg: Bytes,
    size: [u32; 2],
    timings: Vec<(&'static str, f64)>,
    stats: Vec<(&'static str, u64)>,
    tally: Tally,
}

/// What every job shares.
struct Engine {
    pool: rayon::ThreadPool,
    /// As many threads again, for what frames are drawn from; see [`Renderer::build`].
    builders: rayon::ThreadPool,
    level: Level,
    elide: Elisions,
    limits: Limits,
    draw: Box<Draw>,
    metrics: Metrics,
    fronts: Fronts,
}

impl Renderer {
    /// A renderer that draws with the pipeline.
    ///
    /// # Errors
    /// When the system refuses the pool's threads.
    pub fn new(settings: &Settings) -> std::io::Result<Self> {
        Self::with_draw(settings, Box::new(pipeline::render_each))
    }

    /// A renderer that draws with `draw` in the pipeline's place: a test's slow, panicking or
    /// counting one.
    ///
    /// # Errors
    /// When the system refuses the pool's threads.
    pub fn with_draw(settings: &Settings, draw: Box<Draw>) -> std::io::Result<Self> {
        Ok(Self {
            engine: Arc::new(Engine::new(&settings.machine, settings.limits(), draw)?),
            queue: Queue::new(settings.renders.get(), usize::from(settings.queue)),
            planners: Arc::new(Semaphore::new(settings.renders.get().min(Semaphore::MAX_PERMITS))),
            deadline: settings.frame_seconds,
        })
    }

    /// Where jobs wait; closing it ends admission.
    #[must_use]
    pub fn queue(&self) -> &Queue {
        &self.queue
    }

    /// The limits that requests are held to.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.engine.limits
    }

    /// What has happened so far.
    #[must_use]
    pub fn metrics(&self) -> &Metrics {
        &self.engine.metrics
    }

    /// Threads that draw.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.engine.pool.current_num_threads()
    }

    /// Makes a file of `request` when its turn comes. Each side of a turntable waits for a turn of its own
    /// and has the deadline's time, this wait included, and so has what makes one file of them. The pictures
    /// of an archive are one frame.
    ///
    /// # Errors
    /// See [`JobError`].
    pub async fn render(
        &self,
        scene: Arc<Scene>,
        request: FrameRequest,
        product: impl Into<Product>,
    ) -> Result<Rendered, JobError> {
        let product = product.into();
        let kind = if product.is_series() { Kind::Series } else { Kind::Single };
        self.run(kind, move |engine, cancel, shift| {
            let mut rendered = engine.render(&scene, &request, product, cancel, Some(shift))?;
            rendered.add_wait(shift.waited());
            Ok(rendered)
        })
        .await
    }

    /// What is at pixel (`x`, `y`) of the frame that `request` asks for.
    ///
    /// # Errors
    /// See [`JobError`].
    pub async fn pick(
        &self,
        scene: Arc<Scene>,
        request: FrameRequest,
        x: u32,
        y: u32,
    ) -> Result<Option<Hit>, JobError> {
        self.run(Kind::Single, move |engine, cancel, _| engine.pick(&scene, &request, x, y, cancel)).await
    }

    /// The ETag that [`Renderer::render`] would answer with, without drawing: it is made of outlines, which
    /// take little time and no memory.
    ///
    /// # Errors
    /// [`JobError::Plan`] and [`JobError::Unfit`] for a request that can't be met, but for what only a whole
    /// plan shows to be too large; [`JobError::Deadline`], [`JobError::Panicked`].
    pub async fn etag(
        &self,
        scene: Arc<Scene>,
        request: FrameRequest,
        product: impl Into<Product>,
    ) -> Result<String, JobError> {
        let product = product.into();
        self.settle(move |engine, cancel| engine.etag(&scene, &request, product, cancel)).await
    }

    /// The plan of the frame that `request` asks for, without drawing it.
    ///
    /// # Errors
    /// [`JobError::Plan`], [`JobError::Deadline`], [`JobError::Panicked`].
    pub async fn plan(&self, scene: Arc<Scene>, request: FrameRequest) -> Result<Plan, JobError> {
        self.settle(move |engine, _| Ok(engine.plan(&scene, &request)?)).await
    }

    /// Runs what only plans, without a turn in the queue of those who draw. As many run at a time as frames
    /// are drawn, each within the deadline.
    async fn settle<T: Send + 'static>(
        &self,
        task: impl FnOnce(&Engine, &AtomicBool) -> Result<T, JobError> + Send + 'static,
    ) -> Result<T, JobError> {
        let clock = Clock::start(self.deadline);
        let turns = Arc::clone(&self.planners);
        let turn = clock.wait(turns.acquire_owned()).await?.map_err(|_| JobError::Closing)?;
        let cancel = CancelOnDrop::default();
        let flag = cancel.flag();
        let engine = Arc::clone(&self.engine);
        let job = tokio::task::spawn_blocking(move || {
            let _turn = turn;
            caught(|| task(&engine, &flag))
        });
        clock.wait(job).await?.map_err(|_| JobError::Panicked)?
    }

    /// Runs `task`, which makes something that frames are drawn from, on threads that do nothing else: as many
    /// as draw. They are not the same, since parts of it run for seconds without a break, and frames that
    /// take turns of milliseconds would stand still for as long.
    pub fn build<T: Send>(&self, task: impl FnOnce() -> T + Send) -> T {
        self.engine.builders.install(task)
    }

    /// Draws what `settle` asks for when the turn of a stream comes, and gives back what that was for: what a
    /// stream shows next is settled as late as can be. A place in the queue is waited for.
    async fn draw_live<T: Send + 'static>(
        &self,
        settle: impl FnOnce() -> Result<(Arc<Scene>, FrameRequest, T), JobError> + Send + 'static,
    ) -> Result<(Drawn, T), JobError> {
        self.run(Kind::Stream, move |engine, cancel, shift| {
            let (scene, request, purpose) = settle()?;
            let format = LIVE_FORMAT.with_quality(request.quality);
            let mut drawn = draw::draw_one(engine, &scene, &request, format, engine.work(cancel))?;
            drawn.timings.insert(0, ("queue", draw::milliseconds(shift.waited())));
            Ok((drawn, purpose))
        })
        .await
    }

    /// The JPEG of a frame of a stream. It needs no turn: there is one for each frame that had one.
    async fn encode_live(&self, drawn: Drawn, quality: u8, comment: String) -> Result<Encoded, JobError> {
        let cancel = CancelOnDrop::default();
        let flag = cancel.flag();
        let engine = Arc::clone(&self.engine);
        let job = tokio::task::spawn_blocking(move || {
            caught(|| {
                let began = Instant::now();
                let Drawn { frame, mut timings, stats, tally } = drawn;
                let work = engine.work(&flag);
                let jpeg = encode::jpeg_with_comment(&frame, quality, &comment, &work)?;
                let encode = [("encode", draw::milliseconds(began.elapsed()))];
                engine.metrics.observe_passes(encode);
                timings.extend(encode);
                let size = [frame.width, frame.height];
                Ok(Encoded { jpeg: jpeg.into(), size, timings, stats, tally })
            })
        });
        job.await.map_err(|_| JobError::Panicked)?
    }

    /// Makes a file on this thread, now: the same bytes without queue and deadline.
    ///
    /// # Errors
    /// [`JobError::Plan`], [`JobError::Unfit`] and [`JobError::Panicked`].
    pub fn render_now(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        product: impl Into<Product>,
    ) -> Result<Rendered, JobError> {
        let product = product.into();
        caught(|| self.engine.render(scene, request, product, &AtomicBool::new(false), None))
    }

    /// Runs `task` on a blocking thread when its turn comes, the first of a series or the only one. Dropping the
    /// returned future cancels it. The turn ends with the task itself, not with the caller's patience.
    async fn run<T: Send + 'static>(
        &self,
        kind: Kind,
        task: impl FnOnce(&Engine, &AtomicBool, &mut Shift) -> Result<T, JobError> + Send + 'static,
    ) -> Result<T, JobError> {
        let arrived = Instant::now();
        // Not within the deadline: many streams are slow streams, and none of them fails for that.
        let line = self.queue.line_up(kind).await?;
        let clock = Arc::new(Clock::start(self.deadline));
        let turn =
            clock.wait(self.queue.turn(line)).await?.inspect_err(|error| self.count_rejected(error))?;
        let mut shift = Shift::new(turn, Arc::clone(&clock), arrived.elapsed());
        self.metrics().observe_wait(shift.waited());

        let cancel = CancelOnDrop::default();
        let flag = cancel.flag();
        let engine = Arc::clone(&self.engine);
        let job = tokio::task::spawn_blocking(move || {
            let done = caught(|| task(&engine, &flag, &mut shift));
            if matches!(done, Err(JobError::Cancelled)) {
                engine.metrics.jobs_cancelled.inc();
            }
            done
        });
        clock.wait(job).await?.map_err(|_| JobError::Panicked)?
    }

    fn count_rejected(&self, error: &JobError) {
        match error {
            JobError::Full(_) | JobError::FullOfReports(_) => {
                self.metrics().jobs_rejected(Rejection::Full).inc()
            }
            JobError::Closing => self.metrics().jobs_rejected(Rejection::Closing).inc(),
            _ => {}
        }
    }
}

impl Engine {
    fn new(machine: &Machine, limits: Limits, draw: Box<Draw>) -> std::io::Result<Self> {
        let (pool, builders) = (pool(machine, "draw")?, pool(machine, "build")?);
        let level = machine.simd.unwrap_or_else(Simd::best).level();
        Ok(Self {
            pool,
            builders,
            level,
            elide: machine.elide,
            limits,
            draw,
            metrics: Metrics::default(),
            fronts: Fronts::default(),
        })
    }

    fn plan(&self, scene: &Arc<Scene>, request: &FrameRequest) -> Result<Plan, PlanError> {
        Plan::new(scene, &self.with_elisions(request), &self.limits)
    }

    /// `request`, which spares what the program was started to spare if it says nothing of that itself.
    fn with_elisions(&self, request: &FrameRequest) -> FrameRequest {
        FrameRequest { elide: Some(request.elide.unwrap_or(self.elide)), ..request.clone() }
    }

    fn work<'a>(&'a self, cancel: &'a AtomicBool) -> Work<'a> {
        Work { pool: &self.pool, cancel, level: self.level, order: Order::Rows }
    }

    fn render(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        product: Product,
        cancel: &AtomicBool,
        shift: Option<&mut Shift>,
    ) -> Result<Rendered, JobError> {
        draw::make(self, scene, request, &product.settled(request), self.work(cancel), shift)
    }

    fn etag(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        product: Product,
        cancel: &AtomicBool,
    ) -> Result<String, JobError> {
        draw::etag(self, scene, request, &product.settled(request), self.work(cancel))
    }

    fn pick(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        x: u32,
        y: u32,
        cancel: &AtomicBool,
    ) -> Result<Option<Hit>, JobError> {
        // A pixel is asked at its centre, whatever the picture's samples are.
        let request = FrameRequest { output: Output::Instance, ..request.clone() };
        let plan = self.plan(scene, &request)?;
        let faults = outside("x", x, plan.view.width).into_iter().chain(outside("y", y, plan.view.height));
        let faults: Vec<QueryFault> = faults.collect();
        if faults.is_empty() {
            Ok(crate::pipeline::pick(&plan, x, y, &self.work(cancel))?)
        } else {
            Err(JobError::Plan(PlanError::Query(faults)))
        }
    }
}

/// Threads called `name`, as many as `machine` has for drawing.
fn pool(machine: &Machine, name: &'static str) -> std::io::Result<rayon::ThreadPool> {
    // 0 is rayon's word for "as many as the machine runs at once".
    let threads = machine.threads.map_or(0, std::num::NonZeroUsize::get);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(move |index| format!("{name}-{index}"))
        // A panic that no scope carries to its caller would abort the process otherwise.
        .panic_handler(|_| tracing::error!("a thread of a pool panicked"))
        .build()
        .map_err(std::io::Error::other)
}

/// The fault of a pixel coordinate that the picture does not have.
fn outside(parameter: &str, value: u32, side: u32) -> Option<QueryFault> {
    (value >= side).then(|| {
        QueryFault::new(parameter, format!("must lie in [0, {}], is {value}", side.saturating_sub(1)))
    })
}

/// `task`'s answer; its panic becomes an error. Nothing of a job outlives it but counters and
/// permits, so there is no state that a panic could leave broken.
fn caught<T>(task: impl FnOnce() -> Result<T, JobError>) -> Result<T, JobError> {
    catch_unwind(AssertUnwindSafe(task)).unwrap_or_else(|_| {
        tracing::error!("a job panicked");
        Err(JobError::Panicked)
    })
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("pool", &self.pool).field("level", &self.level).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
