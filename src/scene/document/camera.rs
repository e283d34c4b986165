//! The `camera` part.

use super::reader::Node;
use super::writer::{Fields, ToJson};
use crate::scene::Lens;
use glam::DVec3;
use serde_json::Value;

/// Least vertical field of view in degrees.
pub const MIN_FOV_Y_DEG: f64 = 0.001;
/// Greatest vertical field of view in degrees.
pub const MAX_FOV_Y_DEG: f64 = 179.9;
/// Vertical field of view in degrees of a camera that names none.
const DEFAULT_FOV_Y_DEG: f64 = 45.0;
/// Nearest distance drawn by a camera that has a place.
pub const DEFAULT_NEAR: f64 = 0.1;

/// Where the picture is taken from. Without a position it is framed automatically.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPart {
    /// Where it stands, in world space.
    pub position: Option<DVec3>,
    /// What it looks at; always there when `position` is.
    pub target: Option<DVec3>,
    /// The direction that is up in the picture; not zero.
    pub up: DVec3,
    /// Full vertical opening angle in degrees; always there unless `ortho_height` is, which wins.
    pub fov_y_deg: Option<f64>,
    /// Full height of an orthographic view.
    pub ortho_height: Option<f64>,
    /// Nearest distance drawn; always there when `position` is.
    pub near: Option<f64>,
    /// Farthest distance drawn; `None` is infinite.
    pub far: Option<f64>,
    /// Turns about the target, by time.
    pub orbit_deg_per_s: f64,
}

impl Default for CameraPart {
    fn default() -> Self {
        Self {
            position: None,
            target: None,
            up: DVec3::Y,
            fov_y_deg: Some(DEFAULT_FOV_Y_DEG),
            ortho_height: None,
            near: None,
            far: None,
            orbit_deg_per_s: 0.0,
        }
    }
}

impl CameraPart {
    /// The shape of the view volume: orthographic wins where both are given.
    #[must_use]
    pub fn lens(&self) -> Lens {
        match self.ortho_height {
            Some(height) => Lens::Orthographic { height },
            None => Lens::Perspective { fov_y_deg: self.fov_y_deg.unwrap_or(DEFAULT_FOV_Y_DEG) },
        }
    }

    pub(super) fn read(node: Node) -> Option<Self> {
        let mut o = node.object()?;
        let default = Self::default();
        let mut camera = Self {
            position: o.optional("position", Node::point),
            target: o.optional("target", Node::point),
            up: o.or("up", default.up, Node::direction),
            fov_y_deg: o.optional("fov_y_deg", |n| n.number_in(MIN_FOV_Y_DEG, MAX_FOV_Y_DEG)),
            ortho_height: o.optional("orthographic", orthographic),
            near: o.optional("near", Node::positive),
            far: o.optional("far", Node::positive),
            orbit_deg_per_s: o.or("orbit_deg_per_s", 0.0, Node::coordinate),
        };
        if camera.ortho_height.is_none() {
            camera.fov_y_deg.get_or_insert(DEFAULT_FOV_Y_DEG);
        }
        if let Some(position) = camera.position {
            camera.near.get_or_insert(DEFAULT_NEAR);
            if *camera.target.get_or_insert(DVec3::ZERO) == position {
                o.fault_at("target", "must differ from the position, or there is no direction to look in");
            }
        }
        if let (Some(near), Some(far)) = (camera.near, camera.far)
            && far <= near
        {
            o.fault_at("far", format!("must be greater than near, which is {near}, is {far}"));
        }
        o.finish();
        Some(camera)
    }
}

fn orthographic(node: Node) -> Option<f64> {
    let mut o = node.object()?;
    let height = o.required("height", Node::positive);
    o.finish();
    height
}

impl ToJson for CameraPart {
    fn to_json(&self) -> Value {
        let orthographic = self.ortho_height.map(|height| Orthographic { height });
        Fields::new()
            .with_some("position", self.position.as_ref())
            .with_some("target", self.target.as_ref())
            .with("up", &self.up)
            .with_some("fov_y_deg", self.fov_y_deg.as_ref())
            .with_some("orthographic", orthographic.as_ref())
            .with_some("near", self.near.as_ref())
            .with_some("far", self.far.as_ref())
            .with("orbit_deg_per_s", &self.orbit_deg_per_s)
            .finish()
    }
}

struct Orthographic {
    height: f64,
}

impl ToJson for Orthographic {
    fn to_json(&self) -> Value {
        Fields::new().with("height", &self.height).finish()
    }
}
