//! Effects against f64: tone mapping (B43), blur (B44), grey (B45), and every other that has a formula.

use crate::draw::{pool, work, work_of};
use crate::measure::{U, at_most};
use crate::numerics::determinism::levels;
use crate::random::Random;
use fearless_simd::Level;
use glam::Vec3;
use rasterd::math::simd::*;
use rasterd::pipeline::Work;
use rasterd::pipeline::post::{LinearFrame, pointwise, run_passes};
use rasterd::plan::{Pointwise, PostChain};
use rasterd::scene::document::{PostEffect, TonemapOperator};

const WIDTH: usize = 61;
const HEIGHT: usize = 47;
const SIZE: [u32; 2] = [61, 47];

/// Red, green, blue and perhaps alpha of a picture of `WIDTH × HEIGHT` pixels.
type Planes = Vec<Vec<f64>>;

/// Numbers between 0 and `most` that an f32 holds.
fn noise(random: &mut Random, channels: usize, most: f64) -> Planes {
    let mut value = || f64::from(random.between(0.0, most) as f32);
    (0..channels).map(|_| (0..WIDTH * HEIGHT).map(|_| value()).collect()).collect()
}

/// Runs effects on premultiplied planes.
fn run(effects: &[PostEffect], planes: &Planes, work: &Work) -> Vec<Vec<f32>> {
    let chain = PostChain::new(effects, SIZE[0], SIZE[1]);
    let mut frame = LinearFrame::new(SIZE, &chain, planes.len() > 3);
    for (plane, from) in frame.planes.iter_mut().zip(planes) {
        let stride = plane.stride();
        for (row, from) in plane.samples_mut().chunks_mut(stride).zip(from.chunks(WIDTH)) {
            for (to, value) in row.iter_mut().zip(from) {
                *to = *value as f32;
            }
        }
    }
    pointwise::run(&mut frame, &chain.in_tiles, work).expect("nobody cancels");
    run_passes(&mut frame, &chain, work).expect("nobody cancels");
    if !chain.passes.is_empty() {
        pointwise::run(&mut frame, chain.last_steps(), work).expect("nobody cancels");
    }
    let rows = |plane: &rasterd::pipeline::post::Plane| {
        (0..HEIGHT).flat_map(|y| plane.row(y)[..WIDTH].to_vec()).collect()
    };
    frame.planes.iter().map(rows).collect()
}

fn largest_difference(drawn: &[Vec<f32>], expected: &Planes) -> f64 {
    assert_eq!(drawn.len(), expected.len());
    let pairs = drawn.iter().flatten().zip(expected.iter().flatten());
    pairs.map(|(drawn, expected)| (f64::from(*drawn) - expected).abs()).fold(0.0, f64::max)
}

/// A sample of a plane; the border repeats.
fn sample(plane: &[f64], x: isize, y: isize) -> f64 {
    let clamp = |n: isize, size: usize| usize::try_from(n.max(0)).expect("not negative").min(size - 1);
    plane[clamp(y, HEIGHT) * WIDTH + clamp(x, WIDTH)]
}

/// Every pixel of a plane by its column and row.
fn map(f: impl Fn(isize, isize) -> f64) -> Vec<f64> {
    let signed = |n: usize| isize::try_from(n).expect("a small picture");
    (0..WIDTH * HEIGHT).map(|i| f(signed(i % WIDTH), signed(i / WIDTH))).collect()
}

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
#[test]
fn a_blur_is_a_gaussian_and_keeps_what_is_constant() {
    let mut random = Random::new("B44", 0x44);
    for radius in [0.0, 0.5, 1.0, 2.7, 8.0, 32.0, 100.0] {
        let effect = [PostEffect::Blur { radius }];
        let planes = noise(&mut random, 4, 1.0);
        let drawn = run(&effect, &planes, &work());
        let expected = planes.iter().map(|plane| blurred(plane, radius)).collect();
        let case = format!("B44 radius {radius}");
        at_most(&case, "difference from f64", largest_difference(&drawn, &expected), 1e-6);

        let constants: Planes =
            (0..4).map(|_| vec![f64::from(random.magnitude(1e-30, 6e4) as f32); WIDTH * HEIGHT]).collect();
        let drawn = run(&effect, &constants, &work());
        let relative = drawn.iter().zip(&constants).flat_map(|(drawn, constant)| {
            drawn.iter().map(|value| (f64::from(*value) / constant[0] - 1.0).abs())
        });
        at_most(&case, "drift of a constant in u", relative.fold(0.0, f64::max) / U, 4.0);
    }
}

