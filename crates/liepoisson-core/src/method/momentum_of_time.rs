//! The momentum of time, the last component of a driven system, whose error is judged by its own size.
//!
//! It moves nothing, and its unit, that of energy, is not the one in which the state is measured ([`Field::size_limits`]). Nothing but
//! its own terms tells how large its error may be: that of `p_t' = -dH/dt` along a pendulum at rest, for which each step is good.
//!
//! [`Field::size_limits`]: crate::field::Field::size_limits

use crate::lanes::Lane;
use crate::method::estimates::log2_estimate;
use crate::method::known_terms::is_in_range;
use crate::method::taylor::MAX_ORDER;

/// Which component it is, if there is one: the last, if its limit is zero.
#[inline(always)]
pub(super) fn momentum_of_time(limits: &[f64]) -> Option<usize> {
    match limits.last() {
        Some(&0.0) => Some(limits.len() - 1),
        _ => None,
    }
}

/// The series of one component: the register of the coefficient `k` is `k row + at`.
pub(super) struct OwnSeries<'a, V> {
    pub(super) rows: &'a [V],
    pub(super) row: usize,
    pub(super) at: usize,
    pub(super) order: usize,
}

impl<V: Lane<Number = f64>> OwnSeries<'_, V> {
    /// The logarithm of the size of a coefficient; negative infinity where it has no digits.
    #[inline(always)]
    fn size(&self, k: usize) -> V {
        let mut size = V::splat(f64::NEG_INFINITY);
        for (size, &c) in size.as_scalars_mut().iter_mut().zip(self.rows[k * self.row + self.at].as_scalars()) {
            *size = if is_in_range(c.abs()) { log2_estimate(c.abs()) } else { f64::NEG_INFINITY };
        }
        size
    }

    /// Shortens the logarithms of steps to those for which the last two terms of the second half that are not zero are small beside the
    /// largest of the first half.
    ///
    /// With `|c_j| = |c_k| rho^(k-j)` the terms from `N-1` on are below `tol |c_k| h^k` for a step `h = rho tol^(1/(N-1-k))`. The best
    /// `k <= N/2` decides: no single one need differ from zero, and where the terms of a rate cancel, all of them are round-off, of the
    /// same `rho`. Terms without digits are left out.
    #[inline(always)]
    pub(super) fn shorten(&self, logarithm: &mut V, tolerance: f64) {
        let (order, half, allowed) = (self.order, self.order / 2, log2_estimate(tolerance));
        let mut first = [V::splat(f64::NEG_INFINITY); MAX_ORDER / 2 + 1];
        for (k, to) in first[..=half].iter_mut().enumerate() {
            *to = self.size(k);
        }
        let mut n_judged = V::splat(0.0);
        for j in (half + 1..=order).rev() {
            if n_judged.as_scalars().iter().all(|&n| n >= 2.0) {
                break;
            }
            let (last, mut longest) = (self.size(j), V::splat(f64::NEG_INFINITY));
            for k in 0..=half.min(order - 2) {
                let (part, root) = (1.0 / (j - k) as f64, allowed / (order - 1 - k) as f64);
                let sizes = first[k].as_scalars().iter().zip(last.as_scalars());
                for (longest, (from, to)) in longest.as_scalars_mut().iter_mut().zip(sizes) {
                    let step = (from - to) * part + root; // NaN where both are zero
                    *longest = if step > *longest { step } else { *longest };
                }
            }
            let lanes = n_judged.as_scalars_mut().iter_mut().zip(longest.as_scalars()).zip(last.as_scalars());
            for (step, ((n, &longest), &last)) in logarithm.as_scalars_mut().iter_mut().zip(lanes) {
                let is_judged = last > f64::NEG_INFINITY && *n < 2.0;
                *step = if is_judged && longest > f64::NEG_INFINITY && longest < *step { longest } else { *step };
                *n += f64::from(u8::from(is_judged));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::estimates::exp2_estimate;

    fn longest(terms: &[f64], tolerance: f64) -> f64 {
        let mut logarithm = 990.0;
        OwnSeries { rows: terms, row: 1, at: 0, order: terms.len() - 1 }.shorten(&mut logarithm, tolerance);
        exp2_estimate(logarithm)
    }

    /// `c_k = unit rho^-k`, but for the first ones.
    fn geometric(first: &[f64], unit: f64, rho: f64, order: usize) -> Vec<f64> {
        (0..=order).map(|k| first.get(k).copied().unwrap_or(unit * rho.powi(-(k as i32)))).collect()
    }

    #[test]
    fn the_step_follows_from_the_radius_in_any_unit_of_energy() {
        let tolerance: f64 = 1e-15;
        for unit in [1e-200, 1e-10, 1.0, 1e200] {
            for start in [0.0, unit] {
                let (step, order) = (longest(&geometric(&[start], unit, 3.0, 24), tolerance), 24.0);
                let wanted = 3.0 * tolerance.powf(1.0 / (order - 2.0)).max(tolerance.powf(1.0 / (order - 1.0)));
                assert!(step / wanted < 1.01 && step / wanted > 0.9, "{unit:e}, {start:e}: {step}, {wanted}");
            }
        }
        let large = longest(&geometric(&[1e10], 1.0, 3.0, 24), tolerance);
        assert!(large > 2.0 * longest(&geometric(&[0.0], 1.0, 3.0, 24), tolerance), "{large}");
    }

    #[test]
    fn what_is_zero_or_a_polynomial_allows_any_step() {
        for first in [&[0.0; 25][..], &[1.0, 2.0], &[0.0; 20]] {
            let unit = if first.len() == 20 { 1.0 } else { 0.0 };
            assert!(longest(&geometric(first, unit, 1.0, 24), 1e-15) > 1e290);
        }
    }
}
