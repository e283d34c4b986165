//! The entries of `textures` and `materials`.

use super::color::Color;
use super::reader::Node;
use super::writer::{Fields, ToJson};
use crate::model::texture::ColorSpace;
use crate::model::{Filter, Shading, Wrap};
use serde_json::Value;

/// A texture.
#[derive(Clone, Debug, PartialEq)]
pub struct TexturePart {
    /// Where its texels come from.
    pub source: TextureSource,
    /// `None`: by use, see [`super::Document::color_spaces`].
    pub color_space: Option<ColorSpace>,
    /// Between texels.
    pub filter: Filter,
    /// Outside the unit square.
    pub wrap: Wrap,
}

/// Where a texture's texels come from.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureSource {
    /// An image file.
    File(String),
    /// A chequer over the unit square.
    Checker {
        /// The first is at (0, 0).
        colors: [Color; 2],
        /// Fields along a side.
        cells: u64,
    },
}

impl TexturePart {
    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let file = o.optional("file", |n| Some(n.file()));
        let checker = o.optional("checker", |n| Some(checker(n)));
        let source = match (file, checker) {
            (Some(file), None) => file.map(TextureSource::File),
            (None, Some(checker)) => checker,
            (None, None) => {
                o.fault("needs a file or a checker");
                None
            }
            (Some(_), Some(_)) => {
                o.fault("has both a file and a checker; set one of them to null");
                None
            }
        };
        let color_space = o.optional("color_space", Node::one_of);
        let filter = o.or("filter", Filter::Trilinear, Node::one_of);
        let wrap = o.or("wrap", Wrap::Repeat, Node::one_of);
        o.finish();
        Some(Self { source: source?, color_space, filter, wrap })
    }
}

fn checker(node: Node) -> Option<TextureSource> {
    let mut o = node.object()?;
    let colors = o.or("colors", Some([Color::grey(0.25), Color::grey(0.75)]), |n| {
        let read: Vec<_> = n.clone().items()?.into_iter().map(Node::color).collect();
        if read.len() != 2 {
            n.fault(format!("must hold 2 colours, holds {}", read.len()));
        }
        Some(read.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok())
    });
    let cells = o.or("cells", 8, |n| n.count_from(1));
    o.finish();
    colors.map(|colors| TextureSource::Checker { colors, cells })
}

impl ToJson for TexturePart {
    fn to_json(&self) -> Value {
        match &self.source {
            TextureSource::File(file) => Fields::new().with("file", file),
            source @ TextureSource::Checker { .. } => Fields::new().with("checker", source),
        }
        .with_some("color_space", self.color_space.map(Named).as_ref())
        .with_word("filter", self.filter)
        .with_word("wrap", self.wrap)
        .finish()
    }
}

impl ToJson for TextureSource {
    fn to_json(&self) -> Value {
        match self {
            Self::File(file) => file.to_json(),
            Self::Checker { colors, cells } => {
                Fields::new().with("colors", colors).with("cells", cells).finish()
            }
        }
    }
}

/// An optional word on its way into an object.
struct Named<W>(W);

impl<W: super::words::Word> ToJson for Named<W> {
    fn to_json(&self) -> Value {
        Value::String(self.0.word().to_owned())
    }
}

/// A surface. Maps are names of textures.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialPart {
    /// How it answers to light.
    pub shading: Shading,
    /// Diffuse reflectance.
    pub diffuse: Color,
    /// Specular reflectance.
    pub specular: Color,
    /// Exponent of the highlight, ≥ 0.
    pub shininess: f64,
    /// `None`: the diffuse colour with its map.
    pub ambient: Option<Color>,
    /// Light it gives off.
    pub emissive: Color,
    /// 0 to 1.
    pub opacity: f64,
    /// Below this alpha a fragment does not exist.
    pub alpha_cutoff: Option<f64>,
    /// Drawn from both sides.
    pub double_sided: bool,
    /// Height in world units at texel value 1 of `bump_map`.
    pub bump_scale: f64,
    /// Texture names in the order of [`MapUse::ALL`].
    pub maps: [Option<String>; 6],
}

