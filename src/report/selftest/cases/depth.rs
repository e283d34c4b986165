//! Depth: near and far surfaces in order, and exact over a triangle however far its corners lie apart
//! (B13 – B15).

use crate::math::View;
use crate::pipeline::geometry::setup::Triangle;
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::closed_form::{Camera, codes_apart};
use crate::report::selftest::instruments::draw::Picture;
use crate::report::selftest::instruments::draw::pool;
use crate::report::selftest::instruments::stage::*;
use crate::report::selftest::instruments::worst::{U, Worst};
use glam::DVec3;
use serde_json::json;

/// Depth of a set-up triangle at a point in sub-pixels: exact integer weights, and a sum of terms
/// that are all positive.
fn exact_depth(t: &Triangle, depth: [f64; 3], p: [i32; 2]) -> f64 {
    let corner = |i: usize| [t.x[i % 3], t.y[i % 3]].map(i128::from);
    let p = p.map(i128::from);
    let side = |i: usize| {
        let (a, b) = (corner(i), corner(i + 1));
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    // Corner i lies opposite to the edge from corner i + 1.
    let weights = [side(1), side(2), side(0)];
    let area: i128 = weights.iter().sum();
    (0..3).map(|i| weights[i] as f64 * depth[i]).sum::<f64>() / area as f64
}

/// Notes the relative error of the depth of every sample of a triangle, in u; and how many it has.
fn note_errors(worst: &mut Worst, view: &View, screen: [[f64; 2]; 3], w: [f64; 3]) -> usize {
    let corners = [0, 1, 2].map(|i| at_distance(view, screen[i], w[i]));
    let bins = bins(two_sided(soup(&[corners])), view, 1);
    assert_eq!(bins.counts.clipped, 0);
    let Some(t) = triangles(&bins).next() else {
        return 0;
    };
    // The distances after the way through the vertex stage are those of the corners: the camera's
    // axes are those of the world.
    let depth = t.corners().map(|corner| view.near / w[corner]);
    let seen = visible(&bins, 1);
    let mut covered = 0;
    for (i, (&id, &drawn)) in seen.id.iter().zip(&seen.depth).enumerate() {
        if id != 0 {
            let (x, y) = (i as u32 % view.width, i as u32 / view.width);
            let p =
                [(x, view.width), (y, view.height)].map(|(c, n)| (c * 256 + 128) as i32 - (n * 128) as i32);
            let exact = exact_depth(t, depth, p);
            worst.note((f64::from(drawn) - exact).abs() / exact / U);
            covered += 1;
        }
    }
    covered
}

fn claim(
    ledger: &mut Ledger,
    setting: &str,
    seed: u64,
    mut make: impl FnMut(&mut Random, &View) -> ([[f64; 2]; 3], [f64; 3]),
) {
    let mut rng = ledger.random(seed);
    let (mut worst, mut covered) = (Worst::default(), 0);
    for _ in 0..300 {
        let view = perspective_view(128, 96, 0.5, 0.25);
        let (screen, w) = make(&mut rng, &view);
        covered += note_errors(&mut worst, &view, screen, w);
    }
    assert!(covered > 2000, "{covered} samples are too few to show anything");
    ledger.at_most(setting, "relative error of the depth in u", worst.largest(), 8.0);
}

fn anywhere(rng: &mut Random, reach: f64) -> [f64; 2] {
    [0; 2].map(|_| rng.between(-reach, reach) * 256.0)
}

pub fn b14_a_triangle_to_1e9_near_distances_keeps_its_depth(ledger: &mut Ledger) {
    claim(ledger, "", 20, |rng, view| {
        let screen = [0; 3].map(|_| anywhere(rng, 300.0));
        (screen, [view.near, view.near * 1e9, view.near * rng.magnitude(1.0, 1e9)])
    });
    claim(ledger, "huge", 21, |rng, view| {
        let screen = [0; 3].map(|_| anywhere(rng, 30_000.0));
        (screen, [view.near, view.near * 1e9, view.near * rng.magnitude(1.0, 1e9)])
    });
}

pub fn b14_any_ratio_of_distances_keeps_its_depth(ledger: &mut Ledger) {
    claim(ledger, "any ratio", 22, |rng, view| {
        let ratio = rng.magnitude(1.0 + 1e-7, 1e12);
        let far = rng.magnitude(1.0, 1e12) * view.near;
        let screen = [0; 3].map(|_| anywhere(rng, 3000.0));
        (screen, [far, far * ratio, far * rng.magnitude(1.0, ratio)])
    });
}

pub fn b14_a_sliver_keeps_its_depth(ledger: &mut Ledger) {
    claim(ledger, "sliver", 23, |rng, view| {
        // A few sub-pixels to a few pixels wide, and through the picture.
        let (angle, reach) = (rng.between(0.0, 7.0), rng.between(100.0, 30_000.0) * 256.0);
        let through = anywhere(rng, 40.0);
        let (sin, cos) = angle.sin_cos();
        let a = [through[0] - cos * reach, through[1] - sin * reach];
        let b = [through[0] + cos * reach, through[1] + sin * reach];
        let width = rng.magnitude(2.0, 2000.0);
        let c = [b[0] + width * sin, b[1] - width * cos];
        let ratio = rng.magnitude(1.0, 1e9);
        let w = [1.0, ratio, rng.magnitude(1.0, ratio)].map(|w| w * view.near);
        let turn = rng.below(3);
        let mut screen = [a, b, c];
        screen.rotate_left(turn);
        (screen, w)
    });
}

/// A long edge that runs exactly through pixel centres, all of it far away, and a near corner hardly
/// beside it: next to the edge the depth is that of its ends, but a plane through the corners gets
/// it as the difference of two numbers that are a billion times as large.
pub fn b14_a_sliver_keeps_its_depth_on_its_own_edge(ledger: &mut Ledger) {
    claim(ledger, "sliver edge", 24, |rng, view| {
        let [p, q] = [rng.below(4) + 1, rng.below(4)].map(|n| n as f64);
        // The edge is a left or top one, so it belongs to the triangle.
        let middle = [0; 2].map(|_| (rng.between(-20.0, 20.0).floor() + 0.5) * 256.0);
        let steps = rng.between(10.0, 5000.0).floor() * 256.0;
        let a = [middle[0] - p * steps, middle[1] + q * steps];
        let b = [middle[0] + p * steps, middle[1] - q * steps];
        let width = rng.magnitude(2.0, 200.0).floor();
        let c = if rng.below(2) == 0 { [b[0] + 3.0, b[1] + width] } else { [a[0] + 3.0, a[1] + width] };
        let far = view.near * rng.magnitude(10.0, 16e6);
        ([a, b, c], [far, far * rng.between(0.9, 1.1), view.near])
    });
}

/// Samples of a picture of 8 × 8 that see a level triangle which fills it at the distance `w`.
fn seen_at(w: f64) -> usize {
    let view = perspective_view(8, 8, 1.0, 1.0);
    let wide = |x: f64, y: f64| DVec3::new(x * w, y * w, -w);
    let triangle = [wide(-4.0, -4.0), wide(8.0, -4.0), wide(-4.0, 8.0)];
    let seen = visible(&bins(two_sided(soup(&[triangle])), &view, 1), 1);
    seen.id.iter().filter(|&&id| id != 0).count()
}

/// What is so far away that its depth rounds to 0 counts as beyond the far plane; one step nearer is
/// drawn, denormal or not. 2⁻¹⁵⁰ lies in the middle between 0 and the least f32, and rounds to even.
///
/// On every worker thread: each has its own way to treat denormals.
pub fn b13_depth_zero_is_beyond_the_far_plane_and_the_least_depth_is_not(ledger: &mut Ledger) {
    let just_before = 2f64.powi(150) * (1.0 - f64::EPSILON);
    let drawn =
        [100, 126, 127, 140, 149].map(|exponent| 2f64.powi(exponent)).into_iter().chain([just_before]);
    let beyond = [150, 151, 160, 400].map(|exponent| 2f64.powi(exponent));
    let expected: Vec<_> = drawn.map(|w| (w, 64)).chain(beyond.map(|w| (w, 0))).collect();
    let wrong = pool(7).broadcast(|_| expected.iter().filter(|(w, samples)| seen_at(*w) != *samples).count());
    ledger.none_of(
        "7 threads",
        "distances drawn or left out wrongly",
        wrong.iter().sum(),
        7 * expected.len(),
    );
}

/// Parallel surfaces, level and tilted: the farther one is the nearer one scaled about the eye, so it
/// covers the same samples and lies behind by the same factor everywhere.
pub fn b13_the_nearer_of_two_surfaces_wins_down_to_a_gap_of_four_roundings(ledger: &mut Ledger) {
    let mut rng = ledger.random(25);
    for (near, far) in [(0.1, 1e4), (1e-3, 1e6), (1e-6, 1e12)] {
        let view = perspective_view(16, 16, 1.0, near);
        for gap in [1e-3, 1e-5, 1e-6, 2f64.powi(-22)] {
            let (mut wrong, mut covered) = (0, 0);
            for i in 0..200 {
                let w = rng.magnitude(near, far);
                let tilt = if i % 2 == 0 { 1.0 } else { 3.0 };
                let ws = [0; 3].map(|_| w * rng.between(1.0, tilt));
                let screen = [0; 3].map(|_| anywhere(&mut rng, 40.0));
                let at = |scale: f64| [0, 1, 2].map(|i| at_distance(&view, screen[i], ws[i] * scale));
                // The farther one goes first, or a tie would go to the right one.
                let seen = visible(&bins(two_sided(soup(&[at(1.0 + gap), at(1.0)])), &view, 1), 1);
                wrong += seen.id.iter().filter(|&&id| id == 1).count();
                covered += seen.id.iter().filter(|&&id| id == 2).count();
            }
            assert!(covered > 5000, "{covered} samples are too few to show anything");
            let case = format!("{near:e} to {far:e}, gap {gap:.1e}");
            ledger.at_most(&case, "ties and swaps", wrong as f64, 0.0);
        }
    }
}

/// Two squares in one plane, cut along different diagonals. Which of them is seen where their depths
/// differ by rounding is nobody's promise; where they are equal the first is, and that is checked
/// against each square alone.
pub fn b15_of_coplanar_squares_the_first_wins_wherever_depths_are_equal(ledger: &mut Ledger) {
    let mut rng = ledger.random(0x15);
    let view = perspective_view(48, 48, 1.0, 0.1);
    let (mut equal, mut speckled, mut wrong) = (0, 0, 0);
    for i in 0..60 {
        // Level ones have equal depths everywhere, tilted ones almost nowhere.
        let tilt = if i % 3 == 0 { 0.0 } else { rng.between(-0.4, 0.4) };
        let size = rng.between(0.5, 1.5);
        let corner = |x: f64, y: f64| DVec3::new(x * size, y * size, -2.0 + x * tilt + y * tilt * 0.7);
        let [a, b, c, d] = [corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)];
        let (first, second) = ([[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]);
        let alone = |square: &[[DVec3; 3]]| visible(&bins(two_sided(soup(square)), &view, 4), 4);
        let (one, other) = (alone(&first), alone(&second));
        let both_bins = bins(two_sided(soup(&[first, second].concat())), &view, 4);
        let both = visible(&both_bins, 4);
        for (at, source) in
            both.sources(&both_bins).into_iter().enumerate().filter(|(_, source)| *source != 0)
        {
            let ahead = one.depth[at] >= other.depth[at];
            equal += usize::from(one.depth[at] == other.depth[at]);
            speckled += usize::from(one.depth[at] != other.depth[at]);
            wrong += usize::from((source <= 2) != ahead);
        }
    }
    assert!(speckled > 1000, "{speckled} samples are too few to show anything");
    ledger.none_of("coplanar squares", "samples that show the wrong one", wrong, equal);
}

/// Two sheets of one depth, the first named first, over a wall; what the middle of the picture shows.
fn sheets(sheets: [([f64; 3], f64); 2]) -> [u8; 4] {
    let camera = Camera::orthographic([0.0, 0.0, 3.0], [0.0; 3], 2.0, 64, 64);
    let material = |(color, opacity): ([f64; 3], f64)| json!({ "shading": "unlit", "diffuse": color, "opacity": opacity });
    let instance = |name: &str| json!({ "mesh": "sheet", "material": name, "rotation_deg": [90, 0, 0] });
    let document = json!({
        "camera": camera.document(),
        "environment": { "background": { "type": "color", "color": WALL } },
        "lights": {},
        "materials": { "a": material(sheets[0]), "b": material(sheets[1]) },
        "meshes": { "sheet": { "type": "plane", "size": [1, 1] } },
        "instances": { "a": instance("a"), "b": instance("b") },
        "render": camera.render(4),
    });
    Picture::of(&document).at(32, 20)
}

const WALL: [f64; 3] = [0.2, 0.3, 0.6];

/// Of two sheets at one depth the one submitted first is composited first.
pub fn b15_layers_of_one_depth_are_composited_in_the_order_of_submission(ledger: &mut Ledger) {
    let over = |(color, opacity): ([f64; 3], f64), behind: DVec3| {
        DVec3::from_array(color) * opacity + behind * (1.0 - opacity)
    };
    let (rose, leaf) = (([0.9, 0.2, 0.3], 0.35), ([0.1, 0.8, 0.2], 0.6));
    let wall = (leaf.0, 1.0);
    for (name, pair, expected) in [
        ("rose, leaf", [rose, leaf], over(leaf, over(rose, WALL.into()))),
        ("leaf, rose", [leaf, rose], over(rose, over(leaf, WALL.into()))),
        ("opaque, blended", [wall, rose], over(rose, wall.0.into())),
        ("blended, opaque", [rose, wall], wall.0.into()),
    ] {
        // Half a code of rounding, and f32's share.
        ledger.at_most(name, "codes of layers at one depth", codes_apart(sheets(pair), expected), 0.51);
    }
}
