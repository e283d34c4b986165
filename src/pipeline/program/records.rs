//! One record a visible triangle of a program: what interpolation reads.

use super::{Instance, Program, VARYINGS};
use crate::math::round_to_f32;
use crate::pipeline::geometry::setup::NOT_CLIPPED;
use crate::pipeline::shade::table::{self, Table};
use crate::pipeline::shader::Visible;

/// Records of the visible triangles of one run.
pub(super) struct Records {
    pub(super) varyings: usize,
    pub(super) differentiated: usize,
    /// Behind the head: varyings of the three corners, then the derivatives' numerators of each
    /// differentiated one.
    pub(super) table: Table,
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
        let (varyings, differentiated) = (program.varyings(), program.differentiated());
        let table = Table::new(table::HEAD, 3 * (varyings + differentiated));
        Self { varyings, differentiated, table, back: Vec::new() }
    }

    /// Whether the triangle of a record shows its back.
    pub(super) fn is_back(&self, record: u32) -> bool {
        self.back[record as usize]
    }

    /// Adds the record of a triangle.
    pub(super) fn push(&mut self, of: &Instance, (chunk, t): Visible) {
        let source = of.triangles[t.source as usize].map(|vertex| self.corner(of, vertex));
        let corners = match t.clipped {
            NOT_CLIPPED => t.corners().map(|corner| source[corner]),
            piece => t.corners().map(|corner| mix(&source, chunk.clipped[piece as usize][corner])),
        };
        let scale = self.table.begin(t, corners.map(|corner| corner.w));
        for corner in &corners {
            self.table.extend_singles(&corner.varyings[..self.varyings]);
        }
        for i in 0..self.differentiated {
            let value = corners.map(|corner| f64::from(corner.varyings[i]));
            self.table.extend_derivatives(t, scale, value);
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
