//! The run of an ensemble, without the types of its field and its method, so that it is compiled once for all of them.

use super::control::Control;
use super::observer::Observer;
use super::running::{CancelOnPanic, Running};
use super::worker::Worker;
use crate::error::Error;
use crate::field::Space;
use crate::lanes::Simd;
use crate::method::{Block, Method};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::time::Duration;

/// A field with a method for it.
pub trait Integrator: Send + Sync {
    /// Number of components of the state.
    fn n_components(&self) -> usize;

    /// For how many trajectories the field is made, where each has parameters of its own.
    fn n_trajectories(&self) -> Option<usize>;

    /// Most steps that a trajectory may take.
    fn max_steps(&self) -> u64;

    /// Trajectories side by side, in the registers of `simd`.
    fn block(&self, simd: Simd, n_tangents: usize) -> Box<dyn Block + '_>;

    /// Registers that such a block takes, about.
    fn registers(&self, n_tangents: usize) -> usize;
}

/// A field and a method, with their types.
#[derive(Clone, Copy, Debug)]
pub struct Integration<'f, F, M> {
    /// The vector field.
    pub field: &'f F,
    /// How it is integrated.
    pub method: M,
}

impl<F: Space, M: Method<F>> Integrator for Integration<'_, F, M> {
    fn n_components(&self) -> usize {
        self.field.n_components()
    }

    fn n_trajectories(&self) -> Option<usize> {
        self.field.n_trajectories()
    }

    fn max_steps(&self) -> u64 {
        self.method.max_steps()
    }

    fn block(&self, simd: Simd, n_tangents: usize) -> Box<dyn Block + '_> {
        self.method.block_for(simd, self.field, n_tangents)
    }

    fn registers(&self, n_tangents: usize) -> usize {
        self.method.registers(self.field, n_tangents)
    }
}

/// An [`Ensemble`](super::Ensemble) of any field and any method.
#[derive(Clone)]
pub struct AnyEnsemble<'a> {
    pub(super) integrator: Arc<dyn Integrator + 'a>,
    pub(super) max_steps: u64,
    pub(crate) n_components: usize,
    pub(crate) n_tangents: usize,
    pub(crate) states: &'a [f64],
    pub(crate) tangents: &'a [f64],
    pub(crate) times: &'a [f64],
}

/// Whether threads can be started at all.
const HAS_THREADS: bool = !cfg!(target_family = "wasm");

/// What the calling thread does meanwhile; see [`AnyEnsemble::run`].
pub(crate) type Watch<'w> = &'w mut dyn FnMut(&dyn Fn(Duration) -> bool);

