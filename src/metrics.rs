//! What happens, in numbers that Prometheus reads; all names begin with `rasterd_`.
//!
//! No label has values without a bound: those of every family are words of the program or routes of its
//! router.

use crate::plan::{Elision, Tally, Unit};
use prometheus::core::Collector;
use prometheus::{
    Histogram, HistogramOpts, HistogramVec, IntCounter, IntCounterVec, IntGauge, Opts, Registry, TextEncoder,
};

/// Buckets of all times, in seconds: each twice the one before, from half a millisecond to half a minute,
/// the deadline of a frame.
const SECONDS: [f64; 17] = [
    0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128, 0.256, 0.512, 1.024, 2.048, 4.096, 8.192,
    16.384, 32.768,
];

/// What `Server-Timing` names but for `queue`, which has a family of its own, and `total`.
const PASSES: [&str; 10] =
    ["plan", "shadow", "geometry", "raster", "shade", "sky", "resolve", "post", "resample", "encode"];

/// What a drawn frame was for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// Pictures, turntables and archives; the outputs of an archive are one.
    Frame,
    /// Live streams.
    Stream,
}

/// Why a job was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// As many wait as may.
    Full,
    /// The server goes down.
    Closing,
}

/// All of them. What is not an event, such as the number of scenes, is settled when it is read.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    frames_rendered: IntCounterVec,
    pass_seconds: HistogramVec,
    queue_wait_seconds: Histogram,
    jobs_rejected: IntCounterVec,
    work: IntCounterVec,
    work_spared: IntCounterVec,
    http_requests: IntCounterVec,
    /// Jobs whose client left, or whose time was over, before they were done.
    pub jobs_cancelled: IntCounter,
    /// Who watches a stream now; who listens to its events alone is not counted.
    pub stream_watchers: IntGauge,
    /// Pictures given to watchers of streams, repeated ones too.
    pub stream_frames_sent: IntCounter,
    /// Pictures that a watcher was too slow for, so that it was given a newer one.
    pub stream_frames_dropped: IntCounter,
    /// Frames that wait for their turn.
    pub queue_depth: IntGauge,
    /// Scenes in memory.
    pub scenes: IntGauge,
    /// Bytes of all scenes.
    pub scene_bytes: IntGauge,
    /// Different streams that are watched.
    pub streams: IntGauge,
}

impl Default for Metrics {
    fn default() -> Self {
        let registry =
            Registry::new_custom(Some("rasterd".to_owned()), None).expect("a prefix of letters is one");
        let counter = |name: &str, help: &str| kept(&registry, IntCounter::new(name, help));
        let counters = |name: &str, help: &str, labels: &[&str]| {
            kept(&registry, IntCounterVec::new(Opts::new(name, help), labels))
        };
        let gauge = |name: &str, help: &str| kept(&registry, IntGauge::new(name, help));
        let times = |name: &str, help: &str| HistogramOpts::new(name, help).buckets(SECONDS.to_vec());
        let metrics = Self {
            frames_rendered: counters("frames_rendered_total", "Frames drawn", &["kind"]),
            pass_seconds: kept(
                &registry,
                HistogramVec::new(times("pass_seconds", "Time of one pass of a frame"), &["pass"]),
            ),
            queue_wait_seconds: kept(
                &registry,
                Histogram::with_opts(times(
                    "queue_wait_seconds",
                    "Time that a job waited for its first turn",
                )),
            ),
            jobs_rejected: counters("jobs_rejected_total", "Jobs that were not taken", &["reason"]),
            work: counters("work_total", "Work of the frames drawn", &["unit"]),
            work_spared: counters("work_spared_total", "Work that frames were spared", &["elision"]),
            http_requests: counters("http_requests_total", "Requests answered", &["route", "status"]),
            jobs_cancelled: counter("jobs_cancelled_total", "Jobs ended before they were done"),
            stream_watchers: gauge("stream_watchers", "Who watches a stream"),
            stream_frames_sent: counter("stream_frames_sent_total", "Pictures given to watchers"),
            stream_frames_dropped: counter(
                "stream_frames_dropped_total",
                "Pictures that a watcher was too slow for",
            ),
            queue_depth: gauge("queue_depth", "Frames that wait for their turn"),
            scenes: gauge("scenes", "Scenes in memory"),
            scene_bytes: gauge("scene_bytes", "Bytes of all scenes"),
            streams: gauge("streams", "Different streams that are watched"),
            registry,
        };
        metrics.begin_at_zero();
        metrics
    }
}

