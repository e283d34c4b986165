//! Homogeneous clipping against the near plane, the far plane and the guard band, in f64.

use super::vertex::GUARD_PLANE;
use crate::math::Viewport;

/// A vertex of a polygon that is being cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipVertex {
    /// Screen x times w, in sub-pixels.
    pub x: f64,
    /// Screen y times w, in sub-pixels, down.
    pub y: f64,
    /// Depth times w.
    pub z: f64,
    /// Homogeneous coordinate.
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
    const EMPTY: ClipVertex = ClipVertex { x: 0.0, y: 0.0, z: 0.0, w: 0.0, weights: [0.0; 3] };

    /// The triangle of three clip-space positions; `None` if a coordinate is not finite.
    #[must_use]
    pub fn triangle(positions: [[f64; 4]; 3], viewport: &Viewport) -> Option<Self> {
        let [half_w, half_h] = viewport.half_extent();
        let mut polygon = Self { corners: [Self::EMPTY; 9], len: 0 };
        for (i, [x, y, z, w]) in positions.into_iter().enumerate() {
            let mut weights = [0.0; 3];
            weights[i] = 1.0;
            // The same steps as in the vertex stage: a clipped triangle meets its unclipped neighbour
            // at the very same vertices.
            let corner = ClipVertex { x: x * half_w, y: 0.0 - y * half_h, z, w, weights };
            // Beyond 2¹⁰⁰⁰ a product of the cuts below could overflow.
            let limit = 1e300;
            if ![corner.x, corner.y, z, w].iter().all(|c| c.abs() < limit) {
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
    pub fn clipped(mut self, viewport: &Viewport) -> Self {
        // The near plane goes first: behind it w ≤ 0 and the guard planes mean nothing.
        self = self.cut_at_depth(1.0, |v| v.w - v.z);
        if viewport.farthest > 0.0 {
            self = self.cut_at_depth(viewport.farthest, |v| v.z - viewport.farthest * v.w);
        }
        self = self.cut(|v| GUARD_PLANE * v.w - v.x, |v, _| v.x = GUARD_PLANE * v.w);
        self = self.cut(|v| GUARD_PLANE * v.w + v.x, |v, _| v.x = -GUARD_PLANE * v.w);
        self = self.cut(|v| GUARD_PLANE * v.w - v.y, |v, _| v.y = GUARD_PLANE * v.w);
        self.cut(|v| GUARD_PLANE * v.w + v.y, |v, _| v.y = -GUARD_PLANE * v.w)
    }

    /// Cuts where z / w is `depth`. In perspective z is the same everywhere and gives w its exact
    /// value: a far end of 10¹⁰ times the near distance would leave no digits of an interpolated one.
    fn cut_at_depth(self, depth: f64, inside: impl Fn(&ClipVertex) -> f64) -> Self {
        self.cut(inside, |v, level| {
            if level {
                v.w = v.z / depth;
            } else {
                v.z = depth * v.w;
            }
        })
    }

    /// One step of Sutherland and Hodgman's algorithm ("Reentrant polygon clipping", 1974).
    ///
    /// A cut point is always computed from the inside to the outside corner and then set exactly to
    /// the plane, so two triangles that share an edge cut it at the same bits.
    ///
    /// `set` is told whether z is the same at both ends of the edge.
    fn cut(self, inside: impl Fn(&ClipVertex) -> f64, set: impl Fn(&mut ClipVertex, bool)) -> Self {
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
                set(&mut cut, a.z == b.z);
                kept.push(cut);
            }
        }
        kept
    }
}

impl ClipVertex {
    fn mix(&self, o: &Self, t: f64) -> Self {
        let lerp = |a: f64, b: f64| a + (b - a) * t;
        Self {
            x: lerp(self.x, o.x),
            y: lerp(self.y, o.y),
            z: lerp(self.z, o.z),
            w: lerp(self.w, o.w),
            weights: [0, 1, 2].map(|i| lerp(self.weights[i], o.weights[i])),
        }
    }
}

#[cfg(test)]
mod tests;
