//! The variant of the shading kernels that a surface needs, in words.

use super::{Draw, Plan, Surface};
use crate::model::Texture;
use crate::scene::document::words::Word;

impl Plan {
    /// What of a material is computed for each fragment of `draw`: `blinn_phong`, `diffuse map (trilinear)`, ….
    #[must_use]
    pub fn variant(&self, draw: &Draw) -> Vec<String> {
        let surface = &draw.surface;
        let traits = [
            ("shadows", surface.lit && surface.receives_shadow && !self.shadows.is_empty()),
            ("alpha test", draw.alpha_test.is_some()),
        ];
        let own = std::iter::once(surface.shading.word().to_owned());
        own.chain(surface.maps_in_words()).chain(surface.traits_in_words()).chain(held(traits)).collect()
    }
}

impl Surface {
    fn maps_in_words(&self) -> impl Iterator<Item = String> {
        let specular_map = self.specular.as_ref().and_then(|specular| specular.map.as_ref());
        let relief = self.relief.as_ref();
        let heights = relief.and_then(|relief| relief.heights.as_ref()).map(|heights| &heights.map);
        let opacity_map = self.alpha.as_ref().and_then(|alpha| alpha.opacity_map.as_ref());
        let maps = [
            ("diffuse map", self.diffuse_map.as_ref()),
            ("specular map", specular_map),
            ("emissive map", self.emissive_map.as_ref()),
            ("normal map", relief.and_then(|relief| relief.normal_map.as_ref())),
            ("bump map", heights),
            ("opacity map", opacity_map),
        ];
        maps.into_iter().filter_map(|(name, map)| Some(filtered(name, map?)))
    }

    fn traits_in_words(&self) -> impl Iterator<Item = String> + use<> {
        held([
            ("specular", self.specular.is_some()),
            ("emissive", self.emissive != glam::Vec3::ZERO),
            ("vertex colors", self.vertex_colors),
            ("alpha", self.alpha.is_some()),
        ])
    }
}

fn held<const N: usize>(traits: [(&str, bool); N]) -> impl Iterator<Item = String> {
    traits.into_iter().filter(|(_, holds)| *holds).map(|(name, _)| name.to_owned())
}

fn filtered(name: &str, map: &Texture) -> String {
    format!("{name} ({})", map.filter.word())
}
