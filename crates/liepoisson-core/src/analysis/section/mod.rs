//! Surfaces of section: where orbits cross a surface `s(x) = 0`, along their power series.
//!
//! In every step the series of `s` follows from that of the state. Its sign is surveyed piece by piece ([`survey`]), with a
//! bound of what it leaves out ([`remainder`]) and of round-off, so that no pair of crossings within a step is missed.

mod points;
mod remainder;
mod survey;

use super::{UNREACHED, name_unreached};
use crate::ensemble::{Control, Ensemble, Observer, Step, Summary};
use crate::error::Error;
use crate::field::{Enclosure, Field, Functions, Majorant};
use crate::lanes::Simd;
use crate::method::Taylor;
use points::Collected;
pub use points::Points;
use remainder::{Sizes, shifted};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::Duration;
use survey::{Mark, survey};

/// A surface of section.
#[derive(Clone, Debug)]
pub struct Surface {
    /// One function, which is zero on the surface.
    pub function: Functions,
    /// What is kept of every crossing; by default the whole state.
    pub kept: Option<Functions>,
    /// Crossings with this sign of the change of the function, in the order of travel; 0 for both.
    pub direction: i8,
    /// Crossings after which a trajectory ends.
    pub n_crossings: Option<usize>,
}

/// Where less is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Doubts {
    /// Steps in which the error of the state could be estimated only, not bounded.
    pub n_unbounded: u64,
    /// Parts of steps in which the function does not exist, or nothing is known of it however short they are made:
    /// crossings there are not found, and a change of sign across them is none.
    pub n_undefined: u64,
    /// Whether the function stays within its error of zero from the start to the end: the orbit lies in the surface.
    pub is_in_surface: bool,
}

/// Sections of all members of an ensemble: points member by member.
pub struct Sections {
    /// Where they cross: the function has one sign before, beyond its error, and the other afterwards.
    pub crossings: Points,
    /// Number of crossings of each member.
    pub crossing_counts: Vec<usize>,
    /// Where they come within the error of the surface and leave to the side that they came from; whether they crossed in
    /// between is not decided.
    pub touches: Points,
    /// Number of such points of each member.
    pub touch_counts: Vec<usize>,
    /// Of each member.
    pub doubts: Vec<Doubts>,
    /// The end of each member.
    pub summaries: Vec<Summary>,
}

/// Integrates the ensemble and keeps where its members cross a surface; they start at the first of its times and end at
/// the last.
///
/// A pair of crossings of the power series inside a step, however close, is found if the function goes beyond its error
/// between them. That error is the sum of what the series of the function leaves out, which is bounded, of how far the error
/// of the state moves the function, and of an estimate of round-off. The error of the state is bounded for fields of degree
/// two where the bound is sharp, and estimated by the last four terms of its series otherwise ([`Doubts::n_unbounded`]).
/// A member that starts on the surface, within the error, does not cross it there.
///
/// # Errors
/// See [`Ensemble::check`]; functions of another number of components than the field.
pub fn sections<F: Field>(
    ensemble: &Ensemble<'_, F, Taylor>,
    surface: &Surface,
    threads: usize,
    simd: Simd,
    control: &Control,
    watch: impl FnOnce(&dyn Fn(Duration) -> bool),
) -> Result<Sections, Error> {
    let (n, members) = (ensemble.field.n_components(), ensemble.n_members());
    for functions in std::iter::once(&surface.function).chain(&surface.kept) {
        if functions.n_components() != n {
            return Err(Error::Length { name: "variables of the surface", wanted: n, got: functions.n_components() });
        }
    }
    let ended = Mutex::new(Ended {
        crossings: Collected::new(members),
        touches: Collected::new(members),
        doubts: vec![Doubts::default(); members],
        summaries: vec![UNREACHED; members],
    });
    let recorder = |lanes| Recorder {
        shared: &ended,
        surface,
        majorant: ensemble.field.majorant(),
        n,
        seats: vec![Seat::default(); lanes],
        room: Room::default(),
    };
    ensemble.run(threads, simd, control, recorder, watch)?;
    let Ended { crossings, touches, doubts, mut summaries } = ended.into_inner().expect(POISONED);
    name_unreached(&mut summaries, control);
    let width = surface.kept.as_ref().map_or(n, Functions::n_functions);
    let (crossings, crossing_counts) = crossings.arrange(width);
    let (touches, touch_counts) = touches.arrange(width);
    Ok(Sections { crossings, crossing_counts, touches, touch_counts, doubts, summaries })
}

