//! The effects of `post` in f64, as the API defines them. Borders clamp; nothing is clamped between
//! effects. Effects on a single pixel see straight colour, the others premultiplied.
//!
//! `fxaa` is left out: it imitates what many samples are.

use crate::math::colour::BRIGHTEST;
use crate::scene::document::{PostEffect, TonemapOperator};
use glam::{DVec3, DVec4};

/// Rec. 709 luminance.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// Largest magnitude that an effect leaves, whatever its parameters.
const LARGEST: f64 = 1e18;

/// Takes linear premultiplied colours through `effects`. Gives back colours in 0–1, over white.
pub fn apply(effects: &[PostEffect], [width, height]: [u32; 2], radiance: &[[f64; 4]]) -> Vec<[f64; 3]> {
    let pixels = radiance.iter().map(|&pixel| DVec4::from_array(pixel)).collect();
    let picture = Picture { width: i64::from(width), height: i64::from(height), pixels };
    let picture = effects.iter().fold(picture, |picture, effect| picture.after(effect).finite());
    picture.pixels.iter().map(|&pixel| over_white(pixel).to_array()).collect()
}

fn over_white(pixel: DVec4) -> DVec3 {
    let alpha = pixel.w.clamp(0.0, 1.0);
    straight(pixel).clamp(DVec3::ZERO, DVec3::ONE) * alpha + (1.0 - alpha)
}

/// Colour without its alpha; black where that is 0.
fn straight(pixel: DVec4) -> DVec3 {
    if pixel.w > 0.0 { pixel.truncate() / pixel.w } else { DVec3::ZERO }
}

/// Premultiplied colours in rows from the top.
struct Picture {
    width: i64,
    height: i64,
    pixels: Vec<DVec4>,
}

/// A neighbour, by its place relative to a pixel, x to the right and y down; and its weight.
struct Tap {
    x: i64,
    y: i64,
    weight: f64,
}

impl Picture {
    fn after(self, effect: &PostEffect) -> Self {
        match effect {
            PostEffect::Tonemap { operator, exposure } => {
                self.colored(|_, color| tonemapped(*operator, color * *exposure))
            }
            PostEffect::Grayscale { amount } => {
                self.colored(|_, color| color.lerp(DVec3::splat(color.dot(LUMINANCE)), *amount))
            }
            PostEffect::Vignette { amount } => {
                let vignette = self.vignette(*amount);
                self.colored(|place, color| color * vignette(place))
            }
            PostEffect::ColorMatrix { matrix } => self.colored(|_, color| {
                let mixed = |row: [f64; 4]| DVec3::new(row[0], row[1], row[2]).dot(color) + row[3];
                DVec3::from_array(matrix.map(mixed))
            }),
            PostEffect::Blur { radius } => self.blurred(*radius),
            PostEffect::Bloom { threshold, intensity, radius } => {
                let glow = self.mapped(|pixel| glow(pixel, *threshold)).blurred(*radius);
                self.plus(&glow, *intensity)
            }
            PostEffect::Sharpen { amount } => {
                let detail = self.correlated(&detail());
                self.plus(&detail, *amount)
            }
            PostEffect::Kernel { kernel } => {
                let mut summed = self.correlated(&taps(kernel));
                for (pixel, own) in summed.pixels.iter_mut().zip(&self.pixels) {
                    pixel.w = own.w;
                }
                summed
            }
            PostEffect::Fxaa => self,
        }
    }

    fn mapped(&self, pixel: impl Fn(DVec4) -> DVec4) -> Self {
        Self { pixels: self.pixels.iter().map(|&of| pixel(of)).collect(), ..*self }
    }

