//! Layers: what triangles that may not hide what is behind them cover of a tile.
//!
//! They are listed before anything of them is shaded: {depth, id, coverage} of every pixel that a
//! triangle covers and nothing opaque hides. Then they are shaded together, in full blocks however
//! small the triangles are.

use super::cover::{self, BlockDepths, Region, Target, Visibility};
use super::fragments::{Entry, SampleOrder, shading_point, triangle};
use crate::math::simd::*;
use crate::pipeline::geometry::Bins;
use crate::pipeline::geometry::setup::Triangle;
use crate::pipeline::shade::{BLOCK, Fragment, Scratch};
use crate::pipeline::shader::{Outputs, PixelShader, Visible};
use crate::plan::Tally;

/// Samples that may be listed at once: half a megabyte of depths, eight layers of a whole tile at 4
/// samples a pixel. A document can ask for millions of layers.
pub const MOST_SAMPLES: usize = 1 << 17;

/// Fragments that share their triangles' records: many blocks of one triangle make one record of it,
/// and records of many small triangles stay in L2.
const BATCH: usize = 16 * BLOCK;

/// One triangle's share of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// 1 + its triangle's place in the tile's list.
    pub id: u32,
    /// Place of its first seen sample in [`Layers::depths`].
    pub first: u32,
    /// Its pixel in the tile, `y · side + x`.
    pub pixel: u16,
    /// Samples that the triangle covers, one bit each.
    pub covered: u16,
    /// Those of them that nothing opaque hides; not none.
    pub seen: u16,
}

impl Layer {
    /// Its seen samples in order, each with its depth.
    pub fn samples<'a>(&self, layers: &'a Layers) -> impl Iterator<Item = (usize, f32)> + use<'a> {
        set_bits(u64::from(self.seen)).zip(layers.depths[self.first as usize..].iter().copied())
    }

    /// The depth of a seen sample.
    #[must_use]
    pub fn depth(&self, layers: &Layers, sample: usize) -> f32 {
        let before = self.seen & ((1 << sample) - 1);
        layers.depths[self.first as usize + before.count_ones() as usize]
    }
}

/// Layers of a tile.
#[derive(Debug, Default)]
pub struct Layers {
    /// By triangle in submission order.
    pub list: Vec<Layer>,
    /// Depths of the seen samples of each layer in turn.
    pub depths: Vec<f32>,
    blocks: BlockDepths,
    batch: Batch,
}

/// The triangles of a tile.
pub struct TileList<'a> {
    /// Where they are.
    pub bins: &'a Bins,
    /// In submission order; an id is 1 + a place in it.
    pub list: &'a [Entry],
    /// The tile.
    pub region: &'a Region,
    /// Pixels in a row of the tile's buffers.
    pub side: usize,
    /// The samples of a pixel.
    pub order: &'a SampleOrder<'a>,
}

impl<'a> TileList<'a> {
    /// The triangle of an id.
    #[must_use]
    pub fn triangle(&self, id: u32) -> &'a Triangle {
        self.visible(id).1
    }

    /// The same, with its chunk.
    fn visible(&self, id: u32) -> Visible<'a> {
        triangle(self.list[id as usize - 1], self.bins)
    }
}

/// What is opaque in a tile.
pub struct Opaque<'a> {
    /// What each sample sees.
    pub samples: &'a Visibility,
    /// Its hierarchy.
    pub blocks: &'a BlockDepths,
}

/// Which layers are seen where an opaque surface has the very same depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtEqualDepth {
    /// Every one: they are yet to be told apart.
    Every,
    /// Those submitted later than it: they lie over it.
    Later,
}

/// A rectangle of pixels within a tile, from `first` to before `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    first: [usize; 2],
    end: [usize; 2],
}

impl Window {
    /// All of a tile that lies in the picture.
    #[must_use]
    pub fn whole(region: &Region) -> Self {
        Self { first: [0; 2], end: region.size }
    }

    /// Cut in two across its longer side; `None` for a single pixel.
    #[must_use]
    pub fn halves(self) -> Option<[Self; 2]> {
        let size = [0, 1].map(|axis| self.end[axis] - self.first[axis]);
        let axis = usize::from(size[1] >= size[0]);
        let middle = self.first[axis] + size[axis] / 2;
        let (mut near, mut far) = (self, self);
        (near.end[axis], far.first[axis]) = (middle, middle);
        (size[axis] > 1).then_some([near, far])
    }

