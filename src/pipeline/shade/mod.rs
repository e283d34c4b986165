//! Shading: visible fragments in, linear RGB out. Each triangle is shaded once a pixel.
//!
//! Fragments come sorted by draw and triangle. A block of up to [`BLOCK`] of them goes through a
//! short sequence of kernels, which a [`SurfaceShader`] puts together.

mod alpha;
pub mod light;
pub mod relief;
mod surface;
pub(super) mod table;
pub mod texture;
pub mod varyings;

pub use surface::{HoleShader, SurfaceShader};

use super::shadow::ShadowMap;
use crate::math::{Bounds, View};
use crate::plan::{Elisions, Tally};
use glam::{DVec3, Vec3};
use light::LightSource;
use varyings::Varyings;

/// Fragments of one block.
pub const BLOCK: usize = 64;

/// One triangle's share of one pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fragment {
    /// Which of the draw's records is its triangle.
    pub record: u32,
    /// Where its colour goes.
    pub target: u32,
    /// Screen x of its shading point in sub-pixels.
    pub x: i32,
    /// Screen y.
    pub y: i32,
}

/// What is the same for a whole frame.
pub struct Lighting<'a> {
    /// Ambient radiance.
    pub ambient: Vec3,
    /// Every light that shines.
    pub lights: Vec<LightSource>,
    /// The lights' shadows.
    pub maps: &'a [ShadowMap],
    /// The camera.
    pub view: &'a View,
    /// What positions are relative to: an offset from the eye, see [`anchor`].
    pub anchor: DVec3,
    /// What may be left out.
    pub elide: Elisions,
}

/// What positions are shaded relative to, as an offset from the eye: the point of the viewing axis that
/// is as far as the nearest corner of the scene's `bounds`, culled or not.
///
/// Seen through a narrow lens everything is far from the eye and close to everything else: there
/// f32 positions relative to the eye could not tell one pixel from the next.
#[must_use]
pub fn anchor(bounds: Option<Bounds>, view: &View) -> DVec3 {
    let corners = bounds.into_iter().flat_map(Bounds::corners);
    let distances = corners.map(|p| (p - view.eye).dot(view.forward));
    let nearest = distances.fold(f64::INFINITY, f64::min);
    if nearest.is_finite() { view.forward * nearest.max(0.0) } else { DVec3::ZERO }
}

/// Buffers of one block, kept between blocks.
pub struct Scratch {
    varyings: Varyings,
    visibility: [f32; BLOCK],
    tally: Tally,
}

impl Scratch {
    /// What shading cost and was spared since it was last asked.
    pub fn take_tally(&mut self) -> Tally {
        std::mem::take(&mut self.tally)
    }
}

impl Default for Scratch {
    fn default() -> Self {
        Self { varyings: Varyings::default(), visibility: [1.0; BLOCK], tally: Tally::default() }
    }
}
