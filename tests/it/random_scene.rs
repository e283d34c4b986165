//! Scenes of everything that a document can ask for, drawn by lot: small, quick, and never twice the same.

use crate::draw::{png, scene_with};
use crate::random::Random;
use rasterd::model::Filter;
use rasterd::plan::{FrameRequest, Knobs};
use rasterd::scene::{Files, Scene};
use serde_json::{Map, Value, json};
use std::collections::HashSet;
use std::mem::discriminant;
use std::sync::{Arc, LazyLock};

/// The pictures that textures and cube maps are made of.
static FILES: LazyLock<Files> = LazyLock::new(|| {
    let byte = |x: u32, y: u32| u8::try_from((x * x * 7 + y * 13 + x * y) % 256).expect("a byte");
    let mut files = Files::default();
    for (name, bytes) in [
        ("noise.png", png(13, 9, |x, y| [byte(x, y), byte(y, x), byte(x + y, 3), 255])),
        ("holes.png", png(6, 6, |x, y| [200, byte(x, y), 90, if (x + y) % 3 == 0 { 0 } else { byte(x, y) }])),
        ("dot.png", png(1, 1, |_, _| [200, 120, 40, 255])),
        ("flat.png", png(4, 4, |_, _| [128, 128, 255, 255])),
        ("side.png", png(8, 8, |x, y| [byte(x, y), byte(y, 5), 255 - byte(x, 2), 255])),
        ("bumps.png", png(8, 8, |x, y| [100 + byte(x, y) / 8, 110 + byte(y, x) / 8, 230, 255])),
    ] {
        files.insert(name, bytes.into()).expect("a sound name");
    }
    files
});

/// A scene, its document for the one who must find out what went wrong, and a request for a small picture.
pub struct RandomScene {
    pub document: Value,
    pub scene: Arc<Scene>,
    pub request: FrameRequest,
}

/// The scene that `seed` stands for.
pub fn random_scene(seed: u64) -> RandomScene {
    let mut lot = Lot(Random(seed));
    let document = lot.document();
    let scene = scene_with(&document, &FILES);
    let request = lot.request();
    RandomScene { document, scene, request }
}

/// What decides.
struct Lot(Random);

impl Lot {
    fn one_in(&mut self, n: usize) -> bool {
        self.0.below(n) == 0
    }