#[test]
fn a_kernel_is_a_correlation_whose_first_row_weighs_the_pixels_above() {
    let mut random = Random::new("kernel", 0x7e);
    for side in [1usize, 3, 5, 63] {
        let mut row = || (0..side).map(|_| f64::from(random.between(-1.0, 1.0) as f32)).collect();
        let kernel: Vec<Vec<f64>> = (0..side).map(|_| row()).collect();
        let planes = noise(&mut random, 4, 1.0);
        let drawn = run(&[PostEffect::Kernel { kernel: kernel.clone() }], &planes, &work());
        let mut expected: Planes = planes[..3].iter().map(|plane| correlate(plane, &kernel)).collect();
        expected.push(planes[3].clone());
        // A running sum of n products of at most 1: n roundings of what has come together so far.
        let taps = (side * side) as f64;
        let weights: f64 = kernel.iter().flatten().map(|w| w.abs()).sum();
        let bound = (taps + 1.0) * U * weights;
        at_most(
            &format!("kernel of {side}"),
            "difference from f64",
            largest_difference(&drawn, &expected),
            bound,
        );
    }
}

#[test]
fn sharpening_adds_the_difference_to_binomial_weights() {
    let mut random = Random::new("sharpen", 0x54);
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
        at_most(
            &format!("sharpen by {amount}"),
            "difference from f64",
            largest_difference(&drawn, &expected),
            bound,
        );
    }
}

#[test]
fn bloom_adds_the_blurred_light_above_the_threshold() {
    let mut random = Random::new("bloom", 0xb1);
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
        at_most(&case, "difference from f64", largest_difference(&drawn, &expected), bound);
    }
}

/// Applies pointwise effects to straight colours, at the picture's upper left corner.
fn apply(effect: PostEffect, colors: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let chain = PostChain::new(&[effect], SIZE[0], SIZE[1]);
    let steps: &[Pointwise] = &chain.in_tiles;
    let mut out = Vec::new();
    for chunk in colors.chunks(LANES) {
        let lane = |c: usize| std::array::from_fn(|i| chunk.get(i).map_or(0.0, |color| color[c]));
        let [r, g, b]: [[f32; LANES]; 3] = [lane(0), lane(1), lane(2)];
        let [r, g, b] = dispatch!(Level::new(), simd => {
            let color = Vec3x8 { x: f32x8::simd_from(simd, r), y: f32x8::simd_from(simd, g), z: f32x8::simd_from(simd, b) };
            let color = pointwise::apply(simd, steps, color, [0, 0]);
            [color.x.to_array(), color.y.to_array(), color.z.to_array()]
        });
        out.extend((0..chunk.len()).map(|i| [r[i], g[i], b[i]]));
    }
    out
}

fn tonemap(operator: TonemapOperator, exposure: f64) -> PostEffect {
    PostEffect::Tonemap { operator, exposure }
}

/// B43: 64 numbers of every exponent, subnormal ones too.
#[test]
fn tone_mapping_takes_everything_to_0_to_1_in_order() {
    let exponents = (0..255u32).flat_map(|e| (0..64).map(move |m| f32::from_bits(e << 23 | m << 17)));
    let rising: Vec<f32> = exponents.chain([f32::MAX, f32::INFINITY]).collect();
    let greys: Vec<[f32; 3]> = rising.iter().map(|x| [*x; 3]).collect();
    for (name, operator) in [("aces", TonemapOperator::Aces), ("reinhard", TonemapOperator::Reinhard)] {
        for exposure in [0.0, 1e-300, 0.3, 1.0, 50.0, 1e300] {
            let mapped = apply(tonemap(operator, exposure), &greys);
            assert_eq!(mapped[0], [0.0; 3], "{name}: f(0)");
            assert!(mapped.iter().flatten().all(|y| (0.0..=1.0).contains(y)), "{name}, {exposure}");
            assert!(mapped.is_sorted_by(|a, b| a[0] <= b[0]), "{name}, {exposure}");
            if exposure == 1.0 {
                let worst =
                    rising.iter().zip(&mapped).map(|(x, y)| (f64::from(y[0]) - curve(operator, *x)).abs());
                let case = format!("B43 {name}, {} numbers", rising.len());
                at_most(&case, "difference from f64", worst.fold(0.0, f64::max), 4.0 * U);
            }
        }
        let odd = [[f32::NAN, -1.0, f32::NEG_INFINITY], [1e30, 65504.0, f32::INFINITY]];
        let mapped = apply(tonemap(operator, 1.0), &odd);
        assert_eq!(mapped[0], [0.0; 3], "{name}: no number, or negative");
        assert_eq!(mapped[1], [mapped[1][1]; 3], "{name}: clamped to 65504");
    }
}

fn curve(operator: TonemapOperator, x: f32) -> f64 {
    let x = f64::from(x).min(65504.0);
    let y = match operator {
        TonemapOperator::Aces => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
        TonemapOperator::Reinhard => x / (1.0 + x),
        TonemapOperator::None => x,
    };
    y.min(1.0)
}

