//! Radiance HDR: a shared exponent for red, green and blue.
//!
//! Source: G. Ward, "Real Pixels", Graphics Gems II, 1991; the file format of the Radiance reference
//! manual ("new" run-length encoding).

use super::{light, radiance};
use crate::pipeline::Frame;

/// Sides that run-length encoded rows may have.
const ENCODED_WIDTHS: std::ops::Range<usize> = 8..32768;

/// Encodes a frame of linear colour. Alpha has no place in it: what is transparent is over black, the
/// light that arrives.
///
/// Each channel is off by at most 1/256 of the pixel's greatest.
///
/// # Panics
/// For other pixels.
#[must_use]
pub fn hdr(frame: &Frame) -> Vec<u8> {
    let (width, height) = (frame.width, frame.height);
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for row in radiance(frame).0.chunks(width as usize) {
        let row: Vec<[u8; 4]> = row.iter().map(|&pixel| rgbe(light(pixel))).collect();
        if ENCODED_WIDTHS.contains(&row.len()) {
            encode_row(&row, &mut bytes);
        } else {
            bytes.extend(row.as_flattened());
        }
    }
    bytes
}

/// Mantissas and exponent: a channel is `m · 2^(e − 136)`. What is negative or below 2⁻¹²⁶ is black, what
/// is beyond 2¹²⁷ counts as that.
fn rgbe([r, g, b, _]: [f32; 4]) -> [u8; 4] {
    let color = [r, g, b];
    let greatest = color.into_iter().fold(0.0f32, |a, b| if b > a { b } else { a });
    if greatest < f32::MIN_POSITIVE {
        return [0; 4];
    }
    // 2^(exponent − 1) ≤ greatest < 2^exponent, by the bits of a normal number.
    let exponent = (greatest.to_bits() >> 23).cast_signed() - 126;
    // Rounding may carry the greatest channel to 256.
    let exponent = if mantissa(greatest, exponent) > 255.0 { exponent + 1 } else { exponent };
    let exponent = exponent.min(127);
    let [r, g, b] = color.map(|channel| byte(mantissa(channel, exponent)));
    [r, g, b, u8::try_from(exponent + 128).expect("an exponent in −125..=127")]
}

/// `channel · 2^(8 − exponent)`, rounded; 0 for what is negative.
fn mantissa(channel: f32, exponent: i32) -> f64 {
    // A power of two, so that the product is exact.
    let scale = f64::from_bits(u64::from((1023 + 8 - exponent).cast_unsigned()) << 52);
    let scaled = (f64::from(channel) * scale + 0.5).floor();
    if scaled > 0.0 { scaled } else { 0.0 }
}

/// A mantissa as a byte; what is beyond saturates.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast from f64 saturates")]
fn byte(mantissa: f64) -> u8 {
    mantissa as u8
}

/// A row, channel by channel: runs of 4 and more as their length + 128 and their value, what is between
/// them as its length and itself.
fn encode_row(row: &[[u8; 4]], bytes: &mut Vec<u8>) {
    let [high, low] = u16::try_from(row.len()).expect("encoded rows are short").to_be_bytes();
    bytes.extend([2, 2, high, low]);
    for channel in 0..4 {
        let values: Vec<u8> = row.iter().map(|pixel| pixel[channel]).collect();
        encode_channel(&values, bytes);
    }
}

fn encode_channel(mut values: &[u8], bytes: &mut Vec<u8>) {
    while !values.is_empty() {
        let literal = values.windows(4).take(128).position(|four| four.iter().all(|v| *v == four[0]));
        let literal = literal.unwrap_or(values.len().min(128));
        if literal > 0 {
            bytes.push(u8::try_from(literal).expect("at most 128"));
            bytes.extend(&values[..literal]);
            values = &values[literal..];
            continue;
        }
        let run = values.iter().take(127).take_while(|value| **value == values[0]).count();
        bytes.extend([128 + u8::try_from(run).expect("at most 127"), values[0]]);
        values = &values[run..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::float_frame;
    use image::ImageDecoder;
    use image::codecs::hdr::HdrDecoder;
    use proptest::prelude::*;
    use std::io::Cursor;

    /// As another program reads it.
    fn decoded(bytes: &[u8]) -> Vec<[f32; 3]> {
        let decoder = HdrDecoder::new(Cursor::new(bytes)).expect("an HDR picture");
        let mut samples = vec![0; usize::try_from(decoder.total_bytes()).expect("small")];
        decoder.read_image(&mut samples).expect("whole rows");
        let floats = samples.chunks(4).map(|four| f32::from_ne_bytes([four[0], four[1], four[2], four[3]]));
        floats.collect::<Vec<_>>().chunks(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect()
    }

    fn check(width: u32, pixels: &[[f32; 4]]) {
        for (from, to) in pixels.iter().zip(decoded(&hdr(&float_frame(width, pixels, true)))) {
            let greatest = from[..3].iter().fold(0.0f32, |a, b| a.max(*b));
            for c in 0..3 {
                let (from, to) = (from[c].max(0.0), to[c]);
                assert!((from - to).abs() <= greatest / 256.0 + 1.2e-38, "{from} → {to} beside {greatest}");
            }
        }
    }

    #[test]
    fn extremes_survive() {
        for value in [0.0, -1.0, 1e-45, 1e-38, 1.3e-38, 0.5, 1.0, 255.9, 65504.0, 0.999_999_9, 1.997, 1e38] {
            check(1, &[[value, value * 0.3, 1e-3, 1.0]]);
        }
        assert_eq!(rgbe([f32::INFINITY, 0.0, 0.0, 1.0]), [255, 0, 0, 255]);
        assert_eq!(rgbe([f32::NAN, 0.5, 0.0, 1.0]), [0, 128, 0, 128]);
    }

    proptest! {
        #[test]
        fn every_row_comes_back_within_the_precision_of_the_format(
            width in prop::sample::select(vec![1u32, 7, 8, 9, 127, 128, 129, 300]),
            runs in prop::collection::vec((1usize..200, 0.0f32..4.0, 0.0f32..300.0), 1..20),
        ) {
            let values = runs.iter().flat_map(|&(length, a, b)| std::iter::repeat_n([a, b, a * b, 1.0], length));
            let pixels: Vec<[f32; 4]> = values.cycle().take(2 * width as usize).collect();
            check(width, &pixels);
        }
    }
}
