//! What is at one pixel.

use super::samples;
use super::tiles::cover::Region;
use super::tiles::fragments::SampleOrder;
use super::tiles::{AlphaTests, Scratch, tile_shift};
use super::work::{Cancelled, Work};
use crate::plan::Plan;
use glam::DVec3;

/// The surface at a pixel's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index into the scene's instances.
    pub instance: u32,
    /// Index of the triangle in its mesh.
    pub triangle: u32,
    /// View-space distance along the axis.
    pub depth: f64,
    /// Where it is, in world space.
    pub position: DVec3,
}

/// What is seen at the centre of the pixel (x, y); `None` for the background. The plan must be one of
/// a data output: of a single sample a pixel, with nothing blended.
///
/// # Errors
/// [`Cancelled`].
pub fn pick(plan: &Plan, x: u32, y: u32, work: &Work) -> Result<Option<Hit>, Cancelled> {
    let bins = super::transform_clip_and_bin(plan, &[], work)?;
    let shift = tile_shift(plan.samples);
    let place = [x >> shift, y >> shift];
    let mut scratch = Scratch::default();
    scratch.find_visible(work.level, &bins, place, plan.samples);
    let tests = AlphaTests::of(plan);
    let order = SampleOrder { pattern: samples::pattern(1), nearest: &[0] };
    scratch.find_cut_outs(work, &bins, place, &order, &tests);
    let within = [x, y].map(|c| (c & ((1 << shift) - 1)) as usize);
    let Some(seen) = scratch.seen((within[1] << shift) + within[0], &bins) else { return Ok(None) };
    let screen = Region::of_tile(&bins.grid, place[0], place[1]).centre(within);
    let depth = plan.view.distance(seen.depth_at(screen[0], screen[1]));
    Ok(Some(Hit {
        instance: plan.draws[seen.draw as usize].instance,
        triangle: seen.source,
        depth,
        position: plan.view.point(screen, depth) + plan.scene.anchor,
    }))
}
