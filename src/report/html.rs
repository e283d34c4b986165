//! A report as a page: the figure, and the numbers behind it.

use super::plot::{self, svg::escaped};
use super::{Family, Point, Report};
use std::fmt::Write;

const HEAD: &str = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>\n\
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 1100px; padding: 0 1rem; color: #1a1a1a; background: #fff }\n\
svg { max-width: 100%; height: auto }\n\
.wide { overflow-x: auto }\n\
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px }\n\
th, td { padding: .2rem .7rem; text-align: right; border-bottom: 1px solid #e6e6e6; white-space: nowrap }\n\
th { font-weight: 600 } th:first-child, td:first-child { text-align: left }\n\
tr.front td { background: #eef6ee } tr.out td { background: #fbe9e7 }\n\
</style>\n";

/// The whole page.
#[must_use]
pub fn page(report: &Report) -> String {
    let mut page = String::from(HEAD);
    let name = escaped(&report.meta.name);
    page.push_str(&format!("<title>Error against run time: {name}</title>\n"));
    page.push_str(&plot::svg(report));
    reached(&mut page, report);
    settings(&mut page, report);
    parts(&mut page, report);
    stability(&mut page, report);
    notes(&mut page, report);
    page.push_str("</html>\n");
    page
}

/// Adds a table: a caption, heads, and rows with their class.
fn table(
    page: &mut String,
    caption: &str,
    heads: &[&str],
    rows: impl Iterator<Item = (&'static str, Vec<String>)>,
) {
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = String>| -> String {
        cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(&cell))).collect()
    };
    let heads = cells("th", &mut heads.iter().map(|head| (*head).to_owned()));
    let _ = write!(page, "<h2>{}</h2>\n<div class=\"wide\"><table>\n<tr>{heads}</tr>\n", escaped(caption));
    for (class, row) in rows {
        let _ = writeln!(page, "<tr class=\"{class}\">{}</tr>", cells("td", &mut row.into_iter()));
    }
    page.push_str("</table></div>\n");
}

fn reached(page: &mut String, report: &Report) {
    let rows = report.reach.iter().map(|reach| {
        let time = reach.ms.map_or_else(|| "not reached".to_owned(), |ms| format!("{ms:.2} ms"));
        ("", vec![format!("{:.4} ({:.0}/255)", reach.error, reach.error * 255.0), time])
    });
    table(page, "Time to reach an error, interpolated along the front", &["RMSE", "a frame takes"], rows);
    let rows = report.equal_time.iter().map(|at| {
        let error =
            at.error.map_or_else(|| "everything takes longer".to_owned(), |error| format!("{error:.5}"));
        ("", vec![format!("{} ms", at.ms), error])
    });
    table(page, "Error at equal time, interpolated along the front", &["time", "least RMSE"], rows);
}

fn settings(page: &mut String, report: &Report) {
    let heads = [
        "",
        "setting",
        "RMSE",
        "MAE",
        "p99",
        "max",
        "> 1/255",
        "PSNR",
        "SSIM",
        "FLIP",
        "ms",
        "p25–p75",
        "processor ms",
    ];
    let rows = report.points.iter().map(|point| (if point.pareto { "front" } else { "" }, row(point)));
    table(
        page,
        "Every setting that was measured; green: on the front, or not to be told from it by its interval",
        &heads,
        rows,
    );
}

/// What a setting is called by itself.
fn named(family: Family) -> Option<&'static str> {
    match family {
        Family::Default => Some("the scene as it is"),
        Family::Control => Some("the same once more"),
        Family::Preset(preset) => Some(preset.word()),
        Family::Knob(_) | Family::Mixed => None,
    }
}

fn row(point: &Point) -> Vec<String> {
    let knobs: Vec<String> =
        point.knobs.parameters().iter().map(|(name, value)| format!("{name} {value}")).collect();
    let (err, time) = (&point.err, &point.t);
    let near = if point.near_floor { " (near the reference's own)" } else { "" };
    vec![
        point.families.iter().filter_map(|family| named(*family)).collect::<Vec<_>>().join(", "),
        knobs.join(", "),
        format!("{:.5}{near}", err.clamped.rmse),
        format!("{:.5}", err.clamped.mae),
        format!("{:.4}", err.clamped.p99),
        format!("{:.3}", err.clamped.max),
        format!("{:.2} %", 100.0 * err.over_1),
        err.psnr.map_or_else(|| "same bytes".to_owned(), |psnr| format!("{psnr:.2} dB")),
        format!("{:.4}", err.ssim),
        err.flip.map_or_else(|| "–".to_owned(), |[mean, _]| format!("{mean:.4}")),
        format!("{:.2}", time.total.median),
        format!("{:.2}–{:.2}", time.total.p25, time.total.p75),
        time.cpu.map_or_else(|| "–".to_owned(), |ms| format!("{ms:.2}")),
    ]
}

