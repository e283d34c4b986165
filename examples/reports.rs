//! Measures error against run time of three scenes and writes their figures to `docs/reports`:
//! `cargo run --release --example reports`

use rasterd::jobs::Renderer;
use rasterd::plan::FrameRequest;
use rasterd::report::{Options, Report, plot};
use rasterd::scene::gallery::{self, Piece};
use rasterd::scene::{NewScene, Scene, demo};
use rasterd::settings::Settings;
use serde_json::json;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Seconds for each scene.
const BUDGET: Duration = Duration::from_secs(240);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/reports");
    std::fs::create_dir_all(&folder)?;
    let renderer = Renderer::new(&Settings::default())?;
    let demo =
        NewScene { document: Some(demo::document()), files: Some(demo::files()), ..NewScene::default() };
    let scenes = [
        ("demo", Arc::new(demo.compile(renderer.limits())?)),
        ("soft shadows", of_gallery("pcf-pcss", &renderer)?),
        ("many triangles", Arc::new(many_triangles().compile(renderer.limits())?)),
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

/// 331,776 triangles: 144 balls on a floor under a low sun.
fn many_triangles() -> NewScene {
    let mut document = json!({
        "camera": { "position": [9, 7, 12], "target": [0, 0, 0], "fov_y_deg": 40 },
        "lights": { "sun": { "type": "directional", "direction": [-0.7, -1, -0.4], "shadow": { "filter": "hard" } } },
        "materials": { "even": { "diffuse": "#c96f4a" }, "odd": { "diffuse": "#4a7fc9" } },
        "meshes": {
            "ball": { "type": "sphere", "radius": 0.38, "segments": 48, "rings": 25 },
            "floor": { "type": "plane", "size": [14, 14] },
        },
        "instances": { "floor": { "mesh": "floor" } },
    });
    for i in 0..144 {
        let [x, z] = [i % 12, i / 12].map(|at| f64::from(at) - 5.5);
        let material = if (i % 12 + i / 12) % 2 == 0 { "even" } else { "odd" };
        document["instances"][format!("ball{i}")] =
            json!({ "mesh": "ball", "material": material, "translation": [x, 0.38, z] });
    }
    NewScene { document: Some(document), ..NewScene::default() }
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
