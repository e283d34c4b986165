//! Numbers of visible triangles, one record each, and how kernels of eight lanes read them.
//!
//! Every record begins with what the perspective weights of its corners are made of; whatever else is
//! interpolated with those follows.

use super::{BLOCK, Fragment};
use crate::math::round_to_f32;
use crate::math::simd::*;
use crate::pipeline::geometry::setup::Triangle;

// The head of a record's f64 part: corner 0; steps of the edge functions of corners 1 and 2, which
// vanish there; twice the area; the factor of each edge function that makes it a perspective weight.
const ORIGIN: usize = 0;
const EDGES: usize = 2;
const AREA: usize = 6;
const SCALE: usize = 7;

/// Numbers of f64 that every record begins with.
pub const HEAD: usize = 10;

/// Records of a fixed size, the f64 and f32 parts of all of them.
#[derive(Debug)]
pub struct Table {
    doubles: Vec<f64>,
    singles: Vec<f32>,
    doubles_a_record: usize,
    singles_a_record: usize,
}

impl Table {
    /// A table without records, each of which will have so many numbers.
    pub fn new(doubles_a_record: usize, singles_a_record: usize) -> Self {
        Self { doubles: Vec::new(), singles: Vec::new(), doubles_a_record, singles_a_record }
    }

    /// Begins a triangle's record. `w` are the corners' homogeneous coordinates, all the same without
    /// perspective. Returns the factors kᵢ of the edge functions: `lᵢ = kᵢ Eᵢ` is in 0–1 and
    /// proportional to the perspective weight of corner i.
    pub fn begin(&mut self, t: &Triangle, w: [f64; 3]) -> [f64; 3] {
        let [e1, e2] = t.edges_from_corner_0();
        let origin = [f64::from(t.x[0]), f64::from(t.y[0])];
        let area = t.doubled_area();
        let nearest = w[0].min(w[1]).min(w[2]);
        let scale = w.map(|w| nearest / w / area);
        self.doubles.extend(origin.iter().chain(&e1).chain(&e2).chain([&area]).chain(&scale));
        scale
    }

    /// Adds to the f64 part of the record that was begun last.
    pub fn extend_doubles(&mut self, values: &[f64]) {
        self.doubles.extend_from_slice(values);
    }

    /// Adds to its f32 part.
    pub fn extend_singles(&mut self, values: &[f32]) {
        self.singles.extend_from_slice(values);
    }

    /// Adds what [`Lanes::derivatives`] of an interpolated value are made of, in units per pixel:
    /// numerators of ∂/∂x and ∂/∂y at corner 0, and how they change.
    ///
    /// With U = Σ lᵢuᵢ and D = Σ lᵢ linear over the screen, `∂(U/D)/∂x = (Uₓ D − U Dₓ) / D²`, whose
    /// numerator is linear in y alone (and that of ∂/∂y in x alone).
    pub fn extend_derivatives(&mut self, t: &Triangle, scale: [f64; 3], value: [f64; 3]) {
        let [e1, e2] = t.edges_from_corner_0();
        let edges = [[0.0 - e1[0] - e2[0], 0.0 - e1[1] - e2[1]], e1, e2];
        let slope =
            |value: [f64; 3], axis: usize| (0..3).map(|i| edges[i][axis] * scale[i] * value[i]).sum::<f64>();
        let at_0 = t.doubled_area() * scale[0];
        let d = [slope([1.0; 3], 0), slope([1.0; 3], 1)];
        let g = [slope(value, 0), slope(value, 1)];
        let along = |axis: usize| (g[axis] - value[0] * d[axis]) * at_0;
        let numerators = [along(0), along(1), g[0] * d[1] - g[1] * d[0]];
        self.singles.extend(numerators.map(|n| round_to_f32(n * 256.0)));
    }

    /// Calls `f` for every eight of up to [`BLOCK`] fragments, with their records, their weights, and the
    /// place of the first in the block. Lanes beyond the last are copies of it.
    #[inline(always)]
    pub fn for_each_eight<S: Simd>(
        &self,
        simd: S,
        fragments: &[Fragment],
        mut f: impl FnMut(&Lanes, &Weights<S>, usize),
    ) {
        debug_assert!(fragments.len() <= BLOCK, "a block");
        for (group, at) in fragments.chunks(LANES).zip((0..).step_by(LANES)) {
            let lane = always(
                #[inline(always)]
                |i: usize| &group[i.min(group.len() - 1)],
            );
            let index: [usize; LANES] = std::array::from_fn(|i| lane(i).record as usize);
            let uniform = index.iter().all(|&i| i == index[0]);
            let lanes = Lanes { table: self, index, uniform };
            let x = f64x8::from_fn(
                simd,
                #[inline(always)]
                |i| f64::from(lane(i).x),
            );
            let y = f64x8::from_fn(
                simd,
                #[inline(always)]
                |i| f64::from(lane(i).y),
            );
            f(&lanes, &lanes.weights(simd, x, y), at);
        }
    }
}

