//! Shadows of point lights.

use crate::closed_form::{Camera, Ray, hit_box, hit_plane};
use crate::draw::{Picture, plan, scene, work};
use crate::measure::{at_most, none_of};
use crate::random::Random;
use fearless_simd::Level;
use glam::DVec3;
use rasterd::pipeline::shade::BLOCK;
use rasterd::pipeline::shade::varyings::Receivers;
use rasterd::pipeline::shadow::{ShadowMap, render_maps};
use rasterd::plan::FrameRequest;
use serde_json::{Value, json};

/// What a map says of surfaces that face the light, given relative to it.
fn visible(map: &ShadowMap, places: &[DVec3]) -> Vec<f32> {
    let mut all = Vec::new();
    for places in places.chunks(BLOCK) {
        let mut receivers = Receivers::default();
        for (i, place) in places.iter().enumerate() {
            for axis in 0..3 {
                receivers.place[axis][i] = place[axis] as f32;
                receivers.plane[axis][i] = (place[axis] / place.length_squared()) as f32;
            }
        }
        let mut out = [0.5; BLOCK];
        map.visibility(Level::new(), &receivers, u64::MAX, &mut out);
        all.extend_from_slice(&out[..places.len()]);
    }
    all
}

/// Boxes around a lamp at the origin, inside a large room.
fn cage(boxes: &[(DVec3, f64)], shadow: &Value) -> ShadowMap {
    let mut document = json!({
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1] },
        "lights": { "lamp": { "type": "point", "position": [0, 0, 0], "shadow": shadow } },
        "meshes": { "box": { "type": "box" }, "room": { "type": "sphere", "radius": 40 } },
        "materials": { "wall": { "double_sided": true } },
        "instances": { "room": { "mesh": "room", "material": "wall", "casts_shadow": false } },
    });
    for (i, (place, size)) in boxes.iter().enumerate() {
        document["instances"][format!("box {i}")] = json!({ "mesh": "box", "translation": place.to_array(), "scale": size, "rotation_deg": [i, 2 * i, 3 * i] });
    }
    let plan = plan(&scene(&document), &FrameRequest::default());
    render_maps(&plan.shadows, &work()).expect("nobody cancels").remove(0)
}

/// B38: sides without casters are lit, those behind a caster's side too.
#[test]
fn around_a_lamp_only_what_lies_behind_a_caster_is_dark() {
    for filter in ["hard", "pcf", "pcss"] {
        for resolution in [1, 2, 5, 64, 300] {
            let shadow = json!({ "filter": filter, "resolution": resolution });
            let map = cage(&[(DVec3::new(3.0, 0.0, 0.0), 1.5)], &shadow);
            let places = [DVec3::X * 8.0, DVec3::X * -8.0, DVec3::Y * 8.0, DVec3::NEG_Y, DVec3::Z, -DVec3::Z];
            let seen = visible(&map, &places);
            assert!(resolution < 64 || seen[0] == 0.0, "{filter}, {resolution}: {seen:?}");
            assert_eq!(seen[1..], [1.0; 5], "{filter}, {resolution}");
            // Before the caster, next to the light, and at it.
            assert_eq!(visible(&map, &[DVec3::X, DVec3::X * 1e-12, DVec3::ZERO]), [1.0; 3]);
        }
    }
}

/// Where two directions, 2e-6 rad apart, lie.
#[derive(Clone, Copy, Debug)]
enum Pair {
    /// On two sides of the cube.
    AcrossBorder,
    /// On one side, in two columns or rows of texels.
    AcrossTexels,
    /// Anywhere.
    Free,
}

impl Pair {
    /// A pair of random directions, not of unit length.
    fn random(self, rng: &mut Random) -> [DVec3; 2] {
        let mut d = rng.direction();
        let [a, b, c] = [0, 1, 2].map(|i| (rng.below(3) + i) % 3);
        let [a, b, c] = if a != b && b != c && a != c { [a, b, c] } else { [0, 1, 2] };
        let across = match self {
            Self::AcrossBorder => {
                d[b] = d[a].abs().copysign(d[b]);
                d[c] = d[a].abs() * rng.between(-1.0, 1.0);
                DVec3::AXES[a]
            }
            Self::AcrossTexels => {
                // The middle of a side is a border of texels.
                d[a] = 0.0;
                DVec3::AXES[a]
            }
            Self::Free => rng.direction(),
        };
        let step = across * d.length() * 1e-6;
        [d + step, d - step]
    }
}

