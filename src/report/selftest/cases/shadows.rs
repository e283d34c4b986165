//! Shadow maps in stiff settings: grazing light, huge floors, flat scenes, tiny maps.

pub mod cube;
pub mod kernels;

use crate::limits::Limits;
use crate::pipeline::shade::BLOCK;
use crate::pipeline::shade::varyings::Receivers;
use crate::pipeline::shadow::{ShadowMap, render_maps};
use crate::plan::{Elisions, FrameRequest};
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::box_on_floor::BoxOnFloor;
use crate::report::selftest::instruments::closed_form::Camera;
use crate::report::selftest::instruments::draw::{Picture, frame, level, plan, scene, work};
use crate::scene::{Document, compile};
use glam::DVec3;
use serde_json::{Value, json};

/// A square of side 2 in the plane through the origin whose normal makes the angle `slope` with the
/// direction towards the light, seen head on; lit it is white, in shadow black.
fn lit_plane(slope_deg: f64, azimuth: f64, resolution: u32, extra: &[(DVec3, f64)]) -> Value {
    // The square casts on what lies behind it, so it is in its own map.
    let light = DVec3::new(-0.41, -0.83, -0.37).normalize();
    let (right, up) = light.any_orthonormal_pair();
    let across = right * azimuth.cos() + up * azimuth.sin();
    let (sin, cos) = slope_deg.to_radians().sin_cos();
    let normal = across * sin - light * cos;
    let (a, b) = normal.any_orthonormal_pair();
    let (a, b) = (a * 0.8 + b * 0.6, b * 0.8 - a * 0.6);
    let square = |centre: DVec3, half: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| (centre + (a * x + b * y) * half).to_array())
    };
    let mut positions = square(DVec3::ZERO, 1.0).to_vec();
    for &(offset, half) in extra {
        positions.extend(square(a * offset.x + b * offset.y + normal * offset.z, half));
    }
    let quads = positions.len() / 4;
    let indices: Vec<_> = (0..quads).flat_map(|q| [0, 1, 2, 0, 2, 3].map(|i| 4 * q + i)).collect();
    let camera = Camera::orthographic((normal * 50.0).to_array(), [0.0; 3], 1.4, 64, 64);
    json!({
        "camera": camera.document(),
        "environment": { "ambient": [0, 0, 0] },
        "lights": { "sun": { "type": "directional", "direction": light.to_array(), "intensity": 1.0 / cos,
            "shadow": { "filter": "hard", "resolution": resolution } } },
        "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
        "meshes": {
            "square": { "type": "triangles", "positions": positions, "indices": indices },
            "behind": { "type": "sphere" },
        },
        "instances": {
            "square": { "mesh": "square", "material": "white" },
            "behind": { "mesh": "behind", "translation": (light * 30.0).to_array(), "casts_shadow": false },
        },
        "render": camera.render(1),
    })
}

const SLOPES: [f64; 10] = [0.0, 1.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.7, 89.9];

/// B33, k = 0.
pub fn a_lit_plane_does_not_shadow_itself_at_any_slope_or_resolution(ledger: &mut Ledger) {
    for resolution in [64, 257, 1024, 4096] {
        let (mut shadowed, mut pixels) = (0, 0);
        for slope in SLOPES {
            for azimuth in if resolution > 1024 { vec![0.7] } else { vec![0.0, 0.7, 1.6, 4.0] } {
                let scene = scene(&lit_plane(slope, azimuth, resolution, &[]));
                let plan = plan(&scene, &FrameRequest::default());
                assert_eq!(plan.shadows.len(), 1, "the plane is in its own map");
                let picture = Picture::new(frame(&scene, &FrameRequest::default()));
                pixels += picture.pixels.len();
                shadowed += picture.pixels.iter().filter(|pixel| pixel[0] < 250).count();
            }
        }
        ledger.none_of(&format!("slopes 0–89.9°, map {resolution}"), "shadowed pixels", shadowed, pixels);
    }
}

