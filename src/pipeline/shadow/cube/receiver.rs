//! Receivers as a point light sees them.

use super::Lens;
use crate::math::simd::*;
use crate::pipeline::shade::varyings::Receivers;
use glam::Vec3;

/// Eight receivers, off their own surfaces. Lengths are in units of each one's distance along the axis of
/// its side.
pub(super) struct Lifted<S: Simd> {
    /// Where they are.
    pub(super) place: Vec3x8<S>,
    /// The vector whose dot product with every point of the receiver's plane is 1.
    plane: Vec3x8<S>,
    /// The unit over the near distance: depth times this and the distance of a direction along its
    /// side's axis is a ratio of distances.
    pub(super) scale: f32x8<S>,
    /// The unit in world units.
    unit: f32x8<S>,
    /// By how much the ratio of distances of a plane fell when its receivers moved.
    cleared: f32x8<S>,
}

/// One of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    pub(super) place: Vec3,
    pub(super) plane: Vec3,
    pub(super) scale: f32,
    pub(super) unit: f32,
    pub(super) cleared: f32,
    /// Distance along the axis of its side: 1, but for the offset.
    pub(super) distance: f32,
    /// Distance from the light.
    pub(super) length: f32,
}

impl<S: Simd> Lifted<S> {
    /// Moves eight receivers along their planes' normals towards the light.
    ///
    /// A plane loses `(|nₓ| + |n_y|) / 2` texels over half a texel, with the components of its normal
    /// along the side's axes; as a kernel may reach into another side, the two largest of all three are
    /// taken.
    #[inline(always)]
    pub(super) fn load(simd: S, receivers: &Receivers, at: usize, lens: &Lens) -> Self {
        let position = Vec3x8::load(simd, &receivers.place, at);
        let plane = Vec3x8::load(simd, &receivers.plane, at);
        let unit = max(max(position.x.abs(), position.y.abs()), position.z.abs());
        let place = Vec3x8 { x: position.x / unit, y: position.y / unit, z: position.z / unit };
        let plane = plane.scale(unit);
        let length = max(plane.dot(plane).sqrt(), f32x8::splat(simd, f32::MIN_POSITIVE));
        let normal = Vec3x8 { x: plane.x / length, y: plane.y / length, z: plane.z / length };
        let (x, y, z) = (normal.x.abs(), normal.y.abs(), normal.z.abs());
        let oblique = (x + y) + z - min(min(x, y), z);
        let offset = oblique * lens.offset;
        Self {
            place: place - normal.scale(offset),
            plane,
            scale: unit / lens.near,
            unit,
            cleared: length * offset,
        }
    }

    /// One of the eight.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Receiver {
        let of = always(
            #[inline(always)]
            |v: &Vec3x8<S>| Vec3::new(v.x[lane], v.y[lane], v.z[lane]),
        );
        let place = of(&self.place);
        let [x, y, z] = [place.x.abs(), place.y.abs(), place.z.abs()];
        let distance = if x >= y && x >= z {
            x
        } else if y >= z {
            y
        } else {
            z
        };
        Receiver {
            place,
            plane: of(&self.plane),
            scale: self.scale[lane],
            unit: self.unit[lane],
            cleared: self.cleared[lane],
            distance,
            length: dot(place, place).sqrt(),
        }
    }
}

/// Summed x, y, z.
#[inline(always)]
pub(super) fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}
