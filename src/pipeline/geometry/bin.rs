//! Binning: which tile must look at which triangle.

use super::Counts;
use super::setup::Triangle;
use crate::math::Viewport;
use crate::plan::{Elision, Elisions, Tally, Unit};

/// How a picture is cut into square tiles. All coordinates in sub-pixels are relative to the
/// viewport centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileGrid {
    /// Pixels in a row of the picture.
    pub width: u32,
    /// Rows of the picture.
    pub height: u32,
    /// log2 of a tile's side in pixels: 5 or 6.
    pub tile_shift: u32,
    /// Tiles in a row.
    pub columns: u32,
    /// Rows of tiles.
    pub rows: u32,
    /// Screen x and y of the picture's left and top border.
    pub origin: [i32; 2],
    /// The samples of a pixel as a bounding box from its corner: first and last x, first and last y.
    pub sample_box: [[i32; 2]; 2],
}

impl TileGrid {
    /// Cuts a picture into tiles of `2^tile_shift` pixels.
    #[must_use]
    pub fn new(viewport: impl Into<Viewport>, tile_shift: u32, samples: &[[i32; 2]]) -> Self {
        let viewport = viewport.into();
        let tiles = |n: u32| n.div_ceil(1 << tile_shift);
        let range = |axis: usize| {
            let of = |f: fn(i32, i32) -> i32| samples.iter().map(|s| s[axis]).reduce(f).unwrap_or(0);
            [of(i32::min), of(i32::max)]
        };
        Self {
            width: viewport.width,
            height: viewport.height,
            tile_shift,
            columns: tiles(viewport.width),
            rows: tiles(viewport.height),
            origin: viewport.origin(),
            sample_box: [range(0), range(1)],
        }
    }

    /// Number of tiles.
    #[must_use]
    pub fn tiles(&self) -> u32 {
        self.columns * self.rows
    }

    /// First and last pixel along `axis` whose samples can lie in `from..=to` (sub-pixels), within
    /// the picture; `None` if there is none.
    fn pixels(&self, axis: usize, from: i32, to: i32) -> Option<[i32; 2]> {
        let [first_sample, last_sample] = self.sample_box[axis];
        let count = if axis == 0 { self.width } else { self.height };
        // The first pixel whose last sample is not left of `from`, the last whose first is not
        // right of `to`.
        let first = (from - self.origin[axis] - last_sample + 255) >> 8;
        let last = (to - self.origin[axis] - first_sample) >> 8;
        let (first, last) = (first.max(0), last.min(count.cast_signed() - 1));
        (first <= last).then_some([first, last])
    }
}

/// Entries that a chunk's triangles may have in tiles before it is no longer sorted by tile: so many
/// for each triangle, and so many for the chunk. Beyond, a list a tile would take more memory than the
/// triangles (a screen-filling one has an entry in every tile) and save its reader little.
const ENTRIES_A_TRIANGLE: usize = 16;
const ENTRIES_A_CHUNK: usize = 256;

/// A rectangle of tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct TileRect {
    column: u32,
    row: u32,
    columns: u32,
    rows: u32,
}

impl TileRect {
    /// The smallest rectangle around both.
    fn union(self, o: Self) -> Self {
        let (column, row) = (self.column.min(o.column), self.row.min(o.row));
        let right = (self.column + self.columns).max(o.column + o.columns);
        let bottom = (self.row + self.rows).max(o.row + o.rows);
        Self { column, row, columns: right - column, rows: bottom - row }
    }
}

/// What one task of the geometry stage produced.
#[derive(Debug, Default)]
pub struct Chunk {
    /// In submission order.
    pub triangles: Vec<Triangle>,
    /// For each clipped piece: the weights of the source triangle's corners at each of its own.
    pub clipped: Vec<[[f64; 3]; 3]>,
    /// What became of its triangles.
    pub counts: Counts,
    /// Around the tiles that its triangles can touch.
    rect: Option<TileRect>,
    /// For each tile of `rect`, where its entries begin; empty if every tile must look at all.
    offsets: Vec<u32>,
    /// Indices of triangles, by tile, ascending within one; or those of all.
    entries: Vec<u32>,
    /// Whether there are too many entries to sort.
    crowded: bool,
    /// What its triangles cost, and what they were spared.
    pub tally: Tally,
    elide: Elisions,
}

impl Chunk {
    /// Without triangles yet; of what `elide` names they are spared.
    #[must_use]
    pub fn new(elide: Elisions) -> Self {
        Self { elide, ..Self::default() }
    }

    /// Notes how many of its triangles were set up, and how many went through the clipper.
    pub(super) fn tally_triangles(&mut self) {
        let Counts { triangles, outside, clipped, .. } = self.counts;
        let inside = triangles - outside;
        self.tally.count(Unit::Triangles, inside);
        self.tally.spare(Elision::OutsideTriangles, outside);
        if self.elide.contains(Elision::Clipping) {
            self.tally.count(Unit::Clipped, clipped);
            self.tally.spare(Elision::Clipping, inside - clipped);
        } else {
            self.tally.count(Unit::Clipped, inside);
        }
    }

