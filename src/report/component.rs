//! One component of the error at a time: what a knob alone does, against the truth of what it drives.
//!
//! Coverage is judged on flat colours, by what many samples make of them. Shadows are judged at the pixels' centres,
//! without textures and with one sample: there a shadow map is all that differs from a ray to the light.

use super::Failed;
use super::error::{Difference, Region, difference, premultiplied};
use super::fit::{Fit, Law, Metric};
use super::reference::{Aim, Effort, Reference};
use super::setting::{Knob, Setting};
use super::subject::{self, Subject};
use crate::model::{Material, Shading};
use crate::pipeline::Work;
use crate::plan::request::Preset;
use crate::plan::{Filter, FrameRequest, Plan};
use crate::scene::{Light, Scene};
use std::sync::Arc;
use std::time::Instant;

/// Taps at which a filter counts as converged: as many as a light may have.
const CONVERGED_TAPS: u32 = 1024;

/// Rays to a light, from the centre of each pixel in its penumbra.
const LIGHT_RAYS: u32 = 256;

/// Samples of a pixel at an edge.
const EDGE_SAMPLES: u32 = 256;

/// How far off a pixel's truth may be before it gets more samples.
const NOISE: f64 = 5e-4;

/// Pixels that have to be off at least, or their number is chance: of 24 it is off by a fifth.
const LEAST_WRONG: f64 = 24.0;

/// How much larger than the report the picture of shadows may be along a side: few pixels lie at their borders.
const MOST_ENLARGED: f64 = 4.0;

/// Pixels of the picture of shadows.
const MOST_PIXELS: f64 = (1 << 20) as f64;

/// The part of the time that is left which a truth may take: others come after it.
const TRUTH: f64 = 0.4;

/// The laws that the error of a frame's components should follow, in the order of `knobs`.
fn laws(plan: &Plan, knobs: &[Knob]) -> Vec<Law> {
    let law = |knob, metric, region, window| Law { knob, metric, region, window };
    let of = |knob: &Knob| match knob {
        Knob::Samples => vec![law(*knob, Metric::Rmse, Region::Edges, Some([-0.85, -0.55]))],
        // A soft shadow ends at what one layer of depth knows of its casters.
        Knob::ShadowResolution if is_soft(plan) => vec![law(*knob, Metric::Mae, Region::All, None)],
        Knob::ShadowResolution => vec![
            law(*knob, Metric::Mae, Region::All, Some([0.9, 1.1])),
            law(*knob, Metric::Rmse, Region::All, Some([0.45, 0.55])),
        ],
        Knob::PcfTaps => vec![law(*knob, Metric::Rmse, Region::All, Some([-0.9, -0.7]))],
        Knob::PcssTaps => vec![law(*knob, Metric::Rmse, Region::All, None)],
        Knob::RenderScale => vec![
            law(*knob, Metric::Mae, Region::All, Some([0.85, 1.15])),
            // Of a straight edge anywhere between pixels of 1, 4/3, 2 and 4, interpolated, against the part of each
            // pixel that it leaves: 0.289, 0.333, 0.456, 0.700, which is a power of 0.65. Half would be that of
            // pixels without interpolation.
            law(*knob, Metric::Rmse, Region::All, Some([0.55, 0.75])),
        ],
        Knob::TextureFilter => Vec::new(),
    };
    knobs.iter().flat_map(of).collect()
}

fn is_soft(plan: &Plan) -> bool {
    plan.shadows.iter().any(|pass| matches!(pass.filter, Filter::Pcss(_)))
}

/// A frame that shows one component alone, and its truth.
struct Judge {
    subject: Subject,
    truth: Reference,
    /// The pixels that are judged; `None`: all.
    judged: Option<Vec<bool>>,
}

