//! What a scene is made of: meshes, materials, textures. Pure data and the arithmetic over it.

pub mod build;
pub mod material;
pub mod mesh;
pub mod normals;
pub mod polygon;
pub mod shapes;
pub mod sky;
pub mod tangents;
pub mod texture;

pub use build::{Corner, MeshSource, MeshTooLarge};
pub use material::{Material, Shading};
pub use mesh::{Mesh, Part};
pub use tangents::Tangents;
pub use texture::{Filter, Texture, Wrap};
