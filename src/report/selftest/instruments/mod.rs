//! What checks are made of: ways to draw, stage by stage or whole frames; numbers that look random; and
//! slow and obviously right answers that share no code with the pipeline.

#![allow(
    clippy::cast_possible_truncation,
    reason = "the instruments are used with numbers that checks choose; a wrong one fails them"
)]

pub mod box_on_floor;
pub mod closed_form;
pub mod draw;
pub mod engine;
pub(super) mod oracle;
pub(super) mod stage;
pub mod worst;
