//! The view of a frame: a settled camera and a picture.

use crate::math::{Bounds, Projection, View};
use crate::scene::Lens;
use crate::scene::framing::ResolvedCamera;

/// Turns a settled camera into the view of a picture.
pub fn of_camera(camera: &ResolvedCamera, bounds: Option<Bounds>, [width, height]: [u32; 2]) -> View {
    let rows = f64::from(height) * 256.0;
    let (projection, scale) = match camera.lens {
        Lens::Perspective { fov_y_deg } => {
            (Projection::Perspective, rows * 0.5 / libm::tan((fov_y_deg * 0.5).to_radians()))
        }
        Lens::Orthographic { height } => (Projection::Orthographic, rows / height),
    };
    // An orthographic depth needs an end: the farthest point of the scene.
    let far = match (camera.far, projection) {
        (Some(far), _) => far,
        (None, Projection::Perspective) => f64::INFINITY,
        (None, Projection::Orthographic) => farthest(camera, bounds),
    };
    View {
        eye: camera.eye,
        right: camera.right,
        up: camera.up,
        forward: camera.forward,
        projection,
        scale: [scale; 2],
        near: camera.near,
        far,
        width,
        height,
    }
}

/// A distance just beyond everything in `bounds`, and beyond the near plane.
fn farthest(camera: &ResolvedCamera, bounds: Option<Bounds>) -> f64 {
    let farthest = reach(camera, bounds).max(camera.near);
    farthest + (farthest - camera.near).max(camera.near) * 1e-6
}

/// View-space distance of the farthest corner of `bounds`; 0 without any, or behind the eye.
fn reach(camera: &ResolvedCamera, bounds: Option<Bounds>) -> f64 {
    let corners = bounds.into_iter().flat_map(Bounds::corners);
    corners.map(|p| (p - camera.eye).dot(camera.forward)).fold(0.0, f64::max)
}

/// The distances that the ends of `output=depth` stand for.
pub fn depth_range(camera: &ResolvedCamera, bounds: Option<Bounds>) -> [f64; 2] {
    let far = camera.far.unwrap_or_else(|| reach(camera, bounds));
    [camera.near, if far > camera.near { far } else { camera.near * 2.0 }]
}

/// Whether a box can be seen: not all of it lies outside one plane of the view volume.
pub fn reaches(view: &View, bounds: Bounds) -> bool {
    let [half_w, half_h] = view.half_extent();
    let corners = bounds.corners().map(|p| {
        let p = p - view.eye;
        let (x, y, w) = (p.dot(view.right), p.dot(view.up), p.dot(view.forward));
        let q = if view.projection == Projection::Perspective { w } else { 1.0 };
        [
            q * half_w - x * view.scale[0],
            q * half_w + x * view.scale[0],
            q * half_h - y * view.scale[1],
            q * half_h + y * view.scale[1],
            w - view.near,
            view.far - w,
        ]
    });
    // A hair outside still counts: the planes are met exactly by the vertices, not by the box.
    let outside = |plane: usize| corners.iter().all(|c| c[plane] < -1e-9 * (1.0 + c[plane].abs()));
    !(0..6).any(outside)
}
