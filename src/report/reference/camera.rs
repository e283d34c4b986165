//! Lines of sight.

use super::bvh::Ray;
use crate::scene::Lens;
use crate::scene::framing::ResolvedCamera;
use glam::DVec3;

/// A camera and its picture. Along its rays t is the view-space distance.
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    /// A pixel to the right and a pixel down, on the plane at distance 1.
    right: DVec3,
    down: DVec3,
    /// Half the picture in pixels.
    half: [f64; 2],
    is_perspective: bool,
    near: f64,
    far: f64,
}

impl Camera {
    pub fn new(camera: &ResolvedCamera, [width, height]: [u32; 2]) -> Self {
        let half = [f64::from(width) / 2.0, f64::from(height) / 2.0];
        let (is_perspective, half_height) = match camera.lens {
            Lens::Perspective { fov_y_deg } => (true, (fov_y_deg / 2.0).to_radians().tan()),
            Lens::Orthographic { height } => (false, height / 2.0),
        };
        let pixel = half_height / half[1];
        Self {
            eye: camera.eye,
            forward: camera.forward,
            right: camera.right * pixel,
            down: -camera.up * pixel,
            half,
            is_perspective,
            near: camera.near,
            far: camera.far.unwrap_or(f64::INFINITY),
        }
    }

    /// The line of sight through a place of the picture, in pixels from its upper left corner.
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        let aside = self.right * (x - self.half[0]) + self.down * (y - self.half[1]);
        let (nearest, farthest) = (self.near, self.far);
        if self.is_perspective {
            Ray { origin: self.eye, direction: self.forward + aside, nearest, farthest }
        } else {
            Ray { origin: self.eye + aside, direction: self.forward, nearest, farthest }
        }
    }

    /// The unit vector from a point to the viewer.
    pub fn towards_viewer(&self, point: DVec3) -> DVec3 {
        if self.is_perspective { (self.eye - point).normalize_or_zero() } else { -self.forward }
    }
}
