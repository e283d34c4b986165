use super::*;
use crate::pipeline::{Frame, Pixels};
use crate::scene::{ModelOptions, NewScene, UpAxis};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread::sleep;

const TICK: Duration = Duration::from_millis(5);
pub(super) const PATIENCE: Duration = Duration::from_secs(10);

pub(super) fn scene() -> Arc<Scene> {
    let new = NewScene {
        document: Some(serde_json::json!({})),
        files: None,
        options: ModelOptions { up: UpAxis::Y, floor: false },
    };
    Arc::new(new.compile(&Limits::default()).expect("an empty document is a scene"))
}

/// Two slots' worth of settings in one: one frame runs, `queue` wait.
pub(super) fn settings(queue: u16, deadline: Duration) -> Settings {
    let machine = Machine { threads: Some(std::num::NonZeroUsize::MIN), ..Machine::default() };
    Settings {
        renders: std::num::NonZeroUsize::MIN,
        queue,
        frame_seconds: deadline,
        machine,
        ..Settings::default()
    }
}

pub(super) fn renderer(settings: &Settings, draw: Box<Draw>) -> Renderer {
    Renderer::with_draw(settings, draw).expect("a pool")
}

/// Draws until it is cancelled and says so.
fn endless(ended: mpsc::Sender<()>) -> Box<Draw> {
    let ended = std::sync::Mutex::new(ended);
    Box::new(move |_, work| {
        while !work.cancel.load(Ordering::Relaxed) {
            sleep(TICK);
        }
        ended.lock().expect("one sender at a time").send(()).expect("a listening test");
        Err(crate::pipeline::Cancelled)
    })
}

/// One black pixel.
pub(super) fn frame() -> Frame {
    Frame {
        width: 1,
        height: 1,
        pixels: Pixels::Rgba8 { pixels: vec![[0, 0, 0, 255]], opaque: true },
        stats: pipeline::Stats::default(),
        timings: pipeline::Timings::default(),
        depth_range: None,
    }
}

async fn ask(renderer: &Renderer) -> Result<Rendered, JobError> {
    renderer.render(scene(), FrameRequest::default(), Format::Png).await
}

pub(super) async fn until(condition: impl Fn() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !condition() {
        assert!(Instant::now() < end, "waited in vain");
        tokio::time::sleep(TICK).await;
    }
}

#[tokio::test]
async fn a_deadline_cancels_the_job() {
    let (ended, end) = mpsc::channel();
    let renderer = renderer(&settings(0, Duration::from_millis(30)), endless(ended));
    assert!(matches!(ask(&renderer).await, Err(JobError::Deadline(_))));
    end.recv_timeout(PATIENCE).expect("the job was cancelled");
}

#[tokio::test]
async fn a_caller_that_leaves_cancels_its_job_and_frees_the_slot() {
    let (ended, end) = mpsc::channel();
    let renderer = renderer(&settings(0, PATIENCE), endless(ended));
    let caller = tokio::spawn({
        let renderer = renderer.clone();
        async move { ask(&renderer).await.map(|_| ()) }
    });
    until(|| renderer.queue().depth().running == 1).await;
    caller.abort();
    tokio::task::spawn_blocking(move || end.recv_timeout(PATIENCE))
        .await
        .expect("no panic")
        .expect("cancelled");
    until(|| renderer.queue().depth() == QueueDepth { running: 0, waiting: 0 }).await;
}

#[tokio::test]
async fn one_more_than_the_queue_holds_is_refused_at_once() {
    let (ended, _end) = mpsc::channel();
    let renderer = renderer(&settings(1, PATIENCE), endless(ended));
    let callers: Vec<_> = (0..2)
        .map(|_| {
            let renderer = renderer.clone();
            tokio::spawn(async move { ask(&renderer).await.map(|_| ()) })
        })
        .collect();
    until(|| renderer.queue().depth() == QueueDepth { running: 1, waiting: 1 }).await;
    assert!(matches!(ask(&renderer).await, Err(JobError::Full(1))));
    callers.iter().for_each(tokio::task::JoinHandle::abort);
}

