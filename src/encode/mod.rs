//! Pixels to files.

mod png;

pub use png::png;
