//! Measurements as a table that people read.

use super::ledger::{Measurement, Outcome};

const HEAD: [&str; 6] = ["case", "metric", "value", "bound", "margin", "where"];

/// Lays measurements out in columns, in their order; a line each, below a head.
#[must_use]
pub fn table(rows: &[Measurement]) -> String {
    let mut lines = vec![HEAD.map(str::to_owned)];
    lines.extend(rows.iter().map(cells));
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3, 4, 5].map(width);
    let mut text = String::new();
    for [case, metric, value, bound, margin, place] in &lines {
        let [a, b, c, d, e, _] = widths;
        let line = format!("{case:a$}  {metric:b$}  {value:>c$}  {bound:>d$}  {margin:>e$}  {place}");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn cells(row: &Measurement) -> [String; 6] {
    let margin = match row.outcome {
        Outcome::Broken => "broken".to_owned(),
        Outcome::Reported => "reported".to_owned(),
        Outcome::NotOffered => "not offered".to_owned(),
        Outcome::Out => format!("{} OUT", number(row.margin)),
        Outcome::Holds => number(row.margin),
    };
    [row.case.to_owned(), row.metric.clone(), number(row.value), number(row.bound), margin, place(row)]
}

/// In which setting, of how many.
fn place(row: &Measurement) -> String {
    match (row.settings, row.setting.as_str()) {
        (1, setting) => setting.to_owned(),
        (settings, _) if row.margin == f64::INFINITY => format!("all {settings}"),
        (settings, "") => format!("of {settings}"),
        (settings, setting) => format!("{setting}, of {settings}"),
    }
}

/// Three digits; counts as they are.
fn number(value: f64) -> String {
    let size = value.abs();
    if value.is_nan() {
        String::new()
    } else if value == f64::INFINITY {
        "∞".to_owned()
    } else if value.fract() == 0.0 && size < 1e6 {
        format!("{value}")
    } else if !(1e-3..1e5).contains(&size) {
        format!("{value:.2e}")
    } else {
        let digits = if size < 10.0 { if size < 0.1 { 4 } else { 2 } } else { 1 };
        format!("{value:.digits$}")
    }
}
