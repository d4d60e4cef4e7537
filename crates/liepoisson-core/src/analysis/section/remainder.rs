//! How far the power series of a function along an orbit is from the function: a bound of what was cut off.
//!
//! Let `p` be the polynomial of order `N` that stands for the state `x` on a step of length `h`, `y_k` the largest component
//! of its coefficient `k` times `h^k`, `P = sum y_k`, and `q`, `l` the bounds of the field ([`Majorant`]).
//!
//! 1. *State.* `p` fails the equation by terms of the orders `N` to `2N` only, whose sizes add up to at most
//!    `D = q sum_{i+j >= N} y_i y_j + l y_N`, so the error `e = x - p` obeys
//!    `|e|' <= L |e| + D u^N` with `u = t/h` and `L = 2 q P + l + q |e|`. From `exp(L h (1 - u)) <= u^(-L h)` follows
//!    `|e| <= E = h D / (N + 1 - L h)` on the whole step, if `L h < N + 1`, where `|e|` in `L` is any number that `E` does
//!    not exceed. The sizes of terms that cancel in the equation add up in `D`: on very long steps, such as those of a free
//!    body, `E` can be far above round-off. A bound that is not sharp is of no use, and counts as none.
//! 2. *Function.* That moves a function `f` by at most what is known of its derivative ([`Functions::enclosure`], in the
//!    norm of largest values).
//! 3. *Series.* The terms of `f(p)` beyond order `N` are left out. With the norm `sum |f_k| (h/r)^k`, which is
//!    submultiplicative, they add up to at most `|f - f_0| r^(N+1)`, for every `r < 1` for which that is finite: the series
//!    of `f` must converge on a step longer by `1/r`. A linear `f` has none.
//!
//! Where a component is small beside the others, each has its own sizes and its own error: see [`super::components`].
//!
//! These are bounds for the coefficients as they are computed. That they are rounded is not in them: round-off is estimated
//! beside them, by a multiple of the unit of the last place of all that is added up and multiplied.

use crate::field::{Enclosure, Functions, Majorant};
use crate::method::FIRST_TERMS;

/// Values of `r` that are tried, for a whole step: its length is near 0.14 of the radius of convergence of the state.
const RATIOS: [f64; 3] = [0.12, 0.2, 0.3];

/// The last terms of a series, whose sizes estimate what it leaves out: four, since two can vanish by a symmetry.
const LAST: usize = 4;

/// The first of them, of so many terms.
pub(super) fn first_of_last(n_terms: usize) -> usize {
    n_terms.saturating_sub(LAST).max(1)
}

/// The error of the state in units of its size up to which a bound is of use; it is also the one in `L`.
const SHARP: f64 = 1e-12;

/// The size, in units of the largest component, below which a component has an error of its own.
const SMALL: f64 = 1.0 / 1024.0;

/// `coefficient length^k`, given the power as it was computed: it may have left the range of numbers where the product has not.
pub(super) fn term(coefficient: f64, length: f64, k: usize, power: f64) -> f64 {
    if (1e-280..1e280).contains(&power.abs()) || coefficient == 0.0 && !power.is_nan() {
        return if coefficient == 0.0 { 0.0 } else { coefficient * power };
    }
    let (mantissa, exponent) = libm::frexp(length);
    let power = (0..k).fold(1.0, |power, _| power * mantissa);
    libm::scalbn(coefficient * power, (i64::from(exponent) * k as i64).clamp(-5000, 5000) as i32)
}

/// Whether the powers of a length up to this one are well within the range of numbers.
pub(super) fn is_in_range(length: f64, power: usize) -> bool {
    (1e-280..1e280).contains(&length.abs().powi(power as i32))
}

/// Puts a series in units of a length: [`term`] for each coefficient.
#[inline(always)]
pub(super) fn scale(series: &mut [f64], length: f64) {
    let is_in_range = is_in_range(length, series.len());
    let mut power = 1.0;
    for (k, coefficient) in series.iter_mut().enumerate() {
        *coefficient = if is_in_range { *coefficient * power } else { term(*coefficient, length, k, power) };
        power *= length;
    }
}

/// The sizes of the terms of a series about the start of a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Sizes {
    /// `y_k`.
    terms: Vec<f64>,
    /// `h`.
    step: f64,
}

impl Sizes {
    /// Given as they are.
    pub(super) fn set(&mut self, terms: impl Iterator<Item = f64>, step: f64) {
        self.step = step.abs();
        self.terms.clear();
        self.terms.extend(terms);
    }

    /// Of the series `(order, component)` of a state, for a step of size `step`.
    pub(super) fn measure(&mut self, state: &[f64], n_components: usize, step: f64) {
        let largest =
            |row: &[f64]| row.iter().fold(0.0, |largest, c| if c.abs() > largest { c.abs() } else { largest });
        self.measure_largest(state.chunks_exact(n_components).map(largest), step);
    }

