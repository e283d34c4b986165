//! Filtered shadows of a straight edge against closed forms: how wide they are, and how they fade.

use crate::closed_form::{Camera, Ray, decode, hit_plane};
use crate::draw::{Picture, frame, output, plan, scene};
use crate::measure::at_most;
use glam::DVec3;
use rasterd::pipeline::Pixels;
use rasterd::plan::{FrameRequest, Output};
use serde_json::{Value, json};

/// A floor, half of it under a sheet that ends above the middle, seen from the side that is lit. All of
/// it is turned about y, so that the sheet's edge is not parallel to texels.
struct Edge {
    /// Of the sheet above the floor.
    height: f64,
    light: Value,
    /// Where the shadow's edge must be, and half of what is looked at.
    window: f64,
}

/// How much light arrives, by the distance from the shadow's edge; from dark to lit.
struct Profile {
    /// Half the width that is looked at.
    window: f64,
    light: Vec<f64>,
}

const BINS: usize = 120;

/// The turn about y in degrees.
const TURN_DEG: f64 = 20.0;

/// Across the sheet's edge, towards the lit side.
fn across() -> DVec3 {
    let (sin, cos) = TURN_DEG.to_radians().sin_cos();
    DVec3::new(cos, 0.0, -sin)
}

impl Edge {
    fn camera(&self) -> Camera {
        // From 45° above: the view is √2 times as long on the floor as it is high.
        let eye = (across() + DVec3::Y) * 20.0;
        Camera::orthographic(eye.to_array(), [0.0; 3], self.window * 1.6, 200, 200)
    }

    fn document(&self) -> Value {
        let camera = self.camera();
        json!({
            "camera": camera.document(),
            "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#00f" } },
            "lights": { "light": self.light },
            "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1], "double_sided": true } },
            "meshes": { "floor": { "type": "plane", "size": [40, 40] }, "sheet": { "type": "plane", "size": [6, 12] } },
            "instances": {
                "floor": { "mesh": "floor", "material": "white", "casts_shadow": false },
                "sheet": { "mesh": "sheet", "material": "white", "receives_shadow": false,
                    "translation": (across() * -3.0 + DVec3::Y * self.height).to_array(),
                    "rotation_deg": [0, TURN_DEG, 0] },
            },
            "render": camera.render(1),
        })
    }

    /// Length of a texel of parallel light across the edge, in world units.
    fn texel(&self) -> f64 {
        let plan = plan(&scene(&self.document()), &FrameRequest::default());
        let view = &plan.shadows[0].faces()[0].view;
        let [along_x, along_y] = [view.right, view.up].map(|axis| axis.dot(across()));
        (along_x * 256.0 / view.scale[0]).hypot(along_y * 256.0 / view.scale[1])
    }

    /// The mean over many rows, relative to the picture without shadows.
    fn profile(&self) -> Profile {
        let mut without = self.document();
        without["render"]["shadows"] = json!(false);
        let (with, without) = (Picture::of(&self.document()), Picture::of(&without));
        let camera = self.camera();
        let mut bins = vec![(0.0, 0.0); BINS];
        for (x, y, pixel) in with.iter() {
            let ray = camera.centre(x, y);
            let p = ray.at(hit_plane(ray, DVec3::ZERO, DVec3::Y).expect("the camera looks down"));
            let from_edge = p.dot(across());
            let at = ((from_edge / self.window + 1.0) * 0.5 * BINS as f64).floor();
            // What the sheet hides is none of the floor's.
            let hidden = from_edge + self.height < 0.0;
            if (0.0..BINS as f64).contains(&at) && !hidden {
                let lit = decode(without.at(x, y)[0]);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "one of the bins"
                )]
                let bin = &mut bins[at as usize];
                *bin = (bin.0 + decode(pixel[0]) / lit, bin.1 + 1.0);
            }
        }
        Profile { window: self.window, light: bins.iter().map(|(sum, n)| sum / n).collect() }
    }
}

impl Profile {
    /// The radius of the disc that spreads a hard edge so: twice the standard deviation. And where the
    /// edge's middle is.
    fn radius_and_middle(&self) -> (f64, f64) {
        let (w, step) = (self.window, 2.0 * self.window / BINS as f64);
        let at = |i: usize| (i as f64 + 0.5) * step - w;
        // ∫ x dv and ∫ x² dv, by parts.
        let mean = w - self.light.iter().sum::<f64>() * step;
        let square = w * w - self.light.iter().enumerate().map(|(i, v)| 2.0 * at(i) * v * step).sum::<f64>();
        (2.0 * (square - mean * mean).max(0.0).sqrt(), mean)
    }

