//! Surfaces of section: where orbits cross a surface `s(x) = 0`, along their power series.
//!
//! In every step the series of `s` follows from that of the state. Its sign is surveyed piece by piece ([`survey`]), with a
//! bound of what it leaves out ([`remainder`]) and of round-off, so that no pair of crossings within a step is missed.
//! Where that fails, the time for which it does is kept beside the crossings ([`Uncertified`]).

mod at_once;
mod components;
mod ensemble;
mod points;
mod remainder;
mod slot;
mod survey;
mod workspace;

use super::{POISONED, UNREACHED, filled, name_unreached};
use crate::ensemble::{Control, Observer, Step, Stop, Summary, Watch};
use crate::error::Error;
use crate::field::Functions;
use crate::lanes::{ROUNDINGS, Simd};
use crate::method::{Overview, Series};
pub use ensemble::SectionEnsemble;
use points::Collected;
pub use points::Points;
use remainder::shifted;
use slot::{Lost, Slot};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use survey::{Mark, first_known, is_known, survey};
use workspace::Workspace;

/// A surface of section.
#[derive(Clone, Debug)]
pub struct Surface {
    /// One function, which is zero on the surface.
    pub function: Functions,
    /// What is kept of every crossing; by default the whole state.
    pub kept: Option<Functions>,
    /// One function, which is positive on the surface; by default all zeros belong to it. Of an angle `s` the zeros of `sin s`
    /// with `cos s` positive are those modulo a turn.
    pub guard: Option<Functions>,
    /// Crossings with this sign of the change of the function, in the order of travel; 0 for both.
    pub direction: i8,
    /// Crossings after which a trajectory ends, where the sign of the function after the last one is known: beside it, and
    /// before the next.
    pub n_crossings: Option<usize>,
    /// The sign of the function before the start, trajectory by trajectory, 0 where it is not known; empty if it nowhere is. A
    /// trajectory that starts on the surface crosses it there if the sign afterwards is the other one.
    pub sides: Vec<i8>,
}

impl Surface {
    /// That of the first function, in both directions; if there is a guard, it is the second, and the others are kept.
    pub fn of(functions: Functions, has_guard: bool) -> Surface {
        let (function, others) = functions.split_first();
        let (guard, kept) = match others {
            Some(others) if has_guard => {
                let (guard, kept) = others.split_first();
                (Some(guard), kept)
            }
            others => (None, others),
        };
        Surface { function, kept, guard, direction: 0, n_crossings: None, sides: vec![] }
    }
}

/// Where less is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertified {
    /// Steps in which the error of the state could be estimated only, not bounded.
    pub n_unbounded: u64,
    /// Steps with a part of which nothing is known: crossings there are not found, and a change of sign across it is none.
    pub n_unseen: u64,
    /// Changes of sign, of those that are wanted, across parts where the function has values and could not be followed, if it does
    /// not grow towards them from both sides as beside a pole.
    pub n_lost_changes: u64,
    /// The length of the parts on which the function has no value.
    pub undefined_time: f64,
    /// The length of the parts on which the function has values, but could not be followed: it varies too fast for its error,
    /// or has a singularity nearby.
    pub unresolved_time: f64,
    /// Time up to which there was no such part: that of the first, or the end.
    pub seen_to: f64,
    /// Whether the function stays within its error of zero from the start to the end, and would not on orbits beside this one:
    /// the orbit lies in the surface.
    pub is_in_surface: bool,
}

impl Uncertified {
    /// Of a trajectory before its first step.
    const NONE: Uncertified = Uncertified {
        n_unbounded: 0,
        n_unseen: 0,
        n_lost_changes: 0,
        undefined_time: 0.0,
        unresolved_time: 0.0,
        seen_to: f64::NAN,
        is_in_surface: false,
    };
}

