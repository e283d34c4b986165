use super::*;
use crate::pipeline::samples;
use proptest::prelude::*;

fn grid(size: [u32; 2], tile_shift: u32, samples: u32) -> TileGrid {
    let viewport = Viewport { width: size[0], height: size[1], farthest: 0.0 };
    TileGrid::new(viewport, tile_shift, samples::pattern(samples))
}

fn triangle() -> impl Strategy<Value = [[i32; 2]; 3]> {
    let place = [-40_000..40_000, -30_000..30_000];
    let reach = prop_oneof![Just(300), Just(5000), Just(8_000_000)];
    (place, reach).prop_flat_map(|(place, reach)| {
        let c = -reach..=reach;
        let corner = [c.clone(), c].prop_map(move |d| [place[0] + d[0], place[1] + d[1]]);
        [corner.clone(), corner.clone(), corner]
    })
}

/// Whether a sample is inside or on the border of a triangle.
fn touches_sample(t: &Triangle, p: [i32; 2]) -> bool {
    (0..3).all(|i| {
        let j = (i + 1) % 3;
        let d = |a: i32, b: i32| i64::from(a) - i64::from(b);
        d(t.x[j], t.x[i]) * d(p[1], t.y[i]) - d(t.y[j], t.y[i]) * d(p[0], t.x[i]) >= 0
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_tile_lists_in_order_what_covers_one_of_its_samples(
        corners in prop::collection::vec(triangle(), 1..12), samples in prop_oneof![Just(1u32), Just(4), Just(16)],
    ) {
        let grid = grid([173, 101], 5, samples);
        let (mut chunk, mut pairs, mut all) = (Chunk::default(), Vec::new(), Vec::new());
        for corners in corners {
            let Some(t) = Triangle::set(corners, [0.5; 3], 0) else { continue };
            let kept = chunk.bin(t, &grid, &mut pairs);
            all.push((t, kept.then(|| u32::try_from(chunk.triangles.len() - 1).unwrap())));
        }
        chunk.sort_into_tiles(&grid, &mut pairs);
        prop_assert!(pairs.is_empty());
        let mut listed = 0;
        for (column, row) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (column, row))) {
            let list = chunk.tile(column, row);
            listed += list.len();
            prop_assert!(list.is_sorted_by(|a, b| a < b));
            for (t, index) in &all {
                let covered = (0..32 * 32).any(|i| {
                    let (x, y) = (column * 32 + i % 32, row * 32 + i / 32);
                    x < grid.width && y < grid.height && samples::pattern(samples).iter().any(|offset| {
                        let at = |n: u32, axis: usize| grid.origin[axis] + n.cast_signed() * 256 + offset[axis];
                        touches_sample(t, [at(x, 0), at(y, 1)])
                    })
                });
                let found = index.is_some_and(|index| list.contains(&index));
                prop_assert!(found || !covered, "tile {column}, {row}: {t:?}");
            }
        }
        prop_assert!(listed >= chunk.triangles.len(), "a kept triangle is in no tile");
    }
}

#[test]
fn screen_filling_triangles_take_no_entry_a_tile() {
    let grid = grid([8192, 8192], 5, 16);
    let (mut chunk, mut pairs) = (Chunk::default(), Vec::new());
    let all = Triangle::set([[-4_000_000, -4_000_000], [4_000_000, -4_000_000], [0, 4_000_000]], [0.5; 3], 0);
    for _ in 0..3 {
        assert!(chunk.bin(all.unwrap(), &grid, &mut pairs));
    }
    chunk.sort_into_tiles(&grid, &mut pairs);
    assert_eq!((chunk.tile(0, 0), chunk.tile(255, 255)), (&[0, 1, 2][..], &[0, 1, 2][..]));
    assert!(chunk.offsets.is_empty() && chunk.entries.len() == 3);
}

#[test]
fn an_empty_chunk_lists_nothing_anywhere() {
    let chunk = Chunk::default();
    assert!(chunk.tile(0, 0).is_empty() && chunk.tile(u32::MAX, 7).is_empty());
}

#[test]
fn a_triangle_between_two_samples_is_not_kept() {
    let grid = grid([8, 8], 6, 1);
    let mut chunk = Chunk::default();
    let between = Triangle::set([[2, 2], [100, 10], [50, 120]], [0.5; 3], 0).unwrap();
    assert!(!chunk.bin(between, &grid, &mut Vec::new()));
}
