//! Shadow maps: casters in, depth maps a light out, and the question that shading asks of them.
//!
//! ```text
//! ShadowPass ─ draw each face (geometry, coverage, depth alone) ─ pyramid ─ ShadowMap
//! Receivers ─ pyramid: all lit? all dark? ─ else taps ─ part of the light that arrives
//! ```
//!
//! A filter is a disc of taps around the receiver. The result is a count of lit taps over their number: a
//! kernel wholly lit is exactly 1, one wholly dark exactly 0.
//!
//! # Why a surface does not shadow itself
//!
//! A texel holds the depth at its centre, which lies up to half a texel from a tap along x and along y. On
//! a plane whose depth changes by `z_x` and `z_y` per texel it may be nearer to the light than the tap by
//! `(|z_x| + |z_y|) / 2`. A receiver moved along its unit normal n by `(|n_x| + |n_y|) / 2` texels clears
//! just that at every slope, and moves by less than a texel where the offset in depth would grow as the
//! tangent (numerics: B33; `bias` is a factor on it).
//!
//! A tap at k texels from the receiver that compared with the receiver's own depth would need k texels
//! more. It compares with the receiver's plane at its own place, so half a texel is enough for every
//! kernel. Where the plane there lies deeper than the receiver, it compares with the receiver's own depth,
//! since what lies deeper than a point cannot shade it: a floor far below does not darken the rim of a
//! ball. Surfaces that are no planes rise above them in hollows: a tap lets pass what rises by less than
//! 45° on the way to it, and by half a texel.

mod cube;
mod depth_map;
mod directional;
mod disc;
mod penumbra;
mod pyramid;

pub use cube::CubeMap;
pub use depth_map::DepthMap;
pub use directional::DirectionalMap;
pub use penumbra::TapCounts;

use super::shade::BLOCK;
use super::shade::varyings::{RayFrame, Receivers, ShadowFrame};
use super::work::{Cancelled, Work};
use crate::math::simd::*;
use crate::plan::{Elisions, Maps, ShadowPass, Tally};
use glam::DMat3;

/// The shadow of one light.
#[derive(Debug, PartialEq)]
pub enum ShadowMap {
    /// Of parallel light.
    Directional(DirectionalMap),
    /// Around a point light.
    Cube(Box<CubeMap>),
}

/// A receiver's own rounding: 16 units in the last place of the depth range.
const DEPTH_TOLERANCE: f32 = 16.0 * f32::EPSILON * 0.5;

/// Half a texel is the farthest that a texel's centre lies from what it is asked about; 1/128 more
/// covers the snapping of its triangle and the rounding of the coordinates.
const HALF_TEXEL: f64 = 0.5 + 1.0 / 128.0;

/// What rises above a receiver's plane by less than 45° is no shadow: it is a neighbour in a hollow of
/// the same surface. In the cone between a receiver and a large light, by less than this part of the
/// cone's own height.
const WIDEST_CONE: f64 = 0.25;

/// Draws the maps of each pass, without what `elide` leaves out of that and of reading them.
///
/// # Errors
/// [`Cancelled`].
pub fn render_maps(passes: &[ShadowPass], elide: Elisions, work: &Work) -> Result<Vec<ShadowMap>, Cancelled> {
    let draw = |pass: &ShadowPass| match &pass.maps {
        Maps::Directional(face) => DirectionalMap::draw(pass, face, elide, work).map(ShadowMap::Directional),
        Maps::Cube { faces, .. } => {
            CubeMap::draw(pass, faces, elide, work).map(|map| ShadowMap::Cube(Box::new(map)))
        }
    };
    passes.iter().map(draw).collect()
}

impl ShadowMap {
    /// What the light sees: one map of parallel light, else the six sides around it, of which `None` are not
    /// drawn.
    #[must_use]
    pub fn depths(&self) -> Vec<Option<&DepthMap>> {
        match self {
            Self::Directional(map) => vec![Some(map.depths())],
            Self::Cube(map) => map.sides().iter().map(Option::as_ref).collect(),
        }
    }

    /// What drawing them cost, and what it was spared.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        self.depths().into_iter().flatten().for_each(|map| tally.add(map.tally()));
        tally
    }

    /// The part of the light that reaches the receivers of a block: 1 where all of it does, 0 where
    /// casters hide the whole light; only those whose bit is set in `asked` need an answer.
    ///
    /// Receivers are as [`frame`] makes them. Outside the maps no caster is, and what lies nearer to the
    /// light than all of them is lit as well. Returns how many taps that took.
    pub fn visibility(
        &self,
        level: Level,
        receivers: &Receivers,
        asked: u64,
        out: &mut [f32; BLOCK],
    ) -> TapCounts {
        dispatch!(level, simd => match self {
            Self::Directional(map) => map.visibility(simd, receivers, asked, out),
            Self::Cube(map) => map.visibility(simd, receivers, asked, out),
        })
    }
}

/// How receivers find their place in the maps of `pass`.
#[must_use]
pub fn frame(pass: &ShadowPass) -> ShadowFrame {
    match &pass.maps {
        Maps::Directional(face) => {
            let view = &face.view;
            let [x, y] = view.scale.map(|scale| scale / 256.0);
            let depth = view.depth_slope();
            let rows = DMat3::from_cols(view.right * x, view.up * -y, view.forward * -depth);
            let reach = HALF_TEXEL * pass.bias;
            ShadowFrame {
                linear: rows.transpose(),
                origin: view.eye + view.forward * view.distance(0.0),
                rays: RayFrame::Parallel {
                    direction: view.forward,
                    offset: [view.right * (reach / x), view.up * (reach / y)],
                    clearance: 0.5 / x.min(y) * depth * pass.bias,
                },
            }
        }
        Maps::Cube { position, .. } => {
            ShadowFrame { linear: DMat3::IDENTITY, origin: *position, rays: RayFrame::FromPoint }
        }
    }
}

#[cfg(test)]
mod tests;
