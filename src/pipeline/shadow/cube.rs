//! Shadows of a point light: six maps, one a side of a cube around it.
//!
//! Everything is measured in the receiver's own distance along the axis of its side, so it has no
//! unit. A tap is a direction; the surface seen along it hides the receiver if it is nearer to the light
//! than the point of the receiver's plane in that direction. So no kernel ends at the border of a side.

mod kernel;
mod receiver;

use super::HALF_TEXEL;
use super::depth_map::{DepthMap, TexelBox, float};
use super::disc::{Disc, EightPoints};
use super::penumbra::{Light, MapFilter, TapCounter, TapCounts, Taps, Verdict, filtered, soft};
use super::pyramid::{DepthRange, Pyramid};
use crate::math::round_to_f32;
use crate::math::simd::*;
use crate::pipeline::shade::{BLOCK, varyings::Receivers};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Elisions, Face, Filter, Pcss, ShadowPass};
use kernel::{Kernel, Spot};
use receiver::{Lifted, Receiver};

/// The maps around a point light. Sides: +x, −x, +y, −y, +z, −z.
#[derive(Debug, PartialEq)]
pub struct CubeMap {
    /// `None` where no caster is, or no receiver whose kernel reaches it.
    sides: [Option<DepthMap>; 6],
    resolution: u32,
    lens: Lens,
    filter: CubeFilter,
    elide: Elisions,
}

/// What all sides have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lens {
    /// Texels per unit of x / w.
    focal_length: f32,
    /// Depth is `near / w`.
    near: f32,
    /// Normal offset per unit of the receiver's obliqueness, just enough that no texel of a plane
    /// shadows the plane, and half a texel.
    offset: f32,
    clearance: f32,
}

type CubeFilter = MapFilter<Pyramids, PcfKernel, SoftKernel>;

#[derive(Clone, Copy, Debug, PartialEq)]
struct PcfKernel {
    /// Tangent of the angle from its centre to its rim: its radius in texels in the middle of a side.
    tangent: f32,
    bias: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct SoftKernel {
    /// The light's, in world units.
    light_radius: f32,
    /// Tangent of the angle from its centre to its rim; `None`: as wide as the nearest caster demands.
    search: Option<f32>,
    bias: f32,
}

type Pyramids = [Option<Pyramid>; 6];

/// The largest normal offset, as a part of the distance to the light: maps of a few texels would have
/// receivers pass it.
const LARGEST_OFFSET: f64 = 0.25;

/// A cube and its pyramids.
struct Maps<'a> {
    cube: &'a CubeMap,
    pyramids: &'a Pyramids,
    counter: TapCounter,
}

/// A light that is no point. Heights are ratios: how many times as far from the light the receiver is as
/// the blocker.
struct Soft<'a> {
    maps: Maps<'a>,
    size: &'a SoftKernel,
}

impl CubeMap {
    /// Draws the faces of `pass`.
    pub(super) fn draw(
        pass: &ShadowPass,
        faces: &[Face],
        elide: Elisions,
        work: &Work,
    ) -> Result<Self, Cancelled> {
        let mut sides = [const { None }; 6];
        for face in faces {
            sides[face.side] = Some(DepthMap::draw(face, elide, work)?);
        }
        let view = &faces.first().expect("a cube without faces is not planned").view;
        let focal_length = view.scale[0] / 256.0;
        // A receiver that moves along its normal may move away from the axis of its side: its texel
        // grows by as much as the offset is of the distance.
        let reach = HALF_TEXEL * pass.bias / focal_length * (1.0 + 1.5 / focal_length);
        let reach = reach.min(LARGEST_OFFSET);
        let lens = Lens {
            focal_length: round_to_f32(focal_length),
            near: round_to_f32(view.near),
            offset: round_to_f32(reach),
            clearance: round_to_f32(0.5 * pass.bias / focal_length),
        };
        let filter = filter(pass, &sides, focal_length, work)?;
        Ok(Self { sides, resolution: view.width, lens, filter, elide })
    }

    /// The maps of its sides.
    pub(super) fn sides(&self) -> &[Option<DepthMap>; 6] {
        &self.sides
    }