/// Fits each law of the frame that `plan` draws of `subject` for which there is enough to see, until the time is up.
/// A sample of a reference takes `sample_seconds`.
///
/// # Errors
/// [`Failed`].
pub fn fit(
    subject: &Subject,
    plan: &Plan,
    knobs: &[Knob],
    until: Instant,
    sample_seconds: f64,
    work: &Work,
) -> Result<Vec<Fit>, Failed> {
    let mut judges = Judges { subject, plan, until, sample_seconds, coverage: None, shadows: None };
    let mut fits = Vec::new();
    for group in laws(plan, knobs).chunk_by(|a, b| a.knob == b.knob) {
        if !judges.has_time() {
            break;
        }
        let (errors, floor) = judges.errors(group[0].knob, work)?;
        fits.extend(group.iter().filter_map(|law| {
            let known = errors.iter().filter(|(_, error)| error.wrong >= LEAST_WRONG);
            let points: Vec<[f64; 2]> =
                known.map(|(number, error)| [*number, measured(error, law)]).collect();
            Fit::of(law, &points, floor)
        }));
    }
    Ok(fits)
}

/// The judges of a frame's components, each made when it is first asked.
struct Judges<'a> {
    subject: &'a Subject,
    plan: &'a Plan,
    /// When their truths have to do.
    until: Instant,
    sample_seconds: f64,
    /// Of flat colours, by many samples.
    coverage: Option<Judge>,
    /// Of surfaces without textures, at the pixels' centres.
    shadows: Option<Judge>,
}

impl Judges<'_> {
    /// The error of the knob's component at each of its values, and the error of what it is judged by.
    fn errors(&mut self, knob: Knob, work: &Work) -> Result<(Vec<(f64, Errors)>, f64), Failed> {
        let best = Setting { render_scale: 1.0, ..Setting::of_preset(Preset::Reference, self.plan) };
        let one = Setting { samples: 1, ..best };
        match knob {
            Knob::ShadowResolution | Knob::PcssTaps => {
                let settings = knob.turned(one, self.plan);
                self.shadows(&best, work)?.errors(knob, &settings, work)
            }
            Knob::PcfTaps => {
                let subject =
                    Subject { scene: without_textures(&self.subject.scene), ..self.subject.clone() };
                against_converged(&subject, one, &knob.turned(one, self.plan), work)
            }
            // A picture that is drawn larger has more than one sample a pixel: another law.
            Knob::RenderScale => {
                let settings = knob.turned(one, self.plan);
                let settings: Vec<Setting> = settings.into_iter().filter(|s| s.render_scale <= 1.0).collect();
                self.coverage(&best, work)?.errors(knob, &settings, work)
            }
            Knob::Samples | Knob::TextureFilter => {
                let settings = knob.turned(best, self.plan);
                self.coverage(&best, work)?.errors(knob, &settings, work)
            }
        }
    }

    fn coverage(&mut self, best: &Setting, work: &Work) -> Result<&Judge, Failed> {
        if self.coverage.is_none() {
            let request = FrameRequest { shading: Some(Shading::Unlit), ..self.subject.request.clone() };
            let scene = without_textures(&self.subject.scene);
            let effort = Effort { base: 4, most: EDGE_SAMPLES, noise: NOISE, aim: Aim::Pixel };
            let subject = Subject { scene, request, ..self.subject.clone() };
            self.coverage = Some(Judge::new(subject, best, effort, self.end_of_truth(), work)?);
        }
        Ok(self.coverage.as_ref().expect("made above"))
    }

    /// Whether the time suffices for the fewest samples of a truth.
    fn has_time(&self) -> bool {
        let pixels = f64::from(self.plan.size[0]) * f64::from(self.plan.size[1]);
        let left = self.until.saturating_duration_since(Instant::now());
        4.0 * pixels * self.sample_seconds < left.as_secs_f64()
    }

    /// When a truth that is begun now has to do.
    fn end_of_truth(&self) -> Instant {
        let now = Instant::now();
        now + self.until.saturating_duration_since(now).mul_f64(TRUTH)
    }

    /// The frame in the size at which shadows are judged: the largest that there is time for, but for soft ones,
    /// which have pixels enough at their borders.
    fn enlarged(&self) -> FrameRequest {
        if is_soft(self.plan) {
            return self.subject.request.clone();
        }
        let [width, height] = self.plan.size.map(f64::from);
        let time = self.end_of_truth().saturating_duration_since(Instant::now()).as_secs_f64();
        // Two samples of a pixel with shadows, and two without.
        let pixels = (time / (4.0 * self.sample_seconds)).min(MOST_PIXELS);
        let scale = (pixels / (width * height)).sqrt().clamp(1.0, MOST_ENLARGED);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few times a picture's side"
        )]
        let [width, height] = [width, height].map(|side| Some((side * scale).round() as u32));
        FrameRequest { width, height, ..self.subject.request.clone() }
    }

    fn shadows(&mut self, best: &Setting, work: &Work) -> Result<&Judge, Failed> {
        if self.shadows.is_none() {
            let most = if is_soft(self.plan) { LIGHT_RAYS } else { 2 };
            let effort = Effort { base: 2, most, noise: NOISE, aim: Aim::Centre };
            let scene = without_textures(&self.subject.scene);
            let subject = Subject { scene, request: self.enlarged(), ..self.subject.clone() };
            let until = self.end_of_truth();
            let judged = Some(seen_alike(&subject, best, until, work)?);
            self.shadows = Some(Judge { judged, ..Judge::new(subject, best, effort, until, work)? });
        }
        Ok(self.shadows.as_ref().expect("made above"))
    }
}

