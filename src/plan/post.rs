//! The chain of effects: what a document's `post` asks for, settled into passes.
//!
//! An effect that would change nothing is left out. Pointwise effects in a row are steps of one pass:
//! those before the first effect that looks at its neighbours run in the tiles, so that a chain without
//! any such effect needs no picture in linear light at all.

mod neighbourhood;
mod weights;

pub use neighbourhood::{Bloom, Fxaa, Neighbourhood, Sharpen};
pub use weights::{Gaussian, Kernel, KernelRow};

use super::{Elision, Elisions, LeftOut, Part, Reason};
use crate::math::round_to_f32;
use crate::scene::document::{PostEffect, TonemapOperator};

/// The effects of a frame, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PostChain {
    /// Run in each tile, before anything else.
    pub in_tiles: Vec<Pointwise>,
    /// Each looks at the whole picture that the one before it left.
    pub passes: Vec<PostPass>,
    /// Steps that are taken on the way of another pass, and have none of their own.
    pub fused: usize,
}

/// One pass over the picture, and what happens to its result.
#[derive(Clone, Debug, PartialEq)]
pub struct PostPass {
    /// The pass; `None`: nothing, so that `then` has a pass of its own.
    pub effect: Option<Neighbourhood>,
    /// On its result; after the last pass on the way to bytes.
    pub then: Vec<Pointwise>,
}

/// An effect that needs one pixel's colour and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pointwise {
    /// A factor: the tone mapper without a curve.
    Expose(f32),
    /// A curve from radiance to 0–1.
    Tonemap {
        /// Which.
        curve: Curve,
        /// Multiplies before the curve.
        exposure: f32,
    },
    /// Towards luminance, 0–1.
    Grayscale(f32),
    /// Darker away from the centre.
    Vignette {
        /// Where nothing changes, in pixels from the picture's upper left corner.
        centre: [f32; 2],
        /// What the factor loses per square pixel of distance.
        falloff: f32,
    },
    /// Rows of red, green, blue, and what is added.
    ColorMatrix([[f32; 4]; 3]),
}

/// A tone mapper's curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015.
    Aces,
    /// x / (1 + x)
    Reinhard,
}

impl Pointwise {
    /// Whether it is another for every pixel.
    #[must_use]
    pub fn needs_place(&self) -> bool {
        matches!(self, Self::Vignette { .. })
    }

    /// What a document calls the effect that it is made from.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Expose(_) | Self::Tonemap { .. } => "tonemap",
            Self::Grayscale(_) => "grayscale",
            Self::Vignette { .. } => "vignette",
            Self::ColorMatrix(_) => "color_matrix",
        }
    }
}

/// An effect, settled.
enum Step {
    Pointwise(Pointwise),
    Neighbourhood(Neighbourhood),
}

impl PostChain {
    /// Columns of a strip: rows of a plane are filled up to whole strips, so that kernels need no tail.
    pub const STRIP: usize = 32;

    /// Settles `effects` for a picture of `width × height` pixels.
    #[must_use]
    pub fn new(effects: &[PostEffect], width: u32, height: u32) -> Self {
        Self::settle(effects, [width, height], 1.0, Elisions::ALL, &mut Vec::new())
    }

    /// The same without what `elide` leaves out, with a note in `left_out` of each effect that changes
    /// nothing. A pixel of a document is `scale` pixels of the picture.
    pub(super) fn settle(
        effects: &[PostEffect],
        size: [u32; 2],
        scale: f64,
        elide: Elisions,
        left_out: &mut Vec<LeftOut>,
    ) -> Self {
        let mut chain = Self::default();
        for (index, effect) in effects.iter().enumerate() {
            match neutral(effect, scale).filter(|_| elide.contains(Elision::NeutralEffects)) {
                Some(reason) => left_out.push(LeftOut { part: Part::Effect(index), reason }),
                None => chain.push(step(effect, size, scale), elide),
            }
        }
        if chain.passes.last().is_some_and(|pass| pass.effect.is_none()) {
            // The steps before it stay apart from the pass that writes bytes.
            chain.passes.push(PostPass { effect: None, then: Vec::new() });
        }
        chain
    }

    fn push(&mut self, step: Step, elide: Elisions) {
        match (step, self.passes.last_mut()) {
            (Step::Neighbourhood(effect), _) => {
                self.passes.push(PostPass { effect: Some(effect), then: Vec::new() });
            }
            (Step::Pointwise(step), _) if !elide.contains(Elision::PointwisePasses) => {
                self.passes.push(PostPass { effect: None, then: vec![step] });
            }
            (Step::Pointwise(step), before) => {
                before.map_or(&mut self.in_tiles, |pass| &mut pass.then).push(step);
                self.fused += 1;
            }
        }
    }

    /// How many effects it has, and how many passes over the whole picture they take.
    pub(super) fn work(&self) -> (usize, usize) {
        let neighbourhoods = self.passes.iter().filter(|pass| pass.effect.is_some()).count();
        let alone = self.passes.iter().filter(|pass| pass.effect.is_none() && !pass.then.is_empty()).count();
        (neighbourhoods + alone + self.fused, neighbourhoods + alone)
    }

