//! The calls of the core: arrays in, a table of arrays out.

use crate::refusal::{Kind, Refusal};
use liepoisson_core::analysis::orbit::{self, Kept};
use liepoisson_core::analysis::orbit_units::orbit_units;
use liepoisson_core::analysis::section::{self, Surface};
use liepoisson_core::analysis::tangent_frames::{self, Schedule};
use liepoisson_core::analysis::verdict::{self, Question, Rule};
use liepoisson_core::analysis::{filled, last_states, lyapunov, rates};
use liepoisson_core::choice::{AnyField, AnyMethod};
use liepoisson_core::ensemble::{AnyEnsemble, Control, Summary};
use liepoisson_core::error::Error;
use liepoisson_core::field::Functions;
use liepoisson_core::lanes::Simd;

/// Arrays of a result, one after the other; what each is, the call says that made it.
pub(crate) struct Table {
    pub(crate) parts: Vec<Vec<f64>>,
    /// Of an orbit with dense output: number of components, and whether it runs backwards.
    dense: Option<(usize, bool)>,
}

/// Most numbers that a state and its tangent vectors may have: their series must have room in the memory of a browser.
const MOST_NUMBERS: usize = 1 << 20;

fn check_size(field: &AnyField, n_vectors: usize) -> Result<(), Refusal> {
    if n_vectors.saturating_add(1).saturating_mul(field.n_components()) <= MOST_NUMBERS {
        return Ok(());
    }
    let message = format!(
        "the trajectory: wanted at most {MOST_NUMBERS} numbers in its state and tangent vectors; got {n_vectors} vectors of {} \
         components; try a smaller system, or fewer vectors",
        field.n_components()
    );
    Err(Refusal::new(Kind::Memory, message))
}

/// Outcomes, times reached, numbers of steps and last states.
fn ends(summaries: &[Summary], n: usize) -> Result<[Vec<f64>; 4], Refusal> {
    Ok([
        summaries.iter().map(|summary| summary.outcome.code().into()).collect(),
        summaries.iter().map(|summary| summary.time).collect(),
        summaries.iter().map(|summary| summary.n_steps as f64).collect(),
        last_states(summaries, n)?,
    ])
}

/// `[outcome, end_time, n_steps, end_state, state, tangent, step_time, series]`; the last two of one orbit with dense output.
pub(crate) fn orbits(
    field: &AnyField,
    method: AnyMethod,
    states: &[f64],
    tangents: &[f64],
    n_tangents: usize,
    times: &[f64],
    dense: bool,
) -> Result<Table, Refusal> {
    let n = field.n_components();
    if dense && states.len() != n {
        return Err(Error::Length { name: "states of an orbit with dense output", wanted: n, got: states.len() }.into());
    }
    check_size(field, n_tangents)?;
    if dense && !matches!(method, AnyMethod::Taylor(_)) {
        return Err(Error::MethodForField.into());
    }
    let ensemble = AnyEnsemble::new(field.with(method)?, states, tangents, n_tangents, times);
    let mut orbits = orbit::orbits(ensemble, 0, Simd::widest(), &Control::default(), dense, |_| ())?;
    let [outcome, time, n_steps, last] = ends(&orbits.summaries, n)?;
    let series = orbits.series.pop().unwrap_or_default();
    let parts = vec![outcome, time, n_steps, last, orbits.states, orbits.tangents, series.times, series.coefficients];
    let backwards = times.len() > 1 && times[1] < times[0];
    Ok(Table { parts, dense: dense.then_some((n, backwards)) })
}

/// States of an orbit with dense output, `(time, component)`; NaN beyond its end.
pub(crate) fn states_at(orbit: &Table, times: &[f64]) -> Result<Vec<f64>, Refusal> {
    let Some((n, backwards)) = orbit.dense else {
        return Err(Error::Length { name: "series of the orbit", wanted: 1, got: 0 }.into());
    };
    let kept = Kept { times: &orbit.parts[6], coefficients: &orbit.parts[7], end: orbit.parts[1][0] };
    Ok(orbit::states_at(&[kept], n, times, backwards, Simd::widest())?)
}

/// `[outcome, end_time, n_steps, end_state, exponent]`, the last `(trajectory, time)` at the times after the first.
pub(crate) fn exponents(
    field: &AnyField,
    method: AnyMethod,
    states: &[f64],
    tangents: &[f64],
    times: &[f64],
) -> Result<Table, Refusal> {
    check_size(field, 1)?;
    let ensemble = AnyEnsemble::new(field.with(method)?, states, tangents, 1, times);
    let found = lyapunov::finite_time_exponents(ensemble, 0, Simd::widest(), &Control::default(), |_| ())?;
    let mut parts = ends(&found.summaries, field.n_components())?.to_vec();
    parts.push(found.exponents);
    Ok(Table { parts, dense: None })
}

