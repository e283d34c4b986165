//! Opacity: what of a surface is there, and what shows through it.

use super::request::Output;
use super::{Item, Surface};
use crate::model::{Material, Texture};
use std::sync::Arc;

/// The alpha from which on a surface counts as there where nothing can be blended: in data outputs and
/// in shadow maps. A material's own cut-off takes its place.
const SOLID_FROM: f32 = 0.5;

/// How triangles meet what lies behind them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Opacity {
    /// They hide it.
    #[default]
    Opaque,
    /// They hide it where they pass an [`AlphaTest`]; elsewhere they do not exist.
    CutOut,
    /// It shows through them.
    Blended,
}

/// Where the alpha of a fragment comes from, 0–1: `opacity · opacity_map · alpha of diffuse_map`.
#[derive(Clone, Debug)]
pub struct Alpha {
    /// The constant factor, over 0.
    pub opacity: f32,
    /// Its red channel is a factor; `None` where that is 1.
    pub opacity_map: Option<Arc<Texture>>,
    /// Its alpha channel is a factor; `None` where that is 1.
    pub diffuse_map: Option<Arc<Texture>>,
}

/// Decides which fragments of a surface exist.
#[derive(Clone, Debug)]
pub struct AlphaTest {
    /// Those of at least this alpha.
    pub cutoff: f32,
    /// A surface of nothing but that alpha.
    pub probe: Surface,
}

impl AlphaTest {
    /// Whether both decide the same.
    #[must_use]
    pub fn has_the_holes_of(&self, other: &Self) -> bool {
        let alike = match (&self.probe.alpha, &other.probe.alpha) {
            (Some(own), Some(other)) => own.is(other),
            (own, other) => own.is_none() && other.is_none(),
        };
        alike && self.cutoff == other.cutoff
    }
}

/// An alpha test of one item's triangles.
#[derive(Clone, Copy, Debug)]
pub struct ItemTest<'a> {
    /// Whose triangles.
    pub item: &'a Item,
    /// Which of their fragments exist.
    pub test: &'a AlphaTest,
}

/// A material's alpha, settled for one purpose.
#[derive(Clone, Debug)]
pub enum Transparency {
    /// Nothing shows through.
    Opaque,
    /// Holes in what is opaque.
    CutOut(AlphaTest),
    /// Everything shows through.
    Blended(Alpha),
}

impl Transparency {
    /// What is drawn of it when.
    #[must_use]
    pub fn opacity(&self) -> Opacity {
        match self {
            Self::Opaque => Opacity::Opaque,
            Self::CutOut(_) => Opacity::CutOut,
            Self::Blended(_) => Opacity::Blended,
        }
    }

    /// Which fragments exist; `None`: all.
    #[must_use]
    pub fn into_test(self) -> Option<AlphaTest> {
        match self {
            Self::CutOut(test) => Some(test),
            Self::Opaque | Self::Blended(_) => None,
        }
    }
}

/// What an output shows of `material`'s alpha; `None` if there is nothing to be seen of it.
#[must_use]
pub fn of_output(material: &Material, output: Output) -> Option<Transparency> {
    if output.looks_as_color() || output.is_lit() { of_picture(material) } else { of_solid(material) }
}

/// What counts as there of a material; `None` if nothing does.
#[must_use]
pub fn of_solid(material: &Material) -> Option<Transparency> {
    Alpha::of(material).cut(material.alpha_cutoff.unwrap_or(SOLID_FROM))
}

fn of_picture(material: &Material) -> Option<Transparency> {
    let alpha = Alpha::of(material);
    match material.alpha_cutoff {
        Some(cutoff) => alpha.cut(cutoff),
        // `src · 1 + dst · 0` is `src`, and `src · 0 + dst · 1` is `dst`.
        None if alpha.is_constant() && alpha.opacity >= 1.0 => Some(Transparency::Opaque),
        None => (alpha.opacity > 0.0).then_some(Transparency::Blended(alpha)),
    }
}

impl Alpha {
    fn of(material: &Material) -> Self {
        // A factor of exactly 1 is no factor.
        let map = |map: &Option<Arc<Texture>>, channel: usize| {
            map.clone().filter(|map| map.least[channel] < u8::MAX)
        };
        Self {
            opacity: material.opacity,
            opacity_map: map(&material.opacity_map, 0),
            diffuse_map: map(&material.diffuse_map, 3),
        }
    }

    /// Every map that is read.
    pub fn maps(&self) -> impl Iterator<Item = &Arc<Texture>> {
        [self.opacity_map.as_ref(), self.diffuse_map.as_ref()].into_iter().flatten()
    }

