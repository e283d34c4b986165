//! Reports: error against run time of a frame. One is made at a time; all who ask for the same one join it, and
//! its front decides from then on what a budget buys.

use super::{CancelOnDrop, Engine, JobError, Renderer, caught};
use crate::plan::FrameRequest;
use crate::report::choose::{Choice, Front, choose};
use crate::report::{Failed, Options, Progress, Report, Stage, Subject, make};
use crate::scene::Scene;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Weak};
use tokio::sync::{Semaphore, watch};

/// Finished reports that are kept for those who ask again, in another format for instance.
const KEPT: usize = 8;

/// Scenes whose fronts are kept.
const FRONTS: usize = 64;

impl From<Failed> for JobError {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Plan(error) => Self::Plan(error),
            Failed::Cancelled(cancelled) => cancelled.into(),
        }
    }
}

/// The fronts of the scenes that were measured last, by content.
#[derive(Debug, Default)]
pub(super) struct Fronts(Mutex<VecDeque<([u8; 32], Arc<Front>)>>);

impl Fronts {
    fn of(&self, scene: &Scene) -> Option<Arc<Front>> {
        let fronts = lock(&self.0);
        fronts.iter().find(|(content, _)| *content == scene.content).map(|(_, front)| Arc::clone(front))
    }

    fn keep(&self, scene: &Scene, front: Front) {
        let mut fronts = lock(&self.0);
        fronts.retain(|(content, _)| *content != scene.content);
        fronts.push_front((scene.content, Arc::new(front)));
        fronts.truncate(FRONTS);
    }
}

impl Engine {
    /// `request` with the settings that its budget buys, and what is to be expected of them; without a budget, as
    /// it is.
    fn to_budget(
        &self,
        scene: &Arc<Scene>,
        request: FrameRequest,
    ) -> Result<(FrameRequest, Option<Choice>), JobError> {
        let Some(budget) = request.budget else { return Ok((request, None)) };
        let request = FrameRequest { budget: None, ..request };
        let plan = self.plan(scene, &request)?;
        let front = self.fronts.of(scene);
        let choice = choose(budget, &request, &plan, front.as_deref(), self.pool.current_num_threads());
        Ok((choice.setting.of_request(&request), Some(choice)))
    }

    fn report(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        options: &Options,
        tell: &(dyn Fn(Progress) + Sync),
        cancel: &AtomicBool,
    ) -> Result<Report, JobError> {
        let subject = Subject { scene: Arc::clone(scene), request: request.clone(), limits: self.limits };
        let report = make(&subject, options, tell, &self.work(cancel))?;
        if let Some(front) = Front::of(&report) {
            self.fronts.keep(scene, front);
        }
        Ok(report)
    }
}

impl Renderer {
    /// `request` with the settings that its budget buys, and what is to be expected of them; without a budget, as
    /// it is.
    ///
    /// # Errors
    /// [`JobError::Plan`], [`JobError::Deadline`], [`JobError::Panicked`].
    pub async fn to_budget(
        &self,
        scene: &Arc<Scene>,
        request: FrameRequest,
    ) -> Result<(FrameRequest, Option<Choice>), JobError> {
        if request.budget.is_none() {
            return Ok((request, None));
        }
        let scene = Arc::clone(scene);
        self.settle(move |engine, _| engine.to_budget(&scene, request)).await
    }

    /// The same on this thread, now.
    ///
    /// # Errors
    /// [`JobError::Plan`] and [`JobError::Panicked`].
    pub fn to_budget_now(
        &self,
        scene: &Arc<Scene>,
        request: FrameRequest,
    ) -> Result<(FrameRequest, Option<Choice>), JobError> {
        caught(|| self.engine.to_budget(scene, request))
    }

    /// Makes a report on this thread, now; `tell` is told how far it is.
    ///
    /// # Errors
    /// [`JobError::Plan`] and [`JobError::Panicked`].
    pub fn report_now(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        options: &Options,
        tell: &(dyn Fn(Progress) + Sync),
    ) -> Result<Report, JobError> {
        caught(|| self.engine.report(scene, request, options, tell, &AtomicBool::new(false)))
    }
}

/// Makes reports, one at a time. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Reports(Arc<Desk>);

#[derive(Debug)]
struct Desk {
    renderer: Renderer,
    /// One permit: whoever measures needs the machine for himself.
    turn: Arc<Semaphore>,
    /// Under way or waiting; what nobody waits for any more is gone.
    open: Mutex<Vec<(Asked, Weak<Job>)>>,
    /// The last ones, the newest first.
    finished: Mutex<VecDeque<(Asked, Arc<Report>)>>,
    /// How far the one under way is, with the scene's name.
    news: watch::Sender<Option<(String, Progress)>>,
}

