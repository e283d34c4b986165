//! What a draw is programmed with: where its vertices go, and what its fragments look like.

use super::geometry::bin::Chunk;
use super::geometry::setup::Triangle;
use super::shade::{BLOCK, Fragment, Scratch};
use crate::math::simd::Level;
use std::ops::Range;

/// The most vertices that a vertex shader is asked for at once; a multiple of the kernels' lanes.
pub const VERTEX_BLOCK: usize = 128;

/// Clip-space positions of a block of vertices, component by component.
///
/// The view volume is −w ≤ x, y ≤ w and 0 ≤ z ≤ w, y up. The depth z / w is reversed: 1 at the near
/// plane, falling with distance; a z that is the near distance itself and a w that is the distance
/// along the axis make an infinite far plane. All in f64: nothing is rounded before it is snapped to
/// the screen's sub-pixels.
#[derive(Clone, Debug)]
pub struct ClipBlock {
    /// Right.
    pub x: [f64; VERTEX_BLOCK],
    /// Up.
    pub y: [f64; VERTEX_BLOCK],
    /// Depth times w.
    pub z: [f64; VERTEX_BLOCK],
    /// What the others are divided by.
    pub w: [f64; VERTEX_BLOCK],
}

impl ClipBlock {
    /// The position of one vertex of the block.
    #[must_use]
    pub fn position(&self, index: usize) -> [f64; 4] {
        [self.x[index], self.y[index], self.z[index], self.w[index]]
    }

    /// Sets the position of one vertex of the block.
    pub fn set_position(&mut self, index: usize, position: [f64; 4]) {
        [self.x[index], self.y[index], self.z[index], self.w[index]] = position;
    }
}

impl Default for ClipBlock {
    fn default() -> Self {
        let zero = [0.0; VERTEX_BLOCK];
        Self { x: zero, y: zero, z: zero, w: zero }
    }
}

/// The first half of a vertex shader: where the vertices are.
///
/// It is asked for every vertex once, and for the corners of triangles that are clipped again, so it
/// must give the same bits whenever it is asked.
pub trait VertexShader: Sync {
    /// Writes the positions of `vertices`, at most [`VERTEX_BLOCK`] of them, to the front of `out`;
    /// what lies behind them does not matter.
    fn positions(&self, level: Level, vertices: Range<u32>, out: &mut ClipBlock);
}

/// A triangle of which fragments are seen, and the chunk it is in.
pub type Visible<'a> = (&'a Chunk, &'a Triangle);

/// What fragments look like.
pub trait PixelShader: Sync {
    /// Begins a run of fragments: those of one draw in one tile. `triangles` are what their
    /// [`Fragment::record`]s count in.
    fn open<'a>(&'a self, triangles: &mut dyn Iterator<Item = Visible<'a>>) -> Box<dyn Shading + 'a>;
}

/// The shading of one run of fragments.
pub trait Shading {
    /// Shades up to [`BLOCK`] fragments; writes index i of `out` for fragment i. `scratch` is room to work
    /// in, of any content.
    fn shade(&mut self, level: Level, fragments: &[Fragment], scratch: &mut Scratch, out: &mut Outputs);
}

/// Colours of one render target for a block: red, green, blue, alpha.
pub type Colors = [[f32; BLOCK]; 4];

/// The most targets that a pixel shader can write.
pub const TARGETS: usize = 4;

/// What a pixel shader makes of a block.
#[derive(Clone, Debug)]
pub struct Outputs {
    /// For each target, colours in linear light.
    pub colors: [Colors; TARGETS],
    /// One bit for each fragment that is discarded, the first the lowest.
    pub discarded: u64,
}

impl Default for Outputs {
    fn default() -> Self {
        Self { colors: [[[0.0; BLOCK]; 4]; TARGETS], discarded: 0 }
    }
}
