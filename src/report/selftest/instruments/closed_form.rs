//! What a picture must show, computed in f64 from the formulas alone and by none of the library's code.

use super::worst::Worst;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// A camera without roll.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Where it stands.
    pub eye: DVec3,
    /// What is in the middle of its picture.
    pub target: DVec3,
    /// How much it sees.
    pub lens: Lens,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// How much a camera sees.
#[derive(Clone, Copy, Debug)]
pub enum Lens {
    /// Full vertical angle in degrees.
    Perspective(f64),
    /// Full height of the view.
    Orthographic(f64),
}

/// A half-line `origin + s · direction`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Where it goes, of any length.
    pub direction: DVec3,
}

impl Ray {
    /// The point of the parameter `s`.
    pub fn at(&self, s: f64) -> DVec3 {
        self.origin + self.direction * s
    }
}

impl Camera {
    /// With a full vertical angle.
    pub fn perspective(eye: [f64; 3], target: [f64; 3], fov_y_deg: f64, width: u32, height: u32) -> Self {
        Self { eye: eye.into(), target: target.into(), lens: Lens::Perspective(fov_y_deg), width, height }
    }

    /// With a full height of the view.
    pub fn orthographic(eye: [f64; 3], target: [f64; 3], view: f64, width: u32, height: u32) -> Self {
        Self { eye: eye.into(), target: target.into(), lens: Lens::Orthographic(view), width, height }
    }

    /// Right, up and forward.
    pub fn axes(&self) -> [DVec3; 3] {
        let forward = (self.target - self.eye).normalize();
        let aside = if forward.cross(DVec3::Y).length() > 1e-6 { DVec3::Y } else { DVec3::NEG_Z };
        let right = forward.cross(aside).normalize();
        [right, right.cross(forward), forward]
    }

    /// The line of sight through the picture at (x, y): pixel units from the upper left corner. Its
    /// parameter is the distance along the axis.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let [right, up, forward] = self.axes();
        let half = f64::from(self.height) / 2.0;
        let (across, above) = ((x - f64::from(self.width) / 2.0) / half, (half - y) / half);
        match self.lens {
            Lens::Perspective(fov) => {
                let t = (fov / 2.0).to_radians().tan();
                Ray { origin: self.eye, direction: forward + right * (across * t) + up * (above * t) }
            }
            Lens::Orthographic(view) => {
                let t = view / 2.0;
                Ray { origin: self.eye + right * (across * t) + up * (above * t), direction: forward }
            }
        }
    }

    /// The line of sight through a pixel's centre.
    pub fn centre(&self, x: u32, y: u32) -> Ray {
        self.ray(f64::from(x) + 0.5, f64::from(y) + 0.5)
    }

    /// Where a point is seen, in pixel units.
    pub fn project(&self, p: DVec3) -> DVec2 {
        let [right, up, forward] = self.axes();
        let p = p - self.eye;
        let half = f64::from(self.height) / 2.0;
        let q = match self.lens {
            Lens::Perspective(fov) => p.dot(forward) * (fov / 2.0).to_radians().tan(),
            Lens::Orthographic(view) => view / 2.0,
        };
        DVec2::new(f64::from(self.width) / 2.0 + p.dot(right) / q * half, half - p.dot(up) / q * half)
    }

    /// The same camera as a document has it.
    pub fn document(&self) -> Value {
        let (eye, target) = (self.eye.to_array(), self.target.to_array());
        let up = self.axes()[1].to_array();
        match self.lens {
            Lens::Perspective(fov) => {
                json!({ "position": eye, "target": target, "up": up, "fov_y_deg": fov })
            }
            Lens::Orthographic(view) => {
                json!({ "position": eye, "target": target, "up": up, "orthographic": { "height": view } })
            }
        }
    }

    /// The picture's size as a document has it.
    pub fn render(&self, samples: u32) -> Value {
        json!({ "width": self.width, "height": self.height, "samples": samples })
    }

    /// Every pixel's column and row.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let width = self.width;
        (0..width * self.height).map(move |i| (i % width, i / width))
    }

    /// What `f` says of a pixel's centre, if it says the same of the points `px` pixels around it.
    pub fn steady<T: PartialEq>(&self, x: u32, y: u32, px: f64, f: impl Fn(Ray) -> T) -> Option<T> {
        let (cx, cy) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let here = f(self.ray(cx, cy));
        let around = |[dx, dy]: [f64; 2]| f(self.ray(cx + dx * px, cy + dy * px)) == here;
        EIGHT.into_iter().all(around).then_some(here)
    }
}

