//! What is integrated: vector fields, asked for their power series.

mod convolution;
mod cover;
mod quadratic;
mod tape;
pub(crate) mod top;

pub use quadratic::Quadratic;
pub use tape::{Instruction, Tape};
pub use top::Top;

use crate::lanes::Lane;

/// Where a system lives.
pub trait Space: Sync {
    /// Number of components of the state.
    fn n_components(&self) -> usize;
}

/// An autonomous vector field whose solutions are expanded in powers of time.
///
/// The coefficients of one order form a *row*: the state, then work quantities that the field derives from it, then
/// the same for each tangent vector (a field with tangent vectors attached is again a field). Rows follow one another
/// from order 0 upwards.
pub trait Field: Space {
    /// Registers that one group (the state, or one tangent vector) takes in a row: components and work quantities.
    fn group(&self) -> usize;

    /// Registers in a row with `n_tangents` tangent vectors.
    fn row(&self, n_tangents: usize) -> usize {
        self.group() * (1 + n_tangents)
    }

    /// Registers that the series up to `order` take in all: the rows, and after them what else the field keeps.
    fn registers(&self, n_tangents: usize, order: usize) -> usize {
        self.row(n_tangents) * (order + 1)
    }

    /// Completes row `k`: work quantities from the components.
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize);

    /// From the complete rows `0..=k` computes the components of row `k + 1`, of the state and of every tangent vector.
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize);
}