/// B40: across the border of two sides, visibility changes no more than elsewhere.
#[test]
fn the_sides_of_a_cube_meet_without_a_seam() {
    let mut rng = Random::new("B40", 0x5eed_0b40);
    let boxes: Vec<_> = (0..40).map(|i| (rng.direction() * (2.0 + f64::from(i % 3)), 0.6)).collect();
    for (filter, shadow) in [
        ("hard", json!({ "filter": "hard", "resolution": 256 })),
        ("PCF", json!({ "filter": "pcf", "resolution": 256, "radius": 3 })),
        ("PCSS", json!({ "filter": "pcss", "resolution": 256, "light_radius": 0.1 })),
    ] {
        let map = cage(&boxes, &shadow);
        let mut jumps = |pair: Pair| {
            let places: Vec<DVec3> =
                (0..20_000).flat_map(|_| pair.random(&mut rng)).map(|d| d.normalize() * 20.0).collect();
            let seen = visible(&map, &places);
            let partly = seen.iter().filter(|&&v| v > 0.0 && v < 1.0).count();
            assert!(filter == "hard" || partly > 1000, "{filter}: {partly} in half shadow");
            let jumps = seen.chunks(2).map(|pair| f64::from((pair[0] - pair[1]).abs()));
            let (most, sum) = jumps.fold((0.0f64, 0.0), |(most, sum), jump| (most.max(jump), sum + jump));
            println!("B40 {filter}, {pair:?}: jumps of at most {most:.4}, {:.2e} on average", sum / 2e4);
            (most, sum / 2e4)
        };
        let [border, texels, free] = [Pair::AcrossBorder, Pair::AcrossTexels, Pair::Free].map(&mut jumps);
        at_most(&format!("B40 {filter}"), "largest jump across a border", border.0, texels.0.max(free.0));
        // Forty boxes do not lie evenly: a seam would be many times as much.
        at_most(&format!("B40 {filter}"), "mean jump across a border", border.1, 2.0 * texels.1.max(free.1));
    }
}

/// B33 around a lamp: a lit plane at every slope does not shadow itself.
#[test]
fn a_plane_in_the_light_of_a_lamp_does_not_shadow_itself() {
    for shadow in [
        json!({ "filter": "hard" }),
        json!({ "filter": "pcf", "radius": 1 }),
        json!({ "filter": "pcf", "radius": 4 }),
        json!({ "filter": "pcss" }),
        json!({ "filter": "pcss", "light_radius": 0.5 }),
    ] {
        for resolution in [64, 1024] {
            let (mut shadowed, mut pixels) = (0, 0);
            for slope in super::SLOPES {
                for azimuth in [0.0, 0.7, 4.0] {
                    let mut document = super::lit_plane(slope, azimuth, resolution, &[]);
                    let towards = document["lights"]["sun"]["direction"].clone();
                    let towards = [0, 1, 2].map(|axis| -3.0 * towards[axis].as_f64().expect("a number"));
                    let mut shadow = shadow.clone();
                    shadow["resolution"] = json!(resolution);
                    document["lights"] = json!({ "lamp": { "type": "point", "position": towards, "intensity": 9,
                        "attenuation": { "constant": 1, "quadratic": 0 }, "shadow": shadow } });
                    assert!(!plan(&scene(&document), &FrameRequest::default()).shadows.is_empty());
                    let lit = |shadows: bool| {
                        let mut document = document.clone();
                        document["render"]["shadows"] = json!(shadows);
                        Picture::of(&document)
                    };
                    let (with, without) = (lit(true), lit(false));
                    shadowed += with.pixels.iter().zip(&without.pixels).filter(|(a, b)| a != b).count();
                    pixels += with.pixels.len();
                }
            }
            none_of(&format!("B33 lamp, {shadow}, {resolution} a face"), "shadowed pixels", shadowed, pixels);
        }
    }
}

