//! The front: settings that no other beats in both error and time.

use serde::Serialize;

/// A setting's place, with what is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Error, > 0.
    pub error: f64,
    /// Milliseconds, > 0.
    pub ms: f64,
    /// 95 % interval of `ms`.
    pub interval: [f64; 2],
}

/// Which of `places` are on the front. One is beaten if another has no larger error and no larger time, and
/// is better in one of them by more than its own uncertainty.
#[must_use]
pub fn pareto(places: &[Place], error_floor: f64) -> Vec<bool> {
    let beats = |a: &Place, b: &Place| {
        let clearly = a.interval[1] < b.interval[0] || a.error + error_floor < b.error;
        a.error <= b.error && a.ms <= b.ms && clearly
    };
    places.iter().map(|place| !places.iter().any(|other| beats(other, place))).collect()
}

/// A value between two settings of the front.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Between {
    /// Error.
    pub error: f64,
    /// Milliseconds; `None` where no setting reaches the error.
    pub ms: Option<f64>,
}

/// Points of the front, each error and milliseconds, from the least time on, error falling.
#[must_use]
pub fn staircase(places: &[Place], on_front: &[bool]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = places
        .iter()
        .zip(on_front)
        .filter(|(_, on)| **on)
        .map(|(place, _)| [place.error, place.ms])
        .collect();
    points.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let mut least = f64::INFINITY;
    points.retain(|point| {
        let better = point[0] < least;
        least = least.min(point[0]);
        better
    });
    points
}

/// Milliseconds to reach `error`, between the points of `front` as a power of the error; `None` if none does.
#[must_use]
pub fn time_to_reach(error: f64, front: &[[f64; 2]]) -> Option<f64> {
    let first = front.iter().position(|point| point[0] <= error)?;
    let [below, ms] = front[first];
    let Some([above, faster]) = first.checked_sub(1).map(|at| front[at]) else { return Some(ms) };
    Some(between([above, below], [faster, ms], error))
}

/// The error at `ms` milliseconds, between the points of `front` as a power of the time; `None` if all take
/// longer.
#[must_use]
pub fn error_at(ms: f64, front: &[[f64; 2]]) -> Option<f64> {
    let last = front.iter().rposition(|point| point[1] <= ms)?;
    let [error, slower] = front[last];
    let Some([less, longer]) = front.get(last + 1).copied() else { return Some(error) };
    Some(between([slower, longer], [error, less], ms))
}

/// The value at `x` of the power through two points.
fn between([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], x: f64) -> f64 {
    if x0 == x1 || x0 <= 0.0 || x1 <= 0.0 {
        return y1;
    }
    let share = (x.ln() - x0.ln()) / (x1.ln() - x0.ln());
    (y0.ln() + share * (y1.ln() - y0.ln())).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(error: f64, ms: f64) -> Place {
        Place { error, ms, interval: [0.99 * ms, 1.01 * ms] }
    }

    #[test]
    fn what_is_worse_in_both_is_not_on_the_front() {
        let places = [place(0.1, 1.0), place(0.05, 2.0), place(0.06, 3.0), place(0.01, 8.0)];
        assert_eq!(pareto(&places, 0.0), [true, true, false, true]);
    }

    #[test]
    fn what_takes_as_long_within_its_interval_and_errs_no_more_stays() {
        let places = [place(0.1, 1.0), place(0.1, 1.005)];
        assert_eq!(pareto(&places, 0.0), [true, true]);
    }

    #[test]
    fn between_two_points_error_is_a_power_of_time() {
        let front = [[0.1, 1.0], [0.01, 100.0]];
        assert!((time_to_reach(0.0316228, &front).expect("reached") - 10.0).abs() < 1e-3);
        assert!((error_at(10.0, &front).expect("reached") - 0.0316228).abs() < 1e-6);
        assert_eq!((time_to_reach(0.5, &front), error_at(1e3, &front)), (Some(1.0), Some(0.01)));
        assert_eq!((time_to_reach(0.001, &front), error_at(0.5, &front)), (None, None));
    }

    #[test]
    fn the_staircase_falls() {
        let places = [place(0.05, 2.0), place(0.1, 1.0), place(0.05, 2.01)];
        assert_eq!(staircase(&places, &[true; 3]), [[0.1, 1.0], [0.05, 2.0]]);
    }
}
