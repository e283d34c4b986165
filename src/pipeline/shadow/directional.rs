//! Shadows of parallel light: one map, texels of one size.

use super::depth_map::{DepthMap, TexelBox, float};
use super::disc::{Disc, EightPoints};
use super::pyramid::{DepthRange, Pyramid};
use super::{DEPTH_TOLERANCE, PCF_TAPS, Verdict, WIDEST_CONE, bits, sum_of_lanes};
use crate::math::round_to_f32;
use crate::math::simd::*;
use crate::pipeline::shade::{BLOCK, varyings::Receivers};
use crate::pipeline::work::{Cancelled, Work};
use crate::plan::{Face, Filter, Pcss, ShadowPass};

/// The map of a light along whose rays all texels have one size.
#[derive(Debug, PartialEq)]
pub struct DirectionalMap {
    depth: DepthMap,
    filter: MapFilter,
}

#[derive(Debug, PartialEq)]
enum MapFilter {
    Hard,
    Pcf { pyramid: Pyramid, disc: Disc, kernel: Kernel },
    Pcss { pyramid: Pyramid, search: Disc, filter: Disc, size: SoftKernel },
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

/// How often the search for blockers is narrowed to what the nearest caster below it demands.
const NARROWINGS: usize = 3;

impl DirectionalMap {
    /// Draws the one map of `pass`.
    pub(super) fn draw(pass: &ShadowPass, face: &Face, work: &Work) -> Result<Self, Cancelled> {
        let depth = DepthMap::draw(face, work)?;
        let texels = face.view.scale.map(|scale| scale / 256.0);
        let filter = match &pass.filter {
            Filter::Hard => MapFilter::Hard,
            Filter::Pcf { radius } => {
                let rise = radius * pass.bias * face.view.depth_slope() / texels[0].min(texels[1]);
                let kernel = Kernel { radius: [round_to_f32(*radius); 2], rise: round_to_f32(rise) };
                MapFilter::Pcf { pyramid: Pyramid::over(&depth, work)?, disc: Disc::new(PCF_TAPS), kernel }
            }
            Filter::Pcss(pcss) => MapFilter::Pcss {
                pyramid: Pyramid::over(&depth, work)?,
                search: Disc::new(pcss.search_taps),
                filter: Disc::new(pcss.filter_taps),
                size: SoftKernel::new(pcss, texels, face.view.depth_slope(), pass.bias),
            },
        };
        Ok(Self { depth, filter })
    }

