//! How a report comes about, within its budget.

use super::component;
use super::determinism::{self, Determinism};
use super::error::{PictureError, Standard};
use super::front::{self, Between, Place};
use super::machine::Machine;
use super::options::Options;
use super::reference::{Aim, Effort, Reference};
use super::schedule::{Schedule, Stage, Tell};
use super::selftest::instruments::engine::Engine;
use super::selftest::{self, Case, Measurement};
use super::setting::{Knob, Setting};
use super::statistics::median;
use super::subject::{self, Drawn, Subject};
use super::sweep::{Candidate, Family, Sweep};
use super::timing::{self, Sample, Timing};
use super::{AtTime, Failed, Meta, Parts, Point, Report, Threads, Truth};
use crate::limits::Limits;
use crate::pipeline::{Cancelled, Work};
use crate::plan::request::Preset;
use crate::plan::{Elisions, FrameRequest, Output, Plan, PlanError, QueryFault};
use crate::settings::Simd;
use std::time::Instant;

/// Parts of the time that is left when a stage begins, which it may take.
const REFERENCE: f64 = 0.35;
const ERRORS: f64 = 0.25;
const PARTS: f64 = 0.1;
const COMPONENTS: f64 = 0.35;
const TIMING: f64 = 0.8;
const THREADS: f64 = 0.5;

/// How good the reference is where the time suffices.
const EFFORT: Effort = Effort { base: 4, most: 1024, noise: 5e-4, aim: Aim::Pixel };

/// Every setting but the default and its control is timed so often, or not at all; of fewer samples no interval is
/// known.
const LEAST_ROUNDS: usize = 5;

/// Errors that times are told for, in steps of a code.
const REACHED_CODES: [f64; 3] = [1.0, 2.0, 4.0];

/// Milliseconds that errors are told for.
const EQUAL_TIMES: [f64; 3] = [16.0, 33.0, 100.0];

/// Makes a report about the frame that `subject` asks for, in a size of its own.
///
/// # Errors
/// [`Failed`].
pub fn make(subject: &Subject, options: &Options, tell: Tell, work: &Work) -> Result<Report, Failed> {
    let making = Making::begin(subject, options, tell, work)?;
    let (truth, seconds) = making.draw_reference()?;
    let standard = Standard::new(truth, &making.subject.scene);
    let errors = making.errors(&standard)?;
    let parts = making.parts(&standard, &errors[0].0)?;
    let fits = making.fits(seconds / samples_of(&standard.reference))?;
    let samples = making.time(errors.len())?;
    let threads = making.threads()?;
    let determinism = making.determinism()?;
    let stability = making.stability()?;

    let truth = &standard.reference;
    let measured = making.sweep.candidates.iter().zip(errors).zip(&samples);
    let mut points: Vec<Point> = measured
        .map(|((candidate, erred), samples)| making.point(candidate, erred, samples, truth.noise))
        .collect();
    let front = mark_front(&mut points, truth.noise);
    let aa_ratio = timing::ratio(&samples[1], &samples[0]);
    Ok(Report {
        meta: making.meta(samples[0].len()),
        reference: told(truth, seconds),
        fits,
        left_out: making.sweep.left_out.clone(),
        unfinished: making.unfinished(&points),
        reach: REACHED_CODES.map(|codes| reach(codes / 255.0, &front)).to_vec(),
        equal_time: EQUAL_TIMES.map(|ms| AtTime { ms, error: front::error_at(ms, &front) }).to_vec(),
        front,
        parts,
        threads,
        determinism,
        stability,
        aa_holds: (samples[0].len() >= LEAST_ROUNDS).then(|| aa_ratio.holds(1.0)),
        aa_ratio,
        points,
    })
}

fn reach(error: f64, front: &[[f64; 2]]) -> Between {
    Between { error, ms: front::time_to_reach(error, front) }
}

/// A report under way.
struct Making<'a> {
    subject: Subject,
    options: &'a Options,
    plan: Plan,
    sweep: Sweep,
    schedule: Schedule<'a>,
    work: &'a Work<'a>,
    cold_ms: f64,
}

