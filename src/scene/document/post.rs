//! The effects of `post`.

use super::reader::{Node, Object};
use super::words::Word;
use super::writer::{Fields, ToJson};
use serde_json::Value;

/// A step of post-processing; the API's "What the numbers mean" has the formulas.
#[derive(Clone, Debug, PartialEq)]
pub enum PostEffect {
    /// From radiance to 0–1.
    Tonemap {
        /// Which curve.
        operator: TonemapOperator,
        /// Multiplies before the curve, ≥ 0.
        exposure: f64,
    },
    /// Separable Gaussian.
    Blur {
        /// In pixels.
        radius: f64,
    },
    /// Towards luminance.
    Grayscale {
        /// 0–1.
        amount: f64,
    },
    /// Darker corners.
    Vignette {
        /// 0–1.
        amount: f64,
    },
    /// What is bright glows.
    Bloom {
        /// Radiance from which it glows.
        threshold: f64,
        /// How much of the glow is added.
        intensity: f64,
        /// In pixels.
        radius: f64,
    },
    /// Unsharp mask.
    Sharpen {
        /// ≥ 0.
        amount: f64,
    },
    /// Fast approximate anti-aliasing.
    Fxaa,
    /// Rows of a 3×4 matrix, the last column added.
    ColorMatrix {
        /// Red, green and blue out.
        matrix: [[f64; 4]; 3],
    },
    /// A correlation with an odd square of weights.
    Kernel {
        /// Rows from above to below.
        kernel: Vec<Vec<f64>>,
    },
}

/// Which curve a tone mapper follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TonemapOperator {
    /// Narkowicz 2015.
    Aces,
    /// x/(1+x)
    Reinhard,
    /// The identity.
    None,
}

impl Word for TonemapOperator {
    const WORDS: &'static [(&'static str, Self)] =
        &[("aces", Self::Aces), ("reinhard", Self::Reinhard), ("none", Self::None)];
}

const TYPES: [&str; 9] =
    ["tonemap", "blur", "grayscale", "vignette", "bloom", "sharpen", "fxaa", "color_matrix", "kernel"];

impl PostEffect {
    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let kind = o.required("type", |n| n.tag(&TYPES))?;
        let effect = Self::read_kind(kind, &mut o);
        o.finish();
        effect
    }

    fn read_kind(kind: &str, o: &mut Object) -> Option<Self> {
        Some(match kind {
            "tonemap" => Self::Tonemap {
                operator: o.or("operator", TonemapOperator::Aces, Node::one_of),
                exposure: o.or("exposure", 1.0, Node::not_negative),
            },
            "blur" => Self::Blur { radius: o.or("radius", 4.0, Node::not_negative) },
            "grayscale" => Self::Grayscale { amount: o.or("amount", 1.0, fraction) },
            "vignette" => Self::Vignette { amount: o.or("amount", 0.5, fraction) },
            "bloom" => Self::Bloom {
                threshold: o.or("threshold", 1.0, Node::not_negative),
                intensity: o.or("intensity", 0.2, Node::not_negative),
                radius: o.or("radius", 8.0, Node::not_negative),
            },
            "sharpen" => Self::Sharpen { amount: o.or("amount", 0.5, Node::not_negative) },
            "fxaa" => Self::Fxaa,
            "color_matrix" => Self::ColorMatrix { matrix: o.required("matrix", matrix)? },
            _ => Self::Kernel { kernel: o.required("kernel", kernel)? },
        })
    }
}

fn fraction(node: Node) -> Option<f64> {
    node.number_in(0.0, 1.0)
}

fn matrix(node: Node) -> Option<[[f64; 4]; 3]> {
    let rows = node.clone().items()?;
    if rows.len() != 3 {
        node.fault(format!("must have 3 rows of 4 numbers, has {}", rows.len()));
        return None;
    }
    let rows: Vec<_> = rows.into_iter().map(Node::vector::<4>).collect();
    rows.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
}

fn kernel(node: Node) -> Option<Vec<Vec<f64>>> {
    let rows = node.clone().items()?;
    let side = rows.len();
    if side.is_multiple_of(2) {
        node.fault(format!("must have an odd number of rows, has {side}"));
        return None;
    }
    let rows: Vec<_> = rows.into_iter().map(|row| kernel_row(row, side)).collect();
    rows.into_iter().collect()
}

fn kernel_row(node: Node, side: usize) -> Option<Vec<f64>> {
    let weights = node.clone().items()?;
    if weights.len() != side {
        node.fault(format!("must hold {side} weights, as there are rows, holds {}", weights.len()));
        return None;
    }
    let weights: Vec<_> = weights.into_iter().map(Node::coordinate).collect();
    weights.into_iter().collect()
}

impl PostEffect {
    /// What a document calls it.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Tonemap { .. } => "tonemap",
            Self::Blur { .. } => "blur",
            Self::Grayscale { .. } => "grayscale",
            Self::Vignette { .. } => "vignette",
            Self::Bloom { .. } => "bloom",
            Self::Sharpen { .. } => "sharpen",
            Self::Fxaa => "fxaa",
            Self::ColorMatrix { .. } => "color_matrix",
            Self::Kernel { .. } => "kernel",
        }
    }
}

impl ToJson for PostEffect {
    fn to_json(&self) -> Value {
        let fields = Fields::of_type(self.type_name());
        match self {
            Self::Tonemap { operator, exposure } => {
                fields.with_word("operator", *operator).with("exposure", exposure)
            }
            Self::Blur { radius } => fields.with("radius", radius),
            Self::Grayscale { amount } => fields.with("amount", amount),
            Self::Vignette { amount } => fields.with("amount", amount),
            Self::Bloom { threshold, intensity, radius } => {
                fields.with("threshold", threshold).with("intensity", intensity).with("radius", radius)
            }
            Self::Sharpen { amount } => fields.with("amount", amount),
            Self::Fxaa => fields,
            Self::ColorMatrix { matrix } => fields.with("matrix", matrix),
            Self::Kernel { kernel } => fields.with("kernel", kernel),
        }
        .finish()
    }
}
