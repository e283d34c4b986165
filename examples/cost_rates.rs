//! What a unit of each kind of work costs, for the model of `src/report/cost.rs`: draws the demo and the gallery at many
//! settings on one thread and fits the times. `cargo run --release --example cost_rates`

use rasterd::limits::Limits;
use rasterd::math::simd::Level;
use rasterd::pipeline::{Order, Work};
use rasterd::plan::request::Preset;
use rasterd::plan::{FrameRequest, Plan};
use rasterd::report::cost::{KINDS, RATES, amounts};
use rasterd::report::{Knob, Setting, Subject};
use rasterd::scene::{NewScene, demo, gallery};
use std::error::Error;
use std::sync::{Arc, atomic::AtomicBool};

/// Times that each setting is drawn; the least counts, as nothing makes a frame faster than it is.
const ROUNDS: usize = 3;

/// Steps of the fit.
const STEPS: usize = 2000;

/// Which passes do which kinds of work.
const PASSES: [(&[&str], &[usize]); 6] = [
    (&["geometry"], &[0]),
    (&["shadow"], &[1, 2]),
    (&["shade", "sky"], &[3, 5, 6, 7, 8]),
    (&["raster", "resolve"], &[4]),
    (&["post"], &[9]),
    (&["resample"], &[10]),
];

/// What a frame and its passes took on one thread, and what was done for it.
struct Frame {
    total: f64,
    passes: Vec<(&'static str, f64)>,
    amounts: [f64; KINDS],
}

impl Frame {
    /// Nanoseconds of some passes.
    fn took(&self, passes: &[&str]) -> f64 {
        self.passes.iter().filter(|(name, _)| passes.contains(name)).map(|(_, ms)| ms * 1e6).sum()
    }

    /// Nanoseconds that some kinds of work should take.
    fn expected(&self, rates: &[f64; KINDS], kinds: &[usize]) -> f64 {
        kinds.iter().map(|&kind| rates[kind] * self.amounts[kind]).sum()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let cancel = AtomicBool::new(false);
    let work = Work { pool: &pool, cancel: &cancel, level: Level::new(), order: Order::Rows };
    let demo =
        NewScene { document: Some(demo::document()), files: Some(demo::files()), ..NewScene::default() };
    let pieces = gallery::pieces().iter().map(|piece| (piece.name, piece.to_scene()));
    let mut frames = Vec::new();
    for (name, scene) in [("demo", demo)].into_iter().chain(pieces) {
        let scene = Arc::new(scene.compile(&Limits::default())?);
        for [width, height] in [[320, 240], [640, 480]].map(|size| size.map(Some)) {
            let request = FrameRequest { width, height, ..FrameRequest::default() };
            let subject = Subject { scene: Arc::clone(&scene), request, limits: Limits::default() };
            frames.extend(measured(&subject, &work)?);
        }
        eprintln!("{name}: {} frames", frames.len());
    }
    let mut rates = [0.0; KINDS];
    for (passes, kinds) in PASSES {
        fit(&mut rates, &frames, passes, kinds);
    }
    let [median, ..] = off(&rates, &frames);
    // Small relative errors are had by saying too little: the median frame gets what it takes.
    let rates = rates.map(|rate| rate / median);
    for ((kind, _), rate) in RATES.iter().zip(rates) {
        println!("{rate:9.3} ns: {kind}");
    }
    let [median, low, high] = off(&rates, &frames);
    println!("expected / measured: {median:.2} in the median, {low:.2} to {high:.2} for 9 of 10");
    Ok(())
}

/// What frames should take over what they take: the median, and the ends of 9 of 10.
fn off(rates: &[f64; KINDS], frames: &[Frame]) -> [f64; 3] {
    let all: Vec<usize> = (0..KINDS).collect();
    let mut off: Vec<f64> = frames.iter().map(|frame| frame.expected(rates, &all) / frame.total).collect();
    off.sort_by(f64::total_cmp);
    [50, 5, 95].map(|part| off[(off.len() - 1) * part / 100])
}

/// Frames of `subject` at each preset, and at each value of each knob.
fn measured(subject: &Subject, work: &Work) -> Result<Vec<Frame>, Box<dyn Error>> {
    let own = Setting::of(&Plan::new(&subject.scene, &subject.request, &subject.limits)?);
    let plan = subject.plan(&own)?;
    let presets = Preset::WORDS.iter().map(|(_, preset)| Setting::of_preset(*preset, &plan));
    let knobs = Knob::ALL.into_iter().filter(|knob| knob.check(&plan).is_ok());
    let settings = presets.chain(knobs.flat_map(|knob| knob.turned(own, &plan)));
    let frame = |setting: Setting| -> Result<Frame, Box<dyn Error>> {
        let samples = (0..ROUNDS).map(|_| subject.sample(&setting, work)).collect::<Result<Vec<_>, _>>()?;
        let best = samples.into_iter().min_by(|a, b| a.total.total_cmp(&b.total)).expect("some rounds");
        Ok(Frame { total: best.total * 1e6, passes: best.passes, amounts: amounts(&setting, &plan) })
    };
    settings.map(frame).collect()
}

/// Finds the rates of some kinds of work, at least 0, with the least squares of what some passes are off by, as a part
/// of the whole frame: one rate at a time, over and over.
fn fit(rates: &mut [f64; KINDS], frames: &[Frame], passes: &[&str], kinds: &[usize]) {
    for step in 0..STEPS * kinds.len() {
        let kind = kinds[step % kinds.len()];
        let (mut product, mut square) = (0.0, 0.0);
        for frame in frames {
            let part = frame.amounts[kind] / frame.total;
            let others = frame.expected(rates, kinds) - rates[kind] * frame.amounts[kind];
            product += part * (frame.took(passes) - others) / frame.total;
            square += part * part;
        }
        rates[kind] = if square > 0.0 { (product / square).max(0.0) } else { 0.0 };
    }
}
