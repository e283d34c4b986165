//! The `environment` part: ambient light and what is drawn where nothing else is.

use super::color::Color;
use super::reader::{Node, clipped, suggestion};
use super::writer::{Fields, ToJson};
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeMap;

/// Ambient light and background.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentPart {
    /// Ambient radiance.
    pub ambient: Color,
    /// What is drawn where nothing else is.
    pub background: BackgroundChoice,
    /// Backgrounds to choose from.
    pub backgrounds: BTreeMap<String, BackgroundPart>,
}

/// A background, or the name of one in `backgrounds`.
#[derive(Clone, Debug, PartialEq)]
pub enum BackgroundChoice {
    /// Described in place.
    Here(BackgroundPart),
    /// A name of [`EnvironmentPart::backgrounds`].
    Named(String),
}

/// What is drawn where nothing else is.
#[derive(Clone, Debug, PartialEq)]
pub enum BackgroundPart {
    /// One colour.
    Color(Color),
    /// From `bottom` to `top` by elevation.
    Gradient {
        /// Straight up.
        top: Color,
        /// Straight down.
        bottom: Color,
    },
    /// A procedural sky.
    Sky {
        /// The way the sun's light travels; `None`: as the first enabled directional light.
        sun_direction: Option<DVec3>,
        /// Haze: 2 is clear, 10 is hazy.
        turbidity: f64,
    },
    /// Six images by face: `px nx py ny pz nz`.
    Cubemap {
        /// File names in the order of [`FACES`].
        faces: [String; 6],
    },
    /// An equirectangular image.
    Equirect {
        /// Its file name.
        file: String,
    },
    /// Alpha 0.
    Transparent,
}

/// Names of a cube map's faces: seen looking along +x, −x, +y, −y, +z, −z.
pub const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];

const TYPES: [&str; 6] = ["color", "gradient", "sky", "cubemap", "equirect", "transparent"];

impl Default for BackgroundPart {
    fn default() -> Self {
        Self::Gradient { top: hex("#6ea8e8"), bottom: hex("#dfe9f5") }
    }
}

fn hex(text: &str) -> Color {
    Color::from_hex(text).expect("invariant: a literal colour")
}

impl Default for EnvironmentPart {
    fn default() -> Self {
        Self {
            ambient: Color::grey(0.05),
            background: BackgroundChoice::Here(BackgroundPart::default()),
            backgrounds: BTreeMap::new(),
        }
    }
}

impl EnvironmentPart {
    /// The background that is chosen. A checked document names none that is not there.
    #[must_use]
    pub fn chosen(&self) -> Option<&BackgroundPart> {
        match &self.background {
            BackgroundChoice::Here(part) => Some(part),
            BackgroundChoice::Named(name) => self.backgrounds.get(name),
        }
    }

    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let default = Self::default();
        let environment = Self {
            ambient: o.or("ambient", default.ambient, Node::color),
            backgrounds: o.or("backgrounds", BTreeMap::new(), |n| n.map_of(BackgroundPart::read)),
            background: o.or("background", default.background, BackgroundChoice::read),
        };
        if let BackgroundChoice::Named(name) = &environment.background
            && !environment.backgrounds.contains_key(name)
        {
            let nearest = suggestion(name, environment.backgrounds.keys().map(String::as_str));
            o.fault_at("background", format!("there is no {:?} in backgrounds{nearest}", clipped(name)));
        }
        o.finish();
        Some(environment)
    }
}

impl BackgroundChoice {
    fn read(node: Node) -> Option<Self> {
        if node.is_string() {
            node.name().map(Self::Named)
        } else {
            BackgroundPart::read(node).map(Self::Here)
        }
    }
}

impl BackgroundPart {
    fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let part = match o.required("type", |n| n.tag(&TYPES))? {
            "color" => o.required("color", Node::color).map(Self::Color),
            "gradient" => Some(Self::Gradient {
                top: o.or("top", hex("#6ea8e8"), Node::color),
                bottom: o.or("bottom", hex("#dfe9f5"), Node::color),
            }),
            "sky" => Some(Self::Sky {
                sun_direction: o.optional("sun_direction", Node::direction),
                turbidity: o.or("turbidity", 3.0, |n| n.number_in(1.0, 20.0)),
            }),
            "cubemap" => o.required("faces", faces).map(|faces| Self::Cubemap { faces }),
            "equirect" => o.required("file", Node::file).map(|file| Self::Equirect { file }),
            _ => Some(Self::Transparent),
        };
        o.finish();
        part
    }
}

fn faces(node: Node) -> Option<[String; 6]> {
    let mut o = node.object()?;
    let files: Vec<_> = FACES.iter().map(|face| o.required(face, Node::file)).collect();
    o.finish();
    files.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
}

impl ToJson for EnvironmentPart {
    fn to_json(&self) -> Value {
        Fields::new()
            .with("ambient", &self.ambient)
            .with("background", &self.background)
            .with("backgrounds", &self.backgrounds)
            .finish()
    }
}

impl ToJson for BackgroundChoice {
    fn to_json(&self) -> Value {
        match self {
            Self::Here(part) => part.to_json(),
            Self::Named(name) => name.to_json(),
        }
    }
}

impl ToJson for BackgroundPart {
    fn to_json(&self) -> Value {
        match self {
            Self::Color(color) => Fields::of_type("color").with("color", color),
            Self::Gradient { top, bottom } => {
                Fields::of_type("gradient").with("top", top).with("bottom", bottom)
            }
            Self::Sky { sun_direction, turbidity } => Fields::of_type("sky")
                .with_some("sun_direction", sun_direction.as_ref())
                .with("turbidity", turbidity),
            Self::Cubemap { faces } => {
                let by_face = FACES.iter().map(|face| (*face).to_owned()).zip(faces.iter().cloned());
                Fields::of_type("cubemap").with("faces", &by_face.collect::<BTreeMap<_, _>>())
            }
            Self::Equirect { file } => Fields::of_type("equirect").with("file", file),
            Self::Transparent => Fields::of_type("transparent"),
        }
        .finish()
    }
}
