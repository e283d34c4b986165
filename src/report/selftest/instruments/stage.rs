//! Drives the stages one at a time, as a frame does, and shows what they hand on.

use super::draw::{level, work};
use crate::math::simd::*;
use crate::math::{Bounds, Projection, View};
use crate::model::{Mesh, Part};
use crate::pipeline::geometry::bin::TileGrid;
use crate::pipeline::geometry::setup::Triangle;
use crate::pipeline::geometry::{self, Bins};
use crate::pipeline::samples;
use crate::pipeline::tiles::cover::{self, BlockDepths, Region, Target};
use crate::pipeline::tiles::{Scratch, tile_shift};
use crate::plan::{Elisions, Item, Opacity, Slot};
use crate::report::random::Random;
use crate::scene::Cull;
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// A view of which one unit is one pixel: a corner made by [`on_screen`] snaps to exactly the
/// sub-pixels it names, and has exactly the depth it names.
pub fn flat_view(width: u32, height: u32) -> View {
    View {
        projection: Projection::Orthographic,
        scale: [256.0; 2],
        near: 1.0,
        // An orthographic depth falls to 2⁻¹⁰ at the far plane: so by 1 per unit.
        far: 2.0 - 1.0 / 1024.0,
        ..perspective_view(width, height, 1.0, 1.0)
    }
}

/// The point that [`flat_view`] shows at `[x, y]` sub-pixels (y down) from the picture's centre, at
/// a depth of at most 30 bits.
pub fn on_screen([x, y]: [f64; 2], depth: f64) -> DVec3 {
    DVec3::new(x / 256.0, -y / 256.0, depth - 2.0)
}

/// A camera at zero that looks along −z, with an infinite far plane.
pub fn perspective_view(width: u32, height: u32, tan_half_fov_y: f64, near: f64) -> View {
    View {
        eye: DVec3::ZERO,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Perspective,
        scale: [f64::from(height) * 128.0 / tan_half_fov_y; 2],
        near,
        far: f64::INFINITY,
        width,
        height,
    }
}

/// The point at distance `w` that a [`perspective_view`] shows at `[x, y]` sub-pixels (y down).
pub fn at_distance(view: &View, [x, y]: [f64; 2], w: f64) -> DVec3 {
    DVec3::new(x * w / view.scale[0], -y * w / view.scale[1], -w)
}

/// A mesh of one material.
pub fn mesh(positions: &[DVec3], triangles: Vec<[u32; 3]>) -> Mesh {
    let axis = |i: usize| positions.iter().map(|p| p[i]).collect();
    let first = Part { first_triangle: 0, slot: 0 };
    Mesh {
        origin: DVec3::ZERO,
        positions: [axis(0), axis(1), axis(2)],
        normals: vec![Vec3::Z; positions.len()],
        uvs: None,
        colors: None,
        parts: if triangles.is_empty() { Vec::new() } else { vec![first] },
        triangles,
        slots: vec![None],
        bounds: Bounds::around(positions.iter().copied()),
    }
}

/// Triangles that share no vertex.
pub fn soup(triangles: &[[DVec3; 3]]) -> Mesh {
    let count = u32::try_from(triangles.len()).expect("a check has few triangles");
    let indices = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    mesh(triangles.as_flattened(), indices.collect())
}

/// A mesh where it was made, both of its sides seen.
pub fn two_sided(mesh: Mesh) -> Item {
    let slot = Slot { draw: 0, cull: Cull::None, opacity: Opacity::Opaque };
    Item {
        mesh: Arc::new(mesh),
        linear: DMat3::IDENTITY,
        origin: DVec3::ZERO,
        mirrored: false,
        slots: vec![Some(slot)],
    }
}

/// Runs the geometry stage.
pub fn bins(item: Item, view: &View, samples: u32) -> Bins {
    let grid = TileGrid::new(view, tile_shift(samples), samples::pattern(samples));
    geometry::run(&[item], view, grid, Elisions::ALL, &work()).expect("nobody cancels")
}

/// Every set-up triangle in submission order.
pub fn triangles(bins: &Bins) -> impl Iterator<Item = &Triangle> {
    bins.chunks.iter().flat_map(|chunk| &chunk.triangles)
}

/// What every sample of a picture sees. Sample `s` of the pixel (x, y) is at
/// `(y · width + x) · samples + s`.
#[derive(Debug, PartialEq)]
pub struct Seen {
    /// 1 + the place of the triangle among [`triangles`], 0 for none.
    pub id: Vec<u32>,
    /// Depth; 0 for none.
    pub depth: Vec<f32>,
}

