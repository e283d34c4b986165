use super::*;
use crate::math::simd::Level;
use crate::pipeline::{Order, Pixels, Stats, Timings};
use std::sync::atomic::AtomicBool;

fn encode(frame: &Frame, quality: u8, threads: usize) -> Vec<u8> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    jpeg(frame, quality, &work).unwrap()
}

/// Waves of colour, with noise in one corner.
fn frame(width: u32, height: u32) -> Frame {
    let mut noise = 1u32;
    let pixels = (0..width * height).map(|i| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y) = (i % width, i / width);
        let wave = |n: u32| u8::try_from((n % 510).abs_diff(255)).expect("a code");
        let [rough, ..] = if x < 4 && y < 4 { noise.to_be_bytes() } else { [0; 4] };
        [wave(x * 3) ^ rough >> 3, wave(y * 2 + x), wave(x + y), 255]
    });
    let pixels = Pixels::Rgba8 { pixels: pixels.collect(), opaque: true };
    Frame { width, height, pixels, stats: Stats::default(), timings: Timings::default(), depth_range: None }
}

fn decoded(bytes: &[u8]) -> image::RgbImage {
    let format = image::ImageFormat::Jpeg;
    image::load_from_memory_with_format(bytes, format).expect("a JPEG").into_rgb8()
}

/// 20·log10(255 / RMSE) over all channels.
fn psnr_db(frame: &Frame, decoded: &image::RgbImage) -> f64 {
    let pixels = colors(frame).0.iter().zip(decoded.pixels());
    let squares: f64 = pixels
        .flat_map(|(a, b)| [0, 1, 2].map(|c| f64::from(a[c]) - f64::from(b.0[c])))
        .map(|difference| difference * difference)
        .sum();
    let mean = squares / (3.0 * f64::from(frame.width) * f64::from(frame.height));
    10.0 * (255.0 * 255.0 / mean).log10()
}

#[test]
fn strips_join_to_the_picture() {
    // Around the sizes of blocks and strips, and more strips than there are restart markers.
    for (width, height) in [(1, 1), (15, 17), (33, 63), (16, 64), (40, 65), (200, 129), (24, 64 * 11 + 3)] {
        let frame = frame(width, height);
        for (quality, least_db) in [(80, 32.0), (90, 35.0), (95, 38.0)] {
            let decoded = decoded(&encode(&frame, quality, 2));
            assert_eq!(decoded.dimensions(), (width, height));
            let psnr = psnr_db(&frame, &decoded);
            assert!(psnr > least_db, "{width} × {height} at quality {quality}: {psnr} dB");
        }
    }
}

#[test]
fn a_comment_is_a_segment_and_nothing_else() {
    let frame = frame(40, 30);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    let mut commented = jpeg_with_comment(&frame, 80, "frame=7", &work).unwrap();
    // Behind the start of the image and the JFIF segment, which must come first.
    assert_eq!(commented.drain(20..31).collect::<Vec<_>>(), b"\xFF\xFE\0\x09frame=7");
    assert_eq!(commented, jpeg(&frame, 80, &work).unwrap());
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let frame = frame(100, 200);
    let expected = encode(&frame, 80, 1);
    assert!([2, 3, 7].into_iter().all(|threads| encode(&frame, 80, threads) == expected));
}

#[test]
fn less_quality_is_a_smaller_file() {
    let frame = frame(128, 128);
    let sizes = [5, 20, 50, 80, 90, 100].map(|quality| encode(&frame, quality, 1).len());
    assert!(sizes.is_sorted(), "{sizes:?}");
    assert!(sizes[1] * 2 < sizes[4], "{sizes:?}");
}

#[test]
fn the_largest_contrasts_stay_within_what_can_be_coded() {
    // Black and white pixel by pixel, in blocks and in stripes: coefficients at their limits, each step 1.
    for pattern in [|x: u32, y: u32| x ^ y, |x, y| (x / 8) ^ (y / 8), |x, _| x, |_, y| y] {
        let pixels = (0..64 * 64).map(|i| [if pattern(i % 64, i / 64) & 1 == 0 { 0 } else { 255 }; 4]);
        let pixels = pixels.map(|[r, g, b, _]| [r, g, b, 255]).collect();
        let frame = Frame { pixels: Pixels::Rgba8 { pixels, opaque: true }, ..frame(64, 64) };
        let psnr = psnr_db(&frame, &decoded(&encode(&frame, 100, 1)));
        assert!(psnr > 45.0, "{psnr} dB");
    }
}
