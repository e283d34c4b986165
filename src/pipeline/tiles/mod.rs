//! Tiles: binned triangles in, finished pixels out. Each tile is one independent task.
//!
//! Visibility first: every opaque triangle of the tile goes into a buffer of ids and depths ([`cover`]),
//! then those with holes ([`cut_out`]). What is visible becomes fragments ([`fragments`]), each shaded
//! once, and the samples of a pixel are resolved to its colour. What is blended goes over that, layer
//! by layer ([`blend`]). A tile that has no such triangles goes without.

pub mod blend;
pub mod cover;
pub mod cut_out;
mod depth;
pub mod fragments;
pub mod layers;

use super::geometry::Bins;
use super::geometry::bin::TileGrid;
use super::samples;
use super::shade::varyings::{ShadowFrame, Source};
use super::shade::{self, BLOCK, Lighting, SurfaceShader};
use super::shader::{Outputs, PixelShader};
use super::stats::{Clock, TileTimes};
use super::work::{Cancelled, Work};
use super::{resolve, sky};
use crate::math::View;
use crate::math::simd::*;
use crate::plan::{Draw, Elision, Item, ItemTest, Opacity, Plan, Tally, Unit};
use blend::{Behind, Canvas};
use cover::{BlockDepths, IdTarget, Region, Visibility};
use fragments::{Entry, Fragments, SampleOrder, triangle};
use glam::Vec3;
use layers::{Layers, Opaque, TileList};

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

    /// How many pixels of it lie in the picture.
    #[must_use]
    pub fn area(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Places of all of them in a tile of `side` pixels a row.
    #[must_use]
    pub fn pixels(&self, side: usize) -> Vec<u32> {
        let row = |y: usize| y * side..y * side + self.size[0];
        let pixels = (0..self.size[1]).flat_map(row);
        pixels.map(|pixel| u32::try_from(pixel).expect("a tile is small")).collect()
    }

    /// Screen position of the upper left corner of a pixel of this tile, in sub-pixels.
    #[must_use]
    pub fn corner(&self, pixel: [usize; 2]) -> [i32; 2] {
        [0, 1].map(|axis| self.origin[axis] + 256 * i32::try_from(pixel[axis]).expect("a tile is small"))
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
    /// Ids of the tile's triangles with holes, and of those that are blended.
    cut_outs: Vec<u32>,
    blended: Vec<u32>,
    samples: Visibility,
    blocks: BlockDepths,
    layers: Layers,
    fragments: Fragments,
    colors: [Vec<f32>; 3],
    sky: [Vec<f32>; 3],
    shade: shade::Scratch,
    blend: blend::Scratch,
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
    /// Whether the fragments of each pixel are counted.
    pub counts: bool,
    /// Samples a pixel.
    pub samples: u32,
    /// Them, from the nearest to the pixel's centre to the farthest.
    pub nearest: Vec<usize>,
}

impl Shared<'_> {
    /// What the triangles of a draw look like.
    fn shader(&self, draw: u32) -> SurfaceShader<'_> {
        let draw = &self.draws[draw as usize];
        let (item, lighting) = (&self.items[draw.item as usize], &self.lighting);
        let source = Source::new(item, &draw.surface, &self.frames, lighting.view, lighting.anchor);
        SurfaceShader { source, lighting }
    }
}

/// What decides on triangles with holes.
pub struct AlphaTests<'a> {
    /// The draws of the plan.
    pub draws: &'a [Draw],
    /// The items of the plan.
    pub items: &'a [Item],
    /// The camera.
    pub view: &'a View,
}

impl<'a> AlphaTests<'a> {
    /// Those of a plan.
    #[must_use]
    pub fn of(plan: &'a Plan) -> Self {
        Self { draws: &plan.draws, items: &plan.items, view: &plan.view }
    }

    fn test(&self, draw: u32) -> ItemTest<'a> {
        let draw = &self.draws[draw as usize];
        let test = draw.alpha_test.as_ref().expect("the plan gives every cut-out its test");
        ItemTest { item: &self.items[draw.item as usize], test }
    }
}

