//! Plants: bent strips that carry cut-out leaves.

use crate::obj::Obj;
use crate::paint::{self, Color, blend, shade};
use glam::{DVec2, DVec3, dvec3};
use rasterd::scene::demo::noise::{Noise, mix, random, smoothstep};
use std::f64::consts::TAU;

/// A leaf: where it grows, and how it bends.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    root: DVec3,
    /// Radians about y.
    heading: f64,
    length: f64,
    width: f64,
    /// Slope at its root, and how far it has turned down at its tip, in radians.
    rise: f64,
    droop: f64,
}

/// Golden angle: no leaf lies right above another.
const GOLDEN: f64 = 0.381_966 * TAU;

impl Leaf {
    /// Adds the strip, u across and v from root to tip, folded a little along its midrib.
    fn grow(self, obj: &mut Obj, steps: u32) {
        let out = dvec3(libm::sin(self.heading), 0.0, libm::cos(self.heading));
        let right = out.cross(DVec3::Y);
        let row = |v: f64| {
            let parts = 24.0 * v;
            let mut point = self.root;
            // The midrib, small step by small step.
            for i in 0..24 {
                let part = (parts - f64::from(i)).clamp(0.0, 1.0) / 24.0;
                let pitch = self.rise - self.droop * (f64::from(i) / 24.0);
                point += (out * libm::cos(pitch) + DVec3::Y * libm::sin(pitch)) * (self.length * part);
            }
            point
        };
        obj.surface([2, steps], DVec2::ONE, |u, v| {
            let across = u - 0.5;
            let pitch = self.rise - self.droop * v;
            let up = DVec3::Y * libm::cos(pitch) - out * libm::sin(pitch);
            row(v) + right * (across * self.width) + up * (across.abs() * 0.3 * self.width)
        });
    }
}

/// A stalk along a leaf's midrib from `root`, as the leaf without its blade.
fn stalk(obj: &mut Obj, leaf: Leaf, thickness: f64) -> (DVec3, f64) {
    let out = dvec3(libm::sin(leaf.heading), 0.0, libm::cos(leaf.heading));
    let right = out.cross(DVec3::Y);
    let (mut point, mut rings) = (leaf.root, vec![leaf.root]);
    for i in 0..6 {
        let pitch = leaf.rise - leaf.droop * f64::from(i) / 6.0;
        point += (out * libm::cos(pitch) + DVec3::Y * libm::sin(pitch)) * (leaf.length / 6.0);
        rings.push(point);
    }
    obj.surface([5, 6], DVec2::ONE, |u, v| {
        #[expect(clippy::cast_possible_truncation, reason = "0 to 6")]
        let centre = rings[(v * 6.0).round() as usize];
        let pitch = leaf.rise - leaf.droop * v;
        let up = DVec3::Y * libm::cos(pitch) - out * libm::sin(pitch);
        let angle = -TAU * u;
        centre + (right * libm::cos(angle) + up * libm::sin(angle)) * (thickness * (1.0 - 0.4 * v))
    });
    (point, leaf.rise - leaf.droop)
}

/// A rosette of long arching leaves, about 1.6 wide.
pub fn rosette() -> Vec<u8> {
    let mut obj = Obj::textured();
    for i in 0..26 {
        let age = f64::from(i) / 25.0;
        let leaf = Leaf {
            root: dvec3(0.0, 0.02 * age, 0.0),
            heading: GOLDEN * f64::from(i),
            length: mix(0.98, 0.62, age) * (0.92 + 0.16 * random(i, 1, 5)),
            width: mix(0.24, 0.16, age),
            rise: mix(0.75, 1.45, age),
            droop: mix(1.75, 0.5, age),
        };
        leaf.grow(&mut obj, 6);
    }
    obj.to_bytes()
}

