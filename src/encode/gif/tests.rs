use super::*;
use crate::math::simd::Level;
use crate::pipeline::{Order, Pixels};
use std::sync::atomic::AtomicBool;

fn encode(frames: &[Frame], threads: usize) -> Vec<u8> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let work = Work { pool: &pool, cancel: &AtomicBool::new(false), level: Level::new(), order: Order::Rows };
    gif(frames, 7, &work).unwrap()
}

/// At most 256 pixels a side.
fn frame(width: u32, height: u32, pixel: impl Fn(u8, u8) -> [u8; 4]) -> Frame {
    let at = |n: u32| u8::try_from(n).expect("a small picture");
    let pixels: Vec<[u8; 4]> = (0..width * height).map(|i| pixel(at(i % width), at(i / width))).collect();
    let opaque = pixels.iter().all(|pixel| pixel[3] == 255);
    Frame {
        width,
        height,
        pixels: Pixels::Rgba8 { pixels, opaque },
        stats: crate::pipeline::Stats::default(),
        timings: crate::pipeline::Timings::default(),
        depth_range: None,
    }
}

/// Every picture as a player shows it, RGBA.
fn shown(bytes: &[u8]) -> Vec<Vec<[u8; 4]>> {
    use image::AnimationDecoder;
    let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(bytes)).expect("a GIF");
    let frames = decoder.into_frames().collect_frames().expect("whole frames");
    frames.into_iter().map(|frame| frame.into_buffer().pixels().map(|pixel| pixel.0).collect()).collect()
}

fn pixels(frame: &Frame) -> Vec<[u8; 4]> {
    colors(frame).0.to_vec()
}

/// A square of `color` that moves along a gradient of few colours.
fn moving(at: u8, color: [u8; 4]) -> Frame {
    frame(
        40,
        30,
        |x, y| {
            if (at..at + 5).contains(&x) && (7..13).contains(&y) { color } else { [y, 3, 9, 255] }
        },
    )
}

#[test]
fn few_colours_come_back_exactly_and_loop_for_ever() {
    let red = [255, 0, 0, 255];
    let frames = [moving(3, red), moving(4, red), moving(4, red), moving(30, red)];
    let bytes = encode(&frames, 2);
    assert_eq!(shown(&bytes), frames.iter().map(pixels).collect::<Vec<_>>());

    let decoder = ::gif::Decoder::new(bytes.as_slice()).expect("a GIF");
    assert_eq!(decoder.repeat(), Repeat::Infinite);
}

#[test]
fn a_frame_holds_what_changes_alone() {
    let red = [255, 0, 0, 255];
    let bytes = encode(&[moving(3, red), moving(4, red), moving(4, red)], 1);
    let mut decoder = ::gif::Decoder::new(bytes.as_slice()).expect("a GIF");
    let mut sizes = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        assert_eq!(frame.delay, 7);
        sizes.push((frame.left, frame.top, frame.width, frame.height));
    }
    assert_eq!(sizes, [(0, 0, 40, 30), (3, 7, 6, 6), (0, 0, 1, 1)]);
}

#[test]
fn what_is_half_transparent_is_there_or_not() {
    let of_alpha = |alpha| frame(4, 1, |x, _| [x, 0, 0, if x == 2 { alpha } else { 0 }]);
    let shown = shown(&encode(&[of_alpha(128), of_alpha(127), of_alpha(255)], 1));
    assert_eq!(
        shown.iter().map(|frame| frame[2]).collect::<Vec<_>>(),
        [[2, 0, 0, 255], [0; 4], [2, 0, 0, 255]]
    );
    assert!(shown.iter().all(|frame| frame[0][3] == 0));
}

#[test]
fn many_colours_are_met_on_the_average() {
    let gradient = frame(256, 64, |x, y| [x, y * 4, 128, 255]);
    let shown = &shown(&encode(std::slice::from_ref(&gradient), 2))[0];
    // Means over 16 × 16 pixels: what the eye makes of the pattern.
    for (bx, by) in (0..16).flat_map(|bx| (0..4).map(move |by| (bx, by))) {
        let mean = |pixels: &[[u8; 4]], c: usize| -> f64 {
            let block = (0..256).map(|i| (by * 16 + i / 16) * 256 + bx * 16 + i % 16);
            block.map(|at| f64::from(pixels[at][c])).sum::<f64>() / 256.0
        };
        for c in 0..3 {
            let (from, to) = (mean(&pixels(&gradient), c), mean(shown, c));
            assert!((from - to).abs() < 6.0, "block {bx}, {by}, channel {c}: {from} → {to}");
        }
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let frames: Vec<Frame> = (0..5).map(|i| frame(64, 48, |x, y| [x * 4, y * 5, i * 40, 255])).collect();
    let one = encode(&frames, 1);
    assert!([2, 3, 7].into_iter().all(|threads| encode(&frames, threads) == one));
}
