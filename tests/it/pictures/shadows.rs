//! Hard shadows against a ray cast to the light.

use crate::box_on_floor::{BoxOnFloor, Seen};
use crate::closed_form::{Camera, Ray, hit_plane, hit_sphere};
use crate::draw::Picture;
use crate::measure::{all_hold, none_of};
use glam::DVec3;
use rasterd::report::selftest::{Effort, Ledger};
use serde_json::{Value, json};

fn camera() -> Camera {
    Camera::perspective([-2.2, 4.2, 2.4], [-0.2, 0.2, -0.3], 50.0, 160, 120)
}

#[test]
fn a_box_on_a_floor_shadows_what_the_light_cannot_reach_and_nothing_else() {
    for (i, light) in
        [[-0.5, -1.0, -0.3], [0.9, -0.4, -0.5], [0.2, -1.0, 0.9], [0.0, -1.0, 0.0]].into_iter().enumerate()
    {
        for resolution in [128, 1000, 2048] {
            let setting = BoxOnFloor {
                camera: camera(),
                light: light.into(),
                resolution,
                floor: 4.0,
                turn: DVec3::ZERO,
                min: DVec3::new(-0.5, 0.0, -0.4),
                max: DVec3::new(0.4, 1.0, 0.5),
            };
            let mut ledger = Ledger::new("box on a floor", Effort::Quick);
            setting.as_cast(&mut ledger, &format!("light {i}, map {resolution}"));
            all_hold(ledger);
        }
    }
}

#[test]
fn without_shadows_everything_that_faces_the_light_is_lit() {
    let setting = BoxOnFloor {
        camera: camera(),
        light: DVec3::new(-0.5, -1.0, -0.3),
        resolution: 512,
        floor: 4.0,
        turn: DVec3::ZERO,
        min: DVec3::new(-0.5, 0.0, -0.4),
        max: DVec3::new(0.4, 1.0, 0.5),
    };
    let floor_is_lit = |document: &Value| {
        let picture = Picture::of(document);
        let dark = picture.iter().filter(|&(x, y, pixel)| {
            setting.camera.steady(x, y, 0.5, |ray| setting.seen(ray).0) == Some(Seen::Floor) && pixel[0] == 0
        });
        dark.count() == 0
    };
    let sun = setting.document();
    let mut lamp = sun.clone();
    lamp["lights"]["sun"] = json!({ "type": "point", "position": [1, 2, 0.6], "intensity": 4000,
        "shadow": { "filter": "pcf", "resolution": 512 } });
    for document in [sun, lamp] {
        assert!(!floor_is_lit(&document));
        for (pointer, value) in [
            ("/render/shadows", json!(false)),
            ("/lights/sun/shadow/filter", json!("none")),
            ("/instances/box/casts_shadow", json!(false)),
            ("/instances/floor/receives_shadow", json!(false)),
        ] {
            let mut changed = document.clone();
            let (parent, key) = pointer.rsplit_once('/').expect("a path");
            changed.pointer_mut(parent).expect("a parent")[key] = value;
            assert!(floor_is_lit(&changed), "{pointer}");
        }
    }
}

/// A flat caster is drawn into a map only if something lies behind it.
#[test]
fn flat_casters_shade_what_lies_behind_them() {
    let camera = Camera::perspective([-1.0, 6.0, 0.4], [-0.5, 0.0, -0.3], 50.0, 120, 90);
    let light = DVec3::new(-0.5, -1.0, -0.3);
    for (name, turn, slabs) in [
        ("level", json!([0, 0, 0]), [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 1.0)]),
        ("upside down", json!([180, 0, 0]), [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.0, -1.0)]),
        ("upright", json!([90, 0, 0]), [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)]),
    ] {
        let document = json!({
            "camera": camera.document(),
            "environment": { "ambient": [0, 0, 0] },
            "lights": { "sun": { "type": "directional", "direction": light.to_array(), "intensity": 9,
                "shadow": { "filter": "hard", "resolution": 2048 } } },
            "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
            "meshes": { "floor": { "type": "plane", "size": [20, 20] }, "sheet": { "type": "plane", "size": [0.8, 0.6] } },
            "instances": {
                "floor": { "mesh": "floor", "material": "white" },
                "sheet": { "mesh": "sheet", "material": "white", "translation": [0, 1, 0], "rotation_deg": turn },
            },
            "render": camera.render(1),
        });
        let picture = Picture::of(&document);
        let centre = DVec3::new(0.0, 1.0, 0.0);
        let meets = |ray: Ray| {
            let s = hit_plane(ray, centre, slabs[0].cross(slabs[1]));
            s.is_some_and(|s| {
                let p = ray.at(s) - centre;
                p.dot(slabs[0]).abs() < 0.4 && p.dot(slabs[1]).abs() < 0.3
            })
        };
        // The sheet hides some of the floor; what is left of its shadow says enough.
        let dark = |ray: Ray| {
            let origin = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Y).expect("the camera looks down"));
            (meets(ray), meets(Ray { origin, direction: -light }))
        };
        let (mut wrong, mut shaded, mut lit) = (0, 0, 0);
        for (x, y, pixel) in picture.iter() {
            let Some((false, dark)) = camera.steady(x, y, 0.6, dark) else {
                continue;
            };
            wrong += usize::from((pixel[0] == 0) != dark);
            shaded += usize::from(dark);
            lit += usize::from(!dark);
        }
        assert!(shaded > 10, "{name}: {shaded} pixels in the shadow");
        none_of(&format!("flat caster, {name}"), "wrong pixels", wrong, lit + shaded);
    }
}

#[test]
fn a_convex_mesh_does_not_shadow_its_lit_side() {
    let light = DVec3::new(-0.5, -1.0, -0.3);
    let camera = Camera::perspective([1.5, 2.0, 1.2], [0.0, 0.0, 0.0], 40.0, 120, 120);
    for (segments, resolution) in [(16, 64), (64, 300), (64, 2048), (512, 128), (512, 1024)] {
        let document = json!({
            "camera": camera.document(),
            "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#00f" } },
            "lights": { "sun": { "type": "directional", "direction": light.to_array(), "intensity": 100,
                "shadow": { "filter": "hard", "resolution": resolution } } },
            "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
            "meshes": { "ball": { "type": "sphere", "radius": 0.6, "segments": segments, "rings": segments / 2 } },
            "instances": { "ball": { "mesh": "ball", "material": "white" } },
            "render": camera.render(1),
        });
        // A facet's normal is at most so far from that of the ball, where it is not seen at a grazing
        // angle.
        let facet = std::f64::consts::PI / f64::from(segments) * 2.5;
        let (mut dark, mut lit) = (0, 0);
        for (x, y, pixel) in Picture::of(&document).iter() {
            let Some(s) = hit_sphere(camera.centre(x, y), DVec3::ZERO, 0.59) else {
                continue;
            };
            let ray = camera.centre(x, y);
            let normal = ray.at(s).normalize();
            let is_grazing = normal.dot(-ray.direction.normalize()) < 0.4;
            if !is_grazing && normal.dot(-light.normalize()) > facet.sin() {
                lit += 1;
                dark += usize::from(pixel[0] == 0);
            }
        }
        none_of(
            &format!("ball of {segments} segments, map {resolution}"),
            "dark pixels of the lit side",
            dark,
            lit,
        );
    }
}
