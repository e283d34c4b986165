//! Shadows of parallel light: one map, texels of one size.

use super::depth_map::{DepthMap, TexelBox, float};
use super::disc::{Disc, EightPoints};
use super::penumbra::{Light, MapFilter, TapCounter, TapCounts, Taps, Verdict, filtered, soft};
use super::pyramid::{DepthRange, Pyramid};
use super::{DEPTH_TOLERANCE, WIDEST_CONE};
use crate::math::round_to_f32;
use crate::math::simd::*;
use crate::pipeline::shade::{BLOCK, varyings::Receivers};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Elisions, Face, Filter, Pcss, ShadowPass};

/// The map of a light along whose rays all texels have one size.
#[derive(Debug, PartialEq)]
pub struct DirectionalMap {
    depth: DepthMap,
    filter: MapFilter<Pyramid, Kernel, SoftKernel>,
    elide: Elisions,
}

/// A kernel around a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kernel {
    /// Radii along x and y in texels.
    radius: [f32; 2],
    /// Depth by which the receiver's plane is taken to rise from the kernel's centre to its rim: what is
    /// flatter than that is no shadow.
    rise: f32,
}

/// How large the kernels of soft shadows are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SoftKernel {
    /// Texels along x and y per unit of depth between receiver and blocker.
    per_depth: [f32; 2],
    /// Rise per unit of depth between receiver and blocker.
    rise_per_depth: f32,
    /// Texels; `None`: as wide as the nearest caster demands.
    search_radius: Option<f32>,
}

/// One receiver in the map.
#[derive(Clone, Copy, Debug)]
struct Receiver {
    /// Texels from the map's corner.
    x: f32,
    y: f32,
    /// Depth, with the tolerance for its own rounding.
    depth: f32,
    /// Depth gained per texel along x and y.
    slope: [f32; 2],
}

/// Radius in texels beyond which no kernel grows: its taps would lie farther apart than most
/// casters are wide.
const WIDEST_TEXELS: f32 = 1024.0;

/// A map and its pyramid.
struct Maps<'a> {
    depth: &'a DepthMap,
    pyramid: &'a Pyramid,
    elide: Elisions,
    counter: TapCounter,
}

/// A kernel and the texels that its taps can meet.
#[derive(Clone, Copy, Debug)]
struct Placed {
    kernel: Kernel,
    texels: TexelBox,
}

/// A light that is no point: heights are depths above the receiver's.
struct Soft<'a> {
    maps: Maps<'a>,
    size: &'a SoftKernel,
}

impl DirectionalMap {
    /// Draws the one map of `pass`.
    pub(super) fn draw(
        pass: &ShadowPass,
        face: &Face,
        elide: Elisions,
        work: &Work,
    ) -> Result<Self, Cancelled> {
        let depth = DepthMap::draw(face, elide, work)?;
        let texels = face.view.scale.map(|scale| scale / 256.0);
        let filter = match &pass.filter {
            Filter::Hard => MapFilter::Hard,
            Filter::Pcf { radius, taps } => {
                let rise = radius * pass.bias * face.view.depth_slope() / texels[0].min(texels[1]);
                let kernel = Kernel { radius: [round_to_f32(*radius); 2], rise: round_to_f32(rise) };
                MapFilter::Pcf { pyramid: Pyramid::over(&depth, work)?, disc: Disc::new(*taps), kernel }
            }
            Filter::Pcss(pcss) => MapFilter::Pcss {
                pyramid: Pyramid::over(&depth, work)?,
                search: Disc::new(pcss.search_taps),
                filter: Disc::new(pcss.filter_taps),
                size: SoftKernel::new(pcss, texels, face.view.depth_slope(), pass.bias),
            },
        };
        Ok(Self { depth, filter, elide })
    }

    /// Its one map.
    pub(super) fn depths(&self) -> &DepthMap {
        &self.depth
    }