    /// Changes straight colours, given the column and row of each.
    fn colored(mut self, color: impl Fn([i64; 2], DVec3) -> DVec3) -> Self {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| [x, y]));
        for (place, pixel) in places.zip(&mut self.pixels) {
            if pixel.w > 0.0 {
                *pixel = (color(place, straight(*pixel)) * pixel.w).extend(pixel.w);
            }
        }
        self
    }

    /// Adds the colours of another picture, times a factor; alpha stays.
    fn plus(mut self, other: &Self, factor: f64) -> Self {
        for (pixel, added) in self.pixels.iter_mut().zip(&other.pixels) {
            *pixel += (added.truncate() * factor).extend(0.0);
        }
        self
    }

    /// The weighted sum of every pixel's neighbours, alpha too.
    fn correlated(&self, taps: &[Tap]) -> Self {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| [x, y]));
        let sum = |[x, y]: [i64; 2]| taps.iter().map(|tap| self.at(x + tap.x, y + tap.y) * tap.weight).sum();
        Self { pixels: places.map(sum).collect(), ..*self }
    }

    /// The pixel in column x and row y; beyond the borders the nearest.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
    fn at(&self, x: i64, y: i64) -> DVec4 {
        self.pixels[(y.clamp(0, self.height - 1) * self.width + x.clamp(0, self.width - 1)) as usize]
    }

    /// Along the rows, then along the columns.
    fn blurred(&self, radius: f64) -> Self {
        let gaussian = gaussian(radius);
        let along = |x: i64, y: i64| -> Vec<Tap> {
            gaussian.iter().map(|&(at, weight)| Tap { x: at * x, y: at * y, weight }).collect()
        };
        self.correlated(&along(1, 0)).correlated(&along(0, 1))
    }

    /// `1 − amount · (d / D)²`, d the distance from the picture's centre, D that of a corner.
    fn vignette(&self, amount: f64) -> impl Fn([i64; 2]) -> f64 + use<> {
        let half = [self.width, self.height].map(|side| float(side) / 2.0);
        let squared = |[x, y]: [f64; 2]| x * x + y * y;
        move |[x, y]| {
            let from_centre = [float(x) + 0.5 - half[0], float(y) + 0.5 - half[1]];
            (1.0 - amount * squared(from_centre) / squared(half)).max(0.0)
        }
    }

    fn finite(self) -> Self {
        let number = |x: f64| if x.is_nan() { 0.0 } else { x.clamp(-LARGEST, LARGEST) };
        self.mapped(|pixel| DVec4::from_array(pixel.to_array().map(number)))
    }
}

fn tonemapped(operator: TonemapOperator, color: DVec3) -> DVec3 {
    let curve = |x: f64| match operator {
        // K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015; it ends a little above 1.
        TonemapOperator::Aces => (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0),
        TonemapOperator::Reinhard => x / (1.0 + x),
        TonemapOperator::None => x,
    };
    match operator {
        TonemapOperator::None => color,
        _ => DVec3::from_array(color.to_array().map(|x| curve(x.clamp(0.0, f64::from(BRIGHTEST))))),
    }
}

/// What of a pixel glows: the share of its luminance that is over the threshold.
fn glow(pixel: DVec4, threshold: f64) -> DVec4 {
    let bright = pixel.truncate().dot(LUMINANCE);
    if bright > threshold { pixel * ((bright - threshold) / bright) } else { DVec4::ZERO }
}

/// Distances from −⌈radius⌉ to ⌈radius⌉ with weights that sum to 1; sigma is half the radius.
#[expect(clippy::cast_possible_truncation, reason = "cut off far beyond any picture")]
fn gaussian(radius: f64) -> Vec<(i64, f64)> {
    if radius <= 0.0 {
        return vec![(0, 1.0)];
    }
    let (sigma, reach) = (radius / 2.0, radius.ceil().min(LONGEST_REACH) as i64);
    let weight = |at: i64| (-0.5 * (float(at) / sigma).powi(2)).exp();
    let sum: f64 = (-reach..=reach).map(weight).sum();
    (-reach..=reach).map(|at| (at, weight(at) / sum)).collect()
}

/// Pixels beyond which a blur reaches no others: pictures have at most 2¹⁴ a side.
const LONGEST_REACH: f64 = 65536.0;

