//! Homogeneous clipping against the near plane, the far plane and the guard band, in f64.

use super::vertex::{GUARD, ViewFromModel};
use crate::math::{Projection, View};
use glam::DVec3;

/// A vertex of a polygon that is being cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipVertex {
    /// Screen x times q, in sub-pixels.
    pub x: f64,
    /// Screen y times q, in sub-pixels, down.
    pub y: f64,
    /// Homogeneous coordinate: the view-space distance in perspective, else 1.
    pub q: f64,
    /// View-space distance.
    pub w: f64,
    /// Weights of the triangle's three corners.
    pub weights: [f64; 3],
}

/// A polygon with at most 3 + 6 corners.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    corners: [ClipVertex; 9],
    len: usize,
}

impl Polygon {
    const EMPTY: ClipVertex = ClipVertex { x: 0.0, y: 0.0, q: 0.0, w: 0.0, weights: [0.0; 3] };

    /// The triangle of three stored positions; `None` if a coordinate is not finite.
    #[must_use]
    pub fn triangle(positions: [DVec3; 3], from_model: &ViewFromModel, view: &View) -> Option<Self> {
        let mut polygon = Self { corners: [Self::EMPTY; 9], len: 0 };
        for (i, p) in positions.into_iter().enumerate() {
            let v = from_model.apply(p);
            let q = match view.projection {
                Projection::Perspective => v.z,
                Projection::Orthographic => 1.0,
            };
            let mut weights = [0.0; 3];
            weights[i] = 1.0;
            let corner =
                ClipVertex { x: v.x * view.scale[0], y: 0.0 - v.y * view.scale[1], q, w: v.z, weights };
            // Beyond 2¹⁰⁰⁰ a product of the cuts below could overflow.
            let limit = 1e300;
            if ![corner.x, corner.y, corner.w].iter().all(|c| c.abs() < limit) {
                return None;
            }
            polygon.push(corner);
        }
        Some(polygon)
    }

    /// Its corners in order.
    #[must_use]
    pub fn corners(&self) -> &[ClipVertex] {
        &self.corners[..self.len]
    }

    fn push(&mut self, corner: ClipVertex) {
        self.corners[self.len] = corner;
        self.len += 1;
    }

    /// What is left inside the near plane, the far plane and the guard band.
    #[must_use]
    pub fn clipped(mut self, view: &View) -> Self {
        // The near plane goes first: behind it q ≤ 0 and the guard planes mean nothing.
        self = self.cut(|v| v.w - view.near, |v| set_distance(v, view.near, view));
        if view.far.is_finite() {
            self = self.cut(|v| view.far - v.w, |v| set_distance(v, view.far, view));
        }
        self = self.cut(|v| GUARD * v.q - v.x, |v| v.x = GUARD * v.q);
        self = self.cut(|v| GUARD * v.q + v.x, |v| v.x = -GUARD * v.q);
        self = self.cut(|v| GUARD * v.q - v.y, |v| v.y = GUARD * v.q);
        self.cut(|v| GUARD * v.q + v.y, |v| v.y = -GUARD * v.q)
    }

    /// One step of Sutherland and Hodgman's algorithm ("Reentrant polygon clipping", 1974).
    ///
    /// A cut point is always computed from the inside to the outside corner and then set exactly to
    /// the plane, so two triangles that share an edge cut it at the same bits.
    fn cut(self, inside: impl Fn(&ClipVertex) -> f64, set: impl Fn(&mut ClipVertex)) -> Self {
        if self.corners().iter().all(|v| inside(v) >= 0.0) {
            return self;
        }
        let mut kept = Self { corners: [Self::EMPTY; 9], len: 0 };
        for i in 0..self.len {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.len]);
            let (da, db) = (inside(&a), inside(&b));
            if da >= 0.0 {
                kept.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                let (near, far, t) = if da >= 0.0 { (a, b, da / (da - db)) } else { (b, a, db / (db - da)) };
                let mut cut = near.mix(&far, t);
                set(&mut cut);
                kept.push(cut);
            }
        }
        kept
    }
}

fn set_distance(v: &mut ClipVertex, w: f64, view: &View) {
    v.w = w;
    if view.projection == Projection::Perspective {
        v.q = w;
    }
}

impl ClipVertex {
    fn mix(&self, o: &Self, t: f64) -> Self {
        let lerp = |a: f64, b: f64| a + (b - a) * t;
        Self {
            x: lerp(self.x, o.x),
            y: lerp(self.y, o.y),
            q: lerp(self.q, o.q),
            w: lerp(self.w, o.w),
            weights: [0, 1, 2].map(|i| lerp(self.weights[i], o.weights[i])),
        }
    }
}

#[cfg(test)]
mod tests;