/// What is known of members that have ended.
struct Ended {
    crossings: Collected,
    touches: Collected,
    doubts: Vec<Doubts>,
    summaries: Vec<Summary>,
}

const POISONED: &str = "no worker panics while it writes";

struct Recorder<'s> {
    shared: &'s Mutex<Ended>,
    surface: &'s Surface,
    majorant: Option<Majorant>,
    n: usize,
    seats: Vec<Seat>,
    room: Room,
}

/// Memory that steps share.
#[derive(Default)]
struct Room {
    state: Vec<f64>,
    series: Vec<f64>,
    work: Vec<f64>,
    enclosures: Vec<Enclosure>,
    sizes: Sizes,
    /// How far the series of the state is from the state on the step.
    error_of_state: f64,
}

/// One trajectory under way.
#[derive(Clone, Default)]
struct Seat {
    crossings: Points,
    touches: Points,
    doubts: Doubts,
    /// The last sign of the function that is known, 0 if none is.
    side: i8,
    /// The point nearest to the surface since then, where the sign is not known.
    nearest: Option<Nearest>,
}

#[derive(Clone)]
struct Nearest {
    time: f64,
    /// The size of the function.
    size: f64,
    kept: Vec<f64>,
}

impl Observer for Recorder<'_> {
    fn begin(&mut self, lane: usize, _member: usize) {
        let seat = &mut self.seats[lane];
        (seat.doubts, seat.side, seat.nearest) = (Doubts::default(), 0, None);
    }

    fn step(&mut self, lane: usize, step: &Step<'_>) -> ControlFlow<()> {
        let mut state = std::mem::take(&mut self.room.state);
        state.clear();
        if step.copy_series(&mut state).is_ok() {
            self.room.sizes.measure(&state, self.n, step.size);
            let bound = self.majorant.and_then(|majorant| self.room.sizes.error_of_state(majorant));
            self.room.error_of_state = bound.unwrap_or_else(|| self.room.sizes.last());
            self.seats[lane].doubts.n_unbounded += u64::from(bound.is_none());
            self.look(lane, step, &state, Part { from: 0.0, length: 1.0 }, 0);
        } else {
            self.seats[lane].lose_sight();
        }
        self.room.state = state;
        if self.seats[lane].crossings.signs.len() < self.wanted() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }

    fn end(&mut self, lane: usize, member: usize, summary: Summary) {
        let seat = &mut self.seats[lane];
        if let (Some(nearest), true) = (seat.nearest.take(), seat.side != 0) {
            seat.touches.push(nearest.time, &nearest.kept, seat.side);
        }
        seat.doubts.is_in_surface = seat.side == 0 && seat.doubts.n_undefined == 0 && summary.n_steps > 0;
        let mut shared = self.shared.lock().expect(POISONED);
        shared.crossings.take(member, &mut seat.crossings);
        shared.touches.take(member, &mut seat.touches);
        shared.doubts[member] = seat.doubts;
        shared.summaries[member] = summary;
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

/// The error, in units of the round-off of the sum of the terms, that is small enough not to ask for shorter parts.
const SHARP: f64 = 16.0;

/// What errors of the state may do on a part, in units of what they do at its start, where shorter parts would not help.
const BLUNT: f64 = 8.0;

impl Recorder<'_> {
    fn wanted(&self) -> usize {
        self.surface.n_crossings.unwrap_or(usize::MAX)
    }

    /// Looks for crossings on a part of a step, given the series of the state about its start.
    ///
    /// The step is as long as the series of the state allows; a function with a singularity of its own near the orbit, such as
    /// a pole or the end of a root, or a steep one, has a series that needs shorter parts.
    fn look(&mut self, lane: usize, step: &Step<'_>, state: &[f64], part: Part, halvings: u32) {
        let (surface, n) = (self.surface, self.n);
        self.room.expand(state, step.size * part.length, &surface.function, n);
        if let Some(error) = self.room.error(&state[..n], &surface.function, halvings) {
            let (wanted, seat) = (self.wanted(), &mut self.seats[lane]);
            let series = std::mem::take(&mut self.room.series);
            survey(&series, error, &mut |mark| {
                if seat.crossings.signs.len() < wanted {
                    let keep = &mut |at| self.room.keep(step, surface, n, part.from + at * part.length);
                    seat.note(mark, surface.direction, keep);
                }
            });
            self.room.series = series;
        } else if halvings == MOST_HALVINGS || !self.exists_somewhere(step, part) {
            self.seats[lane].lose_sight();
        } else {
            let half = Part { length: part.length / 2.0, ..part };
            self.look(lane, step, state, half, halvings + 1);
            let middle = shifted(state, n, step.size * half.length);
            self.look(lane, step, &middle, Part { from: part.from + half.length, ..half }, halvings + 1);
        }
    }

    /// Whether the function has a value at one of five places of a part.
    fn exists_somewhere(&mut self, step: &Step<'_>, part: Part) -> bool {
        let (mut state, mut value) = (vec![0.0; self.n], [0.0]);
        (0..5).any(|place| {
            step.state((part.from + 0.25 * f64::from(place) * part.length) * step.size, &mut state);
            self.surface.function.series(&state, &mut self.room.work, &mut value);
            value[0].is_finite()
        })
    }
}

