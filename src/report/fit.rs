//! Powers of a knob: how error falls, and how it should.

use super::error::Region;
use super::setting::Knob;
use super::statistics::Line;
use serde::Serialize;

/// A law that a component's error is expected to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// What is turned.
    pub knob: Knob,
    /// What is measured.
    pub metric: Metric,
    /// Where.
    pub region: Region,
    /// Slopes of log error over log knob that are as they should be; `None`: the law is not known, as the error
    /// ends at a floor.
    pub window: Option<[f64; 2]>,
}

/// A number of [`super::error::Difference`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Root of the mean square.
    Rmse,
    /// Mean of the magnitudes.
    Mae,
}

impl Metric {
    /// What it is called.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE",
            Self::Mae => "MAE",
        }
    }
}

/// A measured law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// What was turned.
    pub knob: Knob,
    /// What was measured.
    pub metric: Metric,
    /// Where.
    pub region: Region,
    /// Knob and error of every point that was fitted.
    pub points: Vec<[f64; 2]>,
    /// Exponent of the knob.
    pub slope: f64,
    /// Its standard error.
    pub se: f64,
    /// What it should lie in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<[f64; 2]>,
    /// Whether it does, as far as its standard error tells; absent where no law is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pass: Option<bool>,
    /// The error that remains whatever the knob is turned to: `E = e_inf + c · knob^slope`.
    #[serde(rename = "E_inf", skip_serializing_if = "Option::is_none")]
    pub e_inf: Option<f64>,
}

/// Points this close to the reference's own error say nothing about a slope.
const FLOORS: f64 = 3.0;

/// The least number of points that are fitted.
const LEAST_POINTS: usize = 4;

impl Fit {
    /// Fits `points`, each a knob and an error, by `law`; `None` where fewer than four are clear of `floor`, the
    /// reference's own error.
    #[must_use]
    pub fn of(law: &Law, points: &[[f64; 2]], floor: f64) -> Option<Self> {
        let clear = |point: &[f64; 2]| point[1] > FLOORS * floor && point[1] > 0.0;
        let points: Vec<[f64; 2]> = points.iter().copied().filter(clear).collect();
        if points.len() < LEAST_POINTS {
            return None;
        }
        let e_inf = law.window.is_none().then(|| remaining(&points)).flatten();
        let line = power(&points, e_inf.unwrap_or(0.0))?;
        Some(Self {
            knob: law.knob,
            metric: law.metric,
            region: law.region,
            slope: line.slope,
            se: line.standard_error,
            window: law.window,
            pass: law.window.map(|[least, most]| {
                let unsure = line.standard_error;
                (least - unsure..=most + unsure).contains(&line.slope)
            }),
            e_inf,
            points,
        })
    }
}

/// The line through the logarithms, `floor` taken off the errors.
fn power(points: &[[f64; 2]], floor: f64) -> Option<Line> {
    let logarithms: Vec<[f64; 2]> = points.iter().map(|[x, y]| [x.ln(), (y - floor).ln()]).collect();
    Line::through(&logarithms)
}

/// Steps in which a floor is looked for.
const STEPS: u32 = 200;

/// The floor that makes a power of what is above it, best of all between 0 and the least error.
fn remaining(points: &[[f64; 2]]) -> Option<f64> {
    let least = points.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    let misfit = |floor: f64| {
        let line = power(points, floor)?;
        let off = |[x, y]: &[f64; 2]| {
            let fitted = floor + (line.intercept + line.slope * x.ln()).exp();
            ((fitted - y) / y).powi(2)
        };
        Some(points.iter().map(off).sum::<f64>())
    };
    let floors = (0..STEPS).map(|step| least * f64::from(step) / f64::from(STEPS));
    let judged = floors.filter_map(|floor| Some((misfit(floor)?, floor)));
    judged.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, floor)| floor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(window: Option<[f64; 2]>) -> Law {
        Law { knob: Knob::Samples, metric: Metric::Rmse, region: Region::Edges, window }
    }

    #[test]
    fn a_power_is_found() {
        let points: Vec<[f64; 2]> = [1.0, 2.0, 4.0, 8.0, 16.0f64].map(|n| [n, 0.25 * n.powf(-0.65)]).to_vec();
        let fit = Fit::of(&law(Some([-0.85, -0.55])), &points, 0.0).expect("five points");
        assert!((fit.slope + 0.65).abs() < 1e-12 && fit.pass == Some(true), "{fit:?}");
        let fit = Fit::of(&law(Some([-0.6, -0.5])), &points, 0.0).expect("five points");
        assert_eq!(fit.pass, Some(false));
    }

    #[test]
    fn points_at_the_floor_of_the_reference_are_left_out() {
        let points: Vec<[f64; 2]> = [1.0, 2.0, 4.0, 8.0, 16.0f64].map(|n| [n, 1.0 / n]).to_vec();
        assert_eq!(Fit::of(&law(None), &points, 0.04).map(|fit| fit.points.len()), Some(4));
        assert_eq!(Fit::of(&law(None), &points, 0.05), None);
    }

    #[test]
    fn what_remains_is_told_from_what_falls() {
        let points: Vec<[f64; 2]> =
            [4.0, 8.0, 16.0, 32.0, 64.0, 128.0f64].map(|n| [n, 0.01 + 0.2 / n]).to_vec();
        let fit = Fit::of(&law(None), &points, 0.0).expect("six points");
        assert!((fit.e_inf.expect("a floor") - 0.01).abs() < 2e-4, "{fit:?}");
        assert!((fit.slope + 1.0).abs() < 0.05, "{fit:?}");
    }
}
