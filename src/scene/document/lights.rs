//! The entries of `lights`.

use super::color::Color;
use super::reader::{Node, Object};
use super::writer::{Fields, ToJson};
use crate::scene::{Attenuation, ShadowCull, ShadowFilter};
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeMap;

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPart {
    /// Where its light comes from.
    pub kind: LightKindPart,
    /// Whether it shines.
    pub enabled: bool,
    /// Its colour, multiplied by `intensity`.
    pub color: Color,
    /// ≥ 0.
    pub intensity: f64,
    /// `None`: it casts no shadow.
    pub shadow: Option<ShadowPart>,
}

/// Where light comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKindPart {
    /// From infinitely far.
    Directional {
        /// The way the light travels; not zero, not normalised.
        direction: DVec3,
    },
    /// From a point.
    Point {
        /// In world space.
        position: DVec3,
        /// How it fades with distance.
        attenuation: Attenuation,
    },
}

/// How a light's shadow is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowPart {
    /// How the map is read; `None` draws no shadow.
    pub filter: Option<ShadowFilter>,
    /// Texels along a side of the map (of each face, for a point light).
    pub resolution: u64,
    /// Multiple of the offset that is just enough.
    pub bias: f64,
    /// PCF kernel radius in texels.
    pub radius: f64,
    /// PCF taps.
    pub pcf_taps: u64,
    /// PCSS: tangent of the half-angle (directional) or radius in world units (point).
    pub light_radius: f64,
    /// PCSS blocker search radius in texels; `None`: from `light_radius`.
    pub search_radius: Option<f64>,
    /// PCSS blocker taps.
    pub search_taps: u64,
    /// PCSS filter taps.
    pub filter_taps: u64,
    /// Which faces do not cast.
    pub cull: ShadowCull,
}

impl ShadowPart {
    /// The defaults of a directional light's shadow.
    #[must_use]
    pub fn directional() -> Self {
        Self {
            filter: Some(ShadowFilter::Pcf),
            resolution: 2048,
            bias: 1.0,
            radius: 1.5,
            pcf_taps: 16,
            light_radius: 0.01,
            search_radius: None,
            search_taps: 18,
            filter_taps: 36,
            cull: ShadowCull::None,
        }
    }

    /// The defaults of a point light's shadow.
    #[must_use]
    pub fn point() -> Self {
        Self { resolution: 1024, light_radius: 0.05, ..Self::directional() }
    }

    fn read(node: Node, default: &Self) -> Option<Self> {
        let mut o = node.object()?;
        let shadow = Self {
            filter: o.or("filter", default.filter, Node::one_of),
            resolution: o.or("resolution", default.resolution, |n| n.count_from(1)),
            bias: o.or("bias", default.bias, Node::not_negative),
            radius: o.or("radius", default.radius, Node::not_negative),
            pcf_taps: o.or("pcf_taps", default.pcf_taps, |n| n.count_from(1)),
            light_radius: o.or("light_radius", default.light_radius, Node::not_negative),
            search_radius: o.optional("search_radius", Node::not_negative),
            search_taps: o.or("search_taps", default.search_taps, |n| n.count_from(1)),
            filter_taps: o.or("filter_taps", default.filter_taps, |n| n.count_from(1)),
            cull: o.or("cull", default.cull, Node::one_of),
        };
        o.finish();
        Some(shadow)
    }
}

/// The one light of a document that names none: a warm sun over the left shoulder.
#[must_use]
pub fn default_lights() -> BTreeMap<String, LightPart> {
    let sun = LightPart {
        kind: LightKindPart::Directional { direction: DVec3::new(-0.5, -1.0, -0.3) },
        enabled: true,
        color: Color::from_hex("#fff4e0").expect("invariant: a literal colour"),
        intensity: 1.0,
        shadow: Some(ShadowPart::directional()),
    };
    BTreeMap::from([("sun".to_owned(), sun)])
}

impl LightPart {
    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let kind = o.required("type", |n| n.tag(&["directional", "point"]))?;
        let (kind, shadow) = match kind {
            "directional" => (directional(&mut o), ShadowPart::directional()),
            _ => (point(&mut o), ShadowPart::point()),
        };
        let enabled = o.or("enabled", true, Node::flag);
        let color = o.or("color", Color::grey(1.0), Node::color);
        let intensity = o.or("intensity", 1.0, Node::not_negative);
        let shadow = o.optional("shadow", |n| ShadowPart::read(n, &shadow));
        o.finish();
        Some(Self { kind: kind?, enabled, color, intensity, shadow })
    }
}

fn directional(o: &mut Object) -> Option<LightKindPart> {
    o.required("direction", Node::direction).map(|direction| LightKindPart::Directional { direction })
}

fn point(o: &mut Object) -> Option<LightKindPart> {
    let position = o.required("position", Node::point);
    let attenuation = o.or("attenuation", DEFAULT_ATTENUATION, attenuation);
    position.map(|position| LightKindPart::Point { position, attenuation })
}

const DEFAULT_ATTENUATION: Attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 1.0 };

fn attenuation(node: Node) -> Option<Attenuation> {
    let mut o = node.object()?;
    let attenuation = Attenuation {
        constant: o.or("constant", DEFAULT_ATTENUATION.constant, Node::not_negative),
        linear: o.or("linear", DEFAULT_ATTENUATION.linear, Node::not_negative),
        quadratic: o.or("quadratic", DEFAULT_ATTENUATION.quadratic, Node::not_negative),
    };
    if attenuation == (Attenuation { constant: 0.0, linear: 0.0, quadratic: 0.0 }) {
        o.fault("must not be zero in all of constant, linear and quadratic");
    }
    o.finish();
    Some(attenuation)
}

impl ToJson for LightPart {
    fn to_json(&self) -> Value {
        match &self.kind {
            LightKindPart::Directional { direction } => {
                Fields::of_type("directional").with("direction", direction)
            }
            LightKindPart::Point { position, attenuation } => {
                Fields::of_type("point").with("position", position).with("attenuation", attenuation)
            }
        }
        .with("enabled", &self.enabled)
        .with("color", &self.color)
        .with("intensity", &self.intensity)
        .with_some("shadow", self.shadow.as_ref())
        .finish()
    }
}

impl ToJson for Attenuation {
    fn to_json(&self) -> Value {
        Fields::new()
            .with("constant", &self.constant)
            .with("linear", &self.linear)
            .with("quadratic", &self.quadratic)
            .finish()
    }
}

impl ToJson for ShadowPart {
    fn to_json(&self) -> Value {
        Fields::new()
            .with_word("filter", self.filter)
            .with("resolution", &self.resolution)
            .with("bias", &self.bias)
            .with("radius", &self.radius)
            .with("pcf_taps", &self.pcf_taps)
            .with("light_radius", &self.light_radius)
            .with_some("search_radius", self.search_radius.as_ref())
            .with("search_taps", &self.search_taps)
            .with("filter_taps", &self.filter_taps)
            .with_word("cull", self.cull)
            .finish()
    }
}
