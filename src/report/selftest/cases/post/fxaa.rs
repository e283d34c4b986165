//! Anti-aliasing of a finished picture, against true coverage and an f64 version of the algorithm.

use super::{HEIGHT, Planes, WIDTH, largest_difference, map, noise, run, sample};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::work;
use crate::report::selftest::instruments::worst::{U, Worst};
use crate::scene::document::PostEffect;
use std::cell::Cell;

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

pub fn fxaa_brings_slanted_edges_nearer_to_their_coverage(ledger: &mut Ledger) {
    for slope in [0.08, 0.13, 0.3, -0.2] {
        let (hard, covered) = half_plane(slope);
        let planes = vec![hard.clone(), hard.clone(), hard.clone()];
        let drawn = run(&[PostEffect::Fxaa], &planes, &work());
        let error = |of: &dyn Fn(usize) -> f64| {
            let inside = (0..WIDTH * HEIGHT).filter(|i| (8..WIDTH - 8).contains(&(i % WIDTH)));
            inside.map(|i| (of(i) - covered[i]).powi(2)).sum::<f64>().sqrt()
        };
        let (before, after) = (error(&|i| hard[i]), error(&|i| f64::from(drawn[0][i])));
        ledger.at_most(&format!("FXAA, slope {slope}"), "error left", after / before, 0.5);
    }
}

pub fn fxaa_leaves_flat_and_gentle_pictures_alone(ledger: &mut Ledger) {
    let gentle = map(|x, y| 0.3 + 0.002 * x as f64 + 0.003 * y as f64);
    let gentle: Vec<f64> = gentle.into_iter().map(|value| f64::from(value as f32)).collect();
    let planes = vec![gentle.clone(), gentle.clone(), gentle];
    let change = largest_difference(&run(&[PostEffect::Fxaa], &planes, &work()), &planes);
    ledger.at_most("FXAA on a gentle slope", "change", change, 0.0);
}

pub fn fxaa_takes_on_no_black_from_where_nothing_is(ledger: &mut Ledger) {
    // A white half-plane before nothing: premultiplied, so 0 where alpha is.
    let (hard, _) = half_plane(0.13);
    let planes = vec![hard; 4];
    let drawn = run(&[PostEffect::Fxaa], &planes, &work());
    ledger.at_most("FXAA before nothing", "change, least one", largest_difference(&drawn, &planes), 2.0 * U);
}

/// A picture of three equal channels after FXAA, as T. Lottes describes it, pixel by pixel in f64; and
/// whether any decision on the way was so close that f32 may take it otherwise.
fn filtered(picture: &[f64]) -> Vec<(f64, bool)> {
    let luma: Vec<f64> = picture.iter().map(|value| value.sqrt()).collect();
    let at = |x: isize, y: isize| sample(&luma, x, y);
    let places = (0..WIDTH * HEIGHT).map(|i| [i % WIDTH, i / WIDTH].map(usize::cast_signed));
    let filtered = places.map(|[x, y]| {
        let near = Cell::new(false);
        let above = |a: f64, b: f64| {
            near.set(near.get() || (a - b).abs() < 1e-5);
            a >= b
        };
        let value = pixel(&|dx, dy| at(x + dx, y + dy), &|dx, dy| sample(picture, x + dx, y + dy), &above);
        (value, near.get())
    });
    filtered.collect()
}

type Around<'a> = &'a dyn Fn(isize, isize) -> f64;

fn pixel(luma: Around, color: Around, above: &dyn Fn(f64, f64) -> bool) -> f64 {
    let m = luma(0, 0);
    let [n, s, w, e] = [luma(0, -1), luma(0, 1), luma(-1, 0), luma(1, 0)];
    let most = [m, n, s, w, e].into_iter().fold(0.0, f64::max);
    let range = most - [m, n, s, w, e].into_iter().fold(1.0, f64::min);
    if !above(range, (most * 0.125).max(0.0625)) {
        return color(0, 0);
    }
    let [nw, ne, sw, se] = [luma(-1, -1), luma(1, -1), luma(-1, 1), luma(1, 1)];
    let rows = (nw - 2.0 * w + sw).abs() + 2.0 * (n - 2.0 * m + s).abs() + (ne - 2.0 * e + se).abs();
    let columns = (nw - 2.0 * n + ne).abs() + 2.0 * (w - 2.0 * m + e).abs() + (sw - 2.0 * s + se).abs();
    let (across, along) = if above(rows, columns) { ((0, 1), (1, 0)) } else { ((1, 0), (0, 1)) };
    let side = |sign: isize| luma(sign * across.0, sign * across.1);
    let sign = if above((side(-1) - m).abs(), (side(1) - m).abs()) { -1 } else { 1 };
    let other = side(sign);

    let mean = (m + other) / 2.0;
    let follow = |way: isize| {
        for step in 1..=16 {
            let (x, y) = (along.0 * way * step, along.1 * way * step);
            let here = (luma(x, y) + luma(x + across.0 * sign, y + across.1 * sign)) / 2.0 - mean;
            if above(here.abs(), (m - other).abs() / 4.0) || step == 16 {
                above(here, 0.0);
                return (step as f64, here);
            }
        }
        unreachable!("the last step returns")
    };
    let (before, after) = (follow(-1), follow(1));
    let nearer = if before.0 < after.0 { before } else { after };
    let offset = if (nearer.1 < 0.0) != (m < mean) { 0.5 - nearer.0 / (before.0 + after.0) } else { 0.0 };

    let low = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
    let c = ((low - m).abs() / range).min(1.0);
    let share = offset.max((c * c * (3.0 - 2.0 * c)).powi(2) * 0.75);
    color(0, 0) + (color(across.0 * sign, across.1 * sign) - color(0, 0)) * share
}

pub fn fxaa_is_what_is_published(ledger: &mut Ledger) {
    let mut random = ledger.random(0xfa);
    // Edges of every direction, some specks, and flat ground between.
    let (a, b) = (half_plane(0.17).0, half_plane(-1.7).0);
    let specks = &noise(&mut random, 1, 1.0)[0];
    let value = |i: usize| {
        let speck = if specks[i] > 0.95 { 0.3 } else { 0.0 };
        f64::from((0.1 + 0.37 * a[i] + 0.21 * b[i] + speck) as f32)
    };
    let picture: Vec<f64> = (0..WIDTH * HEIGHT).map(value).collect();
    let planes: Planes = vec![picture.clone(); 3];
    let drawn = run(&[PostEffect::Fxaa], &planes, &work());
    let expected = filtered(&picture);
    let clear = expected.iter().zip(&drawn[0]).filter(|((_, close), _)| !close);
    let worst =
        clear.map(|((value, _), drawn)| (value - f64::from(*drawn)).abs()).collect::<Worst>().largest();
    ledger.at_most("FXAA", "difference from f64", worst, 2e-6);
    let changed =
        expected.iter().zip(&picture).filter(|((value, close), own)| !close && value != *own).count();
    assert!(changed > 200, "only {changed} pixels say something");
}
