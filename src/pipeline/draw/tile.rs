//! One tile of a draw call: what is seen of it, shaded and written.

use super::state::DepthUse;
use super::targets::TargetTile;
use super::{DrawCall, State};
use crate::math::simd::*;
use crate::pipeline::geometry::Bins;
use crate::pipeline::program::Instance;
use crate::pipeline::samples;
use crate::pipeline::shade::{self, BLOCK, Fragment};
use crate::pipeline::shader::{Outputs, PixelShader};
use crate::pipeline::tiles::cover::{self, BlockDepths, IdTarget, Region, Target, Visibility};
use crate::pipeline::tiles::fragments::{Entry, Fragments, SampleOrder, triangle};

/// What every tile of a call shares.
pub(super) struct Pass<'a> {
    pub(super) bins: &'a Bins,
    pub(super) state: &'a State,
    pub(super) instances: &'a [Instance<'a>],
    pub(super) call: &'a DrawCall<'a>,
}

/// Buffers of one worker, kept between tiles.
#[derive(Default)]
pub(super) struct Scratch {
    list: Vec<Entry>,
    seen: Visibility,
    blocks: BlockDepths,
    fragments: Fragments,
    shade: shade::Scratch,
    outputs: Outputs,
}

impl Pass<'_> {
    /// Draws one tile.
    pub(super) fn draw_tile(&self, level: Level, mut tile: TargetTile, scratch: &mut Scratch) {
        let mut list = std::mem::take(&mut scratch.list);
        self.bins.list(tile.place, &mut list);
        if self.call.program.discards() {
            // What may be discarded must not hide what comes after it.
            for entry in &list {
                self.draw_batch(level, std::slice::from_ref(entry), &mut tile, scratch);
            }
        } else if !list.is_empty() {
            self.draw_batch(level, &list, &mut tile, scratch);
        }
        scratch.list = list;
    }

    /// Draws triangles of which no fragment is discarded after it hid another.
    fn draw_batch(&self, level: Level, list: &[Entry], tile: &mut TargetTile, scratch: &mut Scratch) {
        let grid = &self.bins.grid;
        let side = 1usize << grid.tile_shift;
        let region = Region::of_tile(grid, tile.place[0], tile.place[1]);
        scratch.seen.clear(side, 1);
        for (row, depths) in scratch.seen.depth.chunks_mut(side).zip(&tile.depth) {
            row[..depths.len()].copy_from_slice(depths);
        }
        self.find_seen(level, list, &region, side, scratch);
        let order = SampleOrder { pattern: samples::pattern(1), nearest: &[0] };
        scratch.fragments.collect(level, &scratch.seen, &region, side, &order, list, self.bins);
        for run in &scratch.fragments.runs {
            let visible = &scratch.fragments.visible[run.first[0]..run.end[0]];
            let mut visible = visible.iter().map(|&id| triangle(list[id as usize - 1], self.bins));
            let mut shading = self.instances[run.draw as usize].open(&mut visible);
            for block in scratch.fragments.sorted[run.first[1]..run.end[1]].chunks(BLOCK) {
                shading.shade(level, block, &mut scratch.shade, &mut scratch.outputs);
                self.write(block, run.draw, &scratch.seen, &scratch.outputs, side, tile);
            }
        }
    }

    /// Finds which triangle each pixel keeps.
    fn find_seen(&self, level: Level, list: &[Entry], region: &Region, side: usize, scratch: &mut Scratch) {
        let triangles = list.iter().zip(1..).map(|(&entry, id)| (triangle(entry, self.bins).1, id));
        let (samples, blocks) = (&mut scratch.seen, &mut scratch.blocks);
        let pattern = samples::pattern(1);
        blocks.clear(side);
        dispatch!(level, simd => match self.state.depth_use() {
            DepthUse::Nearest => for (t, id) in triangles {
                let mut target = IdTarget { samples, id };
                cover::cover(simd, t, region, side, pattern, blocks, &mut target);
            },
            // The hierarchy knows the nearest alone, which is not what these two keep.
            DepthUse::Compare => for (t, id) in triangles {
                blocks.clear(side);
                cover::cover(simd, t, region, side, pattern, blocks, &mut Compare { samples, id });
            },
            DepthUse::Ignore => for (t, id) in triangles {
                blocks.clear(side);
                cover::cover(simd, t, region, side, pattern, blocks, &mut Paint { samples, id });
            },
        });
    }

    /// Writes what became of a block's fragments to the targets.
    fn write(
        &self,
        block: &[Fragment],
        instance: u32,
        seen: &Visibility,
        outputs: &Outputs,
        side: usize,
        tile: &mut TargetTile,
    ) {
        let kept = block.iter().enumerate().filter(|(i, _)| outputs.discarded >> i & 1 == 0);
        for (i, fragment) in kept {
            let (x, y) = (fragment.target as usize % side, fragment.target as usize / side);
            tile.ids[y][x] = self.call.first_id.wrapping_add(instance);
            if self.state.color_write {
                for (target, colors) in tile.colors.iter_mut().zip(&outputs.colors) {
                    target[y][x] = [0, 1, 2, 3].map(|channel| colors[channel][i]);
                }
            }
            if self.state.depth_use() == DepthUse::Nearest {
                tile.depth[y][x] = seen.depth[fragment.target as usize];
            }
        }
    }
}

/// Keeps the last triangle nearer than what was there before the call.
struct Compare<'a> {
    samples: &'a mut Visibility,
    id: u32,
}

impl<S: Simd> Target<S> for Compare<'_> {
    #[inline(always)]
    fn test_and_write(&mut self, simd: S, at: usize, mask: mask32x8<S>, depth: f32x8<S>) {
        let nearer = depth.simd_gt(f32x8::from_slice(simd, &self.samples.depth[at..at + LANES]));
        keep(simd, self.samples, at, mask & nearer, self.id);
    }
}

/// Keeps the last triangle.
struct Paint<'a> {
    samples: &'a mut Visibility,
    id: u32,
}

impl<S: Simd> Target<S> for Paint<'_> {
    #[inline(always)]
    fn test_and_write(&mut self, simd: S, at: usize, mask: mask32x8<S>, _: f32x8<S>) {
        keep(simd, self.samples, at, mask, self.id);
    }
}

#[inline(always)]
fn keep<S: Simd>(simd: S, samples: &mut Visibility, at: usize, mask: mask32x8<S>, id: u32) {
    let ids = &mut samples.id[at..at + LANES];
    let old = u32x8::from_slice(simd, ids);
    mask.select(u32x8::splat(simd, id), old).store_slice(ids);
}
