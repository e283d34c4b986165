//! Claims about cameras.

use super::scene;
use crate::limits::Limits;
use crate::math::Bounds;
use crate::plan::FrameRequest;
use crate::plan::request::Orbit;
use crate::scene::framing::resolve;
use crate::scene::{CameraFault, Lens, NewScene, Precondition, ResolvedCamera, Scene, Store};
use glam::DVec3;
use proptest::prelude::*;
use serde_json::{Value, json};

fn boxed(camera: Value) -> Scene {
    scene(&json!({
        "camera": camera,
        "meshes": { "box": { "type": "box", "size": [3, 1, 2] } },
        "instances": { "i": { "mesh": "box", "translation": [5, 6, 7] } }
    }))
}

fn camera(scene: &Scene, request: &FrameRequest) -> ResolvedCamera {
    resolve(scene, request, 800, 600).unwrap()
}

fn parameters(faults: Vec<CameraFault>) -> Vec<&'static str> {
    faults.into_iter().map(|fault| fault.parameter).collect()
}

/// The largest |x| and |y| of the corners in normalised device coordinates.
fn reach(camera: &ResolvedCamera, bounds: Bounds, aspect: f64) -> DVec3 {
    let Lens::Perspective { fov_y_deg } = camera.lens else { panic!("perspective") };
    let tan = libm::tan((fov_y_deg / 2.0).to_radians());
    let project = |corner: DVec3| {
        let v = corner - camera.eye;
        let z = v.dot(camera.forward);
        DVec3::new(v.dot(camera.right) / (z * tan * aspect), v.dot(camera.up) / (z * tan), 0.0).abs()
    };
    bounds.corners().map(project).into_iter().fold(DVec3::ZERO, DVec3::max)
}

fn assert_orthonormal(camera: &ResolvedCamera) {
    let axes = [camera.right, camera.up, -camera.forward];
    for (i, a) in axes.iter().enumerate() {
        for (j, b) in axes.iter().enumerate() {
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((a.dot(*b) - expected).abs() <= 1e-15, "{camera:?}");
        }
    }
    assert!(camera.right.cross(camera.up).dot(-camera.forward) > 0.0);
}

proptest! {
    #[test]
    fn automatic_framing_fills_nine_tenths_of_the_tighter_side(
        size in prop::array::uniform3(1e-3..1e3_f64), fov in 1.0..150.0_f64,
        width in 1_u32..4000, height in 1_u32..4000,
    ) {
        let scene = scene(&json!({
            "camera": { "fov_y_deg": fov },
            "meshes": { "box": { "type": "box", "size": size } },
            "instances": { "i": { "mesh": "box", "translation": [1e4, -1e4, 10] } }
        }));
        let camera = resolve(&scene, &FrameRequest::default(), width, height).unwrap();
        let reach = reach(&camera, scene.bounds(0.0).unwrap(), f64::from(width) / f64::from(height));
        prop_assert!((reach.max_element() - 0.9).abs() < 1e-6, "{reach}");
        assert_orthonormal(&camera);
    }

    #[test]
    fn every_basis_is_orthonormal(
        eye in prop::array::uniform3(-1e6..1e6_f64), up in prop::array::uniform3(-1.0..1.0_f64), scale in -30..30_i32,
    ) {
        prop_assume!(eye != [0.0; 3] && up != [0.0; 3]);
        let scale = 10_f64.powi(scale);
        let scene = scene(&json!({ "camera": { "position": eye.map(|x| x * scale), "up": up.map(|x| x * scale) } }));
        assert_orthonormal(&camera(&scene, &FrameRequest::default()));
    }
}

#[test]
fn automatic_framing_looks_from_its_direction_at_the_centre() {
    let scene = boxed(json!({}));
    let camera = camera(&scene, &FrameRequest::default());
    let centre = scene.bounds(0.0).unwrap().centre();
    let outward = (camera.eye - centre).normalize();
    assert!(outward.abs_diff_eq(DVec3::new(1.0, 0.6, 1.4).normalize(), 1e-14));
    assert!((camera.near / (camera.eye - centre).length() - 1e-3).abs() < 1e-15);
}

#[test]
fn what_is_not_framed_does_not_move_the_camera() {
    let with_floor = |framed: bool, visible: bool| {
        scene(&json!({
            "meshes": { "box": { "type": "box", "size": [3, 1, 2] }, "floor": { "type": "plane", "size": [200, 200] } },
            "instances": { "i": { "mesh": "box", "translation": [5, 6, 7], "visible": visible },
                           "j": { "mesh": "floor", "translation": [5, 5.5, 7], "framed": framed } }
        }))
    };
    let plain = boxed(json!({}));
    for (width, height) in [(800, 600), (300, 900)] {
        let at = |scene: &Scene| {
            let camera = resolve(scene, &FrameRequest::default(), width, height).unwrap();
            let [eye, target] = [camera.eye, camera.target].map(|point| point + scene.anchor);
            ResolvedCamera { eye, target, ..camera }
        };
        assert_eq!(at(&with_floor(false, true)), at(&plain));
        assert!((at(&with_floor(true, true)).eye - at(&plain).eye).length() > 50.0);
        // With nothing else to see, the floor is what there is to look at.
        assert!((at(&with_floor(false, false)).eye - at(&plain).eye).length() > 50.0);
    }
}