    /// Whether the box of a triangle touches it.
    #[must_use]
    pub fn touches(&self, t: &Triangle, region: &Region) -> bool {
        let meets = |axis: usize, c: [i32; 3]| {
            let [first, end] = [self.first[axis], self.end[axis]]
                .map(|pixel| region.origin[axis] + 256 * i32::try_from(pixel).expect("a tile is small"));
            c[0].max(c[1]).max(c[2]) >= first && c[0].min(c[1]).min(c[2]) < end
        };
        meets(0, t.x) && meets(1, t.y)
    }

    /// It as a tile of its own, and where its first pixel lies in the buffers. It begins at a whole
    /// block of lanes, so perhaps further left.
    fn region(&self, region: &Region, side: usize) -> (Region, usize) {
        let first = [self.first[0] / LANES * LANES, self.first[1]];
        let moved =
            |axis: usize| region.origin[axis] + 256 * i32::try_from(first[axis]).expect("a tile is small");
        let size = [self.end[0] - first[0], self.end[1] - first[1]];
        (Region { origin: [moved(0), moved(1)], size }, first[1] * side + first[0])
    }

    /// Of eight pixels from column `left`, one bit for each that lies in it.
    fn columns(&self, left: usize) -> u8 {
        let before = self.first[0].saturating_sub(left).min(LANES);
        let up_to = self.end[0].saturating_sub(left).min(LANES);
        let lanes = (1u16 << up_to).wrapping_sub(1 << before);
        lanes.to_le_bytes()[0]
    }
}

impl Layers {
    /// Lists what the triangles `ids` cover of a window, one after another until there are `most` samples
    /// or more: returns how many were taken.
    #[expect(clippy::too_many_arguments, reason = "a tile, a part of it, and what to list of it")]
    pub fn gather(
        &mut self,
        level: Level,
        tile: &TileList,
        opaque: &Opaque,
        tie: AtEqualDepth,
        window: Window,
        ids: &[u32],
        most: usize,
    ) -> usize {
        self.list.clear();
        self.depths.clear();
        let mut blocks = std::mem::take(&mut self.blocks);
        if window == Window::whole(tile.region) {
            blocks.copy_depths(opaque.blocks);
        } else {
            // The hierarchy's blocks are not the window's.
            blocks.begin(tile.side, tile.bins.elide);
        }
        let (region, corner) = window.region(tile.region, tile.side);
        let mut taken = 0;
        dispatch!(level, simd => {
            let mut target = LayerTarget::new(self, opaque.samples, tie, window, tile, corner);
            while taken < ids.len() && target.layers.depths.len() < most {
                target.id = ids[taken];
                let t = tile.triangle(target.id);
                cover::cover(simd, t, &region, tile.side, tile.order.pattern, &mut blocks, &mut target);
                target.flush();
                taken += 1;
            }
        });
        self.blocks = blocks;
        taken
    }

    /// What its blocks cost and were spared since it was last asked.
    pub fn take_tally(&mut self) -> Tally {
        self.blocks.take_tally()
    }

    /// Shades every layer with what `shader` says of its draw. Calls `each` with blocks of fragments, whose
    /// targets are places in [`Layers::list`] in ascending order, and what became of them.
    pub fn shade<P: PixelShader>(
        &mut self,
        level: Level,
        tile: &TileList,
        shader: impl Fn(u32) -> P,
        scratch: &mut Scratch,
        mut each: impl FnMut(&Self, &[Fragment], &Outputs),
    ) {
        let mut batch = std::mem::take(&mut self.batch);
        let mut out = Outputs::default();
        let mut at = 0;
        while at < self.list.len() {
            let draw = tile.triangle(self.list[at].id).draw;
            batch.collect(self, at, draw, tile);
            let shader = shader(draw);
            let mut shading = shader.open(&mut batch.ids.iter().map(|&id| tile.visible(id)));
            for block in batch.fragments.chunks(BLOCK) {
                shading.shade(level, block, scratch, &mut out);
                each(self, block, &out);
            }
            at += batch.fragments.len();
        }
        self.batch = batch;
    }
}

/// Layers of one draw as fragments.
#[derive(Debug, Default)]
struct Batch {
    fragments: Vec<Fragment>,
    /// The triangles of their records.
    ids: Vec<u32>,
}

