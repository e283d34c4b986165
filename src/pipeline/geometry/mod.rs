//! Geometry: meshes in model space in, triangles in fixed-point screen space out, binned by tile.
//!
//! Every vertex is transformed once ([`mesh`], [`vertex`]), triangles are culled, clipped ([`clip`]), snapped
//! and set up ([`setup`]), and listed by the tiles they touch ([`bin`]). The same code serves the
//! camera and the lights.

pub mod bin;
pub mod clip;
pub mod mesh;
pub mod setup;
pub mod vertex;

use super::shader::VertexShader;
use super::work::{Cancelled, Work};
use crate::math::{View, Viewport};
use crate::model::Part;
use crate::plan::{Elisions, Item, Slot, Tally};
use bin::{Chunk, TileGrid};
use mesh::MeshVertices;

/// Triangles of one task: enough to hide the task's cost, few enough to share out.
const CHUNK_TRIANGLES: usize = 4096;

/// What became of the triangles that went in. Every one has exactly one fate, or was clipped into
/// any number of pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Triangles that went in.
    pub triangles: u64,
    /// Wholly outside one plane of the view volume.
    pub outside: u64,
    /// Facing the wrong way.
    pub culled: u64,
    /// No area after snapping, or a coordinate that is not a number.
    pub degenerate: u64,
    /// Touching no sample.
    pub no_sample: u64,
    /// Cut by the near plane, the far plane or the guard band.
    pub clipped: u64,
    /// Binned: what the tiles draw.
    pub drawn: u64,
    /// Those of them that are pieces of clipped ones.
    pub pieces: u64,
}

impl Counts {
    /// Adds another's counts.
    pub fn add(&mut self, o: &Self) {
        self.triangles += o.triangles;
        self.outside += o.outside;
        self.culled += o.culled;
        self.degenerate += o.degenerate;
        self.no_sample += o.no_sample;
        self.clipped += o.clipped;
        self.drawn += o.drawn;
        self.pieces += o.pieces;
    }

    /// The sum of all fates: as many as went in.
    #[must_use]
    pub fn fates(&self) -> u64 {
        let whole = self.drawn - self.pieces;
        self.outside + self.culled + self.degenerate + self.no_sample + self.clipped + whole
    }
}

/// Everything that the tiles need to draw.
#[derive(Debug)]
pub struct Bins {
    /// How the picture is cut into tiles.
    pub grid: TileGrid,
    /// In submission order.
    pub chunks: Vec<Chunk>,
    /// Sums over the chunks.
    pub counts: Counts,
    /// What it cost, and what it was spared.
    pub tally: Tally,
    /// What may be left out where they are drawn.
    pub elide: Elisions,
}

impl Bins {
    /// The triangles of `chunks`, and the sums of what they tell.
    #[must_use]
    pub fn new(grid: TileGrid, chunks: Vec<Chunk>, elide: Elisions) -> Self {
        let (mut counts, mut tally) = (Counts::default(), Tally::default());
        for chunk in &chunks {
            counts.add(&chunk.counts);
            tally.add(&chunk.tally);
        }
        Self { grid, chunks, counts, tally, elide }
    }

    /// Lists the triangles that may touch the tile at (column, row), in submission order.
    pub fn list(&self, place: [u32; 2], list: &mut Vec<(u32, u32)>) {
        list.clear();
        for (number, chunk) in (0..).zip(&self.chunks) {
            list.extend(chunk.tile(place[0], place[1]).iter().map(|&index| (number, index)));
        }
    }
}

/// Transforms, culls, clips, snaps, sets up and bins the triangles of `items`.
///
/// # Errors
/// [`Cancelled`].
pub fn run(
    items: &[Item],
    view: &View,
    grid: TileGrid,
    elide: Elisions,
    work: &Work,
) -> Result<Bins, Cancelled> {
    let vertices: Vec<MeshVertices> = items.iter().map(|item| MeshVertices::new(item, view)).collect();
    let primitives = items.iter().zip(&vertices).map(|(item, vertices)| Primitives {
        vertices,
        vertex_count: item.mesh.vertex_count(),
        triangles: &item.mesh.triangles,
        parts: &item.mesh.parts,
        slots: &item.slots,
        mirrored: item.mirrored,
    });
    draw(&primitives.collect::<Vec<_>>(), &view.viewport(), grid, elide, work)
}

/// Indexed triangles, and the vertex shader that places them.
pub struct Primitives<'a> {
    /// Where the vertices are.
    pub vertices: &'a dyn VertexShader,
    /// How many there are.
    pub vertex_count: usize,
    /// Three vertices each, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// Runs of triangles by slot, ascending; the first begins at 0.
    pub parts: &'a [Part],
    /// What becomes of the triangles of each slot; `None`: nothing.
    pub slots: &'a [Option<Slot>],
    /// Whether fronts run clockwise.
    pub mirrored: bool,
}

/// Runs vertex shaders, then culls, clips, snaps, sets up and bins their triangles.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(
    all: &[Primitives],
    viewport: &Viewport,
    grid: TileGrid,
    elide: Elisions,
    work: &Work,
) -> Result<Bins, Cancelled> {
    let vertices = vertex::transform(all, viewport, work)?;
    let tasks = all.iter().enumerate().flat_map(|(i, primitives)| {
        let count = primitives.triangles.len();
        (0..count).step_by(CHUNK_TRIANGLES).map(move |from| (i, from..count.min(from + CHUNK_TRIANGLES)))
    });
    let chunks = work.map(tasks.collect(), Vec::new, |pairs, (i, range)| {
        setup::process(&all[i], range, &vertices[i], viewport, &grid, elide, work.level, pairs)
    })?;
    Ok(Bins::new(grid, chunks, elide))
}
