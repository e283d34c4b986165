//! Compositing: the layers of each pixel over what is behind them, far to near sample by sample.

use super::{Behind, Canvas};
use crate::pipeline::resolve;
use crate::pipeline::tiles::fragments::{Fragments, SharedPixel};
use crate::pipeline::tiles::layers::{Layers, TileList};

/// Red, green and blue, premultiplied, and alpha.
type Rgba = [f32; 4];

/// What a layer puts over what is behind it.
///
/// Source: T. Porter, T. Duff, "Compositing Digital Images", SIGGRAPH 1984.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Over(Rgba);

impl Over {
    /// A layer of a colour with an alpha in 0–1.
    pub fn new([r, g, b]: [f32; 3], alpha: f32) -> Self {
        Self([r * alpha, g * alpha, b * alpha, alpha])
    }

    /// `src · α + dst · (1 − α)`: exactly the source at α = 1, exactly what is behind at 0.
    #[inline]
    fn composite(&self, behind: &mut Rgba) {
        let left = 1.0 - self.0[3];
        for (value, own) in behind.iter_mut().zip(self.0) {
            *value = own + *value * left;
        }
    }
}

/// The layers of each pixel.
#[derive(Debug, Default)]
pub struct Stacks {
    /// For each pixel, 1 + its place among those that several surfaces share; 0: one surface, or sky.
    shared: Vec<u32>,
    /// For each pixel, where its layers end in `order`; those of the next one begin there.
    ends: Vec<u32>,
    /// Places of layers, by pixel, in submission order within one.
    order: Vec<u32>,
    keys: Vec<u64>,
}

impl Stacks {
    /// Takes a new tile.
    pub fn begin(&mut self, fragments: &Fragments, side: usize) {
        self.shared.clear();
        self.shared.resize(side * side, 0);
        for (shared, number) in fragments.shared.iter().zip(1..) {
            self.shared[shared.pixel as usize] = number;
        }
    }

    /// Sorts layers by pixel: a counting sort, so they stay in order of submission.
    pub fn sort(&mut self, layers: &Layers, side: usize) {
        self.ends.clear();
        self.ends.resize(side * side, 0);
        for layer in &layers.list {
            self.ends[usize::from(layer.pixel)] += 1;
        }
        let mut next = 0;
        for end in &mut self.ends {
            // Where the pixel's first layer goes; the last one leaves it where the next pixel's begin.
            next += std::mem::replace(end, next);
        }
        self.order.clear();
        self.order.resize(layers.list.len(), 0);
        for (layer, at) in layers.list.iter().zip(0..) {
            let place = &mut self.ends[usize::from(layer.pixel)];
            self.order[*place as usize] = at;
            *place += 1;
        }
    }

    /// Composites every pixel's layers over its colours.
    pub fn composite(
        &mut self,
        layers: &Layers,
        over: &[Over],
        behind: &Behind,
        tile: &TileList,
        canvas: &mut Canvas,
    ) {
        let mut first = 0;
        for pixel in 0..self.ends.len() {
            let end = self.ends[pixel] as usize;
            if first < end {
                let stack = Stack { layers, over, order: &self.order[first..end] };
                let shared = self.shared[pixel].checked_sub(1).map(|at| behind.fragments.shared[at as usize]);
                stack.composite(pixel, shared, behind, tile, canvas, &mut self.keys);
            }
            first = end;
        }
    }
}

/// The layers of one pixel, in submission order.
struct Stack<'a> {
    layers: &'a Layers,
    over: &'a [Over],
    order: &'a [u32],
}

