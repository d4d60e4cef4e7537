//! What an analysis is shown of the trajectories of a worker.

use super::outcome::Summary;
use crate::method::{Block, Series};
use std::collections::TryReserveError;
use std::ops::ControlFlow;

/// Seen by an [`Observer`]: one lane during one accepted step.
///
/// A method with power series shows it before the lane is advanced, and knows the state at any time inside it; the
/// others show it afterwards, and know the state at its end.
pub struct Step<'s> {
    pub(super) block: &'s dyn Block,
    pub(super) lane: usize,
    /// Time at the start of the step.
    pub time: f64,
    /// Length of the step, negative when running backwards; equal steps come several at once, with their whole length.
    pub size: f64,
    pub(super) scales: &'s [i64],
}

impl Step<'_> {
    /// The state a time `tau` after the start of the step.
    pub fn state(&self, tau: f64, values: &mut [f64]) {
        let n = values.len();
        self.evaluate(0, &[tau], n, values, n);
    }

    /// One group at several times after the start of the step; of a method without series the present values.
    fn evaluate(&self, group: usize, taus: &[f64], n: usize, values: &mut [f64], stride: usize) {
        match self.block.series() {
            Some(series) => series.evaluate(self.lane, group, taus, n, values, stride),
            None => {
                for values in values.chunks_mut(stride).take(taus.len()) {
                    self.block.read(self.lane, group, &mut values[..n]);
                }
            }
        }
    }

    /// The states at several times after the start of the step, one after the other.
    pub fn states(&self, taus: &[f64], values: &mut [f64]) {
        let n = values.len() / taus.len().max(1);
        self.evaluate(0, taus, n, values, n.max(1));
    }

    /// Tangent vector `k` (from 0) of `n` components as `values * 2^scale` at several times, whose values begin a `stride`
    /// apart; returns `scale`.
    pub fn tangents(&self, k: usize, taus: &[f64], n: usize, values: &mut [f64], stride: usize) -> i64 {
        self.evaluate(1 + k, taus, n, values, stride);
        self.scales[k]
    }

    /// Tangent vector `k` (from 0) as `values * 2^scale`; returns `scale`.
    pub fn tangent(&self, k: usize, tau: f64, values: &mut [f64]) -> i64 {
        let n = values.len();
        self.evaluate(1 + k, &[tau], n, values, n);
        self.scales[k]
    }

    /// The present state: where a step has been taken, that at its end.
    pub fn present_state(&self, values: &mut [f64]) {
        self.block.read(self.lane, 0, values);
    }

    /// The present tangent vector `k` (from 0) as `values * 2^scale`; returns `scale`.
    pub fn present_tangent(&self, k: usize, values: &mut [f64]) -> i64 {
        self.block.read(self.lane, 1 + k, values);
        self.scales[k]
    }

    /// See [`Series::keeps_tangents_whole`](crate::method::Series::keeps_tangents_whole); not without series.
    pub fn keeps_tangents_whole(&self) -> bool {
        self.block.series().is_some_and(|series| series.keeps_tangents_whole())
    }

    /// Appends the power series of the state about the start of the step, so many orders or all that there are; nothing without
    /// series.
    ///
    /// # Errors
    /// There is no memory for it.
    pub fn copy_series(&self, n_orders: usize, to: &mut Vec<f64>) -> Result<(), TryReserveError> {
        self.block.series().map_or(Ok(()), |series| series.copy(self.lane, n_orders, to))
    }
}

/// Why an observer ends a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// It has served its purpose, and ends here.
    Served {
        /// Length of the step up to there: all of it, or, where there are power series, less.
        after: f64,
    },
    /// The run has to stop, and the step was not looked at to its end: the trajectory ends `after` its start, with the reason
    /// that [`Control::reason_to_stop`](super::Control::reason_to_stop) gives. For steps with power series, which can be cut anywhere.
    Interrupted {
        /// Length of the part of the step that was looked at.
        after: f64,
    },
}

/// What follows when a trajectory has reached the last time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Onward<'o> {
    /// It has ended.
    Ends,
    /// It begins again at the first time, in its lane, as a new trajectory.
    Begins {
        /// The state.
        state: &'o [f64],
        /// The tangent vectors, one after the other.
        tangents: &'o [f64],
    },
    /// So it does later, in any lane: the observer keeps it for [`Observer::resume`].
    Waits,
}

/// What a worker does with the trajectories that it advances; each worker has its own.
pub trait Observer: Send {
    /// `trajectory` starts in `lane`.
    fn begin(&mut self, lane: usize, trajectory: usize);
    /// The power series of all lanes are made: what is looked at in all of them at once is looked at here. The steps are those that
    /// follow, lane by lane, of trajectories that can go on.
    fn look_over(&mut self, series: &dyn Series, steps: &[f64]) {
        let _ = (series, steps);
    }
    /// Whether it does.
    fn looks_over(&self) -> bool {
        false
    }
    /// A step was accepted. Breaks where the trajectory is to end.
    fn step(&mut self, lane: usize, step: &Step<'_>) -> ControlFlow<Stop> {
        let _ = (lane, step);
        ControlFlow::Continue(())
    }
    /// The step contains time number `index` of the ensemble, `tau` after its start.
    fn sample(&mut self, lane: usize, index: usize, tau: f64, step: &Step<'_>) {
        let _ = (lane, index, tau, step);
    }
    /// The step contains the times of the ensemble from number `first` on that are `taus` after its start.
    fn samples(&mut self, lane: usize, first: usize, taus: &[f64], step: &Step<'_>) {
        for (k, &tau) in taus.iter().enumerate() {
            self.sample(lane, first + k, tau, step);
        }
    }
    /// How often a trajectory goes from the first time to the last: each time counts in the progress of a run as that part of it.
    fn passes(&self) -> u64 {
        1
    }
    /// The last time is reached after so many steps; `last` is where the trajectory is then.
    fn onward(&mut self, lane: usize, n_steps: u64, last: &Step<'_>) -> Onward<'_> {
        let _ = (lane, n_steps, last);
        Onward::Ends
    }
    /// The next trajectory that waits, to go on in an empty lane: its number, its state and its tangent vectors.
    fn resume(&mut self, lane: usize) -> Option<(usize, &[f64], &[f64])> {
        let _ = lane;
        None
    }
    /// `trajectory` has ended.
    fn end(&mut self, lane: usize, trajectory: usize, summary: Summary);
}
