//! The camera of one frame: the document's, framed automatically where it has no place, with the
//! frame's own overrides.
//!
//! In: a [`Scene`] and a [`FrameRequest`]. Out: a [`ResolvedCamera`] in anchored space. Only basic
//! arithmetic and `libm`, so that the same request gives the same camera on every machine.

use super::document::DEFAULT_NEAR;
use super::{Camera, Lens, Scene};
use crate::math::Bounds;
use crate::math::angle::{rotation_about_deg, sin_cos_deg};
use crate::model::normals::unit;
use crate::plan::FrameRequest;
use crate::plan::request::Orbit;
use glam::DVec3;

/// A camera with nothing left open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedCamera {
    /// Where it stands, anchored.
    pub eye: DVec3,
    /// What it looks at, anchored.
    pub target: DVec3,
    /// What was asked to be up; `up` is as much of it as lies in the picture.
    pub vertical: DVec3,
    /// To the right in the picture; with `up` and `forward` orthonormal, right × up = −forward.
    pub right: DVec3,
    /// Up in the picture.
    pub up: DVec3,
    /// Into the picture.
    pub forward: DVec3,
    /// Perspective or orthographic.
    pub lens: Lens,
    /// Nearest view-space distance drawn, > 0.
    pub near: f64,
    /// Farthest view-space distance drawn, > `near`; `None` is infinite.
    pub far: Option<f64>,
}

/// A camera override that makes no sense.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CameraFault {
    /// The query parameter.
    pub parameter: &'static str,
    /// What must hold and what is there.
    pub detail: String,
}

/// The direction from the bounds' centre to an automatically framed camera.
const AUTO_DIRECTION: DVec3 = DVec3::new(1.0, 0.6, 1.4);
/// How much of the tighter side automatically framed bounds fill.
const AUTO_FILL: f64 = 0.9;
/// `near` of an automatically framed camera, as a part of its distance.
const AUTO_NEAR: f64 = 1e-3;
/// Distance of an automatically framed camera to what has no size.
const POINT_DISTANCE: f64 = 1.0;

/// Least distance of an automatically framed camera, as a part of its target's coordinates.
const LEAST_DISTANCE: f64 = 1e-12;

/// Settles the camera of a frame of `width` × `height` pixels, for a request as
/// [`FrameRequest::parse`] gives it.
///
/// # Errors
/// Every override that makes no sense with this scene, by query parameter.
pub fn resolve(
    scene: &Scene,
    request: &FrameRequest,
    width: u32,
    height: u32,
) -> Result<ResolvedCamera, Vec<CameraFault>> {
    let lens = lens(&scene.camera, request);
    let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
    let placed = place(scene, request, lens, aspect);
    let (near, far) = depth_range(scene, request, &placed);
    let faults = faults(request, &placed, near, far);
    if !faults.is_empty() {
        return Err(faults);
    }
    let [right, up, forward] = basis(placed.target - placed.eye, placed.up);
    let Placed { eye, target, up: vertical, .. } = placed;
    Ok(ResolvedCamera { eye, target, vertical, right, up, forward, lens, near, far })
}

/// Eye, target and up before the basis is made of them.
struct Placed {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    /// `near` that automatic framing has chosen.
    auto_near: Option<f64>,
}

fn lens(camera: &Camera, request: &FrameRequest) -> Lens {
    match (request.ortho_height, request.fov_y_deg) {
        (Some(height), _) => Lens::Orthographic { height },
        (None, Some(fov_y_deg)) => Lens::Perspective { fov_y_deg },
        (None, None) => camera.lens,
    }
}

fn place(scene: &Scene, request: &FrameRequest, lens: Lens, aspect: f64) -> Placed {
    let camera = &scene.camera;
    let anchored = |world: DVec3| world - scene.anchor;
    let (eye, target, auto_near) = match camera.position {
        Some(position) => (position, camera.target.unwrap_or_else(|| anchored(DVec3::ZERO)), None),
        None => {
            let nothing = Bounds { min: DVec3::ZERO, max: DVec3::ZERO };
            let framed = frame(scene.framed_bounds().unwrap_or(nothing), camera.up, lens, aspect);
            (framed.eye, camera.target.unwrap_or(framed.target), Some(framed.near))
        }
    };
    let distance = (eye - target).length();
    let target = request.target.map_or(target, anchored);
    let placed = Placed { eye: request.eye.map_or(eye, anchored), target, up: camera.up, auto_near };
    let placed = match request.orbit {
        Some(orbit) => orbited(&placed, orbit, distance),
        None => placed,
    };
    turned_by_time(turned(placed, request.turn_deg), camera.orbit_deg_per_s * request.t)
}

/// About the target: yaw 0 looks from +z, 90 from +x; pitch 90 from above.
fn orbited(placed: &Placed, orbit: Orbit, distance: f64) -> Placed {
    let (sin_yaw, cos_yaw) = sin_cos_deg(orbit.yaw_deg);
    let (sin_pitch, cos_pitch) = sin_cos_deg(orbit.pitch_deg);
    let outward = DVec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch);
    let eye = placed.target + outward * orbit.distance.unwrap_or(distance);
    // From straight above or below, up goes on as it was on the way there.
    let up = if is_parallel(outward, placed.up) {
        DVec3::new(-sin_yaw * sin_pitch, cos_pitch, -cos_yaw * sin_pitch)
    } else {
        placed.up
    };
    Placed { eye, up, ..*placed }
}

