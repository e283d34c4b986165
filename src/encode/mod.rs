//! Encode: finished pixels to files.
//!
//! In: a [`crate::pipeline::Frame`], or several. Out: the bytes of a file. They depend on the pixels
//! alone: no clock, no machine, and where strips or frames are encoded side by side, their heights are
//! constant.

mod apng;
mod exr;
mod format;
mod frame_json;
mod gif;
mod hdr;
mod jpeg;
pub(crate) mod over_white;
mod png;
mod webp;
mod zip;

pub use apng::apng;
pub use exr::exr;
pub use format::{Animation, Format, Unfit};
pub use frame_json::frame_json;
pub use gif::gif;
pub use hdr::hdr;
pub use jpeg::{jpeg, jpeg_with_comment};
pub use png::png;
pub use webp::webp;
pub use zip::Zip;

use crate::pipeline::{Cancelled, Frame, Pixels, Work};

/// Encodes one picture, whose pixels must be of the kind that [`Format::drawn_as`] has asked for.
///
/// # Errors
/// [`Cancelled`].
pub fn still(frame: &Frame, format: Format, work: &Work) -> Result<Vec<u8>, Cancelled> {
    match format {
        Format::Png => Ok(png(frame)),
        Format::Jpeg { quality } => jpeg(frame, quality, work),
        Format::Webp => Ok(webp(frame)),
        Format::Exr => exr(frame, work),
        Format::Hdr => Ok(hdr(frame)),
    }
}

/// Colours of 8 bits, and whether every alpha is 255.
///
/// # Panics
/// For other pixels.
fn colors(frame: &Frame) -> (&[[u8; 4]], bool) {
    match &frame.pixels {
        Pixels::Rgba8 { pixels, opaque } => (pixels, *opaque),
        _ => panic!("{ASKED_FOR}"),
    }
}

/// Linear colours with straight alpha, and whether every alpha is 1.
///
/// # Panics
/// For other pixels.
fn radiance(frame: &Frame) -> (&[[f32; 4]], bool) {
    match &frame.pixels {
        Pixels::Rgba32F { pixels, opaque } => (pixels, *opaque),
        _ => panic!("{ASKED_FOR}"),
    }
}

/// Why no other pixels come to an encoder.
const ASKED_FOR: &str = "a frame is drawn as its format asks for: see `Format::drawn_as`";

/// A pixel's light: its colour times its alpha.
fn light([r, g, b, alpha]: [f32; 4]) -> [f32; 4] {
    [r * alpha, g * alpha, b * alpha, alpha]
}

/// Red, green, blue of every pixel.
fn rgb(pixels: &[[u8; 4]]) -> Vec<u8> {
    pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect()
}

#[cfg(test)]
fn float_frame(width: u32, pixels: &[[f32; 4]], opaque: bool) -> Frame {
    Frame {
        width,
        height: u32::try_from(pixels.len()).unwrap() / width,
        pixels: Pixels::Rgba32F { pixels: pixels.to_vec(), opaque },
        stats: crate::pipeline::Stats::default(),
        timings: crate::pipeline::Timings::default(),
        depth_range: None,
    }
}