impl Metrics {
    /// A family shows the labels that were used once: a reader expects those it knows of from the start.
    fn begin_at_zero(&self) {
        for kind in [FrameKind::Frame, FrameKind::Stream] {
            self.frames_rendered(kind).reset();
        }
        for reason in [Rejection::Full, Rejection::Closing] {
            self.jobs_rejected(reason).reset();
        }
        for pass in PASSES {
            self.pass_seconds.with_label_values(&[pass]);
        }
        Unit::ALL.iter().for_each(|unit| self.work.with_label_values(&[unit.name()]).reset());
        Elision::ALL.iter().for_each(|elision| self.work_spared.with_label_values(&[elision.name()]).reset());
    }

    /// Frames drawn.
    #[must_use]
    pub fn frames_rendered(&self, kind: FrameKind) -> IntCounter {
        let kind = match kind {
            FrameKind::Frame => "frame",
            FrameKind::Stream => "stream",
        };
        self.frames_rendered.with_label_values(&[kind])
    }

    /// Jobs that were not taken.
    #[must_use]
    pub fn jobs_rejected(&self, reason: Rejection) -> IntCounter {
        let reason = match reason {
            Rejection::Full => "queue_full",
            Rejection::Closing => "closing",
        };
        self.jobs_rejected.with_label_values(&[reason])
    }

    /// Counts the work of a frame, and what it was spared.
    pub fn count_work(&self, tally: &Tally) {
        tally.work().for_each(|(unit, amount)| self.work.with_label_values(&[unit]).inc_by(amount));
        let spared = tally.savings();
        spared.for_each(|(elision, amount)| self.work_spared.with_label_values(&[elision]).inc_by(amount));
    }

    /// Notes what each pass took, in milliseconds. What is no pass is left out.
    pub fn observe_passes(&self, milliseconds: impl IntoIterator<Item = (&'static str, f64)>) {
        for (pass, milliseconds) in milliseconds.into_iter().filter(|(name, _)| PASSES.contains(name)) {
            self.pass_seconds.with_label_values(&[pass]).observe(milliseconds / 1e3);
        }
    }

    /// Notes how long a job waited for its first turn.
    pub fn observe_wait(&self, wait: std::time::Duration) {
        self.queue_wait_seconds.observe(wait.as_secs_f64());
    }

    /// Notes an answer; `route` is the router's pattern, not the path that was asked for.
    pub fn count_request(&self, route: &str, status: u16) {
        self.http_requests.with_label_values(&[route, &status.to_string()]).inc();
    }

    /// All of it in the text format, version 0.0.4.
    #[must_use]
    pub fn text(&self) -> String {
        TextEncoder::new().encode_to_string(&self.registry.gather()).unwrap_or_default()
    }
}

/// A metric that the registry knows. Names and labels are constants, so every start tells whether they are
/// right.
fn kept<M: Collector + Clone + 'static>(registry: &Registry, metric: prometheus::Result<M>) -> M {
    let metric = metric.expect("names are well-formed");
    registry.register(Box::new(metric.clone())).expect("each name is there once");
    metric
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_family_is_there_from_the_start() {
        let text = Metrics::default().text();
        for line in [
            "rasterd_frames_rendered_total{kind=\"frame\"} 0",
            "rasterd_frames_rendered_total{kind=\"stream\"} 0",
            "rasterd_pass_seconds_count{pass=\"shade\"} 0",
            "rasterd_queue_wait_seconds_count 0",
            "rasterd_work_total{unit=\"taps\"} 0",
            "rasterd_work_spared_total{elision=\"decided_taps\"} 0",
            "rasterd_jobs_rejected_total{reason=\"queue_full\"} 0",
            "rasterd_jobs_cancelled_total 0",
            "rasterd_queue_depth 0",
            "rasterd_stream_watchers 0",
            "rasterd_stream_frames_sent_total 0",
            "rasterd_stream_frames_dropped_total 0",
            "rasterd_scenes 0",
            "rasterd_scene_bytes 0",
        ] {
            assert!(text.lines().any(|other| other == line), "{line} in {text}");
        }
    }

    #[test]
    fn what_is_no_pass_has_no_label() {
        let metrics = Metrics::default();
        metrics.observe_passes([("shade", 3.0), ("queue", 1.0), ("total", 9.0)]);
        let text = metrics.text();
        assert!(text.contains("rasterd_pass_seconds_sum{pass=\"shade\"} 0.003"), "{text}");
        assert!(text.contains("rasterd_pass_seconds_bucket{pass=\"shade\",le=\"0.004\"} 1"), "{text}");
        assert!(!text.contains("total\"}") && !text.contains("queue\"}"), "{text}");
    }
}
