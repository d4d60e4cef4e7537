//! Linear algebra of small dense matrices in a fixed order: the same bits on every processor.
//!
//! A library with a kernel for each kind of processor sums in an order of its own on each of them. What a seed decides must not
//! depend on that, so starts, charts and searches use these functions: sums run over the components in their order, no
//! product is fused with a sum, and every iteration ends by a test on the numbers alone. Matrices are row by row.

mod eigenvalues;
mod elimination;
mod product;
mod singular;
mod symmetric;

pub use eigenvalues::{Eigen, eigen};
pub use elimination::{Lu, cholesky};
pub use product::product;
pub use singular::{Singular, singular};
pub use symmetric::symmetric;

/// Iterations that no matrix of numbers needs: Jacobi's methods converge in some ten sweeps, Francis's in some three steps a value.
const MOST_SWEEPS: usize = 60;