#[test]
fn a_model_that_is_replaced_is_framed_anew() {
    let store = Store::new(Limits::default());
    let mut new = NewScene::default();
    new.files.get_or_insert_default().insert("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into()).unwrap();
    let id = store.create(new).unwrap().id;
    let large = "v 0 0 0\nv 90 0 0\nv 0 90 0\nf 1 2 3\n";
    let scene = store.put_file(&id, "a.obj", large.into(), &Precondition::None).unwrap().scene;
    let reach =
        reach(&camera(&scene, &FrameRequest::default()), scene.framed_bounds().unwrap(), 800.0 / 600.0);
    assert!((reach.max_element() - 0.9).abs() < 1e-6, "{reach}");
}

#[test]
fn scenes_without_size_are_framed() {
    let point = json!({
        "meshes": { "m": { "type": "triangles", "positions": [[1, 1, 1], [1, 1, 1], [1, 1, 1]] } },
        "instances": { "i": { "mesh": "m" } }
    });
    for lens in [json!({}), json!({ "orthographic": { "height": 2 } })] {
        for mut json in [json!({}), point.clone()] {
            json["camera"] = lens.clone();
            let camera = camera(&scene(&json), &FrameRequest::default());
            assert!(camera.eye.is_finite() && camera.near > 0.0);
            assert_orthonormal(&camera);
        }
    }
}

#[test]
fn an_orthographic_camera_stands_clear_of_the_scene() {
    let scene = boxed(json!({ "orthographic": { "height": 0.1 } }));
    let camera = camera(&scene, &FrameRequest::default());
    for corner in scene.bounds(0.0).unwrap().corners() {
        assert!((corner - camera.eye).dot(camera.forward) > camera.near);
    }
}

#[test]
fn a_parallel_up_is_replaced() {
    for up in [[0.0, 1.0, 0.0], [0.0, -1.0, 1e-8], [0.0, 1e30, 0.0]] {
        let scene = scene(&json!({ "camera": { "position": [0, 5, 0], "up": up } }));
        let camera = camera(&scene, &FrameRequest::default());
        assert_orthonormal(&camera);
        assert_eq!(camera.forward, DVec3::NEG_Y);
    }
}

#[test]
fn orbits_are_about_the_target() {
    let scene = boxed(json!({ "position": [5, 6, 17], "target": [5, 6, 7] }));
    let target = DVec3::new(5.0, 6.0, 7.0) - scene.anchor;
    for (yaw_deg, pitch_deg, distance, expected) in [
        (0.0, 0.0, None, DVec3::new(0.0, 0.0, 10.0)),
        (90.0, 0.0, None, DVec3::new(10.0, 0.0, 0.0)),
        (180.0, 0.0, Some(3.0), DVec3::new(0.0, 0.0, -3.0)),
        (30.0, 90.0, Some(2.0), DVec3::new(0.0, 2.0, 0.0)),
        (0.0, -90.0, Some(2.0), DVec3::new(0.0, -2.0, 0.0)),
    ] {
        let orbit = Some(Orbit { yaw_deg, pitch_deg, distance });
        let camera = camera(&scene, &FrameRequest { orbit, ..FrameRequest::default() });
        assert_eq!(camera.eye - target, expected);
        assert_orthonormal(&camera);
    }
}

#[test]
fn from_above_the_far_side_is_up() {
    let scene = boxed(json!({ "position": [5, 6, 17], "target": [5, 6, 7] }));
    let up = |pitch_deg| {
        let orbit = Some(Orbit { yaw_deg: 30.0, pitch_deg, distance: None });
        camera(&scene, &FrameRequest { orbit, ..FrameRequest::default() }).up
    };
    assert!(up(90.0).abs_diff_eq(up(89.999), 1e-4));
    assert!(up(-90.0).abs_diff_eq(up(-89.999), 1e-4));
}

#[test]
fn time_turns_the_camera_about_its_target() {
    let scene = boxed(json!({ "position": [5, 6, 17], "target": [5, 6, 7], "orbit_deg_per_s": 45 }));
    let at = |t: f64| camera(&scene, &FrameRequest { t, ..FrameRequest::default() });
    let target = DVec3::new(5.0, 6.0, 7.0) - scene.anchor;
    assert_eq!(at(2.0).eye - target, DVec3::new(10.0, 0.0, 0.0));
    assert_eq!(at(8.0), at(0.0));
}

#[test]
fn eye_and_target_replace_their_part() {
    let scene = boxed(json!({}));
    let auto = camera(&scene, &FrameRequest::default());
    let eye = DVec3::new(5.0, 6.0, 27.0);
    let moved = camera(&scene, &FrameRequest { eye: Some(eye), ..FrameRequest::default() });
    assert_eq!(moved.eye + scene.anchor, eye);
    assert!(moved.forward.abs_diff_eq(DVec3::NEG_Z, 1e-12));
    let turned = camera(&scene, &FrameRequest { target: Some(DVec3::ZERO), ..FrameRequest::default() });
    assert_eq!(turned.eye, auto.eye);
}

#[test]
fn overrides_that_make_no_sense_in_the_scene_are_named() {
    let scene = boxed(json!({ "position": [5, 6, 17], "target": [5, 6, 7], "far": 50 }));
    let request =
        FrameRequest { eye: Some(DVec3::new(5.0, 6.0, 7.0)), near: Some(60.0), ..FrameRequest::default() };
    assert_eq!(parameters(resolve(&scene, &request, 1, 1).unwrap_err()), ["eye", "near"]);
    for (request, parameter) in [
        (FrameRequest { near: Some(60.0), ..FrameRequest::default() }, "near"),
        (FrameRequest { far: Some(0.1), ..FrameRequest::default() }, "far"),
        (FrameRequest { eye: Some(DVec3::new(5.0, 6.0, 7.0)), ..FrameRequest::default() }, "eye"),
        (FrameRequest { target: Some(DVec3::new(5.0, 6.0, 17.0)), ..FrameRequest::default() }, "target"),
    ] {
        assert_eq!(parameters(resolve(&scene, &request, 8, 6).unwrap_err()), [parameter]);
    }
}
