//! What is computed along trajectories: observers of the ensemble runner, one analysis per file.

pub mod lyapunov;
pub mod orbit;

use crate::error::Error;

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
