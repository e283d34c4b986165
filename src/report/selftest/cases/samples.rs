//! Several samples a pixel (B11, B12).

use crate::math::View;
use crate::model::Shading;
use crate::pipeline::geometry::setup::Triangle;
use crate::pipeline::samples;
use crate::pipeline::shade::BLOCK;
use crate::pipeline::shade::varyings::{self, Records, Source, Varyings};
use crate::pipeline::tiles::Scratch;
use crate::pipeline::tiles::cover::Region;
use crate::pipeline::tiles::fragments::{Fragments, SampleOrder, triangle};
use crate::plan::{Item, Spared, Surface};
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::level;
use crate::report::selftest::instruments::oracle::coverage;
use crate::report::selftest::instruments::stage::*;
use crate::report::selftest::instruments::worst::{U, Worst};
use glam::{DVec3, Vec3};

/// Radius in pixels of the disc in which edge pixels are looked at: seen from each of them, all
/// directions and offsets of the edges are equally likely.
const DISC: f64 = 24.0;

/// The exact part of a pixel that lies on the inside of a half-plane: `a·x + b·y + c ≥ 0` over the
/// unit square.
fn exact_coverage(a: f64, b: f64, c: f64) -> f64 {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut kept = Vec::new();
    for i in 0..4 {
        let (p, q) = (corners[i], corners[(i + 1) % 4]);
        let value = |p: [f64; 2]| a * p[0] + b * p[1] + c;
        let (v, w) = (value(p), value(q));
        if v >= 0.0 {
            kept.push(p);
        }
        if (v >= 0.0) != (w >= 0.0) {
            let t = v / (v - w);
            kept.push([0, 1].map(|axis| p[axis] + (q[axis] - p[axis]) * t));
        }
    }
    let shoelace = |i: usize| {
        let (p, q) = (kept[i], kept[(i + 1) % kept.len()]);
        p[0] * q[1] - q[0] * p[1]
    };
    (0..kept.len()).map(shoelace).sum::<f64>().abs() / 2.0
}

/// The edge of a set-up triangle that runs through the picture, as `a·x + b·y + c` with x, y in
/// pixels from the picture's centre; positive inside.
fn inner_edge(t: &Triangle) -> [f64; 3] {
    let corner = |i: usize| [t.x[i % 3], t.y[i % 3]].map(|c| f64::from(c) / 256.0);
    let lines = [0, 1, 2].map(|i| {
        let (p, q) = (corner(i), corner(i + 1));
        let (a, b) = (p[1] - q[1], q[0] - p[0]);
        let length = a.hypot(b);
        [a / length, b / length, -(a * p[0] + b * p[1]) / length]
    });
    let nearest = lines.into_iter().min_by(|l, m| l[2].abs().total_cmp(&m[2].abs()));
    nearest.expect("a triangle has edges")
}

/// Root mean square error of the covered share of the samples over all edge pixels of many random
/// half-planes.
fn coverage_rmse(ledger: &mut Ledger, samples: u32) -> f64 {
    let mut rng = ledger.random(0x11 + u64::from(samples));
    let view = flat_view(64, 64);
    let (mut sum, mut count) = (0.0, 0u32);
    for plane in 0..2000 {
        let angle = rng.between(0.0, std::f64::consts::TAU);
        let offset = rng.between(-DISC - 1.0, DISC + 1.0);
        let (sin, cos) = angle.sin_cos();
        // The inside lies along (cos, sin) from a long edge through `offset`.
        let at = |along: f64, across: f64| {
            let (x, y) = (cos * (offset + across) - sin * along, sin * (offset + across) + cos * along);
            on_screen([x * 256.0, y * 256.0], 0.5)
        };
        let triangle = [at(-3000.0, 0.0), at(3000.0, 0.0), at(0.0, 3000.0)];
        let bins = bins(two_sided(soup(&[triangle])), &view, samples);
        let seen = visible(&bins, samples);
        if plane < 60 {
            let exact = coverage::seen(&bins, &view, samples);
            ledger.holds(&format!("{samples} samples"), "masks unlike O1", seen == exact);
        }
        let [a, b, c] = inner_edge(triangles(&bins).next().expect("it is drawn"));
        for pixel in 0..64 * 64 {
            let corner = [pixel % 64, pixel / 64].map(|c| f64::from(c) - 32.0);
            if (corner[0] + 0.5).hypot(corner[1] + 0.5) > DISC {
                continue;
            }
            let exact = exact_coverage(a, b, a * corner[0] + b * corner[1] + c);
            if exact > 0.0 && exact < 1.0 {
                let at = pixel as usize * samples as usize;
                let ids = &seen.id[at..at + samples as usize];
                let covered = ids.iter().filter(|&&id| id != 0).count() as f64 / f64::from(samples);
                sum += (covered - exact).powi(2);
                count += 1;
            }
        }
    }
    (sum / f64::from(count)).sqrt()
}

