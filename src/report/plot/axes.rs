//! Two logarithmic axes, their grid and their ticks.

use super::svg::{Stroke, Svg, Text};
use super::{GRID, INK, short};

/// A panel whose axes are both logarithmic.
pub struct Axes {
    /// Least and greatest value along each axis, > 0.
    ranges: [[f64; 2]; 2],
    /// Left, top, right, bottom in pixels.
    frame: [f64; 4],
}

impl Axes {
    /// Axes around all of `points`, with a little room about them.
    pub fn around(points: impl Iterator<Item = [f64; 2]> + Clone, frame: [f64; 4]) -> Self {
        let range = |axis: usize| {
            let values =
                || points.clone().map(|point| point[axis]).filter(|value| *value > 0.0 && value.is_finite());
            let least = values().fold(f64::INFINITY, f64::min);
            let most = values().fold(0.0, f64::max);
            if most == 0.0 { [1.0, 10.0] } else { roomy(least, most) }
        };
        Self { ranges: [range(0), range(1)], frame }
    }

    /// Where a point of the panel lies in the figure; what is outside is at the border.
    pub fn place(&self, point: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.frame;
        let share = |axis: usize| {
            let [least, most] = self.ranges[axis];
            ((point[axis].max(least).ln() - least.ln()) / (most.ln() - least.ln())).clamp(0.0, 1.0)
        };
        [left + share(0) * (right - left), bottom - share(1) * (bottom - top)]
    }

    /// The least value of the axis upwards.
    pub fn lowest(&self) -> f64 {
        self.ranges[1][0]
    }

    /// Grid, frame, ticks and the names of the axes.
    pub fn draw(&self, svg: &mut Svg, names: [&str; 2]) {
        let [left, top, right, bottom] = self.frame;
        for value in ticks(self.ranges[0]) {
            let [x, _] = self.place([value, 1.0]);
            svg.line(&[[x, top], [x, bottom]], Stroke::solid(GRID, 1.0));
            svg.text([x, bottom + 16.0], &short(value), Text { anchor: "middle", ..Text::QUIET });
        }
        for value in ticks(self.ranges[1]) {
            let [_, y] = self.place([1.0, value]);
            svg.line(&[[left, y], [right, y]], Stroke::solid(GRID, 1.0));
            svg.text([left - 6.0, y + 4.0], &short(value), Text { anchor: "end", ..Text::QUIET });
        }
        svg.line(&[[left, top], [left, bottom], [right, bottom]], Stroke::solid(INK, 1.0));
        let middle = [(left + right) / 2.0, (top + bottom) / 2.0];
        svg.text([middle[0], bottom + 34.0], names[0], Text { anchor: "middle", ..Text::PLAIN });
        let beside = Text { anchor: "middle", turned: -90.0, ..Text::PLAIN };
        svg.text([left - 46.0, middle[1]], names[1], beside);
    }
}

/// A range with room at its ends.
fn roomy(least: f64, most: f64) -> [f64; 2] {
    let room = (most / least).powf(0.06).max(1.15);
    [least / room, most * room]
}

/// 1, 2 and 5 of each decade; powers of ten alone where these would be too many.
fn ticks([least, most]: [f64; 2]) -> Vec<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "a decade of an f64")]
    let decade = |value: f64| value.log10().floor() as i32;
    let steps: &[f64] = if (most / least).log10() > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let decades = decade(least)..=decade(most);
    let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
    all.filter(|value| (least..=most).contains(value)).collect()
}