/// Sections of all trajectories of an ensemble: points trajectory by trajectory.
pub struct Sections {
    /// Where they cross: the function has one sign before, beyond its error, and the other afterwards.
    pub crossings: Points,
    /// Number of crossings of each trajectory.
    pub crossing_counts: Vec<usize>,
    /// Where they come within the error of the surface and leave to the side that they came from; whether they crossed in
    /// between is not decided.
    pub touches: Points,
    /// Number of such points of each trajectory.
    pub touch_counts: Vec<usize>,
    /// Of each trajectory.
    pub uncertified: Vec<Uncertified>,
    /// The last sign of the function that was known of each trajectory, 0 if none was or if it was lost since: what to go on with.
    pub sides: Vec<i8>,
    /// The length of the first step of each trajectory; NaN if it took none.
    pub first_steps: Vec<f64>,
    /// The end of each trajectory.
    pub summaries: Vec<Summary>,
}

/// Integrates the ensemble and keeps where its trajectories cross a surface; they start at the first of its times and end at
/// the last.
///
/// A pair of crossings of the power series inside a step, however close, is found if the function goes beyond its error
/// between them. That error is the sum of what the series of the function leaves out, which is bounded, of how far the error
/// of the state moves the function, and of an estimate of round-off. The error of the state is bounded for fields of degree
/// two where the bound is sharp, and estimated by the last four terms of its series otherwise ([`Uncertified::n_unbounded`]).
/// A trajectory that starts on the surface, within the error, does not cross it there, unless it is known where it comes from
/// ([`Surface::sides`]). Where the function cannot be followed
/// nothing is found, and [`Uncertified`] say for how long.
///
/// # Errors
/// See [`AnyEnsemble::check`](crate::ensemble::AnyEnsemble::check); functions of another number of components than the field; a
/// direction that is none, no crossing wanted; no memory for the points.
pub fn sections<'a>(
    ensemble: impl Into<SectionEnsemble<'a>>,
    surface: &Surface,
    threads: usize,
    simd: Simd,
    control: &Control,
    mut watch: impl FnMut(&dyn Fn(Duration) -> bool),
) -> Result<Sections, Error> {
    sections_of(&ensemble.into(), surface, threads, simd, control, &mut watch)
}

fn sections_of(
    ensemble: &SectionEnsemble<'_>,
    surface: &Surface,
    threads: usize,
    simd: Simd,
    control: &Control,
    watch: Watch<'_>,
) -> Result<Sections, Error> {
    let (n, trajectories) = (ensemble.any.n_components, ensemble.n_trajectories());
    for functions in std::iter::once(&surface.function).chain(&surface.kept).chain(&surface.guard) {
        if functions.n_components() != n {
            return Err(Error::Length { name: "variables of the surface", wanted: n, got: functions.n_components() });
        }
    }
    if !(-1..=1).contains(&surface.direction) {
        return Err(Error::Direction { got: surface.direction });
    }
    if surface.n_crossings == Some(0) {
        return Err(Error::NoCrossings);
    }
    ensemble.any.check()?;
    if ![0, trajectories].contains(&surface.sides.len()) {
        return Err(Error::Length { name: "sides", wanted: trajectories, got: surface.sides.len() });
    }
    let refused = AtomicUsize::new(0);
    let ended = Mutex::new(Ended {
        crossings: Collected::new(trajectories)?,
        touches: Collected::new(trajectories)?,
        uncertified: filled(trajectories, Uncertified::NONE)?,
        sides: filled(trajectories, 0)?,
        first_steps: filled(trajectories, f64::NAN)?,
        summaries: filled(trajectories, UNREACHED)?,
    });
    let recorder = |lanes| Recorder {
        shared: &ended,
        control,
        refused: &refused,
        surface,
        ensemble,
        n,
        start: ensemble.any.times[0],
        slots: vec![Slot::default(); lanes],
        workspace: Workspace::default(),
        overview: Overview { form: surface.function.linear_form().unwrap_or_default(), ..Overview::default() },
        is_looked_over: false,
    };
    ensemble.any.run(threads, simd, control, recorder, watch)?;
    match refused.into_inner() {
        0 => {}
        bytes => return Err(Error::Memory { bytes }),
    }
    let Ended { crossings, touches, uncertified, sides, first_steps, mut summaries } =
        ended.into_inner().expect(POISONED);
    name_unreached(&mut summaries, control);
    let width = surface.kept.as_ref().map_or(n, Functions::n_functions);
    let (crossings, crossing_counts) = crossings.arrange(width)?;
    let (touches, touch_counts) = touches.arrange(width)?;
    Ok(Sections { crossings, crossing_counts, touches, touch_counts, uncertified, sides, first_steps, summaries })
}