pub fn b11_masks_are_exact_and_edges_as_smooth_as_the_pattern_allows(ledger: &mut Ledger) {
    let expected = [(1, 0.246), (2, 0.161), (4, 0.092), (8, 0.057), (16, 0.044)];
    for (samples, expected) in expected {
        let rmse = coverage_rmse(ledger, samples);
        let case = format!("{samples} samples");
        ledger.at_most(&case, "RMSE off its expectation, relative", (rmse / expected - 1.0).abs(), 0.03);
    }
}

/// Checks every fragment of a frame: each interpolated colour lies between those of its triangle's
/// corners. Returns the largest excess in u, relative to the largest colour of the triangle.
fn worst_excess(item: &Item, view: &View, samples: u32) -> (Worst, usize) {
    let surface = Surface {
        shading: Shading::VertexColor,
        diffuse: Vec3::ONE,
        ambient: None,
        emissive: Vec3::ZERO,
        specular: None,
        diffuse_map: None,
        emissive_map: None,
        relief: None,
        alpha: None,
        vertex_colors: true,
        lit: false,
        receives_shadow: false,
        periodic_uv: false,
        spared: Spared::default(),
    };
    let source = Source::new(item, &surface, &[], view, DVec3::ZERO);
    let nearest = samples::nearest_to_centre(samples);
    let order = SampleOrder { pattern: samples::pattern(samples), nearest: &nearest };
    let bins = bins(item.clone(), view, samples);
    let (mut scratch, mut fragments) = (Scratch::default(), Fragments::default());
    let side = 1 << bins.grid.tile_shift;
    let (mut worst, mut checked) = (Worst::default(), 0);
    for tile in 0..bins.grid.tiles() {
        let place = [tile % bins.grid.columns, tile / bins.grid.columns];
        let region = Region::of_tile(&bins.grid, place[0], place[1]);
        scratch.find_visible(level(), &bins, place, samples);
        let level = level();
        fragments.collect(level, scratch.visibility(), &region, side, &order, scratch.list(), &bins);
        let mut records = Records::new(&source);
        let drawn = fragments.visible.iter().map(|&id| triangle(scratch.list()[id as usize - 1], &bins));
        let drawn: Vec<_> = drawn.collect();
        drawn.iter().for_each(|&visible| records.push(&source, visible));
        for block in fragments.sorted.chunks(BLOCK) {
            let mut varyings = Varyings::default();
            varyings::interpolate(level, &records, &source, block, &mut varyings);
            for (i, fragment) in block.iter().enumerate() {
                let corners = item.mesh.triangles[drawn[fragment.record as usize].1.source as usize];
                let colors = item.mesh.colors.as_ref().expect("it has colours");
                for (channel, color) in varyings.color.iter().enumerate() {
                    let of = |v: u32| f64::from(colors[v as usize][channel]);
                    let all = corners.map(of);
                    let (low, high) = (
                        all.iter().copied().fold(f64::MAX, f64::min),
                        all.iter().copied().fold(0.0, f64::max),
                    );
                    let value = f64::from(color[i]);
                    assert!(value.is_finite());
                    let excess = (low - value).max(value - high).max(0.0);
                    worst.note(excess / high / U);
                    checked += 1;
                }
            }
        }
    }
    (worst, checked)
}

pub fn b12_attributes_stay_between_those_of_the_corners(ledger: &mut Ledger) {
    for samples in [1, 2, 4, 8, 16] {
        let mut rng = ledger.random(0x12 + u64::from(samples));
        let view = perspective_view(200, 150, 0.8, 0.25);
        let corners: Vec<_> = (0..900)
            .map(|i| {
                // Small and large, some thin, some reaching behind the eye, w ratios to 10⁶.
                let reach = [3.0, 30.0, 300.0, 20_000.0][i / 3 % 4] * 256.0;
                let middle = if i / 3 % 4 < 2 {
                    [f64::from(i as u32 / 3 % 20) * 10.0 - 100.0, f64::from(i as u32 / 60) * 10.0 - 75.0]
                } else {
                    [0.0; 2]
                };
                let screen = middle.map(|c| c * 256.0 + rng.between(-reach, reach));
                let w = view.near * rng.magnitude(1.0, 1e6);
                at_distance(&view, screen, if i % 31 == 0 { -w } else { w })
            })
            .collect();
        let mut soup = mesh(&corners, (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
        let color =
            |rng: &mut Random| Vec3::from_array([0; 3].map(|_| rng.between(0.0, 1.0).powi(4) as f32 + 1e-3));
        soup.colors =
            Some((0..900).map(|i| if i / 3 % 5 == 0 { Vec3::splat(0.7) } else { color(&mut rng) }).collect());
        let (worst, checked) = worst_excess(&two_sided(soup), &view, samples);
        assert!(checked > 30_000, "{checked} values are too few to show anything");
        ledger.at_most(
            &format!("{samples} samples"),
            "beyond the corners' values in u",
            worst.largest(),
            4.0,
        );
    }
}