impl Scratch {
    /// Lists the tile's triangles in submission order and finds what each sample sees of the opaque ones.
    pub fn find_visible(&mut self, level: Level, bins: &Bins, place: [u32; 2], samples: u32) {
        let grid = &bins.grid;
        bins.list(place, &mut self.list);
        let side = 1 << grid.tile_shift;
        let pattern = samples::pattern(samples);
        self.samples.clear(side, pattern.len());
        self.blocks.begin(side, bins.elide);
        let region = Region::of_tile(grid, place[0], place[1]);
        self.cut_outs.clear();
        self.blended.clear();
        let triangles = self.list.iter().zip(1..).map(|(&entry, id)| (triangle(entry, bins).1, id));
        dispatch!(level, simd => {
            for (t, id) in triangles {
                match t.opacity() {
                    Opacity::Opaque => {
                        let mut target = IdTarget { samples: &mut self.samples, id };
                        cover::cover(simd, t, &region, side, pattern, &mut self.blocks, &mut target);
                    }
                    Opacity::CutOut => self.cut_outs.push(id),
                    Opacity::Blended => self.blended.push(id),
                }
            }
        });
    }

    /// Finds what samples see of the triangles with holes of the tile that [`Scratch::find_visible`] left.
    pub fn find_cut_outs(
        &mut self,
        work: &Work,
        bins: &Bins,
        place: [u32; 2],
        order: &SampleOrder,
        tests: &AlphaTests,
    ) {
        if self.cut_outs.is_empty() {
            return;
        }
        let region = Region::of_tile(&bins.grid, place[0], place[1]);
        let tile =
            TileList { bins, list: &self.list, region: &region, side: 1 << bins.grid.tile_shift, order };
        cut_out::draw(
            work,
            &tile,
            &self.cut_outs,
            |draw| tests.test(draw),
            tests.view,
            &mut self.samples,
            &self.blocks,
            &mut self.layers,
            &mut self.shade,
        );
    }

    /// Draws the tile's blended triangles over its resolved colours, and counts their fragments if `counts`
    /// is there.
    fn blend(
        &mut self,
        work: &Work,
        shared: &Shared,
        region: &Region,
        order: &SampleOrder,
        coverage: Option<&mut [f32]>,
        counts: Option<&mut [u32]>,
    ) -> TileTimes {
        let side = 1 << shared.bins.grid.tile_shift;
        let tile = TileList { bins: shared.bins, list: &self.list, region, side, order };
        let opaque = Opaque { samples: &self.samples, blocks: &self.blocks };
        let behind = Behind { opaque, fragments: &self.fragments, sky: &self.sky };
        let mut canvas = Canvas { colors: &mut self.colors, coverage, counts };
        let scratch = (&mut self.blend, &mut self.shade);
        blend::draw(work, shared, &tile, &self.blended, &behind, &mut canvas, scratch)
    }

    /// What looking at the tile cost, and what it was spared.
    fn take_look_tally(&mut self) -> Tally {
        let mut tally = self.blocks.take_tally();
        tally.add(&self.layers.take_tally());
        tally.add(&self.shade.take_tally());
        tally.count(Unit::Tiles, 1);
        tally.count(Unit::EmptyTiles, u64::from(self.list.is_empty()));
        tally
    }

    /// What shading the tile cost, and what it was spared.
    fn take_shade_tally(&mut self, region: &Region) -> Tally {
        let mut tally = self.shade.take_tally();
        tally.add(&self.fragments.tally(region));
        tally.add(&self.blend.take_tally());
        tally
    }

    /// What each sample of the tile sees, as [`Scratch::find_visible`] and
    /// [`Scratch::find_cut_outs`] left it.
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
    /// Fragments that were shaded for each pixel; `None` where nobody asks.
    pub counts: Option<&'a [u32]>,
    /// Pixels from one row to the next.
    pub side: usize,
    /// Whether every pixel looks the same.
    pub plain: bool,
}