/// What a setting errs by, and what it did.
type Erred = (PictureError, Drawn);

impl<'a> Making<'a> {
    fn begin(
        subject: &Subject,
        options: &'a Options,
        tell: Tell<'a>,
        work: &'a Work<'a>,
    ) -> Result<Self, Failed> {
        if subject.request.output != Output::Color {
            let fault = QueryFault::new("output", "must be color: a report is about colours");
            return Err(PlanError::Query(vec![fault]).into());
        }
        let schedule = Schedule::new(options.budget, tell);
        let subject = in_report_size(subject, options.width)?;
        let plan = Plan::new(&subject.scene, &subject.request, &subject.limits)?;
        check_size(&plan, &subject.limits)?;
        let mut sweep = Sweep::of(&plan, &options.knobs);
        // What is too large to be drawn is nothing to choose from.
        sweep.candidates.retain(|candidate| subject.plan(&candidate.setting).is_ok());
        let cold_ms = subject.sample(&Setting::of(&plan), work)?.total;
        Ok(Self { subject, options, plan, sweep, schedule, work, cold_ms })
    }

    /// The reference, as good as its part of the budget allows, and the seconds that it took.
    fn draw_reference(&self) -> Result<(Reference, f64), Failed> {
        let began = Instant::now();
        let until = self.schedule.part_of_the_rest(REFERENCE);
        let tell = |share: f64| self.schedule.tell(Stage::Reference, share);
        let subject = subject::of_reference(&self.plan);
        let reference = Reference::draw_until(&subject, EFFORT, Some(until), &tell, self.work)?;
        Ok((reference, began.elapsed().as_secs_f64()))
    }

    /// The error of each candidate, in their order, as far as the time goes; the default and its control always.
    fn errors(&self, standard: &Standard) -> Result<Vec<Erred>, Failed> {
        let until = self.schedule.part_of_the_rest(ERRORS);
        let candidates = &self.sweep.candidates;
        let mut errors = Vec::with_capacity(candidates.len());
        for candidate in candidates {
            if errors.len() >= 2 && Instant::now() >= until {
                break;
            }
            errors.push(self.error(&candidate.setting, standard)?);
            #[expect(clippy::cast_precision_loss, reason = "a few settings")]
            self.schedule.tell(Stage::Errors, errors.len() as f64 / candidates.len() as f64);
        }
        Ok(errors)
    }

    fn error(&self, setting: &Setting, standard: &Standard) -> Result<Erred, Failed> {
        let (radiance, drawn) = self.subject.draw(setting, self.work)?;
        let error = PictureError::of(&radiance, &drawn.bytes, standard, self.work);
        Ok((error, drawn))
    }

    /// What the default's error is made of.
    fn parts(&self, standard: &Standard, default: &PictureError) -> Result<Option<Parts>, Failed> {
        let until = self.schedule.part_of_the_rest(PARTS);
        let own = Setting::of(&self.plan);
        let best = Setting { render_scale: 1.0, ..Setting::of_preset(Preset::Reference, &self.plan) };
        let rmse = |setting: &Setting| self.error(setting, standard).map(|(error, _)| error.clamped.rmse);
        let (least, mut degrade_one, mut repair_one) = (rmse(&best)?, Vec::new(), Vec::new());
        for &knob in self.sweep.knobs.iter().filter(|knob| **knob != Knob::RenderScale) {
            if Instant::now() >= until {
                return Ok(None);
            }
            degrade_one.push((knob, rmse(&knob.taken(best, own))?));
            repair_one.push((knob, rmse(&knob.taken(own, best))?));
        }
        Ok(Some(Parts::new(default.clamped.rmse, least, degrade_one, repair_one)))
    }

    /// The laws of the components; a sample of a reference takes `sample_seconds`.
    fn fits(&self, sample_seconds: f64) -> Result<Vec<super::Fit>, Failed> {
        let until = self.schedule.part_of_the_rest(COMPONENTS);
        let Self { subject, plan, sweep, work, .. } = self;
        let fits = component::fit(subject, plan, &sweep.knobs, until, sample_seconds, work)?;
        self.schedule.tell(Stage::Components, 1.0);
        Ok(fits)
    }

