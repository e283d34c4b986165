use super::*;
use crate::math::{Projection, View};
use crate::pipeline::geometry::bin::TileGrid;
use crate::pipeline::samples;
use crate::pipeline::tiles::cover::{BlockDepths, IdTarget, cover};
use crate::plan::Elisions;
use glam::DVec3;
use proptest::prelude::*;

const SIDE: usize = 64;

/// A picture of one tile that it does not fill.
fn grid(samples: u32) -> TileGrid {
    let view = View {
        eye: DVec3::ZERO,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Orthographic,
        scale: [256.0; 2],
        near: 1.0,
        far: 2.0,
        width: 40,
        height: 24,
    };
    TileGrid::new(&view, 6, samples::pattern(samples))
}

/// Sets up, draws and collects triangles, each of the draw that it names.
fn collect(triangles: Vec<Triangle>, samples: u32) -> (Bins, Visibility, Fragments) {
    let mut chunk = Chunk::default();
    chunk.triangles = triangles;
    let list: Vec<Entry> = (0..).take(chunk.triangles.len()).map(|i| (0, i)).collect();
    let bins = Bins::new(grid(samples), vec![chunk], Elisions::ALL);
    let region = Region::of_tile(&bins.grid, 0, 0);
    let (mut seen, mut blocks) = (Visibility::default(), BlockDepths::default());
    seen.clear(SIDE, samples as usize);
    blocks.clear(SIDE);
    for (t, id) in bins.chunks[0].triangles.iter().zip(1..) {
        let mut target = IdTarget { samples: &mut seen, id };
        dispatch!(Level::new(), simd => {
            cover(simd, t, &region, SIDE, samples::pattern(samples), &mut blocks, &mut target);
        });
    }
    let nearest = samples::nearest_to_centre(samples);
    let order = SampleOrder { pattern: samples::pattern(samples), nearest: &nearest };
    let mut fragments = Fragments::default();
    fragments.collect(Level::new(), &seen, &region, SIDE, &order, &list, &bins);
    (bins, seen, fragments)
}

fn pile() -> impl Strategy<Value = Vec<Triangle>> {
    let corner = [-8000..8000i32, -5000..5000i32];
    let one = ([corner.clone(), corner.clone(), corner], 0.1f64..1.0, 0u32..4);
    prop::collection::vec(one, 0..25).prop_map(|all| {
        all.into_iter()
            .filter_map(|(corners, depth, draw)| Triangle::set(corners, [depth; 3], draw))
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn every_triangle_that_a_pixel_sees_is_one_fragment(
        pile in pile(), samples in prop::sample::select(&[1u32, 2, 4, 8, 16])
    ) {
        let (bins, seen, fragments) = collect(pile, samples);
        let mut expected = Vec::new();
        for pixel in (0..24).flat_map(|y| (0..40).map(move |x| y * SIDE + x)) {
            let mut ids: Vec<u32> = (0..samples as usize).map(|s| seen.id[s * SIDE * SIDE + pixel]).collect();
            ids.sort_unstable();
            ids.dedup();
            expected.extend(ids.into_iter().filter(|&id| id != 0).map(|id| (id, pixel)));
        }
        expected.sort_unstable();

        let mut found = Vec::new();
        for run in &fragments.runs {
            let visible = &fragments.visible[run.first[0]..run.end[0]];
            prop_assert!(visible.is_sorted_by(|a, b| a < b));
            for fragment in &fragments.sorted[run.first[1]..run.end[1]] {
                let id = visible[fragment.record as usize];
                let t = &bins.chunks[0].triangles[id as usize - 1];
                prop_assert_eq!(t.draw, run.draw);
                prop_assert!(contains(t, [fragment.x, fragment.y]), "a shading point lies outside");
                let [x, y] = [fragment.x - bins.grid.origin[0], fragment.y - bins.grid.origin[1]].map(|c| c >> 8);
                found.push((id, usize::try_from(y).unwrap() * SIDE + usize::try_from(x).unwrap()));
            }
        }
        prop_assert_eq!(fragments.runs.last().map_or(0, |run| run.end[1]), fragments.sorted.len());
        prop_assert!(fragments.runs.is_sorted_by(|a, b| a.draw < b.draw));
        found.sort_unstable();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn masks_of_a_shared_pixel_are_its_covered_samples_once_each(
        pile in pile(), samples in prop::sample::select(&[2u32, 4, 8, 16])
    ) {
        let (_, seen, fragments) = collect(pile, samples);
        for shared in &fragments.shared {
            let masks = &fragments.masks[shared.first as usize..][..shared.count as usize];
            let covered = (0..samples as usize)
                .filter(|s| seen.id[s * SIDE * SIDE + shared.pixel as usize] != 0)
                .fold(0u16, |mask, s| mask | 1 << s);
            prop_assert_eq!(masks.iter().fold(0, |all, mask| all | mask), covered);
            let bits: u32 = masks.iter().map(|mask| mask.count_ones()).sum();
            prop_assert_eq!(bits, covered.count_ones());
            let open = covered.count_ones() < samples;
            prop_assert_eq!(fragments.sky.contains(&shared.pixel), open);
        }
    }
}

#[test]
fn a_pixel_without_any_surface_is_sky() {
    let (_, _, fragments) = collect(Vec::new(), 4);
    assert!(fragments.sorted.is_empty() && fragments.shared.is_empty());
    assert_eq!(fragments.sky.len(), 40 * 24);
}