    #[inline(always)]
    pub(super) fn visibility<S: Simd>(
        &self,
        simd: S,
        receivers: &Receivers,
        asked: u64,
        out: &mut [f32; BLOCK],
    ) -> TapCounts {
        let mut counts = TapCounts::default();
        for at in (0..BLOCK).step_by(LANES) {
            let asked = asked >> at & 0xff;
            if asked == 0 {
                continue;
            }
            let lifted = Lifted::load(simd, receivers, at, &self.lens);
            let out = &mut out[at..at + LANES];
            let eight = match &self.filter {
                CubeFilter::Hard => {
                    self.hard(simd, &lifted).store_slice(out);
                    TapCounts { done: u64::from(asked.count_ones()), spared: 0 }
                }
                CubeFilter::Pcf { pyramid: pyramids, disc, kernel } => {
                    let maps = self.maps(pyramids);
                    for lane in set_bits(asked) {
                        let receiver = lifted.lane(lane);
                        out[lane] = filtered(simd, &maps, disc, &receiver, &kernel.around(&receiver));
                    }
                    maps.counter.counts()
                }
                CubeFilter::Pcss { pyramid: pyramids, search, filter, size } => {
                    let light = Soft { maps: self.maps(pyramids), size };
                    for lane in set_bits(asked) {
                        out[lane] = soft(simd, &light, search, filter, &lifted.lane(lane));
                    }
                    light.maps.counter.counts()
                }
            };
            counts.add(eight);
        }
        counts
    }

    fn maps<'a>(&'a self, pyramids: &'a Pyramids) -> Maps<'a> {
        Maps { cube: self, pyramids, counter: TapCounter::default() }
    }

    /// One tap for each of eight receivers.
    #[inline(always)]
    fn hard<S: Simd>(&self, simd: S, lifted: &Lifted<S>) -> f32x8<S> {
        let ratio = self.ratio(simd, &Spot::of(simd, lifted.place), lifted.scale);
        let blocked = ratio.simd_gt(f32x8::splat(simd, self.lens.nearest_blocker()));
        blocked.select(f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0))
    }

    /// In each of eight directions: the length of the direction's vector over the distance of what is
    /// seen there; 0 where nothing is.
    #[inline(always)]
    fn ratio<S: Simd>(&self, simd: S, spot: &Spot<S>, scale: f32x8<S>) -> f32x8<S> {
        let corner = float(self.resolution) * 0.5;
        let number = always(
            #[inline(always)]
            |tangent: f32x8<S>| {
                let from_corner = (tangent * self.lens.focal_length + corner).floor();
                let side = f32x8::splat(simd, float(self.resolution));
                let index: i32x8<S> = min(max(from_corner, f32x8::splat(simd, -1.0)), side).to_int_precise();
                index
            },
        );
        let (x, y) = (number(spot.right), number(f32x8::splat(simd, 0.0) - spot.up));
        let depth = f32x8::from_fn(
            simd,
            #[inline(always)]
            |lane| match &self.sides[spot.side[lane].cast_unsigned() as usize % 6] {
                Some(map) => map.texel(x[lane], y[lane]),
                None => 0.0,
            },
        );
        depth * (spot.distance * scale)
    }

    /// The texels between tangents to the right and upwards, and a hair more than the rounding of a tap.
    #[inline(always)]
    fn texels_between(&self, [right, up]: [[f32; 2]; 2]) -> TexelBox {
        const HAIR: f32 = 1.0 / 64.0;
        let (focal_length, corner) = (self.lens.focal_length, float(self.resolution) * 0.5);
        let x = [right[0] * focal_length + corner - HAIR, right[1] * focal_length + corner + HAIR];
        let y = [corner - up[1] * focal_length - HAIR, corner - up[0] * focal_length + HAIR];
        TexelBox::between(x, y, self.resolution)
    }
}

