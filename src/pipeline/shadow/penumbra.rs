//! Filtered shadows: kernels of taps, the pyramids that spare them, and how wide they are.
//!
//! What is the same for every light. A light's own maps say where a kernel's taps lie ([`Taps`]) and how
//! large its disc looks from a receiver ([`Light`]).

use super::depth_map::float;
use super::disc::Disc;
use super::pyramid::DepthRange;
use crate::math::simd::*;
use crate::plan::{Elision, Elisions};
use std::cell::Cell;

/// How maps are read: with pyramids `P`, by kernels `K` of one size or of sizes `S` that follow what
/// blocks the light.
#[derive(Debug, PartialEq)]
pub(super) enum MapFilter<P, K, S> {
    Hard,
    Pcf { pyramid: P, disc: Disc, kernel: K },
    Pcss { pyramid: P, search: Disc, filter: Disc, size: S },
}

/// What a pyramid says of a kernel.
pub(super) enum Verdict {
    /// No tap is blocked.
    Lit,
    /// Every tap is.
    Dark,
    /// The taps must tell.
    Mixed,
}

impl Verdict {
    /// What it says where taps may be left out: where not, they must tell.
    #[inline(always)]
    pub(super) fn within(self, elide: Elisions) -> Self {
        if elide.contains(Elision::DecidedTaps) { self } else { Self::Mixed }
    }
}

/// How many taps were made, and how many a pyramid spared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapCounts {
    /// Made.
    pub done: u64,
    /// Known without being made.
    pub spared: u64,
}

impl TapCounts {
    /// Adds another's.
    #[inline(always)]
    pub(super) fn add(&mut self, o: Self) {
        self.done += o.done;
        self.spared += o.spared;
    }
}

/// Counts taps on the way through kernels.
#[derive(Debug, Default)]
pub(super) struct TapCounter {
    done: Cell<u64>,
    spared: Cell<u64>,
}

impl TapCounter {
    #[inline(always)]
    fn make(&self, disc: &Disc) {
        self.done.set(self.done.get() + disc.taps());
    }

    #[inline(always)]
    fn spare(&self, disc: &Disc) {
        self.spared.set(self.spared.get() + disc.taps());
    }

    #[inline(always)]
    pub(super) fn counts(&self) -> TapCounts {
        TapCounts { done: self.done.get(), spared: self.spared.get() }
    }
}

/// The maps of one light, as kernels of taps ask them.
pub(super) trait Taps {
    /// Who asks.
    type Receiver;
    /// Where the taps lie around it.
    type Kernel;

    /// A range that holds every depth that taps of the kernel can meet.
    fn range(&self, receiver: &Self::Receiver, kernel: &Self::Kernel) -> DepthRange;

    /// What every tap of the kernel over texels of such depths must say, if that may be told.
    fn verdict(&self, receiver: &Self::Receiver, kernel: &Self::Kernel, range: DepthRange) -> Verdict;

    /// Where taps are counted.
    fn counter(&self) -> &TapCounter;

    /// Calls `f` with which of eight taps are blocked, and by what: the larger, the nearer to the light.
    fn for_each_tap<S: Simd>(
        &self,
        simd: S,
        disc: &Disc,
        receiver: &Self::Receiver,
        kernel: &Self::Kernel,
        f: impl FnMut(mask32x8<S>, f32x8<S>),
    );
}

/// A light that is no point, over its maps. Heights tell how far a blocker is above a receiver, in a
/// measure of the light's own.
pub(super) trait Light {
    /// Its maps.
    type Maps: Taps;

    /// Its maps.
    fn maps(&self) -> &Self::Maps;

    /// The height that no caster exceeds.
    fn highest(&self, receiver: &Receiver<Self>) -> f32;

    /// The height that nothing in the kernel exceeds, for texels of such depths.
    fn height_within(&self, receiver: &Receiver<Self>, kernel: &Kernel<Self>, range: DepthRange) -> f32;

    /// The height of what [`Taps::for_each_tap`] tells of.
    fn height(&self, receiver: &Receiver<Self>, blocker: f32) -> f32;

    /// The light's disc as seen from the receiver, at a blocker of such a height.
    fn kernel(&self, receiver: &Receiver<Self>, height: f32) -> Kernel<Self>;

    /// Where blockers are looked for, if that does not follow from their height.
    fn fixed_search(&self, receiver: &Receiver<Self>) -> Option<Kernel<Self>>;
}

