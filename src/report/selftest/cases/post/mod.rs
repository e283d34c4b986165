//! Effects against f64, and what holds for all of them.

pub mod fxaa;
pub mod neighbours;
pub mod pointwise;

use crate::pipeline::Work;
use crate::pipeline::post::{Chain, Effect, LinearFrame, Plane};
use crate::plan::PostChain;
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::levels;
use crate::report::selftest::instruments::draw::{pool, work, work_of};
use crate::report::selftest::instruments::worst::{U, Worst};
use crate::scene::document::{PostEffect, TonemapOperator};
use glam::Vec3;

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
    let mut frame = LinearFrame::new(SIZE, planes.len() > 3, chain.spare_planes());
    for (plane, from) in frame.planes.iter_mut().zip(planes) {
        for (y, from) in from.chunks(WIDTH).enumerate() {
            for (to, value) in plane.row_mut(y).iter_mut().zip(from) {
                *to = *value as f32;
            }
        }
    }
    chain.in_tiles.apply(&mut frame, work).expect("nobody cancels");
    Chain::new(&chain, &[]).run(&mut frame, work).expect("nobody cancels");
    chain.last_steps().to_vec().apply(&mut frame, work).expect("nobody cancels");
    let rows = |plane: &Plane| (0..HEIGHT).flat_map(|y| plane.row(y)[..WIDTH].to_vec()).collect();
    frame.planes.iter().map(rows).collect()
}

fn largest_difference(drawn: &[Vec<f32>], expected: &Planes) -> f64 {
    assert_eq!(drawn.len(), expected.len());
    let pairs = drawn.iter().flatten().zip(expected.iter().flatten());
    pairs.map(|(drawn, expected)| (f64::from(*drawn) - expected).abs()).collect::<Worst>().largest()
}

fn tonemap(operator: TonemapOperator, exposure: f64) -> PostEffect {
    PostEffect::Tonemap { operator, exposure }
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
pub fn effects_are_the_same_to_the_bit(ledger: &mut Ledger) {
    let mut random = ledger.random(0x49);
    for channels in [3, 4] {
        let planes = noise(&mut random, channels, 1.0);
        let first = run(&long_chain(), &planes, &work());
        for (name, level) in levels() {
            for threads in [1, 2, 7] {
                let again = run(&long_chain(), &planes, &work_of(pool(threads), level));
                let bits =
                    |planes: &[Vec<f32>]| planes.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
                let setting = format!("{name}, {threads} threads, {channels} channels");
                ledger.holds(&setting, "planes after a long chain that differ", bits(&again) == bits(&first));
            }
        }
    }
}

pub fn the_largest_parameters_leave_finite_numbers(ledger: &mut Ledger) {
    let mut random = ledger.random(0x1e);
    let mut planes = noise(&mut random, 3, 65504.0);
    planes.extend(noise(&mut random, 1, 1.0));
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
        let wrong = drawn.iter().flatten().filter(|value| !(-1e18..=1e18).contains(*value)).count();
        let setting = format!("after {:?}", chain.last());
        ledger.none_of(&setting, "numbers beyond 10¹⁸", wrong, drawn.len());
    }
}

pub fn only_a_blur_changes_alpha(ledger: &mut Ledger) {
    let mut random = ledger.random(0xa1);
    let planes = noise(&mut random, 4, 1.0);
    for effect in long_chain() {
        let drawn = run(std::slice::from_ref(&effect), &planes, &work());
        let changed = drawn[3].iter().zip(&planes[3]).any(|(a, b)| f64::from(*a) != *b);
        let blurs = matches!(effect, PostEffect::Blur { .. });
        ledger.holds(&format!("{effect:?}"), "effects that treat alpha otherwise", changed == blurs);
    }
}

pub fn pointwise_effects_see_straight_colour_and_the_others_premultiplied(ledger: &mut Ledger) {
    let straight = Vec3::new(0.9, 0.5, 0.2);
    let alpha = 0.25f64;
    let pixel = |value: f32| vec![f64::from(value) * alpha; WIDTH * HEIGHT];
    let planes = vec![pixel(straight.x), pixel(straight.y), pixel(straight.z), vec![alpha; WIDTH * HEIGHT]];
    let mapped = run(&[tonemap(TonemapOperator::Reinhard, 1.0)], &planes, &work());
    let expected = f64::from(straight.x / (1.0 + straight.x)) * alpha;
    ledger.at_most(
        "straight tone mapping",
        "difference",
        (f64::from(mapped[0][0]) - expected).abs(),
        4.0 * U,
    );
    // Premultiplied, the luminance is a quarter of the straight one, and below the threshold.
    let bloomed = run(&[PostEffect::Bloom { threshold: 0.3, intensity: 1.0, radius: 2.0 }], &planes, &work());
    ledger.at_most("bloom below its threshold", "change", largest_difference(&bloomed, &planes), 0.0);
}
