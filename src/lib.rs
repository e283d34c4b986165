//! rasterd draws 3D scenes on the CPU with its own rasterizing pipeline and serves them over HTTP.
//!
//! The modules follow a frame's way:
//!
//! ```text
//! bytes ─ http ─ import ─ scene ─ plan ─ jobs ─ pipeline ─ encode ─ http ─ bytes
//!                 │                               │
//!               model                           math
//! ```
//!
//! [`scene::Document`] is what a client writes, [`scene::Scene`] what it compiles to, [`plan::Plan`]
//! what one frame of it needs, and [`pipeline::render`] draws that plan.

pub mod encode;
pub mod http;
pub mod import;
pub mod jobs;
pub mod limits;
pub mod math;
pub mod metrics;
pub mod model;
pub mod pipeline;
pub mod plan;
pub mod report;
pub mod scene;
pub mod settings;
