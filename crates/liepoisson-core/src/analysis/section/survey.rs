//! The sign of a polynomial along an interval, by tests that leave no pair of zeros out.
//!
//! On a piece with centre `m` and half-width `r`, the polynomial is `sum c_k v^k` with `v` in `[-1, 1]`. It has no zero
//! there if `|c_0| > sum_{k>0} |c_k|`, and at most one if `|c_1| > sum_{k>1} k |c_k|`: then it is monotone. Where neither
//! holds, the piece is halved. Near a simple zero the second test succeeds, elsewhere the first, once the piece is small;
//! near a double zero neither does until the polynomial is below the given error on the whole piece.
//!
//! So pieces are many only beside zeros and beside places where the polynomial equals the error, of which there are as many as
//! its degree allows. That holds for numbers that add up; those near the ends of their range are scaled first.

use crate::method::MAX_ORDER;

/// What is known of the sign at a point or a piece, in the order of the interval; places are in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mark {
    /// From here on the polynomial is positive, or negative, by more than the error.
    Sign {
        /// Where this begins.
        at: f64,
        /// Whether it is positive.
        positive: bool,
    },
    /// It passes through zero here, once, from beyond the error on one side to beyond it on the other.
    Zero {
        /// Where.
        at: f64,
        /// Whether it is positive afterwards.
        positive: bool,
        /// It moves away from zero up to here at least, and gets beyond the error.
        until: f64,
    },
    /// It comes within the error of zero here, and its sign is not known.
    Near {
        /// Where it is least.
        at: f64,
        /// Its size there.
        size: f64,
    },
}

/// Coefficients of a polynomial, as many as there can be.
type Coefficients = [f64; MAX_ORDER + 1];

/// A move of Newton's method, in units of half the piece, after which the next one is below round-off where the slope is
/// [`STEEP`] in units of the mean one: the square of the first times at most the degree over the second.
const CLOSE: f64 = 1e-10;
const STEEP: f64 = 0.01;

/// Pieces are halved at most so often: then they are as short as the spacing of numbers near 1.
const MOST_HALVINGS: u32 = 52;

/// Coefficients outside of this range are scaled: sums of a few may overflow, or lose all digits.
pub(super) const RANGE: std::ops::Range<f64> = 1e-200..1e200;

/// Goes along `sum c_k u^k`, `u` from 0 to 1, whose values are known up to `error`; all of them finite.
pub(super) fn survey(coefficients: &[f64], error: f64, mark: &mut impl FnMut(Mark)) {
    let largest = coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
    if largest == 0.0 || RANGE.contains(&largest) {
        return survey_scaled(coefficients, error, mark);
    }
    // by a power of two, which rounds nothing that counts
    let (_, exponent) = libm::frexp(largest);
    let mut scaled = [0.0; MAX_ORDER + 1];
    let scaled = &mut scaled[..coefficients.len()];
    for (to, c) in scaled.iter_mut().zip(coefficients) {
        *to = libm::scalbn(*c, -exponent);
    }
    survey_scaled(scaled, libm::scalbn(error, -exponent), &mut |found| {
        mark(match found {
            Mark::Near { at, size } => Mark::Near { at, size: libm::scalbn(size, exponent) },
            known => known,
        });
    });
}

/// The part of the function's size on an interval that an error may be which is not sharp: what the function does within it is
/// not seen.
const SMALL: f64 = 1e-6;

/// Whether the sign is known everywhere but at zeros through which it passes from beyond the error to beyond it, or the error is
/// small beside what is known.
pub(super) fn is_known(coefficients: &[f64], error: f64) -> bool {
    if (0..5).any(|k| error <= SMALL * value(coefficients, 0.25 * f64::from(k)).abs()) {
        return true;
    }
    let mut is_known = true;
    survey(coefficients, error, &mut |mark| is_known &= !matches!(mark, Mark::Near { .. }));
    is_known
}

/// The first place from a mark on where the polynomial is known to have the sign that it has after it: by twice the error, if it
/// gets so far.
pub(super) fn first_known(coefficients: &[f64], error: f64, mark: Mark) -> f64 {
    let (at, positive, until) = match mark {
        Mark::Zero { at, positive, until } => (at, positive, until),
        Mark::Sign { at, .. } | Mark::Near { at, .. } => return at,
    };
    let (mut low, mut high) = (at, until);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        let value = value(coefficients, middle);
        *(if value.abs() > 2.0 * error && (value > 0.0) == positive { &mut high } else { &mut low }) = middle;
    }
}

fn survey_scaled(coefficients: &[f64], error: f64, mark: &mut impl FnMut(Mark)) {
    let rest = sum_of_sizes(&coefficients[1..]);
    if coefficients[0].abs() > rest + error {
        return mark(Mark::Sign { at: 0.0, positive: coefficients[0] > 0.0 });
    }
    let mut survey = Survey { coefficients, error, mark };
    // most steps end here or above: on a step as long as a series allows the first terms tell most of it
    if is_monotone(coefficients) {
        return survey.monotone([coefficients[0], value(coefficients, 1.0)], WHOLE);
    }
    survey.piece(&half(coefficients, true)[..coefficients.len()], WHOLE, 0);
}

