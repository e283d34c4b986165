//! A report as one figure: error over time with the front, time per pass, error over each knob.

mod axes;
mod laws;
mod over_time;
mod passes;
pub(super) mod svg;

use super::Report;
use super::setting::Knob;
use super::sweep::Family;
use svg::{Svg, Text};

/// Pixels along the sides of the figure's upper part.
const WIDTH: f64 = 1080.0;
const UPPER: f64 = 520.0;

/// Rows of the small panels below.
const ROW: f64 = 270.0;
const PANELS_A_ROW: usize = 3;

/// What is drawn on: axes, grid and letters.
const INK: &str = "#1a1a1a";
const QUIET: &str = "#6b6b6b";
const GRID: &str = "#e6e6e6";

/// The report as an SVG.
#[must_use]
pub fn svg(report: &Report) -> String {
    let rows = report.fits.len().div_ceil(PANELS_A_ROW);
    #[expect(clippy::cast_precision_loss, reason = "a few rows")]
    let height = UPPER + ROW * rows as f64;
    let mut svg = Svg::new(WIDTH, height);
    heading(&mut svg, report);
    over_time::draw(&mut svg, report, [70.0, 84.0, 640.0, 470.0]);
    passes::draw(&mut svg, report, [730.0, 84.0, 1060.0, 470.0]);
    for (at, fit) in report.fits.iter().enumerate() {
        let (column, row) = (at % PANELS_A_ROW, at / PANELS_A_ROW);
        #[expect(clippy::cast_precision_loss, reason = "a few panels")]
        let (left, top) = (70.0 + column as f64 * 352.0, UPPER + row as f64 * ROW + 42.0);
        laws::draw(&mut svg, fit, [left, top, left + 270.0, top + 160.0]);
    }
    svg.finish()
}

fn heading(svg: &mut Svg, report: &Report) {
    let meta = &report.meta;
    svg.text(
        [24.0, 32.0],
        &format!("Error against run time: {}", meta.name),
        Text { size: 19.0, ..Text::BOLD },
    );
    let machine = &meta.machine;
    let cpu = machine.cpu.as_deref().unwrap_or("unknown processor");
    let line = format!(
        "{} × {} px · {} rounds, interleaved · {cpu}, {}, {} threads · rasterd {}",
        meta.width, meta.height, meta.rounds, machine.simd, machine.threads, machine.build
    );
    svg.text([24.0, 53.0], &line, Text::QUIET);
}

/// The colour of a family: eight that people with colour-blindness tell apart.
///
/// Source: M. Okabe, K. Ito, "Color Universal Design", 2008.
fn color(family: Family) -> &'static str {
    match family {
        Family::Default | Family::Control | Family::Preset(_) => "#000000",
        Family::Knob(Knob::Samples) => "#0072b2",
        Family::Knob(Knob::ShadowResolution) => "#e69f00",
        Family::Knob(Knob::PcfTaps | Knob::PcssTaps) => "#009e73",
        Family::Knob(Knob::RenderScale) => "#d55e00",
        Family::Knob(Knob::TextureFilter) => "#cc79a7",
        Family::Mixed => "#b0b0b0",
    }
}

/// A knob in words.
fn in_words(knob: Knob) -> &'static str {
    match knob {
        Knob::Samples => "samples a pixel",
        Knob::ShadowResolution => "shadow texels",
        Knob::PcfTaps => "PCF taps",
        Knob::PcssTaps => "PCSS taps",
        Knob::RenderScale => "render scale",
        Knob::TextureFilter => "texture filter",
    }
}

/// A number short enough for a tick or a caption.
fn short(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (0.01..1e4).contains(&magnitude) {
        let digits = if magnitude >= 100.0 {
            0
        } else if magnitude >= 1.0 {
            1
        } else {
            3
        };
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests;