impl Taps for Maps<'_> {
    type Receiver = Receiver;
    type Kernel = Kernel;

    /// On whichever side they are.
    #[inline(always)]
    fn range(&self, receiver: &Receiver, kernel: &Kernel) -> DepthRange {
        let mut range: Option<DepthRange> = None;
        for (side, pyramid) in self.pyramids.iter().enumerate() {
            let Some(footprint) = kernel.footprint(receiver, side) else { continue };
            let here = match (pyramid, footprint) {
                (None, _) => DepthRange::NOTHING,
                (Some(pyramid), kernel::Footprint::Whole) => pyramid.whole(),
                (Some(pyramid), kernel::Footprint::Part(tangents)) => {
                    pyramid.range(&self.cube.texels_between(tangents))
                }
            };
            range = Some(range.map_or(here, |range| range.union(here)));
        }
        range.unwrap_or(DepthRange::NOTHING)
    }

    #[inline(always)]
    fn verdict(&self, receiver: &Receiver, kernel: &Kernel, range: DepthRange) -> Verdict {
        kernel.verdict(receiver, &self.cube.lens, range).within(self.cube.elide)
    }

    #[inline(always)]
    fn counter(&self) -> &TapCounter {
        &self.counter
    }

    /// A tap asks about the point of the receiver's plane in its direction; where that lies farther from
    /// the light than the tap, about the tap itself: what lies behind a point cannot shade it.
    #[inline(always)]
    fn for_each_tap<S: Simd>(
        &self,
        simd: S,
        disc: &Disc,
        receiver: &Receiver,
        kernel: &Kernel,
        mut f: impl FnMut(mask32x8<S>, f32x8<S>),
    ) {
        let [a, b] = kernel.axes;
        let centre = Vec3x8::splat(simd, receiver.place);
        let scale = f32x8::splat(simd, receiver.scale);
        let (slope_a, slope_b) = (receiver.plane.dot(a), receiver.plane.dot(b));
        let zero = f32x8::splat(simd, 0.0);
        disc.for_each_eight(
            simd,
            always(
                #[inline(always)]
                |points: EightPoints<S>| {
                    let tap = Vec3x8 {
                        x: centre.x + (points.x * a.x + points.y * b.x),
                        y: centre.y + (points.x * a.y + points.y * b.y),
                        z: centre.z + (points.x * a.z + points.y * b.z),
                    };
                    let slope = max(points.x * slope_a + points.y * slope_b, zero);
                    let plane = (slope + self.cube.lens.nearest_blocker()) + points.radius * kernel.rise;
                    let ratio = self.cube.ratio(simd, &Spot::of(simd, tap), scale);
                    f(points.counts & ratio.simd_gt(plane), ratio);
                },
            ),
        );
    }
}

impl<'a> Light for Soft<'a> {
    type Maps = Maps<'a>;

    #[inline(always)]
    fn maps(&self) -> &Maps<'a> {
        &self.maps
    }

    /// No caster is nearer than depth 1.
    #[inline(always)]
    fn highest(&self, receiver: &Receiver) -> f32 {
        receiver.scale * receiver.distance
    }

    #[inline(always)]
    fn height_within(&self, receiver: &Receiver, kernel: &Kernel, range: DepthRange) -> f32 {
        range.greatest * (receiver.scale * (receiver.distance + kernel.reach()))
    }

    /// Taps tell of ratios.
    #[inline(always)]
    fn height(&self, _: &Receiver, blocker: f32) -> f32 {
        blocker
    }

    #[inline(always)]
    fn kernel(&self, receiver: &Receiver, height: f32) -> Kernel {
        self.size.kernel(receiver, height)
    }

    #[inline(always)]
    fn fixed_search(&self, receiver: &Receiver) -> Option<Kernel> {
        self.size.fixed_search(receiver)
    }
}

impl Lens {
    /// What is nearer than this ratio says hides a receiver in the middle of a kernel: half a texel
    /// before it, and 16 units in the last place for its own rounding.
    #[inline(always)]
    fn nearest_blocker(&self) -> f32 {
        1.0 + 8.0 * f32::EPSILON + self.clearance
    }
}

/// Reads the maps of `sides` as the plan says.
fn filter(
    pass: &ShadowPass,
    sides: &[Option<DepthMap>; 6],
    focal_length: f64,
    work: &Work,
) -> Result<CubeFilter, Cancelled> {
    let pyramids = || -> Result<Pyramids, Cancelled> {
        let mut pyramids = [const { None }; 6];
        for (pyramid, side) in pyramids.iter_mut().zip(sides) {
            *pyramid = side.as_ref().map(|map| Pyramid::over(map, work)).transpose()?;
        }
        Ok(pyramids)
    };
    let bias = round_to_f32(pass.bias);
    Ok(match &pass.filter {
        Filter::Hard => CubeFilter::Hard,
        Filter::Pcf { radius, taps } => {
            let kernel = PcfKernel { tangent: round_to_f32(radius / focal_length), bias };
            CubeFilter::Pcf { pyramid: pyramids()?, disc: Disc::new(*taps), kernel }
        }
        Filter::Pcss(Pcss { light_radius, search_radius, search_taps, filter_taps }) => CubeFilter::Pcss {
            pyramid: pyramids()?,
            search: Disc::new(*search_taps),
            filter: Disc::new(*filter_taps),
            size: SoftKernel {
                light_radius: round_to_f32(*light_radius),
                search: search_radius.map(|radius| round_to_f32(radius / focal_length)),
                bias,
            },
        },
    })
}

#[cfg(test)]
mod tests;
