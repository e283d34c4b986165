//! What a plan leaves out, and why. It is noted in numbers where it is decided, on the way of every frame;
//! words are made of it when someone asks.

use super::{Elision, Output};
use crate::scene::Scene;
use crate::scene::document::FACES;
use std::fmt::{Display, Formatter};

/// A part of the scene, or of a request, that the frame goes without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What.
    pub part: Part,
    /// Why.
    pub reason: Reason,
}

/// What a frame can go without. Numbers are indices into the scene's lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// An instance.
    Instance(u32),
    /// The triangles of one material slot of an instance.
    Slot {
        /// Whose.
        instance: u32,
        /// Index into the mesh's slots.
        slot: u32,
    },
    /// A light.
    Light(u32),
    /// The shadow of a light.
    Shadow(u32),
    /// An instance in the shadow maps of a light.
    Caster {
        /// The light.
        light: u32,
        /// The instance.
        instance: u32,
    },
    /// One of the six maps around a light.
    Side {
        /// The light.
        light: u32,
        /// In the order +x, −x, +y, −y, +z, −z.
        side: usize,
    },
    /// An effect of `post`.
    Effect(usize),
    /// The background.
    Background,
    /// Samples beyond the first.
    Samples,
    /// Pixels of another size than the picture's.
    RenderScale,
    /// All that the camera sees.
    View,
}

/// Why a frame goes without it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The document hides the instance.
    Hidden,
    /// The mesh has no triangles.
    NoTriangles,
    /// It lies outside of the view volume.
    OutsideOfTheView,
    /// Its alpha is below what is drawn.
    Clear,
    /// The document switches the light off.
    SwitchedOff,
    /// The light's colour or intensity is 0.
    Black,
    /// No surface that is drawn asks for lights.
    NothingLit,
    /// The document draws no shadows.
    NoShadows,
    /// No lit surface that is drawn takes shadows.
    NothingReceives,
    /// No instance throws a shadow on anything.
    NothingCasts,
    /// No receiver lies where a shadow could fall.
    NothingBehind,
    /// The document says that the instance casts no shadow.
    CastsNone,
    /// The instance can shade neither itself nor anything else.
    ShadesNothing,
    /// No caster lies on this side of the light.
    NoCasterThere,
    /// No receiver looks at this side of the light.
    NoReceiverThere,
    /// A tone mapper without a curve at exposure 1.
    NoCurve,
    /// The effect's amount is 0.
    NoAmount,
    /// The glow's intensity is 0.
    NoIntensity,
    /// A matrix or kernel that keeps every colour.
    Identity,
    /// A blur that reaches no other pixel.
    TooSmall,
    /// The output shows data, which it does not change.
    Data(Output),
    /// The output shows what lights see.
    ViewsOfLights,
    /// The output shows light as it is before the effects.
    BeforePost,
}

impl Part {
    /// It in the words of the document.
    #[must_use]
    pub fn describe(&self, scene: &Scene) -> String {
        let instance = |index: u32| format!("instance {:?}", scene.instances[index as usize].name);
        let light = |index: u32| format!("light {:?}", scene.lights[index as usize].name);
        match *self {
            Self::Instance(index) => instance(index),
            Self::Slot { instance: index, slot } => format!("material slot {slot} of {}", instance(index)),
            Self::Light(index) => light(index),
            Self::Shadow(index) => format!("shadow of {}", light(index)),
            Self::Caster { light: of, instance: index } => {
                format!("{} in the shadow of {}", instance(index), light(of))
            }
            Self::Side { light: of, side } => {
                format!("shadow map {} around {}", FACES[side], light(of))
            }
            Self::Effect(index) => format!("post effect {index} ({})", scene.post[index].type_name()),
            Self::Background => "background".to_owned(),
            Self::Samples => "samples".to_owned(),
            Self::RenderScale => "render scale".to_owned(),
            Self::View => "view of the camera".to_owned(),
        }
    }
}

impl Reason {
    /// The elision that decides on it; `None`: the scene or the request does.
    #[must_use]
    pub fn elision(self) -> Option<Elision> {
        match self {
            Self::OutsideOfTheView => Some(Elision::OutsideInstances),
            Self::SwitchedOff | Self::Black | Self::NothingLit => Some(Elision::DarkLights),
            Self::NothingReceives => Some(Elision::UnseenShadows),
            Self::NoCasterThere | Self::NoReceiverThere => Some(Elision::CubeSides),
            Self::NoCurve | Self::NoAmount | Self::NoIntensity | Self::Identity | Self::TooSmall => {
                Some(Elision::NeutralEffects)
            }
            Self::Hidden
            | Self::NoTriangles
            | Self::Clear
            | Self::NoShadows
            | Self::NothingCasts
            | Self::NothingBehind
            | Self::CastsNone
            | Self::ShadesNothing
            | Self::Data(_)
            | Self::ViewsOfLights
            | Self::BeforePost => None,
        }
    }
}

impl Display for Reason {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let text = match self {
            Self::Hidden => "it is not visible",
            Self::NoTriangles => "its mesh has no triangles",
            Self::OutsideOfTheView => "outside of the view",
            Self::Clear => "it is clear: its opacity is below what is drawn",
            Self::SwitchedOff => "it is switched off",
            Self::Black => "it is black: its colour or its intensity is 0",
            Self::NothingLit => "nothing that is drawn is lit",
            Self::NoShadows => "render.shadows is off",
            Self::NothingReceives => "no lit surface in the view takes shadows",
            Self::NothingCasts => "nothing throws a shadow on anything",
            Self::NothingBehind => "nothing that takes shadows lies behind what casts them",
            Self::CastsNone => "its casts_shadow is off",
            Self::ShadesNothing => "nothing that takes shadows lies behind it",
            Self::NoCasterThere => "nothing casts a shadow on this side",
            Self::NoReceiverThere => "nothing takes a shadow on this side",
            Self::NoCurve => "without a curve, exposure 1 changes nothing",
            Self::NoAmount => "an amount of 0 changes nothing",
            Self::NoIntensity => "a glow of intensity 0 changes nothing",
            Self::Identity => "it keeps every colour",
            Self::TooSmall => "its radius reaches no other pixel",
            Self::ViewsOfLights => "the picture shows what lights see",
            Self::BeforePost => "linear colour is taken before post",
            Self::Data(output) => return write!(f, "output={} has no use for it", output.word()),
        };
        f.write_str(text)
    }
}
