//! Medians with intervals, and straight lines through points.

use super::random::Random;
use serde::Serialize;

/// What many measurements of one quantity say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The value that half of them stay below.
    pub median: f64,
    /// A quarter stays below it.
    pub p25: f64,
    /// Three quarters stay below it.
    pub p75: f64,
    /// 95 % interval of the median, by the bootstrap.
    pub ci: [f64; 2],
    /// The least.
    pub min: f64,
}

/// Resamplings of the bootstrap.
const RESAMPLINGS: usize = 400;

impl Spread {
    /// Whether the interval holds `value`.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        (self.ci[0]..=self.ci[1]).contains(&value)
    }

    /// Of at least one value.
    ///
    /// # Panics
    /// Of none.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let sorted = sorted(values);
        Self {
            median: quantile(&sorted, 0.5),
            p25: quantile(&sorted, 0.25),
            p75: quantile(&sorted, 0.75),
            ci: median_interval(&sorted),
            min: sorted[0],
        }
    }

    /// Half the width of the interval of the median, relative to it: the least relative difference that can be
    /// claimed.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        0.5 * (self.ci[1] - self.ci[0]) / self.median
    }
}

/// In order.
fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The value below which the share `q` of `sorted` lies, interpolated between neighbours.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a place in a list"
)]
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let place = q * (sorted.len() - 1) as f64;
    let (below, share) = (place as usize, place.fract());
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + share * (sorted[above] - sorted[below])
}

/// The percentile bootstrap. Source: B. Efron, "Bootstrap Methods: Another Look at the Jackknife", Annals of
/// Statistics 7(1), 1979.
fn median_interval(sorted: &[f64]) -> [f64; 2] {
    let mut random = Random(0);
    let mut medians: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| {
            let drawn: Vec<f64> = sorted.iter().map(|_| sorted[random.below(sorted.len())]).collect();
            median(&drawn)
        })
        .collect();
    medians.sort_by(f64::total_cmp);
    [quantile(&medians, 0.025), quantile(&medians, 0.975)]
}

/// The value that half of `values` stay below.
///
/// # Panics
/// Of none.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    quantile(&sorted(values), 0.5)
}

/// The value that the share `q` of `values` stays below; 0 of none.
#[must_use]
pub fn percentile(values: &[f64], q: f64) -> f64 {
    if values.is_empty() { 0.0 } else { quantile(&sorted(values), q) }
}

/// A straight line through points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Rise a unit.
    pub slope: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Value at 0.
    pub intercept: f64,
}

impl Line {
    /// By least squares; `None` through fewer than three points, or through points above each other.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a few points")]
    pub fn through(points: &[[f64; 2]]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / n;
        let (x, y) = (mean(0), mean(1));
        let spread: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
        if points.len() < 3 || spread <= 0.0 {
            return None;
        }
        let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / spread;
        let intercept = y - slope * x;
        let rest: f64 = points.iter().map(|p| (p[1] - intercept - slope * p[0]).powi(2)).sum();
        Some(Self { slope, standard_error: (rest / (n - 2.0) / spread).sqrt(), intercept })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_lies_within_its_interval() {
        let values: Vec<f64> = (0..31u8).map(|i| f64::from(i * 7 % 31)).collect();
        let spread = Spread::of(&values);
        assert_eq!((spread.median, spread.p25, spread.p75, spread.min), (15.0, 7.5, 22.5, 0.0));
        assert!(spread.ci[0] < 15.0 && spread.ci[1] > 15.0 && spread.ci[0] > 5.0 && spread.ci[1] < 25.0);
    }

    #[test]
    fn one_value_has_no_spread() {
        let spread = Spread::of(&[3.0]);
        assert_eq!((spread.median, spread.ci), (3.0, [3.0, 3.0]));
    }

    #[test]
    fn a_line_goes_through_points_of_one() {
        let points: Vec<[f64; 2]> = [0.0, 1.0, 2.0, 5.0].map(|x| [x, 3.0 - 0.5 * x]).to_vec();
        let line = Line::through(&points).expect("four points");
        assert!((line.slope + 0.5).abs() < 1e-12 && (line.intercept - 3.0).abs() < 1e-12);
        assert!(line.standard_error < 1e-9);
        assert_eq!(Line::through(&points[..2]), None);
    }
}