/// What a pixel has over those around it, weighted 1 2 1 in both directions.
fn detail() -> Vec<Tap> {
    let around = (-1..=1).flat_map(|y: i64| (-1..=1).map(move |x: i64| (x, y)));
    let around = around.map(|(x, y)| Tap { x, y, weight: float((x.abs() - 2) * (2 - y.abs())) / 16.0 });
    around.chain([Tap { x: 0, y: 0, weight: 1.0 }]).collect()
}

/// The taps of a square of rows: the first row weighs the pixels above, the first column those to the left.
fn taps(kernel: &[Vec<f64>]) -> Vec<Tap> {
    let reach = i64::try_from(kernel.len() / 2).expect("invariant: a kernel fits into memory");
    let rows = (-reach..).zip(kernel);
    rows.flat_map(|(y, row)| (-reach..).zip(row).map(move |(x, &weight)| Tap { x, y, weight })).collect()
}

#[expect(clippy::cast_precision_loss, reason = "pixels and weights are far below 2⁵³")]
fn float(i: i64) -> f64 {
    i as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 9;

    /// Black with one pixel of `value` in the middle, after an effect; before it is clamped.
    fn impulse(effect: &PostEffect, value: DVec4) -> Vec<DVec4> {
        let mut pixels = vec![DVec3::ZERO.extend(1.0); SIDE * SIDE];
        pixels[SIDE * SIDE / 2] = value;
        Picture { width: 9, height: 9, pixels }.after(effect).pixels
    }

    fn near(pixels: &[DVec4], expected: impl Fn(i64, i64) -> DVec4) {
        for (i, pixel) in pixels.iter().enumerate() {
            let [x, y] = [i % SIDE, i / SIDE].map(|i| i64::try_from(i).unwrap() - 4);
            let expected = expected(x, y);
            assert!(pixel.distance(expected) < 1e-12, "{x} {y}: {pixel} {expected}");
        }
    }

    const BRIGHT: DVec4 = DVec4::new(2.0, 4.0, 1.0, 1.0);
    const BLACK: DVec4 = DVec4::new(0.0, 0.0, 0.0, 1.0);

    fn is_centre(x: i64, y: i64) -> bool {
        (x, y) == (0, 0)
    }

    #[test]
    fn curves_go_through_known_points() {
        let curve = |operator, exposure, x: f64| {
            let effect = PostEffect::Tonemap { operator, exposure };
            impulse(&effect, DVec3::splat(x).extend(1.0))[SIDE * SIDE / 2].x
        };
        assert!((curve(TonemapOperator::Aces, 2.0, 0.5) - 2.54 / 3.16).abs() < 1e-15);
        assert_eq!(curve(TonemapOperator::Aces, 1.0, 1e6), 1.0);
        assert_eq!(curve(TonemapOperator::Aces, 1.0, -3.0), 0.0);
        assert_eq!(curve(TonemapOperator::Reinhard, 1.0, 3.0), 0.75);
        assert_eq!(curve(TonemapOperator::None, 3.0, -2.0), -6.0);
    }

    #[test]
    fn pointwise_effects_keep_to_their_pixel() {
        let grey = impulse(&PostEffect::Grayscale { amount: 0.25 }, BRIGHT);
        let y = 0.2126 * 2.0 + 0.7152 * 4.0 + 0.0722;
        let mixed = BRIGHT.truncate() * 0.75 + y * 0.25;
        near(&grey, |x, y| if is_centre(x, y) { mixed.extend(1.0) } else { BLACK });
        let matrix = [[0.0, 1.0, 0.0, 0.5], [2.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, -1.0]];
        let rows = impulse(&PostEffect::ColorMatrix { matrix }, BRIGHT);
        near(&rows, |x, y| {
            if is_centre(x, y) { DVec4::new(4.5, 3.0, -1.0, 1.0) } else { DVec4::new(0.5, 0.0, -1.0, 1.0) }
        });
    }

    #[test]
    fn straight_colour_is_what_pointwise_effects_see() {
        let effect = PostEffect::Tonemap { operator: TonemapOperator::Reinhard, exposure: 1.0 };
        let pixel = impulse(&effect, DVec4::new(0.5, 1.5, 0.0, 0.5))[SIDE * SIDE / 2];
        assert_eq!(pixel, DVec4::new(0.25, 0.375, 0.0, 0.5));
    }

    #[test]
    fn a_vignette_is_darkest_in_the_corners() {
        let white = Picture { width: 9, height: 9, pixels: vec![DVec4::ONE; SIDE * SIDE] };
        let pixels = white.after(&PostEffect::Vignette { amount: 0.5 }).pixels;
        near(&pixels, |x, y| DVec3::splat(1.0 - 0.5 * (x * x + y * y) as f64 / 40.5).extend(1.0));
    }

    /// Sigma 1: e^(−k²/2), normalised over −2 … 2.
    fn gauss(at: i64) -> f64 {
        let weight = |k: i64| (-0.5 * (k * k) as f64).exp();
        if at.abs() <= 2 { weight(at) / (1.0 + 2.0 * weight(1) + 2.0 * weight(2)) } else { 0.0 }
    }

    #[test]
    fn a_blurred_impulse_is_a_gaussian() {
        let clear = DVec4::new(2.0, 4.0, 1.0, 0.0);
        let pixels = impulse(&PostEffect::Blur { radius: 2.0 }, clear);
        near(&pixels, |x, y| BLACK + (clear - BLACK) * (gauss(x) * gauss(y)));
        let same = impulse(&PostEffect::Blur { radius: 0.0 }, BRIGHT);
        near(&same, |x, y| if is_centre(x, y) { BRIGHT } else { BLACK });
    }

    #[test]
    fn what_is_over_the_threshold_glows() {
        let pixels = impulse(&PostEffect::Bloom { threshold: 1.0, intensity: 0.5, radius: 2.0 }, BRIGHT);
        let bright = 0.2126 * 2.0 + 0.7152 * 4.0 + 0.0722;
        let glow = BRIGHT.truncate() * ((bright - 1.0) / bright);
        near(&pixels, |x, y| {
            let own = if is_centre(x, y) { BRIGHT } else { BLACK };
            own + (glow * 0.5 * gauss(x) * gauss(y)).extend(0.0)
        });
        let dim = impulse(&PostEffect::Bloom { threshold: 4.0, intensity: 0.5, radius: 2.0 }, BRIGHT);
        near(&dim, |x, y| if is_centre(x, y) { BRIGHT } else { BLACK });
    }

    #[test]
    fn sharpening_adds_what_a_blur_takes() {
        let pixels = impulse(&PostEffect::Sharpen { amount: 2.0 }, BRIGHT);
        let weight =
            |at: i64| [0.25, 0.5, 0.25].get(usize::try_from(at + 1).unwrap_or(9)).copied().unwrap_or(0.0);
        near(&pixels, |x, y| {
            let own = if is_centre(x, y) { BRIGHT.truncate() } else { DVec3::ZERO };
            (own + (own - BRIGHT.truncate() * weight(x) * weight(y)) * 2.0).extend(1.0)
        });
    }

    #[test]
    fn a_kernel_is_a_correlation() {
        // Only the pixel above counts: the impulse moves down.
        let kernel = vec![vec![0.0, 3.0, 0.0], vec![0.0; 3], vec![0.5, 0.0, 0.0]];
        let pixels = impulse(&PostEffect::Kernel { kernel }, BRIGHT);
        near(&pixels, |x, y| match (x, y) {
            (0, 1) => (BRIGHT.truncate() * 3.0).extend(1.0),
            (1, -1) => (BRIGHT.truncate() * 0.5).extend(1.0),
            _ => BLACK,
        });
    }

    #[test]
    fn borders_go_on_for_ever() {
        let pixels = vec![DVec4::new(0.0, 0.0, 0.0, 1.0), DVec4::ONE];
        let blurred = Picture { width: 2, height: 1, pixels }.after(&PostEffect::Blur { radius: 2.0 });
        let right = gauss(1) + gauss(2);
        assert!((blurred.pixels[0].x - right).abs() < 1e-12);
        assert!((blurred.pixels[1].x - (right + gauss(0))).abs() < 1e-12);
    }
}
