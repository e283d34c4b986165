//! Blending and cut-outs against closed forms.

use crate::closed_form::{Camera, Ray, codes_apart, decode, hit_box, hit_plane};
use crate::draw::{Picture, file, frame, output, pick, png, samples, scene, scene_with, values};
use crate::measure::{Worst, at_most, none_of};
use glam::{DVec2, DVec3};
use rasterd::pipeline::samples::pattern;
use rasterd::plan::{FrameRequest, Output};
use serde_json::{Map, Value, json};

/// A colour of the background that is none of any sheet, linear.
const BACK: [f64; 3] = [0.05, 0.3, 0.6];

/// Half a code, and what rounding adds.
const HALF_A_CODE: f64 = 0.5 + 2e-3;

/// A flat sheet that faces along +z.
#[derive(Clone, Copy)]
struct Sheet {
    name: &'static str,
    color: [f64; 3],
    opacity: f64,
    centre: [f64; 3],
}

const SHEETS: [Sheet; 3] = [
    Sheet { name: "rose", color: [0.9, 0.2, 0.3], opacity: 0.35, centre: [0.1, 0.15, 0.5] },
    Sheet { name: "leaf", color: [0.1, 0.8, 0.2], opacity: 0.6, centre: [-0.2, 0.1, 0.2] },
    Sheet { name: "wine", color: [0.4, 0.05, 0.1], opacity: 0.15, centre: [0.0, -0.2, -0.4] },
];

/// Half a sheet's side.
const HALF: f64 = 0.5;

