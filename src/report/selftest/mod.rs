//! The catalogue of stiff and extreme cases, and what it measures.
//!
//! A [`Case`] is a claim about input that breaks renderers: slivers, plates a millionth apart, cameras
//! in the light of a lamp at 10⁷ m. Its checks draw, compare with an oracle that shares no code with
//! the pipeline (exact integers, f64 rays, closed forms), and note each error beside its bound in a
//! [`Ledger`]. [`run`] runs checks on all threads and hands back the [`Measurement`]s, the worst margin
//! first. Bounds are derived, not measured; a panic in a check is a measurement that is out.

mod cases;
mod catalogue;
pub mod instruments;
mod ledger;
mod run;
mod table;
#[cfg(test)]
mod tests;

pub use catalogue::{CASES, Case, Check, UnknownCase, named};
pub use ledger::{Effort, Ledger, Measurement, Outcome};
pub use run::{Progress, run};
pub use table::table;
