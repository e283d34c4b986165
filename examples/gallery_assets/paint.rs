//! Images as functions of (u, v), v up: colours painted, heights turned into normal maps.

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ExtendedColorType, GrayImage, RgbImage, RgbaImage};
use rasterd::scene::demo::noise::mix;
use rayon::prelude::*;

/// An sRGB-encoded colour, 0–255.
pub type Color = [f64; 3];

/// What takes every byte and is given the right number of them.
const IN_MEMORY: &str = "invariant: a vector takes all that is written, and the size is right";

/// `a` at `t` = 0, `b` at 1.
pub fn blend(a: Color, b: Color, t: f64) -> Color {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)]
}

/// A lighter or darker shade.
pub fn shade(color: Color, factor: f64) -> Color {
    color.map(|channel| channel * factor)
}

/// Row by row from the top, the mean of 2 × 2 points of each texel; `N` channels of 0–255.
fn texels<const N: usize>(size: [u32; 2], at: impl Fn(f64, f64) -> [f64; N] + Sync) -> Vec<u8> {
    let [width, height] = size;
    let point = |i: u32, side: f64, count: u32| (f64::from(i) + 0.5 + side) / f64::from(count);
    let texel = |x: u32, row: u32| {
        let y = height - 1 - row;
        let corners = [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)];
        let four = corners.map(|(dx, dy)| at(point(x, dx, width), point(y, dy, height)));
        std::array::from_fn::<u8, N, _>(|i| byte(four.iter().map(|color| color[i]).sum::<f64>() / 4.0))
    };
    (0..height).into_par_iter().flat_map_iter(|row| (0..width).flat_map(move |x| texel(x, row))).collect()
}

fn byte(channel: f64) -> u8 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped to 0–255")]
    let byte = (channel.clamp(0.0, 255.0) + 0.5) as u8;
    byte
}

/// A JPEG file of colours.
pub fn jpeg(size: [u32; 2], quality: u8, at: impl Fn(f64, f64) -> Color + Sync) -> Vec<u8> {
    let image = RgbImage::from_raw(size[0], size[1], texels(size, at)).expect(IN_MEMORY);
    encode_jpeg(&image.into(), quality)
}

/// A JPEG file of grey values, 0–1.
pub fn grey_jpeg(size: [u32; 2], quality: u8, at: impl Fn(f64, f64) -> f64 + Sync) -> Vec<u8> {
    let image =
        GrayImage::from_raw(size[0], size[1], texels(size, |u, v| [255.0 * at(u, v)])).expect(IN_MEMORY);
    encode_jpeg(&image.into(), quality)
}

fn encode_jpeg(image: &DynamicImage, quality: u8) -> Vec<u8> {
    let mut file = Vec::new();
    image.write_with_encoder(JpegEncoder::new_with_quality(&mut file, quality)).expect(IN_MEMORY);
    file
}

/// A PNG file of colours with straight alpha, 0–1.
pub fn cutout(size: [u32; 2], at: impl Fn(f64, f64) -> (Color, f64) + Sync) -> Vec<u8> {
    let rgba = texels(size, |u, v| {
        let ([r, g, b], alpha) = at(u, v);
        [r, g, b, 255.0 * alpha]
    });
    let image = RgbaImage::from_raw(size[0], size[1], rgba).expect(IN_MEMORY);
    let mut file = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new_with_quality(
        &mut file,
        image::codecs::png::CompressionType::Best,
        image::codecs::png::FilterType::Adaptive,
    );
    let [width, height] = size;
    image::ImageEncoder::write_image(encoder, &image, width, height, ExtendedColorType::Rgba8)
        .expect(IN_MEMORY);
    file
}

/// A normal map (OpenGL: red along +u, green along +v) as a JPEG file.
///
/// `slope` is how far the height rises per unit of length along u and along v.
pub fn normal_map(size: [u32; 2], quality: u8, slope: impl Fn(f64, f64) -> [f64; 2] + Sync) -> Vec<u8> {
    jpeg(size, quality, |u, v| {
        let [du, dv] = slope(u, v);
        let length = (du * du + dv * dv + 1.0).sqrt();
        [-du, -dv, 1.0].map(|n| 128.0 + 127.0 * n / length)
    })
}
