//! Rigorous numerics: intervals that contain the exact results, of flows, section maps, periodic orbits, equilibria.
//!
//! Nothing here is an estimate. A result is an interval that contains the number, or a [`failure::Failure`]; round-off,
//! remainders of series and the extent of sets are all enclosed.

pub mod apriori;
mod balls;
pub mod failure;
pub mod flow;
pub mod interval;
pub mod linear;
pub mod lohner;
pub mod matrix;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod rounding;
pub mod section;
pub mod series;
pub mod sum;
