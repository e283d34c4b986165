//! The checks of the catalogue, by what they are about. They draw by the library's public functions alone.

#![allow(
    clippy::cast_possible_truncation,
    reason = "the checks choose their own numbers; a wrong one fails them"
)]

pub(super) mod attributes;
pub(super) mod camera;
pub(super) mod clipping;
pub(super) mod codes;
pub(super) mod colour;
pub(super) mod coverage;
pub(super) mod crops;
pub(super) mod depth;
pub(super) mod determinism;
pub(super) mod enormous;
pub(super) mod float_state;
mod interpolated;
pub(super) mod light;
pub(super) mod limits;
pub(super) mod models;
pub(super) mod normals;
pub(super) mod post;
pub(super) mod relief;
pub(super) mod samples;
pub(super) mod shadows;
pub(super) mod shift;
pub(super) mod sky;
pub(super) mod textures;
