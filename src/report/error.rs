//! How far a picture is from the reference.

use super::reference::Reference;
use super::statistics::percentile;
use crate::encode::over_white::over_white;
use crate::math::colour::{BRIGHTEST, srgb_from_linear};
use crate::pipeline::Work;
use crate::scene::Scene;
use serde::Serialize;

/// Differences of two pictures in linear light, over all channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean of the magnitudes.
    pub mae: f64,
    /// The largest.
    pub max: f64,
    /// What 99 of 100 stay below.
    pub p99: f64,
}

/// The error of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureError {
    /// Before post, clamped to 0–1.
    #[serde(flatten)]
    pub clamped: Difference,
    /// Before post, as it is.
    pub unclamped: Difference,
    /// Of the finished bytes, in decibels; null where they are the same.
    pub psnr: Option<f64>,
    /// Structural similarity of their luminance: 1 is the same.
    pub ssim: f64,
    /// Mean and 95th percentile of FLIP; absent in a build without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip: Option<[f64; 2]>,
    /// Part of the pixels that differ by more than 1/255 of the display's range.
    pub over_1: f64,
    /// Part that differ by more than 8/255.
    pub over_8: f64,
    /// Where samples of a pixel see different surfaces.
    pub edges: Difference,
    /// Where a light's visibility changes.
    pub penumbrae: Difference,
    /// Where textures are seen.
    pub textured: Difference,
    /// Channels of the finished light that are no number: 0, as the pipeline replaces what is none.
    pub not_finite: usize,
    /// Channels that had to be clamped to the brightest radiance.
    pub brightest: usize,
}

/// What pictures of a scene are compared with.
pub struct Standard {
    /// Its light.
    pub reference: Reference,
    /// Its finished picture, in sRGB codes over white.
    codes: Vec<[u8; 3]>,
}

impl Standard {
    /// Takes the light of `scene` through its effects.
    #[must_use]
    pub fn new(reference: Reference, scene: &Scene) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "codes are in 0–255")]
        let code = |linear: f64| (255.0 * srgb_from_linear(linear.clamp(0.0, 1.0)) + 0.5).floor() as u8;
        let codes = reference.finished(scene).into_iter().map(|color| color.map(code)).collect();
        Self { reference, codes }
    }
}

/// What of a picture is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// Every pixel.
    All,
    /// Pixels at edges.
    Edges,
    /// Pixels at the borders of shadows.
    Penumbrae,
    /// Pixels with textures.
    Textured,
}

impl PictureError {
    /// Of a picture's `radiance` (linear, before post, straight alpha) and its finished `bytes`, both in the size
    /// of `standard`.
    #[must_use]
    pub fn of(radiance: &[[f32; 4]], bytes: &[[u8; 4]], standard: &Standard, work: &Work) -> Self {
        let Standard { reference, codes: truth } = standard;
        let clamped = errors(radiance, &reference.radiance, displayed);
        let masks = &reference.masks;
        let all = vec![true; clamped.len()];
        let part = |codes: f64| part_of(&clamped, |error| error > codes / 255.0);
        let bytes: Vec<[u8; 3]> =
            over_white(work.level, bytes).into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
        Self {
            clamped: Difference::of(&clamped, &all),
            unclamped: Difference::of(&errors(radiance, &reference.radiance, |value| value), &all),
            psnr: psnr(&bytes, truth),
            // Its sums run in the pool that it finds itself in.
            ssim: work.pool.install(|| ssim(&bytes, truth, reference.size)),
            flip: flip(&bytes, truth, reference.size),
            over_1: part(1.0),
            over_8: part(8.0),
            edges: Difference::of(&clamped, &masks.edges),
            penumbrae: Difference::of(&clamped, &masks.penumbrae),
            textured: Difference::of(&clamped, &masks.textured),
            not_finite: radiance.iter().flatten().filter(|value| !value.is_finite()).count(),
            brightest: radiance
                .iter()
                .flat_map(|pixel| &pixel[..3])
                .filter(|value| **value >= BRIGHTEST)
                .count(),
        }
    }