fn camera() -> Camera {
    Camera::orthographic([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 2.0, 64, 64)
}

/// Sheets before a plain background, unlit; each instance is called `prefix + name`.
fn sheets(sheets: &[(String, Sheet)], count: u32) -> Value {
    let (mut materials, mut instances) = (Map::new(), Map::new());
    for (name, sheet) in sheets {
        let material = json!({ "shading": "unlit", "diffuse": sheet.color, "opacity": sheet.opacity });
        materials.insert(name.clone(), material);
        let instance = json!({ "mesh": "sheet", "material": name, "translation": sheet.centre,
            "rotation_deg": [90, 0, 0] });
        instances.insert(name.clone(), instance);
    }
    json!({
        "camera": camera().document(),
        "environment": { "background": { "type": "color", "color": BACK } },
        "lights": {},
        "materials": materials,
        "meshes": { "sheet": { "type": "plane", "size": [2.0 * HALF, 2.0 * HALF] } },
        "instances": instances,
        "render": camera().render(count),
    })
}

fn named(all: &[Sheet]) -> Vec<(String, Sheet)> {
    all.iter().map(|sheet| (sheet.name.to_owned(), *sheet)).collect()
}

fn over(color: [f64; 3], opacity: f64, behind: DVec3) -> DVec3 {
    DVec3::from_array(color) * opacity + behind * (1.0 - opacity)
}

/// Sheets of `all` that a line of sight meets, farthest first.
fn met(all: &[Sheet], ray: Ray) -> Vec<usize> {
    let mut met: Vec<usize> = (0..all.len())
        .filter(|&i| {
            let p = ray.origin - DVec3::from_array(all[i].centre);
            p.x.abs() < HALF && p.y.abs() < HALF
        })
        .collect();
    met.sort_by(|&a, &b| all[a].centre[2].total_cmp(&all[b].centre[2]));
    met
}

#[test]
fn one_two_and_three_layers_are_composited_far_to_near() {
    let camera = camera();
    for count in 1..=3 {
        let all = &SHEETS[..count];
        let picture = Picture::of(&sheets(&named(all), 1));
        let (mut worst, mut deepest) = (Worst::default(), 0);
        for (x, y, pixel) in picture.iter() {
            let Some(met) = camera.steady(x, y, 0.01, |ray| met(all, ray)) else { continue };
            let expected =
                met.iter().fold(BACK.into(), |behind, &i| over(all[i].color, all[i].opacity, behind));
            worst.note(codes_apart(pixel, expected));
            deepest = deepest.max(met.len());
        }
        assert_eq!(deepest, count, "they overlap");
        at_most(&format!("{count} layers"), "largest difference in codes", worst.largest(), HALF_A_CODE);
    }
}

#[test]
fn the_order_of_names_plays_no_part() {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    for count in [1, 4, 16] {
        let mut pictures = orders.map(|order| {
            let all = order.iter().zip(SHEETS).map(|(number, sheet)| (format!("{number}"), sheet));
            let mut document = sheets(&all.collect::<Vec<_>>(), count);
            // Slanted, so that edges lie anywhere.
            document["camera"] = json!({ "position": [0.7, 0.9, 2.5], "target": [0, 0, 0] });
            Picture::of(&document)
        });
        let first = pictures[0].clone();
        pictures.iter_mut().enumerate().for_each(|(i, other)| {
            let differing = first.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
            none_of(
                &format!("order {i}, {count} samples"),
                "differing pixels",
                differing,
                first.pixels.len(),
            );
        });
    }
}

/// Two sheets turned against each other about y, so that each is before the other on one side.
#[test]
fn sheets_that_cross_are_sorted_pixel_by_pixel() {
    let camera = Camera::perspective([0.3, 0.4, 3.0], [0.0, 0.0, 0.0], 40.0, 96, 96);
    let turns = [30.0f64, -40.0];
    let mut document = sheets(&named(&SHEETS[..2]), 1);
    document["camera"] = camera.document();
    document["render"] = camera.render(1);
    let slabs = turns.map(|turn| {
        let (sin, cos) = turn.to_radians().sin_cos();
        (DVec3::new(cos, 0.0, -sin), DVec3::new(sin, 0.0, cos))
    });
    for (sheet, turn) in SHEETS.iter().zip(turns) {
        // M = Rz·Ry·Rx: first laid upright, then turned about y.
        document["instances"][sheet.name]["rotation_deg"] = json!([90, turn, 0]);
        document["instances"][sheet.name]["translation"] = json!([0, 0, 0]);
    }
    // Farthest first, with the sheets' numbers.
    let met = |ray: Ray| {
        let mut hits: Vec<(f64, usize)> = (0..2)
            .filter_map(|i| {
                let (along, normal) = slabs[i];
                let s = hit_plane(ray, DVec3::ZERO, normal)?;
                let p = ray.at(s);
                (p.dot(along).abs() < HALF && p.y.abs() < HALF).then_some((s, i))
            })
            .collect();
        hits.sort_by(|a, b| b.0.total_cmp(&a.0));
        hits.into_iter().map(|(_, i)| i).collect::<Vec<_>>()
    };
    let (mut worst, mut orders) = (Worst::default(), [0, 0]);
    for (x, y, pixel) in Picture::of(&document).iter() {
        let Some(met) = camera.steady(x, y, 0.05, met) else { continue };
        if let [far, _] = met[..] {
            orders[far] += 1;
        }
        let expected =
            met.iter().fold(BACK.into(), |behind, &i| over(SHEETS[i].color, SHEETS[i].opacity, behind));
        worst.note(codes_apart(pixel, expected));
    }
    assert!(orders.iter().all(|&n| n > 200), "{orders:?} pixels of each order");
    at_most("sheets that cross", "largest difference in codes", worst.largest(), HALF_A_CODE);
}

#[test]
fn what_is_opaque_hides_what_is_blended_behind_it() {
    let camera = camera();
    let mut document = sheets(&named(&SHEETS), 1);
    document["meshes"]["box"] = json!({ "type": "box", "size": [0.7, 1.4, 0.2] });
    document["materials"]["wall"] = json!({ "shading": "unlit", "diffuse": [0.7, 0.7, 0.1] });
    document["instances"]["box"] = json!({ "mesh": "box", "material": "wall", "translation": [0.15, 0, 0] });
    let (min, max) = (DVec3::new(-0.2, -0.7, -0.1), DVec3::new(0.5, 0.7, 0.1));
    let seen = |ray: Ray| (hit_box(ray, min, max).is_some(), met(&SHEETS, ray));
    let mut worst = Worst::default();
    for (x, y, pixel) in Picture::of(&document).iter() {
        let Some((wall, met)) = camera.steady(x, y, 0.01, seen) else { continue };
        let behind = if wall { [0.7, 0.7, 0.1] } else { BACK };
        let before = met.iter().filter(|&&i| !wall || SHEETS[i].centre[2] > 0.1);
        let expected =
            before.fold(behind.into(), |behind, &i| over(SHEETS[i].color, SHEETS[i].opacity, behind));
        worst.note(codes_apart(pixel, expected));
    }
    at_most("a box among sheets", "largest difference in codes", worst.largest(), HALF_A_CODE);
}

/// What a sample of [`SHEETS`] sees: colour, premultiplied, and alpha.
fn sample_of(all: &[Sheet], opaque: usize, ray: Ray, back: Option<DVec3>) -> (DVec3, f64) {
    let start = (back.unwrap_or(DVec3::ZERO), if back.is_some() { 1.0 } else { 0.0 });
    let met = met(all, ray);
    // What the opaque sheet hides is as good as composited under it.
    met.iter().fold(start, |(color, alpha), &i| {
        let own = if i == opaque { 1.0 } else { all[i].opacity };
        (over(all[i].color, own, color), own + alpha * (1.0 - own))
    })
}

#[test]
fn samples_are_composited_one_by_one_and_then_averaged() {
    let camera = Camera::orthographic([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 2.0, 61, 53);
    for count in [2, 4, 8, 16] {
        for back in [Some(DVec3::from_array(BACK)), None] {
            let mut document = sheets(&named(&SHEETS), count);
            // The middle one hides what is behind.
            document["materials"][SHEETS[1].name]["opacity"] = json!(1);
            document["camera"] = camera.document();
            document["render"] = camera.render(count);
            if back.is_none() {
                document["environment"]["background"] = json!({ "type": "transparent" });
            }
            let (mut worst, mut worst_alpha, mut edges) = (Worst::default(), Worst::default(), 0);
            for (x, y, pixel) in Picture::of(&document).iter() {
                let place = |[dx, dy]: [i32; 2]| {
                    let (dx, dy) = (f64::from(dx) / 256.0, f64::from(dy) / 256.0);
                    DVec2::new(f64::from(x) + dx, f64::from(y) + dy)
                };
                let places = pattern(count).iter().map(|&offset| place(offset));
                let of = |p: DVec2| met(&SHEETS, camera.ray(p.x, p.y));
                // A sample within two sub-pixels of an outline may fall to either side.
                let clear = |p: DVec2| {
                    let near = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
                    near.iter().all(|&d| of(p + DVec2::from_array(d) / 128.0) == of(p))
                };
                let places: Vec<DVec2> = places.collect();
                if !places.iter().all(|&p| clear(p)) {
                    continue;
                }
                edges += usize::from(places.iter().any(|&p| of(p) != of(places[0])));
                let all = places.iter().map(|p| sample_of(&SHEETS, 1, camera.ray(p.x, p.y), back));
                let (color, alpha) = all.fold((DVec3::ZERO, 0.0), |sum, s| (sum.0 + s.0, sum.1 + s.1));
                let (color, alpha) = (color / f64::from(count), alpha / f64::from(count));
                if alpha > 0.0 {
                    worst.note(codes_apart(pixel, color / alpha));
                }
                worst_alpha.note((f64::from(pixel[3]) - 255.0 * alpha).abs());
            }
            let case = format!("blended edges, {count} samples, transparent {}", back.is_none());
            assert!(edges > 100, "{edges} pixels on edges");
            at_most(&case, "largest difference in codes", worst.largest(), HALF_A_CODE);
            at_most(&case, "largest difference of alpha", worst_alpha.largest(), HALF_A_CODE);
        }
    }
}

#[test]
fn alpha_of_a_transparent_picture_is_what_layers_leave_open() {
    let mut document = sheets(&named(&SHEETS), 4);
    document["environment"]["background"] = json!({ "type": "transparent" });
    let picture = Picture::of(&document);
    let alpha = |opacities: &[f64]| 1.0 - opacities.iter().map(|o| 1.0 - o).product::<f64>();
    // Corners of sheets: (pixel, which sheets are there).
    for (x, y, there) in [(32, 32, &[0, 1, 2][..]), (50, 20, &[0][..]), (1, 1, &[][..])] {
        let opacities: Vec<f64> = there.iter().map(|&i| SHEETS[i].opacity).collect();
        let [r, g, b, a] = picture.at(x, y);
        let apart = (f64::from(a) - 255.0 * alpha(&opacities)).abs();
        at_most(&format!("alpha at ({x}, {y})"), "codes", apart, HALF_A_CODE);
        if there == [0] {
            at_most("straight colour", "codes", codes_apart([r, g, b, a], SHEETS[0].color.into()), 0.51);
        }
    }
}

/// Sheets at one depth, `first` and `second` by name; what the middle shows.
fn coplanar(first: Sheet, second: Sheet) -> [u8; 4] {
    let flat = |sheet: Sheet| Sheet { centre: [0.0; 3], ..sheet };
    let document = sheets(&[("a".to_owned(), flat(first)), ("b".to_owned(), flat(second))], 4);
    Picture::of(&document).at(32, 20)
}

/// B15: of two at one depth the one submitted first is composited first.
#[test]
fn b15_layers_of_one_depth_are_composited_in_the_order_of_submission() {
    let [rose, leaf, _] = SHEETS;
    for (first, second) in [(rose, leaf), (leaf, rose)] {
        let under = over(first.color, first.opacity, BACK.into());
        let expected = over(second.color, second.opacity, under);
        let apart = codes_apart(coplanar(first, second), expected);
        at_most("B15 two blended sheets", "codes", apart, HALF_A_CODE);
    }
    let wall = Sheet { opacity: 1.0, ..leaf };
    let before = over(rose.color, rose.opacity, wall.color.into());
    at_most("B15 blended after opaque", "codes", codes_apart(coplanar(wall, rose), before), HALF_A_CODE);
    let hidden = codes_apart(coplanar(rose, wall), wall.color.into());
    at_most("B15 blended before opaque", "codes", hidden, HALF_A_CODE);
}

/// Sheets that nearly coincide, differently cut into triangles: some pixels may go either way, but the
/// same way in every run.
#[test]
fn b15_coplanar_sheets_look_the_same_in_every_run() {
    let mut document = sheets(&named(&SHEETS[..2]), 4);
    document["camera"] = json!({ "position": [0.7, 0.9, 2.5], "target": [0, 0, 0] });
    let positions = [[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.5, 0.0, 0.5], [-0.5, 0.0, 0.5]];
    document["meshes"]["cut"] =
        json!({ "type": "triangles", "positions": positions, "indices": [0, 2, 1, 0, 3, 2] });
    for (name, mesh) in [("rose", "sheet"), ("leaf", "cut")] {
        document["instances"][name] = json!({ "mesh": mesh, "material": name, "rotation_deg": [33, 21, 0] });
    }
    let scene = scene(&document);
    let first = Picture::new(frame(&scene, &samples(4)));
    let [rose, leaf, _] = SHEETS;
    let either = [(rose, leaf), (leaf, rose)]
        .map(|(far, near)| over(near.color, near.opacity, over(far.color, far.opacity, BACK.into())));
    let inside = first.at(32, 32);
    assert!(either.iter().any(|color| codes_apart(inside, *color) <= HALF_A_CODE), "{inside:?}");
    for _ in 0..3 {
        assert_eq!(Picture::new(frame(&scene, &samples(4))), first);
    }
}

/// A sheet whose alpha map is 1 on the left and 0 on the right.
fn half_clear() -> (Value, rasterd::scene::Files) {
    let mut document = sheets(&named(&SHEETS[..1]), 4);
    document["textures"] = json!({ "half": { "file": "half.png", "filter": "nearest" } });
    let rose = &mut document["materials"]["rose"];
    rose["opacity"] = json!(1);
    rose["opacity_map"] = json!("half");
    let texel = |x: u32| if x < 2 { [255, 9, 77, 255] } else { [0, 200, 3, 255] };
    (document, file("half.png", png(4, 2, |x, _| texel(x))))
}

#[test]
fn alpha_of_one_is_opaque_and_of_none_is_nothing_to_the_byte() {
    let (document, files) = half_clear();
    let blended = Picture::new(frame(&scene_with(&document, &files), &samples(4)));
    let mut cut = document.clone();
    cut["materials"]["rose"]["alpha_cutoff"] = json!(0.5);
    let opaque = Picture::new(frame(&scene_with(&cut, &files), &samples(4)));
    assert_eq!(blended, opaque);
    let plain = blended.at(1, 1);
    assert_ne!(blended.at(24, 28), plain);
    assert_eq!(blended.at(45, 28), plain);
}

#[test]
fn a_surface_of_no_opacity_is_not_there() {
    let document = sheets(&named(&SHEETS), 4);
    let mut clear = document.clone();
    clear["materials"]["leaf"]["opacity"] = json!(0);
    let mut without = document;
    without["instances"].as_object_mut().expect("a map").remove("leaf");
    assert_eq!(Picture::of(&clear), Picture::of(&without));
    let shaded = |document: &Value| frame(&scene(document), &FrameRequest::default()).stats.shaded;
    assert_eq!(shaded(&clear), shaded(&without));
}

#[test]
fn alpha_holds_in_every_kind_of_shading() {
    for shading in ["blinn_phong", "lambert", "unlit", "vertex_color", "normal"] {
        let mut document = sheets(&named(&SHEETS[..1]), 1);
        document["environment"]["background"]["color"] = json!([0, 0, 0]);
        document["environment"]["ambient"] = json!([0.2, 0.2, 0.2]);
        document["lights"] =
            json!({ "sun": { "type": "directional", "direction": [0.3, -0.4, -1], "intensity": 0.5 } });
        let rose = &mut document["materials"]["rose"];
        rose["shading"] = json!(shading);
        rose["specular"] = json!([0.3, 0.3, 0.3]);
        rose["opacity"] = json!(1);
        let opaque = Picture::of(&document).at(35, 27);
        document["materials"]["rose"]["opacity"] = json!(0.25);
        let blended = Picture::of(&document).at(35, 27);
        let expected = DVec3::from_array([0, 1, 2].map(|c| decode(opaque[c]) * 0.25));
        // The opaque byte is half a code off at most, and encoding a quarter of it raises that.
        at_most(&format!("alpha of {shading}"), "codes", codes_apart(blended, expected), 1.0);
    }
}

#[test]
fn hundreds_of_layers_are_composited_in_order() {
    // Too many for a tile to hold at once, at every number of samples.
    for (count, layers, side) in [(4, 100, 64), (16, 9000, 8), (1, 300, 70)] {
        let depth = |i: i32| f64::from(i % 1000) * 1e-3 + f64::from(i) * 1e-7;
        let corner = |i: i32, x: f64, y: f64| json!([x, y, depth(i)]);
        // In no order of depth, each larger than the picture.
        let order: Vec<i32> = (0..layers).map(|i| (i * 7919) % layers).collect();
        let positions =
            order.iter().flat_map(|&i| [corner(i, -9.0, -9.0), corner(i, 9.0, -9.0), corner(i, 0.0, 18.0)]);
        let tint = |i: i32| [f64::from(i % 3 == 0), f64::from(i % 7) / 7.0, f64::from(i % 2)];
        let colors = order.iter().flat_map(|&i| [tint(i); 3]);
        let opacity = 0.03;
        let document = json!({
            "camera": { "position": [0, 0, 3], "target": [0, 0, 0], "orthographic": { "height": 2 } },
            "environment": { "background": { "type": "color", "color": BACK } },
            "lights": {},
            "materials": { "veil": { "shading": "vertex_color", "opacity": opacity } },
            "meshes": { "veils": { "type": "triangles", "positions": positions.collect::<Vec<_>>(),
                "colors": colors.collect::<Vec<_>>() } },
            "instances": { "veils": { "mesh": "veils", "material": "veil" } },
            "render": { "width": side, "height": side, "samples": count },
        });
        let mut far_to_near: Vec<i32> = (0..layers).collect();
        far_to_near.sort_by(|&a, &b| depth(a).total_cmp(&depth(b)));
        let expected = far_to_near.iter().fold(BACK.into(), |behind, &i| over(tint(i), opacity, behind));
        let picture = Picture::of(&document);
        let worst: Worst = picture.pixels.iter().map(|pixel| codes_apart(*pixel, expected)).collect();
        at_most(&format!("{layers} layers, {count} samples"), "codes", worst.largest(), HALF_A_CODE);
    }
}

/// A sheet of 8 × 8 fields, every second one a hole, over a floor, under a sun.
struct Holes {
    camera: Camera,
    light: DVec3,
}

impl Holes {
    const CENTRE: DVec3 = DVec3::new(0.0, 1.0, 0.0);

    fn new() -> Self {
        let camera = Camera::perspective([-0.6, 3.4, 2.6], [0.1, 0.3, 0.0], 45.0, 160, 120);
        Self { camera, light: DVec3::new(0.35, -1.0, -0.55) }
    }

    fn document(&self) -> Value {
        json!({
            "camera": self.camera.document(),
            "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#00f" } },
            "lights": { "sun": { "type": "directional", "direction": self.light.to_array(), "intensity": 9,
                "shadow": { "filter": "hard", "resolution": 2048 } } },
            "textures": { "holes": { "checker": { "colors": ["#000", "#fff"], "cells": 8 }, "filter": "nearest" } },
            "materials": {
                "white": { "shading": "lambert", "diffuse": [1, 1, 1] },
                "sheet": { "shading": "unlit", "diffuse": [1, 0, 0], "opacity_map": "holes", "alpha_cutoff": 0.5 },
            },
            "meshes": { "floor": { "type": "plane", "size": [6, 6] }, "sheet": { "type": "plane", "size": [1.6, 1.6] } },
            "instances": {
                "floor": { "mesh": "floor", "material": "white" },
                "sheet": { "mesh": "sheet", "material": "sheet", "translation": Self::CENTRE.to_array() },
            },
            "render": self.camera.render(1),
        })
    }

    /// Whether a ray meets the sheet where it is no hole.
    fn meets(ray: Ray) -> bool {
        let Some(s) = hit_plane(ray, Self::CENTRE, DVec3::Y) else { return false };
        let p = ray.at(s) - Self::CENTRE;
        // u along +x, v along −z; the first colour is that of the field at (0, 0).
        let field = |c: f64| ((c / 1.6 + 0.5) * 8.0).floor();
        p.x.abs() < 0.8 && p.z.abs() < 0.8 && (field(p.x) + field(-p.z)).rem_euclid(2.0) == 1.0
    }

    /// The sheet (2), the lit floor (1), the floor in the shadow (0), or nothing.
    fn seen(&self, ray: Ray) -> Option<u32> {
        if Self::meets(ray) {
            return Some(2);
        }
        let origin = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Y)?);
        let on_floor = origin.x.abs() < 3.0 && origin.z.abs() < 3.0;
        on_floor.then(|| u32::from(!Self::meets(Ray { origin, direction: -self.light })))
    }
}