    /// Times as many of the first `count` candidates as the time lets be drawn often enough. Returns the samples of
    /// each.
    fn time(&self, count: usize) -> Result<Vec<Vec<Sample>>, Failed> {
        let until = self.schedule.part_of_the_rest(TIMING);
        let candidates = &self.sweep.candidates[..count];
        let settings: Vec<Setting> = candidates.iter().map(|candidate| candidate.setting).collect();
        timing::warm_up(&self.subject, &settings[0], self.work)?;
        let affordable = self.affordable(&settings, until)?;
        let tell = |share: f64| self.schedule.tell(Stage::Timing, share);
        let rounds = self.options.rounds;
        Ok(timing::interleaved(&self.subject, &settings[..affordable], rounds, until, &tell, self.work)?)
    }

    /// How many of `settings` can be drawn often enough until then.
    fn affordable(&self, settings: &[Setting], until: Instant) -> Result<usize, Cancelled> {
        let left = until.saturating_duration_since(Instant::now()).as_secs_f64();
        let mut spent = 0.0;
        for (at, setting) in settings.iter().enumerate() {
            let began = Instant::now();
            self.subject.sample(setting, self.work)?;
            spent += began.elapsed().as_secs_f64();
            // The sample just drawn is on the account too.
            #[expect(clippy::cast_precision_loss, reason = "a few rounds")]
            if at >= 2 && spent * (LEAST_ROUNDS + 1) as f64 > left {
                return Ok(at);
            }
        }
        Ok(settings.len())
    }

    /// Milliseconds of the default with 1, 2, 4, … threads, up to those that draw, as far as the time goes.
    fn threads(&self) -> Result<Vec<Threads>, Failed> {
        let until = self.schedule.part_of_the_rest(THREADS);
        let all = self.work.pool.current_num_threads();
        let counts = std::iter::successors(Some(1), |n| Some(n * 2)).take_while(|n| *n < all).chain([all]);
        let own = Setting::of(&self.plan);
        let mut timed = Vec::new();
        for threads in counts.take_while(|_| Instant::now() < until) {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { continue };
            let work = Work { pool: &pool, ..*self.work };
            let sample = |_| self.subject.sample(&own, &work).map(|sample| sample.total);
            let times: Vec<f64> = (0..=LEAST_ROUNDS).map(sample).collect::<Result<_, _>>()?;
            timed.push(Threads { threads, ms: median(&times[1..]) });
        }
        Ok(timed)
    }

    /// Whether the default gives the same bytes however it is drawn, as far as the budget tells.
    fn determinism(&self) -> Result<Determinism, Failed> {
        self.schedule.tell(Stage::Ways, 0.5);
        let until = self.schedule.part_of_the_rest(1.0);
        let compared = determinism::compare(&self.subject, &Setting::of(&self.plan), until, self.work)?;
        self.schedule.tell(Stage::Ways, 1.0);
        Ok(compared)
    }

    /// The catalogue of stiff cases, if it was asked for.
    fn stability(&self) -> Result<Vec<Measurement>, Failed> {
        if !self.options.selftest {
            return Ok(Vec::new());
        }
        self.schedule.tell(Stage::Stability, 0.0);
        let engine = Engine {
            threads: self.work.pool.current_num_threads(),
            level: self.work.level,
            order: self.work.order,
            elide: Elisions::ALL,
        };
        let cases: Vec<&Case> = selftest::CASES.iter().collect();
        Ok(selftest::run(&cases, selftest::Effort::Quick, &engine, self.work.cancel, &|_| {})?)
    }

    fn point(&self, candidate: &Candidate, (err, drawn): Erred, samples: &[Sample], floor: f64) -> Point {
        Point {
            scene: self.options.name.clone(),
            families: candidate.families.clone(),
            knobs: candidate.setting,
            floor,
            near_floor: err.clamped.rmse < 3.0 * floor,
            err,
            t: Timing::of(samples),
            passes: timing::passes(samples),
            counters: drawn.counters,
            work: drawn.work,
            spared: drawn.spared,
            pareto: false,
        }
    }

