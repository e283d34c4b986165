//! Resampling: a picture drawn with more or fewer pixels than it has, brought to its size.
//!
//! In linear light and premultiplied, on what is otherwise finished.

use super::output;
use super::post::{LinearFrame, Plane, write_rows};
use super::target::Pixels;
use super::work::{Cancelled, Work};
use crate::math::colour::SRGB_DECODE;
use crate::plan::{AxisTaps, Plan, Resampling};

/// `pixels`, as they were drawn for `plan`, in the size of its picture.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn to_size(pixels: Pixels, plan: &Plan, work: &Work) -> Result<Pixels, Cancelled> {
    let drawn = [plan.view.width, plan.view.height];
    let resampling = Resampling::new(drawn, plan.size);
    let count = plan.size[0] as usize * plan.size[1] as usize;
    match pixels {
        Pixels::Rgba8 { pixels, opaque } => {
            let frame = linear(&pixels, drawn, opaque, work, |[r, g, b, a]| {
                let [r, g, b] = [r, g, b].map(|code| SRGB_DECODE[usize::from(code)]);
                [r, g, b, f32::from(a) / 255.0]
            })?;
            let frame = resample(&frame, plan.size, &resampling, work)?;
            let mut pixels = vec![[0; 4]; count];
            output::encode_frame(&frame, &[], &mut pixels, work)?;
            Ok(Pixels::Rgba8 { pixels, opaque })
        }
        Pixels::Rgba32F { pixels, opaque } => {
            let frame = linear(&pixels, drawn, opaque, work, |pixel| pixel)?;
            let frame = resample(&frame, plan.size, &resampling, work)?;
            let mut pixels = vec![[0.0; 4]; count];
            output::write_radiance_frame(&frame, &mut pixels, work)?;
            Ok(Pixels::Rgba32F { pixels, opaque })
        }
        values @ Pixels::Gray16(_) => Ok(values),
    }
}

/// Pixels as planes of linear light, premultiplied with alpha. `decode` gives them straight.
fn linear<P: Copy + Sync>(
    pixels: &[P],
    size: [u32; 2],
    opaque: bool,
    work: &Work,
    decode: impl Fn(P) -> [f32; 4] + Sync,
) -> Result<LinearFrame, Cancelled> {
    let mut frame = LinearFrame::new(size, !opaque, 0);
    let width = frame.width;
    write_rows(&mut frame.planes, work, |y, rows| {
        for (x, &pixel) in pixels[y * width..][..width].iter().enumerate() {
            let [r, g, b, alpha] = decode(pixel);
            let premultiplied = [r * alpha, g * alpha, b * alpha, alpha];
            rows.iter_mut().zip(premultiplied).for_each(|(row, value)| row[x] = value);
        }
    })?;
    Ok(frame)
}

/// Columns first, then rows.
fn resample(
    drawn: &LinearFrame,
    size: [u32; 2],
    resampling: &Resampling,
    work: &Work,
) -> Result<LinearFrame, Cancelled> {
    let transparent = drawn.planes.len() > 3;
    let rows = u32::try_from(drawn.height).expect("invariant: a picture has at most 2¹⁴ rows");
    let mut narrowed = LinearFrame::new([size[0], rows], transparent, 0);
    write_rows(&mut narrowed.planes, work, |y, rows| {
        for (row, plane) in rows.iter_mut().zip(&drawn.planes) {
            let from = plane.row(y);
            row.iter_mut().zip(&resampling.columns).for_each(|(value, taps)| *value = along(from, taps));
        }
    })?;
    let mut frame = LinearFrame::new(size, transparent, 0);
    write_rows(&mut frame.planes, work, |y, rows| {
        for (row, plane) in rows.iter_mut().zip(&narrowed.planes) {
            across(plane, &resampling.rows[y], row);
        }
    })?;
    Ok(frame)
}

fn along(from: &[f32], taps: &AxisTaps) -> f32 {
    from[taps.range()].iter().zip(&taps.weights).fold(0.0, |sum, (value, weight)| sum + value * weight)
}

fn across(from: &Plane, taps: &AxisTaps, row: &mut [f32]) {
    row.fill(0.0);
    for (y, weight) in taps.range().zip(&taps.weights) {
        row.iter_mut().zip(from.row(y)).for_each(|(sum, value)| *sum += value * weight);
    }
}
