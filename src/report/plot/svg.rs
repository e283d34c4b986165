//! Lines, marks and words of an SVG.

use super::{INK, QUIET};
use std::fmt::Write;

/// A figure under way. Coordinates are in pixels, y down.
pub struct Svg(String);

/// How words look.
#[derive(Clone, Copy)]
pub struct Text {
    /// Height of the letters in pixels.
    pub size: f64,
    /// Colour.
    pub fill: &'static str,
    /// `normal` or `bold`.
    pub weight: &'static str,
    /// Which part of the words is at the point: `start`, `middle` or `end`.
    pub anchor: &'static str,
    /// Degrees by which they are turned about the point.
    pub turned: f64,
}

impl Text {
    /// Plain words.
    pub const PLAIN: Self = Self { size: 12.0, fill: INK, weight: "normal", anchor: "start", turned: 0.0 };
    /// A heading.
    pub const BOLD: Self = Self { weight: "bold", size: 13.0, ..Self::PLAIN };
    /// What is beside the point.
    pub const QUIET: Self = Self { fill: QUIET, size: 11.0, ..Self::PLAIN };
}

/// How a line looks.
#[derive(Clone, Copy)]
pub struct Stroke {
    /// Colour.
    pub color: &'static str,
    /// Pixels.
    pub width: f64,
    /// Lengths of dashes and gaps; none: solid.
    pub dashes: &'static str,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(color: &'static str, width: f64) -> Self {
        Self { color, width, dashes: "none" }
    }
}

impl Svg {
    /// A white figure.
    pub fn new(width: f64, height: f64) -> Self {
        let mut svg = Self(String::new());
        svg.push(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"system-ui, 'Helvetica Neue', Arial, sans-serif\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>"
        ));
        svg
    }

    fn push(&mut self, element: std::fmt::Arguments) {
        writeln!(self.0, "{element}").expect("a string takes every line");
    }

    /// A line through points.
    pub fn line(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let Stroke { color, width, dashes } = stroke;
        self.push(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" \
             stroke-dasharray=\"{dashes}\" stroke-linejoin=\"round\"/>",
            points.join(" ")
        ));
    }

    /// A filled rectangle between two corners.
    pub fn bar(&mut self, [left, top, right, bottom]: [f64; 4], fill: &str, title: &str) {
        let (width, height) = ((right - left).max(0.0), (bottom - top).max(0.0));
        self.push(format_args!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{fill}\">\
             <title>{}</title></rect>",
            escaped(title)
        ));
    }

    /// A disc, with what is shown when it is pointed at.
    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str, title: &str) {
        self.push(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"#ffffff\" \
             stroke-width=\"0.8\"><title>{}</title></circle>",
            escaped(title)
        ));
    }

    /// A hollow disc with words to hover over.
    pub fn hollow(&mut self, [x, y]: [f64; 2], radius: f64, color: &str, title: &str) {
        self.push(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"#ffffff\" stroke=\"{color}\" \
             stroke-width=\"1.6\"><title>{}</title></circle>",
            escaped(title)
        ));
    }

    /// A circle around something.
    pub fn ring(&mut self, [x, y]: [f64; 2], radius: f64, color: &str) {
        self.push(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.8\"/>"
        ));
    }

    /// Words at a point on their base line.
    pub fn text(&mut self, [x, y]: [f64; 2], words: &str, text: Text) {
        let Text { size, fill, weight, anchor, turned } = text;
        let turn = if turned == 0.0 {
            String::new()
        } else {
            format!(" transform=\"rotate({turned} {x:.1} {y:.1})\"")
        };
        self.push(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"{fill}\" font-weight=\"{weight}\" \
             text-anchor=\"{anchor}\"{turn}>{}</text>",
            escaped(words)
        ));
    }

    /// The finished document.
    pub fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

/// Words that may hold anything, as XML takes them.
pub fn escaped(words: &str) -> String {
    let mut escaped = String::with_capacity(words.len());
    for letter in words.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // XML has no way to say these.
            '\u{0}'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {
                escaped.push('\u{fffd}')
            }
            _ => escaped.push(letter),
        }
    }
    escaped
}