/// `[outcome, end_time, n_steps, end_state, growth, frame, n_complete]`: frames of tangent vectors over intervals, to be carried
/// on from where a call ends; `growth` is `(trajectory, interval, vector)`.
#[allow(clippy::too_many_arguments)] // flat, as the call comes in
pub(crate) fn frames(
    field: &AnyField,
    method: AnyMethod,
    states: &[f64],
    frames: &[f64],
    n_vectors: usize,
    elapsed: &[f64],
    duration: f64,
    n_intervals: usize,
) -> Result<Table, Refusal> {
    check_size(field, n_vectors)?;
    let units = vec![1.0; states.len()];
    let schedule = Schedule { frames, units: &units, elapsed, n_intervals, per_row: 1, keep: false };
    let times = &[0.0, duration];
    let ensemble = AnyEnsemble::new(field.with(method)?, states, &[], n_vectors, times);
    let carried = tangent_frames::carry(ensemble, &schedule, 0, Simd::widest(), &Control::default(), |_| ())?;
    let mut parts = ends(&carried.summaries, field.n_components())?.to_vec();
    parts.extend([carried.growth, carried.frames, carried.n_complete.iter().map(|&n| n as f64).collect()]);
    Ok(Table { parts, dense: None })
}

/// `[outcome, end_time, n_steps, end_state, count, time, state, sign, touch_count, touch_time, touch_state, side, seen_to,
/// unresolved_time, undefined_time, unbounded_steps, unseen_steps, in_surface]`
#[allow(clippy::too_many_arguments)] // flat, as the call comes in
pub(crate) fn section(
    field: &AnyField,
    method: AnyMethod,
    functions: &Functions,
    has_guard: bool,
    direction: i32,
    n_crossings: usize,
    states: &[f64],
    sides: &[f64],
    times: &[f64],
) -> Result<Table, Refusal> {
    check_size(field, 0)?;
    let ensemble = field.section(method, states, times)?;
    let surface = Surface {
        direction: direction.clamp(-2, 2) as i8,
        n_crossings: (n_crossings > 0).then_some(n_crossings),
        sides: sides.iter().map(|&side| side as i8).collect(),
        ..Surface::of(functions.clone(), has_guard)
    };
    let sections = section::sections(ensemble, &surface, 0, Simd::widest(), &Control::default(), |_| ())?;
    let counts = |counts: Vec<usize>| counts.into_iter().map(|count| count as f64).collect();
    let signs = |signs: Vec<i8>| signs.into_iter().map(f64::from).collect();
    let mut parts = ends(&sections.summaries, field.n_components())?.to_vec();
    parts.extend([
        counts(sections.crossing_counts),
        sections.crossings.times,
        sections.crossings.states,
        signs(sections.crossings.signs),
        counts(sections.touch_counts),
        sections.touches.times,
        sections.touches.states,
        signs(sections.sides),
        sections.uncertified.iter().map(|uncertified| uncertified.seen_to).collect(),
        sections.uncertified.iter().map(|uncertified| uncertified.unresolved_time).collect(),
        sections.uncertified.iter().map(|uncertified| uncertified.undefined_time).collect(),
        sections.uncertified.iter().map(|uncertified| uncertified.n_unbounded as f64).collect(),
        sections.uncertified.iter().map(|uncertified| uncertified.n_unseen as f64).collect(),
        sections.uncertified.iter().map(|uncertified| f64::from(u8::from(uncertified.is_in_surface))).collect(),
    ]);
    Ok(Table { parts, dense: None })
}

/// `[time, component]`: natural units along orbits.
pub(crate) fn units(field: &AnyField, method: AnyMethod, states: &[f64], periods: &[f64]) -> Result<Table, Refusal> {
    check_size(field, field.n_components())?;
    let found = orbit_units(&field.with(method)?, states, periods, Simd::widest())?;
    let times = found.iter().map(|units| units.time).collect();
    Ok(Table::of(vec![times, found.into_iter().flat_map(|units| units.components).collect()]))
}

/// `[outcome, kind, exponent, indicators]`.
pub(crate) fn decide(field: &AnyField, method: AnyMethod, question: &Question<'_>) -> Result<Table, Refusal> {
    check_size(field, 2)?;
    let found = verdict::decide(&Rule::USUAL, &field.with(method)?, question, Simd::widest())?;
    Ok(Table::of(vec![
        found.iter().map(|of| of.outcome.code().into()).collect(),
        found.iter().map(|of| f64::from(of.kind as i8)).collect(),
        found.iter().map(|of| of.exponent).collect(),
        found.iter().flat_map(|of| of.indicators).collect(),
    ]))
}

/// Rates of change at states, `(state, component)`.
pub(crate) fn rates(field: &AnyField, method: AnyMethod, states: &[f64]) -> Result<Vec<f64>, Refusal> {
    check_size(field, 0)?;
    Ok(rates::rates(&*field.with(method)?, states, Simd::widest())?)
}

/// Values of functions, `(state, function)`.
pub(crate) fn values(functions: &Functions, states: &[f64]) -> Result<Vec<f64>, Refusal> {
    let (n, n_functions) = (functions.n_components(), functions.n_functions());
    if !states.len().is_multiple_of(n) {
        let wanted = states.len().next_multiple_of(n);
        return Err(Error::Length { name: "states", wanted, got: states.len() }.into());
    }
    let mut values = filled((states.len() / n).saturating_mul(n_functions), 0.0)?;
    let mut work = Vec::new();
    for (state, values) in states.chunks_exact(n).zip(values.chunks_exact_mut(n_functions)) {
        functions.series(state, &mut work, values);
    }
    Ok(values)
}

impl Table {
    pub(crate) fn of(parts: Vec<Vec<f64>>) -> Table {
        Table { parts, dense: None }
    }

    pub(crate) fn part(&self, index: usize) -> &[f64] {
        self.parts.get(index).map_or(&[], Vec::as_slice)
    }
}
