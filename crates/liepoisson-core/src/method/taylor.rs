//! The adaptive Taylor method: power series to an order set by the tolerance, steps to its radius of convergence.
//!
//! # References
//! Jorba and Zou, *A software package for the numerical integration of ODEs by means of high-order Taylor methods*,
//! Experimental Mathematics 14 (2005): the choice of order and step; here each lane takes its own step.

use crate::error::Error;
use crate::field::Field;
use crate::lanes::{Lane, Piece, as_scalars};
use std::collections::TryReserveError;

const MAX_ORDER: usize = 64;

/// The method as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor {
    tolerance: f64,
    order: usize,
    max_steps: u64,
}

impl Taylor {
    /// A method whose last retained term is at most `tolerance` times the size of the state (sum of the absolute values
    /// of its components), with at most `max_steps` steps per trajectory.
    ///
    /// Without an `order` the cheapest for that tolerance is taken: the work of a step grows as the square of the order,
    /// its length as `tolerance^(1/order)`, which gives `-ln(tolerance)/2` for the products alone; the part of the work
    /// that grows more slowly moves the optimum upwards. Measured on the twisted Kovalevskaya top with one tangent
    /// vector (AVX-512): 20 to 22 are best at 1e-13, 14 to 16 at 1e-8, and within 5% of one another.
    ///
    /// # Errors
    /// Tolerance outside `[2^-53, 0.1]`, order outside `2..=64`.
    pub fn new(tolerance: f64, order: Option<usize>, max_steps: u64) -> Result<Taylor, Error> {
        if !(f64::EPSILON / 2.0..=0.1).contains(&tolerance) {
            return Err(Error::Tolerance { got: tolerance });
        }
        let order = order.unwrap_or_else(|| (3.5 - 0.58 * libm::log(tolerance)).ceil() as usize);
        if !(2..=MAX_ORDER).contains(&order) {
            return Err(Error::Order { got: order });
        }
        Ok(Taylor { tolerance, order, max_steps })
    }

    /// Order of the series.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Most steps that a trajectory may take.
    pub fn max_steps(&self) -> u64 {
        self.max_steps
    }
}

/// As many trajectories as a register has lanes, with their tangent vectors and the power series of all of them.
pub struct Block<'f, F, V> {
    field: &'f F,
    method: Taylor,
    n_tangents: usize,
    row: usize,
    rows: Vec<V>,
}

impl<'f, F: Field, V: Lane> Block<'f, F, V> {
    /// A block of trajectories that rest at the origin.
    #[inline(always)]
    pub fn new(field: &'f F, method: Taylor, n_tangents: usize) -> Self {
        let rows = vec![V::splat(0.0); field.registers(n_tangents, method.order)];
        Block { field, method, n_tangents, row: field.row(n_tangents), rows }
    }

