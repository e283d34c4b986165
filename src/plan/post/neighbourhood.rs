//! Effects that look at the pixels around, and the planes that each of them works in: `pipeline` gives
//! it as many, and the plan counts them as memory.

use super::{Gaussian, Kernel};

/// An effect that looks at the pixels around.
#[derive(Clone, Debug, PartialEq)]
pub enum Neighbourhood {
    /// A Gaussian.
    Blur(Gaussian),
    /// Light around what is bright.
    Bloom(Bloom),
    /// An unsharp mask.
    Sharpen(Sharpen),
    /// Fast approximate anti-aliasing.
    Fxaa(Fxaa),
    /// A correlation.
    Kernel(Kernel),
}

impl Neighbourhood {
    /// What a document calls it.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Blur(_) => "blur",
            Self::Bloom(_) => "bloom",
            Self::Sharpen(_) => "sharpen",
            Self::Fxaa(_) => "fxaa",
            Self::Kernel(_) => "kernel",
        }
    }

    pub(super) fn spare_planes(&self) -> usize {
        match self {
            Self::Blur(_) => Gaussian::SPARE_PLANES,
            Self::Bloom(_) => Bloom::SPARE_PLANES,
            Self::Sharpen(_) => Sharpen::SPARE_PLANES,
            Self::Fxaa(_) => Fxaa::SPARE_PLANES,
            Self::Kernel(_) => Kernel::SPARE_PLANES,
        }
    }
}

impl Gaussian {
    /// The picture blurred along its rows.
    pub const SPARE_PLANES: usize = 1;
}

/// The blurred light of what is brighter than a threshold, added.
#[derive(Clone, Debug, PartialEq)]
pub struct Bloom {
    /// Luminance from which it glows.
    pub threshold: f32,
    /// How much of the glow is added.
    pub intensity: f32,
    /// How far it reaches; `None`: no farther than the pixel itself.
    pub gaussian: Option<Gaussian>,
}

impl Bloom {
    /// What glows, and that blurred along its rows.
    pub const SPARE_PLANES: usize = 2;
}

/// An unsharp mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sharpen {
    /// How much of the difference to the blurred picture is added.
    pub amount: f32,
}

impl Sharpen {
    /// The result.
    pub const SPARE_PLANES: usize = 1;
}

/// Fast approximate anti-aliasing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fxaa;

impl Fxaa {
    /// Brightness, later the result; and what each pixel shows of a neighbour.
    pub const SPARE_PLANES: usize = 2;
}

impl Kernel {
    /// The result.
    pub const SPARE_PLANES: usize = 1;
}
