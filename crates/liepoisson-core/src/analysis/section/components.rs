//! Errors of a state whose components are of very different sizes, component by component.
//!
//! The bound of [`super::remainder`] is one number for all components, in the units of the largest. A component that is small
//! beside it, such as a momentum in large units, has its own: with a unit `d_i` for each, `z_i = x_i / d_i` obeys an equation whose
//! majorant has the rows `sum |L_ij| d_j / d_i` and `sum |Q_ijk| d_j d_k / d_i`. With the bound `E` of the error of `z`, that of
//! `x_i` is `d_i E`.
//!
//! The unit of a component is its own size on the step, unless it is small because large terms cancel: then its coefficients are
//! wrong by the round-off of these terms, and they make the unit ([`Terms`]).

use super::SectionEnsemble;
use super::remainder::{Sizes, first_of_last, term};
use super::workspace::unit;
use crate::field::{Enclosure, Functions, Majorant, Rounding, Terms};

/// Terms that add up over a step to more than so many sizes of a component cancel in it. Along the long steps of a free body
/// they add up to a few.
const CANCELS: f64 = 8.0;

/// How often the units are made from one another: round-off comes from component to component.
const PASSES: usize = 4;

/// Sizes and errors of the components of a state.
#[derive(Debug, Default)]
pub(super) struct Components {
    /// Whether they are asked for on this step.
    pub(super) are_looked_at: bool,
    n: usize,
    /// `h`
    step: f64,
    /// The sizes of the terms of the series of the state, `(order, component)`.
    terms: Vec<f64>,
    /// How far each component gets from where it starts, at most, on a part of the step or a longer one.
    rests: Vec<f64>,
    /// How wrong the series of each is on the step.
    errors: Vec<f64>,
    /// `d_i`
    units: Vec<f64>,
    of_rates: Terms,
    /// The series in these units.
    in_units: Sizes,
}

impl Components {
    /// Measures the series `(order, component)` of a state.
    pub(super) fn measure_of(&mut self, state: &[f64], n_components: usize, step: f64) {
        self.n = n_components;
        self.measure(state, step);
    }

    /// The same on another part of the step.
    pub(super) fn measure(&mut self, state: &[f64], step: f64) {
        self.step = step.abs();
        self.terms.clear();
        let mut power = 1.0;
        for (k, row) in state.chunks_exact(self.n).enumerate() {
            self.terms.extend(row.iter().map(|&coefficient| term(coefficient, self.step, k, power).abs()));
            power *= self.step;
        }
    }

    /// Finds the errors on the step that was measured, from its start: bounds, or estimates if there are no sharp ones; which of the two.
    pub(super) fn find_errors(&mut self, start: &[f64], field: &SectionEnsemble<'_>) -> bool {
        let bound = match field.majorant {
            Some(_) => {
                self.find_units(field);
                self.in_units.error_of_state(self.majorant())
            }
            None => {
                self.find_units_from_round_off(start, field);
                None
            }
        };
        let (n, unit) = (self.n, unit(self.terms.len() / self.n));
        self.errors.clear();
        for i in 0..n {
            let series = || self.terms[i..].iter().step_by(n);
            let error = bound.map_or_else(
                || series().skip(first_of_last(self.terms.len() / n)).sum(),
                |bound| bound * self.units[i],
            );
            let cancels = self.units[i] > series().sum();
            self.errors.push(error + if cancels { CANCELS * unit * self.units[i] } else { 0.0 });
        }
        bound.is_some()
    }

    /// The units, and the series in them, for a field of degree two.
    fn find_units(&mut self, field: &SectionEnsemble<'_>) {
        let Components { n, step, terms, rests, units, of_rates, in_units, .. } = self;
        rests.clear();
        rests.resize(*n, 0.0);
        units.clear();
        units.extend((0..*n).map(|i| terms[i..].iter().step_by(*n).sum::<f64>()));
        for _ in 0..PASSES {
            field.field.terms(units, rests, of_rates);
            let sums = of_rates.linear.iter().zip(&of_rates.quadratic);
            for (unit, (linear, quadratic)) in units.iter_mut().zip(sums) {
                *unit = unit.max(*step * (linear + quadratic) / CANCELS);
            }
        }
        field.field.terms(units, rests, of_rates);
        let largest =
            |row: &[f64]| row.iter().zip(&*units).fold(0.0_f64, |most, (term, unit)| most.max(over(*term, *unit)));
        in_units.set(terms.chunks_exact(*n).map(largest), *step);
    }

    /// The majorant in these units.
    fn majorant(&self) -> Majorant {
        let row =
            |sums: &[f64]| sums.iter().zip(&self.units).fold(0.0_f64, |most, (sum, unit)| most.max(over(*sum, *unit)));
        Majorant { linear: row(&self.of_rates.linear), quadratic: row(&self.of_rates.quadratic) }
    }

    /// The units for any other field, whose terms are known by their round-off.
    fn find_units_from_round_off(&mut self, start: &[f64], field: &SectionEnsemble<'_>) {
        self.find_rests(1.0);
        let Components { n, step, terms, rests, units, of_rates, .. } = self;
        field.field.terms(start, rests, of_rates);
        let largest = (0..*n).map(|i| terms[i] + rests[i]).fold(0.0, f64::max);
        units.clear();
        units.extend((0..*n).map(|i| {
            let made_from = *step * of_rates.linear[i];
            // where nothing is known of its terms, they may be as large as any
            let made_from = if made_from.is_finite() { made_from } else { largest };
            (terms[i] + rests[i]).max(made_from / CANCELS)
        }));
    }

    fn find_rests(&mut self, ratio: f64) {
        let Components { n, terms, rests, .. } = self;
        rests.clear();
        rests.resize(*n, 0.0);
        let mut power = 1.0;
        for row in terms.chunks_exact(*n).skip(1) {
            power /= ratio;
            for (rest, term) in rests.iter_mut().zip(row) {
                *rest += term * power;
            }
        }
    }

    /// Encloses a function on a part that is longer by the inverse of `ratio`, or, where that is infinite, at its start.
    pub(super) fn enclose(
        &mut self,
        function: &Functions,
        start: &[f64],
        ratio: f64,
        rounding: Rounding,
        work: &mut Vec<Enclosure>,
    ) -> Enclosure {
        self.find_rests(ratio);
        function.enclosure_by(start, |i| (self.rests[i], self.errors[i]), rounding, work)
    }

    /// The same for a state that is known without error.
    pub(super) fn enclose_exact(
        &mut self,
        function: &Functions,
        start: &[f64],
        ratio: f64,
        work: &mut Vec<Enclosure>,
    ) -> Enclosure {
        self.find_rests(ratio);
        function.enclosure_by(start, |i| (self.rests[i], 0.0), 0.0, work)
    }
}

/// A quotient of sizes, where nothing of anything is nothing.
fn over(size: f64, unit: f64) -> f64 {
    if size == 0.0 { 0.0 } else { size / unit }
}