/// What is looked at: a tile's samples see the same for all outputs of it.
pub struct Look<'a> {
    /// The triangles.
    pub bins: &'a Bins,
    /// Samples a pixel.
    pub samples: u32,
    /// What decides on those with holes.
    pub tests: AlphaTests<'a>,
}

/// What one output makes of a tile, once it is known what its samples see.
pub type TileTask<'a> = Box<dyn FnOnce(&mut Scratch, &Work) -> TileTimes + Send + 'a>;

/// Looks at every tile once, and gives what its samples see to the task of each output. `outputs` has a
/// task a tile for each of them, in the order of [`split`]. Returns each one's times; the look is on the
/// first one's account.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(look: &Look, outputs: Vec<Vec<TileTask>>, work: &Work) -> Result<Vec<TileTimes>, Cancelled> {
    let grid = &look.bins.grid;
    let nearest = samples::nearest_to_centre(look.samples);
    let order = SampleOrder { pattern: samples::pattern(look.samples), nearest: &nearest };
    let mut totals = vec![TileTimes::default(); outputs.len()];
    let mut tiles: Vec<(u32, Vec<TileTask>)> = (0..grid.tiles()).map(|tile| (tile, Vec::new())).collect();
    for tasks in outputs {
        tiles.iter_mut().zip(tasks).for_each(|((_, tile), task)| tile.push(task));
    }
    let times = work.map(tiles, Scratch::default, |scratch, (tile, tasks)| {
        let place = [tile % grid.columns, tile / grid.columns];
        let mut clock = Clock::start();
        scratch.find_visible(work.level, look.bins, place, look.samples);
        scratch.find_cut_outs(work, look.bins, place, &order, &look.tests);
        let look =
            TileTimes { raster: clock.lap(), tally: scratch.take_look_tally(), ..TileTimes::default() };
        let times: Vec<TileTimes> = tasks.into_iter().map(|task| task(scratch, work)).collect();
        (look, times)
    })?;
    for (look, tasks) in &times {
        totals.iter_mut().take(1).for_each(|first| first.add(look));
        totals.iter_mut().zip(tasks).for_each(|(total, task)| total.add(task));
    }
    Ok(totals)
}

/// Shades what the samples of a tile see: fragments, sky, resolve, what is blended over them. `write` takes
/// the colours to the tile's rows.
pub fn shade<P>(
    work: &Work,
    shared: &Shared,
    scratch: &mut Scratch,
    tile: Tile<P>,
    write: impl Fn(&Resolved, Tile<P>),
) -> TileTimes {
    let may_fill = scratch.list.is_empty() && shared.lighting.elide.contains(Elision::PlainTiles);
    match shared.background.plain().filter(|_| may_fill) {
        Some(color) => fill(shared, scratch, color, tile, write),
        None => shade_pixels(work, shared, scratch, tile, write),
    }
}

/// Shades a tile pixel by pixel.
fn shade_pixels<P>(
    work: &Work,
    shared: &Shared,
    scratch: &mut Scratch,
    tile: Tile<P>,
    write: impl Fn(&Resolved, Tile<P>),
) -> TileTimes {
    let mut clock = Clock::start();
    let mut times = TileTimes::default();
    let level = work.level;
    let grid = &shared.bins.grid;
    let side = 1usize << grid.tile_shift;
    let region = Region::of_tile(grid, tile.place[0], tile.place[1]);
    let order = SampleOrder { pattern: samples::pattern(shared.samples), nearest: &shared.nearest };

    scratch.fragments.collect(level, &scratch.samples, &region, side, &order, &scratch.list, shared.bins);
    times.raster = clock.lap();

    scratch.colors.iter_mut().for_each(|channel| {
        channel.clear();
        channel.resize(scratch.fragments.targets, 0.0);
    });
    if !scratch.fragments.sorted.is_empty() {
        shade_fragments(level, shared, scratch);
        times.shade = clock.lap();
    }

    if draw_sky(level, shared, scratch, &region, side, &mut times.tally) {
        times.sky = clock.lap();
    }

    resolve::resolve(&scratch.fragments, &scratch.sky, shared.samples, side, &mut scratch.colors);
    let transparent = shared.background.is_transparent();
    let mut alpha = transparent.then(|| resolve::coverage(&scratch.fragments, shared.samples, side));
    let mut counts = shared.counts.then(|| scratch.fragments.counts(side));
    times.resolve = clock.lap();

    if !scratch.blended.is_empty() {
        let (alpha, counts) = (alpha.as_deref_mut(), counts.as_deref_mut());
        times.add(&scratch.blend(work, shared, &region, &order, alpha, counts));
        clock.lap();
    }
    let (alpha, counts) = (alpha.as_deref(), counts.as_deref());
    write(&Resolved { colors: &scratch.colors, alpha, counts, side, plain: false }, tile);
    times.tally.count(Unit::PixelTiles, 1);
    times.tally.add(&scratch.take_shade_tally(&region));
    times.resolve += clock.lap();
    times
}

