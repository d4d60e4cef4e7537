//! Steps of series whose last terms are beyond the range of numbers: the lower ones decide.
//!
//! The coefficients of a motion that changes at the rate `r` go as `r^k`. Where time is counted in units much shorter or much
//! longer than those of the motion, the high ones vanish by underflow, or overflow. Then the series is cut at the highest order
//! that the range of numbers holds, and the step is shorter: the orbit is as accurate, in more steps.

/// Logarithm of the size from which on a coefficient has digits: some units of the smallest number.
const LOG2_KNOWN: f64 = -1060.0;

/// A series with fewer finite orders than this is of no use.
pub(super) const FEWEST: usize = 4;

/// Whether a term is neither lost nor beyond the range of numbers; a term that vanishes may be lost.
#[inline(always)]
pub(super) fn is_in_range(term: f64) -> bool {
    (f64::MIN_POSITIVE..=f64::MAX).contains(&term)
}

/// Highest order up to which all terms are finite.
pub(super) fn finite_order(order: usize, term: impl Fn(usize) -> f64) -> usize {
    (1..=order).take_while(|&k| term(k).is_finite()).count()
}

/// The longest step for a series of which the terms up to `finite` are finite, if it is not for the last terms to decide.
///
/// All known terms are at most `|c_0| rho^-k`, with the largest such `rho`. The highest order `p` at which that is no underflow
/// is the last one that is known, and a step of `rho tol^(1/p)` makes it and all beyond it small enough.
pub(super) fn longest_step(order: usize, finite: usize, tolerance: f64, term: impl Fn(usize) -> f64) -> Option<f64> {
    let size = libm::log2(term(0).max(f64::MIN_POSITIVE));
    let mut growth = f64::NEG_INFINITY;
    for k in (1..=finite).rev() {
        let term = term(k);
        if term > 0.0 {
            growth = growth.max((libm::log2(term) - size) / k as f64);
            if finite == order && size + growth * order as f64 >= LOG2_KNOWN {
                return None; // a term of this size would not be lost: those that vanish are zero
            }
        }
    }
    if growth == f64::NEG_INFINITY {
        return None;
    }
    let known = if growth < 0.0 { (LOG2_KNOWN - size) / growth } else { f64::INFINITY };
    let last = known.floor().clamp(1.0, finite as f64);
    Some(libm::exp2(libm::log2(tolerance) / last - growth))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geometric_series_allows_the_same_accuracy_in_all_units() {
        let tolerance = 1e-15;
        for exponent in -300..300 {
            let rate = 10.0_f64.powi(exponent);
            let term = |k: usize| (0..k).fold(1.0, |power, _| power * rate);
            for order in [2, 24, 64] {
                let step = longest_step(order, finite_order(order, term), tolerance, term);
                if term(order) >= 1e-318 && term(order).is_finite() {
                    assert_eq!(step, None);
                } else if let Some(step) = step {
                    // 2^-1060 is 10^-319.09, the largest number 10^308.25
                    let lowest = if exponent < 0 { -319.09 } else { 308.25 };
                    let known = (lowest / f64::from(exponent)).floor().clamp(1.0, order as f64);
                    let wanted = tolerance.powf(1.0 / known) / rate;
                    assert!(
                        (0.99..1.01).contains(&(step / wanted)),
                        "rate {rate:e}, order {order}: {step:e}, {wanted:e}"
                    );
                } else {
                    assert!(term(order) > 1e-321, "{rate:e}, {order}");
                }
            }
        }
    }

    #[test]
    fn terms_that_vanish_without_underflow_do_not_limit_the_step() {
        for series in [&[1.0, 0.0, 0.0, 0.0][..], &[1.0, 0.5, 0.0, 0.0], &[1.0, 0.0, 1e-3, 0.0], &[0.0; 4]] {
            assert_eq!(longest_step(3, 3, 1e-15, |k| series[k]), None);
        }
    }
}
