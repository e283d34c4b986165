//! How a report comes about, within its budget.

use super::component;
use super::determinism::{self, Determinism};
use super::error::PictureError;
use super::front::{self, Between, Place};
use super::machine::Machine;
use super::reference::{Aim, Effort, Reference};
use super::selftest::instruments::engine::Engine;
use super::selftest::{self, Case, Measurement};
use super::setting::{Knob, Setting};
use super::statistics::median;
use super::subject::{self, Subject};
use super::sweep::{Candidate, Family, Sweep};
use super::timing::{self, Sample, Timing};
use super::{AtTime, Failed, Meta, Parts, Point, Report, Threads, Truth};
use crate::limits::Limits;
use crate::pipeline::{Cancelled, Pixels, Work};
use crate::plan::request::Preset;
use crate::plan::{Elisions, FrameRequest, Output, Plan, PlanError};
use crate::settings::Simd;
use serde::Serialize;
use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

/// What a report is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// What the scene is called.
    pub name: String,
    /// How long it may take.
    pub budget: Duration,
    /// What is turned; empty: every knob that the scene has.
    pub knobs: Vec<Knob>,
    /// Pixels in a row; the rows follow from the frame's shape.
    pub width: u32,
    /// Times that each setting is drawn, if the budget allows.
    pub rounds: usize,
    /// Whether the catalogue of stiff cases is run too, on top of the budget.
    pub selftest: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            name: String::new(),
            budget: Duration::from_secs(30),
            knobs: Vec::new(),
            width: 320,
            rounds: 15,
            selftest: false,
        }
    }
}

impl Options {
    /// Seconds that a report may be given.
    pub const BUDGETS: RangeInclusive<f64> = 2.0..=600.0;

    /// Reads a budget in seconds.
    ///
    /// # Errors
    /// What is wrong with it, for the client.
    pub fn budget(text: &str) -> Result<Duration, String> {
        let seconds = text.parse().ok().filter(|seconds| Self::BUDGETS.contains(seconds));
        let (least, most) = (Self::BUDGETS.start(), Self::BUDGETS.end());
        seconds.map(Duration::from_secs_f64).ok_or_else(|| format!("must be a number in [{least}, {most}]"))
    }
}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The reference is drawn.
    Reference,
    /// Settings are compared with it.
    Errors,
    /// Components are compared with theirs.
    Components,
    /// Settings are timed against each other.
    Timing,
}

/// How far a report is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// The part of the whole that is done, 0–1.
    pub done: f64,
}

/// Who is told, from any thread.
pub type Tell<'a> = &'a (dyn Fn(Progress) + Sync);

/// Parts of the budget: what each stage may be over at.
const REFERENCE_ENDS: f64 = 0.35;
const ERRORS_END: f64 = 0.5;
const PARTS_END: f64 = 0.55;
const COMPONENTS_END: f64 = 0.7;

/// The part of the budget that comparing bytes may take on top of it.
const DETERMINISM: f64 = 0.1;

