//! What the pipeline draws into.

use super::{Stats, Timings};
use crate::plan::Plan;

/// A finished picture. Rows run top to bottom.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width × height` pixels.
    pub pixels: Pixels,
    /// What was done.
    pub stats: Stats,
    /// What it cost.
    pub timings: Timings,
    /// Distances that 0 and 65535 stand for in a depth picture.
    pub depth_range: Option<[f64; 2]>,
}

/// Pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// sRGB-encoded red, green, blue, and straight alpha.
    Rgba8 {
        /// The pixels.
        pixels: Vec<[u8; 4]>,
        /// Whether every alpha is 255.
        opaque: bool,
    },
    /// Linear red, green, blue, straight, each in 0–65504, and alpha.
    Rgba32F {
        /// The pixels.
        pixels: Vec<[f32; 4]>,
        /// Whether every alpha is 1.
        opaque: bool,
    },
    /// Plain numbers.
    Gray16(Vec<u16>),
}

impl Frame {
    pub(super) fn new(plan: &Plan, pixels: Pixels, stats: Stats, timings: Timings) -> Self {
        let [width, height] = plan.size;
        Self { width, height, pixels, stats, timings, depth_range: plan.depth_range }
    }
}