    /// Sets component `i` of group `group` (0: the state; k: tangent vector k) in one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, group: usize, i: usize, value: f64) {
        self.rows[group * self.field.group() + i].as_scalars_mut()[lane] = value;
    }

    /// Component `i` of group `group` at the start of the step.
    #[inline(always)]
    pub fn get(&self, lane: usize, group: usize, i: usize) -> f64 {
        self.rows[group * self.field.group() + i].as_scalars()[lane]
    }

    /// Sum of the absolute values of the components of `group`, in coefficient `k`; not finite if one of them is not.
    #[inline(always)]
    pub fn norm(&self, k: usize, group: usize) -> V {
        let at = k * self.row + group * self.field.group();
        let components = &self.rows[at..at + self.field.n_components()];
        let mut sum = components[0].abs();
        for component in &components[1..] {
            sum = sum.add(component.abs());
        }
        sum
    }

    /// The power series, from its first coefficients.
    #[inline(always)]
    pub fn expand(&mut self) {
        V::outline(Expansion(self));
    }

    /// For each lane the longest step for which each of the last two terms of the series of the state, and of every
    /// tangent vector, stays below the tolerance; NaN where one of them is not finite.
    ///
    /// Tangent vectors have a say because the state alone does not see the linear flow about it: at an equilibrium its
    /// own series allows any step.
    #[inline(always)]
    pub fn step_sizes(&self, sizes: &mut [f64]) {
        let order = self.method.order;
        sizes.fill(f64::INFINITY);
        for group in 0..=self.n_tangents {
            let (size, last, before) = (self.norm(0, group), self.norm(order, group), self.norm(order - 1, group));
            // Each coefficient enters the next, so the first and the highest tell of all; zero times infinity is NaN.
            let defect = size.add(last).mul(V::splat(0.0));
            let (size, last, before) = (size.as_scalars(), last.as_scalars(), before.as_scalars());
            for lane in 0..V::WIDTH {
                let allowed = log2_estimate(self.method.tolerance * size[lane]);
                let longest = |term: f64, power: usize| {
                    if term > 0.0 { (allowed - log2_estimate(term)) / power as f64 } else { f64::INFINITY }
                };
                let (by_last, by_before) = (longest(last[lane], order), longest(before[lane], order - 1));
                sizes[lane] = (if by_last < sizes[lane] { by_last } else { sizes[lane] }) + defect.as_scalars()[lane];
                sizes[lane] = if by_before < sizes[lane] { by_before } else { sizes[lane] };
            }
        }
        for size in sizes {
            *size = exp2_estimate(*size);
        }
    }

    /// Advances every lane by its own step: Horner's rule, several components at once to hide the latency of each.
    #[inline(always)]
    pub fn advance(&mut self, step: V) {
        let (components, group) = (self.field.n_components(), self.field.group());
        for first in (0..self.row).step_by(group) {
            let (mut i, end) = (first, first + components);
            while i < end {
                i += match end - i {
                    12.. => self.advance_components::<12>(i, step),
                    9.. => self.advance_components::<9>(i, step),
                    4.. => self.advance_components::<4>(i, step),
                    _ => self.advance_components::<1>(i, step),
                };
            }
        }
    }

    #[inline(always)]
    fn advance_components<const M: usize>(&mut self, first: usize, step: V) -> usize {
        let mut value = [V::splat(0.0); M];
        value.copy_from_slice(&self.rows[self.method.order * self.row + first..][..M]);
        for k in (0..self.method.order).rev() {
            let coefficients = &self.rows[k * self.row + first..][..M];
            for i in 0..M {
                value[i] = value[i].mul_add(step, coefficients[i]);
            }
        }
        self.rows[first..first + M].copy_from_slice(&value);
        M
    }

    /// Multiplies a tangent vector of one lane by a power of two, which rounds nothing.
    #[inline(always)]
    pub fn scale_tangent(&mut self, lane: usize, tangent: usize, factor: f64) {
        for i in 0..self.field.n_components() {
            let value = self.get(lane, tangent, i);
            self.set(lane, tangent, i, value * factor);
        }
    }

    /// Component `i` of group `group` of one lane, a time `tau` after the start of the step.
    #[inline(always)]
    pub fn evaluate(&self, lane: usize, group: usize, tau: f64, values: &mut [f64]) {
        let scalars = as_scalars(&self.rows);
        let (stride, at) = (self.row * V::WIDTH, group * self.field.group() * V::WIDTH + lane);
        for (i, value) in values.iter_mut().enumerate() {
            *value = scalars[self.method.order * stride + at + i * V::WIDTH];
        }
        for k in (0..self.method.order).rev() {
            let row = &scalars[k * stride + at..];
            for (i, value) in values.iter_mut().enumerate() {
                *value = value.mul_add(tau, row[i * V::WIDTH]);
            }
        }
    }

    /// Appends the series of one lane's state: order by order, its components.
    ///
    /// # Errors
    /// There is no memory for it.
    pub fn copy_series(&self, lane: usize, to: &mut Vec<f64>) -> Result<(), TryReserveError> {
        to.try_reserve((self.method.order + 1) * self.field.n_components())?;
        for k in 0..=self.method.order {
            for i in 0..self.field.n_components() {
                to.push(self.rows[k * self.row + i].as_scalars()[lane]);
            }
        }
        Ok(())
    }
}

/// The series of a block: the large part of the code, shared by all analyses.
struct Expansion<'b, 'f, F, V>(&'b mut Block<'f, F, V>);

impl<F: Field, V: Lane> Piece for Expansion<'_, '_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Block { field, method, n_tangents, rows, .. } = self.0;
        for k in 0..method.order {
            field.derive_work(rows, *n_tangents, k);
            field.extend(rows, *n_tangents, k);
        }
    }
}

/// `log2 x` of a positive number to 2e-5, without a branch; of zero a number below -1000, of infinity one above 1000.
#[inline(always)]
fn log2_estimate(x: f64) -> f64 {
    const TWO_OVER_LN_2: f64 = 2.0 / std::f64::consts::LN_2;
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i64 - 1023;
    let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    // artanh series in s = (m - 1)/(m + 1), which is at most 1/3
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    exponent as f64 + TWO_OVER_LN_2 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0))))
}

/// `2^y` to 2e-5, for `y` clipped to [-1000, 1000]; NaN for NaN.
#[inline(always)]
fn exp2_estimate(y: f64) -> f64 {
    let y = y.clamp(-1000.0, 1000.0) + 1000.0;
    let whole = y as i64;
    let z = (y - whole as f64) * std::f64::consts::LN_2;
    let fraction =
        1.0 + z * (1.0 + z * (1.0 / 2.0 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z / 720.0)))));
    fraction * f64::from_bits(((whole - 1000 + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn estimates_of_logarithm_and_power_are_good_to_2e_5(y in -900.0..900.0_f64) {
            let x = libm::exp2(y);
            prop_assert!((log2_estimate(x) - y).abs() < 2e-5, "{} {}", log2_estimate(x), y);
            prop_assert!((exp2_estimate(y) / x - 1.0).abs() < 2e-5, "{} {}", exp2_estimate(y), x);
        }
    }

    #[test]
    fn estimates_stay_finite_at_the_ends() {
        assert!(log2_estimate(0.0) < -1000.0);
        assert!(log2_estimate(f64::INFINITY) > 1000.0);
        assert!(exp2_estimate(1e9).is_finite() && exp2_estimate(-1e9) > 0.0);
    }
}
