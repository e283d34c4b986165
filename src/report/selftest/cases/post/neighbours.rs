//! Effects that look at the pixels around: blur (B44), bloom, sharpening, free kernels.

use super::{HEIGHT, Planes, WIDTH, largest_difference, map, noise, run, sample};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::work;
use crate::report::selftest::instruments::worst::{U, Worst};
use crate::scene::document::PostEffect;

fn correlate(plane: &[f64], kernel: &[Vec<f64>]) -> Vec<f64> {
    let reach = isize::try_from(kernel.len() / 2).expect("a small kernel");
    map(|x, y| {
        let rows = kernel.iter().zip(y - reach..);
        rows.flat_map(|(row, sy)| row.iter().zip(x - reach..).map(move |(w, sx)| w * sample(plane, sx, sy)))
            .sum()
    })
}

fn blurred(plane: &[f64], radius: f64) -> Vec<f64> {
    let reach = radius.ceil() as isize;
    let weight =
        |k: isize| if radius == 0.0 { 1.0 } else { (-2.0 * (k * k) as f64 / (radius * radius)).exp() };
    let sum: f64 = (-reach..=reach).map(weight).sum();
    let across = map(|x, y| (-reach..=reach).map(|k| weight(k) / sum * sample(plane, x + k, y)).sum());
    map(|x, y| (-reach..=reach).map(|k| weight(k) / sum * sample(&across, x, y + k)).sum())
}

fn luminance(planes: &Planes, i: usize) -> f64 {
    0.2126 * planes[0][i] + 0.7152 * planes[1][i] + 0.0722 * planes[2][i]
}

/// B44.
pub fn a_blur_is_a_gaussian_and_keeps_what_is_constant(ledger: &mut Ledger) {
    let mut random = ledger.random(0x44);
    for radius in [0.0, 0.5, 1.0, 2.7, 8.0, 32.0, 100.0] {
        let effect = [PostEffect::Blur { radius }];
        let planes = noise(&mut random, 4, 1.0);
        let drawn = run(&effect, &planes, &work());
        let expected = planes.iter().map(|plane| blurred(plane, radius)).collect();
        let case = format!("radius {radius}");
        ledger.at_most(&case, "difference from f64", largest_difference(&drawn, &expected), 1e-6);

        if radius == 0.0 {
            ledger.at_most("", "change by a blur of radius 0", largest_difference(&drawn, &planes), 0.0);
        }

        let constants: Planes =
            (0..4).map(|_| vec![f64::from(random.magnitude(1e-30, 6e4) as f32); WIDTH * HEIGHT]).collect();
        let drawn = run(&effect, &constants, &work());
        let relative = drawn.iter().zip(&constants).flat_map(|(drawn, constant)| {
            drawn.iter().map(|value| (f64::from(*value) / constant[0] - 1.0).abs())
        });
        ledger.at_most(&case, "drift of a constant in u", relative.collect::<Worst>().largest() / U, 4.0);
    }
}

pub fn a_kernel_is_a_correlation_whose_first_row_weighs_the_pixels_above(ledger: &mut Ledger) {
    let mut random = ledger.random(0x7e);
    for side in [1usize, 3, 5, 63] {
        let mut row = || (0..side).map(|_| f64::from(random.between(-1.0, 1.0) as f32)).collect();
        let kernel: Vec<Vec<f64>> = (0..side).map(|_| row()).collect();
        let planes = noise(&mut random, 4, 1.0);
        let drawn = run(&[PostEffect::Kernel { kernel: kernel.clone() }], &planes, &work());
        let mut expected: Planes = planes[..3].iter().map(|plane| correlate(plane, &kernel)).collect();
        expected.push(planes[3].clone());
        // A running sum of n products of at most |w| each: its roundings add up as √n, and 4 times that is
        // not met by chance. N. Higham, T. Mary, "A new approach to probabilistic rounding error
        // analysis", 2019.
        let taps = (side * side) as f64;
        let weights: f64 = kernel.iter().flatten().map(|w| w.abs()).sum();
        let bound = 4.0 * taps.sqrt() * U * weights;
        ledger.at_most(
            &format!("kernel of {side}"),
            "difference from f64",
            largest_difference(&drawn, &expected),
            bound,
        );
    }
}

pub fn sharpening_adds_the_difference_to_binomial_weights(ledger: &mut Ledger) {
    let mut random = ledger.random(0x54);
    let weights = [1.0, 2.0, 1.0];
    let mask: Vec<Vec<f64>> =
        weights.iter().map(|a| weights.iter().map(|b| a * b / 16.0).collect()).collect();
    for amount in [0.5, 3.0, 40.0] {
        let planes = noise(&mut random, 4, 1.0);
        let drawn = run(&[PostEffect::Sharpen { amount }], &planes, &work());
        let sharpened = |plane: &Vec<f64>| {
            let soft = correlate(plane, &mask);
            plane.iter().zip(soft).map(|(c, soft)| c + amount * (c - soft)).collect()
        };
        let mut expected: Planes = planes[..3].iter().map(sharpened).collect();
        expected.push(planes[3].clone());
        // Nine differences of at most 1, weights that sum to 1, and what is left of 1 + amount.
        let bound = (amount * 10.0 + 2.0 + 2.0 * amount) * U;
        ledger.at_most(
            &format!("sharpen by {amount}"),
            "difference from f64",
            largest_difference(&drawn, &expected),
            bound,
        );
    }
}

pub fn bloom_adds_the_blurred_light_above_the_threshold(ledger: &mut Ledger) {
    let mut random = ledger.random(0xb1);
    for (threshold, intensity, radius) in
        [(1.0, 0.2, 8.0), (0.0, 1.0, 3.0), (2.5, 4.0, 0.0), (1.5, 0.7, 90.0)]
    {
        let planes = noise(&mut random, 4, 4.0);
        let effect = [PostEffect::Bloom { threshold, intensity, radius }];
        let drawn = run(&effect, &planes, &work());
        let glow = |c: usize| -> Vec<f64> {
            let share = |i| (luminance(&planes, i) - threshold).max(0.0) / luminance(&planes, i);
            (0..WIDTH * HEIGHT).map(|i| planes[c][i] * share(i)).collect()
        };
        let lit = |c: usize| {
            let glow = blurred(&glow(c), radius);
            planes[c].iter().zip(glow).map(|(color, glow)| color + intensity * glow).collect()
        };
        let mut expected: Planes = (0..3).map(lit).collect();
        expected.push(planes[3].clone());
        let bound = 4.0 * (1.0 + intensity) * 1e-6;
        let case = format!("bloom above {threshold} by {intensity} within {radius}");
        ledger.at_most(&case, "difference from f64", largest_difference(&drawn, &expected), bound);
    }
}
