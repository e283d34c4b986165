//! Output: linear colour to bytes or floats, and what the data outputs show.

mod colors;
mod digits;
mod heat;
mod shadow_maps;
mod wireframe;

pub use colors::{Row, encode_frame, encode_tile, write_radiance, write_radiance_frame};
pub use shadow_maps::draw as draw_shadow_maps;
pub use wireframe::draw as draw_wireframe;

use super::geometry::Bins;
use super::geometry::setup::Triangle;
use super::tiles::cover::Region;
use super::tiles::fragments::Entry;
use super::tiles::{Resolved, Scratch, Tile};
use crate::math::View;
use crate::plan::{Draw, Output, Plan};

/// Writes a tile of 16-bit values: distances or instances.
pub fn write_values(plan: &Plan, bins: &Bins, seen: &Scratch, tile: Tile<u16>) {
    let side = 1usize << bins.grid.tile_shift;
    let region = Region::of_tile(&bins.grid, tile.place[0], tile.place[1]);
    for (y, row) in tile.rows.into_iter().enumerate() {
        for (x, pixel) in row.iter_mut().enumerate() {
            let seen = seen.seen(y * side + x, bins);
            *pixel = match plan.depth_range {
                Some(range) => distance_code(seen, region.centre([x, y]), &plan.view, range),
                None => instance_code(seen, &plan.draws),
            };
        }
    }
}

/// Writes a tile of colours that stand for what is seen: for instances, or for how many triangles the tile
/// lists.
pub fn write_false_colors(plan: &Plan, bins: &Bins, seen: &Scratch, tile: Tile<[u8; 4]>) {
    let side = 1usize << bins.grid.tile_shift;
    if plan.output == Output::Tiles {
        digits::write_count(seen.list().len(), side, tile);
        return;
    }
    for (y, row) in tile.rows.into_iter().enumerate() {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = id_color(instance_code(seen.seen(y * side + x, bins), &plan.draws));
        }
    }
}

/// Writes how many fragments were shaded for each pixel of a tile.
///
/// # Panics
/// If nobody has counted them.
pub fn write_counts(resolved: &Resolved, tile: Tile<[u8; 4]>) {
    let counts = resolved.counts.expect("the fragments of a picture of counts are counted");
    for (row, counts) in tile.rows.into_iter().zip(counts.chunks(resolved.side)) {
        for (pixel, &count) in row.iter_mut().zip(counts) {
            *pixel = opaque(heat::of_fragments(count));
        }
    }
}

/// The colour of an instance's value: black for none; others far apart, and no two the same.
///
/// Fibonacci hashing: D. Knuth, "The Art of Computer Programming", volume 3, section 6.4. The odd factor is 2³²
/// divided by the golden ratio.
fn id_color(id: u16) -> [u8; 4] {
    let [r, g, b, _] = u32::from(id).wrapping_mul(0x9E37_79B1).to_be_bytes();
    opaque([r, g, b])
}

fn opaque([r, g, b]: [u8; 3]) -> [u8; 4] {
    [r, g, b, 255]
}

/// Writes which triangle each pixel of a tile sees.
pub fn write_entries(bins: &Bins, seen: &Scratch, tile: Tile<Option<Entry>>) {
    let side = 1usize << bins.grid.tile_shift;
    for (y, row) in tile.rows.into_iter().enumerate() {
        for (x, entry) in row.iter_mut().enumerate() {
            *entry = seen.entry(y * side + x);
        }
    }
}

/// 65535 · (z − near) / (far − near) of the view-space distance z; 65535 for the background.
fn distance_code(seen: Option<&Triangle>, screen: [f64; 2], view: &View, range: [f64; 2]) -> u16 {
    let Some(seen) = seen else { return u16::MAX };
    let z = view.distance(seen.depth_at(screen[0], screen[1]));
    let share = ((z - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0);
    unorm16(share)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share is in 0–1")]
fn unorm16(share: f64) -> u16 {
    (65535.0 * share + 0.5).floor() as u16
}

/// 0 for the background, else 1 + the instance's place among all names in order.
fn instance_code(seen: Option<&Triangle>, draws: &[Draw]) -> u16 {
    seen.map_or(0, |seen| {
        let place = draws[seen.draw as usize].instance;
        u16::try_from(place + 1).expect("invariant: a scene has at most MAX_INSTANCES")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numerics: B42.
    #[test]
    fn a_value_becomes_the_nearest_of_all_16_bit_codes() {
        for code in 0..=u16::MAX {
            let exact = f64::from(code);
            assert_eq!(unorm16(exact / 65535.0), code);
            for beside in [exact - 0.499_999, exact + 0.499_999] {
                assert_eq!(unorm16((beside / 65535.0).clamp(0.0, 1.0)), code);
            }
        }
        assert_eq!(unorm16(f64::NAN), 0);
    }
}