/// The control of B33 around a lamp.
#[test]
fn without_an_offset_a_plane_shadows_itself_in_the_light_of_a_lamp() {
    for (filter, bias, expected) in [
        ("hard", 0.0, true),
        ("hard", 0.5, true),
        ("hard", 1.0, false),
        ("pcf", 0.0, true),
        ("pcf", 1.0, false),
    ] {
        let mut document = super::lit_plane(75.0, 0.7, 64, &[]);
        let towards = [0, 1, 2]
            .map(|axis| -3.0 * document["lights"]["sun"]["direction"][axis].as_f64().expect("a number"));
        document["lights"] = json!({ "lamp": { "type": "point", "position": towards, "intensity": 50,
            "shadow": { "filter": filter, "resolution": 64, "bias": bias } } });
        let mut without = document.clone();
        without["render"]["shadows"] = json!(false);
        assert_eq!(Picture::of(&document) != Picture::of(&without), expected, "{filter}, bias {bias}");
    }
}

/// B34 around a lamp: against a ray cast to it, beyond the displacement that the bound allows.
#[test]
fn a_box_under_a_lamp_shadows_what_the_lamp_cannot_reach_and_nothing_else() {
    let camera = Camera::perspective([-2.2, 5.2, 3.4], [-0.2, 0.2, -0.3], 60.0, 160, 120);
    let (min, max) = (DVec3::new(-0.5, 0.0, -0.4), DVec3::new(0.4, 1.0, 0.5));
    let lamps = [[1.0, 2.0, 1.0], [-1.5, 1.5, 0.2], [0.05, 3.0, 0.05], [2.0, 0.7, -1.0], [0.8, 1.4, -0.9]];
    for (i, lamp) in lamps.into_iter().enumerate() {
        for resolution in [256, 1024] {
            let document = json!({
                "camera": camera.document(),
                "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#00f" } },
                "lights": { "lamp": { "type": "point", "position": lamp, "intensity": 1e6,
                    "shadow": { "filter": "hard", "resolution": resolution } } },
                "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
                "meshes": { "box": { "type": "box", "size": (max - min).to_array() },
                    "floor": { "type": "plane", "size": [8, 8] } },
                "instances": {
                    "box": { "mesh": "box", "material": "white", "translation": ((min + max) / 2.0).to_array() },
                    "floor": { "mesh": "floor", "material": "white" },
                },
                "render": camera.render(1),
            });
            let lamp = DVec3::from(lamp);
            // On the floor: whether the box lies before it, and whether the lamp is seen.
            let at = |ray: Ray| hit_plane(ray, DVec3::ZERO, DVec3::Y).map(|s| (s, ray.at(s)));
            let reaches = |p: DVec3| {
                let direction = lamp - p;
                hit_box(Ray { origin: p, direction }, min, max).is_none_or(|s| s >= 1.0)
            };
            let (mut acne, mut leaks, mut lit, mut dark) = (0, 0, 0, 0);
            for (x, y, pixel) in Picture::of(&document).iter() {
                let on_floor = |ray: Ray| {
                    at(ray).is_some_and(|(s, p)| {
                        p.abs().max_element() < 3.9 && hit_box(ray, min, max).is_none_or(|b| b > s)
                    })
                };
                if camera.steady(x, y, 0.5, on_floor) != Some(true) {
                    continue;
                }
                let (_, p) = at(camera.centre(x, y)).expect("on the floor");
                // 2√2 · ½ texel across the light, on the floor; a texel is 2 w / resolution.
                let towards = lamp - p;
                let texel = 2.0 * towards.abs().max_element() / f64::from(resolution) * 1.05;
                let apart = std::f64::consts::SQRT_2 * texel * towards.length() / towards.y + 1e-3;
                let around = |k: u32| {
                    let angle = f64::from(k) * std::f64::consts::TAU / 16.0;
                    p + DVec3::new(angle.cos(), 0.0, angle.sin()) * apart * f64::from(1 + k % 2) / 2.0
                };
                let here = reaches(p);
                if !(0..16).all(|k| reaches(around(k)) == here) {
                    continue;
                }
                if here {
                    lit += 1;
                    acne += usize::from(pixel[0] == 0);
                } else {
                    dark += 1;
                    leaks += usize::from(pixel[0] != 0);
                }
            }
            let case = format!("B34 box under lamp {i}, {resolution} a face");
            none_of(&case, "dark pixels in the light", acne, lit);
            none_of(&case, "lit pixels in the shadow", leaks, dark);
        }
    }
}