    /// The difference within `region`.
    #[must_use]
    pub fn within(&self, region: Region) -> &Difference {
        match region {
            Region::All => &self.clamped,
            Region::Edges => &self.edges,
            Region::Penumbrae => &self.penumbrae,
            Region::Textured => &self.textured,
        }
    }
}

impl Difference {
    /// Of the errors of those pixels that are in `mask`; 0 if there are none.
    fn of(errors: &[[f64; 3]], mask: &[bool]) -> Self {
        let within = errors.iter().zip(mask).filter(|(_, inside)| **inside);
        let values: Vec<f64> = within.flat_map(|(error, _)| error.map(f64::abs)).collect();
        if values.is_empty() {
            return Self::default();
        }
        #[expect(clippy::cast_precision_loss, reason = "channels of a picture")]
        let mean =
            |of: fn(f64) -> f64| values.iter().map(|value| of(*value)).sum::<f64>() / values.len() as f64;
        Self {
            rmse: mean(|value| value * value).sqrt(),
            mae: mean(|value| value),
            max: values.iter().fold(0.0, |most: f64, value| most.max(*value)),
            p99: percentile(&values, 0.99),
        }
    }
}

/// A pixel of straight alpha, premultiplied.
pub(super) fn premultiplied(pixel: &[f32; 4]) -> [f64; 4] {
    let [r, g, b, alpha] = pixel.map(f64::from);
    [r * alpha, g * alpha, b * alpha, alpha]
}

/// What a display can show.
fn displayed(value: f64) -> f64 {
    value.clamp(0.0, 1.0)
}

/// The difference of a picture's `radiance` (straight alpha) from `truth` (premultiplied), clamped to 0–1, over the
/// pixels of `mask`; without one, over all.
#[must_use]
pub fn difference(radiance: &[[f32; 4]], truth: &[[f64; 4]], mask: Option<&[bool]>) -> Difference {
    let errors = errors(radiance, truth, displayed);
    match mask {
        Some(mask) => Difference::of(&errors, mask),
        None => Difference::of(&errors, &vec![true; errors.len()]),
    }
}

/// Red, green and blue of each pixel, less those of the truth, as `see` sees them.
fn errors(radiance: &[[f32; 4]], truth: &[[f64; 4]], see: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
    let error = |(drawn, truth): (&[f32; 4], &[f64; 4])| {
        let drawn = premultiplied(drawn);
        [0, 1, 2].map(|c: usize| see(drawn[c]) - see(truth[c]))
    };
    radiance.iter().zip(truth).map(error).collect()
}

/// The part of the pixels with a channel that is off by as much as `is_off` says.
#[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
fn part_of(errors: &[[f64; 3]], is_off: impl Fn(f64) -> bool) -> f64 {
    let count = errors.iter().filter(|error| error.iter().any(|channel| is_off(channel.abs()))).count();
    count as f64 / errors.len() as f64
}

/// 20 log₁₀(1 / RMSE) of codes over 255; `None` for the same bytes.
#[expect(clippy::cast_precision_loss, reason = "channels of a picture")]
fn psnr(drawn: &[[u8; 3]], truth: &[[u8; 3]]) -> Option<f64> {
    let square = |(drawn, truth): (&u8, &u8)| (f64::from(drawn.abs_diff(*truth)) / 255.0).powi(2);
    let sum: f64 = drawn.as_flattened().iter().zip(truth.as_flattened()).map(square).sum();
    (sum > 0.0).then(|| -10.0 * (sum / (3 * truth.len()) as f64).log10())
}

