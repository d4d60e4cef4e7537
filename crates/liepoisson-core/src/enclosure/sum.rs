//! Sums of products of intervals, nearly as narrow as if they were exact.
//!
//! Each bound is a sum of products of doubles. Its terms are split without error into the rounded product and what it misses,
//! and the running sum into the rounded one and what that misses; what is missed is added up beside it. Only this small sum
//! is rounded, with an error of at most `2 n u / (1 - 2 n u)` times the sum `D` of the absolute values of its `2 n` terms
//! (`u = 2^-53`); `8 n u D` is added, which covers the rounding of `D` and of the bound as well. So a sum of thousands of
//! terms is moved outwards as if it were rounded once, and where nothing is missed it is exact.
//!
//! # References
//! - T. Ogita, S. M. Rump, S. Oishi, *Accurate sum and dot product*, SIAM J. Sci. Comput. 26 (2005) 1955, algorithm Dot2.

use super::interval::{Interval, product_around_zero};
use super::rounding::{SMALL, add_down, add_up, missing_from_any_product, missing_from_sum};

/// A sum of doubles: `sum + missing`, up to a bound in which `size` is the sum of the absolute values of what was missing.
#[derive(Clone, Copy, Debug, Default)]
struct Bound {
    sum: f64,
    missing: f64,
    size: f64,
}

impl Bound {
    /// Adds `value + error`.
    #[inline(always)]
    fn add(&mut self, value: f64, error: f64) {
        let next = self.sum + value;
        let lost = missing_from_sum(self.sum, value, next);
        self.sum = next;
        self.missing += error + lost;
        self.size += error.abs() + lost.abs();
    }

    #[inline(always)]
    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.add(product, missing_from_any_product(a, b, product));
    }
}

/// A sum of products that grows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    low: Bound,
    high: Bound,
    /// Number of terms.
    count: f64,
    /// Number of products so small that what they miss is not known, but less than `2^-1000`.
    n_small: f64,
}

impl Sum {
    /// A sum that is zero.
    pub fn new() -> Sum {
        Sum::default()
    }

    /// Adds an interval.
    #[inline(always)]
    pub fn add(&mut self, term: Interval) {
        self.low.add(term.lo(), 0.0);
        self.high.add(term.hi(), 0.0);
        self.count += 1.0;
    }

    /// Adds the product of two intervals.
    #[inline(always)]
    pub fn add_product(&mut self, one: Interval, other: Interval) {
        let is_definite = |x: Interval| (x.lo() >= 0.0) | (x.hi() <= 0.0);
        let (a, b) = if is_definite(other) { (one, other) } else { (other, one) };
        if !is_definite(b) {
            return self.add(product_around_zero(a, b));
        }
        // as for the product of intervals: the signs choose the bounds
        let (first, last) = if b.hi() <= 0.0 { (a.hi(), a.lo()) } else { (a.lo(), a.hi()) };
        let (first_factor, last_factor) =
            (if first >= 0.0 { b.lo() } else { b.hi() }, if last >= 0.0 { b.hi() } else { b.lo() });
        self.low.add_product(first, first_factor);
        self.high.add_product(last, last_factor);
        let is_small = |x: f64, y: f64| ((x * y).abs() <= SMALL) & (x != 0.0) & (y != 0.0);
        let any_small = is_small(first, first_factor) | is_small(last, last_factor);
        self.n_small += if any_small { 1.0 } else { 0.0 };
        self.count += 1.0;
    }

    /// The sum.
    pub fn total(&self) -> Interval {
        const FACTOR: f64 = 4.0 * f64::EPSILON; // 8 u
        /// `2^-1000`.
        const LEAST: f64 = f64::from_bits((1023 - 1000) << 52);
        let slack = |bound: &Bound| match bound.size == 0.0 && self.n_small == 0.0 {
            true => 0.0,
            false => FACTOR * self.count * bound.size + 4.0 * LEAST * self.n_small,
        };
        Interval::new(
            add_down(self.low.sum, add_down(self.low.missing, -slack(&self.low))),
            add_up(self.high.sum, add_up(self.high.missing, slack(&self.high))),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whole numbers of all sizes up to 2^53, whose products add up exactly in 128 bits.
    fn whole() -> impl Strategy<Value = i64> {
        (-(1_i64 << 53)..=1 << 53, 0..53_u32).prop_map(|(number, down)| number >> down)
    }

    /// Whether the interval contains the number.
    fn contains(sum: Interval, exact: i128) -> bool {
        (sum.lo().ceil() as i128) <= exact && exact <= (sum.hi().floor() as i128)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn sums_of_products_are_contained_and_rounded_as_if_once(
            factors in proptest::collection::vec((whole(), whole()), 1..60),
        ) {
            let mut sum = Sum::new();
            let mut exact = 0_i128;
            for &(a, b) in &factors {
                sum.add_product(Interval::point(a as f64), Interval::point(b as f64));
                exact += i128::from(a) * i128::from(b);
            }
            let sum = sum.total();
            prop_assert!(contains(sum, exact), "{sum:?} {exact}");
            // two units of the last place, and what the second sum may have lost, 1e-30 of the products
            let size: f64 = factors.iter().map(|&(a, b)| (a as f64 * b as f64).abs()).sum();
            prop_assert!(sum.width() <= 1e-15 * (exact as f64).abs() + 1e-28 * size, "{sum:?} {exact}");
        }

        #[test]
        fn sums_of_intervals_contain_those_of_all_corners(
            bounds in proptest::collection::vec((whole(), whole(), whole(), whole()), 1..6),
            corner in 0..4096_usize,
        ) {
            let mut sum = Sum::new();
            let mut exact = 0_i128;
            for (k, &(a, b, c, d)) in bounds.iter().enumerate() {
                let interval = |a: i64, b: i64| Interval::new(a.min(b) as f64, a.max(b) as f64);
                sum.add_product(interval(a, b), interval(c, d));
                let first = if corner >> (2 * k) & 1 == 0 { a } else { b };
                let second = if corner >> (2 * k + 1) & 1 == 0 { c } else { d };
                exact += i128::from(first) * i128::from(second);
            }
            prop_assert!(contains(sum.total(), exact));
        }
    }

    #[test]
    fn tiny_products_and_unknown_terms_are_not_lost() {
        let tiny = Interval::point(1e-170);
        let mut sum = Sum::new();
        sum.add_product(tiny, tiny);
        let total = sum.total();
        assert!(total.lo() <= 0.0 && total.hi() > 0.0, "{total:?}");
        let mut sum = Sum::new();
        sum.add(Interval::ONE);
        sum.add_product(Interval::UNKNOWN, Interval::ZERO);
        assert!(sum.total().is_unknown());
        let mut sum = Sum::new();
        sum.add_product(Interval::point(1e200), Interval::point(1e200));
        sum.add(Interval::ONE);
        assert!(sum.total().is_unknown());
        assert_eq!(Sum::new().total(), Interval::ZERO);
    }
}