/// Draws the background where it is seen; false if that is nowhere.
fn draw_sky(
    level: Level,
    shared: &Shared,
    scratch: &mut Scratch,
    region: &Region,
    side: usize,
    tally: &mut Tally,
) -> bool {
    scratch.sky.iter_mut().for_each(|channel| channel.resize(side * side, 0.0));
    let everywhere = (!shared.lighting.elide.contains(Elision::CoveredSky)).then(|| region.pixels(side));
    let pixels = everywhere.as_ref().unwrap_or(&scratch.fragments.sky);
    tally.count(Unit::SkyPixels, pixels.len() as u64);
    tally.spare(Elision::CoveredSky, (region.area() - pixels.len()) as u64);
    if pixels.is_empty() {
        return false;
    }
    shared.background.draw(level, pixels, region, side, &mut scratch.sky);
    true
}

/// Fills a tile in which nothing is drawn over a background of one colour.
fn fill<P>(
    shared: &Shared,
    scratch: &mut Scratch,
    color: Vec3,
    tile: Tile<P>,
    write: impl Fn(&Resolved, Tile<P>),
) -> TileTimes {
    let mut clock = Clock::start();
    let mut times = TileTimes::default();
    let side = 1usize << shared.bins.grid.tile_shift;
    let area = Region::of_tile(&shared.bins.grid, tile.place[0], tile.place[1]).area();
    for (channel, value) in scratch.colors.iter_mut().zip(color.to_array()) {
        channel.clear();
        channel.resize(side * side, value);
    }
    times.tally.count(Unit::SkyPixels, area as u64);
    times.tally.spare(Elision::PlainTiles, 1);
    times.sky = clock.lap();
    let alpha = shared.background.is_transparent().then(|| vec![0.0; side * side]);
    let counts = shared.counts.then(|| vec![0; side * side]);
    let (alpha, counts) = (alpha.as_deref(), counts.as_deref());
    write(&Resolved { colors: &scratch.colors, alpha, counts, side, plain: true }, tile);
    times.resolve = clock.lap();
    times
}

/// Shades every fragment of the tile, draw by draw.
fn shade_fragments(level: Level, shared: &Shared, scratch: &mut Scratch) {
    let mut out = Outputs::default();
    let Scratch { fragments, list, colors, shade, .. } = scratch;
    for run in &fragments.runs {
        let shader = shared.shader(run.draw);
        let visible = fragments.visible[run.first[0]..run.end[0]].iter();
        let mut visible = visible.map(|&id| triangle(list[id as usize - 1], shared.bins));
        let mut shading = shader.open(&mut visible);
        for block in fragments.sorted[run.first[1]..run.end[1]].chunks(BLOCK) {
            shading.shade(level, block, shade, &mut out);
            for (i, fragment) in block.iter().enumerate() {
                for (channel, value) in colors.iter_mut().zip(&out.colors[0]) {
                    channel[fragment.target as usize] = value[i];
                }
            }
        }
    }
}
