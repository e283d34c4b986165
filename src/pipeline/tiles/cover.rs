//! Coverage and depth: which triangle each sample of a tile sees.
//!
//! The edge functions are evaluated in 32-bit integers, exact in sign; the top-left rule gives every
//! sample on a shared edge to exactly one of its two triangles. Source: J. Pineda, "A Parallel
//! Algorithm for Polygon Rasterization", SIGGRAPH 1988; fill rule: Direct3D 11 specification, 3.4.2.1.

use super::depth::{DepthFunction, Plane, PositiveSum, small};
use crate::math::simd::*;
use crate::pipeline::geometry::setup::Triangle;
use crate::plan::{Elision, Elisions, Tally, Unit};

/// A block's side in pixels; the hierarchy keeps one depth a block.
const BLOCK_SHIFT: usize = 3;

/// A tile of the picture. Coordinates are screen coordinates in sub-pixels.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Left and top border.
    pub origin: [i32; 2],
    /// Columns and rows that lie in the picture.
    pub size: [usize; 2],
}

/// Where covered samples go.
pub trait Target<S: Simd> {
    /// Whether what is covered hides what lies behind it, so that the hierarchy may take note.
    const OCCLUDES: bool = true;

    /// Tests eight samples of one row against `depth` where `mask` is set, keeps the nearer ones.
    /// `at` is the index of the first of them.
    fn test_and_write(&mut self, simd: S, at: usize, mask: mask32x8<S>, depth: f32x8<S>);
}

/// What the samples of a tile see. Sample `s` of the pixel (x, y) is at `(s · side + y) · side + x`.
#[derive(Debug, Default)]
pub struct Visibility {
    /// Reversed depth: 1 at the near plane, 0 where nothing is.
    pub depth: Vec<f32>,
    /// 1 + the triangle's place in the tile's list; 0 where nothing is.
    pub id: Vec<u32>,
}

impl Visibility {
    /// Forgets everything and takes `samples` samples of `side × side` pixels.
    pub fn clear(&mut self, side: usize, samples: usize) {
        let count = side * side * samples;
        self.depth.clear();
        self.depth.resize(count, 0.0);
        self.id.clear();
        self.id.resize(count, 0);
    }

    /// One bit for each pixel of the row `y`, the first the lowest: whether all its samples see the same.
    pub fn alone(&self, level: Level, y: usize, side: usize, samples: usize) -> u64 {
        dispatch!(level, simd => self.alone_kernel(simd, y, side, samples))
    }

    #[inline(always)]
    fn alone_kernel<S: Simd>(&self, simd: S, y: usize, side: usize, samples: usize) -> u64 {
        let mut row = 0;
        for left in (0..side).step_by(LANES) {
            let of_sample = always(
                #[inline(always)]
                |s: usize| u32x8::from_slice(simd, &self.id[(s * side + y) * side + left..][..LANES]),
            );
            let first = of_sample(0);
            let mut same = mask32x8::splat(simd, true);
            for s in 1..samples {
                same &= first.simd_eq(of_sample(s));
            }
            row |= same.to_bitmask() << left;
        }
        row
    }
}

/// Writes depth and the id of one triangle.
pub struct IdTarget<'a> {
    /// Where to.
    pub samples: &'a mut Visibility,
    /// The triangle's id.
    pub id: u32,
}

impl<S: Simd> Target<S> for IdTarget<'_> {
    #[inline(always)]
    fn test_and_write(&mut self, simd: S, at: usize, mask: mask32x8<S>, depth: f32x8<S>) {
        let old_depth = f32x8::from_slice(simd, &self.samples.depth[at..at + LANES]);
        let old_id = u32x8::from_slice(simd, &self.samples.id[at..at + LANES]);
        let id = u32x8::splat(simd, self.id);
        // At equal depth the one submitted first wins, whatever the order of drawing. Nothing (id
        // 0) wins against depth 0: that far away is beyond the far plane.
        let nearer = depth.simd_gt(old_depth) | (depth.simd_eq(old_depth) & id.simd_lt(old_id));
        let write = mask & nearer;
        write.select(depth, old_depth).store_slice(&mut self.samples.depth[at..at + LANES]);
        write.select(id, old_id).store_slice(&mut self.samples.id[at..at + LANES]);
    }
}

/// Keeps the nearest depth alone: a shadow map.
pub struct DepthTarget<'a> {
    /// Where to.
    pub depth: &'a mut [f32],
}

impl<S: Simd> Target<S> for DepthTarget<'_> {
    #[inline(always)]
    fn test_and_write(&mut self, simd: S, at: usize, mask: mask32x8<S>, depth: f32x8<S>) {
        let old = f32x8::from_slice(simd, &self.depth[at..at + LANES]);
        let write = mask & depth.simd_gt(old);
        write.select(depth, old).store_slice(&mut self.depth[at..at + LANES]);
    }
}

