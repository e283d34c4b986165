//! Shadow maps: casters in, one depth map a light out, and the question that shading asks of it.
//!
//! The map is drawn by the same geometry and coverage code as the picture, with depth alone as its
//! target. Tiles that no caster touches take no memory.

use super::geometry::{self, Bins, bin::TileGrid};
use super::samples;
use super::shade::{self, BLOCK, varyings::ShadowFrame};
use super::tiles::cover::{self, BlockDepths, DepthTarget, Region, Visibility};
use super::tiles::cut_out;
use super::tiles::fragments::{Entry, SampleOrder};
use super::tiles::layers::{Layers, TileList};
use super::work::{Cancelled, Work};
use crate::math::simd::*;
use crate::plan::{Opacity, ShadowPass};
use glam::DMat3;

const TILE_SHIFT: u32 = 6;
const TILE_SIDE: usize = 1 << TILE_SHIFT;
const TILE_TEXELS: usize = TILE_SIDE * TILE_SIDE;

/// Depth of the nearest caster along each line of light, reversed: 1 next to the light, 0 where
/// there is none.
#[derive(Debug)]
pub struct ShadowMap {
    /// Texels along a side.
    resolution: u32,
    columns: usize,
    /// For each tile, its place in `tiles`; 0 is the empty tile.
    places: Vec<u32>,
    /// 64×64 texels each.
    tiles: Vec<Vec<f32>>,
}

/// Draws the map of each pass.
///
/// # Errors
/// [`Cancelled`].
pub fn render_maps(passes: &[ShadowPass], work: &Work) -> Result<Vec<ShadowMap>, Cancelled> {
    passes.iter().map(|pass| render_map(pass, work)).collect()
}

fn render_map(pass: &ShadowPass, work: &Work) -> Result<ShadowMap, Cancelled> {
    let pattern = samples::pattern(1);
    let grid = TileGrid::new(&pass.view, TILE_SHIFT, pattern);
    let bins = geometry::run(&pass.items, &pass.view, grid, work)?;
    let touched: Vec<(u32, u32)> = (0..grid.rows)
        .flat_map(|row| (0..grid.columns).map(move |column| (column, row)))
        .filter(|&(column, row)| bins.chunks.iter().any(|chunk| !chunk.tile(column, row).is_empty()))
        .collect();
    let drawn = work.map(touched.clone(), Scratch::default, |scratch, place| {
        draw_tile(work.level, pass, &bins, place, scratch)
    })?;
    let mut places = vec![0; grid.tiles() as usize];
    for (&(column, row), place) in touched.iter().zip(1..) {
        places[(row * grid.columns + column) as usize] = place;
    }
    let tiles = std::iter::once(vec![0.0; TILE_TEXELS]).chain(drawn).collect();
    Ok(ShadowMap { resolution: pass.view.width, columns: grid.columns as usize, places, tiles })
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
    level: Level,
    pass: &ShadowPass,
    bins: &Bins,
    (column, row): (u32, u32),
    scratch: &mut Scratch,
) -> Vec<f32> {
    let pattern = samples::pattern(1);
    let mut samples = Visibility { depth: vec![0.0; TILE_TEXELS], id: Vec::new() };
    let Scratch { blocks, cut_outs: (list, ids), layers, shade } = scratch;
    blocks.clear(TILE_SIDE);
    list.clear();
    let region = Region::of_tile(&bins.grid, column, row);
    dispatch!(level, simd => {
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
        let test = |draw| pass.test(draw);
        cut_out::draw(level, &tile, ids, test, &pass.view, &mut samples, blocks, layers, shade);
    }
    samples.depth
}

impl ShadowMap {
    /// 1 where the light reaches the receivers of a block, 0 where a caster lies before them; only those
    /// whose bit is set in `asked` need an answer.
    ///
    /// `coordinates` are texel x and y from the map's centre, and depth, as [`ShadowFrame`] makes
    /// them. Outside the map no caster is, and what lies nearer to the light than all of them is lit
    /// as well.
    pub fn visibility(
        &self,
        level: Level,
        coordinates: &[[f32; BLOCK]; 3],
        asked: u64,
        out: &mut [f32; BLOCK],
    ) {
        dispatch!(level, simd => {
            for at in (0..BLOCK).step_by(LANES) {
                if asked >> at & 0xff != 0 {
                    self.visibility_of_eight(simd, coordinates, at).store_slice(&mut out[at..at + LANES]);
                }
            }
        });
    }

    #[inline(always)]
    fn visibility_of_eight<S: Simd>(&self, simd: S, coordinates: &[[f32; BLOCK]; 3], at: usize) -> f32x8<S> {
        let side = float(self.resolution);
        let texel = always(
            #[inline(always)]
            |axis: usize| {
                let from_centre = f32x8::from_slice(simd, &coordinates[axis][at..at + LANES]);
                let index = (from_centre + side * 0.5).floor();
                let bounded = min(max(index, f32x8::splat(simd, -1.0)), f32x8::splat(simd, side));
                let index: i32x8<S> = bounded.to_int_precise();
                index
            },
        );
        let (x, y) = (texel(0), texel(1));
        let depth = f32x8::from_slice(simd, &coordinates[2][at..at + LANES]);
        let nearest = f32x8::from_fn(
            simd,
            #[inline(always)]
            |lane| self.texel(x[lane], y[lane]),
        );
        // The receiver's own rounding: 16 units in the last place of the depth range.
        let tolerance = 16.0 * f32::EPSILON * 0.5;
        let lit = nearest.simd_le(depth + tolerance) | nearest.simd_eq(f32x8::splat(simd, 0.0));
        lit.select(f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.0))
    }

    /// The stored depth; 0 outside the map.
    #[inline(always)]
    fn texel(&self, x: i32, y: i32) -> f32 {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return 0.0 };
        let side = self.resolution as usize;
        if x >= side || y >= side {
            return 0.0;
        }
        let tile = self.places[(y >> TILE_SHIFT) * self.columns + (x >> TILE_SHIFT)] as usize;
        self.tiles[tile][(y % TILE_SIDE) * TILE_SIDE + x % TILE_SIDE]
    }
}

#[expect(clippy::cast_precision_loss, reason = "at most 2¹⁴ texels a side")]
fn float(side: u32) -> f32 {
    side as f32
}

/// How receivers find their place in the map of `pass`.
#[must_use]
pub fn frame(pass: &ShadowPass) -> ShadowFrame {
    let view = &pass.view;
    let [x, y] = view.scale.map(|scale| scale / 256.0);
    let depth = view.depth_slope();
    let rows = DMat3::from_cols(view.right * x, view.up * -y, view.forward * -depth);
    // Half a texel is the farthest that a texel's centre lies from what it is asked about; 1/128 more
    // covers the snapping of its triangle and the rounding of the coordinates.
    let reach = (0.5 + 1.0 / 128.0) * pass.bias;
    ShadowFrame {
        linear: rows.transpose(),
        origin: view.eye + view.forward * view.distance(0.0),
        direction: view.forward,
        offset: [view.right * (reach / x), view.up * (reach / y)],
        clearance: 0.5 / x.min(y) * depth * pass.bias,
    }
}