    /// Mean distance from the light that a disc of `radius` lets by.
    fn distance_from_disc(&self, radius: f64) -> f64 {
        let truth = |x: f64| {
            let t = (x / radius).clamp(-1.0, 1.0);
            0.5 + (t * (1.0 - t * t).sqrt() + t.asin()) / std::f64::consts::PI
        };
        let step = 2.0 * self.window / BINS as f64;
        let sum = self
            .light
            .iter()
            .enumerate()
            .map(|(i, v)| (v - truth((i as f64 + 0.5) * step - self.window)).abs());
        sum.sum::<f64>() * step / (2.0 * radius)
    }
}

/// Light from straight above.
const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

#[test]
fn pcf_of_a_straight_edge_is_a_ramp_two_radii_wide() {
    for (radius, resolution) in [(1.5, 128), (3.0, 128), (6.0, 200), (12.0, 512)] {
        let shadow = json!({ "filter": "pcf", "radius": radius, "resolution": resolution });
        let light = json!({ "type": "directional", "direction": DOWN, "intensity": 1, "shadow": shadow });
        let mut edge = Edge { height: 2.0, light, window: 1.0 };
        let texel = edge.texel();
        edge.window = 1.6 * radius * texel + texel;
        let (measured, middle) = edge.profile().radius_and_middle();
        // A tap reads the nearest texel: that spreads the edge by a square of one texel, variance 1/12.
        let expected = (radius * radius + 1.0 / 3.0).sqrt() * texel;
        let case = format!("PCF radius {radius}, map {resolution}");
        at_most(&case, "relative error of the ramp's width", (measured / expected - 1.0).abs(), 0.1);
        at_most(&case, "displacement of its middle in texels", middle.abs() / texel, 0.5);
    }
}

#[test]
fn pcss_penumbrae_are_as_wide_as_an_area_light_makes_them() {
    let mut last = 0.0;
    for (light_radius, height) in
        [(0.05, 0.25), (0.05, 0.5), (0.05, 1.0), (0.05, 2.0), (0.05, 4.0), (0.2, 2.0)]
    {
        let shadow = json!({ "filter": "pcss", "light_radius": light_radius });
        let light = json!({ "type": "directional", "direction": DOWN, "intensity": 1, "shadow": shadow });
        // The disc of the light, projected from the edge onto the floor.
        let expected = light_radius * height;
        let edge = Edge { height, light, window: 1.6 * expected };
        let profile = edge.profile();
        let (measured, middle) = profile.radius_and_middle();
        // The map holds the edge to half a texel, of a penumbra two radii wide.
        let texel = edge.texel() / (4.0 * expected);
        let case = format!("PCSS light {light_radius}, blocker {height} above");
        at_most(&case, "relative error of the penumbra's width", (measured / expected - 1.0).abs(), 0.1);
        at_most(&case, "displacement of its middle in radii", middle.abs() / expected, 0.02 + 2.0 * texel);
        at_most(&case, "mean error across it", profile.distance_from_disc(expected), 0.02 + texel);
        assert!(measured > last, "{case}: it grows with the distance");
        last = measured;
    }
}

#[test]
fn pcss_penumbrae_of_a_lamp_are_as_wide_as_a_ball_makes_them() {
    for (light_radius, lamp, height) in [(0.1, 4.0, 0.5), (0.1, 4.0, 1.0), (0.1, 4.0, 2.0), (0.3, 5.0, 1.5)] {
        let shadow = json!({ "filter": "pcss", "light_radius": light_radius });
        let light = json!({ "type": "point", "position": [0, lamp, 0], "intensity": 1, "shadow": shadow,
            "attenuation": { "constant": 1, "quadratic": 0 } });
        let expected = light_radius * height / (lamp - height);
        let edge = Edge { height, light, window: 1.6 * expected };
        let profile = edge.profile();
        let (measured, middle) = profile.radius_and_middle();
        let case = format!("PCSS lamp of {light_radius} at {lamp}, blocker {height} above");
        at_most(&case, "relative error of the penumbra's width", (measured / expected - 1.0).abs(), 0.1);
        at_most(&case, "displacement of its middle in radii", middle.abs() / expected, 0.1);
        at_most(&case, "mean error across it", profile.distance_from_disc(expected), 0.03);
    }
}

/// A tilted floor, partly under a level sheet, in slanted light: the shadow of the sheet's edge runs
/// through the origin, and nothing is parallel to anything.
struct Slanted {
    /// Of the sheet's edge over the origin.
    height: f64,
    light: Emitter,
    shadow: Value,
    /// Half of what is looked at on either side of the shadow's edge.
    window: f64,
}

