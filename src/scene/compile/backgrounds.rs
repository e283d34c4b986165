//! Backgrounds, and where a procedural sky has its sun.

use super::SceneError;
use crate::model::normals::unit;
use crate::scene::assets::{BackgroundPlace, Loader};
use crate::scene::document::{
    BackgroundChoice, BackgroundPart, LightKindPart, LightPart, default_lights, token,
};
use crate::scene::{Background, Document};
use glam::DVec3;
use std::collections::BTreeMap;

/// The chosen background, and the named ones in order of name.
pub(super) struct Backgrounds {
    pub chosen: Background,
    pub named: Vec<(String, Background)>,
}

/// Loads every background, chosen or not: a frame query may choose any.
pub(super) fn compile(document: &Document, loader: &mut Loader) -> Result<Backgrounds, SceneError> {
    let environment = &document.environment;
    let mut named = Vec::with_capacity(environment.backgrounds.len());
    for (name, part) in &environment.backgrounds {
        let pointer = format!("/environment/backgrounds/{}", token(name));
        let place = BackgroundPlace { pointer, what: format!("the background {name:?}") };
        named.push((name.clone(), loader.background(part, &place, towards_sun(part, document))?));
    }
    let chosen = match &environment.background {
        BackgroundChoice::Here(part) => {
            let pointer = "/environment/background".to_owned();
            let place = BackgroundPlace { pointer, what: "the background".to_owned() };
            loader.background(part, &place, towards_sun(part, document))?
        }
        BackgroundChoice::Named(chosen) => {
            let found = named.iter().find(|(name, _)| name == chosen);
            found
                .map(|(_, background)| background.clone())
                .expect("invariant: a checked document names none that is not there")
        }
    };
    Ok(Backgrounds { chosen, named })
}

/// Unit vector towards the sun: as the background says, else opposite to the way the light of the first
/// enabled directional light by name travels, else that of a document that names no lights.
fn towards_sun(part: &BackgroundPart, document: &Document) -> DVec3 {
    let given = match part {
        BackgroundPart::Sky { sun_direction, .. } => *sun_direction,
        _ => None,
    };
    let travels = given
        .or_else(|| first_direction(&document.lights))
        .or_else(|| first_direction(&default_lights()))
        .and_then(unit);
    // Documents have no direction that is zero.
    -travels.unwrap_or(DVec3::NEG_Y)
}

fn first_direction(lights: &BTreeMap<String, LightPart>) -> Option<DVec3> {
    lights.values().filter(|light| light.enabled).find_map(|light| match light.kind {
        LightKindPart::Directional { direction } => Some(direction),
        LightKindPart::Point { .. } => None,
    })
}