/// Eight lanes' view of a table: either all of one triangle, or each of its own.
pub struct Lanes<'a> {
    table: &'a Table,
    /// Record of each lane.
    index: [usize; LANES],
    uniform: bool,
}

/// Perspective weights of eight fragments.
pub struct Weights<S: Simd> {
    /// Of the three corners: 0–1, with the sum 1.
    pub corners: [f32x8<S>; 3],
    /// Edge functions of corners 1 and 2.
    edges: [f64x8<S>; 2],
    /// 1 / Σ lᵢ.
    share: f64x8<S>,
    /// Σ lᵢ, and the place on the screen relative to corner 0, in sub-pixels.
    sum: f32x8<S>,
    from_corner_0: [f32x8<S>; 2],
}

impl Lanes<'_> {
    /// A number of the f32 part.
    #[inline(always)]
    pub fn single<S: Simd>(&self, simd: S, field: usize) -> f32x8<S> {
        let stride = self.table.singles_a_record;
        let all = &self.table.singles;
        if self.uniform {
            f32x8::splat(simd, all[self.index[0] * stride + field])
        } else {
            f32x8::from_fn(
                simd,
                #[inline(always)]
                |lane| all[self.index[lane] * stride + field],
            )
        }
    }

    /// A number of the f64 part.
    #[inline(always)]
    pub fn double<S: Simd>(&self, simd: S, field: usize) -> f64x8<S> {
        let stride = self.table.doubles_a_record;
        let all = &self.table.doubles;
        if self.uniform {
            f64x8::splat(simd, all[self.index[0] * stride + field])
        } else {
            f64x8::from_fn(
                simd,
                #[inline(always)]
                |lane| all[self.index[lane] * stride + field],
            )
        }
    }

    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, x: f64x8<S>, y: f64x8<S>) -> Weights<S> {
        // Edge functions relative to corner 0: whole numbers below 2⁵⁰, exact.
        let (dx, dy) = (x - self.double(simd, ORIGIN), y - self.double(simd, ORIGIN + 1));
        let edge = always(
            #[inline(always)]
            |i: usize| dx * self.double(simd, EDGES + 2 * i) + dy * self.double(simd, EDGES + 2 * i + 1),
        );
        let (e1, e2) = (edge(0), edge(1));
        let e0 = self.double(simd, AREA) - e1 - e2;
        let weight = always(
            #[inline(always)]
            |i: usize, e: f64x8<S>| e * self.double(simd, SCALE + i),
        );
        let l = [weight(0, e0), weight(1, e1), weight(2, e2)];
        let sum = (l[0] + l[1]) + l[2];
        let share = f64x8::splat(simd, 1.0) / sum;
        Weights {
            corners: [narrow(l[0] * share), narrow(l[1] * share), narrow(l[2] * share)],
            edges: [e1, e2],
            share,
            sum: narrow(sum),
            from_corner_0: [narrow(dx), narrow(dy)],
        }
    }

    /// Weighted mean of the f32 values of three corners that lie `step` fields apart.
    #[inline(always)]
    pub fn mix<S: Simd>(&self, simd: S, weights: &Weights<S>, field: usize, step: usize) -> f32x8<S> {
        let corner = always(
            #[inline(always)]
            |i: usize| weights.corners[i] * self.single(simd, field + i * step),
        );
        (corner(0) + corner(1)) + corner(2)
    }

    /// The same for three vectors.
    #[inline(always)]
    pub fn mix3<S: Simd>(&self, simd: S, weights: &Weights<S>, field: usize) -> Vec3x8<S> {
        Vec3x8 {
            x: self.mix(simd, weights, field, 3),
            y: self.mix(simd, weights, field + 1, 3),
            z: self.mix(simd, weights, field + 2, 3),
        }
    }

    /// A value in f64 of which `field` is that of corner 0, and those `step` and twice `step` behind it
    /// are how much corners 1 and 2 differ from it, times their scale.
    #[inline(always)]
    pub fn mix_wide<S: Simd>(&self, simd: S, weights: &Weights<S>, field: usize, step: usize) -> f64x8<S> {
        let [e1, e2] = weights.edges;
        let difference = e1 * self.double(simd, field + step) + e2 * self.double(simd, field + 2 * step);
        self.double(simd, field) + difference * weights.share
    }

    /// ∂/∂x and ∂/∂y per pixel, y down, of a value of which `field` begins the
    /// [numerators](Table::extend_derivatives).
    #[inline(always)]
    pub fn derivatives<S: Simd>(&self, simd: S, weights: &Weights<S>, field: usize) -> [f32x8<S>; 2] {
        let squared = weights.sum * weights.sum;
        let [x, y] = weights.from_corner_0;
        let cross = self.single(simd, field + 2);
        [
            (self.single(simd, field) + cross * y) / squared,
            (self.single(simd, field + 1) - cross * x) / squared,
        ]
    }
}