/// All of the interval.
const WHOLE: Place = Place { centre: 0.5, half: 0.5 };

#[derive(Clone, Copy)]
struct Place {
    centre: f64,
    half: f64,
}

impl Place {
    fn at(self, v: f64) -> f64 {
        self.centre + self.half * v
    }

    fn part(self, side: f64) -> Place {
        Place { centre: self.centre + side * self.half / 2.0, half: self.half / 2.0 }
    }
}

struct Survey<'s, M> {
    coefficients: &'s [f64],
    error: f64,
    mark: &'s mut M,
}

impl<M: FnMut(Mark)> Survey<'_, M> {
    fn piece(&mut self, c: &[f64], place: Place, halvings: u32) {
        let rest = sum_of_sizes(&c[1..]);
        if c[0].abs() > rest + self.error {
            (self.mark)(Mark::Sign { at: place.at(-1.0), positive: c[0] > 0.0 });
        } else if c[0].abs() + rest <= self.error || halvings == MOST_HALVINGS {
            (self.mark)(Mark::Near { at: place.centre, size: c[0].abs() });
        } else if is_monotone(c) {
            self.monotone([-1.0, 1.0].map(|end| value(c, end)), place);
        } else {
            for (side, is_right) in [(-1.0, false), (1.0, true)] {
                self.piece(&half(c, is_right)[..c.len()], place.part(side), halvings + 1);
            }
        }
    }

    /// Given the values at both ends.
    fn monotone(&mut self, [left, right]: [f64; 2], place: Place) {
        let is_known = |end: f64| end.abs() > self.error;
        if is_known(left) {
            (self.mark)(Mark::Sign { at: place.at(-1.0), positive: left > 0.0 });
        }
        if is_known(left) && is_known(right) {
            if (left > 0.0) != (right > 0.0) {
                let at = self.zero([left, right], place);
                (self.mark)(Mark::Zero { at, positive: right > 0.0, until: place.at(1.0) });
            }
            return;
        }
        if (left > 0.0) != (right > 0.0) {
            let at = self.zero([left, right], place);
            (self.mark)(Mark::Near { at, size: 0.0 });
        } else {
            let (end, size) = if left.abs() < right.abs() { (-1.0, left.abs()) } else { (1.0, right.abs()) };
            (self.mark)(Mark::Near { at: place.at(end), size });
        }
        if is_known(right) {
            (self.mark)(Mark::Sign { at: place.at(1.0), positive: right > 0.0 });
        }
    }

    /// The only zero on a piece with a change of sign, by Newton's method between two ends that enclose it; with the original
    /// coefficients, which no shift has rounded.
    fn zero(&self, [left, right]: [f64; 2], place: Place) -> f64 {
        let rises = right > left;
        let (mut low, mut high) = (place.at(-1.0), place.at(1.0));
        let mut at = (low + (high - low) * (left / (left - right))).clamp(low, high);
        for _ in 0..200 {
            let (value, slope) = value_and_slope(self.coefficients, at);
            *(if (value > 0.0) == rises { &mut high } else { &mut low }) = at;
            let newton = at - value / slope;
            let next = if low <= newton && newton <= high { newton } else { 0.5 * (low + high) };
            if next == at || value == 0.0 {
                break;
            }
            // With half the piece as unit, and the mean slope (right - left)/2, which is at least half of that in the middle, the
            // second derivative is at most twice the degree times the mean slope.
            let is_steep = slope.abs() * place.half > STEEP * (right - left).abs() / 2.0;
            let is_close = (next - at).abs() < CLOSE * place.half;
            at = next;
            if is_close && is_steep {
                break;
            }
        }
        at
    }
}

fn is_monotone(c: &[f64]) -> bool {
    let bends: f64 = c.iter().enumerate().skip(2).map(|(k, c)| k as f64 * c.abs()).sum();
    c.len() > 1 && c[1].abs() > bends
}

fn sum_of_sizes(c: &[f64]) -> f64 {
    c.iter().map(|c| c.abs()).sum()
}

/// `binomial(k, j) 2^-k` in row `k`.
static SHIFTS: [Coefficients; MAX_ORDER + 1] = {
    let mut rows = [[0.0; MAX_ORDER + 1]; MAX_ORDER + 1];
    rows[0][0] = 1.0;
    let mut k = 1;
    while k <= MAX_ORDER {
        rows[k][0] = 0.5 * rows[k - 1][0];
        let mut j = 1;
        while j <= k {
            rows[k][j] = 0.5 * (rows[k - 1][j - 1] + rows[k - 1][j]);
            j += 1;
        }
        k += 1;
    }
    rows
};

