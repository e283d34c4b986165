//! Error against run time: the same pipeline, beside an f64 reference that shares no code with it.

pub mod reference;
