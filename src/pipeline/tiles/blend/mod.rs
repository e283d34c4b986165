//! Blending: what lies behind blended triangles shows through them.
//!
//! In: a tile whose opaque surfaces and sky are shaded. The layers of its blended triangles that nothing
//! opaque hides are shaded once a pixel and triangle, and composited over it in linear light, far to
//! near sample by sample (`composite`). Where there are too many layers to hold at once, the tile is
//! cut into windows, down to single pixels.

mod composite;

use super::Shared;
use super::fragments::Fragments;
use super::layers::{AtEqualDepth, Layers, MOST_SAMPLES, Opaque, TileList, Window};
use crate::pipeline::shade;
use crate::pipeline::stats::{Clock, TileTimes};
use crate::pipeline::work::Work;
use crate::plan::{Tally, Unit};
use composite::{Over, Stacks};

/// Buffers of one worker, kept between tiles.
#[derive(Default)]
pub struct Scratch {
    layers: Layers,
    /// What each layer puts over what is behind it.
    over: Vec<Over>,
    stacks: Stacks,
}

impl Scratch {
    /// What the blocks of its layers cost and were spared since it was last asked.
    pub fn take_tally(&mut self) -> Tally {
        self.layers.take_tally()
    }
}

/// A tile before anything is blended over it.
pub struct Behind<'a> {
    /// What is opaque in it.
    pub opaque: Opaque<'a>,
    /// Its fragments.
    pub fragments: &'a Fragments,
    /// Its sky, where that is seen.
    pub sky: &'a [Vec<f32>; 3],
}

/// The colours of a tile, resolved; what is blended goes over them.
pub struct Canvas<'a> {
    /// A pixel's colour at its own place, then the colours of the fragments of shared pixels.
    pub colors: &'a mut [Vec<f32>; 3],
    /// Share of each pixel that surfaces cover; `None` before a background that covers the rest.
    pub coverage: Option<&'a mut [f32]>,
    /// How many fragments each pixel has; `None` where nobody asks.
    pub counts: Option<&'a mut [u32]>,
}

impl Canvas<'_> {
    /// Counts layers that were shaded.
    fn count(&mut self, layers: &Layers) {
        let Some(counts) = &mut self.counts else { return };
        layers.list.iter().for_each(|layer| counts[usize::from(layer.pixel)] += 1);
    }
}

/// Draws the blended triangles `ids` over a tile. Stops early when the frame is cancelled.
pub fn draw(
    work: &Work,
    shared: &Shared,
    tile: &TileList,
    ids: &[u32],
    behind: &Behind,
    canvas: &mut Canvas,
    scratch: (&mut Scratch, &mut shade::Scratch),
) -> TileTimes {
    let (scratch, shading) = scratch;
    scratch.stacks.begin(behind.fragments, tile.side);
    let mut blend = Blend { work, shared, tile, behind, scratch, shading, times: TileTimes::default() };
    blend.draw_window(Window::whole(tile.region), ids, canvas);
    blend.times
}

/// One tile under way.
struct Blend<'a> {
    work: &'a Work<'a>,
    shared: &'a Shared<'a>,
    tile: &'a TileList<'a>,
    behind: &'a Behind<'a>,
    scratch: &'a mut Scratch,
    shading: &'a mut shade::Scratch,
    times: TileTimes,
}

impl Blend<'_> {
    /// Draws the triangles `ids` in a window, or in its halves if they make too many layers. A tile is
    /// halved twelve times on the way to a pixel, of which every layer must be known at once.
    fn draw_window(&mut self, window: Window, ids: &[u32], canvas: &mut Canvas) {
        if self.work.check().is_err() {
            return;
        }
        let halves = window.halves();
        let most = if halves.is_some() { MOST_SAMPLES } else { usize::MAX };
        let mut clock = Clock::start();
        let (tile, opaque, later) = (self.tile, &self.behind.opaque, AtEqualDepth::Later);
        let taken = self.scratch.layers.gather(self.work.level, tile, opaque, later, window, ids, most);
        self.times.raster += clock.lap();
        if taken == ids.len() {
            self.shade();
            canvas.count(&self.scratch.layers);
            self.times.shade += clock.lap();
            self.composite(canvas);
            self.times.resolve += clock.lap();
            return;
        }
        for half in halves.into_iter().flatten() {
            let touches = |&&id: &&u32| half.touches(tile.triangle(id), tile.region);
            let ids: Vec<u32> = ids.iter().filter(touches).copied().collect();
            self.draw_window(half, &ids, canvas);
        }
    }

    /// Shades every layer that is listed.
    fn shade(&mut self) {
        let (level, shared) = (self.work.level, self.shared);
        let Scratch { layers, over, .. } = &mut *self.scratch;
        over.clear();
        self.times.tally.count(Unit::Fragments, layers.list.len() as u64);
        layers.shade(
            level,
            self.tile,
            |draw| shared.shader(draw),
            self.shading,
            |_, block, out| {
                let [red, green, blue, alpha] = &out.colors[0];
                over.extend((0..block.len()).map(|i| Over::new([red[i], green[i], blue[i]], alpha[i])));
            },
        );
    }

    fn composite(&mut self, canvas: &mut Canvas) {
        let Scratch { layers, over, stacks } = &mut *self.scratch;
        stacks.sort(layers, self.tile.side);
        stacks.composite(layers, over, self.behind, self.tile, canvas);
    }
}