    #[inline(always)]
    pub(super) fn visibility<S: Simd>(
        &self,
        simd: S,
        receivers: &Receivers,
        asked: u64,
        out: &mut [f32; BLOCK],
    ) -> TapCounts {
        match &self.filter {
            MapFilter::Hard => {
                for at in (0..BLOCK).step_by(LANES) {
                    if asked >> at & 0xff != 0 {
                        self.hard(simd, receivers, at).store_slice(&mut out[at..at + LANES]);
                    }
                }
                TapCounts { done: u64::from(asked.count_ones()), spared: 0 }
            }
            MapFilter::Pcf { pyramid, disc, kernel } => {
                let maps = self.maps(pyramid);
                for at in set_bits(asked) {
                    let receiver = self.receiver(receivers, at);
                    out[at] = filtered(simd, &maps, disc, &receiver, &maps.place(&receiver, *kernel));
                }
                maps.counter.counts()
            }
            MapFilter::Pcss { pyramid, search, filter, size } => {
                let light = Soft { maps: self.maps(pyramid), size };
                for at in set_bits(asked) {
                    out[at] = soft(simd, &light, search, filter, &self.receiver(receivers, at));
                }
                light.maps.counter.counts()
            }
        }
    }

    fn maps<'a>(&'a self, pyramid: &'a Pyramid) -> Maps<'a> {
        Maps { depth: &self.depth, pyramid, elide: self.elide, counter: TapCounter::default() }
    }

    /// One tap for each of eight receivers.
    #[inline(always)]
    fn hard<S: Simd>(&self, simd: S, receivers: &Receivers, at: usize) -> f32x8<S> {
        let half = float(self.depth.resolution()) * 0.5;
        let place = always(
            #[inline(always)]
            |axis: usize| f32x8::from_slice(simd, &receivers.place[axis][at..at + LANES]),
        );
        let x = self.depth.texel_numbers(simd, place(0) + half);
        let y = self.depth.texel_numbers(simd, place(1) + half);
        let nearest = f32x8::from_fn(
            simd,
            #[inline(always)]
            |lane| self.depth.texel(x[lane], y[lane]),
        );
        let zero = f32x8::splat(simd, 0.0);
        let blocked = nearest.simd_gt(max(place(2) + DEPTH_TOLERANCE, zero));
        blocked.select(zero, f32x8::splat(simd, 1.0))
    }

    #[inline(always)]
    fn receiver(&self, Receivers { place, plane }: &Receivers, at: usize) -> Receiver {
        let half = float(self.depth.resolution()) * 0.5;
        Receiver {
            x: place[0][at] + half,
            y: place[1][at] + half,
            depth: place[2][at] + DEPTH_TOLERANCE,
            slope: [plane[0][at], plane[1][at]],
        }
    }
}

impl Maps<'_> {
    #[inline(always)]
    fn place(&self, receiver: &Receiver, kernel: Kernel) -> Placed {
        let [across, down] = kernel.radius;
        let (x, y) = (receiver.x, receiver.y);
        let resolution = self.depth.resolution();
        let texels = TexelBox::between([x - across, x + across], [y - down, y + down], resolution);
        Placed { kernel, texels }
    }
}

