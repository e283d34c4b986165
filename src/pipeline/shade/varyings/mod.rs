//! Attributes of visible triangles, and their interpolation.
//!
//! Each visible triangle of a tile gets one record. Weights of its corners come from exact edge
//! functions relative to corner 0 and are never negative, so an interpolated value is a sum without
//! cancellation: it stays between its corners' values however thin the triangle or far its end.

mod corners;
mod interpolate;
mod records;

pub use interpolate::{Varyings, interpolate};
pub use records::Records;

use crate::math::{Projection, View};
use crate::plan::{Item, Surface};
use glam::{DMat3, DVec3};

/// A shadow map's coordinates as a varying: what a light needs to know of a receiver.
#[derive(Clone, Copy, Debug)]
pub struct ShadowFrame {
    /// Anchored space → (texel x, texel y, depth), linear part; texels count from the map's centre.
    pub linear: DMat3,
    /// Anchored position that it takes to zero.
    pub origin: DVec3,
    /// The way the light travels.
    pub direction: DVec3,
    /// Normal offset per |component| of the receiver's unit normal along the map's x and y axes, in
    /// world units: just enough that no texel of a plane shadows the plane (numerics: B33).
    pub offset: [DVec3; 2],
    /// Depth by which every receiver moves towards the light beside that: half a texel, so that a
    /// neighbour that rises by up to 45° in the same texel does not shadow it either.
    pub clearance: f64,
}

/// Everything about an item that its triangles' records need.
pub struct Source<'a> {
    item: &'a Item,
    world_from_normal: DMat3,
    /// Stored position's zero, relative to the eye.
    offset: DVec3,
    /// Relative to which the shadow frames are taken: the eye, anchored.
    eye: DVec3,
    /// Relative to which positions are interpolated: an offset from the eye.
    anchor: DVec3,
    forward: DVec3,
    projection: Projection,
    surface: &'a Surface,
    shadows: &'a [ShadowFrame],
}

impl<'a> Source<'a> {
    /// What its triangles look like.
    #[must_use]
    pub fn surface(&self) -> &'a Surface {
        self.surface
    }

    /// Prepares the records of `item`'s triangles with `surface`.
    #[must_use]
    pub fn new(
        item: &'a Item,
        surface: &'a Surface,
        shadows: &'a [ShadowFrame],
        view: &View,
        anchor: DVec3,
    ) -> Self {
        let shadows = if surface.lit && surface.receives_shadow { shadows } else { &[] };
        Self {
            item,
            world_from_normal: item.world_from_normal(),
            offset: item.origin - view.eye,
            eye: view.eye,
            anchor,
            forward: view.forward,
            projection: view.projection,
            surface,
            shadows,
        }
    }
}