/// B45.
#[test]
fn grey_has_no_tint_and_stays_what_it_was() {
    let mut random = Random::new("B45", 0x45);
    let greys: Vec<[f32; 3]> = (0..4000).map(|_| [random.magnitude(1e-6, 6e4) as f32; 3]).collect();
    for amount in [0.1, 0.5, 0.77, 1.0] {
        let same = apply(PostEffect::Grayscale { amount }, &greys);
        let drift = greys
            .iter()
            .zip(&same)
            .flat_map(|(x, y)| y.map(|y| (f64::from(y) / f64::from(x[0]) - 1.0).abs()));
        at_most(&format!("B45 amount {amount}"), "drift of grey in u", drift.fold(0.0, f64::max) / U, 4.0);
    }
    let colors: Vec<[f32; 3]> =
        (0..4000).map(|_| [(); 3].map(|()| random.between(0.0, 2.0) as f32)).collect();
    let mixed = apply(PostEffect::Grayscale { amount: 1.0 }, &colors);
    assert!(mixed.iter().all(|[r, g, b]| r == g && g == b), "no tint at all");
    let worst = colors.iter().zip(&mixed).map(|(c, y)| {
        let [r, g, b] = c.map(f64::from);
        (f64::from(y[0]) - (0.2126 * r + 0.7152 * g + 0.0722 * b)).abs()
    });
    at_most("B45 luminance", "difference from f64", worst.fold(0.0, f64::max), 2.0 * 4.0 * U);
}

#[test]
fn a_colour_matrix_adds_its_last_column() {
    let mut random = Random::new("matrix", 0x3a);
    let mut number = || f64::from(random.between(-2.0, 2.0) as f32);
    let matrix: [[f64; 4]; 3] = [(); 3].map(|()| [(); 4].map(|()| number()));
    let colors: Vec<[f32; 3]> = (0..500).map(|_| [(); 3].map(|()| number() as f32)).collect();
    let mapped = apply(PostEffect::ColorMatrix { matrix }, &colors);
    let worst = colors.iter().zip(&mapped).flat_map(|(c, mapped)| {
        let [r, g, b] = c.map(f64::from);
        [0, 1, 2].map(|i| {
            let [mr, mg, mb, add] = matrix[i];
            (f64::from(mapped[i]) - (mr * r + mg * g + mb * b + add)).abs()
        })
    });
    // Three products of at most 4, three sums of at most 14.
    at_most("colour matrix", "difference from f64", worst.fold(0.0, f64::max), (12.0 + 3.0 * 14.0) * U);
}

/// A half-plane whose edge has a slope, shaded where the pixel's centre is inside; and the share of
/// each pixel that is inside.
fn half_plane(slope: f64) -> (Vec<f64>, Vec<f64>) {
    let middle = |x: isize| 23.3 + slope * (x as f64 - 30.0);
    let hard = map(|x, y| f64::from(u8::from(y as f64 + 0.5 > middle(x) + slope * 0.5)));
    let covered = map(|x, y| {
        let share =
            |i: i32| (y as f64 + 1.0 - middle(x) - slope * (f64::from(i) + 0.5) / 64.0).clamp(0.0, 1.0);
        (0..64).map(share).sum::<f64>() / 64.0
    });
    (hard, covered)
}

#[test]
fn fxaa_brings_slanted_edges_nearer_to_their_coverage() {
    for slope in [0.08, 0.13, 0.3, -0.2] {
        let (hard, covered) = half_plane(slope);
        let planes = vec![hard.clone(), hard.clone(), hard.clone()];
        let drawn = run(&[PostEffect::Fxaa], &planes, &work());
        let error = |of: &dyn Fn(usize) -> f64| {
            let inside = (0..WIDTH * HEIGHT).filter(|i| (8..WIDTH - 8).contains(&(i % WIDTH)));
            inside.map(|i| (of(i) - covered[i]).powi(2)).sum::<f64>().sqrt()
        };
        let (before, after) = (error(&|i| hard[i]), error(&|i| f64::from(drawn[0][i])));
        at_most(&format!("FXAA, slope {slope}"), "error left", after / before, 0.7);
    }
}

#[test]
fn fxaa_leaves_flat_and_gentle_pictures_alone() {
    let gentle = map(|x, y| 0.3 + 0.002 * x as f64 + 0.003 * y as f64);
    let gentle: Vec<f64> = gentle.into_iter().map(|value| f64::from(value as f32)).collect();
    let planes = vec![gentle.clone(), gentle.clone(), gentle];
    assert_eq!(largest_difference(&run(&[PostEffect::Fxaa], &planes, &work()), &planes), 0.0);
}

