//! The stages after the plan: pipeline → encode, and what a finished picture carries.

use crate::pipeline::{Cancelled, Work};
use crate::plan::Plan;
use crate::{encode, pipeline};
use bytes::Bytes;
use std::time::{Duration, Instant};

/// Draws a plan and encodes the picture.
pub type Draw = dyn Fn(&Plan, Format, &Work<'_>) -> Result<Picture, Cancelled> + Send + Sync;

/// How a picture is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG.
    Png,
}

impl Format {
    /// Its media type.
    #[must_use]
    pub fn content_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
        }
    }
}

/// What the drawing step gives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The encoded file.
    pub bytes: Vec<u8>,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Distances that the two ends of a depth picture stand for.
    pub depth_range: Option<[f64; 2]>,
    /// Counts, by the names of `Render-Stats`.
    pub stats: Vec<(&'static str, u64)>,
    /// Milliseconds by pass, in the order of the passes; one that did not run is absent.
    pub timings: Vec<(&'static str, f64)>,
}

/// A finished picture and all that its reply says about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The encoded file.
    pub bytes: Bytes,
    /// Its media type.
    pub content_type: &'static str,
    /// Strong; of the picture's inputs and the version alone.
    pub etag: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Distances that the two ends of a depth picture stand for.
    pub depth_range: Option<[f64; 2]>,
    /// Counts, by the names of `Render-Stats`.
    pub stats: Vec<(&'static str, u64)>,
    /// Milliseconds: `queue` if it waited in one, `plan`, the passes, `encode`, `total`.
    pub timings: Vec<(&'static str, f64)>,
}

impl Rendered {
    pub(super) fn new(
        picture: Picture,
        etag: String,
        format: Format,
        planned: Duration,
        total: Duration,
    ) -> Self {
        let mut timings = vec![("plan", milliseconds(planned))];
        timings.extend(picture.timings);
        timings.push(("total", milliseconds(total)));
        Self {
            bytes: picture.bytes.into(),
            content_type: format.content_type(),
            etag,
            width: picture.width,
            height: picture.height,
            depth_range: picture.depth_range,
            stats: picture.stats,
            timings,
        }
    }

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

/// The drawing step itself.
pub(super) fn picture(plan: &Plan, format: Format, work: &Work<'_>) -> Result<Picture, Cancelled> {
    let frame = pipeline::render(plan, work)?;
    let started = Instant::now();
    let bytes = match format {
        Format::Png => encode::png(&frame),
    };
    let mut timings = frame.timings;
    timings.push("encode", milliseconds(started.elapsed()));
    Ok(Picture {
        bytes,
        width: frame.width,
        height: frame.height,
        depth_range: frame.depth_range,
        stats: frame.stats.entries().to_vec(),
        timings: timings.iter().collect(),
    })
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
