//! Shadows of point lights.

use crate::pipeline::shade::BLOCK;
use crate::pipeline::shade::varyings::Receivers;
use crate::pipeline::shadow::{ShadowMap, render_maps};
use crate::plan::{Elisions, FrameRequest};
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::box_on_floor::{BoxOnFloor, Seen};
use crate::report::selftest::instruments::closed_form::{Camera, Ray, hit_box};
use crate::report::selftest::instruments::draw::{Picture, level, plan, scene, work};
use crate::report::selftest::instruments::worst::Worst;
use glam::DVec3;
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
        map.visibility(level(), &receivers, u64::MAX, &mut out);
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
    render_maps(&plan.shadows, Elisions::ALL, &work()).expect("nobody cancels").remove(0)
}

/// B38: sides without casters are lit, those behind a caster's side too.
pub fn around_a_lamp_only_what_lies_behind_a_caster_is_dark(ledger: &mut Ledger) {
    for filter in ["hard", "pcf", "pcss"] {
        for resolution in [1, 2, 5, 64, 300] {
            let shadow = json!({ "filter": filter, "resolution": resolution });
            let map = cage(&[(DVec3::new(3.0, 0.0, 0.0), 1.5)], &shadow);
            let places = [DVec3::X * 8.0, DVec3::X * -8.0, DVec3::Y * 8.0, DVec3::NEG_Y, DVec3::Z, -DVec3::Z];
            let seen = visible(&map, &places);
            let setting = format!("{filter}, {resolution} a face");
            ledger.holds(&setting, "lit behind a caster", resolution < 64 || seen[0] == 0.0);
            let dark = seen[1..].iter().filter(|seen| **seen != 1.0).count();
            ledger.none_of(&setting, "dark where no caster is", dark, 5);
            // Before the caster, next to the light, and at it.
            let before = visible(&map, &[DVec3::X, DVec3::X * 1e-12, DVec3::ZERO]);
            ledger.holds(&setting, "dark before the caster", before == [1.0; 3]);
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
pub fn the_sides_of_a_cube_meet_without_a_seam(ledger: &mut Ledger) {
    const CAGES: u32 = 8;
    const PAIRS: u32 = 10_000;
    for (filter, shadow) in [
        ("hard", json!({ "filter": "hard", "resolution": 256 })),
        ("PCF", json!({ "filter": "pcf", "resolution": 256, "radius": 3 })),
        ("PCSS", json!({ "filter": "pcss", "resolution": 256, "light_radius": 0.1 })),
    ] {
        let mut rng = ledger.random(0x5eed_0b40);
        // One cage has more edges on some borders of sides than in their middles, or fewer.
        let cages: Vec<ShadowMap> = (0..CAGES)
            .map(|_| {
                let boxes: Vec<_> =
                    (0..40).map(|i| (rng.direction() * (2.0 + f64::from(i % 3)), 0.6)).collect();
                cage(&boxes, &shadow)
            })
            .collect();
        let mut jumps = |pair: Pair| {
            let (mut most, mut sum, mut partly) = (Worst::default(), 0.0, 0);
            for map in &cages {
                let places: Vec<DVec3> =
                    (0..PAIRS).flat_map(|_| pair.random(&mut rng)).map(|d| d.normalize() * 20.0).collect();
                let seen = visible(map, &places);
                partly += seen.iter().filter(|&&v| v > 0.0 && v < 1.0).count();
                for pair in seen.chunks(2) {
                    let jump = f64::from((pair[0] - pair[1]).abs());
                    most.note(jump);
                    sum += jump;
                }
            }
            assert!(filter == "hard" || partly > 1000, "{filter}: {partly} in half shadow");
            let (most, mean) = (most.largest(), sum / f64::from(CAGES * PAIRS));
            (most, mean)
        };
        let [border, texels, free] = [Pair::AcrossBorder, Pair::AcrossTexels, Pair::Free].map(&mut jumps);
        ledger.at_most(filter, "largest jump across a border", border.0, texels.0.max(free.0));
        ledger.at_most(filter, "mean jump across a border", border.1, texels.1.max(free.1));
    }
}

/// B33 around a lamp: a lit plane at every slope does not shadow itself.
pub fn a_plane_in_the_light_of_a_lamp_does_not_shadow_itself(ledger: &mut Ledger) {
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
            ledger.none_of(
                &format!("lamp, {shadow}, {resolution} a face"),
                "shadowed pixels",
                shadowed,
                pixels,
            );
        }
    }
}

/// The control of B33 around a lamp.
pub fn without_an_offset_a_plane_shadows_itself_in_the_light_of_a_lamp(ledger: &mut Ledger) {
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
        let acne = Picture::of(&document) != Picture::of(&without);
        ledger.holds(
            &format!("{filter}, bias {bias}"),
            "control: acne other than expected",
            acne == expected,
        );
    }
}

