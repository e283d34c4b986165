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
const STEPS: usize = 20_000;

/// What a frame took, in nanoseconds of one thread, and what was done for it.
struct Frame {
    nanoseconds: f64,
    amounts: [f64; KINDS],
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
        for [width, height] in [[320, 240], [800, 600]].map(|size| size.map(Some)) {
            let request = FrameRequest { width, height, ..FrameRequest::default() };
            let subject = Subject { scene: Arc::clone(&scene), request, limits: Limits::default() };
            frames.extend(measured(&subject, &work)?);
        }
        eprintln!("{name}: {} frames", frames.len());
    }
    let rates = fitted(&frames);
    for ((kind, _), rate) in RATES.iter().zip(rates) {
        println!("{rate:9.3} ns: {kind}");
    }
    let mut off: Vec<f64> = frames.iter().map(|frame| cost(&rates, frame) / frame.nanoseconds).collect();
    off.sort_by(f64::total_cmp);
    let at = |part: usize| off[(off.len() - 1) * part / 100];
    println!("expected / measured: {:.2} in the median, {:.2} to {:.2} for 9 of 10", at(50), at(5), at(95));
    Ok(())
}

/// Frames of `subject` at each preset, and at each value of each knob.
fn measured(subject: &Subject, work: &Work) -> Result<Vec<Frame>, Box<dyn Error>> {
    let own = Setting::of(&Plan::new(&subject.scene, &subject.request, &subject.limits)?);
    let plan = subject.plan(&own)?;
    let presets = Preset::WORDS.iter().map(|(_, preset)| Setting::of_preset(*preset, &plan));
    let knobs = Knob::ALL.into_iter().filter(|knob| knob.check(&plan).is_ok());
    let settings = presets.chain(knobs.flat_map(|knob| knob.turned(own, &plan)));
    let frame = |setting: Setting| -> Result<Frame, Box<dyn Error>> {
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            least = least.min(subject.sample(&setting, work)?.total * 1e6);
        }
        Ok(Frame { nanoseconds: least, amounts: amounts(&setting, &plan) })
    };
    settings.map(frame).collect()
}

fn cost(rates: &[f64; KINDS], frame: &Frame) -> f64 {
    rates.iter().zip(frame.amounts).map(|(rate, amount)| rate * amount).sum()
}

/// Rates of at least 0 with the least squares of relative errors, found one rate at a time.
fn fitted(frames: &[Frame]) -> [f64; KINDS] {
    let mut rates = [0.0; KINDS];
    for step in 0..STEPS * KINDS {
        let kind = step % KINDS;
        let (mut product, mut square) = (0.0, 0.0);
        for frame in frames {
            let part = frame.amounts[kind] / frame.nanoseconds;
            product +=
                part * (1.0 - (cost(&rates, frame) - rates[kind] * frame.amounts[kind]) / frame.nanoseconds);
            square += part * part;
        }
        rates[kind] = if square > 0.0 { (product / square).max(0.0) } else { 0.0 };
    }
    rates
}
