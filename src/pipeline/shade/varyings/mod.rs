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

use super::BLOCK;
use crate::math::{Projection, View};
use crate::plan::{Item, Surface};
use glam::{DMat3, DVec3};

/// A light's view of a receiver as a varying: what its shadow maps are asked with.
#[derive(Clone, Copy, Debug)]
pub struct ShadowFrame {
    /// Anchored space → [`Receivers::place`], linear part.
    pub linear: DMat3,
    /// Anchored position that it takes to zero.
    pub origin: DVec3,
    /// What depends on how the light travels.
    pub rays: RayFrame,
}

/// What moves a receiver off its own surface before it is looked up.
#[derive(Clone, Copy, Debug)]
pub enum RayFrame {
    /// Parallel light: its texels have one size, so triangles are moved as a whole.
    Parallel {
        /// The way the light travels.
        direction: DVec3,
        /// Normal offset per |component| of the receiver's unit normal along the map's x and y axes, in
        /// world units: just enough that no texel of a plane shadows the plane (numerics: B33).
        offset: [DVec3; 2],
        /// Depth by which every receiver moves towards the light beside that: half a texel, so that a
        /// neighbour that rises by up to 45° in the same texel does not shadow it either.
        clearance: f64,
    },
    /// A point light: its texels grow with the distance, so each receiver is moved on its own.
    FromPoint,
}

/// A block of receivers as one light sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receivers {
    /// Parallel light: texel x and y from the map's centre, and depth. Point light: position relative
    /// to it, in world axes.
    pub place: [[f32; BLOCK]; 3],
    /// The plane that each lies in. Parallel light: depth gained per texel along x and y, and 0. Point
    /// light: the vector whose dot product with every point of the plane, relative to the light, is 1.
    pub plane: [[f32; BLOCK]; 3],
}

impl Default for Receivers {
    fn default() -> Self {
        Self { place: [[0.0; BLOCK]; 3], plane: [[0.0; BLOCK]; 3] }
    }
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
