//! One record a visible triangle of a program: what interpolation reads.

use super::{Instance, Program, VARYINGS};
use crate::math::round_to_f32;
use crate::pipeline::geometry::setup::{NOT_CLIPPED, Triangle};
use crate::pipeline::shader::Visible;

// The f64 part of a record: corner 0; steps of the edge functions of corners 1 and 2, which vanish
// there; twice the area; the factor of each edge function that makes it a perspective weight.
pub(super) const ORIGIN: usize = 0;
pub(super) const EDGES: usize = 2;
pub(super) const AREA: usize = 6;
pub(super) const SCALE: usize = 7;
pub(super) const DOUBLES: usize = 10;

/// Records of the visible triangles of one run.
pub(super) struct Records {
    pub(super) varyings: usize,
    pub(super) differentiated: usize,
    /// [`DOUBLES`] a record.
    pub(super) doubles: Vec<f64>,
    /// Varyings of the three corners, then three numbers for each differentiated one.
    pub(super) singles: Vec<f32>,
    back: Vec<bool>,
}

/// A corner of a triangle as the program's vertex part gave it.
#[derive(Clone, Copy)]
struct Corner {
    w: f64,
    varyings: [f32; VARYINGS],
}

impl Records {
    /// No records yet.
    pub(super) fn new(program: &dyn Program) -> Self {
        Self {
            varyings: program.varyings(),
            differentiated: program.differentiated(),
            doubles: Vec::new(),
            singles: Vec::new(),
            back: Vec::new(),
        }
    }

    /// Whether the triangle of a record shows its back.
    pub(super) fn is_back(&self, record: u32) -> bool {
        self.back[record as usize]
    }

    /// Floats of one record.
    pub(super) fn singles_a_record(&self) -> usize {
        3 * (self.varyings + self.differentiated)
    }

    /// Adds the record of a triangle.
    pub(super) fn push(&mut self, of: &Instance, (chunk, t): Visible) {
        let source = of.triangles[t.source as usize].map(|vertex| self.corner(of, vertex));
        let corners = match t.clipped {
            NOT_CLIPPED => t.corners().map(|corner| source[corner]),
            piece => t.corners().map(|corner| mix(&source, chunk.clipped[piece as usize][corner])),
        };
        let [e1, e2] = t.edges_from_corner_0();
        let origin = [f64::from(t.x[0]), f64::from(t.y[0])];
        let area = t.doubled_area();
        let scale = perspective_scale(corners.map(|corner| corner.w), area);
        self.doubles.extend(origin.iter().chain(&e1).chain(&e2).chain([&area]).chain(&scale));
        for corner in &corners {
            self.singles.extend(&corner.varyings[..self.varyings]);
        }
        for i in 0..self.differentiated {
            let value = corners.map(|corner| f64::from(corner.varyings[i]));
            self.singles.extend(derivative_numerators(t, scale, value).map(round_to_f32));
        }
        self.back.push(t.is_back());
    }

    fn corner(&self, of: &Instance, vertex: u32) -> Corner {
        let mut varyings = [0.0; VARYINGS];
        let [.., w] = of.program.vertex(vertex, of.instance, &mut varyings[..self.varyings]);
        Corner { w, varyings }
    }
}

/// The weighted mean of a source triangle's corners: a corner of a clipped piece.
fn mix(corners: &[Corner; 3], weights: [f64; 3]) -> Corner {
    let mean = |value: &dyn Fn(&Corner) -> f64| {
        value(&corners[0]) * weights[0] + value(&corners[1]) * weights[1] + value(&corners[2]) * weights[2]
    };
    Corner {
        w: mean(&|corner| corner.w),
        varyings: std::array::from_fn(|i| round_to_f32(mean(&|corner| f64::from(corner.varyings[i])))),
    }
}

/// The factors kᵢ of the edge functions: `lᵢ = kᵢ Eᵢ` is in 0–1 and proportional to the perspective
/// weight of corner i.
pub(in crate::pipeline) fn perspective_scale(w: [f64; 3], area: f64) -> [f64; 3] {
    let nearest = w[0].min(w[1]).min(w[2]);
    w.map(|w| nearest / w / area)
}

/// What the screen derivatives of an interpolated value are made of, in units per pixel.
///
/// With U = Σ lᵢuᵢ and D = Σ lᵢ linear over the screen, `∂(U/D)/∂x = (Uₓ D − U Dₓ) / D²`, whose
/// numerator is linear in y alone (and that of ∂/∂y in x alone): its value at corner 0 for x and for
/// y, and how it changes.
pub(in crate::pipeline) fn derivative_numerators(t: &Triangle, scale: [f64; 3], value: [f64; 3]) -> [f64; 3] {
    let [e1, e2] = t.edges_from_corner_0();
    let edges = [[0.0 - e1[0] - e2[0], 0.0 - e1[1] - e2[1]], e1, e2];
    let slope =
        |value: [f64; 3], axis: usize| (0..3).map(|i| edges[i][axis] * scale[i] * value[i]).sum::<f64>();
    let at_0 = t.doubled_area() * scale[0];
    let d = [slope([1.0; 3], 0), slope([1.0; 3], 1)];
    let g = [slope(value, 0), slope(value, 1)];
    let along = |axis: usize| (g[axis] - value[0] * d[axis]) * at_0;
    [along(0), along(1), g[0] * d[1] - g[1] * d[0]].map(|n| n * 256.0)
}