/// What a material uses a texture for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapUse {
    /// Multiplies `diffuse`.
    Diffuse,
    /// Multiplies `specular`.
    Specular,
    /// Multiplies `emissive`.
    Emissive,
    /// Tangent-space normals.
    Normal,
    /// Heights.
    Bump,
    /// Multiplies `opacity`.
    Opacity,
}

impl MapUse {
    /// In the order of [`MaterialPart::maps`].
    pub const ALL: [Self; 6] =
        [Self::Diffuse, Self::Specular, Self::Emissive, Self::Normal, Self::Bump, Self::Opacity];

    /// The material's field.
    #[must_use]
    pub fn field(self) -> &'static str {
        match self {
            Self::Diffuse => "diffuse_map",
            Self::Specular => "specular_map",
            Self::Emissive => "emissive_map",
            Self::Normal => "normal_map",
            Self::Bump => "bump_map",
            Self::Opacity => "opacity_map",
        }
    }

    /// How its texels are read where the texture does not say: colours as sRGB, numbers as they are.
    #[must_use]
    pub fn color_space(self) -> ColorSpace {
        match self {
            Self::Diffuse | Self::Specular | Self::Emissive => ColorSpace::Srgb,
            Self::Normal | Self::Bump | Self::Opacity => ColorSpace::Linear,
        }
    }
}

impl Default for MaterialPart {
    fn default() -> Self {
        Self {
            shading: Shading::BlinnPhong,
            diffuse: Color::grey(0.8),
            specular: Color::grey(0.0),
            shininess: 32.0,
            ambient: None,
            emissive: Color::grey(0.0),
            opacity: 1.0,
            alpha_cutoff: None,
            double_sided: false,
            bump_scale: 0.02,
            maps: Default::default(),
        }
    }
}

impl MaterialPart {
    /// The texture for `map_use`.
    #[must_use]
    pub fn map(&self, map_use: MapUse) -> Option<&String> {
        self.maps[map_use as usize].as_ref()
    }

    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let default = Self::default();
        let material = Self {
            shading: o.or("shading", default.shading, Node::one_of),
            diffuse: o.or("diffuse", default.diffuse, Node::color),
            specular: o.or("specular", default.specular, Node::color),
            shininess: o.or("shininess", default.shininess, Node::not_negative),
            ambient: o.optional("ambient", Node::color),
            emissive: o.or("emissive", default.emissive, Node::color),
            opacity: o.or("opacity", default.opacity, |n| n.number_in(0.0, 1.0)),
            alpha_cutoff: o.optional("alpha_cutoff", |n| n.number_in(0.0, 1.0)),
            double_sided: o.or("double_sided", default.double_sided, Node::flag),
            bump_scale: o.or("bump_scale", default.bump_scale, Node::coordinate),
            maps: MapUse::ALL.map(|map_use| o.optional(map_use.field(), Node::name)),
        };
        o.finish();
        Some(material)
    }
}

impl ToJson for MaterialPart {
    fn to_json(&self) -> Value {
        let fields = Fields::new()
            .with_word("shading", self.shading)
            .with("diffuse", &self.diffuse)
            .with("specular", &self.specular)
            .with("shininess", &self.shininess)
            .with_some("ambient", self.ambient.as_ref())
            .with("emissive", &self.emissive)
            .with("opacity", &self.opacity)
            .with_some("alpha_cutoff", self.alpha_cutoff.as_ref())
            .with("double_sided", &self.double_sided)
            .with("bump_scale", &self.bump_scale);
        MapUse::ALL
            .iter()
            .fold(fields, |fields, map_use| fields.with_some(map_use.field(), self.map(*map_use)))
            .finish()
    }
}