    /// Triangles that touch the tile at (column, row), and perhaps some that don't, in submission order.
    #[must_use]
    pub fn tile(&self, column: u32, row: u32) -> &[u32] {
        let Some(rect) = self.rect else { return &[] };
        let (x, y) = (column.wrapping_sub(rect.column), row.wrapping_sub(rect.row));
        if x >= rect.columns || y >= rect.rows {
            return &[];
        }
        if self.offsets.is_empty() {
            return &self.entries;
        }
        let at = (y * rect.columns + x) as usize;
        &self.entries[self.offsets[at] as usize..self.offsets[at + 1] as usize]
    }

    /// Takes a triangle in and notes its tiles in `pairs`; false if it touches no sample.
    pub(super) fn bin(&mut self, t: Triangle, grid: &TileGrid, pairs: &mut Vec<(u32, u32)>) -> bool {
        let range = |c: [i32; 3]| (c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2]));
        let ((left, right), (top, bottom)) = (range(t.x), range(t.y));
        let (Some(x), Some(y)) = (grid.pixels(0, left, right), grid.pixels(1, top, bottom)) else {
            return false;
        };
        let index = u32::try_from(self.triangles.len()).expect("a chunk is small");
        let tiles = |p: [i32; 2]| p.map(|p| p.cast_unsigned() >> grid.tile_shift);
        let ([x0, x1], [y0, y1]) = (tiles(x), tiles(y));
        if !self.crowded {
            let before = pairs.len();
            // A triangle's box says all there is to say while it is thin.
            let lists_box = x0 == x1 || y0 == y1 || !self.elide.contains(Elision::TilesPassedBy);
            for row in y0..=y1 {
                for column in x0..=x1 {
                    if lists_box || touches(&t, column, row, grid) {
                        pairs.push((row * grid.columns + column, index));
                    }
                }
            }
            let (listed, tiles) = (pairs.len() - before, (x1 - x0 + 1) * (y1 - y0 + 1));
            self.tally.count(Unit::TileEntries, listed as u64);
            self.tally.spare(Elision::TilesPassedBy, u64::from(tiles) - listed as u64);
            if pairs.len() == before {
                return false;
            }
            self.crowded = pairs.len() > ENTRIES_A_CHUNK + ENTRIES_A_TRIANGLE * (self.triangles.len() + 1);
        }
        let own = TileRect { column: x0, row: y0, columns: x1 - x0 + 1, rows: y1 - y0 + 1 };
        self.rect = Some(self.rect.map_or(own, |rect| rect.union(own)));
        self.triangles.push(t);
        true
    }

    /// Sorts the noted pairs by tile (a counting sort, so triangles stay in order).
    pub(super) fn sort_into_tiles(&mut self, grid: &TileGrid, pairs: &mut Vec<(u32, u32)>) {
        let Some(rect) = self.rect else { return };
        let tiles = rect.columns as usize * rect.rows as usize;
        if self.crowded || tiles > ENTRIES_A_CHUNK + 4 * pairs.len() {
            self.entries = (0..).take(self.triangles.len()).collect();
            pairs.clear();
            return;
        }
        let at = |tile: u32| {
            let (x, y) = (tile % grid.columns, tile / grid.columns);
            ((y - rect.row) * rect.columns + (x - rect.column)) as usize
        };
        self.offsets = vec![0; tiles + 1];
        for &(tile, _) in pairs.iter() {
            self.offsets[at(tile) + 1] += 1;
        }
        for i in 1..self.offsets.len() {
            self.offsets[i] += self.offsets[i - 1];
        }
        let mut next = self.offsets.clone();
        self.entries = vec![0; pairs.len()];
        for &(tile, triangle) in pairs.iter() {
            let slot = &mut next[at(tile)];
            self.entries[*slot as usize] = triangle;
            *slot += 1;
        }
        pairs.clear();
    }
}

/// Whether a sample of the tile can be inside all three edges: the sign of each edge function at the
/// tile's corner that lies deepest inside.
fn touches(t: &Triangle, column: u32, row: u32, grid: &TileGrid) -> bool {
    let size = 256i64 << grid.tile_shift;
    let left = i64::from(grid.origin[0]) + i64::from(column) * size;
    let top = i64::from(grid.origin[1]) + i64::from(row) * size;
    (0..3).all(|i| {
        let [dx, dy] = t.edge_step(i);
        let deepest = [if dx > 0 { left + size } else { left }, if dy > 0 { top + size } else { top }];
        t.edge_at(i, deepest) >= 0
    })
}

#[cfg(test)]
mod tests;
