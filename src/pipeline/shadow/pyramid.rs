//! The least and the greatest depth of every part of a shadow map: what answers most kernels
//! without a tap.

use super::depth_map::{DepthMap, TILE_SHIFT, TILE_SIDE, TexelBox, Tile};
use crate::pipeline::work::{Cancelled, Work};

/// Least and greatest depth of some texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DepthRange {
    pub(super) least: f32,
    pub(super) greatest: f32,
}

impl DepthRange {
    /// Of texels in which nothing is.
    pub(super) const NOTHING: Self = Self { least: 0.0, greatest: 0.0 };

    /// Of both.
    #[inline(always)]
    pub(super) fn union(self, o: Self) -> Self {
        Self {
            least: if o.least < self.least { o.least } else { self.least },
            greatest: if o.greatest > self.greatest { o.greatest } else { self.greatest },
        }
    }
}

/// log2 of the side of the smallest cells: the kernel of the default PCF is 4 texels wide.
const FINEST: u32 = 2;
/// Levels within a tile: cells of 4, 8, 16, 32 and 64 texels a side.
const LEVELS_A_TILE: usize = (TILE_SHIFT - FINEST) as usize + 1;
/// Where each of these levels begins among a tile's cells.
const FIRST_CELL: [usize; LEVELS_A_TILE] = [0, 256, 320, 336, 340];
const CELLS_A_TILE: usize = 341;

/// Ranges over a [`DepthMap`], for cells of 2², 2³, … texels a side up to the whole map.
#[derive(Debug, PartialEq)]
pub(super) struct Pyramid {
    resolution: u32,
    columns: usize,
    /// The levels within each tile; `None` where nothing is.
    tiles: Vec<Option<Box<[DepthRange; CELLS_A_TILE]>>>,
    /// Cells of 2, 4, … tiles a side.
    above: Vec<Level>,
}

#[derive(Debug, PartialEq)]
struct Level {
    columns: usize,
    cells: Vec<DepthRange>,
}

impl Pyramid {
    /// Reads every tile of `map` that something is in.
    pub(super) fn over(map: &DepthMap, work: &Work) -> Result<Self, Cancelled> {
        let columns = map.columns();
        let tiles = work.map(map.tiles().iter().collect(), || (), |(), tile| tile.as_deref().map(cells))?;
        let mut above = Vec::new();
        let mut below = Level {
            columns,
            cells: tiles
                .iter()
                .map(|t| t.as_ref().map_or(DepthRange::NOTHING, |t| t[CELLS_A_TILE - 1]))
                .collect(),
        };
        while below.columns > 1 {
            let next = below.halved();
            above.push(std::mem::replace(&mut below, next));
        }
        above.push(below);
        // The first of them repeats the tiles' own last level.
        above.remove(0);
        Ok(Self { resolution: map.resolution(), columns, tiles, above })
    }

    /// A range that holds every depth that texels of the box have; 0 outside the map.
    #[inline(always)]
    pub(super) fn range(&self, texels: &TexelBox) -> DepthRange {
        let last = self.resolution.cast_signed() - 1;
        let mut outside = false;
        let [x, y] = [texels.x, texels.y].map(|[first, end]| {
            outside |= first < 0 || end > last;
            [first.max(0), end.min(last)]
        });
        if x[0] > x[1] || y[0] > y[1] {
            return DepthRange::NOTHING;
        }
        let [x, y] = [x, y].map(|c| c.map(|n| n.cast_unsigned() as usize));
        let steps = (x[1] - x[0]).max(y[1] - y[0]);
        // Cells as wide as the box: at most two of them in a row.
        let level = (usize::BITS - steps.saturating_sub(1).leading_zeros()).max(FINEST);
        let [x, y] = [x, y].map(|c| c.map(|n| n >> level));
        let mut range = self.cell(level, x[0], y[0]);
        if x[1] > x[0] {
            range = range.union(self.cell(level, x[1], y[0]));
        }
        if y[1] > y[0] {
            range = range.union(self.cell(level, x[0], y[1]));
            if x[1] > x[0] {
                range = range.union(self.cell(level, x[1], y[1]));
            }
        }
        if outside { range.union(DepthRange::NOTHING) } else { range }
    }

    /// Of the whole map.
    pub(super) fn whole(&self) -> DepthRange {
        let side = self.resolution.cast_signed() - 1;
        self.range(&TexelBox { x: [0, side], y: [0, side] })
    }

