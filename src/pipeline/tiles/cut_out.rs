//! Cut-outs: triangles of which an alpha test decides, pixel by pixel, whether they are there.

use super::cover::{BlockDepths, Visibility};
use super::layers::{AtEqualDepth, Layer, Layers, MOST_SAMPLES, Opaque, TileList, Window};
use crate::math::View;
use crate::pipeline::shade::varyings::Source;
use crate::pipeline::shade::{self, HoleShader};
use crate::pipeline::work::Work;
use crate::plan::ItemTest;
use glam::DVec3;

/// Draws the triangles `ids` into `samples`, in which everything opaque is drawn already. `test` says
/// what decides on those of a draw.
///
/// The test is made once a triangle and pixel, at its shading point, and holds for all samples that the
/// triangle covers there. Stops early when the frame is cancelled.
#[expect(clippy::too_many_arguments, reason = "a tile, its triangles, what they look like, and buffers")]
pub fn draw<'a>(
    work: &Work,
    tile: &TileList,
    ids: &[u32],
    test: impl Fn(u32) -> ItemTest<'a>,
    view: &View,
    samples: &mut Visibility,
    blocks: &BlockDepths,
    layers: &mut Layers,
    scratch: &mut shade::Scratch,
) {
    let shader = |draw| {
        let ItemTest { item, test } = test(draw);
        let source = Source::new(item, &test.probe, &[], view, DVec3::ZERO);
        HoleShader { source, cutoff: test.cutoff }
    };
    let window = Window::whole(tile.region);
    let mut left = ids;
    while !left.is_empty() && work.check().is_ok() {
        // What a cut-out of before hides is not asked: so it does not matter where the list was cut.
        let opaque = Opaque { samples, blocks };
        let taken = layers.gather(work.level, tile, &opaque, AtEqualDepth::Every, window, left, MOST_SAMPLES);
        left = &left[taken..];
        layers.shade(work.level, tile, shader, scratch, |layers, block, out| {
            for (_, fragment) in (0..).zip(block).filter(|(i, _)| out.discarded >> i & 1 == 0) {
                let layer = &layers.list[fragment.target as usize];
                write(samples, layer, layers, tile.side * tile.side);
            }
        });
    }
}

/// Writes what a fragment wins: the nearer of two is seen, and of two at one depth the one submitted
/// first. A plane of samples is `plane` pixels.
fn write(samples: &mut Visibility, layer: &Layer, layers: &Layers, plane: usize) {
    for (s, depth) in layer.samples(layers) {
        let at = s * plane + usize::from(layer.pixel);
        let (old_depth, old_id) = (samples.depth[at], samples.id[at]);
        if depth > old_depth || (depth == old_depth && layer.id < old_id) {
            (samples.depth[at], samples.id[at]) = (depth, layer.id);
        }
    }
}