type Receiver<L> = <<L as Light>::Maps as Taps>::Receiver;
type Kernel<L> = <<L as Light>::Maps as Taps>::Kernel;

/// How often the search for blockers is narrowed to what the nearest caster below it demands.
const NARROWINGS: usize = 3;

/// The part of the kernel's taps that is lit: exactly 1 if all are, exactly 0 if none is.
#[inline(always)]
pub(super) fn filtered<S: Simd, M: Taps>(
    simd: S,
    maps: &M,
    disc: &Disc,
    receiver: &M::Receiver,
    kernel: &M::Kernel,
) -> f32 {
    let decided = match maps.verdict(receiver, kernel, maps.range(receiver, kernel)) {
        Verdict::Lit => 1.0,
        Verdict::Dark => 0.0,
        Verdict::Mixed => return lit_part(simd, maps, disc, receiver, kernel),
    };
    maps.counter().spare(disc);
    decided
}

/// The same from the taps alone.
#[inline(always)]
pub(super) fn lit_part<S: Simd, M: Taps>(
    simd: S,
    maps: &M,
    disc: &Disc,
    receiver: &M::Receiver,
    kernel: &M::Kernel,
) -> f32 {
    let mut count = 0;
    let tap = always(
        #[inline(always)]
        |blocked: mask32x8<S>, _| count += blocked.to_bitmask().count_ones(),
    );
    maps.counter().make(disc);
    maps.for_each_tap(simd, disc, receiver, kernel, tap);
    (disc.count() - float(count)) / disc.count()
}

/// Soft shadow: as wide as the blockers above the receiver make it.
///
/// Source: R. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH 2005 sketches; the search narrowed by
/// the pyramid.
#[inline(always)]
pub(super) fn soft<S: Simd, L: Light>(
    simd: S,
    light: &L,
    search: &Disc,
    filter: &Disc,
    receiver: &Receiver<L>,
) -> f32 {
    let maps = light.maps();
    let (kernel, highest) = match light.fixed_search(receiver) {
        Some(kernel) => match maps.verdict(receiver, &kernel, maps.range(receiver, &kernel)) {
            Verdict::Lit => {
                maps.counter().spare(search);
                return 1.0;
            }
            Verdict::Dark | Verdict::Mixed => (kernel, f32::INFINITY),
        },
        None => {
            let mut highest = light.highest(receiver);
            let mut kernel = light.kernel(receiver, highest);
            for _ in 0..NARROWINGS {
                let range = maps.range(receiver, &kernel);
                match maps.verdict(receiver, &kernel, range) {
                    Verdict::Lit => {
                        maps.counter().spare(search);
                        return 1.0;
                    }
                    // The filter would lie within the search.
                    Verdict::Dark => {
                        maps.counter().spare(search);
                        maps.counter().spare(filter);
                        return 0.0;
                    }
                    Verdict::Mixed => {}
                }
                let height = light.height_within(receiver, &kernel, range);
                if height >= highest {
                    break;
                }
                highest = height;
                kernel = light.kernel(receiver, highest);
            }
            (kernel, highest)
        }
    };
    let Some(mean) = mean_blocker(simd, maps, search, receiver, &kernel) else { return 1.0 };
    // A mean is no higher than the highest, but for its rounding.
    let height = light.height(receiver, mean);
    let height = if height > highest { highest } else { height };
    filtered(simd, maps, filter, receiver, &light.kernel(receiver, height))
}

/// Mean of what the kernel's taps find before the receiver.
#[inline(always)]
pub(super) fn mean_blocker<S: Simd, M: Taps>(
    simd: S,
    maps: &M,
    disc: &Disc,
    receiver: &M::Receiver,
    kernel: &M::Kernel,
) -> Option<f32> {
    let zero = f32x8::splat(simd, 0.0);
    let (mut sum, mut count) = (zero, 0);
    let tap = always(
        #[inline(always)]
        |blocked: mask32x8<S>, blocker: f32x8<S>| {
            sum += blocked.select(blocker, zero);
            count += blocked.to_bitmask().count_ones();
        },
    );
    maps.counter().make(disc);
    maps.for_each_tap(simd, disc, receiver, kernel, tap);
    (count > 0).then(|| sum_of_lanes(sum) / float(count))
}

/// The sum of eight lanes, in a fixed order.
#[inline(always)]
fn sum_of_lanes<S: Simd>(v: f32x8<S>) -> f32 {
    ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]))
}
