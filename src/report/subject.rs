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

    /// The frame at `setting`: its linear light before post, and its finished pixels.
    ///
    /// # Errors
    /// [`Failed`].
    pub fn draw(&self, setting: &Setting, work: &Work) -> Result<(Vec<[f32; 4]>, Frame), Failed> {
        let plans = [self.plan(setting)?, self.showing(setting, Output::Radiance)?];
        let mut frames = pipeline::render_each(&plans, work)?.into_iter();
        let (finished, radiance) = (frames.next(), frames.next());
        Ok((floats(radiance.expect("two plans")), finished.expect("two plans")))
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