/// Turned as a whole about the vertical through the target, as yaw counts.
fn turned(placed: Placed, deg: f64) -> Placed {
    if deg == 0.0 {
        return placed;
    }
    let turn = rotation_about_deg(DVec3::Y, deg);
    Placed { eye: placed.target + turn * (placed.eye - placed.target), up: turn * placed.up, ..placed }
}

/// Turned about an axis through the target along up.
fn turned_by_time(placed: Placed, deg: f64) -> Placed {
    if deg == 0.0 || !deg.is_finite() {
        return placed;
    }
    let turn = rotation_about_deg(direction(placed.up), deg);
    Placed { eye: placed.target + turn * (placed.eye - placed.target), ..placed }
}

fn depth_range(scene: &Scene, request: &FrameRequest, placed: &Placed) -> (f64, Option<f64>) {
    let far = request.far.or(scene.camera.far);
    let given = request.near.or(scene.camera.near);
    let near = given.unwrap_or_else(|| {
        // What automatic framing finds must not collide with a given far plane.
        let auto = placed.auto_near.unwrap_or(DEFAULT_NEAR);
        far.map_or(auto, |far| auto.min(far * AUTO_NEAR))
    });
    (near, far)
}

/// What automatic framing finds.
struct Framed {
    eye: DVec3,
    target: DVec3,
    near: f64,
}

/// The nearest camera on [`AUTO_DIRECTION`] from which every corner of `bounds` lies within
/// [`AUTO_FILL`] of both sides of the picture.
///
/// In view axes about the centre let a corner be at (x, y, z), z away from the camera. From
/// distance D it appears at |x| / ((D + z) · tan) of the half width, so that
/// D ≥ |x| / (fill · tan) − z, and the same for y: the greatest of these bounds is the distance.
fn frame(bounds: Bounds, up: DVec3, lens: Lens, aspect: f64) -> Framed {
    let target = bounds.centre();
    let outward = AUTO_DIRECTION.normalize();
    let [right, up, forward] = basis(-outward, up);
    let corners = bounds.corners().map(|corner| corner - target);
    let nearest =
        |distance_to: &dyn Fn(DVec3) -> f64| corners.iter().map(|&c| distance_to(c)).fold(0.0, f64::max);
    let distance = match lens {
        Lens::Perspective { fov_y_deg } => {
            let tan_y = tan_half(fov_y_deg) * AUTO_FILL;
            let tan_x = tan_y * aspect;
            nearest(&|c| (c.dot(right).abs() / tan_x).max(c.dot(up).abs() / tan_y) - c.dot(forward))
        }
        // The height is given, so the distance only has to keep everything in front.
        Lens::Orthographic { height } => nearest(&|c| -c.dot(forward)) * 2.0 + height,
    };
    let distance = if distance > 0.0 { distance } else { POINT_DISTANCE };
    // Far from the anchor, a tiny distance would be lost in the sum.
    let distance = distance.max(target.abs().max_element() * LEAST_DISTANCE);
    Framed { eye: target + outward * distance, target, near: (distance * AUTO_NEAR).max(f64::MIN_POSITIVE) }
}

/// The tangent of half an angle in (0, 180) degrees.
fn tan_half(deg: f64) -> f64 {
    libm::tan((deg * 0.5).to_radians())
}

/// Right, up and forward, orthonormal. Where `up` is parallel to `forward`, the world axis that is
/// least along it stands in.
fn basis(forward: DVec3, up: DVec3) -> [DVec3; 3] {
    let forward = direction(forward);
    let up = if is_parallel(forward, up) { least_axis(forward) } else { direction(up) };
    let right = direction(forward.cross(up));
    // Next to the line of sight the product loses digits; what it is off is along `forward`.
    let right = direction(right - forward * right.dot(forward));
    [right, direction(right.cross(forward)), forward]
}

/// Whether `up` is so nearly parallel to `forward` that their cross product is noise.
pub(super) fn is_parallel(forward: DVec3, up: DVec3) -> bool {
    direction(forward).cross(direction(up)).length_squared() <= 1e-12
}

fn least_axis(v: DVec3) -> DVec3 {
    let v = v.abs();
    if v.x <= v.y && v.x <= v.z {
        DVec3::X
    } else if v.y <= v.z {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

/// A unit vector along `v`. It has a direction but where a sum has left the range of f64.
fn direction(v: DVec3) -> DVec3 {
    unit(v).unwrap_or(DVec3::NEG_Z)
}

/// Faults of a query together with the scene's own camera. What a query has alone, its parser has found.
fn faults(request: &FrameRequest, placed: &Placed, near: f64, far: Option<f64>) -> Vec<CameraFault> {
    let mut faults = Vec::new();
    if placed.eye == placed.target {
        let parameter = if request.eye.is_some() { "eye" } else { "target" };
        let detail = "eye and target must differ, or there is no direction to look in".to_owned();
        faults.push(CameraFault { parameter, detail });
    }
    if let Some(far) = far
        && far <= near
    {
        let parameter = if request.far.is_some() { "far" } else { "near" };
        faults.push(CameraFault {
            parameter,
            detail: format!("far must be greater than near: {far} is not greater than {near}"),
        });
    }
    faults
}
