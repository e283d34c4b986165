//! Reports: error against run time of a frame. One is made at a time; all who ask for the same one join it, and
//! its front decides from then on what a budget buys.

use super::{CancelOnDrop, Engine, JobError, Renderer, caught};
use crate::plan::{FrameRequest, Output, Plan};
use crate::report::choose::{Choice, Front, choose};
use crate::report::{Failed, Options, Progress, Report, Setting, Stage, Subject, make};
use crate::scene::Scene;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Weak};
use tokio::sync::{Semaphore, watch};

/// Finished reports that are kept for those who ask again, in another format for instance.
const KEPT: usize = 8;

/// Reports that may wait for their turn, with the scenes that they are about: each takes half a minute or more, so
/// who came last among more of them would long have left.
const WAITING: usize = 4;

impl From<Failed> for JobError {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Plan(error) => Self::Plan(error),
            Failed::Cancelled(cancelled) => cancelled.into(),
        }
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
        // Data has no error, and takes no more or less time.
        if !matches!(request.output, Output::Color | Output::Radiance) {
            return Ok((request, None));
        }
        let plan = self.plan(scene, &request)?;
        let pixels = f64::from(plan.size[0]) * f64::from(plan.size[1]);
        let front = self.fronts.of(scene, &self.with_elisions(&request), pixels);
        let fits =
            |setting: &Setting| Plan::outline(scene, &setting.of_request(&request), &self.limits).is_ok();
        let choice =
            choose(budget, &request, &plan, front.as_deref(), self.pool.current_num_threads(), &fits);
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
        // What is timed spares what frames spare.
        let request = self.with_elisions(request);
        let subject = Subject { scene: Arc::clone(scene), request: request.clone(), limits: self.limits };
        let report = make(&subject, options, tell, &self.work(cancel))?;
        if let Some(front) = Front::of(&report) {
            self.fronts.keep(scene, &request, front);
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

    /// How many fronts reports have measured: with another number, a budget may be settled in another way.
    pub(super) fn fronts_measured(&self) -> watch::Receiver<u64> {
        self.engine.fronts.count()
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

/// How a report has ended, if it has.
type Outcome = Option<Result<Arc<Report>, JobError>>;

/// A report that somebody waits for. With the last of them it is cancelled.
#[derive(Debug)]
struct Job {
    done: watch::Receiver<Outcome>,
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
    /// [`JobError::Plan`], [`JobError::FullOfReports`], [`JobError::Closing`], [`JobError::Panicked`].
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
        let job = self.join(asked, scene).inspect_err(|error| self.0.renderer.count_rejected(error))?;
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

    /// The job that makes what is `asked`; a new one if there is none, and room for one.
    fn join(&self, asked: Asked, scene: Arc<Scene>) -> Result<Arc<Job>, JobError> {
        let mut open = lock(&self.0.open);
        open.retain(|(_, job)| job.strong_count() > 0);
        if let Some(job) = open.iter().find(|(known, _)| *known == asked).and_then(|(_, job)| job.upgrade()) {
            return Ok(job);
        }
        // One of them is under way.
        if open.len() > WAITING {
            return Err(JobError::FullOfReports(WAITING));
        }
        let (finish, done) = watch::channel(None);
        let cancel = CancelOnDrop::default();
        let flag = cancel.flag();
        let job = Arc::new(Job { done, cancel });
        open.push((asked.clone(), Arc::downgrade(&job)));
        tokio::spawn(Arc::clone(&self.0).serve(asked, scene, flag, finish));
        Ok(job)
    }
}

impl Desk {
    /// Makes a report when its turn comes, unless all who wait for it leave before: then it lets its scene go.
    async fn serve(
        self: Arc<Self>,
        asked: Asked,
        scene: Arc<Scene>,
        cancel: Arc<AtomicBool>,
        finish: watch::Sender<Outcome>,
    ) {
        let turn = tokio::select! {
            turn = self.turn.acquire() => turn,
            () = finish.closed() => return,
        };
        let result = match turn {
            Ok(_turn) => self.work(&asked, scene, cancel).await,
            Err(_) => Err(JobError::Closing),
        };
        // Nobody may be left to hear of it.
        let _ = finish.send(Some(result));
    }

    /// Makes a report now.
    async fn work(
        self: &Arc<Self>,
        asked: &Asked,
        scene: Arc<Scene>,
        cancel: Arc<AtomicBool>,
    ) -> Result<Arc<Report>, JobError> {
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

    /// Passes on what a listener can see: another stage, or another percent. The reference alone tells of every
    /// eighth pixel.
    fn tell(&self, name: &str, progress: Progress) {
        self.news.send_if_modified(|news| {
            let is_known =
                news.as_ref().is_some_and(|(known, last)| known == name && look_alike(*last, progress));
            if !is_known {
                *news = Some((name.to_owned(), progress));
            }
            !is_known
        });
    }
}

/// Whether both are in the same stage and at the same whole percent.
fn look_alike(a: Progress, b: Progress) -> bool {
    let percent = |progress: Progress| (progress.done * 100.0).floor();
    a.stage == b.stage && percent(a) == percent(b)
}

/// What a panic while it was held can have left half done is replaced as a whole by the next one.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::tests::{PATIENCE, frame, renderer, scene, settings, until};
    use tokio::task::JoinHandle;

    /// A desk at which somebody else has the turn.
    async fn busy() -> (Reports, tokio::sync::OwnedSemaphorePermit) {
        let renderer = renderer(&settings(0, PATIENCE), Box::new(|_, _| Ok(vec![frame()])));
        let reports = Reports::new(renderer);
        let turn = Arc::clone(&reports.0.turn).acquire_owned().await.expect("not closed");
        (reports, turn)
    }

    /// Options that are equal for equal numbers alone.
    fn options(width: u32) -> Options {
        Options { width, ..Options::default() }
    }

    /// Asks for a report of so many pixels in a row; it waits when this returns.
    async fn asked(reports: &Reports, scene: &Arc<Scene>, width: u32) -> JoinHandle<Result<(), JobError>> {
        let before = waiting(reports);
        let (own, scene) = (reports.clone(), Arc::clone(scene));
        let caller = tokio::spawn(async move {
            own.make(scene, FrameRequest::default(), options(width)).await.map(|_| ())
        });
        until(|| waiting(reports) > before).await;
        caller
    }

    fn waiting(reports: &Reports) -> usize {
        lock(&reports.0.open).iter().filter(|(_, job)| job.strong_count() > 0).count()
    }

    #[tokio::test]
    async fn a_waiting_report_lets_its_scene_go_with_the_last_who_asked() {
        let (reports, _turn) = busy().await;
        let scene = scene();
        let caller = asked(&reports, &scene, 10).await;
        assert!(Arc::strong_count(&scene) > 1);
        caller.abort();
        until(|| Arc::strong_count(&scene) == 1).await;
    }

    #[tokio::test]
    async fn a_waiting_report_ends_with_the_server() {
        let (reports, _turn) = busy().await;
        let scene = scene();
        let caller = asked(&reports, &scene, 10).await;
        reports.close();
        assert!(matches!(caller.await.expect("no panic"), Err(JobError::Closing)));
        until(|| Arc::strong_count(&scene) == 1).await;
    }

    #[tokio::test]
    async fn only_a_few_reports_wait() {
        let (reports, _turn) = busy().await;
        let (scene, width) = (scene(), |i: usize| u32::try_from(i + 1).expect("few"));
        let mut callers = Vec::new();
        for i in 0..=WAITING {
            callers.push(asked(&reports, &scene, width(i)).await);
        }
        let one_more = reports.make(Arc::clone(&scene), FrameRequest::default(), options(width(WAITING + 1)));
        assert!(matches!(one_more.await, Err(JobError::FullOfReports(WAITING))));
        // Who asks for one of those joins it.
        let same =
            Asked { content: scene.content, request: FrameRequest::default(), options: options(width(0)) };
        assert!(reports.join(same, Arc::clone(&scene)).is_ok());
        // And where one has left, there is room for another.
        callers.remove(0).abort();
        until(|| waiting(&reports) == WAITING).await;
        asked(&reports, &scene, width(WAITING + 1)).await;
    }

    #[tokio::test]
    async fn listeners_hear_of_whole_percents_and_of_stages() {
        let (reports, _turn) = busy().await;
        let mut news = reports.news();
        let mut is_told = |name: &str, stage: Stage, done: f64| {
            reports.0.tell(name, Progress { stage, done });
            let told = news.has_changed().expect("a desk");
            news.mark_unchanged();
            told
        };
        assert!(is_told("a", Stage::Reference, 0.0));
        assert!(!is_told("a", Stage::Reference, 0.009));
        assert!(is_told("a", Stage::Reference, 0.011));
        assert!(is_told("a", Stage::Errors, 0.011));
        assert!(is_told("b", Stage::Errors, 0.011));
        assert!(is_told("b", Stage::Errors, 1.0));
    }
}