impl<'a> AnyEnsemble<'a> {
    /// States and tangent vectors at the first time, and the times: those of [`Ensemble`](super::Ensemble).
    pub fn new(
        integrator: Arc<dyn Integrator + 'a>,
        states: &'a [f64],
        tangents: &'a [f64],
        n_tangents: usize,
        times: &'a [f64],
    ) -> AnyEnsemble<'a> {
        let (max_steps, n_components) = (integrator.max_steps(), integrator.n_components());
        AnyEnsemble { integrator, max_steps, n_components, n_tangents, states, tangents, times }
    }

    /// The same with other tangent vectors, as many.
    pub(crate) fn with_tangents<'b>(&self, tangents: &'b [f64]) -> AnyEnsemble<'b>
    where
        'a: 'b,
    {
        AnyEnsemble { tangents, ..self.clone() }
    }

    /// Number of trajectories.
    pub fn n_trajectories(&self) -> usize {
        self.states.len() / self.n_components
    }

    /// Checks that the parts fit together.
    ///
    /// # Errors
    /// Times that are not strictly monotone and finite; arrays of the wrong length.
    pub fn check(&self) -> Result<(), Error> {
        let n = self.n_components;
        if !self.states.len().is_multiple_of(n) {
            let wanted = n.saturating_mul(self.n_trajectories() + 1);
            return Err(Error::Length { name: "states", wanted, got: self.states.len() });
        }
        if let Some(wanted) = self.integrator.n_trajectories().filter(|&wanted| wanted != self.n_trajectories()) {
            return Err(Error::Length { name: "states", wanted: wanted.saturating_mul(n), got: self.states.len() });
        }
        let wanted = self.states.len().saturating_mul(self.n_tangents);
        if self.tangents.len() != wanted {
            return Err(Error::Length { name: "tangents", wanted, got: self.tangents.len() });
        }
        if self.times.len() < 2 {
            return Err(Error::Times { index: self.times.len() });
        }
        let direction = (self.times[1] - self.times[0]).signum();
        for (index, pair) in self.times.windows(2).enumerate() {
            // written so that a NaN is refused too
            if !(pair[0].is_finite() && pair[1].is_finite() && (pair[1] - pair[0]) * direction > 0.0) {
                return Err(Error::Times { index: index + 1 });
            }
        }
        Ok(())
    }

    /// Integrates every trajectory on `threads` threads; with 0, and in WebAssembly, on the calling thread, and nobody watches.
    ///
    /// The result for a trajectory has the same bits for any number of threads and any instruction set. `observer` makes
    /// the observer of one worker, given the number of its lanes. `watch` runs on the calling thread meanwhile: the
    /// function that it is given waits for the workers, at most so long, and says whether they have all ended.
    ///
    /// # Errors
    /// See [`AnyEnsemble::check`]; no memory for the trajectories under way, no thread.
    ///
    /// # Panics
    /// As a worker does, with its message; the other workers are stopped before.
    pub fn run<O: Observer>(
        &self,
        threads: usize,
        simd: Simd,
        control: &Control,
        observer: impl Fn(usize) -> O + Sync,
        watch: Watch<'_>,
    ) -> Result<(), Error> {
        self.check()?;
        if self.n_trajectories() == 0 {
            return Ok(());
        }
        let on_this_thread = threads == 0 || !HAS_THREADS;
        let threads = threads.clamp(1, self.n_trajectories());
        self.reserve(threads, simd)?;
        let (queue, running) = (AtomicUsize::new(0), Running::new(threads));
        if on_this_thread {
            Worker { ensemble: self, queue: &queue, control }.work(simd, &observer);
            return Ok(());
        }
        let mut panic = None;
        let mut refused = None;
        std::thread::scope(|scope| {
            let mut workers = Vec::new();
            for _ in 0..threads {
                let (queue, observer) = (&queue, &observer);
                let counted = running.guard();
                let work = move || {
                    let _counted = counted;
                    let _cancels = CancelOnPanic(control);
                    Worker { ensemble: self, queue, control }.work(simd, observer);
                };
                // fewer threads than were asked for do the same work
                match std::thread::Builder::new().spawn_scoped(scope, work) {
                    Ok(worker) => workers.push(worker),
                    Err(refusal) => refused = Some(refusal),
                }
            }
            if !workers.is_empty() {
                refused = None;
            }
            watch(&|at_most| running.wait(at_most));
            for worker in workers {
                if let Err(message) = worker.join() {
                    panic = Some(message);
                }
            }
        });
        match (panic, refused) {
            (Some(message), _) => std::panic::resume_unwind(message),
            (None, Some(_)) => Err(Error::Threads { wanted: threads }),
            (None, None) => Ok(()),
        }
    }

    /// Finds out whether there is memory for the trajectories under way: where an allocation fails, Rust ends the process.
    fn reserve(&self, threads: usize, simd: Simd) -> Result<(), Error> {
        let registers = self.integrator.registers(self.n_tangents);
        let bytes = registers.saturating_mul(simd.width() * size_of::<f64>()).saturating_mul(threads);
        let mut memory = Vec::<u8>::new();
        memory.try_reserve_exact(bytes).map_err(|_| Error::Memory { bytes })
    }
}
