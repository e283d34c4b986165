//! OpenEXR: 32-bit float, lossless.
//!
//! A single-part file of scan lines with ZIP compression, which every reader takes. Blocks of 16 lines
//! are compressed by themselves, on all threads. Source: "OpenEXR File Layout", openexr.com.

use super::{light, radiance};
use crate::pipeline::{Cancelled, Frame, Work};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// Lines of a block of ZIP compression.
const BLOCK_LINES: usize = 16;

/// The number of ZIP compression, and the name of its attribute's value.
const ZIP_COMPRESSION: u8 = 3;

/// zlib's effort: at 9 a picture of a teapot is 4 % smaller and takes 2.7 times as long.
const EFFORT: u32 = 2;

/// Encodes a frame of linear colour: RGB where it is opaque, else RGBA with the colours multiplied by
/// alpha, as OpenEXR has them.
///
/// # Errors
/// [`Cancelled`].
///
/// # Panics
/// For other pixels.
pub fn exr(frame: &Frame, work: &Work) -> Result<Vec<u8>, Cancelled> {
    let (pixels, opaque) = radiance(frame);
    let (width, height) = (frame.width, frame.height);
    // Channels lie in the order of their names.
    let channels: &[(u8, usize)] = if opaque {
        &[(b'B', 2), (b'G', 1), (b'R', 0)]
    } else {
        &[(b'A', 3), (b'B', 2), (b'G', 1), (b'R', 0)]
    };
    let blocks: Vec<&[[f32; 4]]> = pixels.chunks(BLOCK_LINES * width as usize).collect();
    let blocks = work.map(
        blocks,
        || (),
        |(), block: &[[f32; 4]]| compressed(&planes(block, width as usize, channels.iter().map(|(_, c)| *c))),
    )?;

    let mut bytes = header(width, height, channels.iter().map(|(name, _)| *name));
    let mut offset = (bytes.len() + 8 * blocks.len()) as u64;
    for block in &blocks {
        bytes.extend(offset.to_le_bytes());
        offset += 8 + block.len() as u64;
    }
    for (block, line) in blocks.iter().zip((0u32..).step_by(BLOCK_LINES)) {
        let length = u32::try_from(block.len()).expect("16 lines of 16384 pixels at 16 bytes");
        bytes.extend(line.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(block);
    }
    Ok(bytes)
}

/// A block line by line, and every line channel by channel.
fn planes(
    block: &[[f32; 4]],
    width: usize,
    channels: impl ExactSizeIterator<Item = usize> + Clone,
) -> Vec<u8> {
    let mut planes = Vec::with_capacity(block.len() * channels.len() * size_of::<f32>());
    for line in block.chunks(width) {
        for channel in channels.clone() {
            line.iter().for_each(|&pixel| planes.extend(light(pixel)[channel].to_le_bytes()));
        }
    }
    planes
}

/// Magic number, version 2, and the attributes that every file has.
fn header(width: u32, height: u32, channels: impl Iterator<Item = u8>) -> Vec<u8> {
    const FLOAT: u32 = 2;
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        let length = u32::try_from(value.len()).expect("attributes are short");
        bytes.extend(length.to_le_bytes());
        bytes.extend(value);
    };
    let mut list = Vec::new();
    for name in channels {
        // Name, type, no perceptual hint, a sample for every pixel.
        list.extend([name, 0]);
        [FLOAT, 0, 1, 1].iter().for_each(|field| list.extend(field.to_le_bytes()));
    }
    list.push(0);
    let window: Vec<u8> = [0, 0, width - 1, height - 1].iter().flat_map(|side| side.to_le_bytes()).collect();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[ZIP_COMPRESSION]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]); // from the top
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    bytes.push(0);
    bytes
}

/// A block under ZIP compression, or as it is where that does not help: bytes of even places before
/// those of odd ones, each as its difference from the one before plus 128, deflated.
fn compressed(raw: &[u8]) -> Vec<u8> {
    let halves: Vec<u8> = raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2)).copied().collect();
    let mut differences = halves.clone();
    for (byte, previous) in differences.iter_mut().skip(1).zip(halves) {
        *byte = byte.wrapping_sub(previous).wrapping_add(128);
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(EFFORT));
    let deflated = encoder.write_all(&differences).and_then(|()| encoder.finish());
    let deflated = deflated.expect("memory takes every byte");
    if deflated.len() < raw.len() { deflated } else { raw.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::float_frame;
    use crate::math::simd::Level;
    use crate::pipeline::Order;
    use std::io::Cursor;
    use std::sync::atomic::AtomicBool;

    fn encode(width: u32, pixels: &[[f32; 4]], opaque: bool, threads: usize) -> Vec<u8> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let work =
            Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
        exr(&float_frame(width, pixels, opaque), &work).unwrap()
    }

    /// As another program reads it, alpha 1 where there is none.
    fn decoded(bytes: &[u8]) -> Vec<[f32; 4]> {
        use ::exr::prelude::*;
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size, _| (size.width(), vec![[0.0; 4]; size.area()]),
                |(width, pixels), at, (r, g, b, a): (f32, f32, f32, f32)| {
                    pixels[at.y() * *width + at.x()] = [r, g, b, a];
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .expect("an EXR picture");
        image.layer_data.channel_data.pixels.1
    }

    /// Smooth, sharp and random parts, with extremes.
    fn pixels(width: u32, height: u32) -> Vec<[f32; 4]> {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from_bits(0x3f80_0000 | state >> 9) - 1.0
        };
        (0..width * height)
            .map(|i| match i % 5 {
                0 => [0.0, 65504.0, 1e-38, 1.0],
                1 => [random(), random() * 100.0, 0.0, random()],
                _ => [0.25, 0.5, 0.75, 0.5],
            })
            .collect()
    }

    #[test]
    fn every_float_comes_back_exactly() {
        for (width, height) in [(1, 1), (3, 2), (40, 33), (129, 16), (7, 17)] {
            let from = pixels(width, height);
            let premultiplied: Vec<[f32; 4]> = from.iter().map(|pixel| light(*pixel)).collect();
            assert_eq!(decoded(&encode(width, &from, false, 2)), premultiplied, "{width} × {height}");
            let solid: Vec<[f32; 4]> = from.iter().map(|&[r, g, b, _]| [r, g, b, 1.0]).collect();
            assert_eq!(decoded(&encode(width, &solid, true, 2)), solid, "{width} × {height}");
        }
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_threads() {
        let from = pixels(64, 100);
        let one = encode(64, &from, false, 1);
        assert!([2, 3, 7].into_iter().all(|threads| encode(64, &from, false, threads) == one));
    }
}