#[test]
fn fxaa_takes_on_no_black_from_where_nothing_is() {
    // A white half-plane before nothing: premultiplied, so 0 where alpha is.
    let (hard, _) = half_plane(0.13);
    let planes = vec![hard; 4];
    let drawn = run(&[PostEffect::Fxaa], &planes, &work());
    at_most("FXAA before nothing", "change", largest_difference(&drawn, &planes), 2.0 * U);
}

/// Every kind of effect, some of them twice.
fn long_chain() -> Vec<PostEffect> {
    vec![
        PostEffect::Grayscale { amount: 0.2 },
        PostEffect::Bloom { threshold: 0.6, intensity: 0.5, radius: 5.5 },
        PostEffect::Vignette { amount: 0.8 },
        PostEffect::Blur { radius: 1.3 },
        PostEffect::Fxaa,
        tonemap(TonemapOperator::None, 1.5),
        PostEffect::Sharpen { amount: 0.7 },
        PostEffect::Kernel {
            kernel: vec![vec![0.0, -0.1, 0.0], vec![-0.1, 1.4, -0.1], vec![0.0, -0.1, 0.02]],
        },
        tonemap(TonemapOperator::Aces, 0.8),
        PostEffect::Bloom { threshold: 0.0, intensity: 0.1, radius: 0.0 },
    ]
}

/// B49.
#[test]
fn effects_are_the_same_to_the_bit() {
    let mut random = Random::new("B49 post", 0x49);
    for channels in [3, 4] {
        let planes = noise(&mut random, channels, 1.0);
        let first = run(&long_chain(), &planes, &work());
        for (name, level) in levels() {
            for threads in [1, 2, 7] {
                let again = run(&long_chain(), &planes, &work_of(&pool(threads), level));
                let bits =
                    |planes: &[Vec<f32>]| planes.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&again), bits(&first), "{name}, {threads} threads, {channels} channels");
            }
        }
    }
}

#[test]
fn the_largest_parameters_leave_finite_numbers() {
    let mut random = Random::new("largest", 0x1e);
    let planes = noise(&mut random, 4, 65504.0);
    let huge = 2e37;
    let effects = [
        tonemap(TonemapOperator::None, 1e308),
        PostEffect::Sharpen { amount: 1e308 },
        PostEffect::Bloom { threshold: 0.0, intensity: 1e308, radius: 3.0 },
        PostEffect::Bloom { threshold: 1e308, intensity: 1e308, radius: 3.0 },
        PostEffect::Bloom { threshold: 0.0, intensity: 1e308, radius: 0.0 },
        PostEffect::ColorMatrix { matrix: [[huge, -huge, huge, huge]; 3] },
        PostEffect::Kernel { kernel: vec![vec![huge, -huge, huge], vec![huge; 3], vec![-huge; 3]] },
        PostEffect::Fxaa,
        PostEffect::Blur { radius: 2.0 },
    ];
    let mut chain = Vec::new();
    for effect in effects {
        chain.push(effect);
        let drawn = run(&chain, &planes, &work());
        assert!(drawn.iter().flatten().all(|value| value.abs() <= 1e18), "after {:?}", chain.last());
    }
}

#[test]
fn only_a_blur_changes_alpha() {
    let mut random = Random::new("alpha", 0xa1);
    let planes = noise(&mut random, 4, 1.0);
    for effect in long_chain() {
        let drawn = run(std::slice::from_ref(&effect), &planes, &work());
        let changed = drawn[3].iter().zip(&planes[3]).any(|(a, b)| f64::from(*a) != *b);
        assert_eq!(changed, matches!(effect, PostEffect::Blur { .. }), "{effect:?}");
    }
}

#[test]
fn pointwise_effects_see_straight_colour_and_the_others_premultiplied() {
    let straight = Vec3::new(0.9, 0.5, 0.2);
    let alpha = 0.25f64;
    let pixel = |value: f32| vec![f64::from(value) * alpha; WIDTH * HEIGHT];
    let planes = vec![pixel(straight.x), pixel(straight.y), pixel(straight.z), vec![alpha; WIDTH * HEIGHT]];
    let mapped = run(&[tonemap(TonemapOperator::Reinhard, 1.0)], &planes, &work());
    let expected = f64::from(straight.x / (1.0 + straight.x)) * alpha;
    at_most("straight tone mapping", "difference", (f64::from(mapped[0][0]) - expected).abs(), 4.0 * U);
    // Premultiplied, the luminance is a quarter of the straight one, and below the threshold.
    let bloomed = run(&[PostEffect::Bloom { threshold: 0.3, intensity: 1.0, radius: 2.0 }], &planes, &work());
    assert_eq!(largest_difference(&bloomed, &planes), 0.0);
}