/// Every setting is timed at least so often, or not at all.
const LEAST_ROUNDS: u32 = 5;

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
    let (candidates, errors) = making.errors(&truth)?;
    let parts = making.parts(&truth, &errors[0])?;
    let until = making.end_of(COMPONENTS_END);
    let fits = component::fit(&making.subject, &making.plan, &making.sweep.knobs, until, work)?;
    making.tell(Stage::Components, 1.0);
    let samples = making.time(&candidates[..errors.len()])?;
    let threads = making.threads()?;
    let determinism = making.determinism()?;
    let stability = making.stability()?;

    let measured = candidates.iter().zip(errors).zip(&samples);
    let mut points: Vec<Point> = measured
        .map(|((candidate, erred), samples)| making.point(candidate, erred, samples, truth.noise))
        .collect();
    let front = mark_front(&mut points, truth.noise);
    Ok(Report {
        meta: making.meta(samples[0].len()),
        reference: told(&truth, seconds),
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
        aa_ratio: timing::ratio(&samples[1], &samples[0]),
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
    tell: Tell<'a>,
    work: &'a Work<'a>,
    began: Instant,
    cold_ms: f64,
}

/// What a setting errs by, and what it did.
type Erred = (PictureError, Vec<(&'static str, u64)>);

impl<'a> Making<'a> {
    fn begin(
        subject: &Subject,
        options: &'a Options,
        tell: Tell<'a>,
        work: &'a Work<'a>,
    ) -> Result<Self, Failed> {
        let began = Instant::now();
        let subject = in_report_size(subject, options.width)?;
        let plan = Plan::new(&subject.scene, &subject.request, &subject.limits)?;
        check_size(&plan, &subject.limits)?;
        let sweep = Sweep::of(&plan, &options.knobs);
        let cold_ms = subject.sample(&Setting::of(&plan), work)?.total;
        Ok(Self { subject, options, plan, sweep, tell, work, began, cold_ms })
    }

    fn tell(&self, stage: Stage, share: f64) {
        let [from, to] = match stage {
            Stage::Reference => [0.0, REFERENCE_ENDS],
            Stage::Errors => [REFERENCE_ENDS, ERRORS_END],
            Stage::Components => [ERRORS_END, COMPONENTS_END],
            Stage::Timing => [COMPONENTS_END, 1.0],
        };
        (self.tell)(Progress { stage, done: from + share * (to - from) });
    }

    /// When `part` of the budget is over.
    fn end_of(&self, part: f64) -> Instant {
        self.began + self.options.budget.mul_f64(part)
    }

    /// The reference, as good as its part of the budget allows, and the seconds that it took.
    fn draw_reference(&self) -> Result<(Reference, f64), Failed> {
        let began = Instant::now();
        let subject = subject::of_reference(&self.plan);
        let effort = affordable(&subject, self.options.budget.mul_f64(REFERENCE_ENDS), self.work)?;
        let tell = |share: f64| self.tell(Stage::Reference, share);
        let reference = Reference::draw(&subject, effort, &tell, self.work)?;
        Ok((reference, began.elapsed().as_secs_f64()))
    }

    /// The error of each candidate that can be planned, as far as the budget goes; the default and its control
    /// always.
    fn errors(&self, truth: &Reference) -> Result<(Vec<Candidate>, Vec<Erred>), Failed> {
        let planned = |candidate: &&Candidate| self.subject.plan(&candidate.setting).is_ok();
        let candidates: Vec<Candidate> = self.sweep.candidates.iter().filter(planned).cloned().collect();
        let mut errors = Vec::with_capacity(candidates.len());
        for candidate in &candidates {
            if errors.len() >= 2 && Instant::now() >= self.end_of(ERRORS_END) {
                break;
            }
            errors.push(self.error(&candidate.setting, truth)?);
            #[expect(clippy::cast_precision_loss, reason = "a few settings")]
            self.tell(Stage::Errors, errors.len() as f64 / candidates.len() as f64);
        }
        Ok((candidates, errors))
    }

    fn error(&self, setting: &Setting, truth: &Reference) -> Result<Erred, Failed> {
        let (radiance, frame) = self.subject.draw(setting, self.work)?;
        let Pixels::Rgba8 { pixels, .. } = &frame.pixels else { unreachable!("colour is in bytes") };
        // The structural similarity is summed in the pool that it finds itself in.
        let compare = || PictureError::of(&radiance, pixels, truth, self.work.level);
        let error = self.work.pool.install(compare);
        Ok((error, frame.stats.entries().to_vec()))
    }

    /// What the default's error is made of.
    fn parts(&self, truth: &Reference, default: &Erred) -> Result<Option<Parts>, Failed> {
        let own = Setting::of(&self.plan);
        let best = Setting { render_scale: 1.0, ..Setting::of_preset(Preset::Reference, &self.plan) };
        let rmse = |setting: &Setting| self.error(setting, truth).map(|(error, _)| error.clamped.rmse);
        let (mut degrade_one, mut repair_one) = (Vec::new(), Vec::new());
        for &knob in self.sweep.knobs.iter().filter(|knob| **knob != Knob::RenderScale) {
            if Instant::now() >= self.end_of(PARTS_END) {
                return Ok(None);
            }
            degrade_one.push((knob, rmse(&knob.taken(best, own))?));
            repair_one.push((knob, rmse(&knob.taken(own, best))?));
        }
        let total = default.0.clamped.rmse;
        let squares: f64 = degrade_one.iter().map(|(_, error)| error * error).sum();
        let independent = (squares / (total * total) - 1.0).abs() <= 0.2;
        Ok(Some(Parts { total, degrade_one, repair_one, sum: squares.sqrt(), independent }))
    }

    /// Times as many of the candidates as the rest of the budget lets be drawn often enough. Returns the samples of
    /// each.
    fn time(&self, candidates: &[Candidate]) -> Result<Vec<Vec<Sample>>, Failed> {
        let settings: Vec<Setting> = candidates.iter().map(|candidate| candidate.setting).collect();
        timing::warm_up(&self.subject, &settings[0], self.work)?;
        let affordable = self.affordable(&settings)?;
        let tell = |share: f64| self.tell(Stage::Timing, share);
        let (rounds, until) = (self.options.rounds, self.end_of(1.0));
        Ok(timing::interleaved(&self.subject, &settings[..affordable], rounds, until, &tell, self.work)?)
    }

    /// How many of `settings` can be drawn often enough until the budget is over.
    fn affordable(&self, settings: &[Setting]) -> Result<usize, Cancelled> {
        let left = self.end_of(1.0).saturating_duration_since(Instant::now());
        let mut spent = Duration::ZERO;
        for (at, setting) in settings.iter().enumerate() {
            let began = Instant::now();
            self.subject.sample(setting, self.work)?;
            spent += began.elapsed();
            // The sample just drawn is on the account too.
            if at >= 2 && spent * (LEAST_ROUNDS + 1) > left {
                return Ok(at);
            }
        }
        Ok(settings.len())
    }

    /// Whether the default gives the same bytes however it is drawn, as far as a little more than the budget tells.
    fn determinism(&self) -> Result<Determinism, Failed> {
        let until = Instant::now().max(self.end_of(1.0)) + self.options.budget.mul_f64(DETERMINISM);
        determinism::compare(&self.subject, &Setting::of(&self.plan), until, self.work)
    }

    /// The catalogue of stiff cases, if it was asked for.
    fn stability(&self) -> Result<Vec<Measurement>, Failed> {
        if !self.options.selftest {
            return Ok(Vec::new());
        }
        let engine = Engine {
            threads: self.work.pool.current_num_threads(),
            level: self.work.level,
            order: self.work.order,
            elide: Elisions::ALL,
        };
        let cases: Vec<&Case> = selftest::CASES.iter().collect();
        Ok(selftest::run(&cases, selftest::Effort::Quick, &engine, self.work.cancel, &|_| {})?)
    }

    /// Milliseconds of the default with 1, 2, 4, … threads, up to those that draw.
    fn threads(&self) -> Result<Vec<Threads>, Failed> {
        let all = self.work.pool.current_num_threads();
        let counts = std::iter::successors(Some(1), |n| Some(n * 2)).take_while(|n| *n < all).chain([all]);
        let own = Setting::of(&self.plan);
        let timed = |threads: usize| -> Result<Option<Threads>, Failed> {
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
                return Ok(None);
            };
            let work = Work { pool: &pool, ..*self.work };
            let sample = |_| self.subject.sample(&own, &work).map(|sample| sample.total);
            let times: Vec<f64> = (0..=LEAST_ROUNDS).map(sample).collect::<Result<_, _>>()?;
            Ok(Some(Threads { threads, ms: median(&times[1..]) }))
        };
        counts.filter_map(|threads| timed(threads).transpose()).collect()
    }

    fn point(&self, candidate: &Candidate, (err, counters): Erred, samples: &[Sample], floor: f64) -> Point {
        Point {
            scene: self.options.name.clone(),
            families: candidate.families.clone(),
            knobs: candidate.setting,
            floor,
            near_floor: err.clamped.rmse < 3.0 * floor,
            err,
            t: Timing::of(samples),
            passes: timing::passes(samples),
            counters,
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
            seconds: self.began.elapsed().as_secs_f64(),
            cold_ms: self.cold_ms,
            flip: if cfg!(feature = "flip") { "measured" } else { "left out: this build is without it" },
        }
    }

    /// Families with settings that the budget did not reach.
    fn unfinished(&self, points: &[Point]) -> Vec<Family> {
        let is_measured =
            |candidate: &&Candidate| points.iter().any(|point| point.knobs == candidate.setting);
        let missing = self.sweep.candidates.iter().filter(|candidate| !is_measured(candidate));
        let mut families: Vec<Family> = Vec::new();
        for family in missing.flat_map(|candidate| &candidate.families) {
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
    let asked = FrameRequest { output: Output::Color, width: own_width, ..subject.request.clone() };
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

/// Parts of the picture's pixels that a first look at the reference takes: one of sixteen.
const PILOT: u32 = 4;

/// The effort that a reference can have in `time`, told from a small one.
fn affordable(subject: &super::reference::Subject, time: Duration, work: &Work) -> Result<Effort, Cancelled> {
    let began = Instant::now();
    let pilot = super::reference::Subject { size: subject.size.map(|side| side.div_ceil(PILOT)), ..*subject };
    let few = Effort { base: 4, most: 4, noise: 0.0, aim: Aim::Pixel };
    Reference::draw(&pilot, few, &|_| {}, work)?;
    let sample = began.elapsed().as_secs_f64() / f64::from(few.base * pilot.size[0] * pilot.size[1]);
    let pixels = f64::from(subject.size[0]) * f64::from(subject.size[1]);
    let mean = time.as_secs_f64() / (sample * pixels);
    // Up to a third of a picture's pixels needs most of the samples.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 4 and 1024")]
    let samples = |share: f64, least: f64, most: f64| (mean * share).clamp(least, most) as u32;
    Ok(Effort {
        base: samples(0.3, 4.0, 32.0),
        most: samples(2.5, 16.0, 1024.0),
        noise: 5e-4,
        aim: Aim::Pixel,
    })
}

/// Finds the front among `points` and marks those on it.
fn mark_front(points: &mut [Point], floor: f64) -> Vec<[f64; 2]> {
    let place = |point: &Point| Place {
        error: point.err.clamped.rmse.max(f64::MIN_POSITIVE),
        ms: point.t.total.median,
        interval: point.t.total.ci,
    };
    let places: Vec<Place> = points.iter().map(place).collect();
    let mut on_front = front::pareto(&places, floor);
    // The control is the default under another name.
    on_front.iter_mut().zip(&*points).for_each(|(on, point)| *on &= point.families != [Family::Control]);
    points.iter_mut().zip(&on_front).for_each(|(point, on)| point.pareto = *on);
    front::staircase(&places, &on_front)
}

fn told(truth: &Reference, seconds: f64) -> Truth {
    #[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
    let count = truth.samples.len() as f64;
    #[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
    let part = |mask: &[bool]| mask.iter().filter(|inside| **inside).count() as f64 / count;
    let masks = &truth.masks;
    Truth {
        floor: truth.noise,
        mean_samples: truth.samples.iter().map(|samples| f64::from(*samples)).sum::<f64>() / count,
        most_samples: truth.samples.iter().copied().max().unwrap_or(0),
        seconds,
        masks: [part(&masks.edges), part(&masks.penumbrae), part(&masks.textured)],
    }
}
