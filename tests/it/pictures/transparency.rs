//! Blending against closed forms: layers in order, sample by sample.

mod alpha;
mod cut_outs;

use crate::closed_form::{Camera, Ray, codes_apart, hit_box, hit_plane};
use crate::draw::{Picture, frame, samples, scene};
use crate::measure::{Worst, at_most, none_of};
use glam::{DVec2, DVec3};
use rasterd::pipeline::samples::pattern;
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
