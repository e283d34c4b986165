//! Output: linear colour to bytes or floats, and what the data outputs show.

mod colors;
mod wireframe;

pub use colors::{Row, encode_frame, encode_tile, write_radiance};

use super::geometry::Bins;
use super::geometry::setup::Triangle;
use super::samples;
use super::tiles::cover::Region;
use super::tiles::fragments::SampleOrder;
use super::tiles::{self, AlphaTests, Scratch};
use super::work::{Cancelled, Work};
use crate::math::View;
use crate::plan::{Draw, Plan};

/// Draws a picture of 16-bit values.
///
/// # Errors
/// [`Cancelled`].
pub fn draw_values(plan: &Plan, bins: &Bins, pixels: &mut [u16], work: &Work) -> Result<(), Cancelled> {
    let side = 1usize << bins.grid.tile_shift;
    work.map(tiles::split(pixels, &bins.grid), Scratch::default, |scratch, tile| {
        find_seen(plan, bins, tile.place, work, scratch);
        let region = Region::of_tile(&bins.grid, tile.place[0], tile.place[1]);
        for (y, row) in tile.rows.into_iter().enumerate() {
            for (x, pixel) in row.iter_mut().enumerate() {
                let seen = scratch.seen(y * side + x, bins);
                *pixel = match plan.depth_range {
                    Some(range) => distance_code(seen, region.centre([x, y]), &plan.view, range),
                    None => instance_code(seen, &plan.draws),
                };
            }
        }
    })?;
    Ok(())
}

/// Draws the edges of what each pixel sees.
///
/// # Errors
/// [`Cancelled`].
pub fn draw_wireframe(
    plan: &Plan,
    bins: &Bins,
    pixels: &mut [[u8; 4]],
    work: &Work,
) -> Result<(), Cancelled> {
    let side = 1usize << bins.grid.tile_shift;
    let mut seen = vec![None; pixels.len()];
    work.map(tiles::split(&mut seen, &bins.grid), Scratch::default, |scratch, tile| {
        find_seen(plan, bins, tile.place, work, scratch);
        for (y, row) in tile.rows.into_iter().enumerate() {
            for (x, entry) in row.iter_mut().enumerate() {
                *entry = scratch.entry(y * side + x);
            }
        }
    })?;
    wireframe::draw(&plan.view, bins, &seen, pixels, work)
}

/// Finds what the centre of each pixel of a tile sees.
fn find_seen(plan: &Plan, bins: &Bins, place: [u32; 2], work: &Work, scratch: &mut Scratch) {
    let tests = AlphaTests { draws: &plan.draws, items: &plan.items, view: &plan.view };
    let order = SampleOrder { pattern: samples::pattern(1), nearest: &[0] };
    scratch.find_visible(work.level, bins, place, 1);
    scratch.find_cut_outs(work, bins, place, &order, &tests);
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
