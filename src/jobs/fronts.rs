//! What reports have measured: the fronts that budgets are settled by.

use crate::plan::{FrameRequest, Knobs};
use crate::report::choose::Front;
use crate::scene::Scene;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// Fronts that are kept; each is some dozens of settings.
const FRONTS: usize = 64;

/// The fronts that were measured last, the newest first.
#[derive(Debug, Default)]
pub(super) struct Fronts {
    kept: Mutex<VecDeque<(Subject, Arc<Front>)>>,
    /// How many there have been.
    count: watch::Sender<u64>,
}

/// What a front was measured of: a scene's content, and the request without what settings and sizes change. Those
/// are what a front is about, and what its times grow with.
#[derive(Clone, Debug, PartialEq)]
struct Subject {
    content: [u8; 32],
    picture: FrameRequest,
}

impl Subject {
    fn of(scene: &Scene, request: &FrameRequest) -> Self {
        let picture = FrameRequest {
            width: None,
            height: None,
            samples: None,
            knobs: Knobs::default(),
            budget: None,
            quality: None,
            ..request.clone()
        };
        Self { content: scene.content, picture }
    }

    /// Whether `other` is the same but for camera and time. People orbit, and things spin: what was measured from
    /// one side a moment ago is still to be expected. Another shading, background or output is other work, and
    /// so is another choice of what is spared.
    fn resembles(&self, other: &Self) -> bool {
        let drawn = |subject: &Self| FrameRequest {
            output: subject.picture.output,
            shading: subject.picture.shading,
            background: subject.picture.background.clone(),
            elide: subject.picture.elide,
            ..FrameRequest::default()
        };
        self.content == other.content && drawn(self) == drawn(other)
    }
}

impl Fronts {
    /// That of the picture of `request` with `pixels`, or from another camera or time: of the size that is nearest,
    /// and of those the newest.
    pub(super) fn of(&self, scene: &Scene, request: &FrameRequest, pixels: f64) -> Option<Arc<Front>> {
        let asked = Subject::of(scene, request);
        let kept = self.kept();
        let fits = kept.iter().filter(|(subject, front)| subject.resembles(&asked) && front.tells_of(pixels));
        let apart = |front: &Front| (front.pixels() / pixels).ln().abs();
        let found = fits.min_by(|(a, of_a), (b, of_b)| {
            (*a != asked).cmp(&(*b != asked)).then(apart(of_a).total_cmp(&apart(of_b)))
        });
        found.map(|(_, front)| Arc::clone(front))
    }

    /// Keeps `front` in place of one of the same picture in the same size, but for one that knows more settings.
    pub(super) fn keep(&self, scene: &Scene, request: &FrameRequest, front: Front) {
        let measured = Subject::of(scene, request);
        let mut kept = self.kept();
        let is_same = |subject: &Subject, of: &Front| *subject == measured && of.pixels() == front.pixels();
        if kept.iter().any(|(subject, of)| is_same(subject, of) && of.settings() > front.settings()) {
            return;
        }
        kept.retain(|(subject, of)| !is_same(subject, of));
        kept.push_front((measured, Arc::new(front)));
        kept.truncate(FRONTS);
        drop(kept);
        self.count.send_modify(|count| *count += 1);
    }

    /// How many there have been: another number may settle a budget in another way.
    pub(super) fn count(&self) -> watch::Receiver<u64> {
        self.count.subscribe()
    }

    // A front is put in or taken out as a whole, so a poisoned lock is as good as any.
    fn kept(&self) -> MutexGuard<'_, VecDeque<(Subject, Arc<Front>)>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::tests::scene;

    /// Whether what was measured at the first query decides for the second.
    fn decides(measured: &[(&str, &str)], asked: &[(&str, &str)]) -> bool {
        let scene = scene();
        let subject = |query: &[(&str, &str)]| {
            let request = FrameRequest::parse(query.iter().copied()).expect("a good query");
            Subject::of(&scene, &request)
        };
        subject(measured).resembles(&subject(asked))
    }

    #[test]
    fn settings_sizes_cameras_and_times_are_not_told_apart() {
        for pair in [("width", "99"), ("samples", "16"), ("pcf_taps", "5"), ("max_ms", "3"), ("quality", "9")]
        {
            let (scene, request) = (scene(), FrameRequest::parse([pair]).expect("a good query"));
            assert_eq!(
                Subject::of(&scene, &request),
                Subject::of(&scene, &FrameRequest::default()),
                "{pair:?}"
            );
        }
        for pair in [("orbit", "30,20"), ("eye", "1,2,3"), ("fov", "60"), ("ortho", "2"), ("t", "5")] {
            assert!(decides(&[pair], &[]) && decides(&[], &[pair]), "{pair:?}");
        }
    }

    #[test]
    fn what_changes_the_work_is_told_apart() {
        for pair in [("shading", "unlit"), ("background", "ff8800"), ("output", "depth"), ("elide", "none")] {
            assert!(!decides(&[pair], &[]) && !decides(&[], &[pair]), "{pair:?}");
            assert!(decides(&[pair], &[pair, ("orbit", "30,20")]), "{pair:?}");
        }
    }
}
