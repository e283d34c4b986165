//! Error over time: every setting, and the front.

use super::axes::Axes;
use super::svg::{Stroke, Svg, Text};
use super::{INK, QUIET, color, in_words};
use crate::report::setting::Knob;
use crate::report::sweep::Family;
use crate::report::{Point, Report};

/// Draws the panel into `frame`: left, top, right, bottom.
pub fn draw(svg: &mut Svg, report: &Report, frame: [f64; 4]) {
    let places = report.points.iter().map(place);
    let axes = Axes::around(places.chain(whiskers(report)), frame);
    svg.text([frame[0], frame[1] - 10.0], "Error over time, with the front", Text::BOLD);
    axes.draw(svg, ["milliseconds a frame", "RMSE, linear light in 0–1"]);
    draw_floor(svg, report, &axes, frame);
    draw_families(svg, report, &axes);
    draw_front(svg, report, &axes, frame);
    // The control is the default under another name.
    for point in report.points.iter().rev().filter(|point| point.families != [Family::Control]) {
        draw_point(svg, point, &axes);
    }
    label_presets(svg, report, &axes);
    draw_legend(svg, report, frame);
}

fn place(point: &Point) -> [f64; 2] {
    [point.t.total.median, point.err.clamped.rmse]
}

fn whiskers(report: &Report) -> impl Iterator<Item = [f64; 2]> + Clone {
    let ends = |point: &Point| [point.t.total.p25, point.t.total.p75].map(|ms| [ms, point.err.clamped.rmse]);
    report.points.iter().flat_map(ends)
}

/// What the reference itself may be off by.
fn draw_floor(svg: &mut Svg, report: &Report, axes: &Axes, [left, _, right, bottom]: [f64; 4]) {
    let floor = report.reference.floor;
    if floor > axes.lowest() {
        let [_, top] = axes.place([1.0, floor]);
        svg.bar([left, top, right, bottom], "#e3e3e3", "the reference's own error");
        svg.text([left + 6.0, top + 13.0], "the reference's own error", Text::QUIET);
    }
}

/// A line through the settings of each knob, in the order of its values.
fn draw_families(svg: &mut Svg, report: &Report, axes: &Axes) {
    for knob in Knob::ALL {
        let family = Family::Knob(knob);
        let own = report.points.iter().filter(|point| point.families.contains(&family));
        let mut own: Vec<(f64, [f64; 2])> =
            own.map(|point| (knob.number(&point.knobs).unwrap_or(0.0), axes.place(place(point)))).collect();
        own.sort_by(|a, b| a.0.total_cmp(&b.0));
        let line: Vec<[f64; 2]> = own.into_iter().map(|(_, place)| place).collect();
        if knob != Knob::TextureFilter && line.len() > 1 {
            svg.line(&line, Stroke { dashes: "2 3", ..Stroke::solid(color(family), 1.2) });
        }
    }
}

/// Steps: an error is to be had from its setting's time on, until a better one's.
fn draw_front(svg: &mut Svg, report: &Report, axes: &Axes, [_, top, right, _]: [f64; 4]) {
    let mut steps = Vec::new();
    for [error, ms] in &report.front {
        let place = axes.place([*ms, *error]);
        let before = steps.last().map_or(top, |last: &[f64; 2]| last[1]);
        steps.extend([[place[0], before], place]);
    }
    if let Some(last) = steps.last().copied() {
        steps.push([right, last[1]]);
    }
    svg.line(&steps, Stroke::solid(INK, 1.6));
}

fn draw_point(svg: &mut Svg, point: &Point, axes: &Axes) {
    let family = point.families.iter().find(|family| matches!(family, Family::Knob(_)));
    let family = *family.or(point.families.first()).unwrap_or(&Family::Mixed);
    let (at, spread, error) = (axes.place(place(point)), &point.t.total, point.err.clamped.rmse);
    let ends = [spread.p25, spread.p75].map(|ms| axes.place([ms, error]));
    svg.line(&ends, Stroke::solid(color(family), 1.0));
    let knobs: Vec<String> =
        point.knobs.parameters().iter().map(|(name, value)| format!("{name} {value}")).collect();
    let title = format!("{}: RMSE {error:.5}, {:.2} ms", knobs.join(", "), spread.median);
    let radius = if family == Family::Mixed { 3.0 } else { 4.2 };
    if point.near_floor {
        svg.hollow(at, radius, color(family), &format!("{title}, near the reference's own error"));
    } else {
        svg.disc(at, radius, color(family), &title);
    }
    if point.families.contains(&Family::Default) {
        svg.ring(at, 8.0, INK);
    }
}

fn label_presets(svg: &mut Svg, report: &Report, axes: &Axes) {
    for point in &report.points {
        for family in &point.families {
            let [x, y] = axes.place(place(point));
            match family {
                Family::Preset(preset) => {
                    svg.text([x + 9.0, y - 8.0], preset.word(), Text { size: 11.0, ..Text::BOLD });
                }
                Family::Default => {
                    svg.text([x - 11.0, y + 17.0], "default", Text { anchor: "end", ..Text::QUIET });
                }
                _ => {}
            }
        }
    }
}

/// The colours that are in use, in the upper right corner.
fn draw_legend(svg: &mut Svg, report: &Report, [_, top, right, _]: [f64; 4]) {
    let used = |family: &Family| report.points.iter().any(|point| point.families.contains(family));
    let knobs = Knob::ALL.into_iter().map(|knob| (Family::Knob(knob), in_words(knob)));
    let entries = knobs.chain([(Family::Mixed, "several together")]).filter(|(family, _)| used(family));
    let mut y = top + 12.0;
    for (family, words) in entries {
        svg.disc([right - 8.0, y - 4.0], 4.2, color(family), words);
        svg.text([right - 18.0, y], words, Text { anchor: "end", fill: QUIET, ..Text::QUIET });
        y += 16.0;
    }
}
