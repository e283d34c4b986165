//! The way from anchored space to sub-pixels: a camera or a light, and the picture it looks at.

use glam::{DMat3, DVec3};

/// Sub-pixel units a pixel: 24.8 fixed point.
pub const SUBPIXELS: i32 = 256;

/// How the lines of sight run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Through the eye. Depth is `near / w` (reversed, infinite far plane) for the view-space
    /// distance `w`, so it does not depend on `far`.
    Perspective,
    /// Along the axis. Depth falls from 1 at `near` to 2⁻¹⁰ at `far`: 0 is "nothing there".
    Orthographic,
}

/// The picture that clip space is mapped to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The least depth drawn, that of the far plane; 0 where it is infinitely far.
    pub farthest: f64,
}

impl Viewport {
    /// Half the picture in sub-pixels: it reaches from minus this to this.
    #[must_use]
    pub fn half_extent(&self) -> [f64; 2] {
        [self.width, self.height].map(|n| f64::from(n) * f64::from(SUBPIXELS / 2))
    }

    /// Screen x and y of the left and top border of pixel 0, in sub-pixels.
    #[must_use]
    pub fn origin(&self) -> [i32; 2] {
        // A picture has at most 2¹⁴ pixels a side, so this stays below 2²¹.
        [self.width, self.height].map(|n| -(n.cast_signed() * (SUBPIXELS / 2)))
    }
}

impl From<&View> for Viewport {
    fn from(view: &View) -> Self {
        view.viewport()
    }
}

/// A viewer in anchored space and its picture.
///
/// View space is right-handed: x to the right, y up, and the view-space distance `w` grows along
/// `forward` (so `z = −w`). Screen space has its origin at the viewport centre, y down, in
/// sub-pixels: `x · scale[0] / w` (perspective) or `x · scale[0]` (orthographic).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where it stands.
    pub eye: DVec3,
    /// Unit vector to the right.
    pub right: DVec3,
    /// Unit vector up.
    pub up: DVec3,
    /// Unit vector along the line of sight.
    pub forward: DVec3,
    /// How the lines of sight run.
    pub projection: Projection,
    /// Sub-pixels per unit of `x / w` and `y / w` (perspective), or of x and y.
    pub scale: [f64; 2],
    /// Nearest distance drawn.
    pub near: f64,
    /// Farthest distance drawn; infinite only in perspective.
    pub far: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl View {
    /// The same view in a picture of another size; its pixels need not be square.
    #[must_use]
    pub fn with_size(&self, [width, height]: [u32; 2]) -> Self {
        let ratio = |to: u32, from: u32| f64::from(to) / f64::from(from);
        let [x, y] = self.scale;
        let scale = [x * ratio(width, self.width), y * ratio(height, self.height)];
        Self { scale, width, height, ..*self }
    }

    /// Pixels of the picture.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Rows: right, up, forward. Takes a direction to (x, y, w).
    #[must_use]
    pub fn view_from_world(&self) -> DMat3 {
        DMat3::from_cols(self.right, self.up, self.forward).transpose()
    }

    /// Depth that is lost per unit of view-space distance in an orthographic view.
    #[must_use]
    pub fn depth_slope(&self) -> f64 {
        (1.0 - 1.0 / 1024.0) / (self.far - self.near)
    }

    /// Depth of the view-space distance `w`, 1 at the near plane, falling with distance.
    #[must_use]
    pub fn depth(&self, w: f64) -> f64 {
        match self.projection {
            Projection::Perspective => self.near / w,
            Projection::Orthographic => 1.0 - (w - self.near) * self.depth_slope(),
        }
    }

    /// View-space distance of a depth: the inverse of [`View::depth`].
    #[must_use]
    pub fn distance(&self, depth: f64) -> f64 {
        match self.projection {
            Projection::Perspective => self.near / depth,
            Projection::Orthographic => self.near + (1.0 - depth) / self.depth_slope(),
        }
    }

    /// The picture that its clip space is mapped to.
    #[must_use]
    pub fn viewport(&self) -> Viewport {
        let farthest = match self.projection {
            // Rounded down, so that what lies at `far` to the bit is drawn.
            Projection::Perspective => self.near / self.far * (1.0 - f64::EPSILON),
            Projection::Orthographic => self.depth(self.far),
        };
        Viewport { width: self.width, height: self.height, farthest }
    }

    /// Half the picture in sub-pixels: the viewport reaches from minus this to this.
    #[must_use]
    pub fn half_extent(&self) -> [f64; 2] {
        self.viewport().half_extent()
    }

    /// Direction of the line of sight through the screen point (x, y), in world axes. Its component
    /// along `forward` is 1.
    #[must_use]
    pub fn ray(&self, screen: [f64; 2]) -> DVec3 {
        match self.projection {
            Projection::Perspective => {
                self.right * (screen[0] / self.scale[0]) - self.up * (screen[1] / self.scale[1])
                    + self.forward
            }
            Projection::Orthographic => self.forward,
        }
    }

    /// The anchored point at view-space distance `w` on the line of sight through `screen`.
    #[must_use]
    pub fn point(&self, screen: [f64; 2], w: f64) -> DVec3 {
        match self.projection {
            Projection::Perspective => self.eye + self.ray(screen) * w,
            Projection::Orthographic => {
                self.eye + self.right * (screen[0] / self.scale[0]) - self.up * (screen[1] / self.scale[1])
                    + self.forward * w
            }
        }
    }
}
