//! PNG.

use crate::math::colour::srgb_from_linear;
use crate::pipeline::{Frame, Pixels};
use png::{BitDepth, ColorType, Compression, Encoder};

/// Encodes a frame: RGB where it is opaque, RGBA where it is not, 16-bit grey for values. Linear colour
/// is clamped to 0–1 and sRGB-encoded.
///
/// The bytes depend on the pixels alone: no clock, no machine.
#[must_use]
pub fn png(frame: &Frame) -> Vec<u8> {
    let (color, depth, data) = match &frame.pixels {
        Pixels::Rgba8 { pixels, opaque: true } => {
            (ColorType::Rgb, BitDepth::Eight, pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect())
        }
        Pixels::Rgba8 { pixels, opaque: false } => {
            (ColorType::Rgba, BitDepth::Eight, pixels.as_flattened().to_vec())
        }
        Pixels::Rgba32F { pixels, opaque } => {
            let (color, channels) = if *opaque { (ColorType::Rgb, 3) } else { (ColorType::Rgba, 4) };
            let codes = pixels.iter().flat_map(|&p| codes(p).into_iter().take(channels));
            (color, BitDepth::Eight, codes.collect())
        }
        Pixels::Gray16(pixels) => (
            ColorType::Grayscale,
            BitDepth::Sixteen,
            pixels.iter().flat_map(|p| p.to_be_bytes()).collect::<Vec<u8>>(),
        ),
    };
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, frame.width, frame.height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    if color != ColorType::Grayscale {
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    }
    let write = |encoder: Encoder<&mut Vec<u8>>| -> Result<(), png::EncodingError> {
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&data)?;
        writer.finish()
    };
    write(encoder).expect("writing a picture of at least one pixel to memory succeeds");
    bytes
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
