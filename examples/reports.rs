//! Measures error against run time of three scenes and writes their figures to `docs/reports`:
//! `cargo run --release --example reports`

use rasterd::jobs::Renderer;
use rasterd::plan::FrameRequest;
use rasterd::report::{Options, Report, plot};
use rasterd::scene::gallery::{self, Piece};
use rasterd::scene::{NewScene, Scene, demo};
use rasterd::settings::Settings;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Seconds for each scene.
const BUDGET: Duration = Duration::from_secs(150);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/reports");
    std::fs::create_dir_all(&folder)?;
    let renderer = Renderer::new(&Settings::default())?;
    let demo =
        NewScene { document: Some(demo::document()), files: Some(demo::files()), ..NewScene::default() };
    let scenes = [
        ("demo", Arc::new(demo.compile(renderer.limits())?)),
        ("soft shadows", of_gallery("pcf-pcss", &renderer)?),
        ("many triangles", of_gallery("triangles", &renderer)?),
    ];
    for (name, scene) in scenes {
        let report = measure(name, &scene, &renderer)?;
        let file = name.replace(' ', "-");
        std::fs::write(folder.join(format!("{file}.svg")), plot::svg(&report))?;
        std::fs::write(folder.join(format!("{file}.json")), report.json())?;
        say(name, &report);
    }
    Ok(())
}

fn of_gallery(name: &str, renderer: &Renderer) -> Result<Arc<Scene>, Box<dyn Error>> {
    let piece: &Piece = gallery::find(name)?;
    Ok(Arc::new(piece.to_scene().compile(renderer.limits())?))
}

fn measure(name: &str, scene: &Arc<Scene>, renderer: &Renderer) -> Result<Report, Box<dyn Error>> {
    let options = Options { name: name.to_owned(), budget: BUDGET, rounds: 30, ..Options::default() };
    let report = renderer.report_now(scene, &FrameRequest::default(), &options, &|_| {})?;
    Ok(report)
}

/// The front in words.
fn say(name: &str, report: &Report) {
    println!(
        "{name}: {} settings, {} rounds, {:.0} s",
        report.points.len(),
        report.meta.rounds,
        report.meta.seconds
    );
    for [error, ms] in &report.front {
        println!("  RMSE {error:.5} in {ms:.2} ms");
    }
    for fit in &report.fits {
        let verdict = fit
            .pass
            .map_or("", |pass| if pass { ", as it should be" } else { ", which is not as it should be" });
        println!("  {:?} of {:?}: slope {:.2} ± {:.2}{verdict}", fit.metric, fit.knob, fit.slope, fit.se);
    }
}