#[tokio::test]
async fn a_closed_queue_refuses_but_finishes_what_it_has() {
    let (go, gate) = mpsc::channel::<()>();
    let gate = std::sync::Mutex::new(gate);
    let draw: Box<Draw> = Box::new(move |_, _| {
        gate.lock().expect("one job at a time").recv_timeout(PATIENCE).expect("let go");
        Ok(vec![frame()])
    });
    let renderer = renderer(&settings(1, PATIENCE), draw);
    let callers: Vec<_> = (0..2)
        .map(|_| {
            let renderer = renderer.clone();
            tokio::spawn(async move { ask(&renderer).await.map(|_| ()) })
        })
        .collect();
    until(|| renderer.queue().depth() == QueueDepth { running: 1, waiting: 1 }).await;
    renderer.queue().close();
    assert!(matches!(ask(&renderer).await, Err(JobError::Closing)));
    go.send(()).expect("a waiting job");
    go.send(()).expect("a waiting job");
    for caller in callers {
        caller.await.expect("no panic").expect("finished");
    }
}

#[tokio::test]
async fn a_panic_is_an_error_and_the_next_frame_is_drawn() {
    let calls = AtomicUsize::new(0);
    let draw: Box<Draw> = Box::new(move |_, work| {
        assert!(calls.fetch_add(1, Ordering::Relaxed) > 0, "the first frame panics");
        Ok(vec![work.pool.install(frame)])
    });
    let renderer = renderer(&settings(0, PATIENCE), draw);
    assert!(matches!(ask(&renderer).await, Err(JobError::Panicked)));
    let rendered = ask(&renderer).await.expect("a picture");
    assert!(rendered.timing("queue").is_some() && rendered.timing("total").is_some());
}

#[tokio::test]
async fn a_panic_on_the_pool_is_an_error_too() {
    let draw: Box<Draw> = Box::new(|_, work| work.pool.install(|| panic!("on the pool")));
    let renderer = renderer(&settings(0, PATIENCE), draw);
    assert!(matches!(ask(&renderer).await, Err(JobError::Panicked)));
}

#[tokio::test]
async fn the_etag_needs_no_turn() {
    let (ended, _end) = mpsc::channel();
    let renderer = renderer(&settings(0, PATIENCE), endless(ended));
    let caller = tokio::spawn({
        let renderer = renderer.clone();
        async move { ask(&renderer).await.map(|_| ()) }
    });
    until(|| renderer.queue().depth().running == 1).await;
    assert!(
        renderer.etag(scene(), FrameRequest::default(), Format::Png).await.expect("an ETag").starts_with('"')
    );
    caller.abort();
}

#[tokio::test]
async fn tags_are_made_a_few_at_a_time_and_have_a_deadline() {
    let renderer = renderer(&settings(0, TICK), Box::new(|_, _| Ok(vec![frame()])));
    let all = Arc::clone(&renderer.planners).acquire_owned().await.expect("never closed");
    let tag = || renderer.etag(scene(), FrameRequest::default(), Format::Png);
    assert!(matches!(tag().await, Err(JobError::Deadline(TICK))));
    drop(all);
    let patient = Renderer { deadline: PATIENCE, ..renderer.clone() };
    patient.etag(scene(), FrameRequest::default(), Format::Png).await.expect("an ETag");
}

/// A turntable of so many frames.
fn turn(frames: u32) -> Product {
    Product::Turntable { frames, format: Animation::Gif }
}

/// A renderer for one frame at a time that notes the widths of frames in the order in which they are drawn;
/// it draws the first once there is a message at the gate.
fn noting(deadline: Duration) -> (Renderer, mpsc::Sender<()>, Arc<Mutex<Vec<u32>>>) {
    let drawn = Arc::new(Mutex::new(Vec::new()));
    let (go, gate) = mpsc::channel();
    let gate = Mutex::new(gate);
    let note = Arc::clone(&drawn);
    let draw: Box<Draw> = Box::new(move |plans, _| {
        let mut drawn = note.lock().expect("one frame at a time");
        if drawn.is_empty() {
            gate.lock().expect("one frame at a time").recv_timeout(PATIENCE).expect("let go");
        }
        drawn.push(plans[0].view.width);
        Ok(vec![frame()])
    });
    (renderer(&settings(4, deadline), draw), go, drawn)
}