/// The control of B33: what the offset prevents is there without it.
pub fn without_an_offset_a_plane_shadows_itself(ledger: &mut Ledger) {
    for (bias, expected) in [(0.0, true), (0.5, true), (1.0, false)] {
        let mut document = lit_plane(60.0, 0.7, 64, &[]);
        document["lights"]["sun"]["shadow"]["bias"] = json!(bias);
        let picture = Picture::of(&document);
        let acne = picture.pixels.iter().any(|pixel| pixel[0] < 250);
        ledger.holds(&format!("bias {bias}"), "control: acne other than expected", acne == expected);
    }
}

/// B33: the map is a thousand times as large as what is looked at, and its texels likewise.
pub fn a_plane_in_a_map_a_thousand_times_its_size_does_not_shadow_itself(ledger: &mut Ledger) {
    let (mut shadowed, mut pixels) = (0, 0);
    for slope in SLOPES {
        for azimuth in [0.3, 2.1] {
            let far_off = [(DVec3::new(1000.0, 300.0, 0.0), 1.0), (DVec3::new(-800.0, -500.0, 0.0), 3.0)];
            let picture = Picture::of(&lit_plane(slope, azimuth, 1024, &far_off));
            pixels += picture.pixels.len();
            shadowed += picture.pixels.iter().filter(|pixel| pixel[0] < 250).count();
        }
    }
    ledger.none_of("map 1000 × as large", "shadowed pixels", shadowed, pixels);
}

fn setting() -> BoxOnFloor {
    BoxOnFloor {
        camera: Camera::perspective([-2.2, 4.2, 2.4], [-0.2, 0.2, -0.3], 50.0, 128, 96),
        light: DVec3::new(-0.5, -1.0, -0.3),
        resolution: 512,
        min: DVec3::new(-0.5, 0.0, -0.4),
        max: DVec3::new(0.4, 1.0, 0.5),
        floor: 4.0,
        turn: DVec3::ZERO,
    }
}

/// B33 and B34: the floor is 1000 × as large as the box and dilutes nothing.
pub fn a_floor_a_thousand_times_larger_than_the_casters_keeps_their_shadows_sharp(ledger: &mut Ledger) {
    for resolution in [64, 512, 4096] {
        let setting = BoxOnFloor { floor: 500.0, resolution, ..setting() };
        setting.as_cast(ledger, &format!("floor 1000 × the box, map {resolution}"));
    }
}

/// B34.
pub fn shadows_begin_where_a_box_stands_and_walls_do_not_leak(ledger: &mut Ledger) {
    for (name, min, max) in [
        ("box", [-0.5, 0.0, -0.4], [0.4, 1.0, 0.5]),
        ("thin wall", [-1.5, 0.0, -0.01], [1.0, 0.8, 0.01]),
        ("wall of a few texels", [-0.02, 0.0, -1.2], [0.03, 0.6, 1.0]),
        ("pole", [-0.03, 0.0, -0.03], [0.03, 1.5, 0.03]),
        ("slab that floats", [-0.6, 0.3, -0.5], [0.5, 0.32, 0.6]),
    ] {
        for (i, light) in [[-0.5, -1.0, -0.3], [0.7, -0.5, -0.6], [0.3, -1.0, 0.4], [-3.0, -1.0, 1.1]]
            .into_iter()
            .enumerate()
        {
            for resolution in [256, 2048] {
                let setting = BoxOnFloor {
                    min: min.into(),
                    max: max.into(),
                    light: light.into(),
                    resolution,
                    ..setting()
                };
                setting.as_cast(ledger, &format!("{name}, light {i}, map {resolution}"));
            }
        }
    }
}

/// Quarters that bring the light from above to every axis.
const TURNS: [[i32; 3]; 6] = [[0, 0, 0], [90, 0, 0], [180, 0, 0], [-90, 0, 0], [0, 0, 90], [0, 0, -90]];

/// B35.
pub fn light_along_every_axis_gives_the_same_shadow(ledger: &mut Ledger) {
    for turn in TURNS {
        for light in [[0.0, -1.0, 0.0], [-1e-9, -1.0, 1e-9]] {
            let min = DVec3::new(-0.5, 0.4, -0.4);
            let turn = DVec3::from_array(turn.map(f64::from));
            let setting = BoxOnFloor { turn, light: light.into(), min, ..setting() };
            setting.as_cast(ledger, &format!("turned by {turn}, light {light:?}"));
        }
    }
}

