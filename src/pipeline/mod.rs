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
pub mod post;
pub mod program;
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
pub use work::{Cancelled, Work};

use crate::plan::{Output, Plan};
use geometry::bin::TileGrid;
use geometry::{Bins, Counts};
use post::{Effect, LinearFrame};
use shade::Lighting;
use shade::light::LightSource;
use std::time::Instant;
use tiles::{Resolved, Shared, Tile};

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

/// Draws a frame for each plan. Plans that show the same triangles, as the outputs of one request do,
/// are drawn from one pass over them.
///
/// # Errors
/// [`Cancelled`].
pub fn render_each(plans: &[Plan], work: &Work) -> Result<Vec<Frame>, Cancelled> {
    draw_each(plans, &[], work)
}

/// Draws a frame for each plan. The order of the lines is the order of the passes.
fn draw_each(plans: &[Plan], effects: &[&dyn Effect], work: &Work) -> Result<Vec<Frame>, Cancelled> {
    let mut frames = Vec::with_capacity(plans.len());
    let mut passes: Vec<(&Plan, Bins)> = Vec::new();
    for plan in plans {
        let mut timings = Timings::default();
        let shadow_maps = timed(&mut timings, "shadow", !plan.shadows.is_empty(), || {
            shadow::render_maps(&plan.shadows, work)
        })?;
        let drawn = passes.iter().position(|(drawn, _)| plan.shows_the_triangles_of(drawn));
        let pass = timed(&mut timings, "geometry", drawn.is_none(), || match drawn {
            Some(pass) => Ok(pass),
            None => transform_clip_and_bin(plan, plans, work).map(|bins| {
                passes.push((plan, bins));
                passes.len() - 1
            }),
        })?;
        let mut frame = draw_output(plan, &passes[pass].1, &shadow_maps, effects, timings, work)?;
        if drawn.is_some() {
            frame.stats.geometry = Counts::default();
        }
        frames.push(frame);
    }
    Ok(frames)
}

/// The camera's geometry, binned by tile for all of `others` that show the same triangles.
fn transform_clip_and_bin(plan: &Plan, others: &[Plan], work: &Work) -> Result<Bins, Cancelled> {
    let same = others.iter().filter(|other| other.shows_the_triangles_of(plan)).chain([plan]);
    let counts: Vec<u32> = same.map(|plan| plan.samples).collect();
    let most = counts.iter().fold(1, |most, &count| most.max(count));
    let all: Vec<[i32; 2]> = counts.iter().flat_map(|&count| samples::pattern(count)).copied().collect();
    let grid = TileGrid::new(&plan.view, tiles::tile_shift(most), &all);
    geometry::run(&plan.items, &plan.view, grid, work)
}

/// What the plan's output shows of the triangles.
fn draw_output(
    plan: &Plan,
    bins: &Bins,
    maps: &[shadow::ShadowMap],
    effects: &[&dyn Effect],
    timings: Timings,
    work: &Work,
) -> Result<Frame, Cancelled> {
    match plan.output {
        Output::Color => draw_colors(plan, bins, maps, effects, timings, work),
        Output::Normal | Output::Albedo | Output::Radiance => {
            draw_colors(plan, bins, maps, &[], timings, work)
        }
        Output::Depth | Output::Instance => draw_values(plan, bins, timings, work),
        Output::Wireframe => draw_wireframe(plan, bins, timings, work),
    }
}

/// Draws a picture of colours: per tile cover → shade → sky → resolve → write.
fn draw_colors(
    plan: &Plan,
    bins: &Bins,
    maps: &[shadow::ShadowMap],
    effects: &[&dyn Effect],
    mut timings: Timings,
    work: &Work,
) -> Result<Frame, Cancelled> {
    let anchor = shade::anchor(plan.scene.bounds(plan.t), &plan.view);
    let shared = Shared {
        bins,
        draws: &plan.draws,
        items: &plan.items,
        lighting: Lighting {
            ambient: plan.ambient,
            lights: plan.lights.iter().map(|light| LightSource::new(light, &plan.view, anchor)).collect(),
            maps,
            view: &plan.view,
            anchor,
        },
        frames: plan.shadows.iter().map(shadow::frame).collect(),
        background: sky::Background::new(&plan.background, &plan.view),
        samples: plan.samples,
    };
    let chain = post::Chain::new(&plan.post, effects);
    let (pixels, shaded) = match plan.output {
        Output::Radiance => draw_radiance(plan, &shared, &mut timings, work)?,
        _ if chain.is_empty() => draw_bytes(plan, &shared, &mut timings, work)?,
        _ => draw_and_post(plan, &shared, &chain, &mut timings, work)?,
    };
    let maps = plan.shadows.iter().map(|pass| pass.faces().len()).sum();
    Ok(Frame::new(plan, pixels, Stats::new(bins, shaded, maps), timings))
}

