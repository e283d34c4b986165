//! Numerical stability on stiff and extreme cases, against oracles that share no code with the
//! pipeline.
//!
//! Every test prints `case, metric, value, bound, margin` for each number that it holds to a bound.
//! The bounds are derived, not measured; where a test names a case as `B7`, it is that of the
//! project's catalogue of stiff cases.

#![allow(
    clippy::cast_possible_truncation,
    reason = "the tests choose their own numbers; a wrong one fails them"
)]

mod attributes;
mod camera;
mod clipping;
mod codes;
mod colour;
mod coverage;
mod crops;
mod depth;
pub mod determinism;
mod document;
mod enormous;
mod interpolated;
mod light;
mod limits;
mod normals;
mod oracle;
mod post;
mod relief;
mod samples;
mod shadows;
mod shift;
mod sky;
mod stage;
mod textures;
