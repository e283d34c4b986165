//! What is far away in every direction: cube maps, panoramas and a computed daylight.

pub mod cube_map;
pub mod daylight;
pub mod panorama;
mod scattering;
pub mod texels;

pub use cube_map::{CubeMap, FaceFault};
pub use daylight::Daylight;
pub use panorama::Panorama;
pub use texels::{Picture, PictureSize, Texels};
