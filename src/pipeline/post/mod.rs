//! Post-processing: a picture in linear light in, the same picture after its effects out.
//!
//! Pointwise effects ([`pointwise`]) are steps on eight pixels in registers, taken wherever those pass
//! by: in the tiles, between two effects, on the way to bytes. Every other [`Effect`] is made of passes
//! that write planes row by row out of others, in bands of rows on all threads: the built-in ones in
//! strips of vectors (`passes`), a caller's own by [`write_rows`]. A [`Chain`] has them in order.
//!
//! Colour is linear and premultiplied with alpha here; pointwise steps see it straight. Nothing is
//! clamped to 0–1 between effects, but every effect leaves finite numbers, whatever its parameters.

mod bloom;
mod frame;
mod fxaa;
mod gaussian;
mod kernel;
mod passes;
pub mod pointwise;
mod sharpen;

pub use frame::{LinearFrame, Plane, write_rows, write_tile};
pub use passes::BAND;

use super::work::{Cancelled, Work};
use crate::math::simd::*;
use crate::plan::{Neighbourhood, Pointwise, PostChain};
use glam::Vec3;

/// Weights of linear red, green and blue in luminance. Source: ITU-R BT.709.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Largest magnitude that an effect leaves: products of two stay finite in f32.
const LARGEST: f32 = 1e18;

/// A post effect: an image in, an image out.
///
/// What a document's `post` may ask for is made of it ([`Gaussian`](crate::plan::Gaussian),
/// [`Bloom`](crate::plan::Bloom), [`Sharpen`](crate::plan::Sharpen), [`Fxaa`](crate::plan::Fxaa),
/// [`Kernel`](crate::plan::Kernel), [`Pointwise`]), and so are effects of a caller's own, which
/// [`render_with`](super::render_with) runs. `examples/custom_post.rs` has one.
pub trait Effect: Sync {
    /// How many planes of [`LinearFrame::spare`] it works in; there may be more.
    fn spare_planes(&self) -> usize {
        0
    }

    /// Changes the picture.
    ///
    /// Its colours are linear and premultiplied with alpha, finite, not clamped, and so is its padding.
    /// They must be finite afterwards, and the same for any number of threads: rows are written by
    /// [`write_rows`], out of planes that nobody writes meanwhile.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled>;
}

/// What happens to a picture that the tiles have left in linear light.
pub struct Chain<'a> {
    effects: Vec<&'a dyn Effect>,
    last_steps: &'a [Pointwise],
}

impl<'a> Chain<'a> {
    /// The passes of a plan, then the effects of a caller.
    #[must_use]
    pub fn new(plan: &'a PostChain, own: &[&'a dyn Effect]) -> Self {
        let mut effects: Vec<&dyn Effect> = Vec::new();
        for pass in &plan.passes {
            effects.extend(pass.effect.as_ref().map(Neighbourhood::as_effect));
            effects.push(&pass.then);
        }
        if own.is_empty() {
            // What ends the chain is left to whoever encodes the picture.
            effects.pop();
            return Self { effects, last_steps: plan.last_steps() };
        }
        effects.extend(own);
        Self { effects, last_steps: &[] }
    }

    /// Whether the picture stays as the tiles have left it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.effects.is_empty()
    }

    /// Spare planes that the picture needs.
    #[must_use]
    pub fn spare_planes(&self) -> usize {
        self.effects.iter().map(|effect| effect.spare_planes()).max().unwrap_or(0)
    }

    /// Runs all but the [last steps](Self::last_steps).
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn run(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        self.effects.iter().try_for_each(|effect| effect.apply(frame, work))
    }

    /// What is left to do on the way to bytes.
    #[must_use]
    pub fn last_steps(&self) -> &'a [Pointwise] {
        self.last_steps
    }
}

impl Neighbourhood {
    /// What does it.
    #[must_use]
    pub fn as_effect(&self) -> &dyn Effect {
        match self {
            Self::Blur(gaussian) => gaussian,
            Self::Bloom(bloom) => bloom,
            Self::Sharpen(sharpen) => sharpen,
            Self::Fxaa(fxaa) => fxaa,
            Self::Kernel(kernel) => kernel,
        }
    }
}

/// Rec. 709 luminance.
#[inline(always)]
fn luminance<S: Simd>(color: Vec3x8<S>) -> f32x8<S> {
    color.x * LUMINANCE.x + color.y * LUMINANCE.y + color.z * LUMINANCE.z
}

/// `x` within ±[`LARGEST`]; what is no number is 0.
#[inline(always)]
fn finite<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let simd = x.token();
    let bound = f32x8::splat(simd, LARGEST);
    let number = x.simd_eq(x).select(x, f32x8::splat(simd, 0.0));
    min(max(number, f32x8::splat(simd, -LARGEST)), bound)
}
