//! What a client asks of one frame, as typed overrides of the scene's own settings.

mod budget;
mod knobs;
mod parse;
mod query;

pub use budget::{Budget, Preset};
pub use knobs::Knobs;
pub(super) use query::quoted;
pub use query::{Query, QueryFault};

use super::Elisions;
use crate::model::Shading;
use glam::{DVec3, Vec3};

/// Overrides of one frame. `None` means "as the scene has it". Positions are in world space.
///
/// [`FrameRequest::parse`] checks every value and what contradicts what; one made by hand must keep to
/// the same rules.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameRequest {
    /// Pixels in a row.
    pub width: Option<u32>,
    /// Rows.
    pub height: Option<u32>,
    /// Samples a pixel: 1, 2, 4, 8 or 16.
    pub samples: Option<u32>,
    /// What else trades error for run time.
    pub knobs: Knobs,
    /// What it may cost or err by: nothing to a plan, which takes settled requests.
    pub budget: Option<Budget>,
    /// Seconds; a single frame's default is 0.
    pub t: f64,
    /// JPEG quality, 1–100.
    pub quality: Option<u8>,
    /// What the picture shows.
    pub output: Output,
    /// Overrides every material.
    pub shading: Option<Shading>,
    /// Where the camera stands.
    pub eye: Option<DVec3>,
    /// What it looks at.
    pub target: Option<DVec3>,
    /// Vertical field of view in degrees.
    pub fov_y_deg: Option<f64>,
    /// Nearest distance drawn.
    pub near: Option<f64>,
    /// Farthest distance drawn.
    pub far: Option<f64>,
    /// Orthographic, with this full height of the view.
    pub ortho_height: Option<f64>,
    /// Moves the camera about its target.
    pub orbit: Option<Orbit>,
    /// Turns the camera about the vertical through its target, after all else: degrees, as yaw counts.
    /// No query has it; see [`FrameRequest::turned`].
    pub turn_deg: f64,
    /// Replaces the background.
    pub background: Option<BackgroundRequest>,
    /// What may be left out; the picture is the same whatever it says. `None`: as the program was
    /// started.
    pub elide: Option<Elisions>,
}

impl FrameRequest {
    /// The same frame from `deg` degrees farther about the vertical: with an [`Orbit`], its yaw is that
    /// much more.
    #[must_use]
    pub fn turned(&self, deg: f64) -> Self {
        match self.orbit {
            Some(orbit) => {
                Self { orbit: Some(Orbit { yaw_deg: orbit.yaw_deg + deg, ..orbit }), ..self.clone() }
            }
            None => Self { turn_deg: self.turn_deg + deg, ..self.clone() },
        }
    }
}

/// A place about the target: yaw 0 looks from +z, 90 from +x; pitch 90 from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Degrees about the y axis.
    pub yaw_deg: f64,
    /// Degrees above the horizon.
    pub pitch_deg: f64,
    /// From the target; `None`: as it is.
    pub distance: Option<f64>,
}

/// `background=` of a query.
#[derive(Clone, Debug, PartialEq)]
pub enum BackgroundRequest {
    /// `transparent`
    Transparent,
    /// `rrggbb`, as linear RGB.
    Color(Vec3),
    /// A name of the document's `backgrounds`.
    Named(String),
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Output {
    /// The shaded picture.
    #[default]
    Color,
    /// 16-bit grey: distance along the viewing axis.
    Depth,
    /// World-space normals.
    Normal,
    /// The diffuse colour.
    Albedo,
    /// 16-bit grey: which instance.
    Instance,
    /// White lines on black: the edges of what is seen.
    Wireframe,
    /// A colour for each instance.
    Ids,
    /// What lights see: the shadow maps side by side.
    ShadowMap,
    /// How many triangles each tile of the picture lists.
    Tiles,
    /// How many fragments are shaded for each pixel of the picture.
    Shaded,
    /// The shaded picture in linear light, before `post`, in 32-bit floats: what the float file formats
    /// hold. No query names it.
    Radiance,
}

impl Output {
    /// Whether it shows the scene as it is lit, with samples and background.
    #[must_use]
    pub fn is_shaded(self) -> bool {
        matches!(self, Self::Color | Self::Radiance)
    }

    /// Whether lights decide what it shows.
    #[must_use]
    pub fn is_lit(self) -> bool {
        self.is_shaded() || self == Self::ShadowMap
    }

    /// Whether its samples see what those of the shaded picture see: all of them, and what is blended too.
    #[must_use]
    pub fn looks_as_color(self) -> bool {
        self.is_shaded() || matches!(self, Self::Tiles | Self::Shaded)
    }

    /// Bytes of a finished pixel.
    #[must_use]
    pub fn pixel_bytes(self) -> u64 {
        match self {
            Self::Depth | Self::Instance => 2,
            // Beside the colour which triangle is seen.
            Self::Radiance | Self::Wireframe => 16,
            _ => 4,
        }
    }

    /// Whether it shows work that elisions spare: what it shows is then what is left of that.
    #[must_use]
    pub fn shows_work(self) -> bool {
        matches!(self, Self::ShadowMap | Self::Tiles | Self::Shaded)
    }

    /// Whether it is a picture of 16-bit values, not of colours.
    #[must_use]
    pub fn is_values(self) -> bool {
        matches!(self, Self::Depth | Self::Instance)
    }
}
