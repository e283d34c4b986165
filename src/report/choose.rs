//! A picture to a budget: the setting that a front has for it.

use super::cost::{self, Estimate};
use super::setting::{Knob, Setting};
use super::sweep::{self, Family};
use super::{Point, Report};
use crate::plan::request::{Budget, Preset};
use crate::plan::{FrameRequest, Knobs, Plan};

/// What was chosen, and what is to be expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The setting.
    pub setting: Setting,
    /// Root mean square error of linear light in 0–1.
    pub error: f64,
    /// Milliseconds, from the request to the last pixel.
    pub ms: f64,
    /// What says so.
    pub source: Source,
    /// Whether that is within the budget; where nothing is, the choice is what comes nearest to it.
    pub met: bool,
}

/// Where an expectation comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A report on the scene.
    Measured,
    /// What such scenes cost.
    Model,
}

impl Source {
    /// What a reply calls it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Model => "model",
        }
    }
}

/// The settings of a scene that no other beats, as a report has measured them.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    points: Vec<Measured>,
    presets: Vec<(Preset, f64)>,
    /// Of the pictures that were timed.
    pixels: f64,
    /// How many settings were.
    settings: usize,
}

/// A setting of the front.
#[derive(Clone, Debug, PartialEq)]
struct Measured {
    setting: Setting,
    error: f64,
    /// Milliseconds, from the request to the last pixel.
    ms: f64,
    passes: Vec<(&'static str, f64)>,
}

/// Passes whose time does not grow with the picture.
const OF_THE_SCENE: [&str; 3] = ["plan", "shadow", "geometry"];

impl Front {
    /// That of a report; `None` where its time was too short for all presets: a front of less is none to choose by.
    #[must_use]
    pub fn of(report: &Report) -> Option<Self> {
        if report.unfinished.iter().any(|family| matches!(family, Family::Preset(_))) {
            return None;
        }
        let measured = |point: &Point| Measured {
            setting: point.knobs,
            error: point.err.clamped.rmse,
            ms: point.t.total.median,
            passes: point.passes.iter().filter(|(pass, _)| *pass != "encode").copied().collect(),
        };
        let preset = |point: &Point| {
            let presets = point.families.iter().filter_map(|family| match family {
                Family::Preset(preset) => Some(*preset),
                _ => None,
            });
            presets.map(|preset| (preset, point.err.clamped.rmse)).collect::<Vec<_>>()
        };
        Some(Self {
            points: report.points.iter().filter(|point| point.pareto).map(measured).collect(),
            presets: report.points.iter().flat_map(preset).collect(),
            pixels: f64::from(report.meta.width) * f64::from(report.meta.height),
            settings: report.points.len(),
        })
    }

    /// Pixels of the pictures that were timed.
    #[must_use]
    pub fn pixels(&self) -> f64 {
        self.pixels
    }

    /// How many settings were timed.
    #[must_use]
    pub fn settings(&self) -> usize {
        self.settings
    }

    /// Whether it tells anything of pictures of so many pixels: in one much smaller than those that were timed,
    /// or much larger, other work rules.
    #[must_use]
    pub fn tells_of(&self, pixels: f64) -> bool {
        (1.0 / 16.0..=64.0).contains(&(pixels / self.pixels))
    }

