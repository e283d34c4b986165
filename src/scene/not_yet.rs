//! What the wire contract has and this version does not draw: accepted, checked, and said in the
//! scene's warnings. A feature that is drawn loses its function here.

use super::document::{ShadowPart, default_lights};
use super::{Document, LightKind, Scene, ShadowFilter, Warning};

/// Everything in the scene that is not drawn as asked.
pub(super) fn warnings(document: &Document, scene: &Scene) -> Vec<Warning> {
    let mut details = Vec::new();
    details.extend(soft_shadows(document));
    details.extend(point_shadows(scene));
    details.into_iter().map(|detail| Warning { file: None, line: None, detail }).collect()
}

fn soft_shadows(document: &Document) -> Option<String> {
    // The sun of a document without lights is nobody's wish.
    let is_soft = |shadow: &ShadowPart| matches!(shadow.filter, Some(ShadowFilter::Pcf | ShadowFilter::Pcss));
    let asked = document.lights != default_lights()
        && document.lights.values().any(|light| light.shadow.as_ref().is_some_and(is_soft));
    asked
        .then(|| "the shadow filters pcf and pcss are not drawn by this version; shadows are hard".to_owned())
}

fn point_shadows(scene: &Scene) -> Option<String> {
    let casts = |kind: &LightKind| matches!(kind, LightKind::Point { .. });
    let any = scene.lights.iter().any(|light| light.shadow.is_some() && casts(&light.kind));
    any.then(|| "shadows of point lights are not drawn by this version".to_owned())
}
