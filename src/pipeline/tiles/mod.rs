//! Tiles: binned triangles in, finished pixels out. Each tile is one independent task.
//!
//! Visibility first: every triangle of the tile goes into a buffer of ids and depths ([`cover`]).
//! What is visible becomes fragments ([`fragments`]), each shaded once, and the samples of a pixel
//! are resolved to its colour.

pub mod cover;
mod depth;
pub mod fragments;

use super::geometry::Bins;
use super::geometry::bin::TileGrid;
use super::samples;
use super::shade::varyings::{Records, ShadowFrame, Source};
use super::shade::{self, BLOCK, Lighting};
use super::stats::TileTimes;
use super::work::{Cancelled, Work};
use super::{resolve, sky};
use crate::math::simd::*;
use crate::plan::{Draw, Item};
use cover::{BlockDepths, IdTarget, Region, Visibility};
use fragments::{Entry, Fragments, SampleOrder, triangle};
use std::time::Instant;

/// log2 of a tile's side: smaller with many samples, so that a tile's buffers stay in L2.
#[must_use]
pub fn tile_shift(samples: u32) -> u32 {
    if samples >= 8 { 5 } else { 6 }
}

impl Region {
    /// The tile at (column, row).
    #[must_use]
    pub fn of_tile(grid: &TileGrid, column: u32, row: u32) -> Self {
        let first = [column, row].map(|n| n << grid.tile_shift);
        let side = 1 << grid.tile_shift;
        let size = [grid.width - first[0], grid.height - first[1]].map(|n| n.min(side) as usize);
        let origin = [0, 1].map(|axis| grid.origin[axis] + first[axis].cast_signed() * 256);
        Self { origin, size }
    }

    /// Screen position of the centre of a pixel of this tile.
    #[must_use]
    pub fn centre(&self, pixel: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let offset = i32::try_from(pixel[axis] * 256 + 128).expect("a tile is small");
            f64::from(self.origin[axis] + offset)
        })
    }
}

/// One tile and the rows of the picture that are its own.
pub struct Tile<'a, P> {
    /// Where it lies.
    pub place: [u32; 2],
    /// Its part of each row.
    pub rows: Vec<&'a mut [P]>,
}

/// Splits a picture into the rows of its tiles, so that each can be written by its own task.
pub fn split<'a, P>(pixels: &'a mut [P], grid: &TileGrid) -> Vec<Tile<'a, P>> {
    let side = 1usize << grid.tile_shift;
    let mut tiles = Vec::with_capacity(grid.tiles() as usize);
    let bands = pixels.chunks_mut(grid.width as usize * side);
    for (row, band) in (0..).zip(bands) {
        let first = tiles.len();
        tiles.extend(
            (0..grid.columns).map(|column| Tile { place: [column, row], rows: Vec::with_capacity(side) }),
        );
        for line in band.chunks_mut(grid.width as usize) {
            for (tile, part) in tiles[first..].iter_mut().zip(line.chunks_mut(side)) {
                tile.rows.push(part);
            }
        }
    }
    tiles
}

/// Buffers of one worker, kept between tiles.
#[derive(Default)]
pub struct Scratch {
    list: Vec<Entry>,
    samples: Visibility,
    blocks: BlockDepths,
    fragments: Fragments,
    colors: [Vec<f32>; 3],
    sky: [Vec<f32>; 3],
    shade: shade::Scratch,
}

/// What every tile of a frame shares.
pub struct Shared<'a> {
    /// What to draw.
    pub bins: &'a Bins,
    /// The draws of the plan.
    pub draws: &'a [Draw],
    /// The items of the plan.
    pub items: &'a [Item],
    /// Lights, maps, camera.
    pub lighting: Lighting<'a>,
    /// How receivers find their place in each map.
    pub frames: Vec<ShadowFrame>,
    /// What is seen where nothing is.
    pub background: sky::Background,
    /// Samples a pixel.
    pub samples: u32,
}

impl Scratch {
    /// Lists the tile's triangles in submission order and finds what each sample sees.
    pub fn find_visible(&mut self, level: Level, bins: &Bins, place: [u32; 2], samples: u32) {
        let grid = &bins.grid;
        bins.list(place, &mut self.list);
        let side = 1 << grid.tile_shift;
        let pattern = samples::pattern(samples);
        self.samples.clear(side, pattern.len());
        self.blocks.clear(side);
        let region = Region::of_tile(grid, place[0], place[1]);
        let triangles = self.list.iter().zip(1..).map(|(&entry, id)| (triangle(entry, bins).1, id));
        dispatch!(level, simd => {
            for (t, id) in triangles {
                let mut target = IdTarget { samples: &mut self.samples, id };
                cover::cover(simd, t, &region, side, pattern, &mut self.blocks, &mut target);
            }
        });
    }

    /// What each sample of the tile sees, as [`Scratch::find_visible`] left it.
    #[must_use]
    pub fn visibility(&self) -> &Visibility {
        &self.samples
    }

