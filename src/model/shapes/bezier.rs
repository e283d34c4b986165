//! Bicubic Bézier patches.

use super::builder::fraction;
use glam::DVec3;

/// A bicubic Bézier patch: four rows of four control points, rows upwards and columns to the right
/// seen from its front.
///
/// Source: G. Farin, "Curves and Surfaces for CAGD", chapters 4 and 16.
#[derive(Clone, Copy, Debug)]
pub struct Patch(pub [[DVec3; 4]; 4]);

/// A parameter t in 0–1 together with 1 − t. Both are rounded quotients, so that the way back meets
/// the same points as the way there.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    t: f64,
    s: f64,
}

impl Parameter {
    /// `step / steps`.
    pub fn new(step: u32, steps: u32) -> Self {
        Self { t: fraction(step, steps), s: fraction(steps - step, steps) }
    }
}

impl Patch {
    /// The point at `u` along the rows and `v` along the columns.
    pub fn point(&self, u: Parameter, v: Parameter) -> DVec3 {
        point(self.row_at(v, point), u)
    }

    /// Away from the front, of any length. Where the lower or the upper border is a single point,
    /// the limit there.
    pub fn normal(&self, u: Parameter, v: Parameter) -> DVec3 {
        let along_v = point(self.row_at(v, derivative), u);
        let along_u = derivative(self.row_at(v, point), u);
        if along_u != DVec3::ZERO {
            return along_u.cross(along_v);
        }
        // ∂u vanishes at the border and grows from it along ∂u∂v: upwards from the lower border,
        // against v from the upper one.
        let growth = derivative(self.row_at(v, derivative), u);
        if v.t < 0.5 { growth.cross(along_v) } else { along_v.cross(growth) }
    }

    /// The control points of the curve at `v`, or of its derivative, by what `evaluate` does to
    /// each column.
    fn row_at(&self, v: Parameter, evaluate: fn([DVec3; 4], Parameter) -> DVec3) -> [DVec3; 4] {
        std::array::from_fn(|column| evaluate(self.0.map(|row| row[column]), v))
    }
}

/// A point of a cubic. The sum is the same to the bit when points and parameter are reversed, and
/// exactly an end point at an end: neighbouring patches meet without a gap.
fn point(p: [DVec3; 4], Parameter { t, s }: Parameter) -> DVec3 {
    if p[1..] == [p[0]; 3] {
        return p[0]; // the weights add up to 1 in real numbers only
    }
    let ends = p[0] * (s * s * s) + p[3] * (t * t * t);
    let middle = p[1] * (3.0 * (s * s) * t) + p[2] * (3.0 * (t * t) * s);
    ends + middle
}

/// The derivative of a cubic; exactly zero where all its points are one.
fn derivative(p: [DVec3; 4], Parameter { t, s }: Parameter) -> DVec3 {
    let ends = (p[1] - p[0]) * (s * s) + (p[3] - p[2]) * (t * t);
    (ends + (p[2] - p[1]) * (2.0 * s * t)) * 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: [DVec3; 4] =
        [DVec3::ZERO, DVec3::new(0.3, 1.0, 0.0), DVec3::new(1.1, 1.2, 0.7), DVec3::new(2.0, 0.1, 0.5)];

    #[test]
    fn a_curve_reversed_meets_the_same_points() {
        let reversed = [CURVE[3], CURVE[2], CURVE[1], CURVE[0]];
        for step in 0..=7 {
            let (there, back) = (Parameter::new(step, 7), Parameter::new(7 - step, 7));
            assert_eq!(point(CURVE, there), point(reversed, back));
        }
        assert_eq!(point(CURVE, Parameter::new(0, 7)), CURVE[0]);
        assert_eq!(point(CURVE, Parameter::new(7, 7)), CURVE[3]);
    }

    #[test]
    fn the_derivative_is_the_slope_of_the_curve() {
        let at = |t: f64| Parameter { t, s: 1.0 - t };
        let slope = (point(CURVE, at(0.3 + 1e-6)) - point(CURVE, at(0.3 - 1e-6))) / 2e-6;
        assert!((slope - derivative(CURVE, at(0.3))).length() < 1e-8);
    }

    #[test]
    fn a_border_that_is_one_point_has_the_limit_normal() {
        // A quarter of a shallow bowl around y: columns to the right, rows outwards and down.
        let ring = |r: f64, y: f64| {
            [(0.0, 1.0), (0.56, 1.0), (1.0, 0.56), (1.0, 0.0)].map(|(x, z)| DVec3::new(r * x, y, r * z))
        };
        let cap = Patch([ring(3.0, 0.0), ring(2.0, 0.4), ring(1.0, 0.5), ring(0.0, 0.5)]);
        let bowl = Patch([ring(0.0, -0.5), ring(1.0, -0.5), ring(2.0, -0.4), ring(3.0, 0.0)]);
        for step in 0..=4 {
            let (u, start, end) = (Parameter::new(step, 4), Parameter::new(0, 1), Parameter::new(1, 1));
            assert!((cap.normal(u, end).normalize() - DVec3::Y).length() < 1e-15);
            assert!((bowl.normal(u, start).normalize() + DVec3::Y).length() < 1e-15);
        }
    }
}
