//! Render targets.

use super::Rect;
use crate::math::round_to_f32;
use crate::pipeline::geometry::bin::TileGrid;
use crate::pipeline::shader::TARGETS;
use crate::pipeline::{Frame, Pixels, Stats, Timings};

/// What draw calls draw into: up to four colour targets, a depth and an id target of one size. Rows run
/// top to bottom.
#[derive(Clone, Debug)]
pub struct Targets {
    width: u32,
    height: u32,
    colors: Vec<Vec<[f32; 4]>>,
    depth: Vec<f32>,
    ids: Vec<u32>,
}

/// The pixels of all targets in one tile of a viewport, row by row.
pub(super) struct TargetTile<'a> {
    pub(super) place: [u32; 2],
    pub(super) colors: Vec<Vec<&'a mut [[f32; 4]]>>,
    pub(super) depth: Vec<&'a mut [f32]>,
    pub(super) ids: Vec<&'a mut [u32]>,
}

impl Targets {
    /// Cleared targets: `colors` black and transparent ones, depth 0 (infinitely far), id 0.
    ///
    /// # Panics
    /// For more colour targets than [`TARGETS`], or more than 16,384 pixels a side.
    #[must_use]
    pub fn new(width: u32, height: u32, colors: usize) -> Self {
        assert!(colors <= TARGETS, "at most {TARGETS} colour targets");
        assert!(width.max(height) <= 16_384, "at most 16,384 pixels a side");
        let count = width as usize * height as usize;
        Self {
            width,
            height,
            colors: vec![vec![[0.0; 4]; count]; colors],
            depth: vec![0.0; count],
            ids: vec![0; count],
        }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// A colour target: red, green, blue, alpha in linear light.
    #[must_use]
    pub fn color(&self, target: usize) -> &[[f32; 4]] {
        &self.colors[target]
    }

    /// The depth target: 1 at the near plane, falling with distance; 0 where nothing is.
    #[must_use]
    pub fn depth(&self) -> &[f32] {
        &self.depth
    }

    /// The id target: which instance is seen, see [`DrawCall::first_id`](super::DrawCall::first_id).
    #[must_use]
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// A colour target as a picture: each pixel the mean of `scale × scale` of the target's.
    ///
    /// # Panics
    /// If `scale` does not divide both sides.
    #[must_use]
    pub fn frame(&self, target: usize, scale: u32) -> Frame {
        assert!(self.width.is_multiple_of(scale) && self.height.is_multiple_of(scale), "a whole picture");
        let (width, height) = (self.width / scale, self.height / scale);
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let pixels: Vec<[f32; 4]> = pixels.map(|pixel| self.mean(target, pixel, scale)).collect();
        let opaque = pixels.iter().all(|pixel| pixel[3] == 1.0);
        Frame {
            width,
            height,
            pixels: Pixels::Rgba32F { pixels, opaque },
            stats: Stats::default(),
            timings: Timings::default(),
            depth_range: None,
        }
    }

    /// Straight mean colour of a square of pixels.
    fn mean(&self, target: usize, [x, y]: [u32; 2], scale: u32) -> [f32; 4] {
        let rows = (y * scale..(y + 1) * scale).map(|row| row as usize * self.width as usize);
        let mut sum = [0.0f64; 4];
        for row in rows {
            let from = row + (x * scale) as usize;
            for color in &self.colors[target][from..from + scale as usize] {
                let [r, g, b, alpha] = color.map(f64::from);
                for (sum, value) in sum.iter_mut().zip([r * alpha, g * alpha, b * alpha, alpha]) {
                    *sum += value;
                }
            }
        }
        let [r, g, b, alpha] = sum;
        let color = if alpha > 0.0 { [r / alpha, g / alpha, b / alpha] } else { [0.0; 3] };
        [color[0], color[1], color[2], alpha / f64::from(scale * scale)].map(round_to_f32)
    }

    /// Fills a colour target.
    pub fn clear_color(&mut self, target: usize, color: [f32; 4]) {
        self.colors[target].fill(color);
    }

    /// Forgets depths and ids.
    pub fn clear_depth(&mut self) {
        self.depth.fill(0.0);
        self.ids.fill(0);
    }

    /// Splits the rectangle `of` by the tiles of its grid.
    pub(super) fn split(&mut self, of: &Rect, grid: &TileGrid) -> Vec<TargetTile<'_>> {
        let within = |from: u32, size: u32, all: u32| from.checked_add(size).is_some_and(|end| end <= all);
        assert!(
            within(of.x, of.width, self.width) && within(of.y, of.height, self.height),
            "the viewport lies within the targets"
        );
        let width = self.width as usize;
        let mut tiles: Vec<TargetTile> = (0..grid.tiles())
            .map(|tile| TargetTile {
                place: [tile % grid.columns, tile / grid.columns],
                colors: self.colors.iter().map(|_| Vec::new()).collect(),
                depth: Vec::new(),
                ids: Vec::new(),
            })
            .collect();
        for (target, pixels) in self.colors.iter_mut().enumerate() {
            share_rows(pixels, width, of, grid, |tile, part| tiles[tile].colors[target].push(part));
        }
        share_rows(&mut self.depth, width, of, grid, |tile, part| tiles[tile].depth.push(part));
        share_rows(&mut self.ids, width, of, grid, |tile, part| tiles[tile].ids.push(part));
        tiles
    }
}

/// Gives each tile (counted row by row) its part of every row of the rectangle.
fn share_rows<'a, P>(
    pixels: &'a mut [P],
    width: usize,
    of: &Rect,
    grid: &TileGrid,
    mut give: impl FnMut(usize, &'a mut [P]),
) {
    let (left, right) = (of.x as usize, (of.x + of.width) as usize);
    let rows = pixels.chunks_mut(width.max(1)).skip(of.y as usize).take(of.height as usize);
    for (y, row) in rows.enumerate() {
        let first = (y >> grid.tile_shift) * grid.columns as usize;
        for (tile, part) in (first..).zip(row[left..right].chunks_mut(1 << grid.tile_shift)) {
            give(tile, part);
        }
    }
}