    /// The same, given the largest coefficients of all orders.
    #[inline(always)]
    fn measure_largest(&mut self, largest: impl Iterator<Item = f64>, step: f64) {
        self.step = step.abs();
        self.terms.clear();
        self.terms.extend(largest);
        scale(&mut self.terms, self.step);
    }

    /// [`error_of_state`] of these terms.
    pub(super) fn error_of_state(&self, field: Majorant) -> Option<f64> {
        let last = self.terms.last().copied().unwrap_or(0.0);
        error_of_state(self.step, (self.terms.len(), last), self.sum(), self.products(), field)
    }

    /// `sum_{i+j >= N} y_i y_j = sum_i y_i (y_{N-i} + ... + y_N)`
    fn products(&self) -> f64 {
        let (mut last, mut products) = (0.0, 0.0);
        for (term, highest) in self.terms.iter().zip(self.terms.iter().rev()) {
            last += highest;
            products += term * last;
        }
        products
    }

    /// An estimate of the error of the state on the whole step.
    pub(super) fn last(&self) -> f64 {
        self.terms[first_of_last(self.terms.len())..].iter().sum()
    }

    /// How far the state gets from where it starts, in the norm `sum |x_k| (h/r)^k`, at most.
    pub(super) fn rest(&self, ratio: f64) -> f64 {
        let (mut power, mut sum) = (1.0, 0.0);
        for term in &self.terms[1..] {
            power /= ratio;
            sum += term * power;
        }
        sum
    }

    /// What the series of a function leaves out on a part of a step that was halved so often, at most; less than `wanted` if
    /// it can. The function is that of the state `start`.
    pub(super) fn left_out(
        &self,
        start: &[f64],
        function: &Functions,
        halvings: u32,
        wanted: f64,
        work: &mut Vec<Enclosure>,
    ) -> f64 {
        let enclose = |ratio| function.enclosure(start, self.rest(ratio), 0.0, 0.0, work);
        left_out(function, halvings, self.terms.len(), wanted, enclose)
    }

    /// Whether a component is small beside the others along the whole step, so that what is known of the largest tells nothing
    /// of it. One that stays zero is not small: what is known of it is known of all its orbits in the same subspace.
    pub(super) fn has_small_component(&self, state: &[f64], n_components: usize) -> bool {
        let least = self.least();
        self.may_be_small(state, n_components).any(|i| self.is_small(&state[i..], n_components, least))
    }

    /// Components that may be small, by the first two orders of the series `(order, component)`: one of these terms of nearly
    /// every component is large, or all are zero.
    pub(super) fn may_be_small(&self, state: &[f64], n_components: usize) -> impl Iterator<Item = usize> {
        let (start, rate) = state[..2 * n_components].split_at(n_components);
        let least = self.least();
        (0..n_components).filter(move |&i| !(start[i].abs() >= least || (rate[i] * self.step).abs() >= least))
    }

    fn least(&self) -> f64 {
        small([self.terms[0], self.terms[1]])
    }

    /// Whether the component that a series begins with has no term so large, and does not stay zero.
    #[inline(never)]
    fn is_small(&self, series: &[f64], n_components: usize, least: f64) -> bool {
        let coefficients = || series.iter().step_by(n_components);
        if coefficients().take(FIRST_TERMS).all(|&coefficient| coefficient == 0.0) {
            return false;
        }
        let mut power = 1.0;
        coefficients().enumerate().all(|(k, &coefficient)| {
            let size = term(coefficient, self.step, k, power).abs();
            power *= self.step;
            size < least
        })
    }

    /// The length of the step.
    pub(super) fn length(&self) -> f64 {
        self.step
    }

    /// `P`, which bounds the state on the whole step.
    pub(super) fn sum(&self) -> f64 {
        self.terms.iter().sum()
    }
}

/// `E`, a bound of the error of the state on a whole step of length `h`; none if there is no sharp one. Given how many terms there
/// are and the last one, `P`, and the sum of products in `D`.
pub(super) fn error_of_state(
    step: f64,
    (n_terms, last): (usize, f64),
    sum: f64,
    products: f64,
    Majorant { linear, quadratic }: Majorant,
) -> Option<f64> {
    let n = n_terms as f64; // N + 1
    let growth = step * (quadratic * (2.0 + SHARP) * sum + linear);
    let error = step * (quadratic * products + linear * last) / (n - growth);
    (growth < n && error <= SHARP * sum).then_some(error)
}

/// The size below which a component has an error of its own, given the first two terms of the largest ones.
pub(super) fn small([first, second]: [f64; 2]) -> f64 {
    SMALL * first.max(second)
}

