//! What is computed along trajectories: observers of the ensemble runner, one analysis per file.

pub mod frame;
pub mod lyapunov;
pub mod orbit;
pub mod orbit_units;
pub mod rates;
pub mod section;
pub mod tangent_frames;
pub mod verdict;

use crate::ensemble::{Control, Outcome, Summary};
use crate::error::Error;
use std::sync::Mutex;

/// Of a lock.
const POISONED: &str = "no worker panics while it writes";

/// A trajectory that no worker has started, because the run was ended before.
const UNREACHED: Summary = Summary { outcome: Outcome::Cancelled, time: f64::NAN, n_steps: 0, state: Vec::new() };

/// Says of trajectories that no worker has started why the run was ended.
fn name_unreached(summaries: &mut [Summary], control: &Control) {
    if let Some(reason) = control.reason_to_stop() {
        for summary in summaries.iter_mut().filter(|summary| summary.time.is_nan()) {
            summary.outcome = reason;
        }
    }
}

/// An array of `len` times the same.
///
/// # Errors
/// There is no memory for it.
pub fn filled<T: Clone>(len: usize, value: T) -> Result<Vec<T>, Error> {
    let mut values = Vec::new();
    let bytes = len.saturating_mul(size_of::<T>());
    values.try_reserve_exact(len).map_err(|_| Error::Memory { bytes })?;
    values.resize(len, value);
    Ok(values)
}

/// The last states of trajectories with `n` components, `(trajectory, component)`; NaN of one that never started.
///
/// # Errors
/// There is no memory for them.
pub fn last_states(summaries: &[Summary], n: usize) -> Result<Vec<f64>, Error> {
    let mut states = filled(summaries.len().saturating_mul(n), f64::NAN)?;
    for (summary, state) in summaries.iter().zip(states.chunks_mut(n.max(1))) {
        state[..summary.state.len()].copy_from_slice(&summary.state);
    }
    Ok(states)
}

/// An array as one row for each trajectory, to be taken by the worker that computes it: results are written where they stay, and
/// are in memory once.
struct Rows<'r>(Mutex<Vec<&'r mut [f64]>>);

impl<'r> Rows<'r> {
    fn new(values: &'r mut [f64], trajectories: usize) -> Rows<'r> {
        let row = values.len().checked_div(trajectories).unwrap_or(0);
        Rows(Mutex::new(match row {
            0 => (0..trajectories).map(|_| <&mut [f64]>::default()).collect(),
            _ => values.chunks_exact_mut(row).collect(),
        }))
    }

    /// The row of a trajectory; empty if it was taken before.
    fn take(&self, trajectory: usize) -> &'r mut [f64] {
        std::mem::take(&mut self.0.lock().expect(POISONED)[trajectory])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_that_no_memory_can_hold_is_refused() {
        assert_eq!(filled(usize::MAX / 8, 1.0), Err(Error::Memory { bytes: usize::MAX / 8 * 8 }));
        assert_eq!(filled(usize::MAX, UNREACHED), Err(Error::Memory { bytes: usize::MAX }));
        assert_eq!(filled(3, 1.0).unwrap(), [1.0; 3]);
    }

    #[test]
    fn rows_are_taken_once_and_are_parts_of_the_array() {
        let mut values: Vec<f64> = (0..6).map(f64::from).collect();
        let rows = Rows::new(&mut values, 3);
        assert_eq!(rows.take(2), [4.0, 5.0]);
        assert!(rows.take(2).is_empty());
        rows.take(0)[1] = 7.0;
        assert_eq!(values[1], 7.0);
        assert!(Rows::new(&mut [], 3).take(2).is_empty());
        assert!(Rows::new(&mut [], 0).0.into_inner().unwrap().is_empty());
    }
}