/// Asks for `product` of `width` pixels in a row, for which it has taken its place when this returns.
async fn asked(
    renderer: &Renderer,
    width: u32,
    product: impl Into<Product>,
) -> tokio::task::JoinHandle<Result<Rendered, JobError>> {
    let (before, own, product) = (renderer.queue().depth(), renderer.clone(), product.into());
    let request = FrameRequest { width: Some(width), ..FrameRequest::default() };
    let caller = tokio::spawn(async move { own.render(scene(), request, product).await });
    let inside = |depth: QueueDepth| depth.running + depth.waiting;
    until(|| inside(renderer.queue().depth()) > inside(before)).await;
    caller
}

#[tokio::test]
async fn single_frames_have_their_turn_between_those_of_a_series() {
    let (renderer, go, drawn) = noting(PATIENCE);
    let callers = [
        asked(&renderer, 1, turn(3)).await,
        asked(&renderer, 2, turn(2)).await,
        asked(&renderer, 3, Format::Png).await,
        asked(&renderer, 4, Format::Png).await,
    ];
    go.send(()).expect("a waiting job");
    for caller in callers {
        let rendered = caller.await.expect("no panic").expect("a file");
        assert!(rendered.timing("queue").is_some());
    }
    // One series at a time: what it has drawn takes memory until it is done.
    assert_eq!(*drawn.lock().expect("no panic"), [1, 3, 4, 1, 1, 2, 2]);
    assert_eq!(renderer.queue().depth(), QueueDepth { running: 0, waiting: 0 });
}

#[tokio::test]
async fn a_series_may_take_longer_than_one_of_its_frames() {
    let deadline = Duration::from_millis(400);
    let draw: Box<Draw> = Box::new(|_, _| {
        sleep(Duration::from_millis(80));
        Ok(vec![frame()])
    });
    let renderer = renderer(&settings(0, deadline), draw);
    let began = Instant::now();
    renderer.render(scene(), FrameRequest::default(), turn(8)).await.expect("no frame was late");
    assert!(began.elapsed() > deadline);
}

#[tokio::test]
async fn a_late_frame_ends_its_series() {
    let (ended, end) = mpsc::channel();
    let late = endless(ended);
    let drawn = AtomicUsize::new(0);
    let draw: Box<Draw> = Box::new(move |plans, work| match drawn.fetch_add(1, Ordering::Relaxed) {
        0 | 1 => Ok(vec![frame()]),
        _ => late(plans, work),
    });
    let renderer = renderer(&settings(0, Duration::from_millis(200)), draw);
    let outcome = renderer.render(scene(), FrameRequest::default(), turn(8)).await;
    assert!(matches!(outcome, Err(JobError::Deadline(_))));
    end.recv_timeout(PATIENCE).expect("the job was cancelled");
}

#[test]
fn frames_that_wait_for_the_last_count_with_what_that_takes() {
    let pixels = 800 * 600;
    let scene = scene();
    let plan = Plan::new(&scene, &FrameRequest::default(), &Limits::default()).expect("a plan");
    let archive = Product::Archive { outputs: vec![Output::Color, Output::Instance] };
    let apng = Product::Turntable { frames: 3, format: Animation::Apng };
    let instances = FrameRequest { output: Output::Instance, ..FrameRequest::default() };
    let instances = Plan::new(&scene, &instances, &Limits::default()).expect("a plan");
    // Both pictures of the archive are under way at once, over the same triangles.
    let beside = instances.bytes() - instances.geometry_bytes();
    assert!(beside > 0);
    for (product, held) in [(turn(3), 15 * pixels), (apng, 12 * pixels), (archive, 16 * pixels + beside)] {
        let outcome = |max_frame_bytes: u64| {
            let settings = Settings { max_frame_bytes, ..settings(0, PATIENCE) };
            let draw: Box<Draw> = Box::new(|plans, _| Ok(plans.iter().map(|_| frame()).collect()));
            renderer(&settings, draw).render_now(&scene, &FrameRequest::default(), product.clone())
        };
        outcome(held + plan.bytes()).expect("just enough");
        let refused = outcome(held + plan.bytes() - 1);
        assert!(matches!(refused, Err(JobError::Plan(PlanError::TooLarge { .. }))), "{product:?}");
    }
}