fn parts(page: &mut String, report: &Report) {
    let Some(parts) = &report.parts else { return };
    let repaired = |at: usize| parts.repair_one.get(at).map_or(0.0, |(_, error)| *error);
    let rows = parts.degrade_one.iter().enumerate().map(|(at, (knob, error))| {
        ("", vec![knob.word().to_owned(), format!("{error:.5}"), format!("{:.5}", repaired(at))])
    });
    let heads = ["knob", "RMSE with the others at their best", "RMSE with this alone at its best"];
    table(page, "What the default's error is made of", &heads, rows);
    let verdict = if parts.independent {
        "add up to it within 20 %"
    } else {
        "do not add up to it: the parts depend on each other"
    };
    let _ = writeln!(
        page,
        "<p>The default's RMSE is {:.5}; with all of these at their best it is {:.5}. With what each knob of the first \
         column adds to that, {:.5}, the parts {verdict}.</p>",
        parts.total, parts.best, parts.sum
    );
}

fn stability(page: &mut String, report: &Report) {
    if report.stability.is_empty() {
        return;
    }
    let number = |value: f64| if value.is_finite() { format!("{value:.3e}") } else { "–".to_owned() };
    let rows = report.stability.iter().map(|row| {
        let margin = if row.margin.is_nan() { "–".to_owned() } else { format!("{:.2}", row.margin) };
        let cells = [row.case.to_owned(), row.metric.clone(), number(row.value), number(row.bound), margin];
        (if row.is_out() { "out" } else { "" }, cells.to_vec())
    });
    table(
        page,
        "Stiff and extreme cases, the worst margin first",
        &["case", "metric", "value", "bound", "margin"],
        rows,
    );
}

fn notes(page: &mut String, report: &Report) {
    let truth = &report.reference;
    let ratio = &report.aa_ratio;
    let mut lines = vec![
        format!(
            "The reference is a ray caster in f64: {:.0} samples a pixel in the mean, {} at most, its own error {:.1e}.",
            truth.mean_samples, truth.most_samples, truth.floor
        ),
        format!(
            "The default measured as two settings: ratio {:.3}, 95 % interval {:.3} to {:.3}. {}",
            ratio.median,
            ratio.ci[0],
            ratio.ci[1],
            match report.aa_holds {
                Some(true) =>
                    format!("Smaller differences than {:.1} % cannot be told.", 100.0 * ratio.resolution()),
                Some(false) => "It should hold 1: the machine was too busy to tell times by.".to_owned(),
                None => "There were too few rounds to tell times by.".to_owned(),
            }
        ),
        format!("The very first frame took {:.1} ms.", report.meta.cold_ms),
        format!("FLIP: {}.", report.meta.flip),
        same_bytes(report),
    ];
    lines.extend(report.threads.iter().map(|t| format!("{} threads: {:.2} ms.", t.threads, t.ms)));
    lines.extend(
        report.left_out.iter().map(|left| format!("{} was not turned: {}.", left.knob.word(), left.reason)),
    );
    if !report.unfinished.is_empty() {
        lines.push(
            "The budget ended before every setting was measured; a longer one measures more.".to_owned(),
        );
    }
    page.push_str("<h2>Notes</h2>\n<ul>\n");
    lines.iter().for_each(|line| page.push_str(&format!("<li>{}</li>\n", escaped(line))));
    page.push_str("</ul>\n");
}

fn same_bytes(report: &Report) -> String {
    let same = &report.determinism;
    let ways = same.matrix.len();
    if same.differing.is_empty() {
        format!(
            "Drawn in {ways} ways (threads, SIMD levels, orders of the tiles), the default gave the same bytes: {}.",
            same.hash
        )
    } else {
        format!("Of {ways} ways to draw the default, these gave other bytes: {}.", same.differing.join("; "))
    }
}