    #[inline(always)]
    fn cell(&self, level: u32, x: usize, y: usize) -> DepthRange {
        if level > TILE_SHIFT {
            let level = &self.above[(level - TILE_SHIFT - 1) as usize];
            return level.cells[y * level.columns + x];
        }
        let within = TILE_SHIFT - level;
        match &self.tiles[(y >> within) * self.columns + (x >> within)] {
            None => DepthRange::NOTHING,
            Some(cells) => {
                let last = (1 << within) - 1;
                cells[FIRST_CELL[(level - FINEST) as usize] + ((y & last) << within) + (x & last)]
            }
        }
    }
}

impl Level {
    /// The level above: each cell of four of these.
    fn halved(&self) -> Self {
        let columns = self.columns.div_ceil(2);
        let mut cells: Vec<Option<DepthRange>> = vec![None; columns * columns];
        for (i, &cell) in self.cells.iter().enumerate() {
            let (x, y) = (i % self.columns, i / self.columns);
            let above = &mut cells[(y / 2) * columns + x / 2];
            *above = Some(above.map_or(cell, |range| range.union(cell)));
        }
        Self { columns, cells: cells.into_iter().map(|cell| cell.unwrap_or(DepthRange::NOTHING)).collect() }
    }
}

/// The levels within a tile.
fn cells(tile: &Tile) -> Box<[DepthRange; CELLS_A_TILE]> {
    let mut cells = Box::new([DepthRange::NOTHING; CELLS_A_TILE]);
    for (rows, band) in tile.chunks_exact(4 * TILE_SIDE).enumerate() {
        // Four rows into one, then four columns.
        let (mut least, mut greatest) = ([f32::INFINITY; TILE_SIDE], [0.0f32; TILE_SIDE]);
        for row in band.chunks_exact(TILE_SIDE) {
            for ((&depth, least), greatest) in row.iter().zip(&mut least).zip(&mut greatest) {
                *least = if depth < *least { depth } else { *least };
                *greatest = if depth > *greatest { depth } else { *greatest };
            }
        }
        let columns = least.chunks_exact(4).zip(greatest.chunks_exact(4));
        for (cell, (least, greatest)) in cells[rows * 16..rows * 16 + 16].iter_mut().zip(columns) {
            let all = least.iter().zip(greatest).map(|(&least, &greatest)| DepthRange { least, greatest });
            *cell = all.reduce(DepthRange::union).expect("four columns");
        }
    }
    for level in 1..LEVELS_A_TILE {
        let side = 16 >> level;
        let (below, here) = cells.split_at_mut(FIRST_CELL[level]);
        let below = &below[FIRST_CELL[level - 1]..];
        for (i, cell) in here[..side * side].iter_mut().enumerate() {
            let corner = 4 * side * (i / side) + 2 * (i % side);
            let two = |at: usize| below[at].union(below[at + 1]);
            *cell = two(corner).union(two(corner + 2 * side));
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::super::depth_map::tests::map_of;
    use super::super::tests::{Random, with_work};
    use super::*;

    #[test]
    fn a_range_holds_every_texel_of_its_box_and_is_not_much_wider() {
        let mut rng = Random::new(0x5eed_0001);
        for resolution in [1u32, 3, 64, 65, 200, 321] {
            // A blank corner: tiles without texels.
            let blank = resolution / 2;
            let map = map_of(resolution, |x, y| {
                if x < blank && y < blank {
                    0.0
                } else {
                    crate::math::round_to_f32(f64::from((x * 7 + y * 13) % 97 + 1) / 100.0)
                }
            });
            let pyramid = with_work(|work| Pyramid::over(&map, work).unwrap());
            for _ in 0..2000 {
                let side = i32::try_from(resolution).unwrap();
                let mut pair = || {
                    let widest = rng.below(resolution + 2) + 1;
                    let [first, steps] =
                        [resolution + 2, widest].map(|n| i32::try_from(rng.below(n)).unwrap());
                    [first - 1, (first - 1 + steps).min(side)]
                };
                let texels = TexelBox { x: pair(), y: pair() };
                let range = pyramid.range(&texels);
                let mut exact: Option<DepthRange> = None;
                for y in texels.y[0]..=texels.y[1] {
                    for x in texels.x[0]..=texels.x[1] {
                        let depth = map.texel(x, y);
                        let one = DepthRange { least: depth, greatest: depth };
                        exact = Some(exact.map_or(one, |range| range.union(one)));
                    }
                }
                let exact = exact.unwrap();
                assert!(range.least <= exact.least && range.greatest >= exact.greatest, "{texels:?}");
            }
            let flat = map_of(resolution, |_, _| 0.5);
            let pyramid = with_work(|work| Pyramid::over(&flat, work).unwrap());
            assert_eq!(pyramid.whole().greatest, 0.5);
            if resolution % 64 == 0 {
                assert_eq!(pyramid.whole().least, 0.5);
            }
        }
    }
}