/// What is known of trajectories that have ended.
struct Ended {
    crossings: Collected,
    touches: Collected,
    uncertified: Vec<Uncertified>,
    sides: Vec<i8>,
    first_steps: Vec<f64>,
    summaries: Vec<Summary>,
}

struct Recorder<'s> {
    shared: &'s Mutex<Ended>,
    control: &'s Control,
    /// Bytes for points that could not be had; the run is then cancelled.
    refused: &'s AtomicUsize,
    surface: &'s Surface,
    ensemble: &'s SectionEnsemble<'s>,
    n: usize,
    /// Time at which trajectories start.
    start: f64,
    slots: Vec<Slot>,
    workspace: Workspace,
    /// What is known of a surface that is linear in the state for all trajectories at once.
    overview: Overview<'s>,
    is_looked_over: bool,
}

impl Observer for Recorder<'_> {
    fn begin(&mut self, lane: usize, trajectory: usize) {
        let side = self.surface.sides.get(trajectory).map_or(0, |side| side.signum());
        self.slots[lane] = Slot::default();
        self.slots[lane].side = side;
    }

    fn looks_over(&self) -> bool {
        self.surface.function.linear_form().is_some()
    }

    fn look_over(&mut self, series: &dyn Series, steps: &[f64]) {
        self.is_looked_over = series.look_over(steps, &mut self.overview);
    }

    fn step(&mut self, lane: usize, step: &Step<'_>) -> ControlFlow<Stop> {
        let mut state = std::mem::take(&mut self.workspace.state);
        state.clear();
        (self.workspace.n_lost, self.workspace.is_blind, self.workspace.n_spare) = (0, false, MOST_SPARE[0]);
        let whole = Part { from: 0.0, length: 1.0 };
        if self.slots[lane].first_step.is_nan() {
            self.slots[lane].first_step = step.size.abs();
        }
        let looked = if self.look_at_once(lane, step, whole) {
            ControlFlow::Continue(())
        } else if step.copy_series(usize::MAX, &mut state).is_ok() {
            let is_bounded = self.workspace.measure(&state, step.size, self.ensemble);
            self.slots[lane].uncertified.n_unbounded += u64::from(!is_bounded);
            self.look(lane, step, &state, whole, 0)
        } else {
            self.lose_sight(lane, step, whole, true);
            ControlFlow::Continue(())
        };
        self.workspace.state = state;
        let slot = &mut self.slots[lane];
        slot.uncertified.n_unseen += u64::from(self.workspace.is_blind);
        if slot.refused > 0 {
            self.refused.store(slot.refused, Ordering::Relaxed);
            self.control.cancel();
        } else if let ControlFlow::Break(after) = looked {
            slot.is_cut = true;
            return ControlFlow::Break(Stop::Interrupted { after: after * step.size });
        }
        if self.slots[lane].refused == 0 && self.slots[lane].crossings.signs.len() < self.wanted() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(Stop::Served { after: self.slots[lane].served_at * step.size })
        }
    }

    fn end(&mut self, lane: usize, trajectory: usize, summary: Summary) {
        let can_tell = !self.slots[lane].had_side && self.can_tell(&summary.state);
        let slot = &mut self.slots[lane];
        slot.leave_the_nearest();
        if !slot.had_side && summary.n_steps > 0 {
            let vanishes = can_tell && slot.uncertified.n_unseen == 0 && !slot.is_cut;
            slot.uncertified.is_in_surface = vanishes && self.workspace.is_guarded(self.surface, &summary.state);
            if !vanishes {
                let time = (summary.time - self.start).abs();
                slot.uncertified.unresolved_time = (time - slot.uncertified.undefined_time).max(0.0);
                slot.uncertified.seen_to = self.start;
            }
        }
        if slot.uncertified.seen_to.is_nan() {
            slot.uncertified.seen_to = summary.time;
        }
        let mut shared = self.shared.lock().expect(POISONED);
        let taken = [
            shared.crossings.take(trajectory, &mut slot.crossings),
            shared.touches.take(trajectory, &mut slot.touches),
        ];
        if let Some(&bytes) =
            taken.iter().find_map(|taken| taken.as_ref().err()).or((slot.refused > 0).then_some(&slot.refused))
        {
            self.refused.store(bytes, Ordering::Relaxed);
            self.control.cancel();
        }
        (shared.uncertified[trajectory], shared.sides[trajectory], shared.first_steps[trajectory]) =
            (slot.uncertified, slot.side, slot.first_step);
        shared.summaries[trajectory] = summary;
    }
}