    fn meta(&self, rounds: usize) -> Meta {
        let hash: String = self.plan.scene.content.iter().map(|byte| format!("{byte:02x}")).collect();
        Meta {
            machine: Machine::here(Simd::of(self.work.level), self.work.pool.current_num_threads()),
            name: self.options.name.clone(),
            scene_hash: hash[..32].to_owned(),
            width: self.plan.size[0],
            height: self.plan.size[1],
            rounds,
            budget_s: self.options.budget.as_secs_f64(),
            seconds: self.schedule.elapsed().as_secs_f64(),
            cold_ms: self.cold_ms,
            flip: if cfg!(feature = "flip") { "measured" } else { "left out: this build is without it" },
        }
    }

    /// Families with settings that the budget did not reach.
    fn unfinished(&self, points: &[Point]) -> Vec<Family> {
        let mut families: Vec<Family> = Vec::new();
        for family in self.sweep.candidates[points.len()..].iter().flat_map(|candidate| &candidate.families) {
            if !families.contains(family) {
                families.push(*family);
            }
        }
        families
    }
}

/// The frame of `subject` as colours, `width` pixels wide.
fn in_report_size(subject: &Subject, width: u32) -> Result<Subject, Failed> {
    // A width without a height says nothing about the frame's shape.
    let own_width = subject.request.width.filter(|_| subject.request.height.is_some());
    let asked = FrameRequest { width: own_width, ..subject.request.clone() };
    let outline = Plan::outline(&subject.scene, &asked, &subject.limits)?;
    let [own_width, own_height] = outline.size.map(f64::from);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a picture's side")]
    let height = (f64::from(width) * own_height / own_width).round().clamp(1.0, 16384.0) as u32;
    let request = FrameRequest { width: Some(width), height: Some(height), ..asked };
    Ok(Subject { request, ..subject.clone() })
}

/// Whether the references of a report fit into memory.
fn check_size(plan: &Plan, limits: &Limits) -> Result<(), PlanError> {
    let pixels = u64::from(plan.size[0]) * u64::from(plan.size[1]);
    PlanError::over("the number of pixels of a report", pixels, limits.report_pixels, None)?;
    let bytes = subject::of_reference(plan).triangle_bytes();
    PlanError::over_memory("memory of the reference's triangles", bytes, limits)
}

/// Finds the front among `points` and marks those on it.
fn mark_front(points: &mut [Point], floor: f64) -> Vec<[f64; 2]> {
    let place = |point: &Point| Place {
        error: point.err.clamped.rmse.max(f64::MIN_POSITIVE),
        ms: point.t.total.median,
        interval: point.t.total.ci,
    };
    // The control is the default under another name, and no rival.
    let mut rivals: Vec<&mut Point> =
        points.iter_mut().filter(|point| point.families != [Family::Control]).collect();
    let places: Vec<Place> = rivals.iter().map(|point| place(point)).collect();
    let on_front = front::pareto(&places, floor);
    rivals.iter_mut().zip(&on_front).for_each(|(point, on)| point.pareto = *on);
    front::staircase(&places, &on_front)
}

/// Samples of the whole picture.
fn samples_of(truth: &Reference) -> f64 {
    truth.samples.iter().map(|samples| f64::from(*samples)).sum()
}

fn told(truth: &Reference, seconds: f64) -> Truth {
    #[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
    let count = truth.samples.len() as f64;
    #[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
    let part = |mask: &[bool]| mask.iter().filter(|inside| **inside).count() as f64 / count;
    let masks = &truth.masks;
    Truth {
        floor: truth.noise,
        mean_samples: samples_of(truth) / count,
        most_samples: truth.samples.iter().copied().max().unwrap_or(0),
        seconds,
        masks: [part(&masks.edges), part(&masks.penumbrae), part(&masks.textured)],
    }
}
