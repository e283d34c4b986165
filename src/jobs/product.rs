//! What a job makes, and what a finished one carries.

use super::JobError;
use super::draw::milliseconds;
use crate::encode::{Animation, Format};
use crate::limits::{Limits, MAX_TURNTABLE_FRAMES};
use crate::plan::request::Query;
use crate::plan::{FrameRequest, Output, Plan, PlanError, QueryFault};
use crate::scene::Scene;
use bytes::Bytes;
use std::sync::Arc;
use std::time::Duration;

/// What a client wants to have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Product {
    /// One picture.
    Still(Format),
    /// A turn about the target, drawn from `frames` sides.
    Turntable {
        /// How many, 1–[`crate::limits::MAX_TURNTABLE_FRAMES`].
        frames: u32,
        /// Of the file.
        format: Animation,
    },
    /// A ZIP archive of several pictures of one frame, with a description.
    Archive {
        /// What they show.
        outputs: Vec<Output>,
    },
}

impl From<Format> for Product {
    fn from(format: Format) -> Self {
        Self::Still(format)
    }
}

/// Frames of a turntable where no number is asked for: ten degrees each.
const DEFAULT_TURNTABLE_FRAMES: u32 = 36;

impl Product {
    /// A turntable, out of a query that may hold other parameters too: `frames`.
    pub fn read_turntable(query: &mut Query, format: Animation) -> Self {
        let frames = query.integer_in("frames", 1..=MAX_TURNTABLE_FRAMES);
        Self::Turntable { frames: frames.unwrap_or(DEFAULT_TURNTABLE_FRAMES), format }
    }

    /// An archive, out of a query that may hold other parameters too: `outputs`, else all that show the
    /// scene.
    pub fn read_archive(query: &mut Query) -> Self {
        if query.text("output").is_some() {
            query.fault(
                "output",
                "is that of a single picture; an archive takes outputs, with commas between",
            );
        }
        Self::Archive { outputs: query.parsed("outputs", Output::list).unwrap_or_else(Output::of_the_scene) }
    }

    /// The file's media type.
    #[must_use]
    pub fn content_type(&self) -> &'static str {
        match self {
            Self::Still(format) => format.content_type(),
            Self::Turntable { format, .. } => format.content_type(),
            Self::Archive { .. } => "application/zip",
        }
    }

    /// As `request` has it: of its quality.
    pub(super) fn settled(self, request: &FrameRequest) -> Self {
        match self {
            Self::Still(format) => Self::Still(format.with_quality(request.quality)),
            other => other,
        }
    }

    /// Whether it is made of several frames, one after the other.
    pub(super) fn is_series(&self) -> bool {
        matches!(self, Self::Turntable { frames: 2.., .. })
    }

    /// What each of its frames asks for; at least one.
    ///
    /// # Errors
    /// [`JobError::Unfit`] and [`JobError::Plan`].
    pub(super) fn requests(
        &self,
        scene: &Arc<Scene>,
        request: &FrameRequest,
        limits: &Limits,
    ) -> Result<Vec<FrameRequest>, JobError> {
        PlanError::over_memory("memory of all frames", self.held_bytes(scene, request), limits)?;
        match self {
            Self::Still(format) => Ok(vec![showing(request, format.drawn_as(request.output)?)]),
            Self::Turntable { frames, format } => {
                format.check(request.output)?;
                let side = |i: u32| request.turned(360.0 * f64::from(i) / f64::from(*frames));
                let sides: Vec<_> = (0..*frames).map(side).collect();
                check_depth_ranges(scene, &sides, limits)?;
                Ok(sides)
            }
            Self::Archive { outputs } => Ok(outputs.iter().map(|output| showing(request, *output)).collect()),
        }
    }

    /// Bytes of the frames that it holds until they are a file.
    fn held_bytes(&self, scene: &Scene, request: &FrameRequest) -> u64 {
        let (frames, bytes) = match self {
            Self::Still(_) => (0, 0),
            // Pixels and indices.
            Self::Turntable { frames, format: Animation::Gif } => (u64::from(*frames), 5),
            // Encoded as it comes, in the worst case as large as it was.
            Self::Turntable { frames, format: Animation::Apng } => (u64::from(*frames), 4),
            // Pixels and files.
            Self::Archive { outputs } => (outputs.len() as u64, 8),
        };
        let side = |asked: Option<u32>, own: u32| u64::from(asked.unwrap_or(own));
        let width = side(request.width, scene.render.width);
        let height = side(request.height, scene.render.height);
        width.saturating_mul(height).saturating_mul(frames).saturating_mul(bytes)
    }

    /// Refuses more frames than fit the memory of one beside what `plans`, which are drawn together, take
    /// to be drawn: the triangles of each pass over them once, and all else of every frame, since those that
    /// share a look at the tiles are under way together.
    pub(super) fn check_memory(
        &self,
        scene: &Scene,
        request: &FrameRequest,
        plans: &[Plan],
        limits: &Limits,
    ) -> Result<(), PlanError> {
        let is_pass = |(at, plan): &(usize, &Plan)| {
            !plans[..*at].iter().any(|earlier| plan.shows_the_triangles_of(earlier))
        };
        let passes = plans.iter().enumerate().filter(is_pass);
        let geometry = passes.fold(0u64, |sum, (_, plan)| sum.saturating_add(plan.geometry_bytes()));
        let rests = plans.iter().map(|plan| plan.bytes() - plan.geometry_bytes());
        let rest = rests.fold(0u64, u64::saturating_add);
        let held = self.held_bytes(scene, request);
        let bytes = held.saturating_add(geometry).saturating_add(rest);
        PlanError::over_memory("memory of all frames", bytes, limits)
    }

    /// What tells its file from others of the same frames.
    fn kind(&self) -> String {
        match self {
            Self::Still(format) => format.tag(),
            Self::Turntable { format, .. } => format!("{format:?}"),
            Self::Archive { .. } => "zip".to_owned(),
        }
    }
}

