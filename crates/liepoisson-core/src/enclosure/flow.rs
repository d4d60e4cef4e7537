//! The flow of a polynomial field, with its derivative, on sets of states, step by step.
//!
//! A step of length `h` from a box `X`, with `Z` a box in which the solutions stay: with Taylor coefficients `x_k` and those
//! of the derivative `V_k`
//! ```text
//! phi_h(m)  in  sum_{k <= p} x_k(m) h^k + x_{p+1}(Z_m) h^{p+1},
//! D phi_h(X) in sum_{k <= p} V_k(X) h^k + V_{p+1}(Z) W h^{p+1},     W contains D phi_t(X) for all t of the step.
//! ```
//! The second, by the mean value theorem, moves sets around `m` ([`super::lohner`]).

use super::apriori;
use super::failure::Failure;
use super::interval::Interval;
use super::linear::larger;
use super::lohner::{DerivativeSet, StateSet};
use super::matrix::{IntervalVector, Matrix, combine, hull, is_unknown, points};
use super::program::Program;
use super::series::Series;
use crate::ensemble::Control;

/// How the flow is enclosed. None of it decides whether a result is right.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Order of the Taylor polynomial.
    pub order: usize,
    /// The longest step.
    pub step: f64,
    /// Size of the remainders of the series to which the steps are fitted; none: all steps are equal where they can be.
    pub tolerance: Option<f64>,
    /// The most steps.
    pub max_steps: usize,
}

impl Default for Options {
    fn default() -> Options {
        Options { order: 20, step: 0.1, tolerance: None, max_steps: 100_000 }
    }
}

/// States and derivatives that are moved together: the derivatives are those of the flow along all of the states.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// Sets of states; the orbits of all of them have their derivatives in `derivative`.
    pub states: Vec<StateSet>,
    /// The derivative.
    pub derivative: DerivativeSet,
}

impl Bundle {
    /// The sets at the start, with the derivatives in the directions of the columns of a matrix.
    pub fn new(states: Vec<StateSet>, directions: Matrix<f64>) -> Bundle {
        Bundle { states, derivative: DerivativeSet::new(directions) }
    }

    /// A box that contains all sets and the points that they are described from.
    pub fn hull(&self) -> IntervalVector {
        let hulls = self.states.iter().map(|set| hull(&set.hull(), &points(set.center())));
        hulls.reduce(|a, b| hull(&a, &b)).unwrap_or_default()
    }
}

/// What is known of the whole of a step.
#[derive(Clone, Debug)]
pub struct Tube {
    /// The times of the step, counted from the beginning of the flight.
    pub time: Interval,
    /// A box that contains all states during the step.
    pub states: IntervalVector,
}

/// A field that is ready to be followed.
#[derive(Clone, Debug)]
pub struct Flow {
    field: Program,
    options: Options,
    series: Series,
    /// Of the last image that was computed: the size of the remainder.
    remainder: f64,
}

impl Flow {
    /// Follows the field with these options.
    pub fn new(field: Program, options: Options) -> Flow {
        let series = Series::new(&field, options.order + 1);
        Flow { field, options, series, remainder: 0.0 }
    }

    /// The field.
    pub fn field(&self) -> &Program {
        &self.field
    }

    /// Moves a bundle by `duration`, which may be negative, and shows each step to `watch`.
    ///
    /// # Errors
    /// A step that has no enclosure, too many steps, the wish of the caller to end.
    pub fn advance(
        &mut self,
        bundle: &mut Bundle,
        duration: f64,
        control: &Control,
        mut watch: impl FnMut(&Tube),
    ) -> Result<(), Failure> {
        let mut elapsed = Interval::ZERO;
        let mut wanted = self.first_step(bundle, duration.abs());
        for _ in 0..self.options.max_steps {
            // the last step has the length that is missing, which is not known to the last digit
            let rest = Interval::point(duration) - elapsed;
            if rest == Interval::ZERO {
                return Ok(());
            }
            if control.look_at_clock().is_some() {
                return Err(Failure::Stopped);
            }
            let mut is_last = rest.mag() <= wanted * (1.0 + 1e-9);
            let mut length = if is_last { rest } else { Interval::point(wanted.copysign(duration)) };
            let mut moved = self.step(bundle, length);
            for _ in 0..40 {
                if moved.is_some() && !self.is_inaccurate() {
                    break;
                }
                wanted = if moved.is_some() { self.next_step(length.mag()) } else { 0.5 * length.mag() };
                (is_last, length) = (false, Interval::point(wanted.copysign(duration)));
                moved = self.step(bundle, length);
            }
            let Some((states, next)) = moved else { return Err(Failure::NoStep { time: elapsed.mid() }) };
            *bundle = next;
            let end = elapsed + length;
            watch(&Tube { time: elapsed.hull(end), states });
            if is_last {
                return Ok(());
            }
            elapsed = end;
            wanted = self.next_step(wanted);
        }
        Err(Failure::Steps { time: elapsed.mid() })
    }

