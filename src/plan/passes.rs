//! The passes of a frame in their order, each with a sentence that says why it runs or why it does not.

use super::{Output, Part, Plan, ShadowPass};
use crate::scene::Background;
use std::collections::BTreeSet;

/// One pass, by its name in `Server-Timing`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pass {
    /// `shadow`, `geometry`, …
    pub name: &'static str,
    /// Whether the frame needs it.
    pub runs: bool,
    /// Why, or why not.
    pub reason: String,
}

/// What a pass does in a frame, or why the frame goes without it.
type Why = Result<String, String>;

impl Plan {
    /// Every pass there is, in order.
    #[must_use]
    pub fn passes(&self) -> Vec<Pass> {
        let passes = [
            ("shadow", self.why_shadow()),
            ("geometry", self.why_geometry()),
            ("raster", self.why_raster()),
            ("shade", self.why_shade()),
            ("sky", self.why_sky()),
            ("resolve", self.why_resolve()),
            ("post", self.why_post()),
            ("resample", self.why_resample()),
            ("encode", Ok("The picture is written as a file.".to_owned())),
        ];
        let pass = |(name, why): (_, Why)| {
            let runs = why.is_ok();
            Pass { name, runs, reason: why.unwrap_or_else(|reason| reason) }
        };
        passes.into_iter().map(pass).collect()
    }

    fn why_shadow(&self) -> Why {
        if !self.shadows.is_empty() {
            let maps = || self.shadows.iter().flat_map(ShadowPass::faces);
            let casters: BTreeSet<u32> = maps().flat_map(|map| &map.casters).copied().collect();
            let lights = counted(self.shadows.len(), "light");
            let (casters, maps) = (counted(casters.len(), "instance"), counted(maps().count(), "map"));
            return Ok(format!("Shadows of {lights}: {casters} drawn into {maps} of depth."));
        }
        if self.lights.is_empty() {
            return Err("No light shines on anything that is drawn.".to_owned());
        }
        let without = self.left_out.iter().find(|left| matches!(left.part, Part::Shadow(_)));
        Err(without.map_or_else(
            || "No light that shines asks for a shadow.".to_owned(),
            |left| format!("No shadow can be seen: {}.", left.reason),
        ))
    }

    fn why_geometry(&self) -> Why {
        if self.output == Output::ShadowMap {
            return Err("The picture shows what lights see, not what the camera sees.".to_owned());
        }
        if self.items.is_empty() {
            return Err("No instance reaches into the view.".to_owned());
        }
        let triangles = self.items.iter().map(|item| item.mesh.triangles.len()).sum();
        let (triangles, items) = (counted(triangles, "triangle"), counted(self.items.len(), "instance"));
        Ok(format!("{triangles} of {items} are transformed, clipped and listed tile by tile."))
    }

    fn why_raster(&self) -> Why {
        let samples = counted(self.samples as usize, "sample");
        if self.items.is_empty() {
            return Ok("Each tile is looked at, and finds nothing in it.".to_owned());
        }
        Ok(format!("Each tile finds which triangle its pixels see, at {samples} a pixel."))
    }

    fn why_shade(&self) -> Why {
        if let Some(instead) = shown_unshaded(self.output) {
            return Err(instead.to_owned());
        }
        if self.draws.is_empty() {
            return Err("Nothing is drawn that has a colour.".to_owned());
        }
        let draws = counted(self.draws.len(), "draw");
        let lights = match self.lights.len() {
            0 => "without lights".to_owned(),
            count => format!("by {}", counted(count, "light")),
        };
        Ok(format!("{draws}: each triangle is shaded once in every pixel that sees it, {lights}."))
    }

    fn why_sky(&self) -> Why {
        if let Some(instead) = shown_unshaded(self.output) {
            return Err(instead.to_owned());
        }
        let kind = match &self.background {
            _ if !self.output.is_shaded() => "black, which stands for nothing",
            Background::Color(_) => "one colour",
            Background::Gradient { .. } => "a gradient",
            Background::Sky(_) => "a computed sky",
            Background::CubeMap(_) => "a cube map",
            Background::Panorama(_) => "a panorama",
            Background::Transparent => "transparent",
        };
        Ok(format!("Where a pixel sees the background, it is {kind}."))
    }

    fn why_resolve(&self) -> Why {
        let samples = counted(self.samples as usize, "sample");
        match self.output {
            Output::Depth | Output::Instance => Err("Each pixel has one value, found by raster.".to_owned()),
            Output::Ids | Output::Tiles => Err("Colours stand for numbers, found by raster.".to_owned()),
            Output::Wireframe => Ok("Lines are drawn along the edges of what the pixels see.".to_owned()),
            Output::ShadowMap => Ok("The maps are laid out side by side.".to_owned()),
            Output::Shaded => Ok("The fragments of each pixel are counted.".to_owned()),
            _ if !self.post.passes.is_empty() => {
                Ok(format!("A pixel is the mean of {samples}, kept in linear light for post."))
            }
            _ if self.post.in_tiles.is_empty() => Ok(format!("A pixel is the mean of {samples}.")),
            _ => {
                let effects = counted(self.post.in_tiles.len(), "effect");
                Ok(format!("A pixel is the mean of {samples}, and goes through {effects} on its way."))
            }
        }
    }

    fn why_resample(&self) -> Why {
        if !self.is_resampled() {
            return Err("The pixels that are drawn are those of the picture.".to_owned());
        }
        let ([width, height], [drawn_width, drawn_height]) = (self.size, [self.view.width, self.view.height]);
        Ok(format!("{drawn_width} × {drawn_height} pixels are drawn for a picture of {width} × {height}."))
    }

    fn why_post(&self) -> Why {
        if !self.post.passes.is_empty() {
            let (effects, passes) = self.post.work();
            let (effects, passes) = (counted(effects, "effect"), counted_passes(passes));
            return Ok(format!("The whole picture is kept: {effects} in {passes} over it."));
        }
        if !self.post.in_tiles.is_empty() {
            return Err(
                "Every effect needs one pixel alone, so resolve applies them in its tiles.".to_owned()
            );
        }
        let without = self.left_out.iter().find(|left| matches!(left.part, Part::Effect(_)));
        Err(without.map_or_else(
            || "The scene has no effects.".to_owned(),
            |left| format!("No effect would change the picture: {}.", left.reason),
        ))
    }
}

/// What an output shows in place of colours; `None` if it is shaded.
pub(super) fn shown_unshaded(output: Output) -> Option<&'static str> {
    match output {
        Output::Color | Output::Radiance | Output::Normal | Output::Albedo | Output::Shaded => None,
        Output::Depth => Some("Depth is a distance: no colour is needed."),
        Output::Instance => Some("An instance has a number: no colour is needed."),
        Output::Wireframe => Some("Lines are white on black: no colour is needed."),
        Output::Ids => Some("An instance has a colour for its number: none is computed."),
        Output::ShadowMap => Some("Shadow maps hold depth: no colour is needed."),
        Output::Tiles => Some("A tile shows how many triangles it lists: their colours are not needed."),
    }
}

/// `1 pass`, `2 passes`.
fn counted_passes(count: usize) -> String {
    format!("{count} pass{}", if count == 1 { "" } else { "es" })
}

/// `1 light`, `2 lights`.
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
