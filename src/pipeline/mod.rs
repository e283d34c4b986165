//! The rasterizing pipeline: a plan in, pixels out.
//!
//! ```text
//! shadow ─ geometry ─ tiles (cover ─ shade ─ sky ─ resolve) ─ post ─ output
//! ```
//!
//! Where no effect of `post` looks at a pixel's neighbours, the tiles do the work of the last two.
//!
//! All of it runs on the threads of a [`Work`], and gives the same bytes for any number of them and
//! any SIMD level.

pub mod draw;
pub mod geometry;
mod output;
mod pick;
mod picture;
pub mod post;
pub mod program;
mod resample;
mod resolve;
pub mod samples;
pub mod shade;
pub mod shader;
pub mod shadow;
pub mod sky;
mod stats;
mod target;
pub mod tiles;
pub mod work;

pub use pick::{Hit, pick};
pub use stats::{Stats, Timings};
pub use target::{Frame, Pixels};
pub use work::{Cancelled, Order, Work};

use crate::plan::{Output, Plan, Tally};
use geometry::bin::TileGrid;
use geometry::{Bins, Counts};
use picture::Picture;
use post::{Chain, Effect};
use shade::Lighting;
use shade::light::LightSource;
use shadow::ShadowMap;
use stats::TileTimes;
use std::time::Instant;
use tiles::{AlphaTests, Look, Shared};

/// Draws one frame.
///
/// # Errors
/// [`Cancelled`].
pub fn render(plan: &Plan, work: &Work) -> Result<Frame, Cancelled> {
    render_with(plan, &[], work)
}

/// Draws one frame, with `effects` in their order after those of the plan.
///
/// They change [`Output::Color`] alone: data outputs and radiance know no post effects. The planes they
/// work in are not in the plan's estimate of memory.
///
/// # Errors
/// [`Cancelled`].
pub fn render_with(plan: &Plan, effects: &[&dyn Effect], work: &Work) -> Result<Frame, Cancelled> {
    let frames = draw_each(std::slice::from_ref(plan), effects, work)?;
    Ok(frames.into_iter().next().expect("a frame for each plan"))
}

/// Draws a frame for each plan. Of plans that show the same triangles, as the outputs of one request do,
/// these are transformed, clipped and binned once; and of those with the same samples every tile is looked
/// at once.
///
/// # Errors
/// [`Cancelled`].
pub fn render_each(plans: &[Plan], work: &Work) -> Result<Vec<Frame>, Cancelled> {
    draw_each(plans, &[], work)
}

/// Draws a frame for each plan, look by look. The order of the lines is the order of the passes.
fn draw_each(plans: &[Plan], effects: &[&dyn Effect], work: &Work) -> Result<Vec<Frame>, Cancelled> {
    let mut frames: Vec<Option<Frame>> = plans.iter().map(|_| None).collect();
    let mut passes: Vec<(&Plan, Bins)> = Vec::new();
    while let Some(first) = frames.iter().position(Option::is_none) {
        let is_of_look = |&at: &usize| frames[at].is_none() && plans[at].looks_as(&plans[first]);
        let look: Vec<usize> = (first..plans.len()).filter(is_of_look).collect();
        let mut drafts: Vec<Draft> = look.iter().map(|&at| Draft::new(&plans[at], effects)).collect();
        drafts.iter_mut().try_for_each(|draft| draft.render_shadow_maps(work))?;
        let known = passes.iter().position(|(plan, _)| plans[first].shows_the_triangles_of(plan));
        let pass = match known {
            Some(pass) => pass,
            None => {
                passes.push((&plans[first], drafts[0].transform_clip_and_bin(plans, work)?));
                passes.len() - 1
            }
        };
        let drawn = draw_tiles(drafts, &passes[pass].1, work)?;
        look.into_iter().zip(drawn).for_each(|(at, frame)| frames[at] = Some(frame));
    }
    Ok(frames.into_iter().map(|frame| frame.expect("every plan is of a look")).collect())
}

/// A frame under way.
struct Draft<'a> {
    plan: &'a Plan,
    chain: Chain<'a>,
    shadow_maps: Vec<ShadowMap>,
    /// Of the camera's pass, if it is this frame's.
    counts: Counts,
    tally: Tally,
    timings: Timings,
}

