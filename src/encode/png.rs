//! PNG.

use super::rgb;
use crate::math::colour::srgb_from_linear;
use crate::pipeline::{Frame, Pixels};
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};
use std::borrow::Cow;

/// Encodes a frame: RGB where it is opaque, RGBA where it is not, 16-bit grey for values. Linear colour
/// is clamped to 0–1 and sRGB-encoded.
///
/// The bytes depend on the pixels alone: no clock, no machine.
#[must_use]
pub fn png(frame: &Frame) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = encoder(frame, &mut bytes);
    let write = || -> Result<(), EncodingError> {
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&samples(&frame.pixels))?;
        writer.finish()
    };
    write().expect("writing a picture of at least one pixel to memory succeeds");
    bytes
}

/// An encoder for pictures like `frame`.
pub(super) fn encoder<'a>(frame: &Frame, bytes: &'a mut Vec<u8>) -> Encoder<'static, &'a mut Vec<u8>> {
    let (color, depth) = match frame.pixels {
        Pixels::Rgba8 { opaque: true, .. } | Pixels::Rgba32F { opaque: true, .. } => {
            (ColorType::Rgb, BitDepth::Eight)
        }
        Pixels::Rgba8 { .. } | Pixels::Rgba32F { .. } => (ColorType::Rgba, BitDepth::Eight),
        Pixels::Gray16(_) => (ColorType::Grayscale, BitDepth::Sixteen),
    };
    let mut encoder = Encoder::new(bytes, frame.width, frame.height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    if color != ColorType::Grayscale {
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    }
    encoder
}

/// The samples of `pixels` as PNG has them: 16 bits with the high byte first.
pub(super) fn samples(pixels: &Pixels) -> Cow<'_, [u8]> {
    match pixels {
        Pixels::Rgba8 { pixels, opaque: true } => rgb(pixels).into(),
        Pixels::Rgba8 { pixels, opaque: false } => pixels.as_flattened().into(),
        Pixels::Rgba32F { pixels, opaque } => {
            let channels = if *opaque { 3 } else { 4 };
            pixels.iter().flat_map(|&p| codes(p).into_iter().take(channels)).collect()
        }
        Pixels::Gray16(values) => values.iter().flat_map(|value| value.to_be_bytes()).collect(),
    }
}

/// sRGB codes of a linear colour, and its alpha's.
fn codes([r, g, b, alpha]: [f32; 4]) -> [u8; 4] {
    let color = [r, g, b].map(|linear| code(srgb_from_linear(f64::from(linear).clamp(0.0, 1.0))));
    [color[0], color[1], color[2], code(f64::from(alpha))]
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float-to-integer cast saturates"
)]
fn code(value: f64) -> u8 {
    (255.0 * value + 0.5).floor() as u8
}
