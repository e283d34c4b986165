//! Triangle set-up: culling, snapping, orientation, and the depth plane.

use super::Primitives;
use super::bin::{Chunk, TileGrid};
use super::clip::{ClipVertex, Polygon};
use super::vertex::{GUARD, ScreenVertices, outcode};
use crate::math::Viewport;
use crate::math::simd::Level;
use crate::pipeline::shader::ClipBlock;
use crate::plan::{Elision, Elisions, Opacity, Slot};
use crate::scene::Cull;
use std::ops::Range;

/// A triangle in screen space, ready to be rasterized. 64 bytes, one cache line.
///
/// Its corners run clockwise as seen (y down, so its area is positive), and corner 0 is the one with
/// the least depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Screen x of the corners in sub-pixels.
    pub x: [i32; 3],
    /// Screen y of the corners in sub-pixels, down.
    pub y: [i32; 3],
    /// Depth over the screen.
    pub depth: Depth,
    /// What shades it: [`Slot::draw`].
    pub draw: u32,
    /// Index of the triangle in its mesh.
    pub source: u32,
    /// Index into [`Chunk::clipped`], or [`NOT_CLIPPED`].
    pub clipped: u32,
    flags: u32,
}

/// [`Triangle::clipped`] of a whole triangle.
pub const NOT_CLIPPED: u32 = u32::MAX;

/// Depth of a triangle over the screen, relative to its corner 0, which has the least depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// Depth at corner 0.
    pub base: f64,
    /// Plane: depth per sub-pixel in x and y. Positive sum: depth per unit of the edge functions of
    /// corners 1 and 2.
    pub slope: [f64; 2],
}

impl Triangle {
    const STIFF: u32 = 8;
    const BACK: u32 = 16;
    const CUT_OUT: u32 = 32;
    const BLENDED: u32 = 64;

    /// Whether the depth is summed from edge functions (all terms ≥ 0, so nothing cancels) instead
    /// of taken from a plane: where the terms of the plane exceed the least depth by more than 2²⁴
    /// (corners too far apart, or a sliver), they would cancel to less than f32's precision in f64.
    #[must_use]
    pub fn is_stiff(&self) -> bool {
        self.flags & Self::STIFF != 0
    }

    /// Whether its back is seen.
    #[must_use]
    pub fn is_back(&self) -> bool {
        self.flags & Self::BACK != 0
    }

    /// How it meets what lies behind it: [`Slot::opacity`].
    #[must_use]
    pub fn opacity(&self) -> Opacity {
        match self.flags & (Self::CUT_OUT | Self::BLENDED) {
            0 => Opacity::Opaque,
            Self::CUT_OUT => Opacity::CutOut,
            _ => Opacity::Blended,
        }
    }

    /// Which corner of the source triangle (or of the clipped piece) each corner is.
    #[must_use]
    pub fn corners(&self) -> [usize; 3] {
        PERMUTATIONS[(self.flags & 7) as usize]
    }

    /// The depth at a screen position in sub-pixels, before it is rounded to f32.
    #[must_use]
    pub fn depth_at(&self, x: f64, y: f64) -> f64 {
        let (dx, dy) = (x - f64::from(self.x[0]), y - f64::from(self.y[0]));
        let [sx, sy] = self.depth.slope;
        if self.is_stiff() {
            let [e1, e2] = self.edges_from_corner_0();
            self.depth.base + (sx * (e1[0] * dx + e1[1] * dy) + sy * (e2[0] * dx + e2[1] * dy))
        } else {
            (self.depth.base + sy * dy) + sx * dx
        }
    }

    /// Steps of the edge function of corner `i` → `i + 1` in x and in y, at most 2²⁴.
    ///
    /// The edge function is twice the signed area of the triangle that the edge makes with a point, in
    /// sub-pixels²: positive inside. Source: J. Pineda, "A Parallel Algorithm for Polygon
    /// Rasterization", SIGGRAPH 1988.
    #[must_use]
    pub fn edge_step(&self, i: usize) -> [i32; 2] {
        let j = (i + 1) % 3;
        [self.y[i] - self.y[j], self.x[j] - self.x[i]]
    }

    /// The edge function of corner `i` → `i + 1` at a point in sub-pixels: exact, at most 2⁴⁹ within
    /// the guard band.
    #[must_use]
    pub fn edge_at(&self, i: usize, p: [i64; 2]) -> i64 {
        let [dx, dy] = self.edge_step(i).map(i64::from);
        dx * (p[0] - i64::from(self.x[i])) + dy * (p[1] - i64::from(self.y[i]))
    }

    /// Twice its area in sub-pixels², positive; exact in f64.
    #[must_use]
    pub fn doubled_area(&self) -> f64 {
        let [e1, e2] = self.edges_from_corner_0();
        let (x, y) =
            (f64::from(self.x[1]) - f64::from(self.x[0]), f64::from(self.y[1]) - f64::from(self.y[0]));
        debug_assert_eq!(e2[0] * x + e2[1] * y, 0.0, "the edge through corners 0 and 1 vanishes at both");
        e1[0] * x + e1[1] * y
    }

