//! One shadow map: casters in, the nearest depth a texel out.

use crate::math::View;
use crate::math::simd::*;
use crate::pipeline::geometry::{self, Bins, bin::TileGrid};
use crate::pipeline::tiles::cover::{self, BlockDepths, DepthTarget, Region, Visibility};
use crate::pipeline::tiles::cut_out;
use crate::pipeline::tiles::fragments::{Entry, SampleOrder};
use crate::pipeline::tiles::layers::{Layers, TileList};
use crate::pipeline::work::{Cancelled, Work};
use crate::pipeline::{samples, shade};
use crate::plan::{Elisions, Face, Opacity, Tally};

pub(super) const TILE_SHIFT: u32 = 6;
pub(super) const TILE_SIDE: usize = 1 << TILE_SHIFT;
const TILE_TEXELS: usize = TILE_SIDE * TILE_SIDE;

/// 64×64 depths.
pub(super) type Tile = [f32; TILE_TEXELS];

/// Depth of the nearest caster in each texel, reversed: 1 next to the light, 0 where there is none.
/// Tiles that no caster touches take no memory.
#[derive(Debug, PartialEq)]
pub struct DepthMap {
    /// Texels along a side.
    resolution: u32,
    /// Tiles in a row.
    columns: usize,
    tiles: Vec<Option<Box<Tile>>>,
    /// What drawing it cost, and what it was spared.
    tally: Box<Tally>,
}

/// The texels of a kernel: first and last x, first and last y; −1 and the resolution stand for all that
/// lies outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TexelBox {
    pub(super) x: [i32; 2],
    pub(super) y: [i32; 2],
}

/// Where the texels of a kernel are.
pub(super) enum Window<'a> {
    /// In one tile.
    Tile(&'a Tile),
    /// In several, or in part outside the map.
    Map(&'a DepthMap),
}

impl DepthMap {
    /// Draws the casters of `face`: the same geometry and coverage code as the picture, with depth alone
    /// as its target.
    pub(super) fn draw(face: &Face, elide: Elisions, work: &Work) -> Result<Self, Cancelled> {
        let view: &View = &face.view;
        let grid = TileGrid::new(view, TILE_SHIFT, samples::pattern(1));
        let bins = geometry::run(&face.items, view, grid, elide, work)?;
        let touched: Vec<(u32, u32)> = (0..grid.rows)
            .flat_map(|row| (0..grid.columns).map(move |column| (column, row)))
            .filter(|&(column, row)| bins.chunks.iter().any(|chunk| !chunk.tile(column, row).is_empty()))
            .collect();
        let drawn = work.map(touched.clone(), Scratch::default, |scratch, place| {
            draw_tile(work, face, &bins, place, scratch)
        })?;
        let mut tiles: Vec<Option<Box<Tile>>> = (0..grid.tiles()).map(|_| None).collect();
        let mut tally = bins.tally;
        for (&(column, row), (tile, cost)) in touched.iter().zip(drawn) {
            tiles[(row * grid.columns + column) as usize] = Some(tile);
            tally.add(&cost);
        }
        Ok(Self { resolution: view.width, columns: grid.columns as usize, tiles, tally: Box::new(tally) })
    }

    /// What drawing it cost, and what it was spared.
    pub(super) fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Texels along a side.
    #[inline(always)]
    #[must_use]
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Tiles in a row.
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// Every tile, row by row; `None` where nothing is.
    pub(super) fn tiles(&self) -> &[Option<Box<Tile>>] {
        &self.tiles
    }

    /// The stored depths of all casters, tile by tile.
    pub fn depths(&self) -> impl Iterator<Item = f32> {
        self.tiles.iter().flatten().flat_map(|tile| tile.iter().copied()).filter(|depth| *depth > 0.0)
    }

    /// The stored depth; 0 outside the map.
    #[inline(always)]
    #[must_use]
    pub fn texel(&self, x: i32, y: i32) -> f32 {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return 0.0 };
        let side = self.resolution as usize;
        if x >= side || y >= side {
            return 0.0;
        }
        match &self.tiles[(y >> TILE_SHIFT) * self.columns + (x >> TILE_SHIFT)] {
            Some(tile) => tile[(y % TILE_SIDE) * TILE_SIDE + x % TILE_SIDE],
            None => 0.0,
        }
    }

    /// Numbers of the texels at eight coordinates that count from the map's corner; −1 and the
    /// resolution for all that lies outside (and for what is no number).
    #[inline(always)]
    pub(super) fn texel_numbers<S: Simd>(&self, simd: S, from_corner: f32x8<S>) -> i32x8<S> {
        let side = f32x8::splat(simd, float(self.resolution));
        min(max(from_corner.floor(), f32x8::splat(simd, -1.0)), side).to_int_precise()
    }

    /// Where the texels of a box are.
    #[inline(always)]
    pub(super) fn window(&self, texels: &TexelBox) -> Window<'_> {
        let tile = |n: i32| n >> TILE_SHIFT;
        let side = self.resolution.cast_signed();
        let [inside_x, inside_y] =
            [texels.x, texels.y].map(|[first, last]| first >= 0 && last < side && tile(first) == tile(last));
        if inside_x && inside_y {
            let [column, row] = [texels.x, texels.y].map(|c| tile(c[0]).cast_unsigned() as usize);
            if let Some(tile) = &self.tiles[row * self.columns + column] {
                return Window::Tile(tile);
            }
        }
        Window::Map(self)
    }
}