#[test]
fn a_turn_of_depths_without_a_range_is_refused_before_a_side_is_drawn() {
    let document = serde_json::json!({
        "camera": { "position": [0, 0, 5] },
        "meshes": { "plank": { "type": "box", "size": [1, 1, 4] } },
        "instances": { "a": { "mesh": "plank" } },
    });
    let new = NewScene { document: Some(document), ..NewScene::default() };
    let scene = Arc::new(new.compile(&Limits::default()).expect("a scene"));
    let draw: Box<Draw> = Box::new(|_, _| panic!("nothing is to be drawn"));
    let renderer = renderer(&settings(0, PATIENCE), draw);
    let request = FrameRequest { output: Output::Depth, ..FrameRequest::default() };
    let product = Product::Turntable { frames: 3, format: Animation::Apng };
    let outcome = renderer.render_now(&scene, &request, product);
    assert!(
        matches!(&outcome, Err(JobError::Plan(PlanError::Query(faults))) if faults[0].parameter == "far"),
        "{outcome:?}"
    );
}

#[tokio::test]
async fn archives_that_differ_in_their_description_alone_differ_in_their_tag() {
    let scene = scene();
    let draw: Box<Draw> = Box::new(|plans, _| Ok(plans.iter().map(|_| frame()).collect()));
    let renderer = renderer(&settings(0, PATIENCE), draw);
    let derived = FrameRequest { ortho_height: Some(4.0), near: Some(1.0), ..FrameRequest::default() };
    let outline = Plan::outline(&scene, &derived, renderer.limits()).expect("an outline");
    let given = FrameRequest { far: Some(outline.view.far), ..derived.clone() };
    let same = Plan::outline(&scene, &given, renderer.limits()).expect("an outline");
    assert_eq!(same.etag(), outline.etag());
    let mut files = Vec::new();
    for request in [derived, given] {
        let product = Product::Archive { outputs: vec![Output::Color] };
        let file = renderer.render_now(&scene, &request, product.clone()).expect("an archive");
        let tag = renderer.etag(Arc::clone(&scene), request, product).await.expect("an ETag");
        assert_eq!(file.etag, tag);
        files.push(file);
    }
    assert!(files[0].bytes != files[1].bytes && files[0].etag != files[1].etag);
}

#[test]
fn what_is_built_is_built_on_as_many_threads_as_draw() {
    let machine = Machine { threads: std::num::NonZeroUsize::new(3), ..Machine::default() };
    let settings = Settings { machine, ..Settings::default() };
    let renderer = renderer(&settings, Box::new(|_, _| Ok(vec![frame()])));
    assert_eq!(renderer.build(rayon::current_num_threads), 3);
}

#[test]
fn what_the_program_was_started_to_spare_holds_where_a_request_says_nothing() {
    let machine = Machine { elide: Elisions::NONE, ..Machine::default() };
    let settings = Settings { machine, ..Settings::default() };
    let renderer = renderer(&settings, Box::new(|_, _| Ok(vec![frame()])));
    let spared =
        |elide| renderer.engine.with_elisions(&FrameRequest { elide, ..FrameRequest::default() }).elide;
    assert_eq!(spared(None), Some(Elisions::NONE));
    assert_eq!(spared(Some(Elisions::ALL)), Some(Elisions::ALL));
}
