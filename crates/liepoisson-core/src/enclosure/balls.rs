//! Rows of balls `[m - r, m + r]`: sums of their multiples by plain loops, with one bound for all that is rounded.
//!
//! A product of balls lies in the ball of middle `m m'` and radius `|m| r' + r (|m'| + r')`. A sum of `K` products `m m'`,
//! rounded in any order, is off by at most `K u / (1 - K u) < 2 K u` times the sum of the `|m m'|` (`u = 2^-53`), and by a
//! number below `K` times the smallest one. With the bound taken into `r'` once for each factor, a sum costs two products for
//! the radius and one for the middle. Sums of numbers that are not negative are off by a factor that [`WIDER`] covers.
//!
//! Balls are wider than intervals where radii are not small against middles, and lose some digits in long sums. That does
//! not matter for derivatives, which are multiplied by small sets.
//!
//! # References
//! - S. M. Rump, *Fast and parallel interval arithmetic*, BIT 39 (1999) 534.
//! - N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, 3.1.

use super::interval::Interval;
use super::rounding::{add_down, add_up};

/// The most products in a sum.
const MOST_TERMS: usize = 1 << 20;
/// More than what sums of radii of so many terms lose by rounding.
const WIDER: f64 = 1.0 + 4.0 * MOST_TERMS as f64 * f64::EPSILON;
/// `2^-1000`: more than all that underflows in a sum.
const LEAST: f64 = f64::from_bits((1023 - 1000) << 52);

/// A middle and a radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    middle: f64,
    radius: f64,
}

impl Ball {
    pub(super) fn enclosure(self) -> Interval {
        Interval::new(add_down(self.middle, -self.radius), add_up(self.middle, self.radius))
    }
}

/// A ball that others are multiplied by.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Factor {
    middle: f64,
    /// By which the absolute value of a middle is multiplied: the radius, and what rounding adds.
    for_middle: f64,
    /// By which a radius is multiplied: the greatest absolute value.
    for_radius: f64,
}

impl Factor {
    /// For sums of at most `n_terms` products.
    pub(super) fn new(of: Interval, n_terms: usize) -> Factor {
        let (middle, radius) = (of.mid(), of.rad());
        let rounding = n_terms as f64 * f64::EPSILON; // 2 K u
        Factor { middle, for_middle: radius + rounding * middle.abs(), for_radius: middle.abs() + radius }
    }
}

/// Rows of equal length.
#[derive(Clone, Debug)]
pub(super) struct Balls {
    length: usize,
    middles: Vec<f64>,
    radii: Vec<f64>,
}

/// A row that is a sum of multiples of rows.
pub(super) struct RowSum {
    middles: Vec<f64>,
    radii: Vec<f64>,
    /// How many terms are not exactly zero: a sum of none is exact, while one of others may only have vanished by underflow.
    n_nonzero: Vec<f64>,
    n_terms: usize,
}

impl Balls {
    pub(super) fn zeros(n_rows: usize, length: usize) -> Balls {
        Balls { length, middles: vec![0.0; n_rows * length], radii: vec![0.0; n_rows * length] }
    }

    pub(super) fn get(&self, row: usize, column: usize) -> Ball {
        let place = row * self.length + column;
        Ball { middle: self.middles[place], radius: self.radii[place] }
    }

    pub(super) fn set_unit_row(&mut self, row: usize, column: usize) {
        let places = row * self.length..(row + 1) * self.length;
        self.radii[places.clone()].fill(0.0);
        self.middles[places.clone()].fill(0.0);
        self.middles[places.start + column] = 1.0;
    }

    /// An empty sum.
    pub(super) fn sum(&self) -> RowSum {
        let zeros = vec![0.0; self.length];
        RowSum { middles: zeros.clone(), radii: zeros.clone(), n_nonzero: zeros, n_terms: 0 }
    }

    /// Stores a sum of at most `n_terms` products, divided by a whole number.
    pub(super) fn store(&mut self, row: usize, sum: RowSum, n_terms: usize, divisor: usize) {
        assert!(sum.n_terms <= n_terms && n_terms <= MOST_TERMS, "terms of a sum");
        let divisor = divisor as f64;
        for j in 0..self.length {
            let middle = sum.middles[j] / divisor;
            let place = row * self.length + j;
            self.middles[place] = middle;
            // the quotient of the middle is rounded, too
            let radius = sum.radii[j] / divisor * WIDER + middle.abs() * f64::EPSILON;
            self.radii[place] = if sum.n_nonzero[j] == 0.0 { 0.0 } else { radius + LEAST };
        }
    }
}

