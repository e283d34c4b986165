//! PNG.

use crate::pipeline::{Frame, Pixels};
use png::{BitDepth, ColorType, Compression, Encoder};

/// Encodes a frame: RGB where it is opaque, RGBA where it is not, 16-bit grey for values.
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