impl Room {
    /// Expands the function along a part of a step, in units of that part.
    fn expand(&mut self, state: &[f64], length: f64, function: &Functions, n: usize) {
        let Room { series, work, sizes, .. } = self;
        series.resize(state.len() / n, 0.0);
        function.series(state, work, series);
        let mut power = 1.0;
        for coefficient in series.iter_mut() {
            *coefficient *= power;
            power *= length;
        }
        sizes.measure(state, n, length);
    }

    /// How far the series is from the function, at most; none where it does not exist, or where shorter parts are better.
    ///
    /// Each coefficient of the state and each operation is right to a few units in the last place of a sum of products, and
    /// so is every shift of the survey.
    fn error(&mut self, start: &[f64], function: &Functions, halvings: u32) -> Option<f64> {
        let Room { series, enclosures, sizes, error_of_state, .. } = self;
        let unit = 2.0 * series.len() as f64 * f64::EPSILON;
        let total: f64 = series.iter().map(|c| c.abs()).sum();
        let [here, along] =
            [0.0, sizes.rest(1.0)].map(|rest| function.enclosure(start, rest, *error_of_state, unit, enclosures).error);
        let left_out = sizes.left_out(start, function, halvings, along, enclosures);
        let error = along + left_out + unit * total;
        let is_sharp = error <= SHARP * unit * total || left_out <= along && along <= BLUNT * here;
        (error.is_finite() && total.is_finite() && (is_sharp || halvings == MOST_HALVINGS)).then_some(error)
    }

    /// What is kept of the point at a fraction `at` of the step.
    fn keep(&mut self, step: &Step<'_>, surface: &Surface, n: usize, at: f64) -> (f64, Vec<f64>) {
        let tau = at * step.size;
        let mut state = vec![0.0; n];
        step.state(tau, &mut state);
        let kept = match &surface.kept {
            None => state,
            Some(kept) => {
                let mut values = vec![0.0; kept.n_functions()];
                kept.series(&state, &mut self.work, &mut values);
                values
            }
        };
        (step.time + tau, kept)
    }
}

impl Seat {
    /// The function does not exist here: what its sign was before says nothing about what comes.
    fn lose_sight(&mut self) {
        self.doubts.n_undefined += 1;
        (self.side, self.nearest) = (0, None);
    }

    /// Draws the conclusion from what is known of the sign at a place of the step.
    fn note(&mut self, mark: Mark, direction: i8, keep: &mut impl FnMut(f64) -> (f64, Vec<f64>)) {
        match mark {
            Mark::Near { at, size } => {
                if self.side != 0 && self.nearest.as_ref().is_none_or(|nearest| size < nearest.size) {
                    let (time, kept) = keep(at);
                    self.nearest = Some(Nearest { time, size, kept });
                }
            }
            Mark::Zero { at, positive } => self.cross(sign(positive), direction, keep(at)),
            Mark::Sign { at, positive } => self.note_sign(sign(positive), direction, || keep(at)),
        }
    }

    /// The function has this sign from a place on that `keep` knows.
    fn note_sign(&mut self, side: i8, direction: i8, keep: impl FnOnce() -> (f64, Vec<f64>)) {
        match self.nearest.take() {
            Some(Nearest { time, kept, .. }) if self.side != side => self.cross(side, direction, (time, kept)),
            Some(Nearest { time, kept, .. }) => self.touches.push(time, &kept, side),
            // between two steps, whose ends differ in round-off
            None if self.side == -side => self.cross(side, direction, keep()),
            None => self.side = side,
        }
    }

    fn cross(&mut self, side: i8, direction: i8, (time, kept): (f64, Vec<f64>)) {
        if direction == 0 || direction == side {
            self.crossings.push(time, &kept, side);
        }
        (self.side, self.nearest) = (side, None);
    }
}

fn sign(positive: bool) -> i8 {
    if positive { 1 } else { -1 }
}