    fn pick<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.0.below(all.len())].clone()
    }

    fn one_of_in<T: Clone>(&mut self, n: usize, all: &[T]) -> Option<T> {
        self.one_in(n).then(|| self.pick(all))
    }

    fn vector(&mut self, reach: f64) -> Value {
        json!([(); 3].map(|()| self.0.between(-reach, reach)))
    }

    fn color(&mut self) -> Value {
        json!([(); 3].map(|()| self.0.unit()))
    }

    /// `count` entries with names of their own.
    fn map(&mut self, count: usize, mut entry: impl FnMut(&mut Self) -> Value) -> Map<String, Value> {
        (0..count).map(|i| (format!("n{i}"), entry(self))).collect()
    }

    fn request(&mut self) -> FrameRequest {
        FrameRequest { t: self.0.between(0.0, 3.0), knobs: self.knobs(), ..FrameRequest::default() }
    }

    /// Most are as the scene has them.
    fn knobs(&mut self) -> Knobs {
        Knobs {
            shadow_resolution: self.one_of_in(4, &[24, 100]),
            pcf_taps: self.one_of_in(4, &[1, 5, 40]),
            search_taps: self.one_of_in(4, &[1, 7, 30]),
            filter_taps: self.one_of_in(4, &[1, 9, 50]),
            texture_filter: self.one_of_in(4, &[Filter::Nearest, Filter::Bilinear, Filter::Trilinear]),
            render_scale: self.one_of_in(5, &[0.5, 0.75, 1.5]),
        }
    }

    fn document(&mut self) -> Value {
        let (lights, textures, materials, meshes) = (self.0.below(4), 5, 4, 4);
        let instances = 1 + self.0.below(6);
        let effects = self.pick(&[0, 0, 1, 2, 4]);
        json!({
            "camera": self.camera(),
            "environment": { "ambient": self.color(), "background": self.background() },
            "lights": self.map(lights, Self::light),
            "textures": self.map(textures, Self::texture),
            "materials": self.map(materials, Self::material),
            "meshes": self.map(meshes, Self::mesh),
            "instances": self.map(instances, Self::instance),
            "post": (0..effects).map(|_| self.effect()).collect::<Vec<_>>(),
            "render": self.render(),
        })
    }

    fn camera(&mut self) -> Value {
        let mut camera = json!({ "position": self.vector(4.0), "target": self.vector(0.6) });
        match self.0.below(4) {
            0 => camera["orthographic"] = json!({ "height": self.0.between(0.5, 6.0) }),
            1 => camera["fov_y_deg"] = json!(self.0.between(5.0, 150.0)),
            _ => {}
        }
        if self.one_in(3) {
            camera["near"] = json!(self.0.between(0.01, 3.0));
        }
        if self.one_in(3) {
            camera["far"] = json!(self.0.between(3.1, 9.0));
        }
        camera
    }

    fn background(&mut self) -> Value {
        match self.0.below(8) {
            0 | 1 => json!({ "type": "transparent" }),
            2 | 3 => json!({ "type": "color", "color": self.color() }),
            4 => json!({ "type": "equirect", "file": "noise.png" }),
            5 => self.sky(),
            6 => json!({ "type": "cubemap", "faces": {
                "px": "side.png", "nx": "bumps.png", "py": "side.png",
                "ny": "bumps.png", "pz": "bumps.png", "nz": "side.png" } }),
            _ => json!({ "type": "gradient", "top": self.color(), "bottom": self.color() }),
        }
    }

    fn sky(&mut self) -> Value {
        let mut sky = json!({ "type": "sky", "turbidity": self.0.between(1.0, 10.0) });
        if self.one_in(2) {
            sky["sun_direction"] = json!(self.0.direction().to_array());
        }
        sky
    }

    fn light(&mut self) -> Value {
        let mut light = if self.one_in(2) {
            json!({ "type": "directional", "direction": self.0.direction().to_array() })
        } else {
            json!({ "type": "point", "position": self.vector(2.5) })
        };
        light["color"] = self.color();
        light["intensity"] = json!(self.pick(&[0.0, 0.5, 2.0, 6.0, 6.0]));
        light["enabled"] = json!(!self.one_in(6));
        if !self.one_in(4) {
            light["shadow"] = self.shadow();
        }
        light
    }

    fn shadow(&mut self) -> Value {
        let mut shadow = json!({
            "filter": self.pick(&["hard", "pcf", "pcss", "pcss"]),
            "resolution": self.pick(&[16, 65, 130]),
            "bias": self.pick(&[0.0, 1.0, 1.0, 2.0]),
            "radius": self.pick(&[0.0, 1.5, 7.0]),
            "light_radius": self.pick(&[0.0, 0.03, 0.3]),
            "cull": self.pick(&["none", "none", "front", "back"]),
        });
        if self.one_in(3) {
            shadow["search_radius"] = json!(self.0.between(0.0, 12.0));
        }
        shadow
    }

    fn texture(&mut self) -> Value {
        let mut texture = json!({
            "filter": self.pick(&["nearest", "bilinear", "trilinear"]),
            "wrap": self.pick(&["repeat", "clamp", "mirror"]),
        });
        match self.0.below(7) {
            0 => texture["checker"] = json!({ "colors": ["#b07030", "#b07030"], "cells": 2 }),
            1 => texture["checker"] = json!({ "colors": ["#205080", "#e0e0d0"], "cells": 4 }),
            file => {
                let names =
                    ["dot.png", "dot.png", "noise.png", "holes.png", "flat.png", "flat.png", "bumps.png"];
                texture["file"] = json!(names[file]);
            }
        }
        if self.one_in(3) {
            texture["color_space"] = json!("linear");
        }
        texture
    }

    fn material(&mut self) -> Value {
        let mut material = json!({
            "shading": self.pick(&["blinn_phong", "blinn_phong", "blinn_phong", "lambert", "unlit", "vertex_color", "normal"]),
            "diffuse": self.color(),
            "specular": if self.one_in(2) { json!([0, 0, 0]) } else { self.color() },
            "shininess": self.pick(&[0.0, 1.0, 30.0, 4000.0]),
            "emissive": if self.one_in(3) { self.color() } else { json!([0, 0, 0]) },
            "double_sided": self.one_in(3),
        });
        for map in ["diffuse_map", "specular_map", "emissive_map", "normal_map", "bump_map", "opacity_map"] {
            if self.one_in(3) {
                material[map] = json!(format!("n{}", self.0.below(5)));
            }
        }
        material["bump_scale"] = json!(self.pick(&[0.0, 0.02, 0.5]));
        if self.one_in(4) {
            material["opacity"] = json!(self.pick(&[0.0, 0.4, 0.8]));
        }
        if self.one_in(4) {
            material["alpha_cutoff"] = json!(self.pick(&[0.0, 0.3, 0.7]));
        }
        if self.one_in(4) {
            material["ambient"] = self.color();
        }
        material
    }

    fn mesh(&mut self) -> Value {
        match self.0.below(7) {
            0 => json!({ "type": "box" }),
            1 => json!({ "type": "plane", "size": [5, 5], "uv_repeat": [3, 3] }),
            2 => json!({ "type": "sphere", "segments": 12, "rings": 7 }),
            3 => json!({ "type": "torus", "segments": 14, "sides": 8 }),
            4 => json!({ "type": "plane", "size": [4000, 4000] }),
            5 => json!({ "type": "cone", "segments": 9 }),
            _ => self.triangles(),
        }
    }

    /// A few triangles of any shape, some with colours.
    fn triangles(&mut self) -> Value {
        let count = 3 * (1 + self.0.below(8));
        let mut mesh = json!({ "type": "triangles" });
        mesh["positions"] = (0..count).map(|_| self.vector(1.2)).collect();
        if self.one_in(2) {
            mesh["colors"] = (0..count).map(|_| self.color()).collect();
        }
        if self.one_in(2) {
            mesh["uvs"] = (0..count).map(|_| json!([self.0.between(-2.0, 2.0), self.0.unit()])).collect();
        }
        mesh
    }

    fn instance(&mut self) -> Value {
        let mut instance = json!({
            "mesh": format!("n{}", self.0.below(4)),
            "translation": self.vector(1.5),
            "casts_shadow": !self.one_in(5),
            "receives_shadow": !self.one_in(5),
            "visible": !self.one_in(9),
        });
        if !self.one_in(6) {
            instance["material"] = json!(format!("n{}", self.0.below(4)));
        }
        if self.one_in(2) {
            instance["rotation_deg"] = self.vector(180.0);
        }
        match self.0.below(5) {
            0 => instance["translation"] = self.vector(12.0),
            1 => instance["scale"] = json!(self.0.magnitude(0.01, 40.0)),
            2 => instance["scale"] = json!([-1, 0.5, 2]),
            _ => {}
        }
        instance
    }

    fn effect(&mut self) -> Value {
        let amount = self.pick(&[0.0, 0.0, 0.4, 1.0]);
        match self.0.below(10) {
            0 => json!({ "type": "tonemap", "operator": "none", "exposure": self.pick(&[1.0, 1.0, 1.7]) }),
            1 => json!({ "type": "tonemap", "operator": self.pick(&["aces", "reinhard"]) }),
            2 => json!({ "type": "blur", "radius": self.pick(&[0.0, 0.0, 1.5, 3.0]) }),
            3 => json!({ "type": "grayscale", "amount": amount }),
            4 => json!({ "type": "vignette", "amount": amount }),
            5 => json!({ "type": "bloom", "intensity": amount, "radius": self.pick(&[0.0, 3.0]) }),
            6 => json!({ "type": "sharpen", "amount": amount }),
            7 => json!({ "type": "fxaa" }),
            8 => json!({ "type": "color_matrix", "matrix":
                if self.one_in(2) { json!([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]) }
                else { json!([[0.8, 0.3, -0.2, 0], [0, 1, 0, 0.1], [0.1, 0, 0.7, -0.1]]) } }),
            _ => json!({ "type": "kernel", "kernel":
                if self.one_in(2) { json!([[0, 0, 0], [0, 1, 0], [0, 0, 0]]) }
                else { json!([[0, -0.2, 0], [0.1, 1, 0], [0, 0.1, 0]]) } }),
        }
    }

    fn render(&mut self) -> Value {
        let mut render = json!({
            "width": 40 + self.0.below(12),
            "height": 26 + self.0.below(10),
            "samples": self.pick(&[1, 1, 2, 4, 4, 8, 16]),
            "cull": self.pick(&["back", "back", "front", "none"]),
            "shadows": !self.one_in(12),
        });
        if self.one_in(12) {
            render["shading"] = json!(self.pick(&["lambert", "unlit", "normal"]));
        }
        render
    }
}

/// Files that a background lacks would leave it out without a word.
#[test]
fn the_lot_falls_on_every_background_and_on_resampled_pictures() {
    let mut rng = Random(0x0107);
    let (mut backgrounds, mut resampled) = (HashSet::new(), 0);
    for _ in 0..100 {
        let RandomScene { scene, request, .. } = random_scene(rng.bits());
        backgrounds.insert(discriminant(&scene.background));
        resampled += usize::from(request.knobs.that_change(&scene).render_scale.is_some());
    }
    assert_eq!(backgrounds.len(), 6);
    assert!((10..=30).contains(&resampled), "{resampled} of 100 pictures are resampled");
}