    /// The edge functions of corners 1 and 2 (both vanish at corner 0): their steps in x and y.
    /// Whole numbers, exact in f64.
    #[must_use]
    pub fn edges_from_corner_0(&self) -> [[f64; 2]; 2] {
        [self.edge_step(2).map(f64::from), self.edge_step(0).map(f64::from)]
    }
}

/// Even permutations first: those that keep the orientation.
const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// The largest ratio of a plane's terms to the least depth. A plane in f64 then errs by a few times
/// 2⁻⁵³ · 2²⁴, which is less than f32 can tell.
const STIFF_RATIO: f64 = 16_777_216.0;

/// A snapped vertex: whole sub-pixels and the depth.
#[derive(Clone, Copy)]
struct Snapped {
    x: f64,
    y: f64,
    depth: f64,
}

/// What a triangle became.
enum Fate {
    Set(Triangle),
    Culled,
    Degenerate,
}

/// Sets up the triangles `range` of `primitives` and bins them.
#[expect(clippy::too_many_arguments, reason = "a part of a mesh, where it goes, and how")]
pub fn process(
    primitives: &Primitives,
    range: Range<usize>,
    vertices: &ScreenVertices,
    viewport: &Viewport,
    grid: &TileGrid,
    elide: Elisions,
    level: Level,
    pairs: &mut Vec<(u32, u32)>,
) -> Chunk {
    let mut chunk = Chunk::new(elide);
    let drops_outside = elide.contains(Elision::OutsideTriangles);
    let spares_clipper = elide.contains(Elision::Clipping);
    let parts = primitives.parts;
    let mut part = parts.partition_point(|p| p.first_triangle as usize <= range.start) - 1;
    for source in range {
        while parts.get(part + 1).is_some_and(|next| next.first_triangle as usize <= source) {
            part += 1;
        }
        let Some(slot) = primitives.slots[parts[part].slot as usize] else { continue };
        let corners = primitives.triangles[source];
        let codes = corners.map(|v| vertices.outcode[v as usize]);
        chunk.counts.triangles += 1;
        if drops_outside && codes[0] & codes[1] & codes[2] & outcode::OUTSIDE != 0 {
            chunk.counts.outside += 1;
            continue;
        }
        // Mesh triangles number below 2³².
        let source = u32::try_from(source).expect("a mesh has fewer than 2³² triangles");
        let is_inside = (codes[0] | codes[1] | codes[2]) & outcode::CLIP == 0;
        if is_inside && (spares_clipper || leaves_clipper_whole(primitives, corners, viewport, level)) {
            let snapped = corners.map(|v| {
                let v = v as usize;
                Snapped { x: vertices.x[v], y: vertices.y[v], depth: vertices.depth[v] }
            });
            let fate = set_up(snapped, slot, source, NOT_CLIPPED, primitives.mirrored);
            record(fate, &mut chunk, grid, pairs);
        } else {
            let positions = clip_positions(primitives, corners, level);
            let Some(polygon) = Polygon::triangle(positions, viewport) else {
                chunk.counts.degenerate += 1;
                continue;
            };
            chunk.counts.clipped += 1;
            process_clipped(
                &polygon.clipped(viewport),
                slot,
                source,
                primitives.mirrored,
                &mut chunk,
                grid,
                pairs,
            );
        }
    }
    chunk.sort_into_tiles(grid, pairs);
    chunk.tally_triangles();
    chunk
}

/// Whether nothing is cut off a triangle.
fn leaves_clipper_whole(
    primitives: &Primitives,
    corners: [u32; 3],
    viewport: &Viewport,
    level: Level,
) -> bool {
    let polygon = Polygon::triangle(clip_positions(primitives, corners, level), viewport);
    polygon.is_some_and(|polygon| polygon.clipped(viewport).corners() == polygon.corners())
}

/// Where the corners of one triangle are, asked again: few are clipped, and keeping the positions of all
/// vertices for them would cost the others memory.
fn clip_positions(primitives: &Primitives, corners: [u32; 3], level: Level) -> [[f64; 4]; 3] {
    let mut block = ClipBlock::default();
    corners.map(|vertex| {
        primitives.vertices.positions(level, vertex..vertex + 1, &mut block);
        block.position(0)
    })
}