    /// The tile's triangles in submission order: what an id of [`Scratch::visibility`] counts in.
    #[must_use]
    pub fn list(&self) -> &[Entry] {
        &self.list
    }

    /// Which triangle the pixel's first sample sees.
    #[must_use]
    pub fn entry(&self, pixel: usize) -> Option<Entry> {
        let id = self.samples.id[pixel] as usize;
        (id > 0).then(|| self.list[id - 1])
    }

    /// The triangle that the pixel's first sample sees.
    #[must_use]
    pub fn seen<'a>(&self, pixel: usize, bins: &'a Bins) -> Option<&'a super::geometry::setup::Triangle> {
        self.entry(pixel).map(|entry| triangle(entry, bins).1)
    }
}

/// The colours of a tile, ready to be written.
pub struct Resolved<'a> {
    /// Linear red, green and blue of the pixel (x, y) at `y · side + x`; premultiplied with alpha.
    pub colors: &'a [Vec<f32>; 3],
    /// Share of each pixel that surfaces cover; `None` before a background that covers the rest.
    pub alpha: Option<&'a [f32]>,
    /// Pixels from one row to the next.
    pub side: usize,
}

/// Draws the tiles of a picture of colours. `write` takes each tile's colours to its rows.
///
/// # Errors
/// [`Cancelled`].
pub fn draw<P: Send>(
    shared: &Shared,
    tiles: Vec<Tile<P>>,
    write: impl Fn(&Resolved, Tile<P>) + Sync,
    work: &Work,
) -> Result<TileTimes, Cancelled> {
    let nearest = samples::nearest_to_centre(shared.samples);
    let order = SampleOrder { pattern: samples::pattern(shared.samples), nearest: &nearest };
    let times = work.map(tiles, Scratch::default, |scratch, tile| {
        draw_tile(work.level, shared, &order, scratch, tile, &write)
    })?;
    let mut total = TileTimes::default();
    times.iter().for_each(|t| total.add(t));
    Ok(total)
}

fn draw_tile<P>(
    level: Level,
    shared: &Shared,
    order: &SampleOrder,
    scratch: &mut Scratch,
    tile: Tile<P>,
    write: impl Fn(&Resolved, Tile<P>),
) -> TileTimes {
    let mut clock = Clock::start();
    let mut times = TileTimes::default();
    let grid = &shared.bins.grid;
    let side = 1usize << grid.tile_shift;
    let region = Region::of_tile(grid, tile.place[0], tile.place[1]);

    scratch.find_visible(level, shared.bins, tile.place, shared.samples);
    scratch.fragments.collect(level, &scratch.samples, &region, side, order, &scratch.list, shared.bins);
    times.raster = clock.lap();

    scratch.colors.iter_mut().for_each(|channel| {
        channel.clear();
        channel.resize(scratch.fragments.targets, 0.0);
    });
    shade_fragments(level, shared, scratch);
    times.shaded = scratch.fragments.sorted.len() as u64;
    times.shade = clock.lap();

    scratch.sky.iter_mut().for_each(|channel| channel.resize(side * side, 0.0));
    shared.background.draw(level, &scratch.fragments.sky, &region, side, &mut scratch.sky);
    times.sky = clock.lap();

    resolve::resolve(&scratch.fragments, &scratch.sky, shared.samples, side, &mut scratch.colors);
    let transparent = shared.background.is_transparent();
    let alpha = transparent.then(|| resolve::coverage(&scratch.fragments, shared.samples, side));
    write(&Resolved { colors: &scratch.colors, alpha: alpha.as_deref(), side }, tile);
    times.resolve = clock.lap();
    times
}

/// Shades every fragment of the tile, draw by draw.
fn shade_fragments(level: Level, shared: &Shared, scratch: &mut Scratch) {
    let mut out = [[0.0; BLOCK]; 3];
    for run in &scratch.fragments.runs {
        let draw = &shared.draws[run.draw as usize];
        let item = &shared.items[draw.item as usize];
        let source =
            Source::new(item, &draw.surface, &shared.frames, shared.lighting.view, shared.lighting.anchor);
        let mut records = Records::new(&source);
        for &id in &scratch.fragments.visible[run.first[0]..run.end[0]] {
            let (chunk, t) = triangle(scratch.list[id as usize - 1], shared.bins);
            records.push(&source, t, chunk);
        }
        for block in scratch.fragments.sorted[run.first[1]..run.end[1]].chunks(BLOCK) {
            shade::shade_block(
                level,
                block,
                &records,
                &source,
                &shared.lighting,
                &mut scratch.shade,
                &mut out,
            );
            for (i, fragment) in block.iter().enumerate() {
                for (channel, value) in scratch.colors.iter_mut().zip(&out) {
                    channel[fragment.target as usize] = value[i];
                }
            }
        }
    }
}

/// A stopwatch that is read lap by lap.
struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        Self(Instant::now())
    }

    /// Seconds since the last lap.
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let seconds = (now - self.0).as_secs_f64();
        self.0 = now;
        seconds
    }
}