/// A part of a step, in units of the step.
#[derive(Clone, Copy)]
struct Part {
    from: f64,
    length: f64,
}

/// A part of a step is halved at most so often to make the series of the function converge.
const MOST_HALVINGS: u32 = 14;

/// Some parts are halved more often, beside a place where the function is steep or singular: there are few of them, and they
/// become as short as the spacing of numbers near the length of a step allows.
const MOST_HALVINGS_SPARE: u32 = 48;

/// So many of a step, and of a part of it that was halved [`MOST_HALVINGS`] times. A singularity takes a few for every halving, a
/// function that oscillates along a very long step a few for every turn, and one that varies faster than its error allows all
/// that there are of a part, after which the step gets no more.
const MOST_SPARE: [usize; 2] = [1 << 20, 512];

/// Parts are halved so often at least before the function is said to have no value there: it may have one between the places
/// that are tried.
const LEAST_HALVINGS: u32 = 6;

/// A function that is larger by this factor at the ends of a gap than at a distance of its length grows as beside a pole.
const GROWS: f64 = 1.5;

/// Parts of one step that are given up before the rest of it is not halved any more. A singularity costs a few; a function
/// that varies faster than its error allows costs all parts there are, 16384 in every step, and nothing is found on them.
const MOST_LOST: usize = 256;

/// Distances, in units of the state, at which it is tried whether the function can be told from zero at all.
const BESIDE: [f64; 4] = [-0.3, -0.01, 0.01, 0.3];