impl Taps for Maps<'_> {
    type Receiver = Receiver;
    type Kernel = Placed;

    #[inline(always)]
    fn range(&self, _: &Receiver, placed: &Placed) -> DepthRange {
        self.pyramid.range(&placed.texels)
    }

    #[inline(always)]
    fn verdict(&self, receiver: &Receiver, placed: &Placed, range: DepthRange) -> Verdict {
        placed.kernel.verdict(receiver, range).within(self.elide)
    }

    #[inline(always)]
    fn counter(&self) -> &TapCounter {
        &self.counter
    }

    /// A tap asks about the point of the receiver's plane above or below it; where that lies deeper than
    /// the receiver, about the receiver's own depth: what lies deeper than a point cannot shade it.
    #[inline(always)]
    fn for_each_tap<S: Simd>(
        &self,
        simd: S,
        disc: &Disc,
        receiver: &Receiver,
        Placed { kernel, texels }: &Placed,
        mut f: impl FnMut(mask32x8<S>, f32x8<S>),
    ) {
        let window = self.depth.window(texels);
        let zero = f32x8::splat(simd, 0.0);
        disc.for_each_eight(
            simd,
            always(
                #[inline(always)]
                |points: EightPoints<S>| {
                    let (across, down) = (points.x * kernel.radius[0], points.y * kernel.radius[1]);
                    let x = self.depth.texel_numbers(simd, across + receiver.x);
                    let y = self.depth.texel_numbers(simd, down + receiver.y);
                    let slope = max(across * receiver.slope[0] + down * receiver.slope[1], zero);
                    let plane = (slope + receiver.depth) + points.radius * kernel.rise;
                    let depth = window.texels(simd, x, y);
                    f(points.counts & depth.simd_gt(max(plane, zero)), depth);
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

    /// No caster lies above depth 1.
    #[inline(always)]
    fn highest(&self, receiver: &Receiver) -> f32 {
        1.0 - receiver.depth
    }

    #[inline(always)]
    fn height_within(&self, receiver: &Receiver, _: &Placed, range: DepthRange) -> f32 {
        range.greatest - receiver.depth
    }

    #[inline(always)]
    fn height(&self, receiver: &Receiver, blocker: f32) -> f32 {
        blocker - receiver.depth
    }

    #[inline(always)]
    fn kernel(&self, receiver: &Receiver, height: f32) -> Placed {
        self.maps.place(receiver, self.size.kernel(height))
    }

    #[inline(always)]
    fn fixed_search(&self, receiver: &Receiver) -> Option<Placed> {
        Some(self.maps.place(receiver, self.size.fixed_search()?))
    }
}

impl Kernel {
    /// What every tap of the kernel over texels of such depths must say. The same operations in the same
    /// order as at a tap, each with its greatest operand, and each monotonic, rounding included.
    #[inline(always)]
    fn verdict(&self, receiver: &Receiver, range: DepthRange) -> Verdict {
        if range.greatest <= receiver.depth.max(0.0) {
            return Verdict::Lit;
        }
        let slope = self.radius[0] * receiver.slope[0].abs() + self.radius[1] * receiver.slope[1].abs();
        let plane = (slope + receiver.depth) + self.rise;
        if range.least > plane.max(0.0) { Verdict::Dark } else { Verdict::Mixed }
    }
}

impl SoftKernel {
    /// For a map of so many texels per world unit and such a depth per world unit.
    fn new(pcss: &Pcss, texels: [f64; 2], depth_slope: f64, bias: f64) -> Self {
        let per_depth = texels.map(|texels| round_to_f32(pcss.light_radius * texels / depth_slope));
        let rise_per_depth = round_to_f32(pcss.light_radius.min(WIDEST_CONE) * bias);
        Self { per_depth, rise_per_depth, search_radius: pcss.search_radius.map(round_to_f32) }
    }

    /// The disc of the light as seen from a receiver, at a blocker `height` (in depth) above it.
    #[inline(always)]
    fn kernel(&self, height: f32) -> Kernel {
        let radius = self.per_depth.map(|per_depth| (per_depth * height).clamp(0.0, WIDEST_TEXELS));
        Kernel { radius, rise: self.rise_per_depth * height }
    }

    /// Where blockers are looked for, if that does not follow from their height.
    #[inline(always)]
    fn fixed_search(&self) -> Option<Kernel> {
        let radius = self.search_radius?;
        let reach = radius / self.per_depth[0].max(self.per_depth[1]);
        Some(Kernel { radius: [radius; 2], rise: self.rise_per_depth * reach })
    }
}

#[cfg(test)]
mod tests;