/// A light of some size.
#[derive(Clone, Copy)]
enum Emitter {
    /// A disc infinitely far away: the tangent of its half-angle.
    Sun(f64),
    /// A ball, seen as a disc from wherever its light arrives: its radius, and how far from the origin.
    Ball(f64, f64),
}

/// The way to the middle of the light, from the origin.
fn towards_light() -> DVec3 {
    (across() * 0.5 + DVec3::Y + along() * 0.3).normalize()
}

/// Along the sheet's edge.
fn along() -> DVec3 {
    across().cross(DVec3::Y)
}

fn tilted_normal() -> DVec3 {
    (across() * -0.35 + DVec3::Y + along() * 0.25).normalize()
}

/// Rays to the disc of a light. Their mean over half of the disc is off by less than 0.002.
const RAYS: u32 = 1536;

impl Slanted {
    fn camera(&self) -> Camera {
        let eye = (across() + DVec3::Y + along() * 0.2) * 20.0;
        Camera::orthographic(eye.to_array(), [0.0; 3], self.window * 1.8, 160, 160)
    }

    /// The middle of the sheet's edge.
    fn edge(&self) -> DVec3 {
        towards_light() * (self.height / towards_light().y)
    }

    /// Across the shadow's edge on the floor, towards the lit side.
    fn across_shadow(&self) -> DVec3 {
        // The light's middle, the sheet's edge and the shadow's lie in one plane.
        let plane = towards_light().cross(along());
        let edge = tilted_normal().cross(plane);
        let side = edge.cross(tilted_normal()).normalize();
        side * side.dot(across()).signum()
    }

    fn document(&self) -> Value {
        let camera = self.camera();
        let light = match self.light {
            Emitter::Sun(_) => json!({ "type": "directional", "direction": (-towards_light()).to_array() }),
            Emitter::Ball(_, far) => json!({ "type": "point", "position": (towards_light() * far).to_array(),
                "attenuation": { "constant": 1, "quadratic": 0 } }),
        };
        let mut document = json!({
            "camera": camera.document(),
            "environment": { "ambient": [0, 0, 0], "background": { "type": "color", "color": "#00f" } },
            "lights": { "light": light },
            "materials": { "white": { "shading": "lambert", "diffuse": [1, 1, 1], "double_sided": true } },
            "meshes": { "floor": { "type": "triangles", "indices": [0, 1, 2, 0, 2, 3] },
                "sheet": { "type": "plane", "size": [6, 12] } },
            "instances": {
                "floor": { "mesh": "floor", "material": "white", "casts_shadow": false },
                "sheet": { "mesh": "sheet", "material": "white", "receives_shadow": false,
                    "translation": (self.edge() - across() * 3.0).to_array(), "rotation_deg": [0, TURN_DEG, 0] },
            },
            "render": camera.render(1),
        });
        let (a, b) = tilted_normal().any_orthonormal_pair();
        let corner = |(x, y): (f64, f64)| (a * x + b * y).to_array();
        document["meshes"]["floor"]["positions"] =
            json!([(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(corner));
        document["lights"]["light"]["shadow"] = self.shadow.clone();
        document
    }

    /// Whether a ray meets the sheet.
    fn is_hidden(&self, ray: Ray) -> bool {
        let Some(s) = hit_plane(ray, self.edge(), DVec3::Y) else { return false };
        let p = ray.at(s) - self.edge();
        (-6.0..0.0).contains(&p.dot(across())) && p.dot(along()).abs() < 6.0
    }

    /// The part of the light that a point sees, by casting rays to its disc.
    fn cast(&self, p: DVec3) -> f64 {
        let (middle, radius) = match self.light {
            Emitter::Sun(tangent) => (towards_light(), tangent),
            Emitter::Ball(radius, far) => (towards_light() * far - p, radius),
        };
        let (a, b) = middle.normalize().any_orthonormal_pair();
        let lit = (0..RAYS).filter(|&i| {
            // A spiral by the golden angle: H. Vogel, "A better way to construct the sunflower head", 1979.
            let r = radius * ((f64::from(i) + 0.5) / f64::from(RAYS)).sqrt();
            let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
            !self.is_hidden(Ray { origin: p, direction: middle + a * (r * cos) + b * (r * sin) })
        });
        lit.count() as f64 / f64::from(RAYS)
    }

    /// How light falls off across the shadow's edge: as drawn, and as cast.
    fn profiles(&self) -> [Profile; 2] {
        let radiance = |shadows: bool| {
            let mut document = self.document();
            document["render"]["shadows"] = json!(shadows);
            match frame(&scene(&document), &output(Output::Radiance)).pixels {
                Pixels::Rgba32F { pixels, .. } => pixels,
                _ => panic!("asked for radiance"),
            }
        };
        let (with, without) = (radiance(true), radiance(false));
        let (camera, across_shadow) = (self.camera(), self.across_shadow());
        let mut bins = vec![[0.0; 3]; BINS];
        for ((x, y), (with, without)) in camera.pixels().zip(with.iter().zip(&without)) {
            let ray = camera.centre(x, y);
            let p = ray.at(hit_plane(ray, DVec3::ZERO, tilted_normal()).expect("the camera looks down"));
            let at = ((p.dot(across_shadow) / self.window + 1.0) * 0.5 * BINS as f64).floor();
            if (0.0..BINS as f64).contains(&at) && !self.is_hidden(ray) {
                let drawn = f64::from(with[0]) / f64::from(without[0]);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "one of the bins"
                )]
                let bin = &mut bins[at as usize];
                *bin = [bin[0] + drawn, bin[1] + self.cast(p), bin[2] + 1.0];
            }
        }
        let of = |which: usize| bins.iter().map(|bin| bin[which] / bin[2]).collect();
        [0, 1].map(|which| Profile { window: self.window, light: of(which) })
    }