/// How a lamp's map is read.
#[derive(Clone, Copy, Debug)]
enum Reading {
    Hard,
    /// Radius in texels.
    Pcf(f64),
    /// Radius of the lamp in world units.
    Pcss(f64),
}

impl Reading {
    fn shadow(self, resolution: u32) -> Value {
        match self {
            Self::Hard => json!({ "filter": "hard", "resolution": resolution }),
            Self::Pcf(radius) => json!({ "filter": "pcf", "resolution": resolution, "radius": radius }),
            Self::Pcss(radius) => {
                json!({ "filter": "pcss", "resolution": resolution, "light_radius": radius })
            }
        }
    }

    /// How far from the border of a shadow a point of the floor may be anything between light and dark.
    fn reach(self, lamp: DVec3, p: DVec3, setting: &BoxOnFloor) -> f64 {
        let towards = lamp - p;
        // A texel is 2 w / resolution.
        let texel = 2.0 * towards.abs().max_element() / f64::from(setting.resolution) * 1.05;
        let displaced = |k: f64| 2.0 * std::f64::consts::SQRT_2 * (k + 0.5) * texel;
        let across = match self {
            Self::Hard => displaced(0.0),
            Self::Pcf(k) => displaced(k),
            Self::Pcss(radius) => {
                // The widest penumbra is that of the box's nearest point.
                let nearest = (lamp.clamp(setting.min, setting.max) - lamp).length();
                displaced(0.0) + radius * (towards.length() / nearest - 1.0)
            }
        };
        across * towards.length() / towards.y + 1e-3
    }
}

/// The box on its floor under a lamp from where the light comes; turned as it is.
fn under_a_lamp(setting: &BoxOnFloor, reading: Reading) -> Value {
    let mut document = setting.document();
    let at = [0, 1, 2].map(|i| -document["lights"]["sun"]["direction"][i].as_f64().expect("a number"));
    let shadow = reading.shadow(setting.resolution);
    document["lights"] =
        json!({ "lamp": { "type": "point", "position": at, "intensity": 2, "shadow": shadow } });
    document
}

/// Against a ray cast to the lamp: what is lit is wholly lit, what is dark wholly dark.
fn compare_as_cast(ledger: &mut Ledger, case: &str, setting: &BoxOnFloor, reading: Reading) {
    let document = under_a_lamp(setting, reading);
    let mut without = document.clone();
    without["render"]["shadows"] = json!(false);
    let (with, without) = (Picture::of(&document), Picture::of(&without));
    let lamp = -setting.light;
    let reaches = |p: DVec3| {
        let direction = lamp - p;
        hit_box(Ray { origin: p, direction }, setting.min, setting.max).is_none_or(|s| s >= 1.0)
    };
    let (mut acne, mut leaks, mut lit, mut dark) = (0, 0, 0, 0);
    for (x, y, pixel) in with.iter() {
        let on_floor = |ray: Ray| {
            let (seen, p) = setting.seen(ray);
            seen == Seen::Floor && p.abs().max_element() < setting.floor - 0.1
        };
        if setting.camera.steady(x, y, 0.5, on_floor) != Some(true) {
            continue;
        }
        let (_, p) = setting.seen(setting.camera.centre(x, y));
        let apart = reading.reach(lamp, p, setting);
        let around = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
            [0.5, 1.0].map(|part| p + DVec3::new(cos, 0.0, sin) * apart * part)
        };
        let here = reaches(p);
        if !(0..24).flat_map(around).all(|q| reaches(q) == here) {
            continue;
        }
        if here {
            lit += 1;
            acne += usize::from(pixel != without.at(x, y));
        } else {
            dark += 1;
            leaks += usize::from(pixel[0] != 0);
        }
    }
    let case = format!("{case}, {reading:?}, {} a face", setting.resolution);
    ledger.none_of(&case, "pixels in the light that are not wholly lit", acne, lit);
    ledger.none_of(&case, "pixels in the shadow that are not wholly dark", leaks, dark);
}

