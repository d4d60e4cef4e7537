//! The numerics of liepoisson: `x' = J(x) grad H(x)` for many starts at once, with tangent vectors.
//!
//! A [`field::Field`] is expanded in its power series by [`method::Taylor`] for as many trajectories as a register has
//! [`lanes`]; an [`ensemble::Ensemble`] deals its trajectories to threads and lanes; [`analysis`] watches each accepted step.
//! Where field and method are chosen when the program runs, [`choice`] says which go together.
//!
//! ```
//! use liepoisson_core::{analysis::orbit, ensemble::Control, field::Top, lanes::Simd, method::Taylor};
//!
//! let top = Top::new([2.0, 2.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3], 1.0)?;
//! let start = [0.3, 0.2, 0.5, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
//! let ensemble = liepoisson_core::ensemble::Ensemble {
//!     field: &top,
//!     method: Taylor::new(1e-15, None, 1_000_000)?,
//!     states: &start,
//!     tangents: &[],
//!     n_tangents: 0,
//!     times: &[0.0, 10.0],
//! };
//! let orbits = orbit::orbits(&ensemble, 1, Simd::widest(), &Control::default(), false, |_| ())?;
//! let beta = &orbits.states[9 + 6..9 + 9];
//! assert!((beta.iter().map(|b| b * b).sum::<f64>() - 1.0).abs() < 1e-13); // |beta|^2 is a Casimir
//! # Ok::<(), liepoisson_core::error::Error>(())
//! ```

pub mod analysis;
pub mod choice;
pub mod elementary;
pub mod enclosure;
pub mod ensemble;
pub mod error;
pub mod field;
pub mod formula;
pub mod fourier;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod jit;
pub mod lanes;
pub mod linear;
pub mod method;
pub mod modular;
pub mod random;
