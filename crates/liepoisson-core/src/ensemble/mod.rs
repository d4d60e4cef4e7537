//! Many trajectories: threads times lanes, with progress, cancellation, and one outcome per trajectory.

mod any_ensemble;
mod clock;
mod control;
mod observer;
mod outcome;
mod poll_interval;
mod running;
mod slot;
mod worker;

pub(crate) use any_ensemble::Watch;
pub use any_ensemble::{AnyEnsemble, Integration, Integrator};
pub use control::Control;
pub use observer::{Observer, Onward, Step, Stop};
pub use outcome::{Outcome, Summary};
pub(crate) use running::beside;

use crate::error::Error;
use crate::field::Space;
use crate::lanes::Simd;
use crate::method::Method;
use std::sync::Arc;
use std::time::Duration;

/// What is to be computed: starts, tangent vectors, and the times that matter, for one field and one method.
#[derive(Clone, Copy)]
pub struct Ensemble<'a, F, M> {
    /// The vector field.
    pub field: &'a F,
    /// How it is integrated.
    pub method: M,
    /// States at the first time, trajectory by trajectory.
    pub states: &'a [f64],
    /// Tangent vectors at the first time: trajectory by trajectory, vector by vector.
    pub tangents: &'a [f64],
    /// Tangent vectors per trajectory.
    pub n_tangents: usize,
    /// Start, times of interest, end; strictly monotone in either direction.
    pub times: &'a [f64],
}

impl<F: Space, M: Method<F>> Ensemble<'_, F, M> {
    /// Number of trajectories.
    pub fn n_trajectories(&self) -> usize {
        AnyEnsemble::from(self).n_trajectories()
    }

    /// Checks that the parts fit together.
    ///
    /// # Errors
    /// See [`AnyEnsemble::check`].
    pub fn check(&self) -> Result<(), Error> {
        AnyEnsemble::from(self).check()
    }

    /// Integrates every trajectory: [`AnyEnsemble::run`].
    ///
    /// # Errors
    /// As there.
    ///
    /// # Panics
    /// As there.
    pub fn run<O: Observer>(
        &self,
        threads: usize,
        simd: Simd,
        control: &Control,
        observer: impl Fn(usize) -> O + Sync,
        mut watch: impl FnMut(&dyn Fn(Duration) -> bool),
    ) -> Result<(), Error> {
        AnyEnsemble::from(self).run(threads, simd, control, observer, &mut watch)
    }
}

impl<'a, F: Space, M: Method<F> + 'a> From<&Ensemble<'a, F, M>> for AnyEnsemble<'a> {
    fn from(ensemble: &Ensemble<'a, F, M>) -> AnyEnsemble<'a> {
        let &Ensemble { field, method, states, tangents, n_tangents, times } = ensemble;
        AnyEnsemble::new(Arc::new(Integration { field, method }), states, tangents, n_tangents, times)
    }
}
