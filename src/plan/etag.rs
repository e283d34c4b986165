//! The entity tag of a picture.

use super::Plan;
use std::fmt::Write;

/// Hashes what the picture is made from: the scene's content and the settled request.
pub fn of(plan: &Plan) -> String {
    let mut hash = blake3::Hasher::new();
    hash.update(env!("CARGO_PKG_VERSION").as_bytes());
    hash.update(&plan.scene.content);
    let (view, scene) = (&plan.view, &plan.scene);
    let mut settled = String::new();
    // Debug prints the shortest decimal that reads back as the same f64: exact.
    let shading: Vec<_> = plan.draws.iter().map(|draw| draw.surface.shading).collect();
    write!(
        settled,
        "{view:?} {:?} {:?} {} {:?} {:?} {shading:?} {:?}",
        plan.t, plan.output, plan.samples, plan.background, plan.depth_range, scene.render.cull
    )
    .expect("writing to a string succeeds");
    hash.update(settled.as_bytes());
    let hex = hash.finalize().to_hex();
    format!("\"{}\"", &hex[..32])
}
