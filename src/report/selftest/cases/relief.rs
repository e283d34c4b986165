//! Tangent frames for every direction, and maps that change nothing or are steep beyond all reason.

use crate::model::texture::{ColorSpace, Filter, Image, Texture, Wrap};
use crate::pipeline::shade::relief::tilt;
use crate::pipeline::shade::texture::{Coordinates, sample_normals};
use crate::pipeline::shade::{BLOCK, varyings::Varyings};
use crate::plan::Elisions;
use crate::plan::{FrameRequest, Heights, Relief};
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw::{Picture, file, frame, level, plan, png, scene_with};
use crate::report::selftest::instruments::worst::{U, Worst};
use crate::scene::Files;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::sync::Arc;

/// A linear image as a texture.
fn texture(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4], filter: Filter) -> Arc<Texture> {
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y));
    let image = Arc::new(Image { width, height, texels: texels.collect() });
    Arc::new(Texture::new(image, ColorSpace::Linear, filter, [Wrap::Repeat; 2]))
}

/// A normal map of one texel.
fn everywhere(texel: [u8; 3]) -> Relief {
    let [r, g, b] = texel;
    let normal_map = Some(texture(1, 1, |_, _| [r, g, b, 255], Filter::Nearest));
    Relief { tangents: None, normal_map, heights: None }
}

/// A fragment's normal and the directions of u and v there.
type Place = [Vec3; 3];

/// The block's places with their normals tilted.
fn tilted(relief: &Relief, places: &[Place], varyings: &Varyings) -> Vec<DVec3> {
    let axis = |which: usize, c: usize| -> [f32; BLOCK] {
        std::array::from_fn(|i| places[i.min(places.len() - 1)][which][c])
    };
    let vectors = |which: usize| [0, 1, 2].map(|c| axis(which, c));
    let mut varyings = Varyings {
        normal: vectors(0),
        along_u: vectors(1),
        along_v: vectors(2),
        texture: varyings.texture.clone(),
        uv_per_world: varyings.uv_per_world,
        ..Varyings::default()
    };
    tilt(level(), relief, &mut varyings, places.len());
    let at = |i: usize| DVec3::from_array(varyings.normal.map(|axis| f64::from(axis[i])));
    (0..places.len()).map(at).collect()
}

/// Normals in all directions, many close to ±z; directions of u and v in the surface, out of it, at
/// every angle to the normal, mirrored, and none at all.
fn places(random: &mut Random) -> Vec<Place> {
    (0..BLOCK)
        .map(|i| {
            let normal = match i % 3 {
                0 => random.direction(),
                side => {
                    let (r, angle) = (random.magnitude(1e-20, 1e-1), random.between(0.0, 6.3));
                    DVec3::new(r * angle.cos(), r * angle.sin(), if side == 1 { 1.0 } else { -1.0 })
                        .normalize()
                }
            };
            let aside = normal.cross(random.direction()).normalize();
            let along_u = match i / 3 % 6 {
                0 => DVec3::ZERO,
                1 => normal,
                2 => (normal + aside * random.magnitude(1e-8, 1.0)).normalize(),
                3 => (normal * random.between(-0.3, 0.3) + aside).normalize() * random.between(0.5, 1.0),
                _ => aside,
            };
            let along_v = normal.cross(along_u) * if i % 2 == 0 { 1.0 } else { -1.0 };
            [normal, along_u, along_v].map(|v| v.as_vec3())
        })
        .collect()
}

pub fn b28_tangent_frames_are_orthonormal_and_keep_their_handedness_for_all_directions(ledger: &mut Ledger) {
    let mut random = ledger.random(0xb28);
    let (to_u, to_v) = (everywhere([255, 128, 128]), everywhere([128, 255, 128]));
    let (mut worst, mut wrong, mut handed) = (Worst::default(), 0, 0);
    for _ in 0..4000 {
        let places = places(&mut random);
        let at = Varyings::default();
        let (tangents, bitangents) = (tilted(&to_u, &places, &at), tilted(&to_v, &places, &at));
        for (place, (t, b)) in places.iter().zip(tangents.into_iter().zip(bitangents)) {
            let [n, along_u, along_v] = place.map(|v| v.as_dvec3());
            let errors = [t.dot(n), b.dot(n), t.dot(b), t.length() - 1.0, b.length() - 1.0];
            errors.into_iter().for_each(|e| worst.note(e.abs() / U));
            // A degree off the normal, u has a direction; handedness is that of the texture.
            let sine = (along_u - n * n.dot(along_u)).length();
            if sine > 0.02 {
                handed += 1;
                let turned = along_u.cross(along_v).dot(n) < 0.0;
                wrong += usize::from((t.cross(b).dot(n) < 0.0) != turned);
                wrong += usize::from(t.dot(along_u) < sine * 0.999);
            }
        }
    }
    ledger.at_most("tangent frames", "off orthonormal in u", worst.largest(), 4.0);
    ledger.none_of("tangent frames", "turned the wrong way", wrong, handed);
}