impl<'a> Draft<'a> {
    fn new(plan: &'a Plan, effects: &[&'a dyn Effect]) -> Self {
        let effects = if plan.output == Output::Color { effects } else { &[] };
        let (chain, counts, timings) =
            (Chain::new(&plan.post, effects), Counts::default(), Timings::default());
        Self { plan, chain, shadow_maps: Vec::new(), counts, tally: plan.tally(), timings }
    }

    fn render_shadow_maps(&mut self, work: &Work) -> Result<(), Cancelled> {
        if !self.plan.shadows.is_empty() {
            let began = Instant::now();
            self.shadow_maps = shadow::render_maps(&self.plan.shadows, self.plan.elide, work)?;
            self.shadow_maps.iter().for_each(|map| self.tally.add(&map.tally()));
            self.timings.push("shadow", milliseconds(began));
        }
        Ok(())
    }

    /// The camera's geometry, binned by tile for all of `others` that show the same triangles.
    fn transform_clip_and_bin(&mut self, others: &[Plan], work: &Work) -> Result<Bins, Cancelled> {
        let began = Instant::now();
        let bins = transform_clip_and_bin(self.plan, others, work)?;
        self.counts = bins.counts;
        self.tally.add(&bins.tally);
        if !self.plan.items.is_empty() {
            self.timings.push("geometry", milliseconds(began));
        }
        Ok(bins)
    }

    fn finish(mut self, picture: Picture, shared: &Shared, work: &Work) -> Result<Frame, Cancelled> {
        let mut pixels = picture.finish(self.plan, shared, &self.chain, &mut self.timings, work)?;
        if self.plan.is_resampled() {
            let began = Instant::now();
            pixels = resample::to_size(pixels, self.plan, work)?;
            self.timings.push("resample", milliseconds(began));
        }
        let stats = Stats::new(self.counts, self.tally, self.plan);
        Ok(Frame::new(self.plan, pixels, stats, self.timings))
    }
}

/// Draws the tiles of the frames of one look, per tile cover → shade → sky → resolve → write, and what
/// follows them.
fn draw_tiles(mut drafts: Vec<Draft>, bins: &Bins, work: &Work) -> Result<Vec<Frame>, Cancelled> {
    let plans: Vec<&Plan> = drafts.iter().map(|draft| draft.plan).collect();
    let maps: Vec<Vec<ShadowMap>> =
        drafts.iter_mut().map(|draft| std::mem::take(&mut draft.shadow_maps)).collect();
    let shared: Vec<Shared> = plans.iter().zip(&maps).map(|(plan, maps)| share(plan, bins, maps)).collect();
    let transparent = shared.iter().map(|shared| shared.background.is_transparent());
    let mut pictures: Vec<Picture> =
        drafts.iter().zip(transparent).map(|(draft, t)| Picture::new(draft.plan, &draft.chain, t)).collect();

    let began = Instant::now();
    let look = Look { bins, samples: plans[0].samples, tests: AlphaTests::of(plans[0]) };
    let tasks = pictures.iter_mut().zip(&plans).zip(&shared);
    let tasks = tasks.map(|((picture, plan), shared)| picture.tasks(plan, shared)).collect();
    let times = tiles::draw(&look, tasks, work)?;
    let rate = milliseconds(began) / times.iter().map(TileTimes::total).sum::<f64>().max(f64::MIN_POSITIVE);

    let mut frames = Vec::with_capacity(plans.len());
    for (((mut draft, picture), shared), times) in drafts.into_iter().zip(pictures).zip(&shared).zip(times) {
        draft.timings.push_tiles(rate, &times);
        draft.tally.add(&times.tally);
        frames.push(draft.finish(picture, shared, work)?);
    }
    Ok(frames)
}

/// What the tiles of a frame share.
fn share<'a>(plan: &'a Plan, bins: &'a Bins, maps: &'a [ShadowMap]) -> Shared<'a> {
    let anchor = shade::anchor(plan.scene.bounds(plan.t), &plan.view);
    Shared {
        bins,
        draws: &plan.draws,
        items: &plan.items,
        lighting: Lighting {
            ambient: plan.ambient,
            lights: plan.lights.iter().map(|light| LightSource::new(light, &plan.view, anchor)).collect(),
            maps,
            view: &plan.view,
            anchor,
            elide: plan.elide,
        },
        frames: plan.shadows.iter().map(shadow::frame).collect(),
        background: sky::Background::new(&plan.background, &plan.view),
        counts: plan.output == Output::Shaded,
        samples: plan.samples,
        nearest: samples::nearest_to_centre(plan.samples),
    }
}

/// The camera's geometry, binned by tile for all of `others` that show the same triangles.
fn transform_clip_and_bin(plan: &Plan, others: &[Plan], work: &Work) -> Result<Bins, Cancelled> {
    let same = others.iter().filter(|other| other.shows_the_triangles_of(plan)).chain([plan]);
    let counts: Vec<u32> = same.map(|plan| plan.samples).collect();
    let most = counts.iter().fold(1, |most, &count| most.max(count));
    let all: Vec<[i32; 2]> = counts.iter().flat_map(|&count| samples::pattern(count)).copied().collect();
    let grid = TileGrid::new(&plan.view, tiles::tile_shift(most), &all);
    geometry::run(&plan.items, &plan.view, grid, plan.elide, work)
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