impl Recorder<'_> {
    fn wanted(&self) -> usize {
        self.surface.n_crossings.unwrap_or(usize::MAX)
    }

    /// Looks for crossings on a part of a step, given the series of the state about its start. Breaks where the run has to stop,
    /// with the place up to which it has looked.
    ///
    /// The step is as long as the series of the state allows; a function with a singularity of its own near the orbit, such as
    /// a pole or the end of a root, or a steep one, has a series that needs shorter parts.
    fn look(&mut self, lane: usize, step: &Step<'_>, state: &[f64], part: Part, halvings: u32) -> ControlFlow<f64> {
        if self.slots[lane].crossings.signs.len() >= self.wanted() {
            return ControlFlow::Continue(());
        }
        // most steps need no halving, and one part takes no time
        if halvings > 0 && self.control.look_at_clock().is_some() {
            return ControlFlow::Break(part.from);
        }
        let (surface, n) = (self.surface, self.n);
        if halvings == MOST_HALVINGS {
            let mut n_spare = self.workspace.n_spare.min(MOST_SPARE[1]);
            let can_be_followed =
                n_spare > 0 && self.can_be_followed(state, step.size, part.length, halvings, &mut n_spare);
            self.workspace.can_be_followed = can_be_followed;
            // where it is not a single singularity, other parts of the step would cost as much
            self.workspace.n_spare =
                if can_be_followed { self.workspace.n_spare.saturating_sub(MOST_SPARE[1] - n_spare) } else { 0 };
        }
        let has_spare = (MOST_HALVINGS..MOST_HALVINGS_SPARE).contains(&halvings) && self.workspace.can_be_followed;
        let is_last =
            halvings >= MOST_HALVINGS && !has_spare || halvings <= MOST_HALVINGS && self.workspace.n_lost >= MOST_LOST;
        // the whole step is measured already
        if halvings > 0 {
            self.workspace.measure_part(state, step.size * part.length, n);
        }
        self.workspace.expand(state, step.size * part.length, &surface.function, n);
        let mut exists = true;
        if let Some(error) = self.workspace.error(&state[..n], &surface.function, halvings, is_last) {
            let vanishes = self.workspace.vanishes(&state[..n], &surface.function, error.size);
            let is_seen = vanishes.is_none() && (error.is_sharp || is_known(&self.workspace.series, error.size));
            if is_seen {
                self.survey_part(lane, step, part, error.size);
                return ControlFlow::Continue(());
            }
            if vanishes == Some(true) || is_last {
                self.lose_sight(lane, step, part, true);
                return ControlFlow::Continue(());
            }
        } else {
            exists = self.exists_somewhere(step, part);
        }
        if is_last || !exists && halvings >= LEAST_HALVINGS {
            let exists = exists || self.leaves_the_range(step, part);
            self.lose_sight(lane, step, part, exists);
            return ControlFlow::Continue(());
        }
        let (n_lost, half) = (self.workspace.n_lost, Part { length: part.length / 2.0, ..part });
        self.look(lane, step, state, half, halvings + 1)?;
        let middle = shifted(state, n, step.size * half.length);
        let looked = self.look(lane, step, &middle, Part { from: part.from + half.length, ..half }, halvings + 1);
        if halvings >= MOST_HALVINGS {
            self.workspace.n_lost = self.workspace.n_lost.min(n_lost + 1); // one singularity
        }
        looked
    }

    /// Whether no more than so many parts of a part are needed to follow the function on all of it, but for gaps of the least length.
    ///
    /// Otherwise none is made: where crossings of a fast function are found on some parts only, which ones depends on the step.
    fn can_be_followed(&mut self, state: &[f64], size: f64, length: f64, halvings: u32, n_parts: &mut usize) -> bool {
        if *n_parts == 0 || self.control.look_at_clock().is_some() {
            return false;
        }
        *n_parts -= 1;
        if halvings == MOST_HALVINGS_SPARE {
            return true;
        }
        let (function, n) = (&self.surface.function, self.n);
        self.workspace.measure_part(state, size * length, n);
        self.workspace.expand(state, size * length, function, n);
        if let Some(error) = self.workspace.error(&state[..n], function, halvings, false)
            && self.workspace.vanishes(&state[..n], function, error.size) != Some(false)
        {
            return true;
        }
        let half = length / 2.0;
        self.can_be_followed(state, size, half, halvings + 1, n_parts)
            && self.can_be_followed(&shifted(state, n, size * half), size, half, halvings + 1, n_parts)
    }

    /// Notes what the series of the function, known up to an error, says of its sign on a part of a step.
    fn survey_part(&mut self, lane: usize, step: &Step<'_>, part: Part, error: f64) {
        let series = std::mem::take(&mut self.workspace.series);
        self.slots[lane].forget_refuted_side(series[0], error);
        survey(&series, error, &mut |mark| self.note(lane, step, part, mark, |mark| first_known(&series, error, mark)));
        self.workspace.series = series;
        self.count_lost_change(lane, step, part);
    }

    /// Draws the conclusion from what is known of the sign at a place of a part, and, by `known_from`, from where on it is.
    fn note(&mut self, lane: usize, step: &Step<'_>, part: Part, mark: Mark, known_from: impl FnOnce(Mark) -> f64) {
        let (wanted, surface, n, slot) = (self.wanted(), self.surface, self.n, &mut self.slots[lane]);
        if slot.crossings.signs.len() < wanted {
            let keep = &mut |at| self.workspace.keep(step, surface, n, part.from + at * part.length);
            slot.note(mark, surface.direction, keep);
            if slot.crossings.signs.len() == wanted {
                slot.served_at = part.from + known_from(mark) * part.length;
            }
        }
    }

    /// Counts a change of sign across a gap that ends with this part, unless there is a pole in it.
    fn count_lost_change(&mut self, lane: usize, step: &Step<'_>, part: Part) {
        if let Some(lost) = self.slots[lane].regained.take()
            && !self.is_pole(step, lost.time, part.from * step.size)
        {
            self.slots[lane].uncertified.n_lost_changes += 1;
        }
    }

    /// Whether the function grows towards a gap from both sides as beside a pole: a simple one is in it if the function is at least
    /// twice as large at its ends as at a distance of its length. The gap is from a time to a place of the step.
    fn is_pole(&mut self, step: &Step<'_>, from: f64, to: f64) -> bool {
        let (start, resolved) = (from - step.time, f64::EPSILON * from.abs().max(step.size.abs()));
        let length = (to - start).abs().max(64.0 * resolved).copysign(step.size);
        if length.abs() > 0.1 * step.size.abs() {
            return false;
        }
        let (mut state, mut value) = (vec![0.0; self.n], [0.0]);
        let mut size = |tau: f64| {
            step.state(tau, &mut state);
            self.surface.function.series(&state, &mut self.workspace.work, &mut value);
            value[0].abs()
        };
        size(start) > GROWS * size(start - length) && size(to) > GROWS * size(to + length)
    }

    /// Nothing is known of the function here: what its sign was before says nothing about what comes.
    fn lose_sight(&mut self, lane: usize, step: &Step<'_>, part: Part, exists: bool) {
        self.workspace.n_lost += usize::from(exists);
        self.workspace.is_blind = true;
        let slot = &mut self.slots[lane];
        slot.leave_the_nearest();
        slot.lost = match slot.lost.take() {
            _ if !exists => None,
            Some(lost) => Some(lost),
            None => (slot.side != 0).then_some(Lost { side: slot.side, time: step.time + part.from * step.size }),
        };
        slot.side = 0;
        let time = (part.length * step.size).abs();
        if exists {
            slot.uncertified.unresolved_time += time;
            if slot.uncertified.seen_to.is_nan() {
                slot.uncertified.seen_to = step.time + part.from * step.size;
            }
        } else {
            slot.uncertified.undefined_time += time;
        }
    }

    /// Whether the function has a value at one of five places of a part.
    fn exists_somewhere(&mut self, step: &Step<'_>, part: Part) -> bool {
        let (mut state, mut value) = (vec![0.0; self.n], [0.0]);
        (0..5).any(|place| {
            step.state((part.from + 0.25 * f64::from(place) * part.length) * step.size, &mut state);
            self.surface.function.series(&state, &mut self.workspace.work, &mut value);
            value[0].is_finite()
        })
    }

    /// Whether a number of the function is beyond the largest in the middle of a part, so that it may have a value there.
    fn leaves_the_range(&mut self, step: &Step<'_>, part: Part) -> bool {
        let mut state = vec![0.0; self.n];
        step.state((part.from + 0.5 * part.length) * step.size, &mut state);
        let numbers = &mut self.workspace.enclosures;
        self.surface.function.enclosure(&state, 0.0, 0.0, 0.0, numbers);
        numbers.iter().any(|number| number.value.is_infinite())
    }

    /// Whether the function is beyond its error of zero somewhere beside this state. Where it never is, since it vanishes
    /// below the smallest numbers or its error is larger than itself, an orbit on which it is not cannot be said to lie in
    /// the surface.
    fn can_tell(&mut self, state: &[f64]) -> bool {
        let size = state.iter().fold(0.0_f64, |size, component| size.max(component.abs()));
        let (size, unit) = (if size > 0.0 { size } else { 1.0 }, 16.0 * ROUNDINGS * f64::EPSILON);
        let mut beside = state.to_vec();
        (0..state.len()).any(|i| {
            let found = BESIDE.iter().any(|distance| {
                beside[i] = state[i] + distance * size;
                let work = &mut self.workspace.enclosures;
                let found = self.surface.function.enclosure(&beside, 0.0, unit * size, unit, work);
                found.value.abs() > found.error
            });
            beside[i] = state[i];
            found
        })
    }
}