/// B36.
pub fn casters_far_before_the_receivers_still_shade_them(ledger: &mut Ledger) {
    for height in [10.0, 1e3, 1e5] {
        let light = DVec3::new(-0.3 / height, -1.0, 0.2 / height);
        let (min, max) = (DVec3::new(-0.5, height, -0.4), DVec3::new(0.4, height + 1.0, 0.5));
        let setting = BoxOnFloor { min, max, light, ..setting() };
        setting.as_cast(ledger, &format!("caster {height:e} above"));
    }
}

/// What a case does to a document.
type Change<'a> = &'a dyn Fn(&mut Value);

/// B36.
pub fn flat_and_pointlike_scenes_are_lit_and_finite(ledger: &mut Ledger) {
    let whole = setting().document();
    let flat = |change: &dyn Fn(&mut Value)| {
        let mut document = whole.clone();
        change(&mut document);
        let picture = Picture::of(&document);
        let dark = picture.pixels.iter().filter(|pixel| pixel[..3] == [0; 3]).count();
        (dark, picture.pixels.len())
    };
    let cases: [(&str, Change); 5] = [
        ("box shrunk to a point", &|d| d["instances"]["box"]["scale"] = json!(0)),
        ("everything shrunk to points", &|d| d["render"]["model_scale"] = json!(1e-300)),
        ("two floors in one plane", &|d| d["instances"]["box"] = d["instances"]["floor"].clone()),
        ("nothing but the floor", &|d| d["instances"] = json!({ "floor": d["instances"]["floor"] })),
        ("light along the floor", &|d| {
            d["lights"]["sun"]["direction"] = json!([1, 0, 0]);
            // Nothing of the floor faces the light: only the sky is bright.
            d["environment"]["ambient"] = json!([1, 1, 1]);
            d["instances"] = json!({ "floor": d["instances"]["floor"] });
        }),
    ];
    for (name, change) in cases {
        let (dark, of) = flat(change);
        ledger.none_of(name, "dark pixels", dark, of);
    }
}

/// B38.
pub fn maps_of_any_size_are_defined(ledger: &mut Ledger) {
    for resolution in [1, 2, 3, 65, 1000] {
        let picture = Picture::of(&BoxOnFloor { resolution, floor: 500.0, ..setting() }.document());
        // Ten boxes away no shadow reaches.
        let far = Camera::perspective([12.0, 2.0, 10.0], [12.0, 0.0, 12.0], 40.0, 64, 48);
        let lit = Picture::of(&BoxOnFloor { resolution, floor: 500.0, camera: far, ..setting() }.document());
        let dark = lit.pixels.iter().filter(|pixel| pixel[0] == 0).count();
        ledger.none_of(&format!("map {resolution}"), "dark pixels outside the map", dark, lit.pixels.len());
        assert!(picture.pixels.iter().any(|pixel| pixel[0] > 0));
    }
    let with = |resolution: u64| {
        let mut document = setting().document();
        document["lights"]["sun"]["shadow"]["resolution"] = json!(resolution);
        document
    };
    let faults = Document::from_json(&with(0)).expect_err("0 is refused");
    let is_named = faults.iter().any(|fault| fault.pointer == "/lights/sun/shadow/resolution");
    ledger.holds("0", "map sizes not refused", is_named);
    let large = Document::from_json(&with(16_385)).expect("a number like any other");
    let refused = compile(&large, &crate::scene::Files::default(), None, &Limits::default()).is_err();
    ledger.holds("16385", "map sizes not refused", refused);
}

/// B38: a gigabyte.
pub fn the_largest_map_is_right(ledger: &mut Ledger) {
    BoxOnFloor { resolution: 16_384, ..setting() }.as_cast(ledger, "map 16384");
}

