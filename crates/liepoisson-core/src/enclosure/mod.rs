//! Rigorous numerics: intervals that contain the exact results, of flows, section maps, periodic orbits, equilibria.
//!
//! Nothing here is an estimate. A result is an interval that contains the number, or a [`failure::Failure`]; round-off,
//! remainders of series and the extent of sets are all enclosed.

pub mod apriori;
mod balls;
pub mod chart;
mod complex;
pub mod covering;
pub mod eigenvalues;
pub mod elementary;
pub mod failure;
pub mod flow;
pub mod interval;
pub mod linear;
pub mod lohner;
pub mod matrix;
pub mod passage;
pub mod periodic;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod rounding;
pub mod section;
pub mod series;
pub mod sum;
pub mod zeros;

use crate::ensemble::{Control, beside};
use crate::error::Error;
use std::time::Duration;

/// Runs `work` on a thread of its own, and `watch` on the calling thread meanwhile: the function that it is given waits for
/// the end, at most so long, and says whether it has come.
///
/// # Errors
/// No thread.
///
/// # Panics
/// As `work` does.
pub fn watched<R: Send>(
    control: &Control,
    watch: impl FnOnce(&dyn Fn(Duration) -> bool),
    work: impl FnOnce() -> R + Send,
) -> Result<R, Error> {
    beside(control, watch, work)
}
