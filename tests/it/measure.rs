//! One line for every bound that a test checks, and the check.

use rasterd::report::selftest::Ledger;
pub use rasterd::report::selftest::instruments::worst::Worst;

/// Prints `case, metric, value, bound, margin` and fails if the value is over its bound.
///
/// The margin is `bound / value`: how many times worse it could be. A bound of 0 leaves none.
#[track_caller]
pub fn at_most(case: &str, metric: &str, value: f64, bound: f64) {
    let margin = if value == 0.0 { f64::INFINITY } else { bound / value };
    println!("{case}, {metric}, {value:.4e}, {bound:.4e}, {margin:.2}");
    assert!(value <= bound, "{case}: {metric} is {value:e}, over {bound:e}");
}

/// The same for a number of pixels that must be none; `of` pixels were looked at, and that must be
/// more than none.
#[track_caller]
pub fn none_of(case: &str, metric: &str, count: usize, of: usize) {
    assert!(of > 0, "{case}: nothing was looked at");
    at_most(case, &format!("{metric} of {of}"), count as f64, 0.0);
}

/// Fails with the measurements that are out.
#[track_caller]
pub fn all_hold(ledger: Ledger) {
    let out: Vec<_> = ledger.into_measurements().into_iter().filter(|row| row.is_out()).collect();
    assert!(out.is_empty(), "{}", rasterd::report::selftest::table(&out));
}
