//! A picture in linear light on its way through the passes.

use super::passes::BAND;
use super::pointwise;
use crate::math::simd::*;
use crate::pipeline::geometry::bin::TileGrid;
use crate::pipeline::output::Row;
use crate::pipeline::tiles::{Resolved, Tile};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Pointwise, PostChain};

/// One channel of a picture, `stride × height` samples: pixels of a row, then padding of any finite
/// value.
#[derive(Debug, Default)]
pub struct Plane {
    stride: usize,
    samples: Vec<f32>,
}

impl Plane {
    fn new(stride: usize, height: usize) -> Self {
        Self { stride, samples: vec![0.0; stride * height] }
    }

    /// Samples from one row to the next: a multiple of a strip.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The row `y` with its padding.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, y: usize) -> &[f32] {
        &self.samples[y * self.stride..][..self.stride]
    }

    /// The row `y` with its padding, to be written.
    #[inline(always)]
    pub fn row_mut(&mut self, y: usize) -> &mut [f32] {
        &mut self.samples[y * self.stride..][..self.stride]
    }

    /// Every row, in bands of [`BAND`]: each with the number of its first row.
    pub(super) fn bands(&mut self) -> impl Iterator<Item = (usize, &mut [f32])> {
        (0..).step_by(BAND).zip(self.samples.chunks_mut(self.stride * BAND))
    }
}

/// A picture in linear light, premultiplied with alpha.
#[derive(Debug)]
pub struct LinearFrame {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue, and alpha if the background is transparent.
    pub planes: Vec<Plane>,
    /// What effects work in, of the same size; of any finite content between them.
    pub spare: Vec<Plane>,
}

impl LinearFrame {
    /// Room for a black picture of `width × height` pixels, and for `spare` planes to work in.
    #[must_use]
    pub fn new([width, height]: [u32; 2], transparent: bool, spare: usize) -> Self {
        let plane = |_| Plane::new(PostChain::stride(width), height as usize);
        Self {
            width: width as usize,
            height: height as usize,
            planes: (0..3 + usize::from(transparent)).map(plane).collect(),
            spare: (0..spare).map(plane).collect(),
        }
    }

    /// The row `y` as it is encoded.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, y: usize) -> Row<'_> {
        let [r, g, b] = [0, 1, 2].map(|c: usize| self.planes[c].row(y));
        Row { colors: [r, g, b], alpha: self.planes.get(3).map(|alpha| alpha.row(y)) }
    }

    /// Splits the planes into the rows of the picture's tiles: all rows of red, then of green, blue
    /// and, if there is one, alpha; each with its share of the padding.
    #[must_use]
    pub fn tiles(&mut self, grid: &TileGrid) -> Vec<Tile<'_, f32>> {
        let side = 1usize << grid.tile_shift;
        let columns = grid.columns as usize;
        let row_count = side * self.planes.len();
        let place = |i: u32| [i % grid.columns, i / grid.columns];
        let mut tiles: Vec<_> = (0..grid.tiles())
            .map(|i| Tile { place: place(i), rows: Vec::with_capacity(row_count) })
            .collect();
        for plane in &mut self.planes {
            for (y, row) in plane.samples.chunks_mut(plane.stride).enumerate() {
                let tiles = tiles.iter_mut().skip((y >> grid.tile_shift) * columns).take(columns);
                for (tile, part) in tiles.zip(row.chunks_mut(side)) {
                    tile.rows.push(part);
                }
            }
        }
        tiles
    }
}

/// Calls `write(y, rows)` for every row on all threads: `rows` holds row `y` of each of `planes`, which
/// are of one size. Pixels are followed by padding, which may be left as it is.
///
/// The planes of a picture may be written while its spare ones are read, and the other way round: they
/// are fields of their own.
///
/// # Errors
/// [`Cancelled`].
pub fn write_rows(
    planes: &mut [Plane],
    work: &Work,
    write: impl Fn(usize, &mut [&mut [f32]]) + Sync,
) -> Result<(), Cancelled> {
    let Some(stride) = planes.first().map(Plane::stride) else { return Ok(()) };
    work.map(
        bands(planes),
        || (),
        |(), (top, planes)| {
            let mut planes: Vec<_> = planes.into_iter().map(|band| band.chunks_exact_mut(stride)).collect();
            for y in top.. {
                let mut rows: Vec<&mut [f32]> = planes.iter_mut().filter_map(Iterator::next).collect();
                if rows.is_empty() {
                    return;
                }
                write(y, &mut rows);
            }
        },
    )?;
    Ok(())
}

/// Splits planes of one size into bands of [`BAND`] rows: each with the number of its first row, and
/// its part of every plane.
pub(super) fn bands(planes: &mut [Plane]) -> Vec<(usize, Vec<&mut [f32]>)> {
    let mut bands: Vec<(usize, Vec<&mut [f32]>)> = Vec::new();
    for plane in planes {
        for (band, (top, rows)) in plane.bands().enumerate() {
            match bands.get_mut(band) {
                Some((_, parts)) => parts.push(rows),
                None => bands.push((top, vec![rows])),
            }
        }
    }
    bands
}

/// Writes a tile's colours, after `steps`, to the rows that [`LinearFrame::tiles`] gave it.
pub fn write_tile(level: Level, resolved: &Resolved, steps: &[Pointwise], mut tile: Tile<f32>) {
    let channels = if resolved.alpha.is_some() { 4 } else { 3 };
    let count = tile.rows.len() / channels;
    let (colors, alpha) = tile.rows.split_at_mut(3 * count);
    if steps.is_empty() {
        for (rows, from) in colors.chunks_mut(count).zip(resolved.colors) {
            copy(rows, from, resolved.side);
        }
    } else {
        let corner = resolved.corner(tile.place);
        dispatch!(level, simd => write_colors(simd, resolved, steps, corner, colors));
    }
    if let Some(from) = resolved.alpha {
        copy(alpha, from, resolved.side);
    }
}

fn copy(rows: &mut [&mut [f32]], from: &[f32], side: usize) {
    for (row, from) in rows.iter_mut().zip(from.chunks_exact(side)) {
        row.copy_from_slice(&from[..row.len()]);
    }
}

/// `rows`: all of red, then of green, then of blue.
#[inline(always)]
fn write_colors<S: Simd>(
    simd: S,
    resolved: &Resolved,
    steps: &[Pointwise],
    corner: [usize; 2],
    rows: &mut [&mut [f32]],
) {
    let (red, rest) = rows.split_at_mut(rows.len() / 3);
    let (green, blue) = rest.split_at_mut(red.len());
    for (y, ((red, green), blue)) in red.iter_mut().zip(green).zip(blue).enumerate() {
        let from = resolved.row(y);
        for x in (0..red.len()).step_by(LANES) {
            let color = pointwise::eight(simd, &from, x, steps, [corner[0] + x, corner[1] + y]);
            color.x.store_slice(&mut red[x..x + LANES]);
            color.y.store_slice(&mut green[x..x + LANES]);
            color.z.store_slice(&mut blue[x..x + LANES]);
        }
    }
}
