//! Effects that need one pixel's colour alone.

use super::frame::{LinearFrame, bands};
use super::{Effect, finite, luminance};
use crate::math::colour::BRIGHTEST;
use crate::math::simd::*;
use crate::pipeline::output::Row;
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Curve, Pointwise};

/// Applies `steps` to the straight colours of eight pixels in a row; `place` is the first one's
/// column and row in the picture.
#[inline(always)]
pub fn apply<S: Simd>(simd: S, steps: &[Pointwise], mut color: Vec3x8<S>, place: [usize; 2]) -> Vec3x8<S> {
    for step in steps {
        color = match *step {
            Pointwise::Expose(factor) => scaled(color, factor),
            Pointwise::Tonemap { curve: Curve::Aces, exposure } => {
                Vec3x8 { x: aces(color.x, exposure), y: aces(color.y, exposure), z: aces(color.z, exposure) }
            }
            Pointwise::Tonemap { curve: Curve::Reinhard, exposure } => Vec3x8 {
                x: reinhard(color.x, exposure),
                y: reinhard(color.y, exposure),
                z: reinhard(color.z, exposure),
            },
            Pointwise::Grayscale(amount) => grayscale(color, amount),
            Pointwise::Vignette { centre, falloff } => vignette(simd, color, place, centre, falloff),
            Pointwise::ColorMatrix(rows) => {
                Vec3x8 { x: mixed(color, rows[0]), y: mixed(color, rows[1]), z: mixed(color, rows[2]) }
            }
        };
    }
    color
}

#[inline(always)]
fn scaled<S: Simd>(color: Vec3x8<S>, factor: f32) -> Vec3x8<S> {
    Vec3x8 { x: finite(color.x * factor), y: finite(color.y * factor), z: finite(color.z * factor) }
}

/// What a curve takes: exposed, from 0 to the brightest radiance; what is no number is 0.
#[inline(always)]
fn exposed<S: Simd>(x: f32x8<S>, exposure: f32) -> f32x8<S> {
    let simd = x.token();
    min(max(x * exposure, f32x8::splat(simd, 0.0)), f32x8::splat(simd, BRIGHTEST))
}

/// Source: K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. It ends a little above 1.
#[inline(always)]
fn aces<S: Simd>(x: f32x8<S>, exposure: f32) -> f32x8<S> {
    let x = exposed(x, exposure);
    let curve = x * (x * 2.51 + 0.03) / (x * (x * 2.43 + 0.59) + 0.14);
    min(curve, f32x8::splat(x.token(), 1.0))
}

/// Source: E. Reinhard et al., "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002, (3).
#[inline(always)]
fn reinhard<S: Simd>(x: f32x8<S>, exposure: f32) -> f32x8<S> {
    let x = exposed(x, exposure);
    x / (x + 1.0)
}

/// A weighted mean, and no difference that is added: so grey is grey in every bit.
#[inline(always)]
fn grayscale<S: Simd>(color: Vec3x8<S>, amount: f32) -> Vec3x8<S> {
    let grey = luminance(color) * amount;
    let rest = 1.0 - amount;
    Vec3x8 { x: color.x * rest + grey, y: color.y * rest + grey, z: color.z * rest + grey }
}

#[inline(always)]
fn vignette<S: Simd>(
    simd: S,
    color: Vec3x8<S>,
    place: [usize; 2],
    centre: [f32; 2],
    falloff: f32,
) -> Vec3x8<S> {
    let dx = f32x8::float_from(ramp_i32(simd)) + (pixel_centre(place[0]) - centre[0]);
    let dy = pixel_centre(place[1]) - centre[1];
    let factor = f32x8::splat(simd, 1.0) - (dx * dx + dy * dy) * falloff;
    color.scale(max(factor, f32x8::splat(simd, 0.0)))
}

/// Exact: a picture has at most 2¹⁴ pixels a side.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "at most 2¹⁴")]
fn pixel_centre(pixel: usize) -> f32 {
    pixel as f32 + 0.5
}

#[inline(always)]
fn mixed<S: Simd>(color: Vec3x8<S>, row: [f32; 4]) -> f32x8<S> {
    finite(color.x * row[0] + color.y * row[1] + color.z * row[2] + row[3])
}

/// Takes eight premultiplied colours through `steps`, which see them straight; `place` is the column
/// and row of the first.
#[inline(always)]
pub fn eight<S: Simd>(simd: S, from: &Row, x: usize, steps: &[Pointwise], place: [usize; 2]) -> Vec3x8<S> {
    let color = apply(simd, steps, from.straight(simd, x), place);
    from.premultiplied(simd, x, color)
}

/// Steps, taken one after the other by every pixel of a picture.
impl Effect for Vec<Pointwise> {
    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        // Without steps, straight colours would still be rounded where alpha is not 1.
        if self.is_empty() { Ok(()) } else { run(frame, self, work) }
    }
}

/// A single step.
impl Effect for Pointwise {
    fn apply(&self, frame: &mut LinearFrame, work: &Work) -> Result<(), Cancelled> {
        run(frame, std::slice::from_ref(self), work)
    }
}

/// Applies `steps` to a whole picture.
fn run(frame: &mut LinearFrame, steps: &[Pointwise], work: &Work) -> Result<(), Cancelled> {
    let stride = frame.planes[0].stride();
    work.map(
        bands(&mut frame.planes),
        || (),
        |(), (top, mut planes)| {
            dispatch!(work.level, simd => band(simd, &mut planes, stride, steps, top));
        },
    )?;
    Ok(())
}

/// Applies `steps` to a band of rows, the first of them `top`.
#[inline(always)]
fn band<S: Simd>(simd: S, planes: &mut [&mut [f32]], stride: usize, steps: &[Pointwise], top: usize) {
    let [red, green, blue, alpha @ ..] = planes else { return };
    for at in (0..red.len()).step_by(LANES) {
        let lanes = at..at + LANES;
        let from = Row {
            colors: [&red[lanes.clone()], &green[lanes.clone()], &blue[lanes.clone()]],
            alpha: alpha.first().map(|alpha| &alpha[lanes.clone()]),
        };
        let color = eight(simd, &from, 0, steps, [at % stride, top + at / stride]);
        color.x.store_slice(&mut red[lanes.clone()]);
        color.y.store_slice(&mut green[lanes.clone()]);
        color.z.store_slice(&mut blue[lanes]);
    }
}
