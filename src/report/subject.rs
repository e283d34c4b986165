//! What a report is about: one frame of a scene, drawn at any setting.

use super::Failed;
use super::reference;
use super::setting::Setting;
use crate::limits::Limits;
use crate::pipeline::{self, Frame, Pixels, Work};
use crate::plan::{FrameRequest, Output, Plan, PlanError};
use crate::scene::Scene;
use std::sync::Arc;

/// A frame of a scene, but for how much work goes into it.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Arc<Scene>,
    /// What each setting is put into.
    pub request: FrameRequest,
    /// What frames are held to.
    pub limits: Limits,
}

/// A finished frame, and what was done for it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// sRGB codes and straight alpha.
    pub bytes: Vec<[u8; 4]>,
    /// The short form of what was done, as a reply tells it.
    pub counters: Vec<(&'static str, u64)>,
    /// What was done, by its units.
    pub work: Vec<(&'static str, u64)>,
    /// What elisions spared, by their names.
    pub spared: Vec<(&'static str, u64)>,
}

impl Drawn {
    fn of(frame: Frame) -> Self {
        let Pixels::Rgba8 { pixels, .. } = frame.pixels else { unreachable!("colour is in bytes") };
        Self {
            bytes: pixels,
            counters: frame.stats.entries().to_vec(),
            work: frame.stats.tally.work().collect(),
            spared: frame.stats.tally.savings().collect(),
        }
    }
}

impl Subject {
    /// The plan of `setting`.
    ///
    /// # Errors
    /// Those of [`Plan::new`].
    pub fn plan(&self, setting: &Setting) -> Result<Plan, PlanError> {
        self.showing(setting, self.request.output)
    }

    fn showing(&self, setting: &Setting, output: Output) -> Result<Plan, PlanError> {
        let request = FrameRequest { output, ..setting.of_request(&self.request) };
        Plan::new(&self.scene, &request, &self.limits)
    }

    /// The frame at `setting`: its linear light before post, and it finished.
    ///
    /// # Errors
    /// [`Failed`].
    pub fn draw(&self, setting: &Setting, work: &Work) -> Result<(Vec<[f32; 4]>, Drawn), Failed> {
        let plans = [self.plan(setting)?, self.showing(setting, Output::Radiance)?];
        let mut frames = pipeline::render_each(&plans, work)?.into_iter();
        let (finished, radiance) = (frames.next(), frames.next());
        Ok((floats(radiance.expect("two plans")), Drawn::of(finished.expect("two plans"))))
    }

    /// The linear light of the frame at `setting`, before post.
    ///
    /// # Errors
    /// [`Failed`].
    pub fn radiance(&self, setting: &Setting, work: &Work) -> Result<Vec<[f32; 4]>, Failed> {
        Ok(floats(pipeline::render(&self.showing(setting, Output::Radiance)?, work)?))
    }
}

/// What the reference draws in place of `plan`.
#[must_use]
pub fn of_reference(plan: &Plan) -> reference::Subject<'_> {
    reference::Subject {
        scene: &plan.scene,
        camera: plan.camera,
        size: plan.size,
        t: plan.t,
        background: &plan.background,
        shading: plan.shading(),
    }
}

fn floats(frame: Frame) -> Vec<[f32; 4]> {
    let Pixels::Rgba32F { pixels, .. } = frame.pixels else { unreachable!("radiance is in floats") };
    pixels
}
