//! Progress of a run, and the end of it that its caller or the clock wishes.

use super::clock::Instant;
use super::outcome::Outcome;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// Progress of a run and the wish to end it; shared with the caller.
#[derive(Default)]
pub struct Control {
    cancelled: AtomicBool,
    deadline: Option<Instant>,
    time_is_up: AtomicBool,
    /// Trajectories done, in units of 2^-32.
    pub(super) done: AtomicU64,
}

/// One trajectory, in the units of `done`.
pub(super) const ONE: f64 = 4_294_967_296.0;

impl Control {
    /// A run that ends by itself after `limit`.
    pub fn with_time_limit(limit: Duration) -> Control {
        Control { deadline: Instant::now().checked_add(limit), ..Control::default() }
    }

    /// The outcome of trajectories that have to stop now, if they have to.
    pub fn reason_to_stop(&self) -> Option<Outcome> {
        if self.cancelled.load(Ordering::Relaxed) {
            Some(Outcome::Cancelled)
        } else if self.time_is_up.load(Ordering::Relaxed) {
            Some(Outcome::TimeLimit)
        } else {
            None
        }
    }

    /// Looks at the clock; cheap, but not cheap enough for every step. What takes long within a step asks for itself.
    pub(crate) fn look_at_clock(&self) -> Option<Outcome> {
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.time_is_up.store(true, Ordering::Relaxed);
        }
        self.reason_to_stop()
    }

    /// Asks the workers to stop soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Says how much is done where there are no trajectories: a fraction of the whole.
    pub(crate) fn set_done(&self, fraction: f64) {
        self.done.store((fraction * ONE) as u64, Ordering::Relaxed);
    }

    /// Number of trajectories done, fractions of running ones included.
    pub fn done(&self) -> f64 {
        self.done.load(Ordering::Relaxed) as f64 / ONE
    }
}
