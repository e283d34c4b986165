//! Cut-outs: holes in what is seen, in shadows, in data outputs.

use crate::closed_form::{Camera, Ray, hit_plane};
use crate::draw::{Picture, frame, output, pick, scene, values};
use crate::measure::{Worst, at_most, none_of};
use glam::DVec3;
use rasterd::plan::Output;
use serde_json::{Value, json};

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