/// A19.
pub fn every_code_of_a_normal_map_decodes_exactly(ledger: &mut Ledger) {
    let map = texture(256, 1, |x, _| [x as u8, 255 - x as u8, x as u8, 255], Filter::Nearest);
    for code in 0..=255u8 {
        let u = (f32::from(code) + 0.5) / 256.0;
        let coordinates = Coordinates { uv: [[u; BLOCK], [0.5; BLOCK]], ..Coordinates::default() };
        let mut out = [[f32::NAN; BLOCK]; 4];
        sample_normals(level(), &map, &coordinates, 1, &mut out);
        let exact = |code: u8| (((f64::from(code) - 128.0) / 127.0).max(-1.0)) as f32;
        let is_exact = [out[0][0], out[1][0]] == [exact(code), exact(255 - code)];
        ledger.holds(&format!("code {code}"), "codes not decoded exactly", is_exact);
    }
}

pub fn b29_neutral_texels_leave_the_bits_of_a_normal_whatever_filter_and_level(ledger: &mut Ledger) {
    let mut random = ledger.random(0xb29);
    // One texel differs, far from where the others are read, so that the map is not left out.
    let odd = |x: u32, y: u32| if (x, y) == (40, 40) { [9, 9, 9, 255] } else { [128, 128, 255, 255] };
    for filter in [Filter::Nearest, Filter::Bilinear, Filter::Trilinear] {
        let normal_map = Some(texture(64, 64, odd, filter));
        let map = texture(64, 64, |x, y| if (x, y) == (40, 40) { [0; 4] } else { [77; 4] }, filter);
        let heights = Some(Heights { map, scale: 1e30 });
        let relief = Relief { tangents: None, normal_map, heights };
        for step in [0.0, 1.7 / 64.0, 3.9 / 64.0] {
            let places = places(&mut random);
            // The lower left quarter: rows run down, v runs up.
            let varyings = Varyings {
                texture: Coordinates {
                    uv: [
                        [random.between(0.15, 0.3) as f32; BLOCK],
                        [random.between(0.7, 0.85) as f32; BLOCK],
                    ],
                    per_pixel: [[step; BLOCK], [0.0; BLOCK], [0.0; BLOCK], [step; BLOCK]],
                },
                uv_per_world: [[1.0; BLOCK]; 2],
                ..Varyings::default()
            };
            for (place, normal) in places.iter().zip(tilted(&relief, &places, &varyings)) {
                let [drawn, meant] = [normal.as_vec3(), place[0]].map(|n| n.to_array().map(f32::to_bits));
                ledger.holds(&format!("{filter:?}, step {step}"), "normals that lost a bit", drawn == meant);
            }
        }
    }
}

pub fn b29_heights_of_any_scale_leave_the_normal_finite_and_on_its_side(ledger: &mut Ledger) {
    let mut random = ledger.random(0x29);
    let map = texture(7, 5, |x, y| [(x * 97 + y * 151) as u8, 0, 0, 255], Filter::Trilinear);
    for scale in [1e-30, 0.02, 1e3, 1e30, f32::MAX, -1e30] {
        let relief = |scale| Relief {
            tangents: None,
            normal_map: None,
            heights: Some(Heights { map: map.clone(), scale }),
        };
        let (mut short, mut longest, mut seen) = (Worst::default(), Worst::default(), 0);
        for _ in 0..400 {
            let places = places(&mut random);
            let mut any = |from: f64, to: f64| std::array::from_fn(|_| random.magnitude(from, to) as f32);
            let varyings = Varyings {
                texture: Coordinates {
                    uv: [any(1e-3, 10.0), any(1e-3, 10.0)],
                    per_pixel: [any(1e-9, 1.0), any(1e-9, 1.0), any(1e-9, 1.0), any(1e-9, 1.0)],
                },
                uv_per_world: [any(1e-30, 1e30), any(1e-30, 1e30)],
                ..Varyings::default()
            };
            for (place, normal) in places.iter().zip(tilted(&relief(scale), &places, &varyings)) {
                assert!(normal.is_finite(), "{place:?}");
                longest.note((normal.length() - 1.0).abs() / U);
                short.note(1e-4 - normal.dot(place[0].as_dvec3()));
                seen += usize::from(normal.as_vec3() != place[0]);
            }
        }
        assert!(seen > 0, "nothing was tilted");
        let case = format!("scale {scale:e}");
        // Three roundings in the square, halved by the root, one of the root and one of the quotient.
        ledger.at_most(&case, "length − 1 in u", longest.largest(), 3.5);
        // The steepest slope is 10⁴: the cosine is 10⁻⁴, to 0.2 % and the rounding of a unit vector.
        ledger.at_most(&case, "10⁻⁴ less the cosine to the normal", short.largest(), 1e-6);
    }
}

