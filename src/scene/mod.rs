//! From the document that a client writes to the scene that a frame is drawn from.
//!
//! In: JSON and uploaded files. Out: an immutable [`Scene`], or every fault at once.
//!
//! [`Document::from_json`] checks what can be told from the document alone, [`compile()`] builds the
//! scene, [`framing`] settles a frame's camera, and the [`store`] keeps scenes under their names.

mod assets;
mod compile;
mod compiled;
pub mod demo;
pub mod document;
pub mod files;
pub mod framing;
pub mod gallery;
mod import_model;
mod limits_check;
pub mod patch;
pub mod store;
mod summary;

#[cfg(test)]
mod tests;

pub use assets::Assets;
pub use compile::{Compiled, SceneError, compile};
pub use compiled::{
    Attenuation, Background, Camera, Cull, Instance, Lens, Light, LightKind, RenderDefaults, Scene, Shadow,
    ShadowCull, ShadowFilter, Spin, Warning,
};
pub use document::{Document, Fault};
pub use files::Files;
pub use framing::{CameraFault, ResolvedCamera};
pub use import_model::{ModelOptions, UpAxis};
pub use store::{Entry, NewScene, Precondition, Store, StoreError};