    /// Equal steps, or one for which the last terms of the series are of the size of the tolerance.
    fn first_step(&mut self, bundle: &Bundle, duration: f64) -> f64 {
        let longest = self.options.step.min(duration);
        match (self.options.tolerance, bundle.states.first()) {
            (Some(tolerance), Some(set)) => {
                self.series.expand(&self.field, &points(set.center()));
                let steps = [self.options.order - 1, self.options.order].map(|k| {
                    let size = self.series.state(k).iter().map(|entry| entry.mag()).fold(0.0, larger);
                    0.5 * libm::pow(tolerance / size, 1.0 / k as f64)
                });
                steps.into_iter().filter(|&step| step > 0.0).fold(longest, f64::min)
            }
            _ if longest > 0.0 => duration / (duration / longest).ceil(),
            _ => longest,
        }
    }

    /// Whether the last step should be made again, shorter.
    fn is_inaccurate(&self) -> bool {
        self.options.tolerance.is_some_and(|tolerance| self.remainder > 30.0 * tolerance)
    }

    /// The step after one of this length.
    fn next_step(&self, last: f64) -> f64 {
        let Some(tolerance) = self.options.tolerance else { return last };
        let ratio = libm::pow(tolerance / self.remainder, 1.0 / (self.options.order + 1) as f64);
        // most of the work is lost where no enclosure is found, so that a step grows slowly
        let factor = if ratio.is_nan() { 1.0 } else { (0.9 * ratio).clamp(0.3, 1.2) };
        (last * factor).min(self.options.step)
    }

    /// Where the states are during a step, and the bundle after it; `None` if there is no enclosure.
    fn step(&mut self, bundle: &Bundle, length: Interval) -> Option<(IntervalVector, Bundle)> {
        let time = length.hull(Interval::ZERO);
        let start = bundle.hull();
        let tube = apriori::states(&self.field, &start, time)?;
        let derivative = self.derivative(&start, &tube, length)?;
        let mut moved = bundle.clone();
        for set in &mut moved.states {
            let image = self.image(&points(set.center()), length)?;
            set.advance(&image, &derivative)?;
        }
        moved.derivative.advance(&derivative)?;
        Some((tube, moved))
    }

    /// A matrix that contains the derivatives of the flow after `length` on the box `start`, whose orbits stay in `tube`.
    pub(super) fn derivative(
        &mut self,
        start: &[Interval],
        tube: &[Interval],
        length: Interval,
    ) -> Option<Matrix<Interval>> {
        let order = self.options.order;
        let meanwhile = apriori::derivatives(&self.field.jacobian(tube), length.hull(Interval::ZERO));
        self.series.expand_with_derivative(&self.field, tube);
        let power = length.powi(order as u32 + 1);
        let remainder = self.series.derivative(order + 1).times(&meanwhile).map(|entry| entry * power);
        self.series.expand_with_derivative(&self.field, start);
        let derivative = self.series.derivative_at(length, order).plus(&remainder);
        (!derivative.is_unknown()).then_some(derivative)
    }

    /// A box that contains the images of a small box after `length`.
    pub(super) fn image(&mut self, start: &[Interval], length: Interval) -> Option<IntervalVector> {
        let order = self.options.order;
        let tube = apriori::states(&self.field, start, length.hull(Interval::ZERO))?;
        self.series.expand(&self.field, &tube);
        let remainder = self.series.state(order + 1);
        self.series.expand(&self.field, start);
        let power = length.powi(order as u32 + 1);
        let polynomial = self.series.state_at(length, order);
        let remainder: IntervalVector = remainder.iter().map(|&entry| entry * power).collect();
        self.remainder = remainder.iter().map(|entry| entry.mag()).fold(0.0, larger);
        let image = combine(&polynomial, &remainder, |polynomial, remainder| polynomial + remainder);
        (!is_unknown(&image)).then_some(image)
    }
}