/// For each 8×8 block, a depth that every one of its samples has reached: what lies wholly behind it
/// is hidden.
#[derive(Clone, Debug, Default)]
pub struct BlockDepths {
    depths: Vec<f32>,
    /// By how much an edge may miss a block and still count as crossing it.
    slack: i64,
    counts: BlockCounts,
}

/// What became of the blocks that triangles touch.
#[derive(Clone, Copy, Debug, Default)]
struct BlockCounts {
    /// Crossed by an edge, so that it was tested sample by sample.
    crossed: u64,
    /// Wholly inside or outside of every edge.
    uniform: u64,
    /// Behind what is drawn.
    hidden: u64,
    /// Whose depths were computed.
    drawn: u64,
}

impl BlockDepths {
    /// Forgets everything and takes a tile of `side × side` pixels.
    pub fn clear(&mut self, side: usize) {
        self.begin(side, Elisions::ALL);
    }

    /// The same without what `elide` does not name. A depth that is no number compares with none, so
    /// nothing is hidden; and with enough slack every edge crosses every block.
    pub fn begin(&mut self, side: usize, elide: Elisions) {
        let blocks = side >> BLOCK_SHIFT;
        let farthest = if elide.contains(Elision::HiddenBlocks) { 0.0 } else { f32::NAN };
        self.depths.clear();
        self.depths.resize(blocks * blocks, farthest);
        self.slack = if elide.contains(Elision::UniformBlocks) { 0 } else { i64::MAX / 4 };
    }

    /// Takes over the depths of another, and keeps its own counts.
    pub fn copy_depths(&mut self, other: &Self) {
        self.depths.clone_from(&other.depths);
        self.slack = other.slack;
    }

    /// What its blocks cost and were spared since it was last asked.
    pub fn take_tally(&mut self) -> Tally {
        let BlockCounts { crossed, uniform, hidden, drawn } = std::mem::take(&mut self.counts);
        let mut tally = Tally::default();
        tally.count(Unit::EdgeBlocks, crossed);
        tally.count(Unit::DepthBlocks, drawn);
        tally.spare(Elision::UniformBlocks, uniform);
        tally.spare(Elision::HiddenBlocks, hidden);
        tally
    }
}

/// An edge that crosses the tile.
#[derive(Clone, Copy, Default)]
struct Edge {
    /// Steps per pixel of the edge function divided by 256.
    step: [i32; 2],
    /// Its value at the tile's corner, divided by 256 and rounded down.
    at_corner: i32,
    /// For each sample, its value at pixel (0, 0), divided by 256 and rounded down: not negative
    /// exactly where the sample is inside, the fill rule included.
    at_origin: [i32; 16],
}

/// Edge function of corner `i` → `i + 1`: steps per sub-pixel, and its value at the tile's origin less
/// 1 where a sample on the edge is not inside.
fn edge(t: &Triangle, i: usize, region: &Region) -> ([i32; 2], i64) {
    let step = t.edge_step(i);
    // Clockwise with y down: a left edge goes up, a top edge is level and goes right.
    let top_left = step[0] > 0 || (step[0] == 0 && step[1] > 0);
    (step, t.edge_at(i, region.origin.map(i64::from)) - i64::from(!top_left))
}

/// Rasterizes one triangle into a tile of `side × side` pixels.
///
/// `pattern` holds the samples of a pixel, `blocks` the tile's hierarchy.
#[inline(always)]
pub fn cover<S: Simd, T: Target<S>>(
    simd: S,
    t: &Triangle,
    region: &Region,
    side: usize,
    pattern: &[[i32; 2]],
    blocks: &mut BlockDepths,
    target: &mut T,
) {
    let Some(span) = pixel_box(t, region) else { return };
    let mut edges = [Edge::default(); 3];
    let mut crossing = 0;
    let reach = [0, 1].map(|axis| i64::try_from(region.size[axis]).expect("a tile is small") * 256 - 16);
    for i in 0..3 {
        let (step, value) = edge(t, i, region);
        let wide = step.map(i64::from);
        let most = value + wide[0].max(0) * reach[0] + wide[1].max(0) * reach[1];
        if most < 0 {
            return;
        }
        let least = value + wide[0].min(0) * reach[0] + wide[1].min(0) * reach[1];
        if least < 0 {
            let edge = &mut edges[crossing];
            edge.step = step;
            edge.at_corner = floor_256(value);
            for (at, offset) in edge.at_origin.iter_mut().zip(pattern) {
                *at = floor_256(value + wide[0] * i64::from(offset[0]) + wide[1] * i64::from(offset[1]));
            }
            crossing += 1;
        }
    }
    let edges = &edges[..crossing];
    if t.is_stiff() {
        let depth = PositiveSum::new(t, region);
        cover_blocks(simd, &depth, edges, &span, side, pattern, blocks, target);
    } else {
        let depth = Plane::new(t, region);
        cover_blocks(simd, &depth, edges, &span, side, pattern, blocks, target);
    }
}

