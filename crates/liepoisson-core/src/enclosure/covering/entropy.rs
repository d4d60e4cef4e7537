//! The entropy of a flow that follows two loops in any order.

use crate::enclosure::elementary::exp;
use crate::enclosure::interval::Interval;

/// A lower bound of the root `h` of `exp(-h T_1) + exp(-h T_2) = 1`; zero if none was found.
///
/// By Abramov's formula the entropy of the flow is at least `h` if the orbits of a full shift on two symbols take at most
/// `T_1` and `T_2`: the measure that weighs a symbol by `exp(-h T)` has it. The left side falls with `h`, so a number at
/// which it is above one is a lower bound.
///
/// # References
/// - L. M. Abramov, *On the entropy of a flow*, Dokl. Akad. Nauk SSSR 128 (1959) 873.
pub fn entropy(times: [f64; 2]) -> f64 {
    let is_below = |h: f64| {
        let weights = times.map(|time| exp(-(Interval::point(h) * Interval::point(time))));
        (weights[0] + weights[1] - Interval::ONE).is_positive()
    };
    let (mut low, mut high) = (0.0, 1.0 / times[0].min(times[1]));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_times_give_the_logarithm_of_two() {
        let h = entropy([4.0, 4.0]);
        assert!(h <= 2.0_f64.ln() / 4.0 && h > 2.0_f64.ln() / 4.0 - 1e-12, "{h}");
        // exp(-h) = x with x + x^2 = 1
        let golden = entropy([1.0, 2.0]);
        let exact = (0.5 * (1.0 + 5.0_f64.sqrt())).ln();
        assert!(golden <= exact && golden > exact - 1e-12, "{golden}");
        assert_eq!(entropy([f64::NAN, 1.0]), 0.0);
    }
}
