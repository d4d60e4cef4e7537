//! A whole step of a surface that is linear in the state, from what is known of all lanes at once: most steps end here.

use super::remainder::{error_of_state, first_of_last, is_in_range, small};
use super::survey::{Mark, RANGE};
use super::workspace::{BLUNT, SHARP, error_of_form, unit};
use super::{Part, Recorder, SectionEnsemble};
use crate::ensemble::Step;
use crate::method::{Overview, SeriesSums};

impl Recorder<'_> {
    /// Looks for crossings on a whole step of a surface that is linear in the state, from what is known of all lanes; whether
    /// that was enough. It sees what [`Recorder::look`] would.
    pub(super) fn look_at_once(&mut self, lane: usize, step: &Step<'_>, whole: Part) -> bool {
        let (n_lanes, overview) = (self.slots.len(), &self.overview);
        let known = self.is_looked_over.then(|| known_at_once((lane, n_lanes), step.size, self.ensemble, overview));
        let Some(Known { error, is_bounded }) = known.flatten() else { return false };
        let values = overview.values[lane..].iter().step_by(n_lanes).copied();
        let positive =
            sign_along(&overview.sums[lane], [overview.values[lane], overview.values[n_lanes + lane]], error);
        self.slots[lane].uncertified.n_unbounded += u64::from(!is_bounded);
        if let Some(positive) = positive {
            self.slots[lane].forget_refuted_side(overview.values[lane], error);
            self.note(lane, step, whole, Mark::Sign { at: 0.0, positive }, |_| 0.0);
            self.count_lost_change(lane, step, whole);
        } else {
            self.workspace.series.clear();
            self.workspace.series.extend(values);
            self.survey_part(lane, step, whole, error);
        }
        true
    }
}

/// What is known on a whole step of a function that is linear in the state, of one of so many lanes whose series were looked over;
/// nothing where a component may be small beside the others, or where shorter parts are better.
fn known_at_once(
    (lane, n_lanes): (usize, usize),
    step: f64,
    field: &SectionEnsemble<'_>,
    overview: &Overview<'_>,
) -> Option<Known> {
    let sums = &overview.sums[lane];
    let (n_terms, unit) = (overview.values.len() / n_lanes, unit(overview.values.len() / n_lanes));
    let largest = |k: usize| overview.largest[k * n_lanes + lane];
    if !is_in_range(step, n_terms) || sums.least < small([largest(0), largest(1)]) {
        return None;
    }
    let last = (n_terms, largest(n_terms - 1));
    let bound = field.majorant.and_then(|field| error_of_state(step.abs(), last, sums.state, sums.products, field));
    let error = bound.unwrap_or_else(|| (first_of_last(n_terms)..n_terms).map(largest).sum());
    let starts = overview.starts[lane..].iter().step_by(n_lanes);
    let along = error_of_form(overview.form, starts.clone(), sums.state_rest, error, unit);
    let size = along + unit * sums.total;
    let is_sharp =
        || size <= SHARP * unit * sums.total || along <= BLUNT * error_of_form(overview.form, starts, 0.0, error, unit);
    (size.is_finite() && sums.total.is_finite() && is_sharp())
        .then_some(Known { error: size, is_bounded: bound.is_some() })
}

/// What is known of a function along a whole step.
#[derive(Clone, Copy)]
struct Known {
    /// How far its series is from it.
    error: f64,
    /// Whether the error of the state is bounded, and not estimated.
    is_bounded: bool,
}

/// The sign of a polynomial on all of `[0, 1]` beyond the error, given the first coefficients and sums of all: what [`survey`] finds
/// by its first two tests. None where it needs more.
fn sign_along(sums: &SeriesSums, [first, second]: [f64; 2], error: f64) -> Option<bool> {
    let is_known = |value: f64| value.abs() > error;
    let has_no_zero = first.abs() > sums.rest + error;
    let is_monotone = || second.abs() > sums.bends && is_known(first) && is_known(sums.end);
    let is_certain = RANGE.contains(&sums.most) && (has_no_zero || is_monotone() && (first > 0.0) == (sums.end > 0.0));
    is_certain.then_some(first > 0.0)
}
