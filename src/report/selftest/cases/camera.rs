//! Cameras: bad ones are refused, extreme ones draw what a ray sees (B16 – B18, B20).

use super::coverage::SNAP_BOUND;
use crate::math::{Projection, View};
use crate::plan::{FrameRequest, Output};
use crate::report::random::Random;
use crate::report::selftest::Ledger;
use crate::report::selftest::instruments::draw;
use crate::report::selftest::instruments::oracle::geometric::{self, Solid};
use crate::report::selftest::instruments::worst::Worst;
use crate::scene::framing;
use glam::DVec3;
use serde_json::{Value, json};

/// A camera by its own numbers.
#[derive(Clone, Copy)]
pub struct Camera {
    pub eye: DVec3,
    pub target: DVec3,
    pub up: DVec3,
    pub fov_y_deg: f64,
    pub near: f64,
    pub far: f64,
    /// Orthographic with this height of the view.
    pub height: Option<f64>,
    /// Whether backs are seen.
    pub two_sided: bool,
    pub size: [u32; 2],
}

impl Camera {
    pub const STANDARD: Self = Self {
        eye: DVec3::new(1.0, 2.0, 5.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y_deg: 45.0,
        near: 0.1,
        far: f64::INFINITY,
        height: None,
        two_sided: true,
        size: [800, 600],
    };

    /// A document of triangles, one an instance, in the order of their places.
    pub fn document(&self, triangles: &[[DVec3; 3]]) -> Value {
        let mut document = json!({
            "camera": { "position": self.eye.to_array(), "target": self.target.to_array(), "up": self.up.to_array(),
                        "fov_y_deg": self.fov_y_deg, "near": self.near },
            "render": { "width": self.size[0], "height": self.size[1], "cull": if self.two_sided { "none" } else { "back" } },
        });
        if let Some(height) = self.height {
            document["camera"]["orthographic"] = json!({ "height": height });
        }
        if self.far.is_finite() {
            document["camera"]["far"] = json!(self.far);
        }
        for (i, triangle) in triangles.iter().enumerate() {
            let name = format!("t{i:04}");
            let positions = triangle.map(|p| p.to_array());
            document["meshes"][&name] = json!({ "type": "triangles", "positions": positions });
            document["instances"][&name] = json!({ "mesh": name });
        }
        document
    }

    /// The same as the oracle sees it, with the eye at zero.
    pub fn view(&self) -> View {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        let [width, height] = self.size;
        let half = f64::from(height) * 128.0;
        let (projection, scale) = match self.height {
            Some(height) => (Projection::Orthographic, half / (height / 2.0)),
            None => (Projection::Perspective, half / (self.fov_y_deg / 2.0).to_radians().tan()),
        };
        View {
            eye: DVec3::ZERO,
            right,
            up: right.cross(forward),
            forward,
            projection,
            scale: [scale; 2],
            near: self.near,
            far: self.far,
            width,
            height,
        }
    }

    pub fn solids(&self, triangles: &[[DVec3; 3]]) -> Vec<Solid> {
        let about_eye: Vec<_> = triangles.iter().map(|t| t.map(|p| p - self.eye)).collect();
        let two_sided = self.two_sided;
        let solids = geometric::solids(&about_eye).into_iter();
        solids.map(|solid| Solid { two_sided, ..solid }).collect()
    }

    /// Draws each scene's triangles as instances and holds the pictures to what rays see.
    pub fn sees_what_rays_see(&self, ledger: &mut Ledger, case: &str, scenes: &[Vec<[DVec3; 3]>]) {
        let view = self.view();
        let (mut certain, mut uncertain, mut perimeter, mut seen, mut all) = (0, 0, 0.0, 0, 0);
        for triangles in scenes {
            let drawn = draw::values_of(&self.document(triangles), Output::Instance);
            let drawn: Vec<u32> = drawn.into_iter().map(u32::from).collect();
            let solids = self.solids(triangles);
            let answers = geometric::seen(&solids, &view, 1);
            let differences = geometric::compare(&drawn, &answers);
            certain += differences.certain;
            uncertain += differences.uncertain;
            perimeter += geometric::perimeter(&solids, &view);
            seen += answers.iter().filter(|a| !a.uncertain && a.id != 0).count();
            all += drawn.len();
        }
        assert!(seen > all / 40, "{case}: {seen} pixels are too few to show anything");
        ledger.at_most(case, "pixels differing outside the band", f64::from(certain), 0.0);
        let per_pixel = f64::from(uncertain) / perimeter;
        ledger.at_most(case, "differing pixels per px of perimeter", per_pixel, SNAP_BOUND);
    }
}

/// Triangles of which each has a range of distances of its own, between `nearest` and `farthest`, so
/// that no two intersect: where they would, snapping moves the line in which they meet.
pub fn shells(
    rng: &mut Random,
    count: usize,
    camera: &Camera,
    nearest: f64,
    farthest: f64,
) -> Vec<[DVec3; 3]> {
    let view = camera.view();
    let half = [view.width, view.height].map(|n| f64::from(n) * 128.0);
    let shell = (farthest / nearest).powf(1.0 / count as f64);
    let mut triangles: Vec<_> = (0..count)
        .map(|i| {
            let near = nearest * shell.powf(i as f64);
            let middle = [0; 2].map(|_| rng.between(-1.0, 1.0));
            [0; 3].map(|_| {
                let w = near * rng.between(1.0, 1.0 + (shell - 1.0) * 0.999);
                let at = |axis: usize, part: f64| (middle[axis] + part) * half[axis] / view.scale[axis] * w;
                let (x, y) = (at(0, rng.between(-0.6, 0.6)), at(1, rng.between(-0.6, 0.6)));
                camera.eye + view.right * x + view.up * y + view.forward * w
            })
        })
        .collect();
    for i in 0..count {
        triangles.swap(i, rng.below(count));
    }
    triangles
}

pub fn b16_bad_cameras_are_refused_by_name(ledger: &mut Ledger) {
    let bad = [
        ("near", json!({ "near": 0 })),
        ("near", json!({ "near": -0.0 })),
        ("near", json!({ "near": -1 })),
        ("near", json!({ "near": "NaN" })),
        ("far", json!({ "far": 0 })),
        ("far", json!({ "far": 0.1 })),
        ("far", json!({ "near": 2, "far": 1.999 })),
        ("far", json!({ "near": 2, "far": 2 })),
        ("far", json!({ "far": -5 })),
        ("target", json!({ "target": [1, 2, 3] })),
        ("fov_y_deg", json!({ "fov_y_deg": 0 })),
        ("fov_y_deg", json!({ "fov_y_deg": 180 })),
        ("fov_y_deg", json!({ "fov_y_deg": 200 })),
        ("fov_y_deg", json!({ "fov_y_deg": -45 })),
        ("fov_y_deg", json!({ "fov_y_deg": 1e-300 })),
        ("fov_y_deg", json!({ "fov_y_deg": 180.0 - 1e-12 })),
        ("up", json!({ "up": [0, 0, 0] })),
        ("up", json!({ "up": [0, -0.0, 0] })),
        ("up", json!({ "up": [0, "NaN", 0] })),
    ];
    for (field, camera) in bad {
        let mut document = json!({ "camera": camera });
        document["camera"]["position"] = json!([1, 2, 3]);
        let faults = draw::faults(&document);
        let pointer = format!("/camera/{field}");
        let is_named = faults.len() == 1 && faults[0].starts_with(&pointer);
        ledger.holds(&document.to_string(), "bad cameras not refused by name", is_named);
    }
}

pub fn b16_a_slab_of_a_millionth_shows_what_lies_in_it(ledger: &mut Ledger) {
    let camera = Camera {
        eye: DVec3::new(0.3, -0.2, 7.0),
        target: DVec3::new(0.3, -0.2, 0.0),
        near: 5.0,
        far: 5.0 * (1.0 + 1e-6),
        ..Camera::STANDARD
    };
    // Nearly square to the line of sight, so that they run through the slab within the picture, and
    // side by side, so that none hides or meets another.
    let mut rng = ledger.random(30);
    let mut triangle = |i: u32| {
        let middle = [f64::from(i % 8) - 3.5, f64::from(i / 8) - 2.5].map(|c| c * 0.66);
        [0; 3].map(|_| {
            let [x, y] = middle.map(|c| c + rng.between(-0.32, 0.32));
            DVec3::new(0.3 + x, y - 0.2, 2.0 - rng.between(-3.0, 8.0) * 1e-6)
        })
    };
    let mut scene = || (0..48).map(&mut triangle).collect();
    let scenes = [scene(), scene(), scene(), scene()];
    camera.sees_what_rays_see(ledger, "slab", &scenes);
    let orthographic = Camera { height: Some(4.2), ..camera };
    orthographic.sees_what_rays_see(ledger, "orthographic slab", &scenes);
}

pub fn b17_the_narrowest_and_the_widest_view_show_what_rays_see(ledger: &mut Ledger) {
    let mut rng = ledger.random(31);
    let target = DVec3::new(-300.0, 517.0, 120.0);
    let eye = target + DVec3::new(613.0, 411.0, -877.0);
    for (fov_y_deg, nearest, farthest) in
        [(1e-3, 500.0, 2000.0), (0.1, 20.0, 1e5), (45.0, 0.08, 1e4), (150.0, 0.08, 1e3), (179.9, 0.08, 50.0)]
    {
        let camera = Camera { eye, target, fov_y_deg, ..Camera::STANDARD };
        let triangles = shells(&mut rng, 60, &camera, nearest, farthest);
        camera.sees_what_rays_see(ledger, &format!("{fov_y_deg}°"), &[triangles]);
    }
}

pub fn b18_up_along_the_line_of_sight_is_replaced_and_said(ledger: &mut Ledger) {
    let mut rng = ledger.random(32);
    let directions = [
        (DVec3::NEG_Y, DVec3::X),
        (DVec3::Y, DVec3::X),
        (DVec3::NEG_Z, DVec3::X),
        (DVec3::X, DVec3::Y),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::X),
        (DVec3::new(-2.0, 0.5, 3.0), DVec3::Y),
        (DVec3::new(2.0, -4.0, 0.25), DVec3::Z),
    ];
    for (direction, stand_in) in directions {
        for (tilt, replaced) in [(0.0, true), (1e-7, true), (1e-5, false)] {
            for sign in [1.0, -1.0] {
                let sideways = direction.any_orthonormal_vector() * direction.length() * tilt;
                let target = DVec3::new(0.5, -0.25, 0.125);
                let camera = Camera {
                    eye: target - direction * 2.0,
                    target,
                    up: (direction + sideways) * sign,
                    size: [160, 120],
                    ..Camera::STANDARD
                };
                let up = if replaced { stand_in } else { camera.up };
                // What the oracle is told is what the document is to be understood as.
                let understood = Camera { up, ..camera };
                let triangles = shells(&mut rng, 12, &understood, 0.5, 20.0);
                let document = camera.document(&triangles);
                let scene = draw::scene(&document);
                let warned = scene.warnings.iter().any(|w| w.detail.contains("up is parallel"));
                let setting = format!("{direction} tilted by {tilt:e}");
                ledger.holds(&setting, "replaced or kept unsaid", warned == replaced);
                let settled =
                    framing::resolve(&scene, &FrameRequest::default(), 160, 120).expect("it is legal");
                let basis = [settled.right, settled.up, settled.forward];
                let mut worst = Worst::default();
                for i in 0..3 {
                    for j in 0..3 {
                        let expected = if i == j { 1.0 } else { 0.0 };
                        worst.note((basis[i].dot(basis[j]) - expected).abs());
                    }
                }
                ledger.at_most(
                    &format!("{direction}, {tilt}"),
                    "off an orthonormal basis",
                    worst.largest(),
                    1e-15,
                );
                let drawn = draw::values_of(&document, Output::Instance);
                let drawn: Vec<u32> = drawn.into_iter().map(u32::from).collect();
                // With up 1e-5 from the line of sight, the oracle's own basis is good to 1e-11.
                let answers = geometric::seen(&understood.solids(&triangles), &understood.view(), 1);
                let differences = geometric::compare(&drawn, &answers);
                let certain = f64::from(differences.certain);
                ledger.at_most(&setting, "pixels differing outside the band", certain, 0.0);
            }
        }
    }
}

pub fn b20_a_speck_before_the_lens_and_a_mountain_are_both_seen(ledger: &mut Ledger) {
    let mut rng = ledger.random(34);
    let camera = Camera { near: 1e-6, ..Camera::STANDARD };
    // One in each factor of 1.35 from a hundredth of a millimetre to a thousand kilometres.
    let triangles = shells(&mut rng, 84, &camera, 1e-5, 1e6);
    camera.sees_what_rays_see(ledger, "", &[triangles]);
}

pub fn backs_are_culled_as_a_ray_sees_them(ledger: &mut Ledger) {
    let mut rng = ledger.random(35);
    for height in [None, Some(3.0)] {
        let camera = Camera { height, two_sided: false, ..Camera::STANDARD };
        let triangles = shells(&mut rng, 120, &camera, 0.05, 1e3);
        camera.sees_what_rays_see(ledger, "culling", &[triangles]);
    }
}