#[test]
fn holes_are_cut_where_the_map_says_and_light_falls_through_them() {
    let holes = Holes::new();
    let picture = Picture::of(&holes.document());
    let (mut wrong, mut counts) = (0, [0; 3]);
    for (x, y, pixel) in picture.iter() {
        // A texel of the map is 0.1 px on the floor.
        let Some(Some(seen)) = holes.camera.steady(x, y, 0.4, |ray| holes.seen(ray)) else { continue };
        counts[seen as usize] += 1;
        let expected = [[0, 0, 0, 255], [255, 255, 255, 255], [255, 0, 0, 255]][seen as usize];
        wrong += usize::from(pixel != expected);
    }
    assert!(counts.iter().all(|&n| n > 300), "{counts:?} pixels of shadow, floor, sheet");
    none_of("holes", "wrong pixels", wrong, counts.iter().sum());
}

#[test]
fn edges_of_holes_are_exact() {
    // Seen from above, a field is twenty pixels wide: its outline is that of the closed form.
    let holes = Holes {
        camera: Camera::orthographic([0.0, 3.0, 0.0], [0.0, 0.0, 0.0], 1.7, 170, 170),
        ..Holes::new()
    };
    for count in [1, 4] {
        let mut document = holes.document();
        document["render"] = holes.camera.render(count);
        let (mut wrong, mut checked) = (0, 0);
        for (x, y, pixel) in Picture::of(&document).iter() {
            let Some(met) = holes.camera.steady(x, y, 2.0 / 256.0, Holes::meets) else { continue };
            // Samples of a pixel differ where the sheet ends, and where its two triangles meet.
            let on_sheet = |ray: Ray| ray.origin.x.abs() < 0.8 && ray.origin.z.abs() < 0.8;
            let on_diagonal = x.abs_diff(y) < 2 || (x + y).abs_diff(169) < 2;
            if on_diagonal || holes.camera.steady(x, y, 0.8, on_sheet).is_none() {
                continue;
            }
            checked += 1;
            wrong += usize::from((pixel == [255, 0, 0, 255]) != met);
        }
        assert!(checked > 25_000);
        none_of(&format!("edges of holes, {count} samples"), "wrong pixels", wrong, checked);
    }
}