/// The coefficients about `v = 1/2`, or `-1/2`, in units of half the present width: `sum_k binomial(k, j) (+-1)^(k - j) 2^-k c_k`.
///
/// Coefficient by coefficient of the given ones, so that no sum waits for the one before it.
fn half(c: &[f64], is_right: bool) -> Coefficients {
    let mut sums = [0.0; MAX_ORDER + 1];
    for (k, &c) in c.iter().enumerate() {
        let c = if is_right || k % 2 == 0 { c } else { -c };
        for (sum, shift) in sums[..=k].iter_mut().zip(&SHIFTS[k][..=k]) {
            *sum += shift * c;
        }
    }
    if !is_right {
        sums.iter_mut().skip(1).step_by(2).for_each(|sum| *sum = -*sum);
    }
    sums
}

fn value(c: &[f64], v: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * v + c)
}

fn value_and_slope(c: &[f64], u: f64) -> (f64, f64) {
    c.iter().rev().fold((0.0, 0.0), |(value, slope), c| (value * u + c, slope * u + value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The polynomial with these zeros and this factor.
    fn with_zeros(zeros: &[f64], factor: f64) -> Vec<f64> {
        zeros.iter().fold(vec![factor], |c, zero| {
            let mut product = vec![0.0; c.len() + 1];
            for (k, c) in c.iter().enumerate() {
                product[k + 1] += c;
                product[k] -= zero * c;
            }
            product
        })
    }

    fn marks(c: &[f64], error: f64) -> Vec<Mark> {
        let mut marks = vec![];
        survey(c, error, &mut |mark| marks.push(mark));
        marks
    }

    fn zeros(c: &[f64], error: f64) -> Vec<f64> {
        let found = marks(c, error).into_iter();
        found.filter_map(|mark| if let Mark::Zero { at, .. } = mark { Some(at) } else { None }).collect()
    }

    #[test]
    fn a_double_crossing_of_width_1e_6_is_found() {
        // (u - 0.3)^2 - 1e-12: two zeros 2e-6 apart; the depth 1e-12 is beyond the error
        let c = [0.09 - 1e-12, -0.6, 1.0];
        let found = zeros(&c, 1e-14);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - (0.3 - 1e-6)).abs() < 1e-9 && (found[1] - (0.3 + 1e-6)).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_tangency_is_near_and_not_decided() {
        let c = [0.09, -0.6, 1.0];
        let found = marks(&c, 1e-14);
        assert!(zeros(&c, 1e-14).is_empty());
        assert!(found.iter().any(|mark| matches!(mark, Mark::Near { at, .. } if (at - 0.3).abs() < 1e-6)), "{found:?}");
    }

    #[test]
    fn a_minimum_above_the_error_is_no_tangency() {
        let found = marks(&[0.09 + 1e-12, -0.6, 1.0], 1e-14);
        assert!(found.iter().all(|mark| matches!(mark, Mark::Sign { positive: true, .. })), "{found:?}");
    }

    #[test]
    fn numbers_at_the_ends_of_their_range_are_surveyed_like_others() {
        // binomials of the shift overflow beside the largest number; unscaled, every piece was halved 52 times
        let c: Vec<f64> = (0..=40).map(|k| if k % 2 == 0 { 1.0 } else { -1.7 }).collect();
        let wanted = marks(&c, 1e-13);
        for exponent in [1023, -1000] {
            let scaled: Vec<f64> = c.iter().map(|c| libm::scalbn(*c, exponent)).collect();
            assert_eq!(marks(&scaled, libm::scalbn(1e-13, exponent)), wanted);
        }
    }

    proptest! {
        #[test]
        fn every_zero_of_a_polynomial_with_known_zeros_is_found(
            inside in prop::collection::vec(0.02_f64..0.98, 0..5),
            outside in prop::collection::vec(1.1_f64..4.0, 0..4),
            factor in 0.1_f64..10.0,
        ) {
            let mut wanted = inside.clone();
            wanted.sort_by(f64::total_cmp);
            prop_assume!(wanted.windows(2).all(|pair| pair[1] - pair[0] > 1e-3));
            let c = with_zeros(&[inside, outside].concat(), factor);
            let found = zeros(&c, 1e-15 * sum_of_sizes(&c));
            prop_assert_eq!(found.len(), wanted.len());
            for (found, wanted) in found.iter().zip(&wanted) {
                prop_assert!((found - wanted).abs() < 1e-7, "{} for {}", found, wanted);
            }
        }

        #[test]
        fn signs_are_those_of_the_polynomial(c in prop::collection::vec(-1.0_f64..1.0, 2..24)) {
            let error = 1e-13;
            let mut known = None;
            for mark in marks(&c, error) {
                match mark {
                    Mark::Sign { at, positive } => {
                        let value = value(&c, at + 1e-14);
                        prop_assert!(value.abs() < 1e-12 || (value > 0.0) == positive);
                        known = Some(positive);
                    }
                    Mark::Zero { at, positive, until } => {
                        let place = first_known(&c, error, mark);
                        prop_assert!(at < place && place <= until, "{at} {place} {until}");
                        prop_assert!(value(&c, place).abs() > error && (value(&c, place) > 0.0) == positive);
                        prop_assert!(value(&c, at).abs() < 1e-13);
                        prop_assert!(known != Some(positive));
                        known = Some(positive);
                    }
                    Mark::Near { at, .. } => prop_assert!(value(&c, at).abs() < 10.0 * error),
                }
            }
        }
    }
}
