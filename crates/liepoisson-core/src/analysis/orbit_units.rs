//! The natural unit of time of an orbit, and of each component along it, in the cases in which eigenvalues give it; Python's
//! `liepoisson.numeric.time_scale` has the others, too.

use super::orbit::{Orbits, orbits};
use crate::ensemble::{AnyEnsemble, Control, Integrator};
use crate::error::Error;
use crate::lanes::Simd;
use crate::linear::eigen;
use std::f64::consts::PI;
use std::sync::Arc;

/// Points of the first stretch, at which the derivative of the field is taken.
const POINTS: usize = 8;
/// Its length, in natural times at the start.
const STRETCH: f64 = 32.0;
/// The derivative is read off `M(h) = 1 + h Df + O(h^2)` at the first rung h at which `|M(h) - 1|` is this large.
const LEAST_CHANGE: f64 = 1e-8;
const RUNG: f64 = 1e2;
const LOWEST: f64 = 1e-60;
const HIGHEST: f64 = 1e60;
/// Below this part of the coupling all eigenvalues count as zero.
const NILPOTENT: f64 = 1e-2;
/// The size of a component below this part of the largest one may be round-off, and is no unit.
const NO_UNIT: f64 = 1e-6;

/// Units along one orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Units {
    /// `1 / median rho(Df)` over the first stretch; NaN where the field has no such time there.
    pub time: f64,
    /// Root mean square of each component along the stretch, at most a radian of an angle; that of the largest one of a
    /// component that has none.
    pub components: Vec<f64>,
}

/// Units along the orbit from each state; `periods` of all components, infinite of those that are points of no circle.
///
/// # Errors
/// See [`AnyEnsemble::check`].
pub fn orbit_units<'a>(
    integrator: &Arc<dyn Integrator + 'a>,
    states: &[f64],
    periods: &[f64],
    simd: Simd,
) -> Result<Vec<Units>, Error> {
    let n = integrator.n_components();
    if periods.len() != n {
        return Err(Error::Length { name: "periods", wanted: n, got: periods.len() });
    }
    let run = Run { integrator, n, simd };
    states.chunks_exact(n).map(|state| run.units(state, periods)).collect()
}

/// Short runs with a field.
struct Run<'r, 'a> {
    integrator: &'r Arc<dyn Integrator + 'a>,
    n: usize,
    simd: Simd,
}

impl Run<'_, '_> {
    fn orbits(&self, states: &[f64], tangents: &[f64], n_tangents: usize, times: &[f64]) -> Result<Orbits, Error> {
        let ensemble = AnyEnsemble::new(self.integrator.clone(), states, tangents, n_tangents, times);
        orbits(ensemble, 1, self.simd, &Control::default(), false, |_| ())
    }

    fn units(&self, state: &[f64], periods: &[f64]) -> Result<Units, Error> {
        let none = Units { time: f64::NAN, components: vec![1.0; self.n] };
        let (at_start, rung) = self.derivative(state, LOWEST)?;
        let (radius, coupling) = self.radius_and_coupling(&at_start);
        // where components act on each other in longer circles only, what is left of the coupling is round-off
        let rate = if coupling > NILPOTENT * radius { coupling } else { radius };
        if !(rate.is_finite() && rate > 0.0) {
            return Ok(none);
        }
        let times: Vec<f64> = (0..POINTS).map(|k| STRETCH / rate * k as f64 / (POINTS - 1) as f64).collect();
        let points = self.orbits(state, &[], 0, &times)?.states;
        if !points.iter().all(|x| x.is_finite()) {
            return Ok(none);
        }
        let mut rates = Vec::with_capacity(POINTS);
        for point in points.chunks_exact(self.n) {
            let (radius, coupling) = self.radius_and_coupling(&self.derivative(point, rung / RUNG)?.0);
            rates.push(if radius > NILPOTENT * coupling { radius } else { coupling });
        }
        rates.sort_by(f64::total_cmp);
        let median = 0.5 * (rates[POINTS / 2 - 1] + rates[POINTS / 2]);
        let mut sizes: Vec<f64> = periods.iter().map(|period| period / (2.0 * PI)).collect();
        for (i, size) in sizes.iter_mut().enumerate() {
            let squares: f64 = points.iter().skip(i).step_by(self.n).map(|x| x * x).sum();
            *size = size.min((squares / POINTS as f64).sqrt());
        }
        let largest = sizes.iter().fold(0.0_f64, |most, size| most.max(*size));
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let components = sizes.iter().map(|&size| if size > NO_UNIT * largest { size } else { unit }).collect();
        Ok(Units { time: if median > 0.0 { 1.0 / median } else { f64::NAN }, components })
    }

    /// Df at a state, from a rung of times h upwards, and the rung that was taken; zero where nothing changes.
    fn derivative(&self, state: &[f64], lowest: f64) -> Result<(Vec<f64>, f64), Error> {
        let n = self.n;
        let identity: Vec<f64> = (0..n * n).map(|at| if at % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        let mut h = lowest;
        while h <= HIGHEST {
            let found = self.orbits(state, &identity, n, &[0.0, h])?;
            // tangents are rows: the transposed matrix, which has the same eigenvalues
            let change: Vec<f64> =
                found.tangents[n * n..].iter().zip(&identity).map(|(after, one)| after - one).collect();
            let size = change.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size.is_nan() || size >= LEAST_CHANGE {
                return Ok((change.iter().map(|x| x / h).collect(), h));
            }
            h *= RUNG;
        }
        Ok((vec![0.0; n * n], h))
    }

    /// The spectral radius, and `sqrt(sum |A_ij A_ji| / 2)`: 1 for a rotation, too, and less sensitive where eigenvalues coincide.
    fn radius_and_coupling(&self, matrix: &[f64]) -> (f64, f64) {
        let n = self.n;
        let radius = eigen(matrix, n)
            .map_or(f64::NAN, |found| found.values.iter().fold(0.0_f64, |most, [re, im]| most.max(re.hypot(*im))));
        let products: f64 = (0..n * n).map(|at| (matrix[at] * matrix[at % n * n + at / n]).abs()).sum();
        (radius, (0.5 * products).sqrt())
    }
}