#[test]
fn data_outputs_and_pick_see_through_holes() {
    let holes = Holes::new();
    let mut document = holes.document();
    document["camera"]["far"] = json!(10);
    let scene = scene(&document);
    let ids = values(frame(&scene, &output(Output::Instance)));
    let depths = values(frame(&scene, &output(Output::Depth)));
    let albedo = Picture::new(frame(&scene, &output(Output::Albedo)));
    let (mut wrong, mut worst, mut checked) = (0, Worst::default(), 0);
    for (x, y, color) in albedo.iter() {
        let Some(Some(seen)) = holes.camera.steady(x, y, 0.02, |ray| holes.seen(ray).map(|n| n == 2)) else {
            continue;
        };
        let at = (y * holes.camera.width + x) as usize;
        let height = if seen { 1.0 } else { 0.0 };
        let s =
            hit_plane(holes.camera.centre(x, y), DVec3::Y * height, DVec3::Y).expect("the camera looks down");
        let red = if seen { [255, 0, 0, 255] } else { [255; 4] };
        wrong += usize::from(ids[at] != 1 + u16::from(seen) || color != red);
        worst.note((f64::from(depths[at]) - 65535.0 * (s - 0.1) / 9.9).abs());
        if x % 16 == 3 && y % 16 == 5 {
            let hit = pick(&scene, x, y).expect("a surface");
            wrong += usize::from(hit.instance != u32::from(seen) || (hit.depth - s).abs() > 1e-3);
        }
        checked += 1;
    }
    none_of("data outputs of holes", "wrong pixels", wrong, checked);
    at_most("data outputs of holes", "depth in codes", worst.largest(), 4.0);
}

