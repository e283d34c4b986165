//! What a document asks for, against [`Limits`]: before anything is built.

use super::Document;
use super::compile::SceneError;
use super::document::{MeshPart, PostEffect, ShadowPart, TexturePart, TextureSource};
use crate::limits::Limits;

/// Checks every number of `document` that has a limit.
///
/// # Errors
/// [`SceneError::TooLarge`] for the first that is over it.
pub(super) fn check(document: &Document, limits: &Limits) -> Result<(), SceneError> {
    entries(document, limits)?;
    names(document, limits)?;
    picture(document, limits)?;
    for (name, light) in &document.lights {
        if let Some(part) = &light.shadow {
            shadow(name, part, limits)?;
        }
    }
    document.textures.iter().try_for_each(|(name, part)| texture(name, part, limits))?;
    document.meshes.iter().try_for_each(|(name, part)| shape(name, part, limits))?;
    document.post.iter().try_for_each(|effect| post(effect, limits))
}

fn entries(document: &Document, limits: &Limits) -> Result<(), SceneError> {
    let parts = [
        ("lights", document.lights.len(), limits.lights),
        ("environment.backgrounds", document.environment.backgrounds.len(), limits.backgrounds),
        ("textures", document.textures.len(), limits.entries),
        ("materials", document.materials.len(), limits.entries),
        ("meshes", document.meshes.len(), limits.entries),
        ("instances", document.instances.len(), limits.instances),
        ("post", document.post.len(), limits.post_effects),
    ];
    parts.into_iter().try_for_each(|(part, count, limit)| {
        at_most(limit as u64, count as u64, || format!("entries of {part}"))
    })
}

/// Lengths of names, the document's own among them.
fn names(document: &Document, limits: &Limits) -> Result<(), SceneError> {
    let backgrounds = document.environment.backgrounds.keys().map(|name| ("environment.backgrounds", name));
    let own = std::iter::once(("the scene itself", &document.name));
    own.chain(backgrounds)
        .chain(document.lights.keys().map(|name| ("lights", name)))
        .chain(document.textures.keys().map(|name| ("textures", name)))
        .chain(document.materials.keys().map(|name| ("materials", name)))
        .chain(document.meshes.keys().map(|name| ("meshes", name)))
        .chain(document.instances.keys().map(|name| ("instances", name)))
        .try_for_each(|(part, name)| {
            let length = name.chars().count() as u64;
            at_most(limits.name_chars as u64, length, || format!("characters of a name of {part}"))
        })
}

fn picture(document: &Document, limits: &Limits) -> Result<(), SceneError> {
    let (width, height) = (document.render.width, document.render.height);
    at_most(limits.picture_side.into(), width, || "render.width in pixels".to_owned())?;
    at_most(limits.picture_side.into(), height, || "render.height in pixels".to_owned())?;
    at_most(limits.picture_pixels, width.saturating_mul(height), || "pixels of the picture".to_owned())
}

fn shadow(light: &str, shadow: &ShadowPart, limits: &Limits) -> Result<(), SceneError> {
    let numbers = [
        ("resolution", shadow.resolution, limits.texture_side),
        ("bias", whole(shadow.bias), limits.shadow_bias),
        ("radius in texels", whole(shadow.radius), limits.shadow_kernel_texels),
        ("search_radius in texels", whole(shadow.search_radius.unwrap_or(0.0)), limits.shadow_kernel_texels),
        ("pcf_taps", shadow.pcf_taps, limits.shadow_taps),
        ("search_taps", shadow.search_taps, limits.shadow_taps),
        ("filter_taps", shadow.filter_taps, limits.shadow_taps),
    ];
    numbers.into_iter().try_for_each(|(what, value, limit)| {
        at_most(limit.into(), value, || format!("shadow {what} of the light {light:?}"))
    })
}

fn texture(name: &str, texture: &TexturePart, limits: &Limits) -> Result<(), SceneError> {
    match texture.source {
        TextureSource::Checker { cells, .. } => {
            at_most(limits.checker_cells.into(), cells, || format!("checker cells of the texture {name:?}"))
        }
        TextureSource::File(_) => Ok(()),
    }
}

fn shape(name: &str, mesh: &MeshPart, limits: &Limits) -> Result<(), SceneError> {
    let steps = match mesh {
        MeshPart::Sphere { segments, rings, .. } => (*segments).max(*rings),
        MeshPart::Torus { segments, sides, .. } => (*segments).max(*sides),
        MeshPart::Cylinder { segments, .. } | MeshPart::Cone { segments, .. } => *segments,
        MeshPart::Teapot { segments, .. } => {
            return at_most(limits.teapot_segments.into(), *segments, || {
                format!("segments of the teapot {name:?}")
            });
        }
        _ => return Ok(()),
    };
    at_most(limits.shape_segments.into(), steps, || format!("segments of the mesh {name:?}"))
}

fn post(effect: &PostEffect, limits: &Limits) -> Result<(), SceneError> {
    match effect {
        PostEffect::Blur { radius } | PostEffect::Bloom { radius, .. } => {
            at_most(limits.post_radius_px.into(), whole(*radius), || {
                "radius of an effect in pixels".to_owned()
            })
        }
        PostEffect::Kernel { kernel } => {
            at_most(limits.post_kernel_side as u64, kernel.len() as u64, || "rows of a kernel".to_owned())
        }
        _ => Ok(()),
    }
}

/// The next whole number.
fn whole(value: f64) -> u64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative; what no u64 holds becomes its maximum, which is over every limit"
    )]
    {
        value.ceil() as u64
    }
}

fn at_most(limit: u64, value: u64, what: impl FnOnce() -> String) -> Result<(), SceneError> {
    if value <= limit {
        Ok(())
    } else {
        Err(SceneError::TooLarge { what: what(), limit, value, setting: None })
    }
}