impl Stack<'_> {
    /// Composites them over the colours of their pixel.
    fn composite(
        &self,
        pixel: usize,
        shared: Option<SharedPixel>,
        behind: &Behind,
        tile: &TileList,
        canvas: &mut Canvas,
        keys: &mut Vec<u64>,
    ) {
        let samples = tile.order.pattern.len();
        self.sort(0, keys);
        let color = match shared {
            None if self.is_alike(samples, keys) => {
                // The mean of equal samples is that sample.
                let mut color = canvas.pixel(pixel);
                self.over(keys, &mut color);
                color
            }
            None => self.mean([canvas.pixel(pixel); 16], samples, keys),
            Some(shared) => self.mean(canvas.samples(&shared, behind, tile.side), samples, keys),
        };
        canvas.set(pixel, color);
    }

    /// The layers that a sample sees, farthest first; of two at one depth the one submitted first.
    ///
    /// A key is the bits of a depth (positive, so that they are in order of the depths) above the place
    /// in `order`.
    fn sort(&self, sample: usize, keys: &mut Vec<u64>) {
        keys.clear();
        for (&at, place) in self.order.iter().zip(0u64..) {
            let layer = &self.layers.list[at as usize];
            if layer.seen >> sample & 1 == 1 {
                keys.push(u64::from(layer.depth(self.layers, sample).to_bits()) << 32 | place);
            }
        }
        if keys.len() > 1 {
            keys.sort_unstable();
        }
    }

    /// Whether every sample sees every layer, and in the order that `keys` gives for the first one.
    fn is_alike(&self, samples: usize, keys: &[u64]) -> bool {
        let all = u16::MAX >> (16 - samples);
        let everywhere = self.order.iter().all(|&at| self.layers.list[at as usize].seen == all);
        let ordered = |sample: usize| {
            let key = |key: &u64| {
                let place = place(*key);
                (self.layer_depth(place, sample).to_bits(), place)
            };
            keys.is_sorted_by_key(key)
        };
        everywhere && (1..samples).all(ordered)
    }

    fn layer_depth(&self, place: usize, sample: usize) -> f32 {
        self.layers.list[self.order[place] as usize].depth(self.layers, sample)
    }

    /// Composites the layers of `keys` over one colour.
    fn over(&self, keys: &[u64], color: &mut Rgba) {
        for &key in keys {
            self.over[self.order[place(key)] as usize].composite(color);
        }
    }

    /// Composites each sample on its own, and resolves.
    fn mean(&self, mut colors: [Rgba; 16], samples: usize, keys: &mut Vec<u64>) -> Rgba {
        for (sample, color) in colors[..samples].iter_mut().enumerate() {
            self.sort(sample, keys);
            self.over(keys, color);
        }
        std::array::from_fn(|c| resolve::mean(&mut colors.map(|color| color[c])[..samples]))
    }
}

/// The place in the low half of a key.
#[expect(clippy::cast_possible_truncation, reason = "the low half alone is wanted")]
fn place(key: u64) -> usize {
    key as u32 as usize
}

impl Canvas<'_> {
    fn pixel(&self, pixel: usize) -> Rgba {
        let [r, g, b] = [0, 1, 2].map(|c| self.colors[c][pixel]);
        [r, g, b, self.coverage.as_ref().map_or(1.0, |coverage| coverage[pixel])]
    }

    /// The colour of each sample of a pixel that several surfaces share.
    fn samples(&self, shared: &SharedPixel, behind: &Behind, side: usize) -> [Rgba; 16] {
        let of =
            |channel: &[f32], uncovered: f32| resolve::values(behind.fragments, shared, channel, uncovered);
        let pixel = shared.pixel as usize;
        let [r, g, b] = [0, 1, 2].map(|c| of(&self.colors[c][side * side..], behind.sky[c][pixel]));
        let masks = &behind.fragments.masks[shared.first as usize..(shared.first + shared.count) as usize];
        let covered = masks.iter().fold(0, |all, mask| all | mask);
        std::array::from_fn(|s| [r[s], g[s], b[s], if covered >> s & 1 == 1 { 1.0 } else { 0.0 }])
    }

    fn set(&mut self, pixel: usize, color: Rgba) {
        for (channel, value) in self.colors.iter_mut().zip(color) {
            channel[pixel] = value;
        }
        if let Some(coverage) = &mut self.coverage {
            coverage[pixel] = color[3];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clear_layers_change_nothing_and_full_ones_leave_nothing() {
        let mut color = [0.1, 0.7, 65504.0, 0.3];
        Over::new([65504.0, 0.3, 1e-30], 0.0).composite(&mut color);
        assert_eq!(color, [0.1, 0.7, 65504.0, 0.3]);
        Over::new([0.2, 65504.0, 1e-30], 1.0).composite(&mut color);
        assert_eq!(color, [0.2, 65504.0, 1e-30, 1.0]);
    }
}