/// Sets up the pieces of a cut triangle: a fan around the polygon's first corner.
fn process_clipped(
    polygon: &Polygon,
    slot: Slot,
    source: u32,
    mirrored: bool,
    chunk: &mut Chunk,
    grid: &TileGrid,
    pairs: &mut Vec<(u32, u32)>,
) {
    // Where the near distance is a subnormal number, a later cut moves a corner off the guard plane
    // of an earlier one by more than its last place.
    let snap = |v: &ClipVertex| Snapped {
        x: (v.x / v.w + 0.5).floor().clamp(-GUARD, GUARD),
        y: (v.y / v.w + 0.5).floor().clamp(-GUARD, GUARD),
        depth: v.z / v.w,
    };
    let corners = polygon.corners();
    for i in 2..corners.len() {
        let piece = [&corners[0], &corners[i - 1], &corners[i]];
        let clipped = u32::try_from(chunk.clipped.len()).expect("a chunk is small");
        let mut counts = chunk.counts;
        let fate = set_up(piece.map(snap), slot, source, clipped, mirrored);
        if matches!(fate, Fate::Set(_)) {
            chunk.clipped.push(piece.map(|v| v.weights));
        }
        record(fate, chunk, grid, pairs);
        // The triangle's fate is "clipped"; that of its pieces shows only in what is drawn.
        counts.pieces += chunk.counts.drawn - counts.drawn;
        counts.drawn = chunk.counts.drawn;
        chunk.counts = counts;
    }
}

fn record(fate: Fate, chunk: &mut Chunk, grid: &TileGrid, pairs: &mut Vec<(u32, u32)>) {
    match fate {
        Fate::Culled => chunk.counts.culled += 1,
        Fate::Degenerate => chunk.counts.degenerate += 1,
        Fate::Set(triangle) => {
            if chunk.bin(triangle, grid, pairs) {
                chunk.counts.drawn += 1;
            } else {
                chunk.counts.no_sample += 1;
            }
        }
    }
}

fn set_up(v: [Snapped; 3], slot: Slot, source: u32, clipped: u32, mirrored: bool) -> Fate {
    // Twice the signed area in 1/65536 px²: at most 2⁴⁹, so every step is exact.
    let area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[1].y - v[0].y) * (v[2].x - v[0].x);
    if !(area.abs() > 0.0 && v.iter().all(|v| v.depth.is_finite())) {
        return Fate::Degenerate;
    }
    // With y down, clockwise is positive and a front face (counter-clockwise) negative; a mirrored
    // instance turns its front faces clockwise.
    let back = (area > 0.0) != mirrored;
    let culled = match slot.cull {
        Cull::Back => back,
        Cull::Front => !back,
        Cull::None => false,
    };
    if culled {
        return Fate::Culled;
    }
    let order = clockwise_from_least_depth(&v, area > 0.0);
    let v = PERMUTATIONS[order as usize].map(|corner| v[corner]);
    let area = area.abs();
    // Depth gained per unit of the edge function of corner 1, and of corner 2.
    let gain = [(v[1].depth - v[0].depth) / area, (v[2].depth - v[0].depth) / area];
    let stiff = plane_terms(&v, gain) > v[0].depth * STIFF_RATIO;
    let slope = if stiff {
        gain
    } else {
        [
            gain[0] * (v[2].y - v[0].y) + gain[1] * (v[0].y - v[1].y),
            gain[0] * (v[0].x - v[2].x) + gain[1] * (v[1].x - v[0].x),
        ]
    };
    let opacity = match slot.opacity {
        Opacity::Opaque => 0,
        Opacity::CutOut => Triangle::CUT_OUT,
        Opacity::Blended => Triangle::BLENDED,
    };
    let stiff = if stiff { Triangle::STIFF } else { 0 };
    let flags = order | stiff | if back { Triangle::BACK } else { 0 } | opacity;
    Fate::Set(Triangle {
        x: v.map(|v| to_i32(v.x)),
        y: v.map(|v| to_i32(v.y)),
        depth: Depth { base: v[0].depth, slope },
        draw: slot.draw,
        source,
        clipped,
        flags,
    })
}

/// A bound on the terms that a depth plane adds up within the triangle, before they cancel.
///
/// About the largest depth for a triangle of any width; for a sliver, which falls from depth to
/// depth within a few sub-pixels and runs on for a million, as much more as it is longer than wide.
fn plane_terms(v: &[Snapped; 3], gain: [f64; 2]) -> f64 {
    let reach = |of: fn(&Snapped) -> f64| (of(&v[1]) - of(&v[0])).abs().max((of(&v[2]) - of(&v[0])).abs());
    let (reach_x, reach_y) = (reach(|v| v.x), reach(|v| v.y));
    let edge = |corner: &Snapped| (corner.y - v[0].y).abs() * reach_x + (corner.x - v[0].x).abs() * reach_y;
    gain[0] * edge(&v[2]) + gain[1] * edge(&v[1])
}

/// Index of the permutation that makes the corners clockwise, beginning at the least depth (the
/// first of equals).
fn clockwise_from_least_depth(v: &[Snapped; 3], clockwise: bool) -> u32 {
    let least = if v[1].depth < v[0].depth {
        if v[2].depth < v[1].depth { 2 } else { 1 }
    } else if v[2].depth < v[0].depth {
        2
    } else {
        0
    };
    match (clockwise, least) {
        (true, least) => least,
        (false, 0) => 3,
        (false, 1) => 5,
        (false, _) => 4,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the guard band bounds it to ±2²³")]
fn to_i32(whole: f64) -> i32 {
    whole as i32
}

#[cfg(test)]
mod tests;