impl Seen {
    /// 1 + the triangle's index in its mesh, 0 for none.
    pub fn sources(&self, bins: &Bins) -> Vec<u32> {
        let all: Vec<u32> = triangles(bins).map(|t| t.source + 1).collect();
        let source = |&id: &u32| id.checked_sub(1).map_or(0, |at| all[at as usize]);
        self.id.iter().map(source).collect()
    }
}

/// Runs the visibility step of every tile.
pub fn visible(bins: &Bins, samples: u32) -> Seen {
    let mut first = vec![0];
    for chunk in &bins.chunks {
        first.push(first.last().unwrap_or(&0) + chunk.triangles.len() as u32);
    }
    let mut scratch = Scratch::default();
    let mut seen = Seen { id: vec![0; count(bins, samples)], depth: vec![0.0; count(bins, samples)] };
    for place in places(bins) {
        scratch.find_visible(level(), bins, place, samples);
        let tile = scratch.visibility();
        for_each_sample(bins, place, samples, |within, whole| {
            seen.depth[whole] = tile.depth[within];
            if let Some(at) = tile.id[within].checked_sub(1) {
                let (chunk, index) = scratch.list()[at as usize];
                seen.id[whole] = first[chunk as usize] + index + 1;
            }
        });
    }
    seen
}

/// How many triangles cover each sample, whatever hides them; in the order of [`Seen`].
pub fn cover_counts(bins: &Bins, samples: u32) -> Vec<u32> {
    let side = 1usize << bins.grid.tile_shift;
    let pattern = samples::pattern(samples);
    let mut counts = vec![0; count(bins, samples)];
    let (mut tile, mut blocks) = (Vec::new(), BlockDepths::default());
    for place in places(bins) {
        tile.clear();
        tile.resize(side * side * pattern.len(), 0);
        let region = Region::of_tile(&bins.grid, place[0], place[1]);
        for chunk in &bins.chunks {
            for &index in chunk.tile(place[0], place[1]) {
                let t = &chunk.triangles[index as usize];
                blocks.clear(side);
                let mut target = Counter(&mut tile);
                dispatch!(level(), simd => {
                    cover::cover(simd, t, &region, side, pattern, &mut blocks, &mut target);
                });
            }
        }
        for_each_sample(bins, place, samples, |within, whole| counts[whole] = tile[within]);
    }
    counts
}

/// Counts what covers a sample instead of keeping the nearest.
struct Counter<'a>(&'a mut [u32]);

impl<S: Simd> Target<S> for Counter<'_> {
    #[inline(always)]
    fn test_and_write(&mut self, _: S, at: usize, mask: mask32x8<S>, _: f32x8<S>) {
        let bits = mask.to_bitmask();
        for (lane, count) in self.0[at..at + LANES].iter_mut().enumerate() {
            *count += u32::from(bits >> lane & 1 == 1);
        }
    }
}

fn count(bins: &Bins, samples: u32) -> usize {
    (bins.grid.width * bins.grid.height * samples) as usize
}

fn places(bins: &Bins) -> impl Iterator<Item = [u32; 2]> + use<> {
    let (columns, rows) = (bins.grid.columns, bins.grid.rows);
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]))
}

/// Calls `f` with the index of every sample of a tile within the tile's buffers and within a
/// [`Seen`].
fn for_each_sample(bins: &Bins, place: [u32; 2], samples: u32, mut f: impl FnMut(usize, usize)) {
    let side = 1usize << bins.grid.tile_shift;
    let region = Region::of_tile(&bins.grid, place[0], place[1]);
    let [left, top] = place.map(|n| n as usize * side);
    let (width, samples) = (bins.grid.width as usize, samples as usize);
    for y in 0..region.size[1] {
        for x in 0..region.size[0] {
            let pixel = (top + y) * width + left + x;
            for s in 0..samples {
                f((s * side + y) * side + x, pixel * samples + s);
            }
        }
    }
}

/// A grid of `n × n` quads, each cut along a random diagonal. `corner` places the vertex in a column
/// and row, 0..=n; triangles wind like (column, row), (column + 1, row), (column, row + 1).
pub fn grid(
    n: i32,
    rng: &mut Random,
    mut corner: impl FnMut(&mut Random, i32, i32) -> DVec3,
) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=n {
        for column in 0..=n {
            positions.push(corner(rng, column, row));
        }
    }
    let n = n.cast_unsigned();
    for a in (0..n).flat_map(|row| (0..n).map(move |column| row * (n + 1) + column)) {
        let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
        let halves = if rng.below(2) == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] };
        triangles.extend(halves);
    }
    (positions, triangles)
}
