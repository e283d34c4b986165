//! A box that throws a hard shadow on a floor, and what a ray cast to the light says of it.

use super::super::Ledger;
use super::closed_form::{Camera, Ray, hit_box, hit_plane};
use super::draw::{Picture, frame, plan, scene};
use crate::plan::FrameRequest;
use glam::{DMat3, DVec3};
use serde_json::{Value, json};

/// A box on a floor, in light from one direction. What is lit is bright, what is not is black.
pub struct BoxOnFloor {
    /// Who looks at it.
    pub camera: Camera,
    /// The way the light travels.
    pub light: DVec3,
    /// Texels of the map.
    pub resolution: u32,
    /// The lowest corner of the box.
    pub min: DVec3,
    /// Its highest.
    pub max: DVec3,
    /// Half a side of the floor, at y = 0.
    pub floor: f64,
    /// Turns all of it about x, then y, then z, in degrees. The picture stays the same.
    pub turn: DVec3,
}

/// What a line of sight meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// Neither.
    Nothing,
    /// The floor.
    Floor,
    /// The box, and its outward normal.
    Box(DVec3),
}

impl BoxOnFloor {
    /// The document of the turned scene.
    pub fn document(&self) -> Value {
        let (centre, size) = ((self.min + self.max) / 2.0, self.max - self.min);
        let turn = quarter_turns(self.turn);
        let turned = |v: DVec3| (turn * v).to_array();
        let mut camera = self.camera.document();
        for key in ["position", "target", "up"] {
            let place = [0, 1, 2].map(|axis| camera[key][axis].as_f64().expect("a number"));
            camera[key] = json!(turned(place.into()));
        }
        let rotation = self.turn.to_array();
        json!({
            "camera": camera,
            "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#00f" } },
            "lights": { "sun": { "type": "directional", "direction": turned(self.light), "intensity": 4000,
                "shadow": { "filter": "hard", "resolution": self.resolution } } },
            "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1] } },
            "meshes": {
                "box": { "type": "box", "size": size.to_array() },
                "floor": { "type": "plane", "size": [2.0 * self.floor, 2.0 * self.floor] },
            },
            "instances": {
                "box": { "mesh": "box", "material": "white", "translation": turned(centre), "rotation_deg": rotation },
                "floor": { "mesh": "floor", "material": "white", "rotation_deg": rotation },
            },
            "render": self.camera.render(1),
        })
    }

    /// Side of a texel of the document's map in world units, the larger one.
    pub fn texel(document: &Value) -> f64 {
        let plan = plan(&scene(document), &FrameRequest::default());
        let scale = plan.shadows[0].faces()[0].view.scale;
        256.0 / scale[0].min(scale[1])
    }

    /// What a line of sight meets, and where.
    pub fn seen(&self, ray: Ray) -> (Seen, DVec3) {
        let floor = hit_plane(ray, DVec3::ZERO, DVec3::Y)
            .filter(|&s| ray.direction.y < 0.0 && ray.at(s).abs().max_element() < self.floor);
        let on_box = hit_box(ray, self.min, self.max);
        match (on_box, floor) {
            (Some(s), floor) if floor.is_none_or(|f| s < f) => {
                let p = ray.at(s);
                let depth =
                    |axis: usize| (p[axis] - self.min[axis]).abs().min((self.max[axis] - p[axis]).abs());
                let axis = (0..3).min_by(|&a, &b| depth(a).total_cmp(&depth(b))).expect("three axes");
                let mut normal = DVec3::ZERO;
                normal[axis] = if (p[axis] - self.max[axis]).abs() < (p[axis] - self.min[axis]).abs() {
                    1.0
                } else {
                    -1.0
                };
                (Seen::Box(normal), p)
            }
            (_, Some(s)) => (Seen::Floor, ray.at(s)),
            _ => (Seen::Nothing, ray.origin),
        }
    }

    /// Whether the light reaches a point of a surface with this normal, and points all around, up to
    /// `apart` from it in the plane across the light; `None` if not the same for all.
    fn lit(&self, p: DVec3, normal: DVec3, apart: f64) -> Option<bool> {
        let towards = -self.light.normalize();
        if normal.dot(towards) <= 0.0 {
            return Some(false);
        }
        let right = towards.any_orthonormal_vector();
        let up = towards.cross(right);
        let reaches = |[a, b]: [f64; 2]| {
            let across = right * a + up * b;
            // Back onto the surface, along the light; a hair above it.
            let origin = p + across - towards * (across.dot(normal) / towards.dot(normal)) + normal * 1e-9;
            hit_box(Ray { origin, direction: towards }, self.min, self.max).is_none()
        };
        let here = reaches([0.0, 0.0]);
        // A right angle between two directions reaches at most 1 % farther in than both show.
        let mut all = (0..24).flat_map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
            [0.5, 0.75, 1.0].map(|part| [cos * apart * part, sin * apart * part])
        });
        all.all(|d| reaches(d) == here).then_some(here)
    }

    /// Every pixel whose shadow is beyond doubt, and whether it is lit: half a pixel from any outline,
    /// and `apart` across the light from the border of any shadow.
    pub fn beyond_doubt(&self, apart: f64) -> Vec<(u32, u32, bool)> {
        let mut found = Vec::new();
        for (x, y) in self.camera.pixels() {
            let what = |ray: Ray| self.seen(ray).0;
            let Some(seen) = self.camera.steady(x, y, 0.5, what) else {
                continue;
            };
            let p = self.seen(self.camera.centre(x, y)).1;
            let normal = match seen {
                Seen::Nothing => continue,
                Seen::Floor => DVec3::Y,
                Seen::Box(normal) => normal,
            };
            found.extend(self.lit(p, normal, apart).map(|lit| (x, y, lit)));
        }
        found
    }

    /// Compares every pixel whose shadow is beyond doubt: outside the bound on the displacement of
    /// the shadow's edge, 2√2 · ½ texel across the light, and half a pixel.
    pub fn as_cast(&self, ledger: &mut Ledger, setting: &str) {
        let document = self.document();
        let apart = std::f64::consts::SQRT_2 * Self::texel(&document);
        let picture = Picture::new(frame(&scene(&document), &FrameRequest::default()));
        let (mut acne, mut leaks, mut lit, mut dark) = (0, 0, 0, 0);
        for (x, y, reached) in self.beyond_doubt(apart) {
            let pixel = picture.at(x, y);
            if reached {
                lit += 1;
                acne += usize::from(pixel[0] == 0);
            } else {
                dark += 1;
                leaks += usize::from(pixel[0] != 0);
            }
        }
        ledger.none_of(setting, "dark pixels in the light", acne, lit);
        ledger.none_of(setting, "lit pixels in the shadow", leaks, dark);
    }
}

/// Turns about x, then y, then z, each a whole number of quarters and so exact.
fn quarter_turns(deg: DVec3) -> DMat3 {
    let quarter = |deg: f64| match (deg / 90.0).rem_euclid(4.0) {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        3.0 => (-1.0, 0.0),
        _ => panic!("{deg}° is no quarter turn"),
    };
    let about = |axis: usize| {
        let (sin, cos) = quarter(deg[axis]);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
        (columns[a][a], columns[a][b], columns[b][a], columns[b][b]) = (cos, sin, -sin, cos);
        DMat3::from_cols(columns[0], columns[1], columns[2])
    };
    about(2) * about(1) * about(0)
}