    /// Whether both are the same factors.
    fn is(&self, other: &Self) -> bool {
        let same = |own: &Option<Arc<Texture>>, other: &Option<Arc<Texture>>| {
            own.as_ref().map(Arc::as_ptr) == other.as_ref().map(Arc::as_ptr)
        };
        self.opacity == other.opacity
            && same(&self.opacity_map, &other.opacity_map)
            && same(&self.diffuse_map, &other.diffuse_map)
    }

    fn is_constant(&self) -> bool {
        self.maps().next().is_none()
    }

    /// What is left of it from `cutoff` on; `None` if nothing is: no map raises the constant factor.
    fn cut(self, cutoff: f32) -> Option<Transparency> {
        if self.opacity < cutoff {
            None
        } else if self.is_constant() || cutoff <= 0.0 {
            Some(Transparency::Opaque)
        } else {
            Some(Transparency::CutOut(AlphaTest { cutoff, probe: Surface::of_alpha(self) }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::texture::{ColorSpace, Image};
    use crate::model::{Filter, Wrap};

    fn map(texels: Vec<[u8; 4]>) -> Option<Arc<Texture>> {
        let image = Image { width: 1, height: u32::try_from(texels.len()).unwrap(), texels };
        Some(Arc::new(Texture::new(Arc::new(image), ColorSpace::Linear, Filter::Nearest, [Wrap::Repeat; 2])))
    }

    fn picture(material: &Material) -> Option<Opacity> {
        of_output(material, Output::Color).map(|t| t.opacity())
    }

    fn solid(material: &Material) -> Option<Opacity> {
        of_solid(material).map(|t| t.opacity())
    }

    #[test]
    fn a_constant_alpha_needs_no_test() {
        let of = |opacity: f32, alpha_cutoff: Option<f32>| {
            let material = Material { opacity, alpha_cutoff, ..Material::default() };
            (picture(&material), solid(&material))
        };
        let (opaque, blended) = (Some(Opacity::Opaque), Some(Opacity::Blended));
        assert_eq!(of(1.0, None), (opaque, opaque));
        assert_eq!(of(0.5, None), (blended, opaque));
        assert_eq!(of(0.499, None), (blended, None));
        assert_eq!(of(0.0, None), (None, None));
        assert_eq!(of(0.3, Some(0.3)), (opaque, opaque));
        assert_eq!(of(0.3, Some(0.31)), (None, None));
        assert_eq!(of(0.0, Some(0.0)), (opaque, opaque));
    }

    #[test]
    fn maps_without_holes_are_no_maps() {
        let white = vec![[255; 4], [255, 0, 0, 255]];
        let full =
            Material { diffuse_map: map(white.clone()), opacity_map: map(white), ..Material::default() };
        assert_eq!((picture(&full), solid(&full)), (Some(Opacity::Opaque), Some(Opacity::Opaque)));
        let red = Material { opacity_map: map(vec![[254, 255, 255, 255]]), ..Material::default() };
        assert_eq!((picture(&red), solid(&red)), (Some(Opacity::Blended), Some(Opacity::CutOut)));
        let clear = Material { diffuse_map: map(vec![[255, 255, 255, 254]]), ..Material::default() };
        assert_eq!((picture(&clear), solid(&clear)), (Some(Opacity::Blended), Some(Opacity::CutOut)));
        let cut = Material { alpha_cutoff: Some(0.2), ..clear };
        assert_eq!((picture(&cut), solid(&cut)), (Some(Opacity::CutOut), Some(Opacity::CutOut)));
    }

    #[test]
    fn holes_are_those_of_a_map_and_a_cutoff() {
        let test = |opacity_map: &Option<Arc<Texture>>, cutoff: f32| {
            let material = Material {
                opacity_map: opacity_map.clone(),
                alpha_cutoff: Some(cutoff),
                ..Material::default()
            };
            of_solid(&material).and_then(Transparency::into_test).unwrap()
        };
        let (red, copy) = (map(vec![[9, 0, 0, 255]]), map(vec![[9, 0, 0, 255]]));
        assert!(test(&red, 0.5).has_the_holes_of(&test(&red, 0.5)));
        assert!(!test(&red, 0.5).has_the_holes_of(&test(&red, 0.6)));
        assert!(!test(&red, 0.5).has_the_holes_of(&test(&copy, 0.5)));
    }

    #[test]
    fn data_outputs_know_no_blending() {
        let glass = Material { opacity: 0.6, ..Material::default() };
        for output in [Output::Normal, Output::Albedo, Output::Depth, Output::Instance] {
            let settled = of_output(&glass, output).map(|t| t.opacity());
            assert_eq!(settled, Some(Opacity::Opaque));
        }
    }
}