fn setting(lamp: [f64; 3]) -> BoxOnFloor {
    BoxOnFloor {
        camera: Camera::perspective([-2.2, 5.2, 3.4], [-0.2, 0.2, -0.3], 60.0, 160, 120),
        light: -DVec3::from(lamp),
        ..super::setting()
    }
}

/// B34 around a lamp, beyond the displacement that the bound allows.
pub fn a_box_under_a_lamp_shadows_what_the_lamp_cannot_reach_and_nothing_else(ledger: &mut Ledger) {
    let lamps = [[1.0, 2.0, 1.0], [-1.5, 1.5, 0.2], [0.05, 3.0, 0.05], [2.0, 0.7, -1.0], [0.8, 1.4, -0.9]];
    for (i, lamp) in lamps.into_iter().enumerate() {
        for resolution in [256, 1024] {
            let setting = BoxOnFloor { resolution, ..setting(lamp) };
            compare_as_cast(ledger, &format!("box under lamp {i}"), &setting, Reading::Hard);
        }
    }
}

/// B34 around a lamp.
pub fn filtered_shadows_of_a_lamp_begin_where_a_box_stands_and_walls_do_not_leak(ledger: &mut Ledger) {
    let wall = (DVec3::new(-1.5, 0.0, -0.03), DVec3::new(1.0, 0.8, 0.03));
    let slab = (DVec3::new(-0.6, 0.3, -0.5), DVec3::new(0.5, 0.34, 0.6));
    let block = (setting([1.0; 3]).min, setting([1.0; 3]).max);
    for (name, (min, max), lamp) in [
        ("box", block, [1.0, 2.0, 1.0]),
        ("box", block, [-1.5, 1.5, 0.2]),
        ("box", block, [0.8, 1.4, -0.9]),
        ("thin wall", wall, [0.3, 1.6, 0.9]),
        ("thin wall", wall, [-1.0, 2.0, -0.8]),
        ("slab that floats", slab, [0.4, 1.7, -0.3]),
    ] {
        let setting = BoxOnFloor { min, max, resolution: 1024, ..setting(lamp) };
        for reading in [Reading::Pcf(1.0), Reading::Pcf(4.0), Reading::Pcss(0.02), Reading::Pcss(0.1)] {
            compare_as_cast(ledger, &format!("{name} under a lamp at {lamp:?}"), &setting, reading);
        }
    }
}

const READINGS: [Reading; 3] = [Reading::Hard, Reading::Pcf(3.0), Reading::Pcss(0.05)];

/// B35 around a lamp: each side of its cube in turn looks at the box.
pub fn a_lamp_on_every_axis_throws_the_same_shadow(ledger: &mut Ledger) {
    for turn in super::TURNS {
        for lamp in [[0.0, 2.0, 0.0], [1e-9, 2.0, -1e-9]] {
            let turn = DVec3::from_array(turn.map(f64::from));
            let setting = BoxOnFloor { turn, min: DVec3::new(-0.5, 0.4, -0.4), ..setting(lamp) };
            for reading in READINGS {
                compare_as_cast(ledger, &format!("turned by {turn}, lamp {lamp:?}"), &setting, reading);
            }
        }
    }
}

/// B36: a lamp that is shut in lights nothing outside.
pub fn a_lamp_inside_of_a_caster_leaves_all_else_dark(ledger: &mut Ledger) {
    for reading in READINGS {
        let setting = setting([-0.05, 0.5, 0.1]);
        let picture = Picture::of(&under_a_lamp(&setting, reading));
        // Where the box stands, beyond the bound on a displacement from the light inside.
        let on_floor = |&(x, y, _): &(u32, u32, _)| {
            let (seen, p) = setting.seen(setting.camera.centre(x, y));
            let outside = (p.clamp(setting.min, setting.max) - p).length();
            seen == Seen::Floor && outside > Reading::Pcf(3.0).reach(-setting.light, p, &setting)
        };
        let floor: Vec<_> = picture.iter().filter(on_floor).collect();
        let leaks = floor.iter().filter(|(_, _, pixel)| pixel[0] != 0).count();
        ledger.none_of(&format!("shut in, {reading:?}"), "lit pixels", leaks, floor.len());
    }
}