/// A ball with a shadow on a floor.
fn still(extra: Value) -> Value {
    let mut material = json!({ "diffuse": [0.7, 0.5, 0.4], "specular": [0.4, 0.4, 0.4], "shininess": 20 });
    material.as_object_mut().expect("a map").extend(extra.as_object().expect("a map").clone());
    json!({
        "camera": { "position": [0.8, 1.4, 2.4], "target": [0, 0.3, 0], "fov_y_deg": 40 },
        "lights": { "sun": { "type": "directional", "direction": [-0.7, -1, -0.4],
                             "shadow": { "filter": "hard", "resolution": 256 } } },
        "textures": { "map": { "file": "map.png" } },
        "materials": { "m": material },
        "meshes": { "ball": { "type": "sphere", "segments": 32, "rings": 16 }, "floor": { "type": "plane", "size": [4, 4] } },
        "instances": { "ball": { "mesh": "ball", "material": "m", "translation": [0, 0.5, 0] },
                       "floor": { "mesh": "floor", "material": "m" } },
        "render": { "width": 96, "height": 72 },
    })
}

fn drawn(document: &Value, files: &Files) -> Picture {
    Picture::new(frame(&scene_with(document, files), &FrameRequest::default()))
}

pub fn b29_maps_that_change_nothing_are_left_out_and_no_byte_differs(ledger: &mut Ledger) {
    let flat = file("map.png", png(8, 8, |_, _| [128, 128, 255, 255]));
    let level = file("map.png", png(8, 8, |_, _| [200, 200, 200, 255]));
    let rough = file("map.png", png(8, 8, |x, y| [(x * 30) as u8, (y * 30) as u8, 255, 255]));
    let without = drawn(&still(json!({})), &flat);
    for (case, extra, files) in [
        ("flat normal map", json!({ "normal_map": "map" }), &flat),
        ("constant bump map", json!({ "bump_map": "map", "bump_scale": 5 }), &level),
        ("bump scale 0", json!({ "bump_map": "map", "bump_scale": 0 }), &rough),
    ] {
        let document = still(extra);
        let request = FrameRequest { elide: Some(Elisions::ALL), ..FrameRequest::default() };
        let plan = plan(&scene_with(&document, files), &request);
        let is_left_out = plan.draws.iter().all(|draw| draw.surface.relief.is_none());
        ledger.holds(case, "maps without effect that are kept", is_left_out);
        ledger.holds(case, "pictures that they change", drawn(&document, files) == without);
    }
    // What is left out must be something that shows.
    for extra in [json!({ "normal_map": "map" }), json!({ "bump_map": "map" })] {
        let setting = extra.to_string();
        ledger.holds(
            &setting,
            "control: rough maps that change nothing",
            drawn(&still(extra), &rough) != without,
        );
    }
}

pub fn b28_maps_without_texture_coordinates_draw_something(ledger: &mut Ledger) {
    let rough = file("map.png", png(8, 8, |x, y| [(x * 30) as u8, (y * 30) as u8, 255, 255]));
    let mut document = still(json!({ "normal_map": "map", "bump_map": "map" }));
    document["meshes"]["ball"] =
        json!({ "type": "triangles", "positions": [[-1, 0, 0], [1, 0, 0], [0, 1, 0]] });
    let scene = scene_with(&document, &rough);
    let is_said = scene.warnings.iter().any(|w| w.detail.contains("no texture coordinates"));
    ledger.holds("", "missing texture coordinates unsaid", is_said);
    let picture = drawn(&document, &rough);
    let is_seen = picture.pixels.iter().any(|pixel| pixel[0] > 0);
    ledger.holds("", "nothing drawn without texture coordinates", is_seen);
}