impl Judge {
    fn new(
        subject: Subject,
        best: &Setting,
        effort: Effort,
        until: Instant,
        work: &Work,
    ) -> Result<Self, Failed> {
        let plan = subject.plan(best)?;
        let seen = subject::of_reference(&plan);
        let truth = Reference::draw_until(&seen, effort, Some(until), &|_| {}, work)?;
        Ok(Self { subject, truth, judged: None })
    }

    /// The errors of `settings`, and the truth's own.
    fn errors(
        &self,
        knob: Knob,
        settings: &[Setting],
        work: &Work,
    ) -> Result<(Vec<(f64, Errors)>, f64), Failed> {
        let error = |setting: &Setting| -> Result<(f64, Errors), Failed> {
            let radiance = self.subject.radiance(setting, work)?;
            let all = difference(&radiance, &self.truth.radiance, self.judged.as_deref());
            let errors = Errors {
                all,
                wrong: wrong_pixels(&all, radiance.len()),
                edges: difference(&radiance, &self.truth.radiance, Some(&self.truth.masks.edges)),
            };
            Ok((knob.number(setting).expect("only knobs with numbers have laws"), errors))
        };
        Ok((settings.iter().map(error).collect::<Result<_, _>>()?, self.truth.noise))
    }
}

/// Pixels whose centre shows the same, but for shadows, as a ray through it finds. Where an edge passes within the
/// 1/512 of a pixel that corners are snapped by it may not, and whether another surface is in shadow says nothing
/// about a shadow map.
fn seen_alike(subject: &Subject, best: &Setting, until: Instant, work: &Work) -> Result<Vec<bool>, Failed> {
    let one = Setting { samples: 1, ..*best };
    let subject = Subject { scene: without_shadows(&subject.scene), ..subject.clone() };
    let effort = Effort { base: 2, most: 2, noise: 0.0, aim: Aim::Centre };
    let judge = Judge::new(subject, &one, effort, until, work)?;
    let radiance = judge.subject.radiance(&one, work)?;
    let is_alike = |(drawn, truth): (&[f32; 4], &[f64; 4])| {
        let drawn = premultiplied(drawn);
        drawn.iter().zip(truth).all(|(drawn, truth)| (drawn - truth).abs() <= 1.0 / 255.0)
    };
    Ok(radiance.iter().zip(&judge.truth.radiance).map(is_alike).collect())
}

fn without_shadows(scene: &Scene) -> Arc<Scene> {
    let lights = scene.lights.iter().map(|light| Light { shadow: None, ..light.clone() }).collect();
    Arc::new(Scene { lights, ..scene.clone() })
}

/// What few taps differ by from so many that more would change nothing, of the same map.
fn against_converged(
    subject: &Subject,
    one: Setting,
    settings: &[Setting],
    work: &Work,
) -> Result<(Vec<(f64, Errors)>, f64), Failed> {
    let converged = subject.radiance(&Setting { pcf_taps: Some(CONVERGED_TAPS), ..one }, work)?;
    let converged: Vec<[f64; 4]> = converged.iter().map(premultiplied).collect();
    let error = |setting: &Setting| -> Result<(f64, Errors), Failed> {
        let all = difference(&subject.radiance(setting, work)?, &converged, None);
        let number = Knob::PcfTaps.number(setting).expect("taps are a number");
        Ok((number, Errors { all, wrong: f64::INFINITY, edges: Difference::default() }))
    };
    Ok((settings.iter().map(error).collect::<Result<_, _>>()?, 0.0))
}