    /// What its settings promise for the picture of `plan`.
    fn choices(&self, plan: &Plan) -> Vec<Choice> {
        let ratio = f64::from(plan.size[0]) * f64::from(plan.size[1]) / self.pixels;
        let choice = |point: &Measured| Choice {
            setting: point.setting,
            error: point.error,
            ms: point.ms * growth(&point.passes, ratio),
            source: Source::Measured,
            met: true,
        };
        self.points.iter().map(choice).collect()
    }
}

/// How many times as long a frame of `passes` takes in a picture of `ratio` times the pixels.
fn growth(passes: &[(&'static str, f64)], ratio: f64) -> f64 {
    let sum = |of: &dyn Fn(&str) -> f64| passes.iter().map(|(pass, ms)| ms * of(pass)).sum::<f64>();
    let all = sum(&|_| 1.0);
    if all > 0.0 { sum(&|pass| if OF_THE_SCENE.contains(&pass) { 1.0 } else { ratio }) / all } else { ratio }
}

/// The setting that `budget` gets for the frame of `request`, which `plan` draws on `threads`, of those that `fit` into
/// the limits: by the `front` of its scene, if that is measured. What the request sets itself stays.
///
/// A preset is what it says, and on a measured front what errs no more than that and costs the least.
#[must_use]
pub fn choose(
    budget: Budget,
    request: &FrameRequest,
    plan: &Plan,
    front: Option<&Front>,
    threads: usize,
    fits: &dyn Fn(&Setting) -> bool,
) -> Choice {
    // What was measured was without what the request sets.
    let measured = front.filter(|_| !sets_knobs(request));
    let measured = measured.map(|front| (front, fitting(front.choices(plan), fits)));
    let (front, choices) = match measured.filter(|(_, choices)| !choices.is_empty()) {
        Some((front, choices)) => (Some(front), choices),
        None => (None, fitting(all_modelled(plan, request, threads), fits)),
    };
    let within = |budget: f64, of: fn(&Choice) -> f64, best: fn(&Choice) -> f64| {
        let affordable = choices.iter().filter(|choice| of(choice) <= budget);
        // Where nothing is, what comes nearest to it.
        affordable
            .min_by(|a, b| best(a).total_cmp(&best(b)))
            .or_else(|| choices.iter().min_by(|a, b| of(a).total_cmp(&of(b))))
            .copied()
    };
    let by_error = |error: f64| within(error, |choice| choice.error, |choice| choice.ms);
    let own = Setting::of(plan);
    let chosen = match budget {
        Budget::MaxMs(ms) => within(ms, |choice| choice.ms, |choice| choice.error),
        Budget::MaxError(error) => by_error(error),
        Budget::Preset(preset) => {
            let known = front.and_then(|front| front.presets.iter().find(|(own, _)| *own == preset));
            let itself = modelled(kept(Setting::of_preset(preset, plan), request), plan, threads);
            match known {
                Some((_, error)) => by_error(*error),
                None if fits(&itself.setting) => Some(itself),
                None => by_error(itself.error),
            }
        }
    };
    // The frame as it is can be drawn, or there were no plan of it.
    let chosen = chosen.unwrap_or_else(|| modelled(own, plan, threads));
    let met = match budget {
        Budget::MaxMs(ms) => chosen.ms <= ms,
        Budget::MaxError(error) => chosen.error <= error,
        Budget::Preset(_) => true,
    };
    Choice { met, ..chosen }
}

fn fitting(mut choices: Vec<Choice>, fits: &dyn Fn(&Setting) -> bool) -> Vec<Choice> {
    choices.retain(|choice| fits(&choice.setting));
    choices
}

fn modelled(setting: Setting, plan: &Plan, threads: usize) -> Choice {
    let Estimate { error, ms } = cost::expected(&setting, plan, threads);
    Choice { setting, error, ms, source: Source::Model, met: true }
}

/// Settings from little work to much, and what they should cost.
fn all_modelled(plan: &Plan, request: &FrameRequest, threads: usize) -> Vec<Choice> {
    let presets = Preset::WORDS.iter().map(|(_, preset)| Setting::of_preset(*preset, plan));
    let knobs: Vec<Knob> = Knob::ALL.into_iter().filter(|knob| knob.check(plan).is_ok()).collect();
    let settings = presets.chain(sweep::mixed(plan, &knobs));
    settings.map(|setting| modelled(kept(setting, request), plan, threads)).collect()
}

/// Whether `request` sets any knob itself.
fn sets_knobs(request: &FrameRequest) -> bool {
    request.samples.is_some() || request.knobs != Knobs::default()
}

/// `setting`, but for what `request` sets itself.
fn kept(setting: Setting, request: &FrameRequest) -> Setting {
    let own = &request.knobs;
    let pcss =
        |[search, filter]: [u32; 2]| [own.search_taps.unwrap_or(search), own.filter_taps.unwrap_or(filter)];
    Setting {
        samples: request.samples.unwrap_or(setting.samples),
        shadow_resolution: own.shadow_resolution.or(setting.shadow_resolution),
        pcf_taps: own.pcf_taps.or(setting.pcf_taps),
        pcss_taps: setting.pcss_taps.map(pcss),
        texture_filter: own.texture_filter.or(setting.texture_filter),
        render_scale: own.render_scale.unwrap_or(setting.render_scale),
    }
}
