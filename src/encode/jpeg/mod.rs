//! JPEG (ITU-T T.81), in strips that any thread encodes.
//!
//! An encoder of our own: those at hand either build with C, or round differently from one instruction
//! set to the next, and a picture's bytes must not tell the machine. A restart marker lets the coding
//! begin anew in the middle of a scan (E.1.4), so strips of [`STRIP_ROWS`] rows are transformed and coded
//! by themselves and then lie one behind the other.

mod bits;
mod headers;
mod huffman;
mod tables;
mod transform;

use super::{colors, over_white::over_white};
use crate::pipeline::{Cancelled, Frame, Pixels, Work};
use headers::{END_OF_IMAGE, headers, restart};
use huffman::Coder;
use std::borrow::Cow;
use tables::Quantization;

/// Rows of a strip: whole blocks of 8 or 16, and few enough that a small picture keeps several threads
/// busy.
const STRIP_ROWS: usize = 64;

/// From this quality on, colour is as sharp as brightness; below, a chroma sample covers 2 × 2 pixels.
const FULL_CHROMA_QUALITY: u8 = 90;

/// How many pixels a sample of chroma covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Chroma {
    /// 4:4:4, one pixel.
    Full,
    /// 4:2:0, 2 × 2 pixels.
    Quarter,
}

impl Chroma {
    /// Pixels along a side of a minimum coded unit: the blocks that share one of chroma.
    fn unit(self) -> usize {
        match self {
            Self::Full => 8,
            Self::Quarter => 16,
        }
    }
}

/// Encodes a frame of colours at a `quality` of 1–100, or one of 16-bit values as greys; what is transparent is
/// laid over white, in linear light.
///
/// # Errors
/// [`Cancelled`].
///
/// # Panics
/// For other pixels.
pub fn jpeg(frame: &Frame, quality: u8, work: &Work) -> Result<Vec<u8>, Cancelled> {
    jpeg_with_comment(frame, quality, "", work)
}

/// The same with a comment in it, unless that is empty: a line of at most 1000 bytes.
///
/// # Errors
/// As [`jpeg`].
///
/// # Panics
/// As [`jpeg`], and for a comment that is too long.
pub fn jpeg_with_comment(
    frame: &Frame,
    quality: u8,
    comment: &str,
    work: &Work,
) -> Result<Vec<u8>, Cancelled> {
    let greys;
    let (pixels, opaque) = match &frame.pixels {
        Pixels::Gray16(values) => {
            greys = grey(values);
            (greys.as_slice(), true)
        }
        _ => colors(frame),
    };
    let width = frame.width as usize;
    let chroma = if quality < FULL_CHROMA_QUALITY { Chroma::Quarter } else { Chroma::Full };
    let quantization = Quantization::of_quality(quality);
    let strips = work.map(
        pixels.chunks(STRIP_ROWS * width).collect(),
        || (),
        |(), strip: &[[u8; 4]]| {
            let visible = if opaque { Cow::Borrowed(strip) } else { over_white(work.level, strip).into() };
            let blocks = transform::blocks(work.level, &visible, width, chroma, &quantization);
            Coder::new().code(&blocks, chroma)
        },
    )?;

    let units = width.div_ceil(chroma.unit()) * (STRIP_ROWS / chroma.unit());
    let mut bytes = headers([frame.width, frame.height], comment, chroma, &quantization, units);
    for (at, strip) in strips.iter().enumerate() {
        if at > 0 {
            bytes.extend(restart(at - 1));
        }
        bytes.extend(strip);
    }
    bytes.extend(END_OF_IMAGE);
    Ok(bytes)
}

/// Values as the nearest of 256 greys.
fn grey(values: &[u16]) -> Vec<[u8; 4]> {
    let code = |value: u16| {
        let [.., code] = ((u32::from(value) + 128) / 257).to_be_bytes();
        [code, code, code, 255]
    };
    values.iter().map(|&value| code(value)).collect()
}

#[cfg(test)]
mod tests;
