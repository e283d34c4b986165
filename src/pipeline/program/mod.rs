//! Programs: shaders in their usual form, a vertex part with varyings and a pixel part.
//!
//! [`Program`] is what a user of the library writes. Here it becomes the [`VertexShader`] and the
//! [`PixelShader`] that the stages know: positions are asked for every vertex; varyings only for the
//! corners of triangles that are seen, and interpolated for their fragments a block at a time.

mod interpolate;
mod records;

use super::shade::{BLOCK, Fragment, Scratch};
use super::shader::{ClipBlock, Outputs, PixelShader, Shading, VertexShader, Visible};
use crate::math::simd::Level;
use records::Records;
use std::ops::Range;

/// The most floats of varyings that a program can have.
pub const VARYINGS: usize = 36;

/// A vertex part and a pixel part.
pub trait Program: Sync {
    /// How many floats of varyings a vertex has, at most [`VARYINGS`].
    fn varyings(&self) -> usize;

    /// How many of them, from the first, come with their screen derivatives: texture coordinates.
    fn differentiated(&self) -> usize {
        0
    }

    /// Whether [`Program::pixels`] may discard fragments. What is discarded hides nothing, so the
    /// triangles of such a program are shaded one by one.
    fn discards(&self) -> bool {
        false
    }

    /// The vertex part: fills `varyings` and returns the position in clip space (x, y, z, w), see
    /// [`ClipBlock`]. It must give the same bits whenever it is asked.
    fn vertex(&self, vertex: u32, instance: u32, varyings: &mut [f32]) -> [f64; 4];

    /// The pixel part: colours of a block of fragments, target by target. A target that it leaves alone
    /// gets transparent black.
    ///
    /// Lanes from `block.len()` on hold copies of the last fragment; what is written there is not read.
    fn pixels(&self, level: Level, block: &Block, out: &mut Outputs);
}

/// Up to [`BLOCK`] fragments as a pixel part sees them.
pub struct Block<'a> {
    /// Where they are: their shading points on the screen.
    pub fragments: &'a [Fragment],
    /// Interpolated varyings, perspective-correct.
    pub varyings: &'a [[f32; BLOCK]],
    /// ∂/∂x and ∂/∂y of the differentiated ones, per pixel, y down.
    pub derivatives: &'a [[[f32; BLOCK]; 2]],
    /// One bit for each fragment whose triangle shows its back, the first the lowest.
    pub back: u64,
    /// Which instance they belong to.
    pub instance: u32,
}

impl Block<'_> {
    /// How many fragments it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.fragments.len()
    }

    /// Whether it has none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.fragments.is_empty()
    }
}

/// One instance of a program's indexed triangles.
pub(super) struct Instance<'a> {
    pub(super) program: &'a dyn Program,
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) instance: u32,
}

impl VertexShader for Instance<'_> {
    fn positions(&self, _: Level, vertices: Range<u32>, out: &mut ClipBlock) {
        let mut varyings = [0.0; VARYINGS];
        let varyings = &mut varyings[..self.program.varyings()];
        for (index, vertex) in vertices.enumerate() {
            out.set_position(index, self.program.vertex(vertex, self.instance, varyings));
        }
    }
}

impl PixelShader for Instance<'_> {
    fn open<'a>(&'a self, triangles: &mut dyn Iterator<Item = Visible<'a>>) -> Box<dyn Shading + 'a> {
        let mut records = Records::new(self.program);
        triangles.for_each(|visible| records.push(self, visible));
        let values = vec![[0.0; BLOCK]; self.program.varyings()];
        let derivatives = vec![[[0.0; BLOCK]; 2]; self.program.differentiated()];
        Box::new(Run { of: self, records, values, derivatives })
    }
}

/// The fragments of one instance in one tile.
struct Run<'a> {
    of: &'a Instance<'a>,
    records: Records,
    values: Vec<[f32; BLOCK]>,
    derivatives: Vec<[[f32; BLOCK]; 2]>,
}

impl Shading for Run<'_> {
    fn shade(&mut self, level: Level, fragments: &[Fragment], _: &mut Scratch, out: &mut Outputs) {
        interpolate::interpolate(level, &self.records, fragments, &mut self.values, &mut self.derivatives);
        let back = fragments.iter().enumerate();
        let back = back.fold(0, |bits, (i, f)| bits | u64::from(self.records.is_back(f.record)) << i);
        // What the pixel part leaves alone is black, whatever the block before it left.
        *out = Outputs::default();
        let block = Block {
            fragments,
            varyings: &self.values,
            derivatives: &self.derivatives,
            back,
            instance: self.of.instance,
        };
        self.of.program.pixels(level, &block, out);
    }
}
