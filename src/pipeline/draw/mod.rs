//! Draw calls: programs and indexed triangles in, render targets out.
//!
//! What a scene's frame does in one go, call by call, for a program that has its own idea of a scene.
//! The stages are the same: [`geometry`], then tile by tile coverage, fragments,
//! pixel shader; one sample a pixel.

mod state;
mod targets;
mod tile;

pub use state::{Rect, State};
pub use targets::Targets;

use super::geometry::bin::TileGrid;
use super::geometry::{self, Primitives};
use super::program::{Instance, Program};
use super::work::{Cancelled, Work};
use super::{samples, tiles};
use crate::math::Viewport;
use crate::model::Part;
use crate::plan::{Elisions, Opacity, Slot};

/// Instances of indexed triangles.
pub struct DrawCall<'a> {
    /// Where the vertices go and what the fragments look like.
    pub program: &'a dyn Program,
    /// How many vertices an instance has.
    pub vertices: u32,
    /// Three vertices each, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// How many instances to draw; the vertex part is told which.
    pub instances: u32,
    /// What the id target shows for instance 0; the others count on.
    pub first_id: u32,
}

impl DrawCall<'_> {
    /// Draws to `targets`: a triangle may come after one that it hides, and equal depths are won by
    /// the first.
    ///
    /// # Errors
    /// [`Cancelled`]; the targets are then drawn in part.
    ///
    /// # Panics
    /// If an index is not below [`DrawCall::vertices`], the viewport is not within the targets, or the
    /// program has more than [`VARYINGS`](super::program::VARYINGS) varyings.
    pub fn draw(&self, targets: &mut Targets, state: &State, work: &Work) -> Result<(), Cancelled> {
        assert!(
            self.triangles.as_flattened().iter().all(|&vertex| vertex < self.vertices),
            "a vertex of its own"
        );
        let Rect { width, height, .. } = state.viewport;
        let viewport = Viewport { width, height, farthest: 0.0 };
        let grid = TileGrid::new(viewport, tiles::tile_shift(1), samples::pattern(1));
        let instances: Vec<Instance> = (0..self.instances).map(|instance| self.instance(instance)).collect();
        let slot = |draw| Some(Slot { draw, cull: state.cull, opacity: Opacity::Opaque });
        let slots: Vec<Option<Slot>> = (0..self.instances).map(slot).collect();
        let parts = [Part { first_triangle: 0, slot: 0 }];
        let primitives = instances.iter().zip(&slots).map(|(instance, slot)| Primitives {
            vertices: instance,
            vertex_count: self.vertices as usize,
            triangles: self.triangles,
            parts: &parts,
            slots: std::slice::from_ref(slot),
            mirrored: false,
        });
        let bins = geometry::draw(&primitives.collect::<Vec<_>>(), &viewport, grid, Elisions::ALL, work)?;
        let pass = tile::Pass { bins: &bins, state, instances: &instances, call: self };
        work.map(targets.split(&state.viewport, &grid), tile::Scratch::default, |scratch, tile| {
            pass.draw_tile(work.level, tile, scratch);
        })?;
        Ok(())
    }

    fn instance(&self, instance: u32) -> Instance<'_> {
        Instance { program: self.program, triangles: self.triangles, instance }
    }
}
