use super::*;
use crate::pipeline::shadow::depth_map::tests::map_of;
use crate::pipeline::shadow::penumbra::lit_part;
use crate::pipeline::shadow::tests::{Random, with_work};
use glam::Vec3;

const NEAR: f32 = 0.1;

/// Six sides of walls at distances around 2, with patches at 1 and holes; one side is missing.
fn rugged(rng: &mut Random, resolution: u32) -> (CubeMap, Pyramids) {
    let mut sides = [const { None }; 6];
    for side in sides.iter_mut().skip(1) {
        let patch = rng.below(resolution);
        let noise: Vec<f32> = (0..97).map(|_| rng.between(1.95, 2.05)).collect();
        *side = Some(map_of(resolution, |x, y| {
            if x + y < patch {
                0.0
            } else if x > patch && x < patch + 30 && y % 80 < 50 {
                NEAR
            } else {
                NEAR / noise[(x * 31 + y * 17) as usize % 97]
            }
        }));
    }
    let pyramids = with_work(|work| {
        std::array::from_fn(|i| sides[i].as_ref().map(|map| Pyramid::over(map, work).unwrap()))
    });
    let focal_length = float(resolution) * 0.5 - 2.0;
    let lens = Lens { focal_length, near: NEAR, offset: 0.7 / focal_length, clearance: 0.5 / focal_length };
    (CubeMap { sides, resolution, lens, filter: CubeFilter::Hard, elide: Elisions::ALL }, pyramids)
}

/// Somewhere around the light, every third close to where sides meet.
fn receiver(rng: &mut Random, lens: &Lens) -> Receiver {
    let mut direction = Vec3::new(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0), rng.between(-1.0, 1.0));
    if rng.below(3) == 0 {
        direction.y = direction.x * rng.between(0.99, 1.01);
    }
    let place = direction * (rng.between(0.5, 4.0) / direction.abs().max_element());
    let tilt = Vec3::new(rng.between(-0.5, 0.5), rng.between(-0.5, 0.5), rng.between(-0.5, 0.5));
    let normal = place.normalize() + tilt;
    let plane = normal / normal.dot(place);
    let receivers = Receivers {
        place: place.to_array().map(|c| [c; BLOCK]),
        plane: plane.to_array().map(|c| [c; BLOCK]),
    };
    dispatch!(Level::new(), simd => Lifted::load(simd, &receivers, 0, lens).lane(3))
}

#[test]
fn the_pyramids_answer_as_every_tap_would() {
    let mut rng = Random::new(0x5eed_0005);
    let disc = Disc::new(16);
    let (mut lit, mut dark, mut mixed) = (0, 0, 0);
    for resolution in [16, 64, 200, 333] {
        let (map, pyramids) = rugged(&mut rng, resolution);
        let maps = map.maps(&pyramids);
        for _ in 0..4000 {
            let receiver = receiver(&mut rng, &map.lens);
            let largest = if rng.below(3) == 0 { 0.6 } else { 3.0 / map.lens.focal_length };
            let kernel = PcfKernel { tangent: rng.between(0.0, largest), bias: 1.0 }.around(&receiver);
            let taps = dispatch!(Level::new(), simd => lit_part(simd, &maps, &disc, &receiver, &kernel));
            match maps.verdict(&receiver, &kernel, maps.range(&receiver, &kernel)) {
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
    assert!(lit > 1000 && dark > 1000 && mixed > 500, "{lit} {dark} {mixed}");
}

/// B39.
#[test]
fn soft_shadows_are_finite_for_lights_and_searches_of_every_size() {
    let mut rng = Random::new(0x5eed_0006);
    let (map, pyramids) = rugged(&mut rng, 100);
    let (search, filter) = (Disc::new(18), Disc::new(36));
    let mut receivers: Vec<Receiver> = (0..500).map(|_| receiver(&mut rng, &map.lens)).collect();
    // At the light itself, and where its plane meets it.
    let at_light = Receivers::default();
    let grazing = Receivers { place: [[1e-30; BLOCK]; 3], plane: [[1e36; BLOCK]; 3] };
    for odd in [&at_light, &grazing] {
        receivers.push(dispatch!(Level::new(), simd => Lifted::load(simd, odd, 0, &map.lens).lane(0)));
    }
    for light_radius in [1e-30, 0.05, 1.0, 1e30] {
        for search_tangent in [None, Some(0.0), Some(0.1), Some(10.0)] {
            let size = SoftKernel { light_radius, search: search_tangent, bias: 1.0 };
            let light = Soft { maps: map.maps(&pyramids), size: &size };
            for receiver in &receivers {
                let visibility =
                    dispatch!(Level::new(), simd => soft(simd, &light, &search, &filter, receiver));
                assert!((0.0..=1.0).contains(&visibility), "{receiver:?} {size:?}: {visibility}");
            }
        }
    }
}