/// A file has one range of depth, or its values could not be compared.
fn check_depth_ranges(scene: &Arc<Scene>, sides: &[FrameRequest], limits: &Limits) -> Result<(), PlanError> {
    let mut first = None;
    for side in sides.iter().filter(|side| side.output == Output::Depth) {
        let range = Plan::outline(scene, side, limits)?.depth_range;
        if *first.get_or_insert(range) != range {
            let detail = "must be given for a turntable of depth, here or in the scene's camera: \
                          without it every side has a range of its own";
            return Err(PlanError::Query(vec![QueryFault::new("far", detail)]));
        }
    }
    Ok(())
}

/// The same frame with another output.
fn showing(request: &FrameRequest, output: Output) -> FrameRequest {
    FrameRequest { output, ..request.clone() }
}

/// A finished file and all that its reply says about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The file.
    pub bytes: Bytes,
    /// Its media type.
    pub content_type: &'static str,
    /// Strong; of the file's inputs and the version alone.
    pub etag: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Distances that the two ends of a depth picture stand for.
    pub depth_range: Option<[f64; 2]>,
    /// Counts, by the names of `Render-Stats`, of all frames together.
    pub stats: Vec<(&'static str, u64)>,
    /// Milliseconds: `queue` if it waited in one, `plan`, the passes of all frames together, `encode`,
    /// `total`.
    pub timings: Vec<(&'static str, f64)>,
}

impl Rendered {
    /// Puts the time in the queue in front, and into the total.
    pub(super) fn add_wait(&mut self, waited: Duration) {
        let waited = milliseconds(waited);
        for (_, total) in self.timings.iter_mut().filter(|(name, _)| *name == "total") {
            *total += waited;
        }
        self.timings.insert(0, ("queue", waited));
    }

    /// Milliseconds of `pass`, if it ran.
    #[must_use]
    pub fn timing(&self, pass: &str) -> Option<f64> {
        self.timings.iter().find(|(name, _)| *name == pass).map(|(_, time)| *time)
    }
}

/// The ETag of a file in the making: of its kind, of the tags of its frames' plans, and of what describes
/// them.
#[derive(Debug)]
pub(super) struct FileTag(blake3::Hasher);

impl FileTag {
    /// The tag of a product without frames yet.
    pub(super) fn new(product: &Product) -> Self {
        let mut hash = blake3::Hasher::new();
        hash.update(product.kind().as_bytes());
        Self(hash)
    }

    /// Takes in a frame.
    pub(super) fn add(&mut self, plan: &Plan) {
        self.0.update(plan.etag().as_bytes());
    }

    /// Takes in what lies beside the frames.
    pub(super) fn add_description(&mut self, description: &[u8]) {
        self.0.update(description);
    }

    /// In quotes.
    pub(super) fn finish(&self) -> String {
        format!("\"{}\"", &self.0.finalize().to_hex()[..32])
    }
}