#[test]
fn half_opaque_counts_as_there_and_less_does_not() {
    for (opacity, there) in [(0.499, false), (0.5, true)] {
        let mut sheet = SHEETS;
        sheet[0].opacity = opacity;
        let mut document = sheets(&named(&sheet[..1]), 1);
        document["camera"]["far"] = json!(10);
        let scene = scene(&document);
        assert_eq!(values(frame(&scene, &output(Output::Instance)))[30 * 64 + 36] != 0, there);
        assert_eq!(values(frame(&scene, &output(Output::Depth)))[30 * 64 + 36] != u16::MAX, there);
        for output in [Output::Normal, Output::Albedo].map(output) {
            assert_eq!(Picture::new(frame(&scene, &output)).at(36, 30) != [0, 0, 0, 255], there);
        }
        assert_eq!(pick(&scene, 36, 30).is_some(), there);
    }
}

/// What a sheet over a floor does to the floor's light.
#[test]
fn a_sheet_casts_from_half_opacity_on() {
    let picture = |change: &dyn Fn(&mut Value)| {
        let mut document = Holes::new().document();
        document["materials"]["sheet"] = json!({ "shading": "unlit", "diffuse": [1, 0, 0] });
        document["lights"]["sun"]["intensity"] = json!(1);
        change(&mut document);
        Picture::of(&document)
    };
    let with = |opacity: f64| move |d: &mut Value| d["materials"]["sheet"]["opacity"] = json!(opacity);
    let silent = picture(&|d| {
        with(0.4)(d);
        d["instances"]["sheet"]["casts_shadow"] = json!(false);
    });
    assert!(picture(&with(0.4)) == silent, "less than half opaque");
    let full = picture(&with(1.0));
    let half = picture(&with(0.5));
    let holes = Holes::new();
    let beside = |ray: Ray| {
        let s = hit_plane(ray, Holes::CENTRE, DVec3::Y).expect("the camera looks down");
        let p = ray.at(s);
        p.x.abs() > 0.8 || p.z.abs() > 0.8
    };
    let clear = |&(x, y, _): &(u32, u32, [u8; 4])| holes.camera.steady(x, y, 1.0, beside) == Some(true);
    let (mut wrong, mut dark, mut checked) = (0, 0, 0);
    for (x, y, pixel) in full.iter().filter(clear) {
        wrong += usize::from(half.at(x, y) != pixel);
        dark += usize::from(pixel == [0, 0, 0, 255]);
        checked += 1;
    }
    assert!(dark > 150, "{dark} pixels in the shadow");
    none_of("a sheet of half opacity", "pixels lit otherwise", wrong, checked);
    // With a cut-off it casts from there on.
    let cut = |opacity: f64| {
        picture(&|d| {
            with(opacity)(d);
            d["materials"]["sheet"]["alpha_cutoff"] = json!(0.3);
        })
    };
    let without = picture(&|d| {
        d["instances"].as_object_mut().expect("a map").remove("sheet");
    });
    assert!(cut(0.3) == full, "as much as the cut-off");
    assert!(cut(0.29) == without, "less than the cut-off");
}

