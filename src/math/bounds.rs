//! Axis-aligned boxes.

use glam::{DMat3, DVec3};

/// An axis-aligned box that holds at least one point: `min ≤ max` in every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lower corner.
    pub min: DVec3,
    /// The upper corner.
    pub max: DVec3,
}

impl Bounds {
    /// The smallest box around `points`; `None` without any.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().fold(None, |bounds: Option<Self>, p| {
            Some(match bounds {
                None => Self { min: p, max: p },
                Some(b) => Self { min: b.min.min(p), max: b.max.max(p) },
            })
        })
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Its middle.
    #[must_use]
    pub fn centre(self) -> DVec3 {
        self.min + (self.max - self.min) * 0.5
    }

    /// Its eight corners.
    #[must_use]
    pub fn corners(self) -> [DVec3; 8] {
        let (a, b) = (self.min, self.max);
        [
            DVec3::new(a.x, a.y, a.z),
            DVec3::new(b.x, a.y, a.z),
            DVec3::new(a.x, b.y, a.z),
            DVec3::new(b.x, b.y, a.z),
            DVec3::new(a.x, a.y, b.z),
            DVec3::new(b.x, a.y, b.z),
            DVec3::new(a.x, b.y, b.z),
            DVec3::new(b.x, b.y, b.z),
        ]
    }

    /// The smallest box around this one after `p ↦ linear · p + translation`.
    #[must_use]
    pub fn transformed(self, linear: DMat3, translation: DVec3) -> Self {
        Self::around(self.corners().map(|p| linear * p + translation)).expect("a box has corners")
    }

    /// This box moved by `offset`.
    #[must_use]
    pub fn translated(self, offset: DVec3) -> Self {
        Self { min: self.min + offset, max: self.max + offset }
    }
}