impl RowSum {
    /// Adds a multiple of a row.
    #[inline]
    pub(super) fn add(&mut self, rows: &Balls, row: usize, factor: Factor) {
        self.n_terms += 1;
        let places = row * rows.length..(row + 1) * rows.length;
        let (middles, radii) = (&rows.middles[places.clone()], &rows.radii[places]);
        let is_zero = factor.for_radius == 0.0;
        let sums = self.middles.iter_mut().zip(&mut self.radii).zip(&mut self.n_nonzero);
        for (((sum, rest), count), (&middle, &radius)) in sums.zip(middles.iter().zip(radii)) {
            *sum += middle * factor.middle;
            *rest += middle.abs() * factor.for_middle + radius * factor.for_radius;
            *count += if is_zero | ((middle == 0.0) & (radius == 0.0)) { 0.0 } else { 1.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn sums_of_multiples_contain_the_exact_ones(
            terms in proptest::collection::vec((-(1_i64 << 53)..=1 << 53, -(1_i64 << 53)..=1 << 53), 1..40),
            divisor in 1..9_usize,
        ) {
            let n = terms.len();
            let (mut rows, mut exact) = (Balls::zeros(n + 1, 1), 0_i128);
            let mut sum = rows.sum();
            for (k, &(a, b)) in terms.iter().enumerate() {
                rows.middles[k] = a as f64;
                sum.add(&rows, k, Factor::new(Interval::point(b as f64), n));
                exact += i128::from(a) * i128::from(b);
            }
            rows.store(n, sum, n, divisor);
            let found = rows.get(n, 0).enclosure();
            let (low, high) = (found.lo().floor() as i128, found.hi().ceil() as i128);
            prop_assert!(low * divisor as i128 <= exact && exact <= high * divisor as i128, "{found:?} {exact}");
            let size: f64 = terms.iter().map(|&(a, b)| (a as f64 * b as f64).abs()).sum();
            prop_assert!(found.width() <= 1e-15 * (n + 2) as f64 * size, "{found:?}");
        }

        #[test]
        fn radii_are_those_of_all_members(a in -5.0..5.0_f64, b in -5.0..5.0_f64, r in 0.0..1.0_f64, s in 0.0..1.0_f64) {
            let mut rows = Balls::zeros(2, 1);
            (rows.middles[0], rows.radii[0]) = (a, r);
            let mut sum = rows.sum();
            sum.add(&rows, 0, Factor::new(Interval::ball(b, s), 1));
            rows.store(1, sum, 1, 1);
            let found = rows.get(1, 0).enclosure();
            for (x, y) in [(a - r, b - s), (a - r, b + s), (a + r, b - s), (a + r, b + s)] {
                prop_assert!(found.lo() <= x * y && x * y <= found.hi(), "{found:?} {x} {y}");
            }
            prop_assert!(found.width() <= 2.0 * (a.abs() * s + r * (b.abs() + s)) * (1.0 + 1e-8) + 1e-13);
        }
    }

    #[test]
    fn what_is_exactly_zero_stays_so_and_what_is_unknown_too() {
        let mut rows = Balls::zeros(3, 1);
        let mut sum = rows.sum();
        sum.add(&rows, 0, Factor::new(Interval::symmetric(2.0), 1));
        rows.store(1, sum, 1, 1);
        assert_eq!(rows.get(1, 0).enclosure(), Interval::ZERO);
        rows.middles[0] = 1e-200;
        let mut sum = rows.sum();
        sum.add(&rows, 0, Factor::new(Interval::point(1e-200), 1));
        rows.store(1, sum, 1, 1);
        assert!(rows.get(1, 0).enclosure().hi() > 0.0, "a product that underflows is not zero");
        rows.middles[0] = 0.0;
        let mut sum = rows.sum();
        sum.add(&rows, 0, Factor::new(Interval::UNKNOWN, 1));
        rows.store(2, sum, 1, 1);
        assert!(rows.get(2, 0).enclosure().is_unknown());
    }
}