#[test]
fn alpha_of_a_diffuse_map_and_of_an_mtl_file_counts() {
    let (mut document, _) = half_clear();
    document["textures"]["half"]["file"] = json!("clear.png");
    document["materials"]["rose"] =
        json!({ "shading": "unlit", "diffuse_map": "half", "diffuse": [1, 1, 1] });
    let files = file("clear.png", png(4, 2, |x, _| if x < 2 { [255, 255, 255, 51] } else { [255; 4] }));
    let picture = Picture::new(frame(&scene_with(&document, &files), &samples(1)));
    let fifth = over([1.0; 3], 0.2, BACK.into());
    at_most("alpha of a diffuse map", "codes", codes_apart(picture.at(24, 28), fifth), HALF_A_CODE);
    assert_eq!(picture.at(45, 28), [255; 4]);

    let mut files =
        file("pane.obj", b"mtllib pane.mtl\nusemtl pane\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n".to_vec());
    files
        .insert("pane.mtl", b"newmtl pane\nKd 0 0 0\nKa 1 0 0\nd 0.25\n".to_vec().into())
        .expect("a sound name");
    let mut document = sheets(&[], 1);
    document["environment"]["ambient"] = json!([1, 1, 1]);
    document["meshes"]["pane"] = json!({ "type": "obj", "file": "pane.obj" });
    document["instances"]["pane"] = json!({ "mesh": "pane" });
    let scene = scene_with(&document, &files);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let expected = over([1.0, 0.0, 0.0], 0.25, BACK.into());
    let picture = Picture::new(frame(&scene, &FrameRequest::default()));
    at_most("MTL `d 0.25`", "codes", codes_apart(picture.at(32, 40), expected), HALF_A_CODE);
}
