//! Sculpting with signed distances, and the skin of a sculpture that rays see from outside.
//!
//! Source of the formulas: I. Quilez, "Distance functions" and "Smooth minimum", iquilezles.org.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Distance to a ball.
pub fn ball(p: DVec3, centre: DVec3, radius: f64) -> f64 {
    p.distance(centre) - radius
}

/// About the distance to an ellipsoid; exact on its surface.
pub fn ellipsoid(p: DVec3, centre: DVec3, radii: DVec3) -> f64 {
    let p = p - centre;
    let (k0, k1) = ((p / radii).length(), (p / (radii * radii)).length());
    if k1 == 0.0 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// About the distance to a limb from `a` to `b` whose radius goes from `ra` to `rb`.
pub fn limb(p: DVec3, (a, ra): (DVec3, f64), (b, rb): (DVec3, f64)) -> f64 {
    let (pa, ba) = (p - a, b - a);
    let t = (pa.dot(ba) / ba.length_squared()).clamp(0.0, 1.0);
    (pa - ba * t).length() - (ra + (rb - ra) * t)
}

/// Union of two whose seam is rounded over a width of about `k`.
pub fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k / 4.0
}

/// The first without the second, the edge rounded over a width of about `k`.
pub fn carve(a: f64, b: f64, k: f64) -> f64 {
    -join(-a, b, k)
}

/// Where rays start that look at a sculpture: `from` below to `to` above, all around.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Its lower end.
    pub from: DVec3,
    /// Its upper end.
    pub to: DVec3,
    /// How far out all of the sculpture ends.
    pub reach: f64,
}

impl Axis {
    /// The outermost point of `sculpture` at (u, v): u around from the back, v from the lower pole to
    /// the upper one.
    pub fn skin(&self, u: f64, v: f64, sculpture: impl Fn(DVec3) -> f64) -> DVec3 {
        let (origin, direction) = self.ray(u, v);
        let mut t = self.reach;
        // The distances are about right: shorter steps do not overshoot.
        for _ in 0..160 {
            let distance = sculpture(origin + direction * t);
            t -= 0.6 * distance;
            if distance < 1e-5 || t < 0.0 {
                break;
            }
        }
        origin + direction * t.max(0.0)
    }

    /// A ray of a capsule: rays of half a ball at each end, level ones between.
    fn ray(&self, u: f64, v: f64) -> (DVec3, DVec3) {
        const END: f64 = 0.3;
        let angle = TAU * (u - 0.5);
        let around = DVec3::new(libm::sin(angle), 0.0, libm::cos(angle));
        let (origin, pitch) = if v < END {
            (self.from, (v / END - 1.0) * FRAC_PI_2)
        } else if v > 1.0 - END {
            (self.to, ((v - 1.0) / END + 1.0) * FRAC_PI_2)
        } else {
            (self.from + (self.to - self.from) * ((v - END) / (1.0 - 2.0 * END)), 0.0)
        };
        (origin, around * libm::cos(pitch) + DVec3::Y * libm::sin(pitch))
    }
}