impl Batch {
    /// Takes the layers of `draw` from the layer `from` on, [`BATCH`] at most.
    fn collect(&mut self, layers: &Layers, from: usize, draw: u32, tile: &TileList) {
        self.fragments.clear();
        self.ids.clear();
        for (layer, target) in layers.list[from..].iter().zip(from..).take(BATCH) {
            let t = tile.triangle(layer.id);
            if t.draw != draw {
                return;
            }
            if self.ids.last() != Some(&layer.id) {
                self.ids.push(layer.id);
            }
            let record = u32::try_from(self.ids.len() - 1).expect("a batch is small");
            let pixel = usize::from(layer.pixel);
            let corner = tile.region.corner([pixel % tile.side, pixel / tile.side]);
            let [x, y] = shading_point(t, layer.covered, corner, tile.order);
            let target = u32::try_from(target).expect("as many as fit in memory at once");
            self.fragments.push(Fragment { record, target, x, y });
        }
    }
}

/// Lists the layers of one triangle after another, a row of eight pixels at a time.
struct LayerTarget<'a> {
    layers: &'a mut Layers,
    opaque: &'a Visibility,
    tie: AtEqualDepth,
    window: Window,
    /// Pixels in a row of the tile's buffers, a power of two, and log2 of its square.
    side: usize,
    plane_shift: u32,
    /// Added to the places that the window's region counts.
    corner: usize,
    id: u32,
    /// The row of eight that is under way: the place of its first pixel, and sample by sample which of
    /// its pixels are covered, which are seen, and their depths.
    row: usize,
    covered: [u8; 16],
    seen: [u8; 16],
    depth: [[f32; LANES]; 16],
    /// Pixels of which some sample is seen.
    any: u8,
    samples: usize,
}

impl<'a> LayerTarget<'a> {
    fn new(
        layers: &'a mut Layers,
        opaque: &'a Visibility,
        tie: AtEqualDepth,
        window: Window,
        tile: &TileList,
        corner: usize,
    ) -> Self {
        Self {
            layers,
            opaque,
            tie,
            window,
            side: tile.side,
            plane_shift: 2 * tile.side.trailing_zeros(),
            corner,
            id: 0,
            row: 0,
            covered: [0; 16],
            seen: [0; 16],
            depth: [[0.0; LANES]; 16],
            any: 0,
            samples: tile.order.pattern.len(),
        }
    }

    /// Lists the row that is under way.
    #[inline(always)]
    fn flush(&mut self) {
        let mut lanes = self.any & self.window.columns(self.row & (self.side - 1));
        while lanes != 0 {
            self.push(lanes.trailing_zeros() as usize);
            lanes &= lanes - 1;
        }
        self.any = 0;
        self.covered = [0; 16];
        self.seen = [0; 16];
    }

    #[inline(always)]
    fn push(&mut self, lane: usize) {
        let first = u32::try_from(self.layers.depths.len()).expect("bounded by what is listed at once");
        let pixel = u16::try_from(self.row + lane).expect("a tile has at most 64² pixels");
        let mut layer = Layer { id: self.id, first, pixel, covered: 0, seen: 0 };
        for s in 0..self.samples {
            layer.covered |= u16::from(self.covered[s] >> lane & 1) << s;
            if self.seen[s] >> lane & 1 == 1 {
                layer.seen |= 1 << s;
                self.layers.depths.push(self.depth[s][lane]);
            }
        }
        self.layers.list.push(layer);
    }
}

impl<S: Simd> Target<S> for LayerTarget<'_> {
    const OCCLUDES: bool = false;

    #[inline(always)]
    fn test_and_write(&mut self, simd: S, at: usize, mask: mask32x8<S>, depth: f32x8<S>) {
        let at = at + self.corner;
        let old_depth = f32x8::from_slice(simd, &self.opaque.depth[at..at + LANES]);
        let old_id = u32x8::from_slice(simd, &self.opaque.id[at..at + LANES]);
        // Nothing is there where the id is 0, at depth 0: what is as far away is beyond the far plane.
        let something = old_id.simd_gt(u32x8::splat(simd, 0));
        let wins = match self.tie {
            AtEqualDepth::Every => something,
            AtEqualDepth::Later => something & old_id.simd_lt(u32x8::splat(simd, self.id)),
        };
        let seen = mask & (depth.simd_gt(old_depth) | (depth.simd_eq(old_depth) & wins));
        let sample = at >> self.plane_shift;
        let row = at & ((1 << self.plane_shift) - 1);
        if row != self.row {
            self.flush();
            self.row = row;
        }
        self.covered[sample] = lanes(mask);
        self.seen[sample] = lanes(seen);
        self.any |= lanes(seen);
        depth.store_slice(&mut self.depth[sample]);
    }
}

/// One bit a lane.
#[inline(always)]
fn lanes<S: Simd>(mask: mask32x8<S>) -> u8 {
    mask.to_bitmask().to_le_bytes()[0]
}

#[cfg(test)]
mod tests;