/// What laws are about.
struct Errors {
    all: Difference,
    /// How many pixels are off, where they are few: at the borders of shadows.
    wrong: f64,
    edges: Difference,
}

/// How many of `count` pixels are off, if all that are off are so by as much.
#[expect(clippy::cast_precision_loss, reason = "pixels of a picture")]
fn wrong_pixels(difference: &Difference, count: usize) -> f64 {
    if difference.rmse == 0.0 { 0.0 } else { (difference.mae / difference.rmse).powi(2) * count as f64 }
}

fn measured(errors: &Errors, law: &Law) -> f64 {
    let within = if law.region == Region::Edges { &errors.edges } else { &errors.all };
    match law.metric {
        Metric::Rmse => within.rmse,
        Metric::Mae => within.mae,
    }
}

/// The scene with the factors of its materials alone; what is seen through keeps the maps that say so.
fn without_textures(scene: &Scene) -> Arc<Scene> {
    let plain = |material: &Arc<Material>| {
        let is_opaque = material.diffuse_map.as_ref().is_none_or(|map| map.least[3] == u8::MAX);
        Arc::new(Material {
            diffuse_map: material.diffuse_map.clone().filter(|_| !is_opaque),
            specular_map: None,
            emissive_map: None,
            normal_map: None,
            bump_map: None,
            ..Material::clone(material)
        })
    };
    Arc::new(Scene { materials: scene.materials.iter().map(plain).collect(), ..scene.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::report::selftest::instruments::draw;
    use crate::scene::{Files, demo};
    use serde_json::{Value, json};
    use std::time::Duration;

    /// The fits of a scene at some knobs, none of which may lie outside of its window. Returns how many have one.
    fn held(document: &Value, files: &Files, width: u32, knobs: &[Knob]) -> usize {
        let request =
            FrameRequest { width: Some(width), height: Some(width * 3 / 4), ..FrameRequest::default() };
        let scene = draw::scene_with(document, files);
        let plan = draw::plan(&scene, &request);
        let subject = Subject { scene, request, limits: Limits::default() };
        let until = Instant::now() + Duration::from_secs(600);
        // Slow enough that no picture is enlarged, and fast enough that all are drawn.
        let sample_seconds = 2e-4;
        let fits = fit(&subject, &plan, knobs, until, sample_seconds, &draw::work()).expect("nobody cancels");
        for fit in &fits {
            println!(
                "{:?} of {:?}: {:.3} ± {:.3}, {:?}",
                fit.metric, fit.knob, fit.slope, fit.se, fit.points
            );
            assert_ne!(fit.pass, Some(false), "{fit:?}");
        }
        fits.iter().filter(|fit| fit.pass.is_some()).count()
    }

    #[test]
    fn the_demo_keeps_the_laws() {
        let (document, files) = (demo::document(), demo::files());
        assert_eq!(held(&document, &files, 320, &[Knob::Samples, Knob::RenderScale]), 3);
        assert_eq!(held(&document, &files, 800, &[Knob::ShadowResolution]), 2);
    }

    #[test]
    fn filtered_shadows_keep_the_laws() {
        let document = json!({
            "camera": { "position": [2, 1.5, 3], "target": [0, 0.3, 0] },
            "lights": { "sun": { "type": "directional", "direction": [-0.5, -1, -0.3], "shadow": { "filter": "pcf" } } },
            "meshes": { "floor": { "type": "plane", "size": [6, 6] }, "box": { "type": "box" } },
            "instances": { "floor": { "mesh": "floor" }, "box": { "mesh": "box", "translation": [0, 0.5, 0], "rotation_deg": [0, 25, 0] } },
        });
        assert_eq!(held(&document, &Files::default(), 800, &[Knob::ShadowResolution, Knob::PcfTaps]), 3);
    }
}
