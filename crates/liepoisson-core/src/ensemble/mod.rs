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

pub(crate) use any_ensemble::{AnyEnsemble, Watch};
pub use control::Control;
pub use observer::{Observer, Onward, Step, Stop};
pub use outcome::{Outcome, Summary};
pub(crate) use running::beside;

use crate::error::Error;
use crate::field::{Space, Terms};
use crate::lanes::Simd;
use crate::method::{Block, Method};
use any_ensemble::Integrator;
use std::time::Duration;

/// What is to be computed: starts, tangent vectors, and the times that matter.
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
        self.any().n_trajectories()
    }

    /// Checks that the parts fit together.
    ///
    /// # Errors
    /// Times that are not strictly monotone and finite; arrays of the wrong length.
    pub fn check(&self) -> Result<(), Error> {
        self.any().check()
    }

    /// Integrates every trajectory on `threads` threads; with 0, and in WebAssembly, on the calling thread, and nobody watches.
    ///
    /// The result for a trajectory has the same bits for any number of threads and any instruction set. `observer` makes
    /// the observer of one worker, given the number of its lanes. `watch` runs on the calling thread meanwhile: the
    /// function that it is given waits for the workers, at most so long, and says whether they have all ended.
    ///
    /// # Errors
    /// See [`Ensemble::check`]; no memory for the trajectories under way, no thread.
    ///
    /// # Panics
    /// As a worker does, with its message; the other workers are stopped before.
    pub fn run<O: Observer>(
        &self,
        threads: usize,
        simd: Simd,
        control: &Control,
        observer: impl Fn(usize) -> O + Sync,
        watch: impl FnOnce(&dyn Fn(Duration) -> bool),
    ) -> Result<(), Error> {
        let mut watch = Some(watch);
        self.any().run(threads, simd, control, observer, &mut |wait| watch.take().expect("a run calls it once")(wait))
    }

    /// The same without its types.
    pub(crate) fn any(&self) -> AnyEnsemble<'_> {
        AnyEnsemble {
            integrator: self,
            max_steps: self.method.max_steps(),
            majorant: self.field.majorant(),
            n_components: self.field.n_components(),
            fields: self.field.n_trajectories(),
            n_tangents: self.n_tangents,
            states: self.states,
            tangents: self.tangents,
            times: self.times,
        }
    }
}

impl<F: Space, M: Method<F>> Integrator for Ensemble<'_, F, M> {
    fn block(&self, simd: Simd, n_tangents: usize) -> Box<dyn Block + '_> {
        self.method.block_for(simd, self.field, n_tangents)
    }

    fn registers(&self, n_tangents: usize) -> usize {
        self.method.registers(self.field, n_tangents)
    }

    fn terms(&self, state: &[f64], rest: &[f64], to: &mut Terms) {
        self.field.terms(state, rest, to);
    }
}
