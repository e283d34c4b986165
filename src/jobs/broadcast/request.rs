//! What a client wants to watch.

use crate::encode::Format;
use crate::plan::FrameRequest;
use crate::plan::request::Query;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Frames a second that may be asked for: screens show no more, and slower is a job for single frames.
const FPS: RangeInclusive<f64> = 0.1..=60.0;

/// Frames a second where nothing is asked for.
const DEFAULT_FPS: f64 = 30.0;

/// What a client wants to watch. Equal ones see the same pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamRequest {
    /// Each frame, but for its time; the quality is settled, a budget is not: what it buys changes with the scene.
    frame: FrameRequest,
    /// Whether the query holds the time.
    is_frozen: bool,
    /// No faster than this.
    fps: f64,
}

impl StreamRequest {
    /// Reads a frame query and `fps`, out of a query that may hold other parameters too.
    pub fn read(query: &mut Query) -> Self {
        let fps = query.number_in("fps", FPS).unwrap_or(DEFAULT_FPS);
        let is_frozen = query.text("t").is_some();
        let mut frame = FrameRequest::read(query);
        frame.quality = Some(frame.quality.unwrap_or(Format::DEFAULT_QUALITY));
        Self { frame, is_frozen, fps }
    }

    /// From the start of one frame to that of the next, at least.
    pub(super) fn period(&self) -> Duration {
        Duration::from_secs_f64(self.fps.recip())
    }

    /// JPEG quality.
    pub(super) fn quality(&self) -> u8 {
        self.frame.quality.unwrap_or(Format::DEFAULT_QUALITY)
    }

    /// Whether time passes in it.
    pub(super) fn runs(&self) -> bool {
        !self.is_frozen
    }

    /// The frame `now` seconds after the scene was made, or at the time that it is frozen at.
    pub(super) fn at(&self, now: f64) -> FrameRequest {
        let t = if self.is_frozen { self.frame.t } else { now };
        FrameRequest { t, ..self.frame.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[(&str, &str)]) -> StreamRequest {
        let mut query = Query::new(text.iter().copied());
        let request = StreamRequest::read(&mut query);
        query.finish().expect("a good query");
        request
    }

    #[test]
    fn what_means_the_same_is_the_same() {
        assert_eq!(read(&[]), read(&[("quality", "80"), ("fps", "30")]));
        assert_ne!(read(&[]), read(&[("t", "0")]));
        assert_ne!(read(&[]), read(&[("fps", "10")]));
        assert_eq!(read(&[("max_ms", "5")]), read(&[("max_ms", "5.0")]));
        assert_ne!(read(&[]), read(&[("max_ms", "5")]));
    }

    #[test]
    fn a_given_time_stands_still() {
        assert_eq!(read(&[]).at(7.5).t, 7.5);
        assert_eq!(read(&[("t", "2")]).at(7.5).t, 2.0);
        assert!(read(&[]).runs() && !read(&[("t", "2")]).runs());
    }
}
