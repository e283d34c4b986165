//! What of a draw call is fixed: the state around its programmable parts.

use crate::scene::Cull;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// State of a draw call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// Where clip space goes; nothing is drawn outside.
    pub viewport: Rect,
    /// Which faces are left out.
    pub cull: Cull,
    /// Whether a fragment must be nearer than what is there. Without the test the last triangle wins and
    /// no depth is written.
    pub depth_test: bool,
    /// Whether the depth target is written.
    pub depth_write: bool,
    /// Whether colour targets are written.
    pub color_write: bool,
}

impl State {
    /// Back faces culled, depth tested, everything written.
    #[must_use]
    pub fn new(viewport: Rect) -> Self {
        Self { viewport, cull: Cull::Back, depth_test: true, depth_write: true, color_write: true }
    }

    /// How the depths of a call's fragments are used.
    pub(super) fn depth_use(&self) -> DepthUse {
        match (self.depth_test, self.depth_write) {
            (true, true) => DepthUse::Nearest,
            (true, false) => DepthUse::Compare,
            (false, _) => DepthUse::Ignore,
        }
    }
}

/// Which fragment of a call a pixel keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepthUse {
    /// The nearest, if it is nearer than what is there.
    Nearest,
    /// The last of those nearer than what is there.
    Compare,
    /// The last.
    Ignore,
}
