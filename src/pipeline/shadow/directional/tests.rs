use super::*;
use crate::pipeline::shadow::depth_map::tests::map_of;
use crate::pipeline::shadow::penumbra::{lit_part, mean_blocker};
use crate::pipeline::shadow::tests::{Random, with_work};

/// A slope, a block above it, blank tiles, and noise.
fn rugged(rng: &mut Random, resolution: u32) -> DirectionalMap {
    let (slope, block) = (rng.between(0.0, 4e-3), rng.below(resolution));
    let noise: Vec<f32> = (0..97).map(|_| rng.between(0.0, 2e-3)).collect();
    let blank = rng.below(resolution);
    let depth = map_of(resolution, |x, y| {
        if x < blank && y < blank {
            0.0
        } else if x > block && x < block + 40 && y % 90 < 50 {
            0.8
        } else {
            0.1 + slope * float(x) + noise[(x * 31 + y * 17) as usize % 97]
        }
    });
    DirectionalMap { depth, filter: MapFilter::Hard, elide: Elisions::ALL }
}

fn receiver(rng: &mut Random, resolution: u32) -> Receiver {
    let side = float(resolution);
    Receiver {
        x: rng.between(-20.0, side + 20.0),
        y: rng.between(-20.0, side + 20.0),
        depth: rng.between(-0.1, 0.9),
        slope: [rng.between(-0.01, 0.01), rng.between(-0.01, 0.01)],
    }
}

#[test]
fn the_pyramid_answers_as_every_tap_would() {
    let mut rng = Random::new(0x5eed_0002);
    let disc = Disc::new(16);
    let (mut lit, mut dark, mut mixed) = (0, 0, 0);
    for resolution in [1, 50, 64, 200, 333] {
        let map = rugged(&mut rng, resolution);
        let pyramid = with_work(|work| Pyramid::over(&map.depth, work).unwrap());
        let maps = map.maps(&pyramid);
        for _ in 0..4000 {
            let receiver = receiver(&mut rng, resolution);
            let largest = if rng.below(3) == 0 { 80.0 } else { 3.0 };
            let radius = [rng.between(0.0, largest), rng.between(0.0, largest)];
            let kernel = Kernel { radius, rise: rng.between(0.0, 0.01) };
            let placed = maps.place(&receiver, kernel);
            let taps = dispatch!(Level::new(), simd => lit_part(simd, &maps, &disc, &receiver, &placed));
            match kernel.verdict(&receiver, maps.range(&receiver, &placed)) {
                Verdict::Lit => {
                    lit += 1;
                    assert_eq!(taps, 1.0, "{receiver:?} {kernel:?}");
                }
                Verdict::Dark => {
                    dark += 1;
                    assert_eq!(taps, 0.0, "{receiver:?} {kernel:?}");
                }
                Verdict::Mixed => mixed += 1,
            }
        }
    }
    println!("lit {lit}, dark {dark}, mixed {mixed}");
    assert!(lit > 1000 && dark > 100 && mixed > 1000, "{lit} {dark} {mixed}");
}

#[test]
fn a_search_that_the_pyramid_ends_would_have_ended_the_same() {
    let mut rng = Random::new(0x5eed_0003);
    let (search, filter) = (Disc::new(18), Disc::new(36));
    let (mut lit, mut dark) = (0, 0);
    for resolution in [64, 200, 333] {
        let map = rugged(&mut rng, resolution);
        let pyramid = with_work(|work| Pyramid::over(&map.depth, work).unwrap());
        let maps = map.maps(&pyramid);
        let per_depth = rng.between(5.0, 60.0);
        let size =
            SoftKernel { per_depth: [per_depth, per_depth * 0.7], rise_per_depth: 0.05, search_radius: None };
        for _ in 0..3000 {
            let receiver = receiver(&mut rng, resolution);
            let kernel = size.kernel(rng.between(0.0, 1.0 - receiver.depth));
            let placed = maps.place(&receiver, kernel);
            dispatch!(Level::new(), simd => {
                let mean = mean_blocker(simd, &maps, &search, &receiver, &placed);
                match kernel.verdict(&receiver, maps.range(&receiver, &placed)) {
                    Verdict::Lit => {
                        lit += 1;
                        assert_eq!(mean, None, "{receiver:?} {kernel:?}");
                    }
                    Verdict::Dark => {
                        dark += 1;
                        let inner = Kernel { radius: kernel.radius.map(|r| r * 0.9), rise: kernel.rise * 0.9 };
                        let inner = maps.place(&receiver, inner);
                        assert!(mean.is_some(), "{receiver:?} {kernel:?}");
                        assert_eq!(lit_part(simd, &maps, &filter, &receiver, &inner), 0.0);
                    }
                    Verdict::Mixed => {}
                }
            });
        }
    }
    println!("lit {lit}, dark {dark}");
    assert!(lit > 300 && dark > 30, "{lit} {dark}");
}

/// B39: what no number can go wrong with.
#[test]
fn soft_shadows_are_finite_for_blockers_and_searches_of_every_size() {
    let mut rng = Random::new(0x5eed_0004);
    let map = rugged(&mut rng, 200);
    let pyramid = with_work(|work| Pyramid::over(&map.depth, work).unwrap());
    let (search, filter) = (Disc::new(18), Disc::new(36));
    let mut receivers: Vec<Receiver> = (0..500).map(|_| receiver(&mut rng, 200)).collect();
    for depth in [-1e30, 0.0, 0.8, 0.800_001, 1.0, 5.0, f32::NAN] {
        receivers.push(Receiver { x: 100.0, y: 20.0, depth, slope: [0.0; 2] });
        receivers.push(Receiver { x: 100.0, y: 20.0, depth, slope: [1e6, -1e6] });
    }
    for per_depth in [0.0, 1e-30, 1.0, 1e6, 1e30] {
        for search_radius in [None, Some(0.0), Some(7.0), Some(1024.0)] {
            let size = SoftKernel { per_depth: [per_depth; 2], rise_per_depth: 0.25, search_radius };
            let light = Soft { maps: map.maps(&pyramid), size: &size };
            for receiver in &receivers {
                let visibility =
                    dispatch!(Level::new(), simd => soft(simd, &light, &search, &filter, receiver));
                assert!((0.0..=1.0).contains(&visibility), "{receiver:?} {size:?}: {visibility}");
            }
        }
    }
}