/// Mean SSIM of the luma in windows of 8 × 8 pixels, as the crate `image-compare` has it: with variances summed over a
/// window in place of their mean, beside which its second constant (K2 = 0.03) weighs 64 times less. A little stricter
/// on flat areas than the paper's.
fn ssim(drawn: &[[u8; 3]], truth: &[[u8; 3]], [width, height]: [u32; 2]) -> f64 {
    let luma = |pixels: &[[u8; 3]]| {
        let picture = image::RgbImage::from_raw(width, height, pixels.as_flattened().to_vec());
        image::DynamicImage::ImageRgb8(picture.expect("a picture has the size of its reference")).into_luma8()
    };
    let similarity = image_compare::gray_similarity_structure(
        &image_compare::Algorithm::MSSIMSimple,
        &luma(drawn),
        &luma(truth),
    );
    similarity.expect("both pictures have the same size").score
}

/// Mean and 95th percentile, at 67 pixels a degree.
#[cfg(feature = "flip")]
fn flip(drawn: &[[u8; 3]], truth: &[[u8; 3]], [width, height]: [u32; 2]) -> Option<[f64; 2]> {
    let picture =
        |pixels: &[[u8; 3]]| nv_flip::FlipImageRgb8::with_data(width, height, pixels.as_flattened());
    let map = nv_flip::flip(picture(truth), picture(drawn), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    let mut pool = nv_flip::FlipPool::from_image(&map);
    Some([f64::from(pool.mean()), f64::from(pool.get_percentile(0.95, false))])
}

/// This build is without it.
#[cfg(not(feature = "flip"))]
fn flip(_: &[[u8; 3]], _: &[[u8; 3]], _: [u32; 2]) -> Option<[f64; 2]> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::reference::Masks;
    use crate::report::selftest::instruments::draw;
    use serde_json::json;

    fn standard(value: f64) -> Standard {
        let count = 16 * 16;
        let reference = Reference {
            size: [16, 16],
            radiance: vec![[value, value, value, 1.0]; count],
            samples: vec![1; count],
            noise: 0.0,
            masks: Masks {
                edges: (0..count).map(|i| i < 16).collect(),
                penumbrae: vec![false; count],
                textured: vec![true; count],
            },
        };
        Standard::new(reference, &draw::scene(&json!({})))
    }

    fn of(drawn: &[[f32; 4]], code: u8, standard: &Standard) -> PictureError {
        PictureError::of(drawn, &vec![[code, code, code, 255]; 16 * 16], standard, &draw::work())
    }

    #[test]
    fn the_reference_itself_has_no_error() {
        let error = of(&[[1.0; 4]; 16 * 16], 255, &standard(1.0));
        assert_eq!(error.clamped, Difference::default());
        assert_eq!((error.psnr, error.over_1, error.not_finite), (None, 0.0, 0));
        assert!((error.ssim - 1.0).abs() < 1e-9);
    }

    #[test]
    fn one_row_that_is_off_is_seen_where_it_is() {
        let mut drawn = vec![[0.5, 0.5, 0.5, 1.0]; 16 * 16];
        drawn[..16].fill([0.75, 0.5, 0.5, 1.0]);
        let error = of(&drawn, 188, &standard(0.5));
        // One channel of three in a sixteenth of the pixels.
        assert!((error.clamped.rmse - (0.0625f64 / 48.0).sqrt()).abs() < 1e-12, "{error:?}");
        assert!((error.clamped.mae - 0.25 / 48.0).abs() < 1e-12);
        assert_eq!((error.clamped.max, error.over_8), (0.25, 1.0 / 16.0));
        assert!((error.edges.mae - 0.25 / 3.0).abs() < 1e-12);
        assert_eq!(error.penumbrae, Difference::default());
    }

    #[test]
    fn what_the_display_cannot_show_counts_unclamped_alone() {
        let error = of(&[[3.0, 3.0, 3.0, 1.0]; 16 * 16], 255, &standard(2.0));
        assert_eq!((error.clamped.max, error.unclamped.max), (0.0, 1.0));
    }

    #[test]
    fn a_code_off_everywhere_has_the_psnr_of_its_step() {
        let error = of(&[[1.0; 4]; 16 * 16], 254, &standard(1.0));
        let expected = 20.0 * 255f64.log10();
        assert!((error.psnr.expect("not the same") - expected).abs() < 1e-9);
        assert!(error.ssim < 1.0 && error.ssim > 0.99);
    }
}
