//! Spaces, bounds, colour, projection, and functions that give the same bits on every machine.

pub mod angle;
pub mod approx;
pub mod bounds;
pub mod colour;
pub mod rounding;
pub mod simd;
mod subnormal;
pub mod view;

pub use bounds::Bounds;
pub use rounding::round_to_f32;
pub use subnormal::keeps_subnormals;
pub use view::{Projection, View, Viewport};
