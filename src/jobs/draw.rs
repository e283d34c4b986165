//! The stages after the request: plan → pipeline → encode, for every frame of a product.

use super::product::{FileTag, Product, Rendered};
use super::shift::Shift;
use super::{Engine, JobError};
use crate::encode::{self, Animation, Format, Zip};
use crate::metrics::FrameKind;
use crate::pipeline::{Cancelled, Frame, Work};
use crate::plan::{FrameRequest, Output, Plan, Tally};
use crate::scene::Scene;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Draws a frame for each plan.
pub type Draw = dyn Fn(&[Plan], &Work<'_>) -> Result<Vec<Frame>, Cancelled> + Send + Sync;

/// A whole turn of a turntable, in hundredths of a second: slow enough to look at a model, and 36 frames
/// still flow.
const TURN_CS: u32 = 250;

/// The shortest time that browsers show a frame of a GIF; what is below counts as ten times that.
const SHORTEST_DELAY_CS: u32 = 2;

/// Makes a product, one frame after another; between them, `shift` lets other jobs have their turn.
pub(super) fn make(
    engine: &Engine,
    scene: &Arc<Scene>,
    request: &FrameRequest,
    product: &Product,
    work: Work<'_>,
    shift: Option<&mut Shift>,
) -> Result<Rendered, JobError> {
    let requests = product.requests(scene, request, &engine.limits)?;
    let mut making = Making::new(engine, scene, product, work, shift);
    let bytes = match product {
        Product::Still(format) => {
            let frame = making.frame(&requests[0])?;
            encode::still(&frame, *format, &work)?
        }
        Product::Turntable { frames, format: Animation::Apng } => {
            encode::apng(requests.iter().map(|side| making.frame(side)), *frames, delay_cs(*frames))?
        }
        Product::Turntable { frames, format: Animation::Gif } => {
            let sides: Vec<Frame> =
                requests.iter().map(|side| making.frame(side)).collect::<Result<_, JobError>>()?;
            making.begin_last_step();
            encode::gif(&sides, delay_cs(*frames), &work)?
        }
        Product::Archive { outputs } => making.archive(&requests, outputs)?,
    };
    Ok(making.finish(bytes, product.content_type()))
}

/// A frame before it is encoded.
#[derive(Debug)]
pub(super) struct Drawn {
    pub frame: Frame,
    /// Milliseconds: `plan` and the passes.
    pub timings: Vec<(&'static str, f64)>,
    /// Counts, by the names of `Render-Stats`.
    pub stats: Vec<(&'static str, u64)>,
    /// What was done, and what elisions spared.
    pub tally: Tally,
}

/// The part of [`make`] before the encoding, for a stream.
pub(super) fn draw_one(
    engine: &Engine,
    scene: &Arc<Scene>,
    request: &FrameRequest,
    format: Format,
    work: Work<'_>,
) -> Result<Drawn, JobError> {
    let product = Product::Still(format);
    let requests = product.requests(scene, request, &engine.limits)?;
    let mut making = Making::new(engine, scene, &product, work, None);
    making.kind = FrameKind::Stream;
    let frame = making.frame(&requests[0])?;
    let mut timings = vec![("plan", milliseconds(making.planning))];
    timings.extend(making.passes);
    Ok(Drawn { frame, timings, stats: making.stats, tally: making.tally })
}

/// The tag of what [`make`] makes, without making it.
pub(super) fn etag(
    engine: &Engine,
    scene: &Arc<Scene>,
    request: &FrameRequest,
    product: &Product,
    work: Work<'_>,
) -> Result<String, JobError> {
    let requests = product.requests(scene, request, &engine.limits)?;
    let mut tag = FileTag::new(product);
    let mut depth_range = None;
    for request in &requests {
        work.check()?;
        let outline = Plan::outline(scene, request, &engine.limits)?;
        tag.add(&outline);
        depth_range = depth_range.or(outline.depth_range);
    }
    if let Product::Archive { outputs } = product {
        let outline = Plan::outline(scene, &requests[0], &engine.limits)?;
        tag.add_description(&encode::frame_json(&outline, outputs, depth_range));
    }
    Ok(tag.finish())
}

/// How long each of `frames` is shown.
fn delay_cs(frames: u32) -> u16 {
    let delay = (TURN_CS + frames / 2) / frames.max(1);
    u16::try_from(delay.max(SHORTEST_DELAY_CS)).expect("at most a whole turn")
}

/// A product in the making: what it is drawn with, and what it has cost so far.
struct Making<'a> {
    engine: &'a Engine,
    scene: &'a Arc<Scene>,
    product: &'a Product,
    work: Work<'a>,
    shift: Option<&'a mut Shift>,
    kind: FrameKind,
    frames: u32,
    began: Instant,
    waiting: Duration,
    planning: Duration,
    drawing: Duration,
    size: [u32; 2],
    depth_range: Option<[f64; 2]>,
    tag: FileTag,
    passes: Vec<(&'static str, f64)>,
    stats: Vec<(&'static str, u64)>,
    tally: Tally,
}

impl<'a> Making<'a> {
    fn new(
        engine: &'a Engine,
        scene: &'a Arc<Scene>,
        product: &'a Product,
        work: Work<'a>,
        shift: Option<&'a mut Shift>,
    ) -> Self {
        Self {
            engine,
            scene,
            product,
            work,
            shift,
            kind: FrameKind::Frame,
            frames: 0,
            began: Instant::now(),
            waiting: Duration::ZERO,
            planning: Duration::ZERO,
            drawing: Duration::ZERO,
            size: [0; 2],
            depth_range: None,
            tag: FileTag::new(product),
            passes: Vec::new(),
            stats: Vec::new(),
            tally: Tally::default(),
        }
    }

    /// Plans and draws one frame.
    fn frame(&mut self, request: &FrameRequest) -> Result<Frame, JobError> {
        self.wait_for_turn()?;
        let plan = [self.plan(request)?];
        self.product.check_memory(self.scene, request, &plan, &self.engine.limits)?;
        let frames = self.draw(&plan)?;
        Ok(frames.into_iter().next().expect("a frame for each plan"))
    }

    /// The first frame is drawn in the turn that the job came with.
    fn wait_for_turn(&mut self) -> Result<(), JobError> {
        self.frames += 1;
        if let Some(shift) = self.shift.as_mut().filter(|_| self.frames > 1) {
            let began = Instant::now();
            shift.next_frame()?;
            self.waiting += began.elapsed();
            self.work.check()?;
        }
        Ok(())
    }

    /// What is left to do has the time of a frame.
    fn begin_last_step(&mut self) {
        if let Some(shift) = &self.shift {
            shift.last_step();
        }
    }

    fn plan(&mut self, request: &FrameRequest) -> Result<Plan, JobError> {
        let began = Instant::now();
        let plan = self.engine.plan(self.scene, request)?;
        let planning = began.elapsed();
        self.planning += planning;
        self.engine.metrics.observe_passes([("plan", milliseconds(planning))]);
        self.tag.add(&plan);
        self.size = plan.size;
        self.depth_range = self.depth_range.or(plan.depth_range);
        Ok(plan)
    }

    fn draw(&mut self, plans: &[Plan]) -> Result<Vec<Frame>, JobError> {
        let began = Instant::now();
        let frames = (self.engine.draw)(plans, &self.work)?;
        self.drawing += began.elapsed();
        self.engine.metrics.frames_rendered(self.kind).inc();
        for frame in &frames {
            self.engine.metrics.observe_passes(frame.timings.iter());
            frame.timings.iter().for_each(|(pass, ms)| *entry(&mut self.passes, pass) += ms);
            frame.stats.entries().iter().for_each(|(name, count)| *entry(&mut self.stats, name) += count);
            self.engine.metrics.count_work(&frame.stats.tally);
            self.tally.add(&frame.stats.tally);
        }
        Ok(frames)
    }

    /// Pictures of one frame under the names of their outputs, and `frame.json`.
    fn archive(&mut self, requests: &[FrameRequest], outputs: &[Output]) -> Result<Vec<u8>, JobError> {
        let plans: Vec<Plan> =
            requests.iter().map(|request| self.plan(request)).collect::<Result<_, JobError>>()?;
        self.product.check_memory(self.scene, &requests[0], &plans, &self.engine.limits)?;
        let description = encode::frame_json(&plans[0], outputs, self.depth_range);
        self.tag.add_description(&description);
        let frames = self.draw(&plans)?;
        let mut archive = Zip::default();
        for (frame, output) in frames.iter().zip(outputs) {
            archive.add(&format!("{}.png", output.word()), &encode::png(frame));
        }
        archive.add("frame.json", &description);
        Ok(archive.finish())
    }

    /// The finished product. What was neither planning nor drawing was encoding; waiting is told apart.
    fn finish(self, bytes: Vec<u8>, content_type: &'static str) -> Rendered {
        let total = self.began.elapsed().saturating_sub(self.waiting);
        let encoding = total.saturating_sub(self.planning).saturating_sub(self.drawing);
        let mut timings = vec![("plan", milliseconds(self.planning))];
        timings.extend(self.passes);
        self.engine.metrics.observe_passes([("encode", milliseconds(encoding))]);
        timings.extend([("encode", milliseconds(encoding)), ("total", milliseconds(total))]);
        Rendered {
            bytes: bytes.into(),
            content_type,
            etag: self.tag.finish(),
            width: self.size[0],
            height: self.size[1],
            depth_range: self.depth_range,
            stats: self.stats,
            timings,
        }
    }
}

/// The value of `name`, a new one at the end if there is none.
fn entry<'a, T: Default>(entries: &'a mut Vec<(&'static str, T)>, name: &'static str) -> &'a mut T {
    let at = entries.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
        entries.push((name, T::default()));
        entries.len() - 1
    });
    &mut entries[at].1
}

pub(super) fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_takes_two_and_a_half_seconds_or_what_browsers_need() {
        assert_eq!(delay_cs(1), 250);
        assert_eq!(delay_cs(36), 7);
        assert_eq!(delay_cs(100), 3);
        assert_eq!(delay_cs(360), 2);
    }
}
