//! A vector field at many states.

use super::filled;
use crate::ensemble::Integrator;
use crate::error::Error;
use crate::lanes::Simd;

/// The rates of change at states, `(state, component)`: the first coefficients of the series that the method makes of them.
///
/// # Errors
/// A method without series; states that are not so many for each; no memory.
pub fn rates(integrator: &dyn Integrator, states: &[f64], simd: Simd) -> Result<Vec<f64>, Error> {
    let n = integrator.n_components();
    if !states.len().is_multiple_of(n) {
        return Err(Error::Length { name: "states", wanted: states.len().next_multiple_of(n), got: states.len() });
    }
    let mut rates = filled(states.len(), f64::NAN)?;
    let mut block = integrator.block(simd, 0);
    let lanes = block.n_lanes();
    let (ahead, mut sizes, mut first_two) = (vec![0.0; lanes], vec![0.0; lanes], Vec::new());
    for (states, rates) in states.chunks(lanes * n).zip(rates.chunks_mut(lanes * n)) {
        for (lane, state) in states.chunks_exact(n).enumerate() {
            block.load(lane, lane, 0, state);
        }
        block.prepare(&ahead, &mut sizes);
        let series = block.series().ok_or(Error::MethodForField)?;
        for (lane, rates) in rates.chunks_exact_mut(n).enumerate() {
            first_two.clear();
            series.copy(lane, 2, &mut first_two).map_err(|_| Error::Memory { bytes: 16 * n })?;
            rates.copy_from_slice(&first_two[n..]);
        }
    }
    Ok(rates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ensemble::Integration;
    use crate::field::Quadratic;
    use crate::method::Taylor;

    #[test]
    fn rates_are_those_of_the_field_in_registers_of_any_width() {
        // x' = 2 x y + 1, y' = -3 x
        let field = Quadratic::new(2, &[(0, 1.0)], &[(1, 0, -3.0)], &[(0, 0, 1, 2.0)]).unwrap();
        let states: Vec<f64> = (0..22).map(|k| 0.5 * f64::from(k) - 3.0).collect();
        let wanted: Vec<f64> = states.chunks(2).flat_map(|x| [2.0 * x[0] * x[1] + 1.0, -3.0 * x[0]]).collect();
        let integration = Integration { field: &field, method: Taylor::new(1e-15, None, 1).unwrap() };
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            assert_eq!(rates(&integration, &states, simd).unwrap(), wanted);
        }
        assert!(rates(&integration, &states[1..], Simd::Scalar).is_err());
        assert_eq!(rates(&integration, &[], Simd::Scalar), Ok(vec![]));
    }
}
