//! Time per pass: one bar a preset, and one for the default.

use super::short;
use super::svg::{Svg, Text};
use crate::report::sweep::Family;
use crate::report::{Point, Report};

/// Passes in their order, each with its colour.
const PASSES: [(&str, &str); 10] = [
    ("plan", "#999999"),
    ("shadow", "#4d4d4d"),
    ("geometry", "#0072b2"),
    ("raster", "#56b4e9"),
    ("shade", "#e69f00"),
    ("sky", "#f0e442"),
    ("resolve", "#009e73"),
    ("post", "#cc79a7"),
    ("resample", "#d55e00"),
    ("encode", "#c8c8c8"),
];

/// Pixels from one bar to the next.
const STEP: f64 = 46.0;

/// Draws the panel into `frame`: left, top, right, bottom.
pub fn draw(svg: &mut Svg, report: &Report, [left, top, right, _]: [f64; 4]) {
    svg.text([left, top - 10.0], "Time per pass", Text::BOLD);
    let named: Vec<(&str, &Point)> = report.points.iter().flat_map(names).collect();
    let total = |point: &Point| point.passes.iter().map(|(_, ms)| ms).sum::<f64>();
    let most = named.iter().map(|(_, point)| total(point)).fold(f64::MIN_POSITIVE, f64::max);
    let mut y = top + 14.0;
    for (name, point) in &named {
        svg.text([left, y], &format!("{name}: {} ms", short(total(point))), Text::PLAIN);
        draw_bar(svg, point, [left, y + 6.0, left + (right - left) * total(point) / most, y + 24.0]);
        y += STEP;
    }
    draw_legend(svg, &named, [left, y + 10.0]);
}

/// What of the bars a setting is.
fn names(point: &Point) -> impl Iterator<Item = (&'static str, &Point)> {
    let name = |family: &Family| match family {
        Family::Default => Some("default"),
        Family::Preset(preset) => Some(preset.word()),
        _ => None,
    };
    point.families.iter().filter_map(name).map(move |name| (name, point))
}

fn draw_bar(svg: &mut Svg, point: &Point, [left, top, right, bottom]: [f64; 4]) {
    let total: f64 = point.passes.iter().map(|(_, ms)| ms).sum();
    let mut from = left;
    for (pass, ms) in &point.passes {
        let to = from + (right - left) * ms / total;
        let color = PASSES.iter().find(|(name, _)| name == pass).map_or("#000000", |(_, color)| *color);
        svg.bar([from, top, to, bottom], color, &format!("{pass}: {ms:.2} ms"));
        from = to;
    }
}

/// The passes that ran, in three columns.
fn draw_legend(svg: &mut Svg, named: &[(&str, &Point)], [left, top]: [f64; 2]) {
    let ran = |pass: &str| named.iter().any(|(_, point)| point.passes.iter().any(|(name, _)| *name == pass));
    for (at, (pass, color)) in PASSES.iter().filter(|(pass, _)| ran(pass)).enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a few passes")]
        let (x, y) = (left + (at % 3) as f64 * 100.0, top + (at / 3) as f64 * 18.0);
        svg.bar([x, y, x + 11.0, y + 11.0], color, pass);
        svg.text([x + 16.0, y + 10.0], pass, Text::QUIET);
    }
}
