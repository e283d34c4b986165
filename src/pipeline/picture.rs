//! Pictures under way: what each output makes of what the samples of its tiles see.

use super::output;
use super::post::{self, Chain, LinearFrame};
use super::stats::{Clock, TileTimes, Timings};
use super::target::Pixels;
use super::tiles::fragments::Entry;
use super::tiles::{self, Resolved, Scratch, Shared, Tile, TileTask};
use super::work::{Cancelled, Work};
use crate::plan::{Output, Plan};
use std::time::Instant;

/// A picture, as the tiles leave it.
pub(super) enum Picture {
    /// Finished bytes.
    Bytes(Vec<[u8; 4]>),
    /// Linear colour, and nothing else.
    Radiance(Vec<[f32; 4]>),
    /// Linear colour for effects that look at a pixel's neighbours.
    Linear(LinearFrame),
    /// Distances or instances.
    Values(Vec<u16>),
    /// Which triangle the centre of each pixel sees.
    Seen(Vec<Option<Entry>>),
    /// Colours that stand for what is seen.
    FalseColors(Vec<[u8; 4]>),
    /// Colours that stand for how many fragments were shaded.
    Counts(Vec<[u8; 4]>),
    /// Nothing that tiles draw: the shadow maps, once all else is done.
    ShadowMaps,
}

impl Picture {
    /// Room for what `plan` shows.
    pub(super) fn new(plan: &Plan, chain: &Chain, transparent: bool) -> Self {
        let (view, count) = (&plan.view, plan.view.pixels());
        match plan.output {
            Output::Color | Output::Normal | Output::Albedo if chain.is_empty() => {
                Self::Bytes(vec![[0; 4]; count])
            }
            Output::Color | Output::Normal | Output::Albedo => {
                Self::Linear(LinearFrame::new([view.width, view.height], transparent, chain.spare_planes()))
            }
            Output::Radiance => Self::Radiance(vec![[0.0; 4]; count]),
            Output::Depth | Output::Instance => Self::Values(vec![0; count]),
            Output::Wireframe => Self::Seen(vec![None; count]),
            Output::Ids | Output::Tiles => Self::FalseColors(vec![[0; 4]; count]),
            Output::Shaded => Self::Counts(vec![[0; 4]; count]),
            Output::ShadowMap => Self::ShadowMaps,
        }
    }

    /// What it makes of each tile.
    pub(super) fn tasks<'a>(&'a mut self, plan: &'a Plan, shared: &'a Shared<'a>) -> Vec<TileTask<'a>> {
        let grid = &shared.bins.grid;
        let steps = &plan.post.in_tiles;
        match self {
            Self::Bytes(pixels) => shade(shared, tiles::split(pixels, grid), |work, resolved, tile| {
                output::encode_tile(work.level, resolved, steps, tile);
            }),
            Self::Radiance(pixels) => shade(shared, tiles::split(pixels, grid), |work, resolved, tile| {
                output::write_radiance(work.level, resolved, tile);
            }),
            Self::Linear(frame) => shade(shared, frame.tiles(grid), |work, resolved, tile| {
                post::write_tile(work.level, resolved, steps, tile);
            }),
            Self::Values(pixels) => look(tiles::split(pixels, grid), |scratch, tile| {
                output::write_values(plan, shared.bins, scratch, tile);
            }),
            Self::Seen(entries) => look(tiles::split(entries, grid), |scratch, tile| {
                output::write_entries(shared.bins, scratch, tile);
            }),
            Self::FalseColors(pixels) => look(tiles::split(pixels, grid), |scratch, tile| {
                output::write_false_colors(plan, shared.bins, scratch, tile);
            }),
            Self::Counts(pixels) => shade(shared, tiles::split(pixels, grid), |_, resolved, tile| {
                output::write_counts(resolved, tile);
            }),
            Self::ShadowMaps => (0..grid.tiles()).map(|_| idle()).collect(),
        }
    }

    /// The finished picture.
    pub(super) fn finish(
        self,
        plan: &Plan,
        shared: &Shared,
        chain: &Chain,
        timings: &mut Timings,
        work: &Work,
    ) -> Result<Pixels, Cancelled> {
        let opaque = !shared.background.is_transparent();
        let began = Instant::now();
        match self {
            Self::Bytes(pixels) => Ok(Pixels::Rgba8 { pixels, opaque }),
            Self::Radiance(pixels) => Ok(Pixels::Rgba32F { pixels, opaque }),
            Self::Values(pixels) => Ok(Pixels::Gray16(pixels)),
            Self::FalseColors(pixels) | Self::Counts(pixels) => Ok(Pixels::Rgba8 { pixels, opaque: true }),
            Self::ShadowMaps => {
                let pixels = output::draw_shadow_maps(plan, shared.lighting.maps, work)?;
                timings.push("resolve", super::milliseconds(began));
                Ok(Pixels::Rgba8 { pixels, opaque: true })
            }
            Self::Linear(mut frame) => {
                let mut pixels = vec![[0; 4]; plan.view.pixels()];
                chain.run(&mut frame, work)?;
                output::encode_frame(&frame, chain.last_steps(), &mut pixels, work)?;
                timings.push("post", super::milliseconds(began));
                Ok(Pixels::Rgba8 { pixels, opaque })
            }
            Self::Seen(entries) => {
                let mut pixels = vec![[0; 4]; plan.view.pixels()];
                output::draw_wireframe(&plan.view, shared.bins, &entries, &mut pixels, work)?;
                timings.push("resolve", super::milliseconds(began));
                Ok(Pixels::Rgba8 { pixels, opaque: true })
            }
        }
    }
}

/// Tasks that shade what is seen, and `write` its colours.
fn shade<'a, P: Send>(
    shared: &'a Shared<'a>,
    tiles: Vec<Tile<'a, P>>,
    write: impl Fn(&Work, &Resolved, Tile<P>) + Copy + Send + 'a,
) -> Vec<TileTask<'a>> {
    let task = |tile: Tile<'a, P>| -> TileTask<'a> {
        Box::new(move |scratch, work| {
            tiles::shade(work, shared, scratch, tile, |resolved, tile| write(work, resolved, tile))
        })
    };
    tiles.into_iter().map(task).collect()
}

/// A task that makes nothing of a tile.
fn idle<'a>() -> TileTask<'a> {
    Box::new(|_, _| TileTimes::default())
}

/// Tasks that `write` what is seen as it is.
fn look<'a, P: Send>(
    tiles: Vec<Tile<'a, P>>,
    write: impl Fn(&Scratch, Tile<P>) + Copy + Send + 'a,
) -> Vec<TileTask<'a>> {
    let task = |tile: Tile<'a, P>| -> TileTask<'a> {
        Box::new(move |scratch, _| {
            let mut clock = Clock::start();
            write(scratch, tile);
            TileTimes { raster: clock.lap(), ..TileTimes::default() }
        })
    };
    tiles.into_iter().map(task).collect()
}
