//! What a worker keeps for the steps of all its trajectories: the series of the surface function on a part of a step, and how
//! far it is from the function.

use super::components::Components;
use super::remainder::{Sizes, left_out, scale, term};
use super::slot::Found;
use super::{SectionEnsemble, Surface};
use crate::ensemble::Step;
use crate::field::{Enclosure, Functions, Rounding};
use crate::lanes::ROUNDINGS;

/// Memory that steps share.
#[derive(Default)]
pub(super) struct Workspace {
    pub(super) state: Vec<f64>,
    pub(super) series: Vec<f64>,
    pub(super) work: Vec<f64>,
    pub(super) enclosures: Vec<Enclosure>,
    pub(super) sizes: Sizes,
    /// How far the series of the state is from the state on the step.
    error_of_state: f64,
    /// The same component by component, where one is small beside the others.
    components: Components,
    /// How far errors of the state and round-off move the function on the part.
    along: f64,
    /// Parts of the step that may still be made beyond those of all functions.
    pub(super) n_spare: usize,
    /// Whether they are enough for the part that is looked at.
    pub(super) can_be_followed: bool,
    /// Parts of the step that were given up although the function exists.
    pub(super) n_lost: usize,
    /// Whether there is a part of the step of which nothing is known.
    pub(super) is_blind: bool,
}

/// The error, in units of the round-off of the sum of the terms, that is small enough not to ask for shorter parts.
pub(super) const SHARP: f64 = 16.0;

/// How far the series of the function is from it on a part, at most.
#[derive(Clone, Copy)]
pub(super) struct Error {
    pub(super) size: f64,
    /// Whether that is what cannot be known; otherwise the function may do anything within it, as often as it likes.
    pub(super) is_sharp: bool,
}

/// What errors of the state may do on a part, in units of what they do at its start, where shorter parts would not help.
pub(super) const BLUNT: f64 = 8.0;

/// How wrong a linear form is where each of its components is within `rest` of where it starts and known up to `error`: what its
/// tape says, in one pass.
pub(super) fn error_of_form<'s>(
    (constant, terms): (f64, &[(usize, f64)]),
    starts: impl Iterator<Item = &'s f64>,
    rest: f64,
    error: f64,
    unit: f64,
) -> f64 {
    let (mut value, mut sizes, mut errors) = (constant, 0.0, 0.0);
    for (&(_, c), start) in terms.iter().zip(starts) {
        value += c * start;
        sizes += c.abs() * rest;
        errors += c.abs() * (error + unit * (start.abs() + rest));
    }
    errors + unit * (value.abs() + sizes)
}

/// Round-off of a sum of terms of a series of so many orders, relative to their sizes.
pub(super) fn unit(n_orders: usize) -> f64 {
    2.0 * ROUNDINGS * n_orders as f64 * f64::EPSILON
}

/// Whether a component of a series `(order, component)` of a state grows evenly, as time does: its series ends and leaves nothing
/// out, so that the error of the largest component tells nothing of it.
fn grows_evenly(state: &[f64], n: usize) -> bool {
    (n..2 * n).any(|i| state[i] != 0.0 && state[i + n..].iter().step_by(n).all(|&coefficient| coefficient == 0.0))
}

impl Workspace {
    /// Finds how far the series `(order, component)` of a state is from the state on a step; whether that is bounded, or
    /// estimated only.
    pub(super) fn measure(&mut self, state: &[f64], step: f64, field: &SectionEnsemble<'_>) -> bool {
        let Workspace { sizes, error_of_state, components, .. } = self;
        let n = field.any.n_components;
        sizes.measure(state, n, step);
        components.are_looked_at =
            sizes.has_small_component(state, n) || field.majorant.is_none() && grows_evenly(state, n);
        if components.are_looked_at {
            components.measure_of(state, n, step);
            return components.find_errors(&state[..n], field);
        }
        let bound = field.majorant.and_then(|majorant| sizes.error_of_state(majorant));
        *error_of_state = bound.unwrap_or_else(|| sizes.last());
        bound.is_some()
    }

    /// Expands the function along a part of a step, in units of that part.
    pub(super) fn expand(&mut self, state: &[f64], length: f64, function: &Functions, n: usize) {
        let Workspace { series, work, .. } = self;
        series.resize(state.len() / n, 0.0);
        function.series(state, work, series);
        scale(series, length);
        if !series.iter().all(|c| c.is_finite()) {
            // a coefficient may leave the range where its term does not
            let mut in_units = state.to_vec();
            let mut power = 1.0;
            for (k, row) in in_units.chunks_exact_mut(n).enumerate() {
                row.iter_mut().for_each(|coefficient| *coefficient = term(*coefficient, length, k, power));
                power *= length;
            }
            function.series(&in_units, work, series);
        }
    }

