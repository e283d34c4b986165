//! Files of every format, byte by byte: the same on every machine.

use super::{assert_golden_file, root, stored};
use crate::draw::work;
use rasterd::encode;
use rasterd::math::colour::linear_from_srgb8;
use rasterd::pipeline::{Cancelled, Frame, Pixels};
use serde_json::json;

/// Three balls, differently shaded.
fn balls() -> [Frame; 3] {
    ["blinn_phong", "lambert", "normal"].map(|name| stored(&format!("shade/a_ball_in_{name}.png")))
}

/// A golden picture in linear light, four times as bright.
fn bright(name: &str) -> Frame {
    let frame = stored(name);
    let Pixels::Rgba8 { pixels, .. } = &frame.pixels else { panic!("a picture of colours") };
    let opaque = pixels.iter().all(|pixel| pixel[3] == 255);
    #[expect(clippy::cast_possible_truncation, reason = "rounded to f32")]
    let linear = |code: u8| (linear_from_srgb8(code) * 4.0) as f32;
    let pixels =
        pixels.iter().map(|&[r, g, b, a]| [linear(r), linear(g), linear(b), f32::from(a) / 255.0]).collect();
    Frame { pixels: Pixels::Rgba32F { pixels, opaque }, ..frame }
}

/// A golden picture with its alpha.
fn with_alpha(name: &str) -> Frame {
    let frame = stored(name);
    let Pixels::Rgba8 { pixels, .. } = frame.pixels else { panic!("a picture of colours") };
    Frame { pixels: Pixels::Rgba8 { pixels, opaque: false }, ..frame }
}

/// What is lost is lost in the same way everywhere.
#[test]
fn lossy_files_have_the_same_bytes_everywhere() {
    let [ball, ..] = balls();
    for quality in [30, 80, 95] {
        let jpeg = encode::jpeg(&ball, quality, &work()).expect("nobody cancels");
        assert_golden_file(&format!("encode/a_ball_at_quality_{quality}.jpg"), &jpeg);
    }
    let gif = encode::gif(&balls(), 50, &work()).expect("nobody cancels");
    assert_golden_file("encode/three_balls_share_a_palette.gif", &gif);
}

#[test]
fn lossless_files_have_the_same_bytes_everywhere() {
    let clear = "blend/a_clear_ball_on_a_transparent_background.png";
    let [ball, ..] = balls();
    assert_golden_file("encode/a_ball.webp", &encode::webp(&ball));
    assert_golden_file("encode/a_clear_ball.webp", &encode::webp(&with_alpha(clear)));
    let frames = balls().map(Ok::<Frame, Cancelled>);
    let apng = encode::apng(frames, 3, 50).expect("nobody cancels");
    assert_golden_file("encode/three_balls.apng", &apng);
}

#[test]
fn files_of_floats_have_the_same_bytes_everywhere() {
    let ball = "shade/a_ball_in_blinn_phong.png";
    assert_golden_file("encode/a_bright_ball.hdr", &encode::hdr(&bright(ball)));
    let exr = |name: &str| encode::exr(&bright(name), &work()).expect("nobody cancels");
    assert_golden_file("encode/a_bright_ball.exr", &exr(ball));
    assert_golden_file(
        "encode/a_bright_clear_ball.exr",
        &exr("blend/a_clear_ball_on_a_transparent_background.png"),
    );
}

#[test]
fn archives_have_the_same_bytes_everywhere() {
    let mut zip = encode::Zip::default();
    for name in ["blinn_phong", "normal"] {
        let file = root().join(format!("tests/golden/shade/a_ball_in_{name}.png"));
        zip.add(&format!("{name}.png"), &std::fs::read(file).expect("a golden picture"));
    }
    zip.add("frame.json", json!({ "width": 64 }).to_string().as_bytes());
    assert_golden_file("encode/two_balls_and_a_note.zip", &zip.finish());
}
