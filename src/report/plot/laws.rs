//! Error over one knob: what was measured, the law that fits it, and the one that should.

use super::axes::Axes;
use super::svg::{Stroke, Svg, Text};
use super::{INK, QUIET, color, in_words};
use crate::report::error::Region;
use crate::report::fit::Fit;
use crate::report::setting::Knob;
use crate::report::sweep::Family;

/// Draws the panel of `fit` into `frame`: left, top, right, bottom.
pub fn draw(svg: &mut Svg, fit: &Fit, frame: [f64; 4]) {
    let axes = Axes::around(fit.points.iter().copied(), frame);
    svg.text([frame[0], frame[1] - 26.0], &title(fit), Text::BOLD);
    svg.text([frame[0], frame[1] - 10.0], &verdict(fit), Text::QUIET);
    axes.draw(svg, [x_name(fit.knob), fit.metric.word()]);
    if let Some([least, most]) = fit.window {
        for slope in [least, most] {
            let line = through_the_middle(fit, slope, &axes);
            svg.line(&line, Stroke { dashes: "5 4", ..Stroke::solid(QUIET, 1.0) });
        }
    }
    svg.line(&fitted(fit, &axes), Stroke::solid(INK, 1.4));
    for point in &fit.points {
        let title = format!("{}: {:.3e}", point[0], point[1]);
        svg.disc(axes.place(*point), 4.2, color(Family::Knob(fit.knob)), &title);
    }
}

fn title(fit: &Fit) -> String {
    let region = match fit.region {
        Region::All => "",
        Region::Edges => " at edges",
        Region::Penumbrae => " in penumbrae",
        Region::Textured => " on textures",
    };
    format!("{}{region}", in_words(fit.knob))
}

fn x_name(knob: Knob) -> &'static str {
    match knob {
        Knob::ShadowResolution => "size of a texel (1 / texels)",
        Knob::RenderScale => "size of a drawn pixel",
        knob => in_words(knob),
    }
}

/// `slope −0.66 ± 0.02, expected −0.85 to −0.55`
fn verdict(fit: &Fit) -> String {
    let slope = format!("{}: slope {:.2} ± {:.2}", fit.metric.word(), fit.slope, fit.se).replace('-', "−");
    match (fit.window, fit.pass, fit.e_inf) {
        (Some([least, most]), Some(pass), _) => {
            let mark = if pass { "✓" } else { "✗" };
            format!("{slope} {mark} expected {least} to {most}").replace('-', "−")
        }
        (_, _, Some(rest)) => format!("{slope}, ends at {rest:.1e}"),
        _ => slope,
    }
}

/// Mean of the logarithms of knob and error.
fn middle(fit: &Fit) -> [f64; 2] {
    #[expect(clippy::cast_precision_loss, reason = "a few points")]
    let count = fit.points.len() as f64;
    [0, 1].map(|axis: usize| fit.points.iter().map(|point| point[axis].ln()).sum::<f64>() / count)
}

fn ends(fit: &Fit) -> [f64; 2] {
    let knobs = || fit.points.iter().map(|point| point[0]);
    [knobs().fold(f64::INFINITY, f64::min), knobs().fold(0.0, f64::max)]
}

/// A power of the knob with the exponent `slope`, through the middle of the points.
fn through_the_middle(fit: &Fit, slope: f64, axes: &Axes) -> Vec<[f64; 2]> {
    let [x, y] = middle(fit);
    ends(fit).map(|knob| axes.place([knob, (y + slope * (knob.ln() - x)).exp()])).to_vec()
}

/// Steps of a curve.
const STEPS: u32 = 24;

/// The fitted law, with the floor that it ends at.
fn fitted(fit: &Fit, axes: &Axes) -> Vec<[f64; 2]> {
    let floor = fit.e_inf.unwrap_or(0.0);
    #[expect(clippy::cast_precision_loss, reason = "a few points")]
    let count = fit.points.len() as f64;
    let x = middle(fit)[0];
    let y = fit.points.iter().map(|point| (point[1] - floor).ln()).sum::<f64>() / count;
    let [least, most] = ends(fit);
    let knob = |step: u32| least * (most / least).powf(f64::from(step) / f64::from(STEPS));
    let error = |knob: f64| floor + (y + fit.slope * (knob.ln() - x)).exp();
    (0..=STEPS).map(|step| axes.place([knob(step), error(knob(step))])).collect()
}