    #[inline(always)]
    pub(super) fn visibility<S: Simd>(
        &self,
        simd: S,
        receivers: &Receivers,
        asked: u64,
        out: &mut [f32; BLOCK],
    ) {
        match &self.filter {
            MapFilter::Hard => {
                for at in (0..BLOCK).step_by(LANES) {
                    if asked >> at & 0xff != 0 {
                        self.hard(simd, receivers, at).store_slice(&mut out[at..at + LANES]);
                    }
                }
            }
            MapFilter::Pcf { pyramid, disc, kernel } => {
                for at in bits(asked) {
                    let receiver = self.receiver(receivers, at);
                    out[at] = self.filtered(simd, pyramid, disc, &receiver, kernel);
                }
            }
            MapFilter::Pcss { pyramid, search, filter, size } => {
                for at in bits(asked) {
                    let receiver = self.receiver(receivers, at);
                    out[at] = self.soft(simd, pyramid, search, filter, &receiver, size);
                }
            }
        }
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

    /// The part of the kernel's taps that is lit: exactly 1 if all are, exactly 0 if none is.
    #[inline(always)]
    fn filtered<S: Simd>(
        &self,
        simd: S,
        pyramid: &Pyramid,
        disc: &Disc,
        receiver: &Receiver,
        kernel: &Kernel,
    ) -> f32 {
        let texels = self.texels_under(receiver, kernel);
        match kernel.verdict(receiver, pyramid.range(&texels)) {
            Verdict::Lit => 1.0,
            Verdict::Dark => 0.0,
            Verdict::Mixed => self.lit_part(simd, disc, receiver, kernel, &texels),
        }
    }

    /// The same from the taps alone.
    #[inline(always)]
    fn lit_part<S: Simd>(
        &self,
        simd: S,
        disc: &Disc,
        receiver: &Receiver,
        kernel: &Kernel,
        texels: &TexelBox,
    ) -> f32 {
        let mut blocked = 0;
        self.for_each_tap(
            simd,
            disc,
            receiver,
            kernel,
            texels,
            always(
                #[inline(always)]
                |mask: mask32x8<S>, _| blocked += mask.to_bitmask().count_ones(),
            ),
        );
        (disc.count() - float(blocked)) / disc.count()
    }

    /// Soft shadow: as wide as the blockers above the receiver make it.
    #[inline(always)]
    fn soft<S: Simd>(
        &self,
        simd: S,
        pyramid: &Pyramid,
        search: &Disc,
        filter: &Disc,
        receiver: &Receiver,
        size: &SoftKernel,
    ) -> f32 {
        // No caster lies above depth 1.
        let mut height = 1.0 - receiver.depth;
        let mut kernel = size.search(height);
        let mut texels = self.texels_under(receiver, &kernel);
        for _ in 0..NARROWINGS {
            let range = pyramid.range(&texels);
            match kernel.verdict(receiver, range) {
                Verdict::Lit => return 1.0,
                // The filter would lie within the search.
                Verdict::Dark if size.search_radius.is_none() => return 0.0,
                _ => {}
            }
            if size.search_radius.is_some() || range.greatest - receiver.depth >= height {
                break;
            }
            height = range.greatest - receiver.depth;
            kernel = size.search(height);
            texels = self.texels_under(receiver, &kernel);
        }
        let Some(mean) = self.mean_blocker(simd, search, receiver, &kernel, &texels) else { return 1.0 };
        let mean = mean - receiver.depth;
        let above = if size.search_radius.is_none() && mean > height { height } else { mean };
        self.filtered(simd, pyramid, filter, receiver, &size.kernel(above))
    }

    /// Mean depth of what the kernel's taps find before the receiver.
    #[inline(always)]
    fn mean_blocker<S: Simd>(
        &self,
        simd: S,
        disc: &Disc,
        receiver: &Receiver,
        kernel: &Kernel,
        texels: &TexelBox,
    ) -> Option<f32> {
        let zero = f32x8::splat(simd, 0.0);
        let (mut sum, mut count) = (zero, 0);
        self.for_each_tap(
            simd,
            disc,
            receiver,
            kernel,
            texels,
            always(
                #[inline(always)]
                |blocked: mask32x8<S>, depth: f32x8<S>| {
                    sum += blocked.select(depth, zero);
                    count += blocked.to_bitmask().count_ones();
                },
            ),
        );
        (count > 0).then(|| sum_of_lanes(sum) / float(count))
    }

    /// Calls `f` with what blocks the light of eight taps, and their depths.
    ///
    /// A tap asks about the point of the receiver's plane above or below it; where that lies deeper than
    /// the receiver, about the receiver's own depth: what lies deeper than a point cannot shade it.
    #[inline(always)]
    fn for_each_tap<S: Simd>(
        &self,
        simd: S,
        disc: &Disc,
        receiver: &Receiver,
        kernel: &Kernel,
        texels: &TexelBox,
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

    #[inline(always)]
    fn texels_under(&self, receiver: &Receiver, kernel: &Kernel) -> TexelBox {
        let [across, down] = kernel.radius;
        let (x, y) = (receiver.x, receiver.y);
        let resolution = self.depth.resolution();
        TexelBox::between([x - across, x + across], [y - down, y + down], resolution)
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

    /// Where blockers up to `height` above a receiver are looked for.
    #[inline(always)]
    fn search(&self, height: f32) -> Kernel {
        match self.search_radius {
            None => self.kernel(height),
            Some(radius) => {
                let kernel = Kernel { radius: [radius; 2], rise: 0.0 };
                let reach = radius / self.per_depth[0].max(self.per_depth[1]);
                Kernel { rise: self.rise_per_depth * reach, ..kernel }
            }
        }
    }
}

#[cfg(test)]
mod tests;
