//! Post-processing: a picture in linear light in, the same picture after its effects out.
//!
//! Pointwise effects ([`pointwise`]) are steps on eight pixels in registers, taken wherever those pass
//! by: in the tiles, between two passes, on the way to bytes. Every other effect is made of passes
//! (`passes`) that write one plane row by row out of others, in bands of rows on all threads.
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

pub use frame::{LinearFrame, Plane, write_tile};
pub use passes::BAND;

use super::work::{Cancelled, Work};
use crate::math::simd::*;
use crate::plan::{Neighbourhood, PostChain};
use glam::Vec3;

/// Weights of linear red, green and blue in luminance. Source: ITU-R BT.709.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Largest magnitude that an effect leaves: products of two stay finite in f32.
const LARGEST: f32 = 1e18;

/// Runs the passes of `chain`. The steps after the last one are left to whoever encodes the frame.
///
/// # Errors
/// [`Cancelled`].
pub fn run_passes(frame: &mut LinearFrame, chain: &PostChain, work: &Work) -> Result<(), Cancelled> {
    for (pass, next) in chain.passes.iter().zip(1..) {
        match &pass.effect {
            Neighbourhood::Blur(gaussian) => gaussian::blur(frame, gaussian, work),
            Neighbourhood::Bloom { threshold, intensity, gaussian: Some(gaussian) } => {
                bloom::bloom(frame, *threshold, *intensity, gaussian, work)
            }
            Neighbourhood::Bloom { threshold, intensity, gaussian: None } => {
                bloom::brighten(frame, *threshold, *intensity, work)
            }
            Neighbourhood::Sharpen(amount) => sharpen::sharpen(frame, *amount, work),
            Neighbourhood::Fxaa => fxaa::fxaa(frame, work),
            Neighbourhood::Kernel(kernel) => kernel::correlate(frame, kernel, work),
        }?;
        if next < chain.passes.len() && !pass.then.is_empty() {
            pointwise::run(frame, &pass.then, work)?;
        }
    }
    Ok(())
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
