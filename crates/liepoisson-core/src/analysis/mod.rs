//! What is computed along trajectories: observers of the ensemble runner, one analysis per file.

pub mod lyapunov;
pub mod orbit;
pub mod section;

use crate::ensemble::{Control, Outcome, Summary};
use crate::error::Error;

/// A member that no worker has started, because the run was ended before.
const UNREACHED: Summary = Summary { outcome: Outcome::Cancelled, time: f64::NAN, n_steps: 0, state: Vec::new() };

/// Says of members that no worker has started why the run was ended.
fn name_unreached(summaries: &mut [Summary], control: &Control) {
    if let Some(reason) = control.reason_to_stop() {
        for summary in summaries.iter_mut().filter(|summary| summary.time.is_nan()) {
            summary.outcome = reason;
        }
    }
}

/// An array of `len` NaN, or the refusal of the memory for it.
fn unreached(len: usize) -> Result<Vec<f64>, Error> {
    let mut values = Vec::new();
    values.try_reserve_exact(len).map_err(|_| Error::Memory { bytes: len.saturating_mul(8) })?;
    values.resize(len, f64::NAN);
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_that_no_memory_can_hold_is_refused() {
        assert_eq!(unreached(usize::MAX / 8), Err(Error::Memory { bytes: usize::MAX / 8 * 8 }));
        assert!(unreached(3).unwrap().iter().all(|value| value.is_nan()));
    }
}
