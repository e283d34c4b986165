//! What a setting should cost and err by, before anything is measured.
//!
//! A model, no more: work counted from the plan, at rates that were measured once on other scenes. A report on the
//! scene takes its place.

use super::setting::Setting;
use crate::model::texture;
use crate::plan::{Face, Filter, Item, Plan, ShadowPass};

/// Kinds of work, and the nanoseconds that one thread takes for a unit of each.
///
/// `cargo run --release --example cost_rates` measures them: those here are of an x86-64 core with AVX-512, on which the
/// model says the milliseconds of the median frame, and between 0.4 and 1.9 of them in 9 of 10. What the scenes of the
/// demo and the gallery do not tell apart has a rate of 0: where there are lights there are shadows or textures.
pub const RATES: [(&str, f64); KINDS] = [
    ("triangles in the view", 96.0),
    ("triangles in shadow maps", 720.0),
    ("texels of shadow maps", 0.73),
    ("drawn pixels", 0.0),
    ("samples of drawn pixels", 9.0),
    ("lights at drawn pixels", 0.0),
    ("shadows at drawn pixels", 54.0),
    ("taps at drawn pixels", 2.4),
    ("textures at drawn pixels", 46.0),
    ("passes over drawn pixels", 26.0),
    ("resampled pixels", 32.0),
];

/// How many kinds of work there are.
pub const KINDS: usize = 11;

/// How much of the threads' time is work: two were 1.84 to 1.91 times as fast as one in the reports of `docs/reports`.
const PARALLEL: f64 = 0.85;

/// What is to be expected of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Root mean square error of linear light in 0–1.
    pub error: f64,
    /// Milliseconds, from the request to the last pixel.
    pub ms: f64,
}

/// What the picture of `plan` should cost and err by at `setting` on `threads`.
#[must_use]
pub fn expected(setting: &Setting, plan: &Plan, threads: usize) -> Estimate {
    #[expect(clippy::cast_precision_loss, reason = "a count of threads")]
    let speed = 1.0 + PARALLEL * (threads as f64 - 1.0);
    Estimate { error: error(setting, plan), ms: nanoseconds(setting, plan) * 1e-6 / speed }
}

fn nanoseconds(setting: &Setting, plan: &Plan) -> f64 {
    RATES.iter().zip(amounts(setting, plan)).map(|((_, rate), amount)| rate * amount).sum()
}

/// How much of each kind of work the picture of `plan` takes at `setting`.
#[expect(clippy::cast_precision_loss, reason = "counts of an estimate")]
#[must_use]
pub fn amounts(setting: &Setting, plan: &Plan) -> [f64; KINDS] {
    let finished = f64::from(plan.size[0]) * f64::from(plan.size[1]);
    let drawn = finished * setting.render_scale * setting.render_scale;
    let triangles = |items: &[Item]| items.iter().map(|item| item.mesh.triangles.len()).sum::<usize>() as f64;
    let faces = || plan.shadows.iter().flat_map(|pass| pass.faces());
    let texels = |face: &Face| f64::from(setting.shadow_resolution.unwrap_or(face.view.width)).powi(2);
    let textures = plan.draws.iter().map(|draw| draw.surface.maps().count()).max().unwrap_or(0);
    [
        triangles(&plan.items),
        faces().map(|face| triangles(&face.items)).sum(),
        faces().map(texels).sum(),
        drawn,
        drawn * f64::from(setting.samples),
        drawn * plan.lights.len() as f64,
        drawn * plan.shadows.len() as f64,
        drawn * plan.shadows.iter().map(|pass| taps(setting, &pass.filter)).sum::<f64>(),
        drawn * textures as f64,
        drawn * plan.post.passes.len() as f64,
        if setting.render_scale == 1.0 { 0.0 } else { finished },
    ]
}

fn taps(setting: &Setting, filter: &Filter) -> f64 {
    let taps = match filter {
        Filter::Hard => 0,
        Filter::Pcf { taps, .. } => setting.pcf_taps.unwrap_or(*taps),
        Filter::Pcss(pcss) => {
            let [search, filter] = setting.pcss_taps.unwrap_or([pcss.search_taps, pcss.filter_taps]);
            search + filter
        }
    };
    f64::from(taps)
}

/// Root of the sum of the squares of what each knob adds: within a factor of 2.5 of what the reports in `docs/reports`
/// measured of presets.
fn error(setting: &Setting, plan: &Plan) -> f64 {
    let pixel = 1.0 / setting.render_scale;
    let coverage = 0.03 * f64::from(setting.samples).powf(-0.65) * pixel.sqrt();
    let blur = if pixel > 1.0 { 0.03 * (pixel - 1.0).sqrt() } else { 0.0 };
    let shadow = |pass: &ShadowPass| {
        let own = pass.faces().first().map_or(1024, |face| face.view.width);
        let side = f64::from(setting.shadow_resolution.unwrap_or(own));
        let noise = match taps(setting, &pass.filter) {
            0.0 => 0.0,
            taps => 0.02 * taps.powf(-0.8),
        };
        let edge = 0.01 * (512.0 / side).sqrt();
        edge * edge + noise * noise
    };
    let filter = match setting.texture_filter {
        Some(texture::Filter::Nearest) => 0.03,
        Some(texture::Filter::Bilinear) => 0.02,
        Some(texture::Filter::Trilinear) | None => 0.016,
    };
    let textured = plan.draws.iter().any(|draw| draw.surface.maps().next().is_some());
    let texture = if textured { filter * pixel.sqrt() } else { 0.0 };
    let shadows: f64 = plan.shadows.iter().map(shadow).sum();
    (coverage * coverage + blur * blur + shadows + texture * texture).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::plan::FrameRequest;
    use crate::plan::request::Preset;
    use crate::scene::{NewScene, demo};
    use std::sync::Arc;

    #[test]
    fn presets_cost_more_and_err_less_from_one_to_the_next() {
        let new =
            NewScene { document: Some(demo::document()), files: Some(demo::files()), ..NewScene::default() };
        let scene = Arc::new(new.compile(&Limits::default()).expect("a sound scene"));
        let plan = Plan::new(&scene, &FrameRequest::default(), &Limits::default()).expect("a plan");
        let of = |preset, threads| expected(&Setting::of_preset(preset, &plan), &plan, threads);
        let estimates = Preset::WORDS.map(|(_, preset)| of(preset, 2));
        assert!(estimates.windows(2).all(|pair| pair[0].ms < pair[1].ms), "{estimates:?}");
        assert!(estimates.windows(2).all(|pair| pair[0].error > pair[1].error), "{estimates:?}");
        assert!(of(Preset::Normal, 8).ms < estimates[1].ms / 2.0);
    }
}
