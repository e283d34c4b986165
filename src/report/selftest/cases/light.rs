//! Highlights of every sharpness, and lights that are too close, too bright or too many.

use super::interpolated::{corners, document, shaded, weights};
use crate::limits::Limits;
use crate::pipeline::geometry::setup::{NOT_CLIPPED, Triangle};
use crate::plan::Elisions;
use crate::plan::FrameRequest;
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::{plan, scene};
use crate::report::selftest::instruments::worst::Worst;
use crate::scene::{Document, Files, SceneError, compile};
use glam::DVec3;
use serde_json::{Value, json};

/// The light of these scenes travels this way.
const DIRECTION: DVec3 = DVec3::new(-0.6, -0.5, -0.7);

/// Half-way between the light and a viewer at zero.
fn half(position: DVec3) -> DVec3 {
    (-DIRECTION.normalize() - position.normalize()).normalize()
}

/// Triangles whose normals follow the half vector, `off` from it, and nothing but a highlight on them.
fn glossy(random: &mut Random, shininess: f64, off: f64) -> (Vec<DVec3>, Vec<DVec3>, Value) {
    let positions: Vec<DVec3> = (0..1500).flat_map(|_| corners(random, 1.5, 60.0)).collect();
    let normals: Vec<DVec3> = positions
        .iter()
        .map(|p| (half(*p) + random.direction() * random.between(0.0, off)).normalize())
        .collect();
    let mut document =
        document(&positions, json!({ "normals": normals.iter().map(|n| n.to_array()).collect::<Vec<_>>() }));
    document["materials"]["m"] =
        json!({ "diffuse": [0, 0, 0], "specular": [1, 1, 1], "shininess": shininess, "double_sided": true });
    document["lights"] = json!({ "sun": { "type": "directional", "direction": DIRECTION.to_array() } });
    document["environment"] = json!({ "ambient": [0, 0, 0] });
    (positions, normals, document)
}

/// What the corners' `values` are at a point of a triangle, in perspective.
fn interpolated(t: &Triangle, point: [i32; 2], positions: &[DVec3], values: &[DVec3]) -> DVec3 {
    assert_eq!(t.clipped, NOT_CLIPPED);
    let corner = t.corners().map(|c| 3 * t.source as usize + c);
    let e = weights(t, point);
    let share = [0, 1, 2].map(|i| e[i] as f64 / -positions[corner[i]].z);
    (0..3).map(|i| values[corner[i]] * share[i]).sum::<DVec3>() / share.iter().sum::<f64>()
}

pub fn b30_a_highlight_of_any_sharpness_is_right_to_a_fraction_of_its_peak(ledger: &mut Ledger) {
    for (shininess, bound) in [(1.0, 2e-5), (10.0, 2e-5), (1e2, 2e-5), (1e3, 1e-4), (1e4, 1e-4), (1e5, 1e-3)]
    {
        let mut random = ledger.random(0xb30);
        let (positions, normals, document) = glossy(&mut random, shininess, 3.0 / shininess.sqrt().max(3.0));
        let plan = plan(&scene(&document), &FrameRequest::default());
        let (mut worst, mut bright) = (Worst::default(), 0);
        shaded(&plan, &mut random, |t, point, radiance| {
            let normal = interpolated(t, point, &positions, &normals).normalize();
            let position = interpolated(t, point, &positions, &positions);
            // A back that is seen is lit from its own side.
            let normal = if t.is_back() { -normal } else { normal };
            let lit = normal.dot(-DIRECTION) > 1e-6;
            let lobe = normal.dot(half(position)).max(0.0).powf(shininess);
            let exact = if lit { lobe } else { 0.0 };
            if normal.dot(-DIRECTION).abs() > 1e-6 {
                worst.note((f64::from(radiance[1]) - exact).abs());
                bright += usize::from(exact > 1e-3);
            }
        });
        assert!(bright > 1000, "only {bright} points lie in a highlight");
        let case = format!("exponent {shininess:e}, {bright} points");
        ledger.at_most(&case, "error of the pixel in peaks", worst.largest(), bound);
    }
}

pub fn b30_an_exponent_of_zero_is_one_wherever_there_is_light(ledger: &mut Ledger) {
    let mut random = ledger.random(0x30);
    let (positions, normals, document) = glossy(&mut random, 0.0, 20.0);
    let plan = plan(&scene(&document), &FrameRequest::default());
    let (mut lit, mut unlit, mut wrong) = (0, 0, 0);
    shaded(&plan, &mut random, |t, point, radiance| {
        let normal = interpolated(t, point, &positions, &normals).normalize();
        let cosine = normal.dot(-DIRECTION.normalize()) * if t.is_back() { -1.0 } else { 1.0 };
        if cosine.abs() > 1e-6 {
            let expected = if cosine > 0.0 { 1.0 } else { 0.0 };
            wrong += usize::from(radiance != [expected; 3]);
            *if cosine > 0.0 { &mut lit } else { &mut unlit } += 1;
        }
    });
    assert!(lit > 1000 && unlit > 1000, "{lit} lit, {unlit} not");
    ledger.none_of("exponent 0", "points that are not 1 in light, or 0 without", wrong, lit + unlit);
}