/// What the series of a function to so many orders leaves out on a part of a step that was halved so often, at most; less than
/// `wanted` if it can. `enclose` encloses it on the part that is longer by the inverse of a ratio.
pub(super) fn left_out(
    function: &Functions,
    halvings: u32,
    n_orders: usize,
    wanted: f64,
    mut enclose: impl FnMut(f64) -> Enclosure,
) -> f64 {
    if function.is_affine() {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    // the series of the state allows small ratios on short parts, that of the function perhaps large ones only
    for shorter in (0..=halvings).rev() {
        for ratio in RATIOS.map(|ratio| ratio * 0.5_f64.powi(shorter as i32)) {
            least = least.min(enclose(ratio).rest * ratio.powi(n_orders as i32));
            if least <= wanted {
                return least;
            }
        }
    }
    least
}

/// The series `(order, component)` of a polynomial about a later time.
pub(super) fn shifted(state: &[f64], n: usize, by: f64) -> Vec<f64> {
    let (mut series, n_orders) = (state.to_vec(), state.len() / n);
    for k in 0..n_orders {
        for j in (k..n_orders - 1).rev() {
            for i in 0..n {
                series[j * n + i] += by * series[(j + 1) * n + i];
            }
        }
    }
    series
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Instruction;

    #[test]
    fn the_remainder_of_a_solution_known_in_closed_form_is_bounded() {
        // x' = x^2, x(0) = 1: x = 1/(1 - t), coefficients 1; the series to order N leaves out h^(N+1)/(1-h)
        let functions = [0, 1].map(|output| Functions::new(1, vec![Instruction::Product(0, 0)], vec![output]).unwrap());
        let majorant = Majorant { linear: 0.0, quadratic: 1.0 };
        for (order, step) in [(20, 0.05_f64), (24, 0.1), (30, 0.15), (40, -0.1)] {
            let mut sizes = Sizes::default();
            sizes.measure(&vec![1.0; order + 1], 1, step);
            let error = sizes.error_of_state(majorant).unwrap();
            let [identity, square] = functions.each_ref().map(|function| {
                let (start, work) = (&[1.0], &mut vec![]);
                let moved = function.enclosure(start, sizes.rest(1.0), error, 0.0, work).error;
                moved + sizes.left_out(start, function, 0, 0.0, work)
            });
            let h = step.abs();
            let left_out = h.powi(order as i32 + 1) / (1.0 - h);
            assert!((left_out..100.0 * left_out).contains(&identity), "{identity:e} for {left_out:e}");
            // x^2 = sum (k+1) t^k
            let squared = (order + 1..order + 200).map(|k| (k + 1) as f64 * h.powi(k as i32)).sum::<f64>();
            // as far as the ratios go that are tried, below round-off
            assert!((squared..1e-15).contains(&square), "{square:e} for {squared:e}");
        }
    }

    #[test]
    fn a_step_that_is_too_long_has_no_bound() {
        let mut sizes = Sizes::default();
        sizes.measure(&[1.0; 21], 1, 0.99);
        assert_eq!(sizes.error_of_state(Majorant { linear: 0.0, quadratic: 1.0 }), None);
    }

    #[test]
    fn the_remainder_of_functions_that_are_no_polynomials_is_bounded() {
        // x = 1 + t, whose series ends, and the functions of it on a part of length h: sqrt leaves out about binomial(1/2, N+1)
        let mut state = vec![0.0; 21];
        (state[0], state[1]) = (1.0, 1.0);
        for (instruction, value) in [
            (Instruction::Sqrt(0), libm::sqrt as fn(f64) -> f64),
            (Instruction::Exp(0), libm::exp),
            (Instruction::Sin(0), libm::sin),
            (Instruction::Log(0), libm::log),
            (Instruction::Atan(0), libm::atan),
            (Instruction::Tanh(0), libm::tanh),
        ] {
            let function = Functions::new(1, vec![instruction.clone()], vec![1]).unwrap();
            let mut series = vec![0.0; 21];
            function.series(&state, &mut vec![], &mut series);
            for h in [0.05, 0.1, 0.2, 0.25] {
                let mut sizes = Sizes::default();
                sizes.measure(&state, 1, h);
                let bound = sizes.left_out(&[1.0], &function, 0, 0.0, &mut vec![]);
                let sum = series.iter().rev().fold(0.0, |sum, c| sum * h + c);
                let left_out = (sum - value(1.0 + h)).abs();
                assert!(left_out <= bound + 1e-15 && bound < 1e-6, "{instruction:?}, {h}: {left_out:e} for {bound:e}");
            }
        }
    }

    #[test]
    fn beyond_the_radius_of_a_function_there_is_no_bound() {
        let function = Functions::new(1, vec![Instruction::Sqrt(0)], vec![1]).unwrap();
        let mut sizes = Sizes::default();
        sizes.measure(&[1.0, 1.0, 0.0], 1, 1.01);
        assert_eq!(sizes.left_out(&[1.0], &function, 3, 0.0, &mut vec![]), f64::INFINITY);
    }
}
