//! Filtered shadows of a straight edge against closed forms: how wide they are, and how they fade.

use crate::closed_form::{Camera, decode, hit_plane};
use crate::draw::{Picture, plan, scene};
use crate::measure::at_most;
use glam::DVec3;
use rasterd::plan::FrameRequest;
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