    /// Measures the sizes of the series of the state on a part of the step.
    pub(super) fn measure_part(&mut self, state: &[f64], length: f64, n: usize) {
        self.sizes.measure(state, n, length);
        if self.components.are_looked_at {
            self.components.measure(state, length);
        }
    }

    /// How far the series is from the function, at most; none where it does not exist, where shorter parts are better, or,
    /// on the last part, where it is of no use.
    ///
    /// Each coefficient of the state and each operation is right to a few units in the last place of a sum of products, and
    /// so is every shift of the survey.
    pub(super) fn error(&mut self, start: &[f64], function: &Functions, halvings: u32, is_last: bool) -> Option<Error> {
        let Workspace { series, enclosures, sizes, error_of_state, components, along: kept_along, .. } = self;
        let unit = unit(series.len());
        let rounding = Rounding::of_series(unit, series.len(), sizes.length());
        let total: f64 = series.iter().map(|c| c.abs()).sum();
        let [here, along, left_out] = if let Some(form) = function.linear_form().filter(|_| !components.are_looked_at) {
            let starts = || form.1.iter().map(|&(i, _)| &start[i]);
            let error = |rest| error_of_form(form, starts(), rest, *error_of_state, unit);
            [error(0.0), error(sizes.rest(1.0)), 0.0]
        } else if components.are_looked_at {
            let [here, along] = [f64::INFINITY, 1.0]
                .map(|ratio| components.enclose(function, start, ratio, rounding, enclosures).error);
            let enclose = |ratio| components.enclose_exact(function, start, ratio, enclosures);
            [here, along, left_out(function, halvings, series.len(), along, enclose)]
        } else {
            let [here, along] = [0.0, sizes.rest(1.0)]
                .map(|rest| function.enclosure(start, rest, *error_of_state, rounding, enclosures).error);
            [here, along, sizes.left_out(start, function, halvings, along, enclosures)]
        };
        *kept_along = along;
        let error = along + left_out + unit * total;
        // where all coefficients are zero, those of shorter parts are, too
        let is_sharp = error <= SHARP * unit * total || left_out <= along && (along <= BLUNT * here || total == 0.0);
        // a bound beyond the function itself tells nothing
        let is_of_use = is_sharp || is_last && error < total;
        (error.is_finite() && total.is_finite() && is_of_use).then_some(Error { size: error, is_sharp })
    }

    /// Whether the sign of the function may not be seen on the part because numbers below the smallest have no digits, and
    /// whether that is so on all of it; given its error.
    pub(super) fn vanishes(&mut self, start: &[f64], function: &Functions, error: f64) -> Option<bool> {
        let Workspace { series, enclosures, sizes, error_of_state, components, along, .. } = self;
        let rest: f64 = series[1..].iter().map(|c| c.abs()).sum();
        if function.is_affine() || series[0].abs() > rest + error {
            return None;
        }
        let rounding = Rounding::from(unit(series.len()));
        let in_range = if components.are_looked_at {
            components.enclose(function, start, 1.0, rounding, enclosures)
        } else {
            function.enclosure(start, sizes.rest(1.0), *error_of_state, rounding, enclosures)
        };
        (*along > 2.0 * in_range.error).then_some(series[0].abs() + rest <= error)
    }

    /// What is kept of the point at a fraction `at` of the step.
    pub(super) fn keep(&mut self, step: &Step<'_>, surface: &Surface, n: usize, at: f64) -> Found {
        let tau = at * step.size;
        let mut state = vec![0.0; n];
        step.state(tau, &mut state);
        let is_on_surface = self.is_guarded(surface, &state);
        let kept = match &surface.kept {
            None => state,
            Some(kept) => {
                let mut values = vec![0.0; kept.n_functions()];
                kept.series(&state, &mut self.work, &mut values);
                values
            }
        };
        Found { time: step.time + tau, kept, is_on_surface }
    }

    /// Whether a zero of the function belongs to the surface.
    pub(super) fn is_guarded(&mut self, surface: &Surface, state: &[f64]) -> bool {
        surface.guard.as_ref().is_none_or(|guard| {
            let mut value = [0.0];
            guard.series(state, &mut self.work, &mut value);
            value[0] > 0.0
        })
    }
}