    /// What is left to do after the last pass; nothing if there is none.
    #[must_use]
    pub fn last_steps(&self) -> &[Pointwise] {
        self.passes.last().map_or(&[], |pass| &pass.then)
    }

    /// Samples from one row of a plane to the next: whole strips, and never so many that one column's
    /// samples all fall into the same few lines of a cache.
    #[must_use]
    pub fn stride(width: u32) -> usize {
        let stride = (width as usize).next_multiple_of(Self::STRIP);
        if stride.is_multiple_of(512) { stride + Self::STRIP } else { stride }
    }

    /// Planes beside those of the picture that the passes work in.
    #[must_use]
    pub fn spare_planes(&self) -> usize {
        self.passes
            .iter()
            .filter_map(|pass| pass.effect.as_ref())
            .map(Neighbourhood::spare_planes)
            .max()
            .unwrap_or(0)
    }

    /// Working memory of the passes: planes of f32 for red, green, blue, alpha if there is one, and
    /// the spare ones.
    #[must_use]
    pub fn frame_bytes(&self, width: u32, height: u32, transparent: bool) -> u64 {
        if self.passes.is_empty() {
            return 0;
        }
        let planes = 3 + usize::from(transparent) + self.spare_planes();
        planes as u64 * Self::stride(width) as u64 * u64::from(height) * 4
    }
}

/// Why an effect would change nothing; `None`: it would.
fn neutral(effect: &PostEffect, scale: f64) -> Option<Reason> {
    match effect {
        PostEffect::Tonemap { operator: TonemapOperator::None, exposure: 1.0 } => Some(Reason::NoCurve),
        PostEffect::Grayscale { amount: 0.0 }
        | PostEffect::Vignette { amount: 0.0 }
        | PostEffect::Sharpen { amount: 0.0 } => Some(Reason::NoAmount),
        PostEffect::ColorMatrix { matrix } if *matrix == IDENTITY => Some(Reason::Identity),
        PostEffect::Blur { radius } if Gaussian::new(radius * scale).is_none() => Some(Reason::TooSmall),
        PostEffect::Bloom { intensity: 0.0, .. } => Some(Reason::NoIntensity),
        PostEffect::Kernel { kernel } if Kernel::new(kernel).keeps_every_color() => Some(Reason::Identity),
        _ => None,
    }
}

/// An effect as a step.
fn step(effect: &PostEffect, size: [u32; 2], scale: f64) -> Step {
    match effect {
        PostEffect::Tonemap { operator, exposure } => Step::Pointwise(tonemap(*operator, factor(*exposure))),
        PostEffect::Grayscale { amount } => Step::Pointwise(Pointwise::Grayscale(round_to_f32(*amount))),
        PostEffect::Vignette { amount } => Step::Pointwise(vignette(*amount, size)),
        PostEffect::ColorMatrix { matrix } => {
            Step::Pointwise(Pointwise::ColorMatrix(matrix.map(|row| row.map(round_to_f32))))
        }
        PostEffect::Blur { radius } => Step::Neighbourhood(Neighbourhood::Blur(
            Gaussian::new(radius * scale).unwrap_or_else(Gaussian::of_one_pixel),
        )),
        PostEffect::Bloom { threshold, intensity, radius } => {
            Step::Neighbourhood(Neighbourhood::Bloom(Bloom {
                threshold: factor(*threshold),
                intensity: factor(*intensity),
                gaussian: Gaussian::new(radius * scale),
            }))
        }
        PostEffect::Sharpen { amount } => {
            Step::Neighbourhood(Neighbourhood::Sharpen(Sharpen { amount: factor(*amount) }))
        }
        PostEffect::Fxaa => Step::Neighbourhood(Neighbourhood::Fxaa(Fxaa)),
        PostEffect::Kernel { kernel } => Step::Neighbourhood(Neighbourhood::Kernel(Kernel::new(kernel))),
    }
}

const IDENTITY: [[f64; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// A number that may be larger than any f32, as the largest.
fn factor(number: f64) -> f32 {
    round_to_f32(number.min(f64::from(f32::MAX)))
}

fn tonemap(operator: TonemapOperator, exposure: f32) -> Pointwise {
    match operator {
        TonemapOperator::Aces => Pointwise::Tonemap { curve: Curve::Aces, exposure },
        TonemapOperator::Reinhard => Pointwise::Tonemap { curve: Curve::Reinhard, exposure },
        TonemapOperator::None => Pointwise::Expose(exposure),
    }
}

/// The factor `1 − amount · (d / D)²`, d the distance from the centre, D that of a corner.
fn vignette(amount: f64, size: [u32; 2]) -> Pointwise {
    let [x, y] = size.map(|n| f64::from(n) / 2.0);
    Pointwise::Vignette {
        centre: [round_to_f32(x), round_to_f32(y)],
        falloff: round_to_f32(amount / (x * x + y * y)),
    }
}

#[cfg(test)]
mod tests;
