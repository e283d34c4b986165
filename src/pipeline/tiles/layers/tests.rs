use super::*;
use crate::math::{Projection, View};
use crate::pipeline::geometry::bin::{Chunk, TileGrid};
use crate::pipeline::samples;
use crate::pipeline::tiles::cover::IdTarget;
use crate::plan::Elisions;
use glam::DVec3;
use proptest::prelude::*;

const SIDE: usize = 64;

/// A picture of one tile that it does not fill.
fn bins(triangles: Vec<Triangle>, samples: u32) -> Bins {
    let view = View {
        eye: DVec3::ZERO,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Orthographic,
        scale: [256.0; 2],
        near: 1.0,
        far: 2.0,
        width: 41,
        height: 24,
    };
    let mut chunk = Chunk::default();
    chunk.triangles = triangles;
    let grid = TileGrid::new(&view, 6, samples::pattern(samples));
    Bins::new(grid, vec![chunk], Elisions::ALL)
}

fn pile() -> impl Strategy<Value = Vec<Triangle>> {
    let corner = [-8000..8000i32, -5000..5000i32];
    let depth = prop_oneof![0.1f64..1.0, Just(0.5)];
    let one = ([corner.clone(), corner.clone(), corner], depth);
    prop::collection::vec(one, 1..20).prop_map(|all| {
        all.into_iter().filter_map(|(corners, depth)| Triangle::set(corners, [depth; 3], 0)).collect()
    })
}

/// Draws the first `opaque` triangles and lists what the others cover of a window.
struct Gathered {
    bins: Bins,
    seen: Visibility,
    layers: Layers,
}

fn gather(pile: Vec<Triangle>, opaque: usize, samples: u32, window: Option<Window>) -> Gathered {
    let bins = bins(pile, samples);
    let list: Vec<Entry> = (0..).take(bins.chunks[0].triangles.len()).map(|i| (0, i)).collect();
    let region = Region::of_tile(&bins.grid, 0, 0);
    let (mut seen, mut blocks) = (Visibility::default(), BlockDepths::default());
    seen.clear(SIDE, samples as usize);
    blocks.clear(SIDE);
    for (t, id) in bins.chunks[0].triangles.iter().zip(1..).take(opaque) {
        let mut target = IdTarget { samples: &mut seen, id };
        dispatch!(Level::new(), simd => {
            cover::cover(simd, t, &region, SIDE, samples::pattern(samples), &mut blocks, &mut target);
        });
    }
    let nearest = samples::nearest_to_centre(samples);
    let order = SampleOrder { pattern: samples::pattern(samples), nearest: &nearest };
    let tile = TileList { bins: &bins, list: &list, region: &region, side: SIDE, order: &order };
    let ids: Vec<u32> = (1..).take(list.len()).skip(opaque).collect();
    let mut layers = Layers::default();
    let window = window.unwrap_or(Window::whole(&region));
    let before = Opaque { samples: &seen, blocks: &blocks };
    let tie = AtEqualDepth::Later;
    let taken = layers.gather(Level::new(), &tile, &before, tie, window, &ids, usize::MAX);
    assert_eq!(taken, ids.len());
    Gathered { bins, seen, layers }
}

/// What a layer says: its triangle, its pixel, and bits of the depths of its samples.
type Told = (u32, u16, Vec<(usize, u32)>);

fn told(gathered: &Gathered) -> Vec<Told> {
    let layers = &gathered.layers;
    let samples = |layer: &Layer| layer.samples(layers).map(|(s, depth)| (s, depth.to_bits())).collect();
    layers.list.iter().map(|layer| (layer.id, layer.pixel, samples(layer))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// The same triangle drawn alone as an opaque one says which samples it covers, and how deep.
    #[test]
    fn layers_are_what_triangles_cover_before_what_is_opaque(
        pile in pile(), opaque in 0usize..6, samples in prop::sample::select(&[1u32, 2, 4, 8, 16])
    ) {
        let opaque = opaque.min(pile.len());
        let gathered = gather(pile.clone(), opaque, samples, None);
        let mut expected = Vec::new();
        for (t, id) in pile.iter().zip(1u32..).skip(opaque) {
            let alone = gather(vec![*t], 1, samples, None).seen;
            for pixel in (0..24).flat_map(|y| (0..41).map(move |x| y * SIDE + x)) {
                let at = |s: usize| s * SIDE * SIDE + pixel;
                let is_seen = |&s: &usize| {
                    let (depth, old) = (alone.depth[at(s)], gathered.seen.depth[at(s)]);
                    alone.id[at(s)] != 0 && (depth > old || (depth == old && gathered.seen.id[at(s)] != 0))
                };
                let seen = (0..samples as usize).filter(is_seen).map(|s| (s, alone.depth[at(s)].to_bits()));
                let seen: Vec<_> = seen.collect();
                if !seen.is_empty() {
                    expected.push((id, u16::try_from(pixel).unwrap(), seen));
                }
            }
        }
        let mut found = told(&gathered);
        prop_assert!(found.is_sorted_by_key(|(id, ..)| *id));
        found.sort_unstable();
        prop_assert_eq!(found, expected);
        for layer in &gathered.layers.list {
            prop_assert_eq!(layer.covered & layer.seen, layer.seen);
            for (s, depth) in layer.samples(&gathered.layers) {
                prop_assert_eq!(layer.depth(&gathered.layers, s), depth);
            }
        }
    }

    #[test]
    fn windows_list_each_layer_once(
        pile in pile(), opaque in 0usize..6, samples in prop::sample::select(&[1u32, 4]),
        turns in prop::collection::vec(any::<bool>(), 0..12)
    ) {
        let opaque = opaque.min(pile.len());
        let whole = gather(pile.clone(), opaque, samples, None);
        // From the whole tile down a random path of halves: every half beside it counts.
        let mut window = Window::whole(&Region::of_tile(&whole.bins.grid, 0, 0));
        let mut parts = Vec::new();
        for turn in turns {
            let Some([near, far]) = window.halves() else { break };
            let (down, beside) = if turn { (near, far) } else { (far, near) };
            parts.extend(told(&gather(pile.clone(), opaque, samples, Some(beside))));
            window = down;
        }
        parts.extend(told(&gather(pile, opaque, samples, Some(window))));
        parts.sort_unstable();
        let mut all = told(&whole);
        all.sort_unstable();
        prop_assert_eq!(parts, all);
    }

    #[test]
    fn a_window_touches_what_it_lists(pile in pile(), turns in prop::collection::vec(any::<bool>(), 1..12)) {
        let region = Region::of_tile(&bins(Vec::new(), 4).grid, 0, 0);
        let mut window = Window::whole(&region);
        for turn in turns {
            let Some([near, far]) = window.halves() else { break };
            window = if turn { near } else { far };
        }
        let gathered = gather(pile.clone(), 0, 4, Some(window));
        for layer in &gathered.layers.list {
            prop_assert!(window.touches(&pile[layer.id as usize - 1], &region));
        }
    }
}
