//! From samples to fragments: each triangle once a pixel, sorted by draw and triangle.

use super::cover::{Region, Visibility};
use crate::math::simd::*;
use crate::pipeline::geometry::Bins;
use crate::pipeline::geometry::bin::Chunk;
use crate::pipeline::geometry::setup::Triangle;
use crate::pipeline::shade::Fragment;
use crate::plan::{Elision, Tally, Unit};

/// A triangle of the tile's list: its chunk and its place there.
pub type Entry = (u32, u32);

/// What a tile's pixels are made of.
#[derive(Debug, Default)]
pub struct Fragments {
    /// Sorted by draw, then by triangle.
    pub sorted: Vec<Fragment>,
    /// Runs of fragments of one draw.
    pub runs: Vec<Run>,
    /// Ids of the visible triangles, by draw, ascending within one: the records of each run.
    pub visible: Vec<u32>,
    /// Pixels of which the background can be seen.
    pub sky: Vec<u32>,
    /// Pixels that more than one surface share.
    pub shared: Vec<SharedPixel>,
    /// Samples of each fragment of a shared pixel, one bit each.
    pub masks: Vec<u16>,
    /// Colours that shading will write: a pixel's own place, or one beyond the pixels for each
    /// fragment of a shared one.
    pub targets: usize,
    unsorted: Vec<Unsorted>,
    counts: Vec<u32>,
}

/// Fragments of one draw.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Index into the plan's draws.
    pub draw: u32,
    /// Its first record in [`Fragments::visible`] and its first fragment in [`Fragments::sorted`].
    pub first: [usize; 2],
    /// One past its last.
    pub end: [usize; 2],
}

/// A pixel that more than one surface share.
#[derive(Clone, Copy, Debug)]
pub struct SharedPixel {
    /// Its place in the tile, `y · side + x`.
    pub pixel: u32,
    /// Its first fragment in [`Fragments::masks`].
    pub first: u32,
    /// How many it has.
    pub count: u32,
}

#[derive(Clone, Copy, Debug)]
struct Unsorted {
    id: u32,
    target: u32,
    x: i32,
    y: i32,
}

/// How the samples of a pixel are looked at.
pub struct SampleOrder<'a> {
    /// Where they lie.
    pub pattern: &'a [[i32; 2]],
    /// From the nearest to the pixel's centre to the farthest.
    pub nearest: &'a [usize],
}

impl Fragments {
    /// Reads a tile's samples.
    #[expect(clippy::too_many_arguments, reason = "the whole of a tile, and the kernels' instruction set")]
    pub fn collect(
        &mut self,
        level: Level,
        samples: &Visibility,
        region: &Region,
        side: usize,
        order: &SampleOrder,
        list: &[Entry],
        bins: &Bins,
    ) {
        self.clear();
        self.targets = side * side;
        let spares_means = bins.elide.contains(Elision::UniformPixels);
        for y in 0..region.size[1] {
            let alone = if spares_means { samples.alone(level, y, side, order.pattern.len()) } else { 0 };
            for x in 0..region.size[0] {
                let pixel = y * side + x;
                let [number, right, down] =
                    [pixel, x * 256, y * 256].map(|n| i32::try_from(n).expect("a tile is small"));
                let corner = [region.origin[0] + right, region.origin[1] + down];
                let id = samples.id[pixel];
                if alone >> x & 1 == 0 {
                    self.share(samples, number.cast_unsigned(), side, corner, order, list, bins);
                } else if id == 0 {
                    self.sky.push(number.cast_unsigned());
                } else {
                    let (x, y) = (corner[0] + 128, corner[1] + 128);
                    self.unsorted.push(Unsorted { id, target: number.cast_unsigned(), x, y });
                }
            }
        }
        self.sort(list, bins);
    }

    /// How many there are of each pixel of a tile of `side` pixels a row.
    #[must_use]
    pub fn counts(&self, side: usize) -> Vec<u32> {
        let mut counts = vec![0; side * side];
        for fragment in &self.sorted {
            // What is written beyond the pixels belongs to shared ones.
            if let Some(count) = counts.get_mut(fragment.target as usize) {
                *count += 1;
            }
        }
        for shared in &self.shared {
            counts[shared.pixel as usize] += shared.count;
        }
        counts
    }

    /// What they are to be, and what the pixels that are alone are spared.
    #[must_use]
    pub fn tally(&self, region: &Region) -> Tally {
        let mut tally = Tally::default();
        let is_covered = |shared: &&SharedPixel| shared.count > 0;
        let covered = self.shared.iter().filter(is_covered).count();
        let alone = self.sorted.len() - self.masks.len();
        tally.count(Unit::Fragments, self.sorted.len() as u64);
        tally.count(Unit::CoveredPixels, (alone + covered) as u64);
        tally.count(Unit::Means, self.shared.len() as u64);
        tally.spare(Elision::UniformPixels, (region.area() - self.shared.len()) as u64);
        tally
    }

