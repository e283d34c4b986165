//! The control points of the Utah teapot, 3.15 high on its bottom at y = 0.
//!
//! Its 32 patches are far from arbitrary: pot and lid are profiles turned around y, handle and
//! spout sections led along a curve and symmetric in z. So four short tables hold all 306 vertices.
//! Every third row is a border between patches.
//!
//! Source: M. Newell, "The Utilization of Procedure Models in Digital Image Synthesis", University
//! of Utah, 1975; numbers as in F. Crow, "The Origins of the Teapot", IEEE CG&A 7(1), 1987.

/// A circle around y as control points: its radius, how far the two inner control points of each
/// quarter lie along the tangent (0.56 of the radius, nearly a circle), and its height.
pub type Ring = [f64; 3];

/// Half a section of handle or spout: x and y where it starts, x and y where it ends, both at
/// z = 0, and how far the two inner control points beside them stand out in z.
pub type Section = [f64; 5];

/// From the middle of the bottom outwards, up the body and over the rim to its inner edge.
pub const POT: [Ring; 13] = [
    [0.0, 0.0, 0.0],
    [1.425, 0.798, 0.0],
    [1.5, 0.84, 0.075],
    [1.5, 0.84, 0.15],
    [1.5, 0.84, 0.225],
    [2.0, 1.12, 0.45],
    [2.0, 1.12, 0.9],
    [2.0, 1.12, 1.35],
    [1.75, 0.98, 1.875],
    [1.5, 0.84, 2.4],
    [1.4375, 0.805, 2.53125],
    [1.3375, 0.749, 2.53125],
    [1.4, 0.784, 2.4],
];

/// From the edge of the lid up to the neck of its knob and over that to the top.
pub const LID: [Ring; 7] = [
    [1.3, 0.728, 2.4],
    [1.3, 0.728, 2.55],
    [0.4, 0.224, 2.55],
    [0.2, 0.112, 2.7],
    [0.0, 0.0, 2.85],
    [0.8, 0.45, 3.15],
    [0.0, 0.0, 3.15],
];

/// From its upper to its lower end; sections start on the side of the pot.
pub const HANDLE: [Section; 7] = [
    [-1.6, 2.025, -1.5, 2.25, 0.3],
    [-2.3, 2.025, -2.5, 2.25, 0.3],
    [-2.7, 2.025, -3.0, 2.25, 0.3],
    [-2.7, 1.8, -3.0, 1.8, 0.3],
    [-2.7, 1.575, -3.0, 1.35, 0.3],
    [-2.5, 1.125, -2.65, 0.9375, 0.3],
    [-2.0, 0.9, -1.9, 0.6, 0.3],
];

/// From the pot to the lip and into the mouth; sections start above.
pub const SPOUT: [Section; 7] = [
    [1.7, 1.425, 1.7, 0.6, 0.66],
    [2.6, 1.425, 3.1, 0.825, 0.66],
    [2.3, 2.1, 2.4, 2.025, 0.25],
    [2.7, 2.4, 3.3, 2.4, 0.25],
    [2.8, 2.475, 3.525, 2.49375, 0.25],
    [2.9, 2.475, 3.45, 2.5125, 0.15],
    [2.8, 2.4, 3.2, 2.4, 0.15],
];

/// From the bottom to the top of the knob.
pub const HEIGHT: f64 = 3.15;
