//! `rasterd report`

use super::Failure;
use super::frame_flags::FrameFlags;
use super::source::Source;
use rasterd::http::Problem;
use rasterd::plan::FrameRequest;
use rasterd::plan::request::Query;
use rasterd::report::{Knob, Options, Progress, Report as Measured, Stage, html, plot};
use rasterd::settings::Machine;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The arguments of `rasterd report`.
#[derive(Debug, clap::Args)]
pub(super) struct Report {
    #[command(flatten)]
    source: Source,

    /// The file to write, of the kind that its ending says: .svg, .html or .json; given more than once, each
    #[arg(short, long, value_name = "OUT", required = true)]
    out: Vec<PathBuf>,

    /// Seconds that it may take
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = budget)]
    budget_s: Duration,

    /// What is turned, with commas between: samples, shadow_resolution, pcf_taps, pcss_taps, render_scale,
    /// texture_filter [default: all that the scene has]
    #[arg(long, value_name = "KNOBS", value_parser = knobs)]
    knobs: Option<Knobs>,

    /// Run the catalogue of stiff cases too, as selftest does, and put its table into the report
    #[arg(long)]
    selftest: bool,

    #[command(flatten)]
    frame: FrameFlags,

    #[command(flatten)]
    machine: Machine,
}

/// Some knobs; a type of its own, since to clap a list is a flag given more than once.
#[derive(Clone, Debug)]
struct Knobs(Vec<Knob>);

fn knobs(text: &str) -> Result<Knobs, String> {
    Knob::list(text).map(Knobs)
}

fn budget(text: &str) -> Result<Duration, String> {
    Options::budget(text)
}

impl Report {
    /// Files → scene → report → files.
    pub(super) fn run(self) -> Result<(), Failure> {
        self.out.iter().try_for_each(|path| check_folder(path))?;
        let writers: Vec<Writer> = self.out.iter().map(|path| writer(path)).collect::<Result<_, _>>()?;
        let request = self.request()?;
        let (renderer, scene) = self.source.open(self.machine.clone())?;
        let options = Options {
            name: self.source.name(),
            budget: self.budget_s,
            knobs: self.knobs.clone().map_or_else(Vec::new, |knobs| knobs.0),
            width: request.width.unwrap_or(Options::default().width),
            selftest: self.selftest,
            ..Options::default()
        };
        let (request, _) = renderer.to_budget_now(&scene, request)?;
        let report = renderer.report_now(&scene, &request, &options, &show)?;
        clear();
        for (path, write) in self.out.iter().zip(writers) {
            std::fs::write(path, write(&report)).map_err(|error| Failure::new(path.display(), error))?;
        }
        name_failed_laws(&report);
        check(&report)
    }

    /// The frame that it is about, by the reader of the server's query.
    fn request(&self) -> Result<FrameRequest, Problem> {
        let mut query = Query::new(self.frame.pairs());
        let request = FrameRequest::read(&mut query);
        query.finish().map_err(|faults| Problem::query(&faults))?;
        Ok(request)
    }
}

/// Whether there is a folder to write to: a report takes a while, and would be lost.
fn check_folder(path: &Path) -> Result<(), Failure> {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            Err(Failure::new(path.display(), "there is no such folder"))
        }
        _ => Ok(()),
    }
}

/// Makes a file of a report.
type Writer = fn(&Measured) -> String;

/// That for the ending of `path`.
fn writer(path: &Path) -> Result<Writer, Failure> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Ok(plot::svg),
        Some("html") => Ok(html::page),
        Some("json") => Ok(Measured::json),
        _ => Err(Failure::new(path.display(), "a report is written as .svg, .html or .json")),
    }
}

/// Says which slopes lie outside of their windows: a sign of a fault, or of details as small as a pixel.
fn name_failed_laws(report: &Measured) {
    for fit in report.fits.iter().filter(|fit| fit.pass == Some(false)) {
        let [least, most] = fit.window.unwrap_or_default();
        eprintln!(
            "note: {} of {}: slope {:.2} ± {:.2}, expected {least} to {most}",
            fit.metric.word(),
            fit.knob.word(),
            fit.slope,
            fit.se
        );
    }
}

/// A report whose frames differ, or with a case that is out of its bound, is a failed check.
fn check(report: &Measured) -> Result<(), Failure> {
    if let Some(way) = report.determinism.differing.first() {
        return Err(Failure::new("determinism", format_args!("another picture with {way}")));
    }
    match report.stability.iter().find(|row| row.is_out()) {
        Some(row) => Err(Failure::new(row.case, format_args!("{} is out of its bound", row.metric))),
        None => Ok(()),
    }
}

/// Cells of the bar.
const CELLS: u32 = 30;

/// Shows how far the report is, on a terminal.
fn show(progress: Progress) {
    let mut stderr = std::io::stderr().lock();
    if stderr.is_terminal() {
        let what = match progress.stage {
            Stage::Reference => "drawing the reference",
            Stage::Errors => "measuring errors",
            Stage::Components => "fitting laws",
            Stage::Timing => "timing",
            Stage::Ways => "drawing in other ways",
            Stage::Stability => "running the stiff cases",
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a few cells")]
        let full = (progress.done.clamp(0.0, 1.0) * f64::from(CELLS)) as u32;
        let bar: String = (0..CELLS).map(|cell| if cell < full { '█' } else { '░' }).collect();
        let _ = write!(stderr, "\r{bar} {:3.0} %  {what:<24}", progress.done * 100.0);
    }
}

/// Takes the bar away.
fn clear() {
    let mut stderr = std::io::stderr().lock();
    if stderr.is_terminal() {
        let _ = write!(stderr, "\r\x1b[2K");
    }
}