/// What a map says of one place: texels from its centre, and depth.
fn visible(map: &ShadowMap, place: [f32; 3]) -> f32 {
    let receivers = Receivers { place: place.map(|c| [c; BLOCK]), ..Receivers::default() };
    let mut visibility = [0.5; BLOCK];
    map.visibility(level(), &receivers, 1, &mut visibility);
    visibility[0]
}

/// B38.
pub fn outside_the_map_is_lit_and_its_border_is_part_of_it(ledger: &mut Ledger) {
    // A roof larger than what it shades: the map is as large as the floor and full to its border.
    let roof = BoxOnFloor {
        min: DVec3::new(-9.0, 3.0, -9.0),
        max: DVec3::new(9.0, 3.1, 9.0),
        floor: 1.0,
        resolution: 100,
        ..setting()
    };
    let mut document = roof.document();
    document["instances"]["box"]["receives_shadow"] = json!(false);
    let plan = plan(&scene(&document), &FrameRequest::default());
    let maps = render_maps(&plan.shadows, Elisions::ALL, &work()).expect("nobody cancels");
    let map = &maps[0];
    let behind = 1e-3;
    for (inside, outside) in [
        (49.999, 50.001),
        (-49.999, -50.001),
        (0.0, 1e9),
        (0.0, -1e30),
        (0.0, f32::INFINITY),
        (0.0, f32::NAN),
    ] {
        for axis in [0, 1] {
            let at = |c: f32| {
                let mut place = [0.5, 0.5, behind];
                place[axis] = c;
                visible(map, place)
            };
            let setting = format!("axis {axis}: {inside}, {outside}");
            ledger.holds(
                &setting,
                "dark beyond the border, or lit on it",
                [at(inside), at(outside)] == [0.0, 1.0],
            );
        }
    }
    // Before all casters, and before the light itself.
    for depth in [1.0, 7.0] {
        let seen = visible(map, [0.0, 0.0, depth]);
        ledger.holds(&format!("depth {depth}"), "dark before all casters", seen == 1.0);
    }
}

/// B37: maps are fitted to the scene, so they do not know the camera.
pub fn maps_are_the_same_wherever_the_camera_is(ledger: &mut Ledger) {
    let lamp = json!({ "type": "point", "position": [-1, 2, 1], "shadow": { "resolution": 64 } });
    let maps = |step: u32, draw: bool| {
        let aside = f64::from(step) * 0.004;
        let camera = Camera::perspective([-2.2 + aside, 4.2, 2.4 - aside], [-0.2, 0.2, -0.3], 50.0, 128, 96);
        let mut document = BoxOnFloor { camera, resolution: 100, ..setting() }.document();
        document["lights"]["lamp"] = lamp.clone();
        let plan = plan(&scene(&document), &FrameRequest::default());
        let views: Vec<_> = plan.shadows.iter().flat_map(|pass| pass.faces()).map(|face| face.view).collect();
        (views, draw.then(|| render_maps(&plan.shadows, Elisions::ALL, &work()).expect("nobody cancels")))
    };
    let (views, first) = maps(0, true);
    assert!(views.len() > 2, "a sun and sides of a lamp");
    let moved = (1..100).filter(|&step| maps(step, false).0 != views).count();
    ledger.none_of("100 cameras", "views of lights that moved", moved, 99);
    let differing = [1, 50, 99].into_iter().filter(|&step| maps(step, true).1 != first).count();
    ledger.none_of("100 cameras", "differing maps", differing, 3);
}

pub fn more_texels_than_a_frame_may_have_are_refused(ledger: &mut Ledger) {
    let mut document = setting().document();
    let lamp = |x: u32| json!({ "type": "point", "position": [x, 2, 1], "shadow": { "filter": "hard", "resolution": 8192 } });
    document["lights"] = (0..3).map(|i| (format!("lamp {i}"), lamp(i))).collect();
    let refused = crate::plan::Plan::new(&scene(&document), &FrameRequest::default(), &Limits::default());
    let error = refused.expect_err("too many texels").to_string();
    ledger.holds(&error, "too many texels not refused by name", error.contains("texels of all shadow maps"));
}