    fn clear(&mut self) {
        self.sorted.clear();
        self.runs.clear();
        self.visible.clear();
        self.sky.clear();
        self.shared.clear();
        self.masks.clear();
        self.unsorted.clear();
    }

    /// Takes in a pixel with several surfaces, in the order of their first samples.
    #[expect(clippy::too_many_arguments, reason = "the rarer half of `collect`")]
    fn share(
        &mut self,
        samples: &Visibility,
        pixel: u32,
        side: usize,
        corner: [i32; 2],
        order: &SampleOrder,
        list: &[Entry],
        bins: &Bins,
    ) {
        let mut ids = [0u32; 16];
        let mut masks = [0u16; 16];
        let mut count = 0;
        let mut uncovered = false;
        for s in 0..order.pattern.len() {
            let id = samples.id[s * side * side + pixel as usize];
            if id == 0 {
                uncovered = true;
                continue;
            }
            let at = ids[..count].iter().position(|&known| known == id).unwrap_or_else(|| {
                ids[count] = id;
                count += 1;
                count - 1
            });
            masks[at] |= 1 << s;
        }
        if uncovered {
            self.sky.push(pixel);
        }
        let first = u32::try_from(self.masks.len()).expect("a tile is small");
        for (&id, &mask) in ids.iter().zip(&masks).take(count) {
            let triangle = triangle(list[id as usize - 1], bins).1;
            let [x, y] = shading_point(triangle, mask, corner, order);
            let target = u32::try_from(self.targets).expect("a tile is small");
            self.targets += 1;
            self.unsorted.push(Unsorted { id, target, x, y });
            self.masks.push(mask);
        }
        self.shared.push(SharedPixel { pixel, first, count: u32::try_from(count).expect("a tile is small") });
    }

    /// A counting sort by (draw, id).
    fn sort(&mut self, list: &[Entry], bins: &Bins) {
        self.counts.clear();
        self.counts.resize(list.len() + 1, 0);
        for fragment in &self.unsorted {
            self.counts[fragment.id as usize] += 1;
        }
        let ids = 1..u32::try_from(list.len() + 1).expect("a list of u32 entries");
        self.visible.extend(ids.filter(|&id| self.counts[id as usize] > 0));
        let draw = |id: u32| triangle(list[id as usize - 1], bins).1.draw;
        self.visible.sort_by_key(|&id| draw(id));

        // `counts` turns into each triangle's next free place, `record` into its number in its run.
        let mut record = std::mem::take(&mut self.counts);
        let mut next = vec![0u32; record.len()];
        let mut at = 0;
        for (i, &id) in self.visible.iter().enumerate() {
            let count = record[id as usize];
            if self.runs.last().is_none_or(|run| run.draw != draw(id)) {
                self.runs.push(Run { draw: draw(id), first: [i, at as usize], end: [i, at as usize] });
            }
            let run = self.runs.last_mut().expect("just pushed");
            record[id as usize] = u32::try_from(i - run.first[0]).expect("a tile is small");
            next[id as usize] = at;
            at += count;
            run.end = [i + 1, at as usize];
        }
        self.sorted.resize(self.unsorted.len(), Fragment::default());
        for fragment in &self.unsorted {
            let place = &mut next[fragment.id as usize];
            self.sorted[*place as usize] = Fragment {
                record: record[fragment.id as usize],
                target: fragment.target,
                x: fragment.x,
                y: fragment.y,
            };
            *place += 1;
        }
        self.counts = record;
    }
}

/// The chunk and triangle of a list's entry.
#[must_use]
pub fn triangle((chunk, index): Entry, bins: &Bins) -> (&Chunk, &Triangle) {
    let chunk = &bins.chunks[chunk as usize];
    (chunk, &chunk.triangles[index as usize])
}

/// The pixel's centre if the triangle covers it, else its covered sample nearest to the centre: so
/// the weights of the corners are never negative. `corner` is the pixel's upper left, in sub-pixels.
pub(super) fn shading_point(t: &Triangle, mask: u16, corner: [i32; 2], order: &SampleOrder) -> [i32; 2] {
    let centre = corner.map(|c| c + 128);
    if contains(t, centre) {
        return centre;
    }
    let nearest = order.nearest.iter().find(|&&s| mask >> s & 1 == 1).expect("a fragment covers a sample");
    let offset = order.pattern[*nearest];
    [corner[0] + offset[0], corner[1] + offset[1]]
}

/// Whether a point lies in the triangle or on its border, exactly.
fn contains(t: &Triangle, p: [i32; 2]) -> bool {
    (0..3).all(|i| t.edge_at(i, p.map(i64::from)) >= 0)
}

#[cfg(test)]
mod tests;