/// A floor below the eye under one point light.
fn floor(light: Value) -> Value {
    json!({
        "camera": { "position": [0, 1, 1], "target": [0, 0, 0] },
        "lights": { "lamp": light },
        "materials": { "m": { "specular": [1, 1, 1], "shininess": 5 } },
        "meshes": { "floor": { "type": "plane", "size": [4, 4] } },
        "instances": { "floor": { "mesh": "floor", "material": "m" } },
        "render": { "width": 64, "height": 64, "samples": 1 },
    })
}

/// B32.
pub fn b32_a_light_at_the_surface_or_beyond_all_brightness_leaves_finite_radiance(ledger: &mut Ledger) {
    let mut random = ledger.random(0xb32);
    for height in [0.0, 1e-300, 1e-30, 1e-12, 1e-6, -1e-6, 1.0, 1e6, 1e30] {
        for intensity in [1.0, 1e18, 1e30, 1e37] {
            for attenuation in [
                json!({}),
                json!({ "constant": 0, "quadratic": 1e-30 }),
                json!({ "constant": 0, "linear": 1e30 }),
            ] {
                // On a point that the picture shows, and on the corner of a triangle.
                for place in [[0.3, -0.2], [2.0, 2.0]] {
                    let document = floor(json!({ "type": "point", "position": [place[0], height, place[1]],
                        "intensity": intensity, "attenuation": attenuation }));
                    let plan = plan(&scene(&document), &FrameRequest::default());
                    let mut beyond = 0;
                    let looked = shaded(&plan, &mut random, |_, _, radiance| {
                        beyond += radiance.iter().filter(|c| !(0.0..=65504.0).contains(*c)).count();
                    });
                    let setting = format!("height {height:e}, intensity {intensity:e}, {attenuation}");
                    ledger.none_of(&setting, "radiance that is not in 0 to 65504", beyond, looked);
                }
            }
        }
    }
}

pub fn b32_a_light_without_intensity_is_left_out(ledger: &mut Ledger) {
    for light in [
        json!({ "type": "point", "position": [0, 1, 0], "intensity": 0 }),
        json!({ "type": "point", "position": [0, 1, 0], "color": [0, 0, 0] }),
        json!({ "type": "directional", "direction": [0, -1, 0], "enabled": false }),
    ] {
        let setting = light.to_string();
        let request = FrameRequest { elide: Some(Elisions::ALL), ..FrameRequest::default() };
        let left = plan(&scene(&floor(light)), &request).lights.len();
        ledger.none_of(&setting, "lights without light that are kept", left, 1);
    }
}

pub fn b32_lights_that_make_no_sense_are_refused_by_name(ledger: &mut Ledger) {
    for (light, pointer) in [
        (json!({ "type": "directional", "direction": [0, 0, 0] }), "/lights/lamp/direction"),
        (
            json!({ "type": "point", "position": [0, 1, 0], "attenuation": { "constant": 0, "linear": 0, "quadratic": 0 } }),
            "/lights/lamp/attenuation",
        ),
        (json!({ "type": "point", "position": [0, 1, 0], "intensity": -1 }), "/lights/lamp/intensity"),
    ] {
        let faults = Document::from_json(&floor(light)).expect_err("it makes no sense");
        let is_named = faults.iter().any(|fault| fault.pointer == pointer);
        ledger.holds(pointer, "bad lights not refused by name", is_named);
    }
}

pub fn b32_as_many_lights_as_the_limit_are_drawn_and_one_more_is_refused(ledger: &mut Ledger) {
    let limits = Limits::default();
    let with = |count: usize| {
        let lights: serde_json::Map<_, _> = (0..count)
            .map(|i| {
                let light =
                    json!({ "type": "point", "position": [i as f64 * 1e-3, 1e-6, 0], "intensity": 1e30 });
                (format!("l{i}"), light)
            })
            .collect();
        let mut document = floor(json!({}));
        document["lights"] = Value::Object(lights);
        Document::from_json(&document).expect("a valid document")
    };
    let compiled = compile(&with(limits.lights), &Files::default(), None, &limits).expect("a scene");
    let plan = plan(&std::sync::Arc::new(compiled.scene), &FrameRequest::default());
    ledger.holds("as many lights as the limit", "lights not drawn", plan.lights.len() == limits.lights);
    let (mut random, mut beyond) = (ledger.random(0x32), 0);
    let looked = shaded(&plan, &mut random, |_, _, radiance| {
        beyond += radiance.iter().filter(|c| !(0.0..=65504.0).contains(*c)).count();
    });
    ledger.none_of("as many lights as the limit", "radiance that is not in 0 to 65504", beyond, looked);
    for count in [limits.lights + 1, 4096] {
        let refused = compile(&with(count), &Files::default(), None, &limits).expect_err("too many lights");
        let SceneError::TooLarge { limit, value, .. } = refused else { panic!("{refused}") };
        let is_said = (limit, value) == (limits.lights as u64, count as u64);
        ledger.holds(&format!("{count} lights"), "numbers of lights not refused", is_said);
    }
}