    /// How far on the floor half a texel, along both of the map's axes and twice, may move a shadow.
    fn displacement(&self) -> f64 {
        let plan = plan(&scene(&self.document()), &FrameRequest::default());
        let texel = 256.0 / plan.shadows[0].faces()[0].view.scale[0];
        let texel = match self.light {
            Emitter::Sun(_) => texel,
            // In the plane of the side that sees the origin.
            Emitter::Ball(_, far) => texel * (towards_light() * far).abs().max_element(),
        };
        std::f64::consts::SQRT_2 * texel / tilted_normal().dot(towards_light())
    }

    /// Radius of the penumbra, roughly.
    fn penumbra(&self) -> f64 {
        let above = self.height / towards_light().y;
        let across_light = match self.light {
            Emitter::Sun(tangent) => tangent * above,
            Emitter::Ball(radius, far) => radius * above / (far - above),
        };
        across_light / tilted_normal().dot(towards_light())
    }
}

/// The penumbra as it is drawn and as 1536 rays a point find it.
#[test]
fn pcss_penumbrae_of_slanted_light_on_slanted_ground_are_as_wide_as_rays_find_them() {
    let pcss = |light_radius: f64, more: Value| {
        let mut shadow = json!({ "filter": "pcss", "light_radius": light_radius });
        shadow.as_object_mut().expect("a shadow").extend(more.as_object().cloned().unwrap_or_default());
        shadow
    };
    for (light, height, more) in [
        (Emitter::Sun(0.05), 1.0, json!({})),
        (Emitter::Sun(0.05), 2.5, json!({})),
        (Emitter::Sun(0.15), 1.5, json!({ "search_taps": 64, "filter_taps": 128 })),
        (Emitter::Sun(0.05), 2.0, json!({ "search_radius": 30 })),
        (Emitter::Ball(0.1, 5.0), 1.0, json!({})),
        (Emitter::Ball(0.1, 5.0), 2.0, json!({})),
        (Emitter::Ball(0.3, 6.0), 1.5, json!({ "search_taps": 64, "filter_taps": 128 })),
        (Emitter::Ball(0.1, 5.0), 2.0, json!({ "search_radius": 30 })),
    ] {
        let (name, radius) = match light {
            Emitter::Sun(tangent) => (format!("PCSS sun of {tangent}"), tangent),
            Emitter::Ball(radius, far) => (format!("PCSS lamp of {radius} at {far}"), radius),
        };
        let case = format!("{name}, slanted, blocker {height} above, {more}");
        let mut slanted = Slanted { height, light, shadow: pcss(radius, more), window: 0.0 };
        slanted.window = 1.7 * slanted.penumbra();
        let [drawn, cast] = slanted.profiles();
        let ((width, middle), (true_width, true_middle)) =
            (drawn.radius_and_middle(), cast.radius_and_middle());
        at_most(&case, "relative error of the penumbra's width", (width / true_width - 1.0).abs(), 0.1);
        let displaced = (middle - true_middle).abs() / true_width;
        let bound = 0.02 + slanted.displacement() / true_width;
        at_most(&case, "displacement of its middle in radii", displaced, bound);
        let apart: f64 = drawn.light.iter().zip(&cast.light).map(|(a, b)| (a - b).abs()).sum();
        // An edge that is moved by d is off by d on the mean of it, over the width that is looked at.
        let bound = 0.02 + bound * true_width / (2.0 * slanted.window);
        at_most(&case, "mean error across it", apart / BINS as f64, bound);
        let ends = [cast.light[0], 1.0 - cast.light[BINS - 1]];
        assert!(ends.iter().all(|&end| end < 0.01), "{case}: all of the penumbra is looked at: {ends:?}");
    }
}
