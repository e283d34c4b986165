//! The entity tag of a picture.

use super::Plan;
use crate::model::Shading;
use std::fmt::Write;

/// Hashes what the picture is made from: the scene's content and the settled request. Items, draws, lights and
/// shadows follow from these, so that an outline has the tag of its plan.
pub fn of(plan: &Plan) -> String {
    let mut hash = blake3::Hasher::new();
    hash.update(env!("CARGO_PKG_VERSION").as_bytes());
    hash.update(&plan.scene.content);
    let (view, scene) = (&plan.view, &plan.scene);
    let mut settled = String::new();
    // What says of every material what it says itself is no override; nor is there one of data.
    let overrides = |shading: &Shading| scene.materials.iter().any(|own| own.shading != *shading);
    let shading = plan.shading().filter(overrides);
    // Debug prints the shortest decimal that reads back as the same f64: exact.
    write!(
        settled,
        "{view:?} {:?} {:?} {:?} {:?} {} {:?} {:?} {shading:?} {:?}",
        plan.size,
        plan.knobs,
        plan.t,
        plan.output,
        plan.samples,
        plan.background,
        plan.depth_range,
        scene.render.cull
    )
    .expect("writing to a string succeeds");
    hash.update(settled.as_bytes());
    let hex = hash.finalize().to_hex();
    format!("\"{}\"", &hex[..32])
}
