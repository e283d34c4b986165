//! WebP, lossless.

use super::{colors, rgb};
use crate::pipeline::Frame;
use image::ExtendedColorType;
use image::codecs::webp::WebPEncoder;

/// Encodes a frame of colours: RGB where it is opaque, RGBA with straight alpha where it is not. Every
/// pixel comes back as it was.
///
/// # Panics
/// For a picture of values.
#[must_use]
pub fn webp(frame: &Frame) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encode = |samples: &[u8], kind| {
        WebPEncoder::new_lossless(&mut bytes).encode(samples, frame.width, frame.height, kind)
    };
    let result = match colors(frame) {
        (pixels, true) => encode(&rgb(pixels), ExtendedColorType::Rgb8),
        (pixels, false) => encode(pixels.as_flattened(), ExtendedColorType::Rgba8),
    };
    result.expect("WebP takes up to 16384 pixels a side, as many as a picture has");
    bytes
}
