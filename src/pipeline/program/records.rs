//! One record a visible triangle of a program: what interpolation reads.

use super::{Instance, Program, VARYINGS};
use crate::math::round_to_f32;
use crate::pipeline::geometry::setup::NOT_CLIPPED;
use crate::pipeline::shade::weights::{derivative_numerators, perspective_scale};
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
