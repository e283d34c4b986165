//! Knobs: how much work goes into a picture, in place of what the scene says.

use crate::model::texture::Filter;
use crate::model::{Material, Texture};
use crate::scene::{Scene, Shadow, ShadowFilter};
use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Overrides that trade error for run time, beside the samples. `None` means "as the scene has it".
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Knobs {
    /// Texels along a side of every shadow map.
    pub shadow_resolution: Option<u32>,
    /// Taps of every PCF.
    pub pcf_taps: Option<u32>,
    /// Taps of every PCSS search for blockers.
    pub search_taps: Option<u32>,
    /// Taps of every PCSS filter.
    pub filter_taps: Option<u32>,
    /// How every texture is sampled, but those that the scene shows texel by texel (`nearest`).
    pub texture_filter: Option<Filter>,
    /// The picture is drawn with so many times the pixels along each side, and resampled.
    pub render_scale: Option<f64>,
}

impl Knobs {
    /// What `render_scale` may be: beyond it a picture is mush, or a matter for samples.
    pub const SCALES: RangeInclusive<f64> = 0.1..=4.0;

    /// Pixels along the sides of what is drawn for a picture of `size`.
    #[must_use]
    pub fn drawn_size(&self, size: [u32; 2]) -> [u32; 2] {
        let Some(scale) = self.render_scale else { return size };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most four times a u32 saturates, and is over every limit"
        )]
        size.map(|side| (f64::from(side) * scale).round().max(1.0) as u32)
    }

    /// `shadow` with the knobs turned.
    #[must_use]
    pub fn shadow(&self, shadow: Shadow) -> Shadow {
        Shadow {
            resolution: self.shadow_resolution.unwrap_or(shadow.resolution),
            pcf_taps: self.pcf_taps.unwrap_or(shadow.pcf_taps),
            search_taps: self.search_taps.unwrap_or(shadow.search_taps),
            filter_taps: self.filter_taps.unwrap_or(shadow.filter_taps),
            ..shadow
        }
    }

    /// `material` with the knobs turned.
    #[must_use]
    pub fn material<'a>(&self, material: &'a Material) -> Cow<'a, Material> {
        let Some(filter) = self.texture_filter else { return Cow::Borrowed(material) };
        let map = |map: &Option<Arc<Texture>>| map.as_ref().map(|map| filtered(map, filter));
        Cow::Owned(Material {
            diffuse_map: map(&material.diffuse_map),
            specular_map: map(&material.specular_map),
            emissive_map: map(&material.emissive_map),
            normal_map: map(&material.normal_map),
            bump_map: map(&material.bump_map),
            opacity_map: map(&material.opacity_map),
            ..material.clone()
        })
    }

    /// Those that change something in a picture of `scene`.
    #[must_use]
    pub fn that_change(&self, scene: &Scene) -> Self {
        let shadows = || scene.lights.iter().filter_map(|light| light.shadow);
        let of = |filter: ShadowFilter| shadows().filter(move |shadow| shadow.filter == filter);
        let soft = || of(ShadowFilter::Pcss);
        Self {
            shadow_resolution: unlike(self.shadow_resolution, shadows().map(|own| own.resolution)),
            pcf_taps: unlike(self.pcf_taps, of(ShadowFilter::Pcf).map(|own| own.pcf_taps)),
            search_taps: unlike(self.search_taps, soft().map(|own| own.search_taps)),
            filter_taps: unlike(self.filter_taps, soft().map(|own| own.filter_taps)),
            texture_filter: self
                .texture_filter
                .filter(|filter| filters(scene).any(|own| own != Filter::Nearest && own != *filter)),
            render_scale: self.render_scale.filter(|scale| *scale != 1.0),
        }
    }
}

/// `asked`, if any of `own` is not it already.
fn unlike(asked: Option<u32>, mut own: impl Iterator<Item = u32>) -> Option<u32> {
    let changes = own.any(|own| asked != Some(own));
    asked.filter(|_| changes)
}

/// How the textures of `scene` are sampled.
fn filters(scene: &Scene) -> impl Iterator<Item = Filter> {
    scene.materials.iter().flat_map(|material| material.maps()).map(|map| map.filter)
}

/// The same texels, sampled by `filter`; those of a texture without mips stay as they are.
fn filtered(texture: &Arc<Texture>, filter: Filter) -> Arc<Texture> {
    match texture.filter {
        Filter::Nearest => Arc::clone(texture),
        own if own == filter => Arc::clone(texture),
        _ => Arc::new(Texture { filter, ..Texture::clone(texture) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::scene::NewScene;
    use serde_json::json;

    fn scene(shadow: serde_json::Value) -> Scene {
        let document = json!({
            "lights": { "sun": { "type": "directional", "direction": [0, -1, 0], "shadow": shadow } },
            "textures": { "t": { "checker": {} }, "texels": { "checker": {}, "filter": "nearest" } },
            "materials": { "m": { "diffuse_map": "t", "emissive_map": "texels" } },
        });
        let new = NewScene { document: Some(document), ..NewScene::default() };
        new.compile(&Limits::default()).expect("a sound scene")
    }

    #[test]
    fn a_drawn_picture_has_at_least_one_pixel() {
        let drawn = |render_scale: f64, size| {
            Knobs { render_scale: Some(render_scale), ..Knobs::default() }.drawn_size(size)
        };
        assert_eq!(drawn(0.5, [801, 600]), [401, 300]);
        assert_eq!(drawn(0.1, [1, 4]), [1, 1]);
        assert_eq!(Knobs::default().drawn_size([801, 600]), [801, 600]);
    }

    #[test]
    fn what_the_scene_says_itself_changes_nothing() {
        let scene = scene(json!({ "filter": "pcf", "resolution": 512 }));
        let knobs = Knobs {
            shadow_resolution: Some(512),
            pcf_taps: Some(8),
            search_taps: Some(3),
            filter_taps: Some(3),
            texture_filter: Some(Filter::Trilinear),
            render_scale: Some(1.0),
        };
        // Nothing is soft, and no texture but one of texels is sampled otherwise.
        assert_eq!(knobs.that_change(&scene), Knobs { pcf_taps: Some(8), ..Knobs::default() });
    }

    #[test]
    fn texels_that_are_shown_as_they_are_stay_so() {
        let scene = scene(json!({}));
        let material = scene.materials.iter().find(|m| m.emissive_map.is_some()).expect("the document's");
        let knobs = Knobs { texture_filter: Some(Filter::Bilinear), ..Knobs::default() };
        let turned = knobs.material(material);
        let filter = |map: &Option<Arc<Texture>>| map.as_ref().expect("a map").filter;
        assert_eq!(filter(&turned.diffuse_map), Filter::Bilinear);
        assert_eq!(filter(&turned.emissive_map), Filter::Nearest);
    }
}