/// What a report is about. Who asks for the same gets the same.
#[derive(Clone, Debug, PartialEq)]
struct Asked {
    content: [u8; 32],
    request: FrameRequest,
    options: Options,
}

/// A report that somebody waits for. With the last of them it is cancelled.
#[derive(Debug)]
struct Job {
    done: watch::Receiver<Option<Result<Arc<Report>, JobError>>>,
    cancel: CancelOnDrop,
}

impl Reports {
    /// Reports by `renderer`, on its threads.
    #[must_use]
    pub fn new(renderer: Renderer) -> Self {
        let desk = Desk {
            renderer,
            turn: Arc::new(Semaphore::new(1)),
            open: Mutex::default(),
            finished: Mutex::default(),
            news: watch::Sender::new(None),
        };
        Self(Arc::new(desk))
    }

    /// The report on the frame that `request` asks for: one that is there, one under way, or a new one, which waits
    /// for its turn. Who drops the returned future leaves it; the last one's leaving cancels it.
    ///
    /// # Errors
    /// [`JobError::Plan`], [`JobError::Closing`], [`JobError::Panicked`].
    pub async fn make(
        &self,
        scene: Arc<Scene>,
        request: FrameRequest,
        options: Options,
    ) -> Result<Arc<Report>, JobError> {
        let asked = Asked { content: scene.content, request, options };
        if let Some(report) = self.finished(&asked) {
            return Ok(report);
        }
        let job = self.join(asked, scene);
        let mut done = job.done.clone();
        let result = done.wait_for(Option::is_some).await.map_err(|_| JobError::Closing)?.clone();
        result.unwrap_or(Err(JobError::Closing))
    }

    /// How far the report under way is, and on which scene it is.
    #[must_use]
    pub fn news(&self) -> watch::Receiver<Option<(String, Progress)>> {
        self.0.news.subscribe()
    }

    /// Takes no more reports, and stops the one under way: it may have minutes to go.
    pub fn close(&self) {
        self.0.turn.close();
        for job in lock(&self.0.open).iter().filter_map(|(_, job)| job.upgrade()) {
            job.cancel.flag().store(true, Ordering::Relaxed);
        }
    }

    fn finished(&self, asked: &Asked) -> Option<Arc<Report>> {
        let finished = lock(&self.0.finished);
        finished.iter().find(|(known, _)| known == asked).map(|(_, report)| Arc::clone(report))
    }

    /// The job that makes what is `asked`; a new one if there is none.
    fn join(&self, asked: Asked, scene: Arc<Scene>) -> Arc<Job> {
        let mut open = lock(&self.0.open);
        open.retain(|(_, job)| job.strong_count() > 0);
        if let Some(job) = open.iter().find(|(known, _)| *known == asked).and_then(|(_, job)| job.upgrade()) {
            return job;
        }
        let (finish, done) = watch::channel(None);
        let cancel = CancelOnDrop::default();
        let flag = cancel.flag();
        let job = Arc::new(Job { done, cancel });
        open.push((asked.clone(), Arc::downgrade(&job)));
        let desk = Arc::clone(&self.0);
        tokio::spawn(async move {
            let result = desk.work(&asked, scene, flag).await;
            // Nobody may be left to hear of it.
            let _ = finish.send(Some(result));
        });
        job
    }
}

impl Desk {
    /// Makes a report when its turn comes.
    async fn work(
        self: &Arc<Self>,
        asked: &Asked,
        scene: Arc<Scene>,
        cancel: Arc<AtomicBool>,
    ) -> Result<Arc<Report>, JobError> {
        let _turn = self.turn.acquire().await.map_err(|_| JobError::Closing)?;
        let (desk, asked_for) = (Arc::clone(self), asked.clone());
        let job = tokio::task::spawn_blocking(move || {
            let tell = |progress| desk.tell(&asked_for.options.name, progress);
            let engine = &desk.renderer.engine;
            caught(|| engine.report(&scene, &asked_for.request, &asked_for.options, &tell, &cancel))
        });
        let result = job.await.map_err(|_| JobError::Panicked)?;
        if self.turn.is_closed() {
            return Err(JobError::Closing);
        }
        self.tell(&asked.options.name, Progress { stage: Stage::Timing, done: 1.0 });
        let report = Arc::new(result?);
        let mut finished = lock(&self.finished);
        finished.push_front((asked.clone(), Arc::clone(&report)));
        finished.truncate(KEPT);
        Ok(report)
    }

    fn tell(&self, name: &str, progress: Progress) {
        self.news.send_replace(Some((name.to_owned(), progress)));
    }
}

/// What a panic while it was held can have left half done is replaced as a whole by the next one.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
