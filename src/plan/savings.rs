//! What the elisions of a frame save, in words, as far as it is known before the frame is drawn.

use super::passes::{counted, shown_unshaded};
use super::{Elision, Filter, LeftOut, Part, Plan, PostChain, ShadowPass, Spared};
use crate::scene::{Background, LightKind};

/// An elision that a frame has use for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Saving {
    /// Which.
    pub elision: Elision,
    /// What the frame would do without it.
    pub saves: String,
}

impl Plan {
    /// What each elision saves, in the order of the passes; those that this frame has no use for are absent.
    #[must_use]
    pub fn savings(&self) -> Vec<Saving> {
        let saving = |elision| Some(Saving { elision, saves: self.saving(elision)? });
        self.elide.iter().filter_map(saving).collect()
    }

    fn saving(&self, elision: Elision) -> Option<String> {
        match elision {
            Elision::UnseenShadows | Elision::DarkLights | Elision::CubeSides | Elision::OutsideInstances => {
                self.saved_parts(elision)
            }
            Elision::OutsideTriangles
            | Elision::Clipping
            | Elision::TilesPassedBy
            | Elision::UniformBlocks
            | Elision::HiddenBlocks => self.saved_of_triangles(elision),
            Elision::AbsentMaps
            | Elision::ConstantMaps
            | Elision::FlatRelief
            | Elision::BlackSpecular
            | Elision::TurnedAway
            | Elision::DecidedTaps => self.saved_of_shading(elision),
            Elision::PlainTiles => self.saved_tiles(),
            Elision::CoveredSky | Elision::UniformPixels => self.saved_of_pixels(elision),
            Elision::NeutralEffects | Elision::PointwisePasses => self.saved_of_post(elision),
        }
    }

    fn elided_by(&self, elision: Elision) -> impl Iterator<Item = &LeftOut> {
        self.left_out.iter().filter(move |left| left.reason.elision() == Some(elision))
    }

