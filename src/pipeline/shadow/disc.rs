//! Where a kernel looks: points spread evenly over a disc.

use crate::math::round_to_f32;
use crate::math::simd::*;

/// Points of the unit disc, each with an equal share of its area. The same for every pixel: no noise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Disc {
    count: u32,
    /// In whole vectors: copies of the last point fill the end.
    eights: Vec<[[f32; LANES]; 3]>,
}

/// Eight points of a [`Disc`].
#[derive(Clone, Copy)]
pub(super) struct EightPoints<S: Simd> {
    pub(super) x: f32x8<S>,
    pub(super) y: f32x8<S>,
    /// Distance from the centre.
    pub(super) radius: f32x8<S>,
    /// Not set for the copies that fill the last vector.
    pub(super) counts: mask32x8<S>,
}

impl Disc {
    /// `count` points along a spiral, a golden angle apart. Source: H. Vogel, "A better way to construct
    /// the sunflower head", Mathematical Biosciences 44, 1979.
    pub(super) fn new(count: u32) -> Self {
        let golden_angle = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
        let point = |i: u32| {
            let i = f64::from(i.min(count.saturating_sub(1)));
            let radius = ((i + 0.5) / f64::from(count.max(1))).sqrt();
            let angle = i * golden_angle;
            [radius * libm::cos(angle), radius * libm::sin(angle), radius].map(round_to_f32)
        };
        let eight = |first: u32| {
            let points: [[f32; 3]; LANES] = [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| point(first + lane));
            [0, 1, 2].map(|c| points.map(|point| point[c]))
        };
        Self { count, eights: (0..count).step_by(LANES).map(eight).collect() }
    }

    /// How many points there are.
    #[inline(always)]
    pub(super) fn taps(&self) -> u64 {
        u64::from(self.count)
    }

    /// The same as a divisor.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "at most a thousand taps")]
    pub(super) fn count(&self) -> f32 {
        self.count as f32
    }

    /// All points, eight at a time.
    #[inline(always)]
    pub(super) fn for_each_eight<S: Simd>(&self, simd: S, mut f: impl FnMut(EightPoints<S>)) {
        let mut left = self.count.cast_signed();
        for eight in &self.eights {
            let [x, y, radius] = eight.map(|c| f32x8::simd_from(simd, c));
            let counts = ramp_i32(simd).simd_lt(i32x8::splat(simd, left));
            f(EightPoints { x, y, radius, counts });
            left -= 8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(disc: &Disc) -> Vec<[f32; 2]> {
        let all = disc.eights.iter().flat_map(|e| (0..LANES).map(|lane| [e[0][lane], e[1][lane]]));
        all.take(disc.count as usize).collect()
    }

    #[test]
    fn every_half_plane_holds_about_its_share_of_the_points() {
        for count in [16, 18, 36, 100] {
            let points = points(&Disc::new(count));
            assert_eq!(points.len(), count as usize);
            assert!(points.iter().all(|[x, y]| x.hypot(*y) < 1.0));
            // Area of the unit disc beyond a line at distance t from its centre.
            let share = |t: f64| (t.acos() - t * (1.0 - t * t).sqrt()) / std::f64::consts::PI;
            let mut worst = 0.0f64;
            for direction in 0..64 {
                let (sin, cos) = (f64::from(direction) * 0.1).sin_cos();
                for t in (-9..=9).map(|t| f64::from(t) * 0.1) {
                    let beyond = |p: &&[f32; 2]| f64::from(p[0]) * cos + f64::from(p[1]) * sin > t;
                    let found = f64::from(u32::try_from(points.iter().filter(beyond).count()).unwrap());
                    let error = (found / f64::from(count) - share(t)).abs();
                    assert!(!error.is_nan());
                    worst = worst.max(error);
                }
            }
            // Random points would be off by 1.5/√n somewhere.
            assert!(worst < 0.7 / f64::from(count).sqrt(), "{count} points: {worst}");
        }
    }
}