/// Divides by 256, rounding down, which keeps the sign.
#[expect(clippy::cast_possible_truncation, reason = "an edge that crosses the tile stays below 2³⁹ there")]
fn floor_256(value: i64) -> i32 {
    (value >> 8) as i32
}

/// First and last pixel column and row that the triangle's box touches within the tile.
#[derive(Clone, Copy)]
struct PixelBox {
    x: [usize; 2],
    y: [usize; 2],
}

fn pixel_box(t: &Triangle, region: &Region) -> Option<PixelBox> {
    let range = |axis: usize, c: [i32; 3]| {
        let first = (c[0].min(c[1]).min(c[2]) - region.origin[axis]) >> 8;
        let last = (c[0].max(c[1]).max(c[2]) - region.origin[axis]) >> 8;
        let end = usize::try_from(last + 1).unwrap_or(0).min(region.size[axis]);
        let first = usize::try_from(first).unwrap_or(0);
        (first < end).then(|| [first, end - 1])
    };
    Some(PixelBox { x: range(0, t.x)?, y: range(1, t.y)? })
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the inner half of `cover`, generic over the depth")]
fn cover_blocks<S: Simd, D: DepthFunction, T: Target<S>>(
    simd: S,
    depth: &D,
    edges: &[Edge],
    span: &PixelBox,
    side: usize,
    pattern: &[[i32; 2]],
    blocks: &mut BlockDepths,
    target: &mut T,
) {
    let mut ramps = [i32x8::splat(simd, 0); 3];
    for (ramp, edge) in ramps.iter_mut().zip(edges) {
        *ramp = ramp_i32(simd) * edge.step[0];
    }
    let blocks_a_row = side >> BLOCK_SHIFT;
    let mut counts = BlockCounts::default();
    for block_y in span.y[0] >> BLOCK_SHIFT..=span.y[1] >> BLOCK_SHIFT {
        let top = block_y << BLOCK_SHIFT;
        let rows = top.max(span.y[0])..(top + LANES).min(span.y[1] + 1);
        for block_x in span.x[0] >> BLOCK_SHIFT..=span.x[1] >> BLOCK_SHIFT {
            let left = block_x << BLOCK_SHIFT;
            let Some((crossing, inner)) = classify(edges, left, top, blocks.slack) else {
                counts.uniform += 1;
                continue;
            };
            counts.crossed += u64::from(!inner);
            counts.uniform += u64::from(inner && !edges.is_empty());
            let behind = &mut blocks.depths[block_y * blocks_a_row + block_x];
            let (nearest, farthest) = depth.range(left, top);
            if nearest < *behind {
                counts.hidden += 1;
                continue;
            }
            counts.drawn += 1;
            if T::OCCLUDES && inner && farthest > *behind {
                *behind = farthest;
            }
            for y in rows.clone() {
                for (s, offset) in pattern.iter().enumerate() {
                    let mut mask = mask32x8::splat(simd, true);
                    for i in 0..3 {
                        if crossing[i] {
                            let e = &edges[i];
                            let row = e.at_origin[s]
                                .wrapping_add(e.step[0].wrapping_mul(small(left)))
                                .wrapping_add(e.step[1].wrapping_mul(small(y)));
                            mask &= (ramps[i] + row).simd_ge(i32x8::splat(simd, 0));
                        }
                    }
                    if !inner && mask.all_false() {
                        continue;
                    }
                    let d = depth.row(simd, left, y, offset);
                    target.test_and_write(simd, (s * side + y) * side + left, mask, d);
                }
            }
        }
    }
    blocks.counts.add(&counts);
}

impl BlockCounts {
    fn add(&mut self, o: &Self) {
        self.crossed += o.crossed;
        self.uniform += o.uniform;
        self.hidden += o.hidden;
        self.drawn += o.drawn;
    }
}

/// Which edges cross the 8×8 block at (left, top), and whether none does; `None` if the block is
/// outside one. Edges that miss the block by `slack` or less cross it.
#[inline(always)]
fn classify(edges: &[Edge], left: usize, top: usize, slack: i64) -> Option<([bool; 3], bool)> {
    let mut crossing = [false; 3];
    for (i, e) in edges.iter().enumerate() {
        let [dx, dy] = e.step.map(i64::from);
        // Eight pixels on, the edge function differs by a multiple of 256: rounding loses no sign.
        let corner = i64::from(e.at_corner) + dx * i64::from(small(left)) + dy * i64::from(small(top));
        if corner + 8 * (dx.max(0) + dy.max(0)) + slack < 0 {
            return None;
        }
        crossing[i] = corner + 8 * (dx.min(0) + dy.min(0)) < slack;
    }
    Some((crossing, crossing == [false; 3]))
}

#[cfg(test)]
mod tests;