/// Buffers of one worker, kept between tiles.
#[derive(Default)]
struct Scratch {
    blocks: BlockDepths,
    /// Triangles with holes, and their ids.
    cut_outs: (Vec<Entry>, Vec<u32>),
    layers: Layers,
    shade: shade::Scratch,
}

/// Draws the tile at (column, row): opaque casters, then those with holes.
fn draw_tile(
    work: &Work,
    face: &Face,
    bins: &Bins,
    (column, row): (u32, u32),
    scratch: &mut Scratch,
) -> (Box<Tile>, Tally) {
    let pattern = samples::pattern(1);
    let mut samples = Visibility { depth: vec![0.0; TILE_TEXELS], id: Vec::new() };
    let Scratch { blocks, cut_outs: (list, ids), layers, shade } = scratch;
    blocks.begin(TILE_SIDE, bins.elide);
    list.clear();
    let region = Region::of_tile(&bins.grid, column, row);
    dispatch!(work.level, simd => {
        let mut target = DepthTarget { depth: &mut samples.depth };
        for (number, chunk) in (0..).zip(&bins.chunks) {
            for &index in chunk.tile(column, row) {
                let triangle = &chunk.triangles[index as usize];
                if triangle.opacity() == Opacity::Opaque {
                    cover::cover(simd, triangle, &region, TILE_SIDE, pattern, blocks, &mut target);
                } else {
                    list.push((number, index));
                }
            }
        }
    });
    if !list.is_empty() {
        // Among depths alone it does not matter whose they are.
        samples.id.resize(TILE_TEXELS, 0);
        ids.clear();
        ids.extend((1..).take(list.len()));
        let order = SampleOrder { pattern, nearest: &[0] };
        let tile = TileList { bins, list, region: &region, side: TILE_SIDE, order: &order };
        let test = |draw| face.test(draw);
        cut_out::draw(work, &tile, ids, test, &face.view, &mut samples, blocks, layers, shade);
    }
    let mut tally = blocks.take_tally();
    tally.add(&layers.take_tally());
    (samples.depth.into_boxed_slice().try_into().expect("a tile of texels"), tally)
}

impl TexelBox {
    /// The texels between coordinates that count from the corner of a map of `resolution`.
    #[inline(always)]
    pub(super) fn between(x: [f32; 2], y: [f32; 2], resolution: u32) -> Self {
        let side = float(resolution);
        let number = always(
            #[inline(always)]
            |c: f32| {
                let c = c.floor();
                let bounded = if c > -1.0 { if c < side { c } else { side } } else { -1.0 };
                #[expect(clippy::cast_possible_truncation, reason = "a whole number from −1 to 2¹⁴")]
                {
                    bounded as i32
                }
            },
        );
        Self { x: x.map(number), y: y.map(number) }
    }
}

impl Window<'_> {
    /// The depths of eight texels of the box that this is the window of.
    #[inline(always)]
    pub(super) fn texels<S: Simd>(&self, simd: S, x: i32x8<S>, y: i32x8<S>) -> f32x8<S> {
        match self {
            Self::Tile(tile) => {
                let last = (1 << TILE_SHIFT) - 1;
                let at = ((y & last) << TILE_SHIFT) | (x & last);
                f32x8::from_fn(
                    simd,
                    #[inline(always)]
                    |lane| tile[at[lane].cast_unsigned() as usize % TILE_TEXELS],
                )
            }
            Self::Map(map) => f32x8::from_fn(
                simd,
                #[inline(always)]
                |lane| map.texel(x[lane], y[lane]),
            ),
        }
    }
}

/// Texels along a side as a coordinate.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "at most 2¹⁴ texels a side")]
pub(super) fn float(side: u32) -> f32 {
    side as f32
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A map of any depths; whole tiles of nothing are left out.
    pub(in super::super) fn map_of(resolution: u32, depth: impl Fn(u32, u32) -> f32) -> DepthMap {
        let columns = resolution.div_ceil(64);
        let tile = |column: u32, row: u32| {
            let mut tile: Box<Tile> =
                vec![0.0; TILE_TEXELS].into_boxed_slice().try_into().expect("a tile of texels");
            for (i, texel) in (0..).zip(tile.iter_mut()) {
                let (x, y) = (column * 64 + i % 64, row * 64 + i / 64);
                *texel = if x < resolution && y < resolution { depth(x, y) } else { 0.0 };
            }
            tile.iter().any(|&depth| depth > 0.0).then_some(tile)
        };
        let tiles = (0..columns * columns).map(|i| tile(i % columns, i / columns)).collect();
        DepthMap { resolution, columns: columns as usize, tiles, tally: Box::default() }
    }

    #[test]
    fn a_window_shows_what_the_map_shows() {
        let map = map_of(150, |x, y| float(1 + x + 150 * y) / 32768.0);
        for (x, y) in [([3, 10], [3, 10]), ([60, 70], [3, 10]), ([-1, 5], [140, 150]), ([128, 135], [64, 71])]
        {
            let window = map.window(&TexelBox { x, y });
            let inside_one = x[0] >> 6 == x[1] >> 6 && y[0] >> 6 == y[1] >> 6 && x[0] >= 0 && y[1] < 150;
            assert_eq!(matches!(window, Window::Tile(_)), inside_one);
            dispatch!(Level::new(), simd => {
                let row = ramp_i32(simd) + x[0];
                let column = ramp_i32(simd) + y[0];
                let seen = window.texels(simd, row, column);
                for i in 0..LANES {
                    assert_eq!(seen[i], map.texel(row[i], column[i]));
                }
            });
        }
    }
}