/// B36: a shade next to a lamp, as small as it is near, darkens what lies below; nearer than 10⁻⁵ of the
/// farthest caster it is none, and the picture that without it.
pub fn a_caster_next_to_a_lamp_shades_unless_it_is_nearer_than_the_near_limit(ledger: &mut Ledger) {
    for reading in READINGS {
        let setting = setting([-1.0, 2.0, 1.0]);
        let without = under_a_lamp(&setting, reading);
        let with = |distance: f64| {
            let mut document = without.clone();
            document["meshes"]["shade"] =
                json!({ "type": "plane", "size": [distance * 20.0, distance * 20.0] });
            document["instances"]["shade"] = json!({ "mesh": "shade", "translation": [-1.0, 2.0 - distance, 1.0], "receives_shadow": false });
            Picture::of(&document)
        };
        let plain = Picture::of(&without);
        // A lamp that is larger than its shade is not hidden by it.
        let hides: &[f64] = if matches!(reading, Reading::Pcss(_)) { &[] } else { &[1e-3, 1e-4] };
        for &distance in hides {
            let lit = with(distance).pixels.iter().filter(|pixel| pixel[0] > 0).count();
            ledger.none_of(
                &format!("shade {distance:e} below, {reading:?}"),
                "lit pixels",
                lit,
                plain.pixels.len(),
            );
        }
        // The search for blockers begins as wide as the near limit demands: other taps find their mean.
        let passed: &[f64] = if matches!(reading, Reading::Pcss(_)) { &[] } else { &[1e-6, 1e-9] };
        for &distance in passed {
            let setting = format!("shade {distance:e} below, {reading:?}");
            ledger.holds(
                &setting,
                "pictures changed by what is nearer than the near limit",
                with(distance) == plain,
            );
        }
    }
}

/// B36 around a lamp.
pub fn flat_and_pointlike_scenes_under_a_lamp_are_lit_and_finite(ledger: &mut Ledger) {
    for reading in READINGS {
        let whole = under_a_lamp(&setting([-1.0, 2.0, 1.0]), reading);
        let cases: [(&str, super::Change); 4] = [
            ("box shrunk to a point", &|d| d["instances"]["box"]["scale"] = json!(0)),
            ("two floors in one plane", &|d| d["instances"]["box"] = d["instances"]["floor"].clone()),
            ("nothing but the floor", &|d| d["instances"] = json!({ "floor": d["instances"]["floor"] })),
            ("a point where the lamp is", &|d| {
                d["instances"]["box"]["scale"] = json!(0);
                d["instances"]["box"]["translation"] = d["lights"]["lamp"]["position"].clone();
            }),
        ];
        for (name, change) in cases {
            let mut document = whole.clone();
            change(&mut document);
            let picture = Picture::of(&document);
            let dark = picture.pixels.iter().filter(|pixel| pixel[..3] == [0; 3]).count();
            ledger.none_of(&format!("{name}, {reading:?}"), "dark pixels", dark, picture.pixels.len());
        }
    }
}

/// B39 around a lamp: lamps of every size, with casters from 10⁻⁶ away.
pub fn soft_shadows_of_lamps_lie_between_light_and_dark_whatever_blocks(ledger: &mut Ledger) {
    let mut rng = ledger.random(0xb39);
    for radius in [0.0, 1e-30, 0.05, 10.0, 1e30] {
        for distance in [1e-6, 1e-3, 1.0, 30.0] {
            let shadow = json!({ "filter": "pcss", "resolution": 64, "light_radius": radius });
            let map = cage(&[(DVec3::X * distance, distance), (DVec3::Y * 3.0, 1.0)], &shadow);
            let mut places = vec![DVec3::ZERO, DVec3::X * distance, DVec3::X * distance * 0.5];
            places.extend((0..500).map(|_| rng.direction() * rng.magnitude(1e-9, 1e9)));
            let seen = visible(&map, &places);
            let beyond = seen.iter().filter(|seen| !(0.0..=1.0).contains(*seen)).count();
            let setting = format!("lamp {radius:e}, caster {distance:e} away");
            ledger.none_of(&setting, "visibilities that are not in 0 to 1", beyond, seen.len());
        }
    }
}
