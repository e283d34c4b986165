//! Effects on one pixel's colour: tone mapping (B43), grey (B45), colour matrices.

use super::{SIZE, tonemap};
use crate::math::simd::*;
use crate::pipeline::post::pointwise;
use crate::plan::{Pointwise, PostChain};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::closed_form::encode;
use crate::report::selftest::instruments::draw::level;
use crate::report::selftest::instruments::worst::{U, Worst};
use crate::scene::document::{PostEffect, TonemapOperator};

/// Applies pointwise effects to straight colours, at the picture's upper left corner.
fn apply(effect: PostEffect, colors: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let chain = PostChain::new(&[effect], SIZE[0], SIZE[1]);
    let steps: &[Pointwise] = &chain.in_tiles;
    let mut out = Vec::new();
    for chunk in colors.chunks(LANES) {
        let lane = |c: usize| std::array::from_fn(|i| chunk.get(i).map_or(0.0, |color| color[c]));
        let [r, g, b]: [[f32; LANES]; 3] = [lane(0), lane(1), lane(2)];
        let [r, g, b] = dispatch!(level(), simd => {
            let color = Vec3x8 { x: f32x8::simd_from(simd, r), y: f32x8::simd_from(simd, g), z: f32x8::simd_from(simd, b) };
            let color = pointwise::apply(simd, steps, color, [0, 0]);
            [color.x.to_array(), color.y.to_array(), color.z.to_array()]
        });
        out.extend((0..chunk.len()).map(|i| [r[i], g[i], b[i]]));
    }
    out
}

/// B43: 64 numbers of every exponent, subnormal ones too.
pub fn tone_mapping_takes_everything_to_0_to_1_in_order(ledger: &mut Ledger) {
    let exponents = (0..255u32).flat_map(|e| (0..64).map(move |m| f32::from_bits(e << 23 | m << 17)));
    let rising: Vec<f32> = exponents.chain([f32::MAX, f32::INFINITY]).collect();
    let greys: Vec<[f32; 3]> = rising.iter().map(|x| [*x; 3]).collect();
    for (name, operator) in [("aces", TonemapOperator::Aces), ("reinhard", TonemapOperator::Reinhard)] {
        for exposure in [0.0, 1e-300, 0.3, 1.0, 50.0, 1e300] {
            let mapped = apply(tonemap(operator, exposure), &greys);
            let setting = format!("{name}, exposure {exposure:e}");
            ledger.holds(&setting, "f(0) is not 0", mapped[0] == [0.0; 3]);
            let outside = mapped.iter().flatten().filter(|y| !(0.0..=1.0).contains(*y)).count();
            ledger.none_of(&setting, "numbers outside 0 to 1", outside, mapped.len());
            ledger.holds(&setting, "out of order", mapped.is_sorted_by(|a, b| a[0] <= b[0]));
            if exposure == 1.0 {
                let worst =
                    rising.iter().zip(&mapped).map(|(x, y)| (f64::from(y[0]) - curve(operator, *x)).abs());
                let case = format!("{name}, {} numbers", rising.len());
                ledger.at_most(&case, "difference from f64", worst.collect::<Worst>().largest(), 4.0 * U);
            }
        }
        let odd = [[f32::NAN, -1.0, f32::NEG_INFINITY], [1e30, 65504.0, f32::INFINITY]];
        let mapped = apply(tonemap(operator, 1.0), &odd);
        ledger.holds(name, "no number, or a negative one, is not 0", mapped[0] == [0.0; 3]);
        ledger.holds(name, "not clamped to 65504", mapped[1] == [mapped[1][1]; 3]);
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
pub fn grey_has_no_tint_and_stays_what_it_was(ledger: &mut Ledger) {
    let mut random = ledger.random(0x45);
    let greys: Vec<[f32; 3]> = (0..4000).map(|_| [random.magnitude(1e-6, 6e4) as f32; 3]).collect();
    for amount in [0.1, 0.5, 0.77, 1.0] {
        let same = apply(PostEffect::Grayscale { amount }, &greys);
        let drift = greys
            .iter()
            .zip(&same)
            .flat_map(|(x, y)| y.map(|y| (f64::from(y) / f64::from(x[0]) - 1.0).abs()));
        ledger.at_most(
            &format!("amount {amount}"),
            "drift of grey in u",
            drift.collect::<Worst>().largest() / U,
            2.0,
        );
    }
    let white = apply(PostEffect::Grayscale { amount: 1.0 }, &[[1.0; 3]])[0];
    let is_white = white.iter().all(|y| (255.0 * encode(f64::from(*y)) + 0.5).floor() == 255.0);
    ledger.holds("", "white is not 255", is_white);
    let colors: Vec<[f32; 3]> =
        (0..4000).map(|_| [(); 3].map(|()| random.between(0.0, 2.0) as f32)).collect();
    let mixed = apply(PostEffect::Grayscale { amount: 1.0 }, &colors);
    let tinted = mixed.iter().filter(|[r, g, b]| r != g || g != b).count();
    ledger.none_of("", "tinted greys", tinted, mixed.len());
    let worst = colors.iter().zip(&mixed).map(|(c, y)| {
        let [r, g, b] = c.map(f64::from);
        (f64::from(y[0]) - (0.2126 * r + 0.7152 * g + 0.0722 * b)).abs()
    });
    ledger.at_most("luminance", "difference from f64", worst.collect::<Worst>().largest(), 2.0 * 4.0 * U);
}

pub fn a_colour_matrix_adds_its_last_column(ledger: &mut Ledger) {
    let mut random = ledger.random(0x3a);
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
    ledger.at_most(
        "colour matrix",
        "difference from f64",
        worst.collect::<Worst>().largest(),
        (12.0 + 3.0 * 14.0) * U,
    );
}
