//! What a frame cost and what it did.

use super::geometry::Counts;
use crate::plan::{Elision, Plan, Tally, Unit};
use std::time::Instant;

/// Seconds and work of one tile, or of all of them added up.
#[derive(Clone, Copy, Debug, Default)]
pub struct TileTimes {
    /// Coverage, depth, and the list of fragments.
    pub raster: f64,
    /// Attributes, textures, lights, shadow taps.
    pub shade: f64,
    /// The background.
    pub sky: f64,
    /// Samples to pixels to bytes.
    pub resolve: f64,
    /// What was done, and what was spared.
    pub tally: Tally,
}

impl TileTimes {
    /// Seconds of everything.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.raster + self.shade + self.sky + self.resolve
    }

    /// Adds another's.
    pub fn add(&mut self, o: &Self) {
        self.raster += o.raster;
        self.shade += o.shade;
        self.sky += o.sky;
        self.resolve += o.resolve;
        self.tally.add(&o.tally);
    }
}

/// What a frame did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stats {
    /// Of the camera's pass; nothing for a frame that shares the pass of one before it.
    pub geometry: Counts,
    /// Shadow maps drawn; each face around a point light is one.
    pub shadow_maps: u64,
    /// What all passes did, and what elisions spared them.
    pub tally: Tally,
}

impl Stats {
    pub(super) fn new(geometry: Counts, tally: Tally, plan: &Plan) -> Self {
        let shadow_maps = plan.shadows.iter().map(|pass| pass.faces().len() as u64).sum();
        Self { geometry, shadow_maps, tally }
    }

    /// Fragments shaded.
    #[must_use]
    pub fn shaded(&self) -> u64 {
        self.tally.done(Unit::Fragments)
    }

    /// The entries of a `Render-Stats` header.
    #[must_use]
    pub fn entries(&self) -> [(&'static str, u64); 9] {
        let g = &self.geometry;
        [
            ("triangles", g.triangles),
            ("culled", g.outside + g.culled + g.degenerate + g.no_sample),
            ("clipped", g.clipped),
            ("drawn", g.drawn),
            ("shaded", self.shaded()),
            ("shadow_maps", self.shadow_maps),
            ("lookups", self.tally.done(Unit::Lookups)),
            ("taps", self.tally.done(Unit::Taps)),
            ("taps_spared", self.tally.spared(Elision::DecidedTaps)),
        ]
    }
}

/// Milliseconds a pass, in the order of the passes. A pass that did not run is absent.
#[derive(Clone, Debug, Default)]
pub struct Timings(Vec<(&'static str, f64)>);

impl Timings {
    /// Notes a pass.
    pub fn push(&mut self, pass: &'static str, milliseconds: f64) {
        self.0.push((pass, milliseconds));
    }

    /// Notes the passes within tiles. `rate`: milliseconds that a second of the threads' time took.
    pub fn push_tiles(&mut self, rate: f64, times: &TileTimes) {
        let parts = [
            ("raster", times.raster),
            ("shade", times.shade),
            ("sky", times.sky),
            ("resolve", times.resolve),
        ];
        for (pass, seconds) in parts.into_iter().filter(|part| part.1 > 0.0) {
            self.push(pass, rate * seconds);
        }
    }

    /// Every pass with its milliseconds.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.0.iter().copied()
    }
}

/// A stopwatch that is read lap by lap.
pub struct Clock(Instant);

impl Clock {
    /// From now.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Seconds since the last lap.
    pub fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let seconds = (now - self.0).as_secs_f64();
        self.0 = now;
        seconds
    }
}
