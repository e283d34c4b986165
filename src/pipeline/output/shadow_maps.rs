//! Shadow maps as grey pictures, side by side: bright is near the light, black is where nothing is.

use super::opaque;
use crate::math::View;
use crate::pipeline::shadow::{DepthMap, ShadowMap};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Plan, ShadowPass};

/// The darkest grey of a caster: the farthest of its light.
const FARTHEST: f64 = 64.0;

/// What surrounds each map.
const FRAME: [u8; 4] = [48, 48, 48, 255];

const BLACK: [u8; 4] = [0, 0, 0, 255];

/// Draws the maps of all lights of `plan`, in rows of squares as large as fit the picture. A lamp has six, in
/// the order +x, −x, +y, −y, +z, −z; those that are not drawn are black.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(plan: &Plan, maps: &[ShadowMap], work: &Work) -> Result<Vec<[u8; 4]>, Cancelled> {
    let size = [plan.view.width, plan.view.height].map(|side| side as usize);
    let tones: Vec<Tones> = plan.shadows.iter().zip(maps).map(|(pass, map)| Tones::of(pass, map)).collect();
    let maps = maps.iter().zip(&tones);
    let maps: Vec<Square> = maps
        .flat_map(|(map, tones)| map.depths().into_iter().map(move |map| Square { map, tones }))
        .collect();
    let sheet = Sheet::new(size, maps.len());
    let mut pixels = vec![BLACK; size[0] * size[1]];
    let rows = pixels.chunks_mut(size[0]).enumerate().collect();
    work.map(
        rows,
        || (),
        |(), (y, row): (usize, &mut [[u8; 4]])| {
            for (x, pixel) in row.iter_mut().enumerate() {
                if let Some((square, place)) = sheet.square([x, y]) {
                    *pixel = maps[square].pixel(place, sheet.side);
                }
            }
        },
    )?;
    Ok(pixels)
}

/// Where squares lie in a picture.
struct Sheet {
    /// Pixels along a square.
    side: usize,
    columns: usize,
    count: usize,
    /// The upper left corner of the first.
    corner: [usize; 2],
}

impl Sheet {
    /// The number of columns that makes `count` squares largest, in the middle of a picture.
    fn new(size: [usize; 2], count: usize) -> Self {
        let side = |columns: usize| (size[0] / columns).min(size[1] / count.div_ceil(columns));
        // Of equals the last: a row before a column.
        let columns = (1..=count).max_by_key(|&columns| side(columns)).unwrap_or(1);
        let side = if count == 0 { 0 } else { side(columns) };
        let used = [columns, count.div_ceil(columns)].map(|squares| squares * side);
        let corner = [0, 1].map(|axis| (size[axis] - used[axis]) / 2);
        Self { side, columns, count, corner }
    }

    /// Which square a pixel is in, and where in it.
    fn square(&self, pixel: [usize; 2]) -> Option<(usize, [usize; 2])> {
        let [x, y] = [pixel[0].checked_sub(self.corner[0])?, pixel[1].checked_sub(self.corner[1])?];
        let [column, row] = [x.checked_div(self.side)?, y.checked_div(self.side)?];
        let square = row * self.columns + column;
        (column < self.columns && square < self.count).then(|| (square, [x % self.side, y % self.side]))
    }
}

/// A map in its square.
struct Square<'a> {
    /// `None`: it is not drawn.
    map: Option<&'a DepthMap>,
    tones: &'a Tones<'a>,
}

impl Square<'_> {
    /// The pixel of a square of `side` pixels, of which the outermost are its frame.
    fn pixel(&self, place: [usize; 2], side: usize) -> [u8; 4] {
        if place.iter().any(|&n| n == 0 || n + 1 == side) {
            return FRAME;
        }
        let Some(map) = self.map else { return BLACK };
        let [x, y] = place.map(|n| texels(n - 1, side - 2, map.resolution()));
        let count = f64::from((x[1] - x[0]) * (y[1] - y[0]));
        let texels = (y[0]..y[1]).flat_map(|y| (x[0]..x[1]).map(move |x| map.texel(x, y)));
        let sum: f64 = texels.map(|depth| self.tones.grey(depth)).sum();
        let grey = byte(sum / count);
        opaque([grey; 3])
    }
}

/// The texels of one of `pixels` pixels, from the first to before the last; at least one.
fn texels(pixel: usize, pixels: usize, resolution: u32) -> [i32; 2] {
    let at = |pixel: usize| pixel * resolution as usize / pixels;
    let (first, end) = (at(pixel), at(pixel + 1).max(at(pixel) + 1));
    [first, end].map(|n| i32::try_from(n).expect("maps are smaller than 2³¹ texels"))
}

/// What greys stand for: the distances of one light's casters.
struct Tones<'a> {
    view: &'a View,
    nearest: f64,
    farthest: f64,
}

impl<'a> Tones<'a> {
    fn of(pass: &'a ShadowPass, map: &ShadowMap) -> Self {
        let view = &pass.faces().first().expect("a shadow has a map at least").view;
        let maps = map.depths();
        let depths = maps.iter().flatten().flat_map(|map| map.depths());
        let [least, greatest] = depths.fold([1.0f32, 0.0], |[a, b], depth| [a.min(depth), b.max(depth)]);
        let [farthest, nearest] = [least, greatest].map(|depth| view.distance(f64::from(depth)));
        Self { view, nearest, farthest }
    }

    /// The grey of a depth, 0–255.
    fn grey(&self, depth: f32) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let range = self.farthest - self.nearest;
        let beyond = self.farthest - self.view.distance(f64::from(depth));
        let share = if range > 0.0 { beyond / range } else { 1.0 };
        FARTHEST + (255.0 - FARTHEST) * share
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "greys are in 0–255")]
fn byte(grey: f64) -> u8 {
    (grey + 0.5).floor() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_as_large_as_fit_and_do_not_overlap() {
        let shape = |size, count| {
            let sheet = Sheet::new(size, count);
            (sheet.side, sheet.columns, sheet.corner)
        };
        assert_eq!(shape([80, 60], 1), (60, 1, [10, 0]));
        assert_eq!(shape([80, 60], 2), (40, 2, [0, 10]));
        assert_eq!(shape([90, 60], 6), (30, 3, [0, 0]));
        assert_eq!(shape([2, 2], 7).0, 0);
        let sheet = Sheet::new([90, 60], 5);
        assert_eq!(sheet.square([31, 2]), Some((1, [1, 2])));
        assert_eq!(sheet.square([89, 59]), None);
        assert_eq!(Sheet::new([80, 60], 0).square([40, 30]), None);
        assert_eq!(Sheet::new([2, 2], 7).square([1, 1]), None);
    }

    #[test]
    fn every_texel_is_in_a_pixel_and_every_pixel_has_one() {
        for (pixels, resolution) in [(30, 100), (100, 30), (64, 64), (1, 5)] {
            let all: Vec<[i32; 2]> = (0..pixels).map(|pixel| texels(pixel, pixels, resolution)).collect();
            assert!(all.iter().all(|[first, end]| first < end));
            assert_eq!((all[0][0], all[pixels - 1][1]), (0, resolution.cast_signed()));
            assert!(all.windows(2).all(|pair| pair[1][0] <= pair[0][1]));
        }
    }
}