    /// What is known part by part.
    fn saved_parts(&self, elision: Elision) -> Option<String> {
        let parts: Vec<String> = self.elided_by(elision).filter_map(|left| self.saved_with(*left)).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// What is saved with a part that an elision leaves out.
    #[must_use]
    pub fn saved_with(&self, left: LeftOut) -> Option<String> {
        left.reason.elision()?;
        match left.part {
            Part::Instance(index) => {
                let mesh = self.scene.mesh(&self.scene.instances[index as usize]);
                let (vertices, triangles) = (mesh.vertex_count(), mesh.triangles.len());
                let (vertices, triangles) = (counted(vertices, "corner"), counted(triangles, "triangle"));
                Some(format!("{vertices} and {triangles}"))
            }
            Part::Light(_) => Some("one term of the sum of light on every lit fragment".to_owned()),
            Part::Shadow(index) => self.saved_maps(index),
            Part::Side { light, .. } => Some(format!("{} of depth", self.texels(light)?)),
            Part::Effect(_) => Some(format!("a pass over {}", self.picture())),
            Part::Slot { .. }
            | Part::Caster { .. }
            | Part::Background
            | Part::Samples
            | Part::RenderScale
            | Part::View => None,
        }
    }

    /// `2048² texels`: of one map of a light.
    fn texels(&self, light: u32) -> Option<String> {
        let shadow = self.knobs.shadow(self.scene.lights[light as usize].shadow?);
        Some(format!("{}² texels", shadow.resolution))
    }

    fn saved_maps(&self, light: u32) -> Option<String> {
        let texels = self.texels(light)?;
        Some(match self.scene.lights[light as usize].kind {
            LightKind::Directional { .. } => format!("{texels} of depth"),
            LightKind::Point { .. } => format!("up to 6 · {texels} of depth"),
        })
    }

    /// `640 × 480 pixels`
    fn picture(&self) -> String {
        format!("{} × {} pixels", self.view.width, self.view.height)
    }

    fn saved_of_triangles(&self, elision: Elision) -> Option<String> {
        let count: usize = self.items.iter().map(|item| item.mesh.triangles.len()).sum();
        if count == 0 {
            return None;
        }
        let (triangles, samples) = (counted(count, "triangle"), self.samples);
        Some(match elision {
            Elision::OutsideTriangles => format!("set-up of what of the {triangles} lies outside the view"),
            Elision::Clipping => {
                format!("six planes to clip at, for what of the {triangles} none of them cuts")
            }
            Elision::TilesPassedBy => {
                "an entry in each tile of a triangle's box that its edges miss".to_owned()
            }
            Elision::UniformBlocks => {
                format!("up to 3 · 64 · {samples} edge tests in each block that no edge crosses")
            }
            _ => format!("64 · {samples} depths in each block that lies behind what is drawn"),
        })
    }

    fn saved_of_shading(&self, elision: Elision) -> Option<String> {
        if shown_unshaded(self.output).is_some() {
            return None;
        }
        match elision {
            Elision::AbsentMaps => self.saved_samples("colour", |draw| draw.absent_maps),
            Elision::ConstantMaps => self.saved_samples("colour", |draw| draw.constant_maps),
            Elision::FlatRelief => self.saved_samples("relief", |draw| draw.flat_relief),
            Elision::BlackSpecular => self.saved_highlights(),
            Elision::TurnedAway => self.is_lit().then(|| {
                let lights = counted(self.lights.len(), "light");
                format!("the light of {lights}, shadows and all, on what is turned away")
            }),
            _ => self.saved_taps(),
        }
    }

    fn is_lit(&self) -> bool {
        !self.lights.is_empty() && self.draws.iter().any(|draw| draw.surface.lit)
    }

    /// `2 colour samples a fragment in 2 of 3 draws`
    fn saved_samples(&self, of: &str, count: impl Fn(&Spared) -> u64) -> Option<String> {
        let counts = self.draws.iter().map(|draw| count(&draw.surface.spared)).filter(|count| *count > 0);
        let counts: Vec<u64> = counts.collect();
        let most = usize::try_from(*counts.iter().max()?).ok()?;
        let (samples, draws) = (counted(most, &format!("{of} sample")), counted(self.draws.len(), "draw"));
        let upto = if counts.iter().all(|&count| count == counts[0]) { "" } else { "up to " };
        Some(format!("{upto}{samples} a fragment in {} of {draws}", counts.len()))
    }

    fn saved_highlights(&self) -> Option<String> {
        let draws = self.draws.iter().filter(|draw| draw.surface.spared.highlights > 0).count();
        let lights = counted(self.lights.len(), "light");
        let all = counted(self.draws.len(), "draw");
        (self.is_lit() && draws > 0).then(|| {
            format!("a half vector and a power for each of {lights} on each fragment of {draws} of {all}")
        })
    }

    fn saved_taps(&self) -> Option<String> {
        let taps = |shadow: &ShadowPass| match shadow.filter {
            Filter::Hard => None,
            Filter::Pcf { taps, .. } => Some(taps.to_string()),
            Filter::Pcss(pcss) => Some(format!("{} + {}", pcss.search_taps, pcss.filter_taps)),
        };
        let all: Vec<String> = self.shadows.iter().filter_map(taps).collect();
        (!all.is_empty()).then(|| {
            format!("{} taps a lit pixel that is wholly in the light or in the shadow", all.join(" and "))
        })
    }

    fn saved_tiles(&self) -> Option<String> {
        let is_plain = matches!(self.background, Background::Color(_) | Background::Transparent);
        (is_plain && shown_unshaded(self.output).is_none())
            .then(|| format!("all but one row of what of {} lies in tiles without triangles", self.picture()))
    }

    fn saved_of_pixels(&self, elision: Elision) -> Option<String> {
        if shown_unshaded(self.output).is_some() || self.items.is_empty() {
            return None;
        }
        let (picture, samples) = (self.picture(), counted(self.samples as usize, "sample"));
        Some(match elision {
            Elision::CoveredSky => format!("the background of what of {picture} is covered"),
            _ => format!("a mean of {samples} for each pixel that one surface fills"),
        })
    }

    fn saved_of_post(&self, elision: Elision) -> Option<String> {
        if elision == Elision::NeutralEffects {
            return self.saved_parts(elision);
        }
        let (steps, picture) = (self.post.fused, self.picture());
        if steps == 0 {
            return None;
        }
        let passes = counted(steps, "step");
        Some(if self.post.passes.is_empty() {
            let bytes = 3 * PostChain::stride(self.view.width) as u64 * u64::from(self.view.height) * 4;
            format!(
                "a pass for each of {passes} over {picture}, and the {} of 32-bit floats that they are kept in",
                megabytes(bytes)
            )
        } else {
            format!("a pass for each of {passes} over {picture}")
        })
    }
}

/// `5.5 MB`
fn megabytes(bytes: u64) -> String {
    let tenths = (bytes + 50_000) / 100_000;
    format!("{}.{} MB", tenths / 10, tenths % 10)
}
