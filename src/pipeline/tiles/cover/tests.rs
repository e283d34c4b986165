use super::*;
use crate::pipeline::samples;
use proptest::prelude::*;

const SIDE: usize = 64;
const PATTERNS: [u32; 5] = [1, 2, 4, 8, 16];

fn region() -> Region {
    Region { origin: [-128 * 256, 64 * 256], size: [SIDE, 51] }
}

/// Counts what covers each sample.
struct Counter(Vec<u32>);

impl<S: Simd> Target<S> for Counter {
    fn test_and_write(&mut self, _: S, at: usize, mask: mask32x8<S>, _: f32x8<S>) {
        for lane in 0..LANES {
            self.0[at + lane] += u32::from(mask.to_bitmask() >> lane & 1 == 1);
        }
    }
}

fn triangle(corners: [[i32; 2]; 3], depth: [f64; 3]) -> Option<Triangle> {
    let origin = region().origin;
    Triangle::set(corners.map(|c| [c[0] + origin[0], c[1] + origin[1]]), depth, 0)
}

/// Draws triangles with their ids in the order given; `hierarchy` off forgets it before each.
fn draw(triangles: &[(u32, Triangle)], samples: u32, hierarchy: bool) -> (Vec<u32>, Vec<u32>) {
    let (mut seen, mut blocks) = (Visibility::default(), BlockDepths::default());
    seen.clear(SIDE, samples as usize);
    blocks.clear(SIDE);
    for (id, t) in triangles {
        if !hierarchy {
            blocks.clear(SIDE);
        }
        let mut target = IdTarget { samples: &mut seen, id: *id };
        dispatch!(Level::new(), simd => {
            cover(simd, t, &region(), SIDE, samples::pattern(samples), &mut blocks, &mut target);
        });
    }
    // What lies below the picture is written but never read.
    let in_picture = |i: usize| i / SIDE % SIDE < region().size[1];
    let keep = |(i, value): (usize, u32)| in_picture(i).then_some(value);
    let depth = seen.depth.iter().map(|d| d.to_bits());
    (
        seen.id.iter().copied().enumerate().filter_map(keep).collect(),
        depth.enumerate().filter_map(keep).collect(),
    )
}

/// Triangles in and about the tile; many large, so that the hierarchy has something to hide.
fn pile() -> impl Strategy<Value = Vec<(u32, Triangle)>> {
    let c = prop_oneof![-4000..20_000, -300_000..300_000];
    let corner = [c.clone(), c];
    let depth = prop_oneof![0.0f64..1.0, 0.4..0.6, Just(0.5), Just(1e-9)];
    let one = (
        [corner.clone(), corner.clone(), corner],
        prop_oneof![[depth.clone(), depth.clone(), depth.clone()], depth.prop_map(|d| [d; 3]),],
    );
    prop::collection::vec(one, 1..30).prop_map(|all| {
        let set = all.into_iter().filter_map(|(corners, depth)| triangle(corners, depth));
        // Some twice: equal depths everywhere.
        let mut set: Vec<_> = set.collect();
        set.extend_from_within(..set.len() / 3);
        (1..).zip(set).collect()
    })
}

#[test]
fn a_shared_diagonal_covers_each_sample_once() {
    for shift in 0..256 {
        let [left, top] = [shift, shift * 7 % 256].map(|s| 8 * 256 + s);
        let (right, bottom) = (left + 40 * 256, top + 30 * 256);
        let [a, b, c, d] = [[left, top], [right, top], [right, bottom], [left, bottom]];
        for halves in [[[a, b, c], [a, c, d]], [[a, b, d], [d, b, c]]] {
            for samples in PATTERNS {
                let mut counter = Counter(vec![0; SIDE * SIDE * samples as usize]);
                for half in halves {
                    let t = triangle(half, [0.5; 3]).expect("it has an area");
                    let mut blocks = BlockDepths::default();
                    blocks.clear(SIDE);
                    dispatch!(Level::new(), simd => {
                        cover(simd, &t, &region(), SIDE, samples::pattern(samples), &mut blocks, &mut counter);
                    });
                }
                assert!(counter.0.iter().all(|&n| n <= 1));
                // The rectangle is as many pixels wide and high whatever the shift.
                assert_eq!(counter.0.iter().sum::<u32>(), 40 * 30 * samples);
            }
        }
    }
}

#[test]
fn a_row_of_samples_on_a_border_belongs_to_the_triangle_below_it() {
    // Through the centres of the pixels of row 8: the top edge of the lower triangle.
    let y = 8 * 256 + 128;
    let upper = triangle([[0, y], [8192, y], [4096, 0]], [0.5; 3]).expect("it has an area");
    let lower = triangle([[0, y], [8192, y], [4096, 2 * y]], [0.5; 3]).expect("it has an area");
    let (ids, _) = draw(&[(1, upper), (2, lower)], 1, true);
    assert!(ids[8 * SIDE..8 * SIDE + 32].iter().all(|&id| id == 2));
    assert!(!ids[..8 * SIDE].contains(&2) && ids[..8 * SIDE].contains(&1));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_hierarchy_never_changes_a_sample(pile in pile(), samples in prop::sample::select(&PATTERNS)) {
        prop_assert!(draw(&pile, samples, true) == draw(&pile, samples, false));
    }

    #[test]
    fn the_order_of_drawing_never_changes_a_sample(pile in pile(), samples in prop::sample::select(&PATTERNS)) {
        let mut turned = pile.clone();
        turned.reverse();
        prop_assert!(draw(&pile, samples, true) == draw(&turned, samples, true));
        turned.sort_by_key(|(id, _)| id.wrapping_mul(2_654_435_761));
        prop_assert!(draw(&pile, samples, true) == draw(&turned, samples, true));
    }
}