/// Tiles that end in bytes. Returns how many fragments were shaded, too.
fn draw_bytes(
    plan: &Plan,
    shared: &Shared,
    timings: &mut Timings,
    work: &Work,
) -> Result<(Pixels, u64), Cancelled> {
    let mut pixels = vec![[0; 4]; plan.view.pixels()];
    let tiles = tiles::split(&mut pixels, &shared.bins.grid);
    let write = |resolved: &Resolved, tile: Tile<[u8; 4]>| {
        output::encode_tile(work.level, resolved, &plan.post.in_tiles, tile);
    };
    let shaded = draw_tiles(shared, tiles, write, timings, work)?;
    Ok((Pixels::Rgba8 { pixels, opaque: !shared.background.is_transparent() }, shaded))
}

/// Tiles that end in linear colour, and nothing else.
fn draw_radiance(
    plan: &Plan,
    shared: &Shared,
    timings: &mut Timings,
    work: &Work,
) -> Result<(Pixels, u64), Cancelled> {
    let mut pixels = vec![[0.0; 4]; plan.view.pixels()];
    let tiles = tiles::split(&mut pixels, &shared.bins.grid);
    let write =
        |resolved: &Resolved, tile: Tile<[f32; 4]>| output::write_radiance(work.level, resolved, tile);
    let shaded = draw_tiles(shared, tiles, write, timings, work)?;
    Ok((Pixels::Rgba32F { pixels, opaque: !shared.background.is_transparent() }, shaded))
}

/// Tiles that end in linear colour for the effects of `chain`, then those, then bytes.
fn draw_and_post(
    plan: &Plan,
    shared: &Shared,
    chain: &post::Chain,
    timings: &mut Timings,
    work: &Work,
) -> Result<(Pixels, u64), Cancelled> {
    let transparent = shared.background.is_transparent();
    let mut linear = LinearFrame::new([plan.view.width, plan.view.height], transparent, chain.spare_planes());
    let tiles = linear.tiles(&shared.bins.grid);
    let write = |resolved: &Resolved, tile: Tile<f32>| {
        post::write_tile(work.level, resolved, &plan.post.in_tiles, tile);
    };
    let shaded = draw_tiles(shared, tiles, write, timings, work)?;
    let began = Instant::now();
    chain.run(&mut linear, work)?;
    let mut pixels = vec![[0; 4]; plan.view.pixels()];
    output::encode_frame(&linear, chain.last_steps(), &mut pixels, work)?;
    timings.push("post", milliseconds(began));
    Ok((Pixels::Rgba8 { pixels, opaque: !transparent }, shaded))
}

/// Draws the tiles of a picture of colours and notes their times. Returns how many fragments were
/// shaded.
fn draw_tiles<P: Send>(
    shared: &Shared,
    tiles: Vec<Tile<P>>,
    write: impl Fn(&Resolved, Tile<P>) + Sync,
    timings: &mut Timings,
    work: &Work,
) -> Result<u64, Cancelled> {
    let began = Instant::now();
    let times = tiles::draw(shared, tiles, write, work)?;
    timings.push_tiles(milliseconds(began), &times);
    Ok(times.shaded)
}

/// Draws a picture of 16-bit values: distances or instances, straight from what each pixel sees.
fn draw_values(plan: &Plan, bins: &Bins, mut timings: Timings, work: &Work) -> Result<Frame, Cancelled> {
    let mut pixels = vec![0; plan.view.pixels()];
    let began = Instant::now();
    output::draw_values(plan, bins, &mut pixels, work)?;
    timings.push("raster", milliseconds(began));
    Ok(Frame::new(plan, Pixels::Gray16(pixels), Stats::new(bins, 0, 0), timings))
}

/// Draws the edges of what each pixel sees.
fn draw_wireframe(plan: &Plan, bins: &Bins, mut timings: Timings, work: &Work) -> Result<Frame, Cancelled> {
    let mut pixels = vec![[0; 4]; plan.view.pixels()];
    let began = Instant::now();
    output::draw_wireframe(plan, bins, &mut pixels, work)?;
    timings.push("raster", milliseconds(began));
    Ok(Frame::new(plan, Pixels::Rgba8 { pixels, opaque: true }, Stats::new(bins, 0, 0), timings))
}

/// Runs a pass and notes its time, if it is one that this frame has.
fn timed<T>(timings: &mut Timings, pass: &'static str, runs: bool, f: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let result = f();
    if runs {
        timings.push(pass, milliseconds(began));
    }
    result
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