/// Large slit leaves on stalks, about 1.5 tall.
pub fn monstera() -> Vec<u8> {
    let mut obj = Obj::textured().with_library("monstera.mtl");
    for i in 0..9 {
        let age = f64::from(i) / 8.0;
        let heading = GOLDEN * f64::from(i) + 0.5 * random(i, 2, 5);
        let stem = Leaf {
            root: DVec3::ZERO,
            heading,
            length: mix(0.72, 1.12, age),
            width: 0.0,
            rise: mix(1.0, 1.5, age),
            droop: mix(0.6, 0.25, age),
        };
        let (root, pitch) = stalk(obj.material("stalk"), stem, 0.018);
        let size = mix(0.56, 0.74, random(i, 3, 5));
        let blade = Leaf { root, length: size, width: size, rise: pitch - 0.75, droop: 0.85, ..stem };
        blade.grow(obj.material("blade"), 6);
    }
    obj.to_bytes()
}

/// The slit leaves' materials.
pub const MONSTERA_LIBRARY: &str = "# Written by examples/gallery_assets
newmtl stalk
Kd 0.09 0.2 0.045
newmtl blade
Kd 1 1 1
map_Kd monstera.png
Ks 0.22 0.25 0.2
Ns 30
";

const DEEP: Color = [34.0, 84.0, 40.0];
const FRESH: Color = [112.0, 166.0, 62.0];
const VEIN: Color = [176.0, 204.0, 128.0];

/// A slender leaf, root below.
pub fn slender() -> Vec<u8> {
    let mottle = Noise::new([4, 16], 3, 91);
    paint::cutout([128, 512], |u, v| {
        let x = 2.0 * u - 1.0;
        // Widest a third of the way up, pointed at its tip.
        let half = 0.96 * libm::pow(libm::sin(std::f64::consts::PI * libm::pow(v, 0.62)), 0.8);
        let edge = half - x.abs();
        let rib = 1.0 - smoothstep(0.02, 0.06, x.abs());
        let side = (v * 26.0 - x.abs() * 2.2).rem_euclid(1.0);
        let veins = (1.0 - smoothstep(0.0, 0.16, side.min(1.0 - side))) * 0.3;
        let green = blend(DEEP, FRESH, 0.3 + 0.45 * v + 0.4 * (mottle.at(u, v) - 0.5));
        let border = 1.0 - smoothstep(0.0, 0.12, edge);
        let color = blend(blend(green, VEIN, (0.7 * rib).max(veins)), FRESH, 0.6 * border);
        (color, smoothstep(-0.02, 0.02, edge))
    })
}

/// A heart-shaped leaf with slits between its side veins, root below.
pub fn slit() -> Vec<u8> {
    /// Side veins on each half.
    const VEINS: f64 = 6.0;
    let mottle = Noise::new([6, 6], 4, 92);
    paint::cutout([384, 384], |u, v| {
        let (x, y) = (2.0 * (u - 0.5).abs(), v);
        // A heart: lobes that reach below the root, a point at the tip.
        let lobe =
            0.99 * (1.0 - libm::pow((y - 0.34).abs() / if y > 0.34 { 0.66 } else { 0.34 }, 1.9)).max(0.0);
        let notch = if y < 0.14 { (0.14 - y) * 1.5 } else { 0.0 };
        let edge = (libm::pow(lobe, 0.75) - x).min(x - notch);
        // Side veins rise outwards; a slit lies midway between two of them and opens at the border.
        let along = (y - 0.3 * x + 0.12) * VEINS;
        let between = along.rem_euclid(1.0) - 0.5;
        let reach = x / libm::pow(lobe, 0.75).max(1e-3);
        let open = 0.04 + 0.17 * smoothstep(0.5, 1.0, reach);
        let is_slit = smoothstep(0.46, 0.5, reach) * f64::from(y > 0.1 && y < 0.84);
        let slit = (between.abs() - open) * 0.12 + (1.0 - is_slit);
        let vein = 1.0 - smoothstep(0.0, 0.05, 0.5 - between.abs());
        let rib = 1.0 - smoothstep(0.012, 0.03, x);
        let green = blend(DEEP, FRESH, 0.18 + 0.4 * (mottle.at(u, v) - 0.5) + 0.35 * x * x);
        let color = blend(green, VEIN, (0.75 * rib).max(0.4 * vein));
        (shade(color, 0.95), smoothstep(-0.004, 0.008, edge.min(slit)))
    })
}