/// Eight directions.
pub const EIGHT: [[f64; 2]; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [0.7, 0.7], [0.7, -0.7], [-0.7, 0.7], [-0.7, -0.7]];

/// Where a ray meets the plane through `point`, ahead of its origin.
pub fn hit_plane(ray: Ray, point: DVec3, normal: DVec3) -> Option<f64> {
    let s = (point - ray.origin).dot(normal) / ray.direction.dot(normal);
    (s.is_finite() && s > 0.0).then_some(s)
}

/// Where a ray enters a sphere.
pub fn hit_sphere(ray: Ray, centre: DVec3, radius: f64) -> Option<f64> {
    let (o, d) = (ray.origin - centre, ray.direction);
    let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - radius * radius);
    let root = b * b - a * c;
    let s = (-b - root.sqrt()) / a;
    (root > 0.0 && s > 0.0).then_some(s)
}

/// Where a ray enters an axis-parallel box.
pub fn hit_box(ray: Ray, min: DVec3, max: DVec3) -> Option<f64> {
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        if d == 0.0 {
            if o < min[axis] || o > max[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((min[axis] - o) / d, (max[axis] - o) / d);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave && enter > 0.0).then_some(enter)
}

/// sRGB encoding of a linear value, 0–1.
pub fn encode(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

/// Linear value of an sRGB code.
pub fn decode(code: u8) -> f64 {
    let c = f64::from(code) / 255.0;
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// The code of a linear value.
#[expect(clippy::cast_possible_truncation, reason = "an encoded value lies in 0–1")]
pub fn code(linear: f64) -> u8 {
    (encode(linear) * 255.0 + 0.5).floor() as u8
}

/// How far a pixel is from a linear colour: the largest difference of its channels, in codes.
pub fn codes_apart(pixel: [u8; 4], linear: DVec3) -> f64 {
    (0..3).map(|c| (f64::from(pixel[c]) - 255.0 * encode(linear[c])).abs()).collect::<Worst>().largest()
}

/// What a surface does with light.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Colour in diffuse light.
    pub diffuse: DVec3,
    /// Colour of highlights.
    pub specular: DVec3,
    /// Their exponent.
    pub shininess: f64,
    /// Colour in ambient light.
    pub ambient: DVec3,
    /// Light of its own.
    pub emissive: DVec3,
}

/// Light at a point: unit vector towards it, and radiance with attenuation.
#[derive(Clone, Copy, Debug)]
pub struct Incoming {
    /// Unit vector towards the light.
    pub towards: DVec3,
    /// What arrives.
    pub radiance: DVec3,
}

impl Incoming {
    /// A point light with coefficients of 1, d and d².
    pub fn from_point(place: DVec3, radiance: DVec3, [c, l, q]: [f64; 3], p: DVec3) -> Self {
        let d = (place - p).length();
        Self { towards: (place - p) / d, radiance: radiance / (c + l * d + q * d * d).max(1e-6) }
    }
}

/// The shading formula of the wire contract.
pub fn blinn_phong(s: &Surface, ambient: DVec3, lights: &[Incoming], normal: DVec3, viewer: DVec3) -> DVec3 {
    let mut sum = s.emissive + ambient * s.ambient;
    for light in lights {
        let cosine = normal.dot(light.towards);
        if cosine > 0.0 {
            let half = (light.towards + viewer).normalize();
            let lobe = normal.dot(half).max(0.0).powf(s.shininess);
            sum += (s.diffuse * cosine + s.specular * lobe) * light.radiance;
        }
    }
    sum
}

/// Area of a convex polygon (pixel units) within the pixel (x, y), by Sutherland and Hodgman's clipping.
pub fn area_in_pixel(polygon: &[DVec2], x: u32, y: u32) -> f64 {
    let (x, y) = (f64::from(x), f64::from(y));
    let mut p = polygon.to_vec();
    for inside in
        [&(|v: DVec2| v.x - x) as &dyn Fn(DVec2) -> f64, &|v| x + 1.0 - v.x, &|v| v.y - y, &|v| y + 1.0 - v.y]
    {
        let mut kept = Vec::new();
        for i in 0..p.len() {
            let (a, b) = (p[i], p[(i + 1) % p.len()]);
            let (da, db) = (inside(a), inside(b));
            if da >= 0.0 {
                kept.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                kept.push(a + (b - a) * (da / (da - db)));
            }
        }
        p = kept;
    }
    let twice: f64 = (0..p.len()).map(|i| p[i].perp_dot(p[(i + 1) % p.len()])).sum();
    twice.abs() / 2.0
}
