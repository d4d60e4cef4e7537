//! Orthonormal frames of tangent vectors along trajectories, made orthonormal again after each interval of time.
//!
//! Over an interval the tangent flow D takes the frame Q to `D Q = Q' R`, and `ln R_kk` is what direction k has grown. All
//! intervals of a trajectory follow one another in its lane: none waits for its neighbours.
//!
//! # References
//! Benettin, Galgani, Giorgilli and Strelcyn, Meccanica 15 (1980) 9.

use super::frame::Frame;
use super::{POISONED, Rows, filled};
use crate::ensemble::{AnyEnsemble, Control, Observer, Onward, Outcome, Step, Summary, Watch};
use crate::error::Error;
use crate::lanes::Simd;
use std::collections::VecDeque;
use std::sync::Mutex;
use std::time::Duration;

/// Times that each trajectory gives way to another where there are more than lanes: at the end, and where the time for the run
/// is over, all have come about as far.
const TURNS: usize = 32;

/// Most intervals between two such times.
const LONGEST_TURN: usize = 16;

/// What frames are carried along: the ensemble has the states, and as its times the begin and the end of an interval.
#[derive(Clone, Copy)]
pub struct Schedule<'c> {
    /// Orthonormal columns in units of `units`, `(trajectory, component, vector)`.
    pub frames: &'c [f64],
    /// Unit of each component, `(trajectory, component)`.
    pub units: &'c [f64],
    /// Time that each trajectory has already run for.
    pub elapsed: &'c [f64],
    /// Number of intervals.
    pub n_intervals: usize,
    /// So many intervals make up a row of the growth.
    pub per_row: usize,
    /// Whether what is found at each interval is kept.
    pub keep: bool,
}

/// Frames that have been carried along trajectories.
pub struct Carried {
    /// Sums of `ln R_kk` over the intervals of a row, `(trajectory, row, vector)`; NaN in rows that are not complete.
    pub growth: Vec<f64>,
    /// R of each interval, `(trajectory, interval, vector, vector)`, if they were to be kept; NaN for those that are not complete.
    pub triangles: Vec<f64>,
    /// Frames at the ends of the intervals, `(trajectory, interval, component, vector)`, likewise.
    pub kept_frames: Vec<f64>,
    /// States at the ends of the intervals, `(trajectory, interval, component)`, likewise.
    pub kept_states: Vec<f64>,
    /// Frames at the end of the last complete interval, `(trajectory, component, vector)`.
    pub frames: Vec<f64>,
    /// Complete intervals of each trajectory.
    pub n_complete: Vec<usize>,
    /// For each vector the largest ratio in one interval of the greatest `R_jj` to its own, `(trajectory, vector)`.
    pub ratios: Vec<f64>,
    /// Time that each trajectory has run for, states and numbers of steps. One that could not complete an interval ends where
    /// this interval begins, unless the run was stopped.
    pub summaries: Vec<Summary>,
}

/// Carries orthonormal frames along every trajectory of an ensemble, interval after interval.
///
/// The steps are those of a new run for each interval: the same bits. So are those of its start vectors, which the ensemble need
/// not have; it has their number.
///
/// # Errors
/// See [`AnyEnsemble::check`]; arrays of the wrong length; no memory.
pub fn carry<'a>(
    ensemble: impl Into<AnyEnsemble<'a>>,
    schedule: &Schedule<'_>,
    threads: usize,
    simd: Simd,
    control: &Control,
    mut watch: impl FnMut(&dyn Fn(Duration) -> bool),
) -> Result<Carried, Error> {
    carry_along(&ensemble.into(), schedule, threads, simd, control, &mut watch)
}

fn carry_along(
    ensemble: &AnyEnsemble<'_>,
    schedule: &Schedule<'_>,
    threads: usize,
    simd: Simd,
    control: &Control,
    watch: Watch<'_>,
) -> Result<Carried, Error> {
    let (n, k, trajectories) = (ensemble.n_components, ensemble.n_tangents, ensemble.n_trajectories());
    check(ensemble, schedule)?;
    let mut tangents = filled(schedule.frames.len(), 0.0)?;
    for (trajectory, tangents) in tangents.chunks_exact_mut(n * k).enumerate() {
        let (frame, unit) = (&schedule.frames[trajectory * n * k..][..n * k], &schedule.units[trajectory * n..][..n]);
        vectors_of(|i| &frame[i * k..][..k], unit, tangents);
    }
    let ensemble = ensemble.with_tangents(&tangents);
    let intervals = if schedule.keep { trajectories.saturating_mul(schedule.n_intervals) } else { 0 };
    let n_rows = schedule.n_intervals / schedule.per_row;
    let mut growth = filled(trajectories.saturating_mul(n_rows).saturating_mul(k), f64::NAN)?;
    let mut triangles = filled(intervals.saturating_mul(k * k), f64::NAN)?;
    let mut kept_frames = filled(intervals.saturating_mul(n * k), f64::NAN)?;
    let mut kept_states = filled(intervals.saturating_mul(n), f64::NAN)?;
    let mut frames = filled(schedule.frames.len(), 0.0)?;
    frames.copy_from_slice(schedule.frames);
    let shared = Shared {
        waiting: Mutex::new(VecDeque::new()),
        ended: Mutex::new((0..trajectories).map(|trajectory| Ended::before(&ensemble, schedule, trajectory)).collect()),
        growth: Rows::new(&mut growth, trajectories),
        triangles: Rows::new(&mut triangles, trajectories),
        kept_frames: Rows::new(&mut kept_frames, trajectories),
        kept_states: Rows::new(&mut kept_states, trajectories),
        frames: Rows::new(&mut frames, trajectories),
    };
    let observer = |lanes: usize| Carrier {
        shared: &shared,
        schedule,
        ensemble: &ensemble,
        simd,
        turn: match trajectories > lanes.saturating_mul(threads) {
            true => (schedule.n_intervals / TURNS).clamp(1, LONGEST_TURN),
            false => usize::MAX,
        },
        lanes: (0..lanes).map(|_| None).collect(),
        pushed: vec![vec![0.0; n * k]; lanes],
        state: vec![0.0; n],
        frame: Frame::new(n, k),
    };
    ensemble.run(threads, simd, control, observer, watch)?;
    let reason = control.reason_to_stop().unwrap_or(Outcome::Cancelled);
    let mut ended = shared.ended.into_inner().expect(POISONED);
    for waiting in shared.waiting.into_inner().expect(POISONED) {
        let number = waiting.number;
        ended[number] = waiting.ended(reason);
    }
    for ended in ended.iter_mut().filter(|ended| ended.is_unreached) {
        ended.summary.outcome = reason;
    }
    let n_complete = ended.iter().map(|ended| ended.n_complete).collect();
    let ratios = ended.iter().flat_map(|ended| ended.ratios.iter().copied()).collect();
    let summaries = ended.into_iter().map(|ended| ended.summary).collect();
    Ok(Carried { growth, triangles, kept_frames, kept_states, frames, n_complete, ratios, summaries })
}

fn check(ensemble: &AnyEnsemble<'_>, schedule: &Schedule<'_>) -> Result<(), Error> {
    let (n, k, trajectories) = (ensemble.n_components, ensemble.n_tangents, ensemble.n_trajectories());
    if k == 0 || k > n {
        return Err(Error::Length { name: "n_tangents", wanted: n, got: k });
    }
    let lengths = [
        ("frames", trajectories.saturating_mul(n * k), schedule.frames.len()),
        ("units", trajectories * n, schedule.units.len()),
        ("elapsed", trajectories, schedule.elapsed.len()),
    ];
    for (name, wanted, got) in lengths {
        if got != wanted {
            return Err(Error::Length { name, wanted, got });
        }
    }
    if schedule.per_row == 0 || schedule.n_intervals == 0 || !schedule.n_intervals.is_multiple_of(schedule.per_row) {
        return Err(Error::Length { name: "n_intervals", wanted: schedule.per_row, got: schedule.n_intervals });
    }
    // the tangent vectors are made from the frames
    ensemble.with_tangents(schedule.frames).check()
}

/// Tangent vectors, one after the other, from the rows of a frame in units.
fn vectors_of<'f>(row: impl Fn(usize) -> &'f [f64], unit: &[f64], vectors: &mut [f64]) {
    let n = unit.len();
    for (i, &unit) in unit.iter().enumerate() {
        for (j, &x) in row(i).iter().enumerate() {
            vectors[j * n + i] = x * unit;
        }
    }
}

/// What all workers write to.
struct Shared<'s> {
    waiting: Mutex<VecDeque<Box<Trajectory<'s>>>>,
    ended: Mutex<Vec<Ended>>,
    growth: Rows<'s>,
    triangles: Rows<'s>,
    kept_frames: Rows<'s>,
    kept_states: Rows<'s>,
    frames: Rows<'s>,
}

/// The end of a trajectory.
struct Ended {
    n_complete: usize,
    ratios: Vec<f64>,
    summary: Summary,
    is_unreached: bool,
}

impl Ended {
    /// A trajectory that no worker has started.
    fn before(ensemble: &AnyEnsemble<'_>, schedule: &Schedule<'_>, trajectory: usize) -> Ended {
        let state = ensemble.states[trajectory * ensemble.n_components..][..ensemble.n_components].to_vec();
        let summary = Summary { outcome: Outcome::Cancelled, time: schedule.elapsed[trajectory], n_steps: 0, state };
        Ended { n_complete: 0, ratios: vec![1.0; ensemble.n_tangents], summary, is_unreached: true }
    }
}

/// A trajectory under way, as it was at the end of its last complete interval.
struct Trajectory<'s> {
    number: usize,
    state: Vec<f64>,
    tangents: Vec<f64>,
    elapsed: f64,
    n_steps: u64,
    n_complete: usize,
    ratios: Vec<f64>,
    /// Sums over the intervals of the present row.
    grown: Vec<f64>,
    /// Intervals up to the next time that it gives way.
    left: usize,
    growth: &'s mut [f64],
    triangles: &'s mut [f64],
    kept_frames: &'s mut [f64],
    kept_states: &'s mut [f64],
    frame: &'s mut [f64],
}

impl Trajectory<'_> {
    fn ended(self, outcome: Outcome) -> Ended {
        let summary = Summary { outcome, time: self.elapsed, n_steps: self.n_steps, state: self.state };
        Ended { n_complete: self.n_complete, ratios: self.ratios, summary, is_unreached: false }
    }

    /// An interval is complete: its end.
    fn complete(&mut self, state: &[f64], frame: &Frame, schedule: &Schedule<'_>) {
        let (n, k, at) = (state.len(), self.grown.len(), self.n_complete);
        self.state.copy_from_slice(state);
        for (i, row) in self.frame.chunks_exact_mut(k).enumerate() {
            row.copy_from_slice(frame.row(i));
        }
        let unit = &schedule.units[self.number * n..][..n];
        vectors_of(|i| frame.row(i), unit, &mut self.tangents);
        let stretchings = || frame.triangle().iter().step_by(k + 1);
        let largest = stretchings().fold(0.0_f64, |largest, &stretching| largest.max(stretching));
        for ((grown, ratio), &stretching) in self.grown.iter_mut().zip(&mut self.ratios).zip(stretchings()) {
            *grown += libm::log(stretching);
            *ratio = ratio.max(if stretching > 0.0 { largest / stretching } else { f64::INFINITY });
        }
        self.n_complete += 1;
        if self.n_complete.is_multiple_of(schedule.per_row) {
            self.growth[(self.n_complete / schedule.per_row - 1) * k..][..k].copy_from_slice(&self.grown);
            self.grown.fill(0.0);
        }
        if schedule.keep {
            self.triangles[at * k * k..][..k * k].copy_from_slice(frame.triangle());
            self.kept_frames[at * n * k..][..n * k].copy_from_slice(self.frame);
            self.kept_states[at * n..][..n].copy_from_slice(state);
        }
    }
}

struct Carrier<'c, 's> {
    shared: &'c Shared<'s>,
    schedule: &'c Schedule<'c>,
    ensemble: &'c AnyEnsemble<'c>,
    simd: Simd,
    /// Intervals after which a trajectory gives way to another.
    turn: usize,
    lanes: Vec<Option<Box<Trajectory<'s>>>>,
    /// Tangent vectors at the end of an interval, of each lane.
    pushed: Vec<Vec<f64>>,
    /// Room for one lane.
    state: Vec<f64>,
    frame: Frame,
}

impl Carrier<'_, '_> {
    /// The end of an interval becomes the matrix of `frame` and `state`; whether all of it is finite.
    fn take_end(&mut self, lane: usize, unit: &[f64], last: &Step<'_>) -> bool {
        let n = self.state.len();
        last.present_state(&mut self.state);
        let mut are_finite = self.state.iter().all(|x| x.is_finite());
        for (j, vector) in self.pushed[lane].chunks_exact_mut(n).enumerate() {
            if last.keeps_tangents_whole() {
                let scale = last.present_tangent(j, vector);
                scale_by(vector, scale);
            }
            vector.iter_mut().zip(unit).for_each(|(x, unit)| *x /= unit);
            for (i, &x) in vector.iter().enumerate() {
                are_finite &= x.is_finite();
                self.frame.set(i, j, x);
            }
        }
        are_finite
    }
}

/// Multiplies by a power of two.
fn scale_by(vector: &mut [f64], exponent: i64) {
    if exponent != 0 {
        let exponent = exponent.clamp(-5000, 5000) as i32;
        vector.iter_mut().for_each(|x| *x = libm::scalbn(*x, exponent));
    }
}

impl Observer for Carrier<'_, '_> {
    fn begin(&mut self, lane: usize, trajectory: usize) {
        let (n, k, shared) = (self.ensemble.n_components, self.ensemble.n_tangents, self.shared);
        self.lanes[lane] = Some(Box::new(Trajectory {
            number: trajectory,
            state: self.ensemble.states[trajectory * n..][..n].to_vec(),
            tangents: self.ensemble.tangents[trajectory * n * k..][..n * k].to_vec(),
            elapsed: self.schedule.elapsed[trajectory],
            n_steps: 0,
            n_complete: 0,
            ratios: vec![1.0; k],
            grown: vec![0.0; k],
            left: self.turn,
            growth: shared.growth.take(trajectory),
            triangles: shared.triangles.take(trajectory),
            kept_frames: shared.kept_frames.take(trajectory),
            kept_states: shared.kept_states.take(trajectory),
            frame: shared.frames.take(trajectory),
        }));
    }

    fn sample(&mut self, lane: usize, index: usize, tau: f64, step: &Step<'_>) {
        if index == 1 && !step.keeps_tangents_whole() {
            for (j, vector) in self.pushed[lane].chunks_exact_mut(self.state.len()).enumerate() {
                let scale = step.tangent(j, tau, vector);
                scale_by(vector, scale);
            }
        }
    }

    fn passes(&self) -> u64 {
        self.schedule.n_intervals as u64
    }

    fn onward(&mut self, lane: usize, n_steps: u64, last: &Step<'_>) -> Onward<'_> {
        let Some(mut trajectory) = self.lanes[lane].take() else { return Onward::Ends };
        let (schedule, n) = (self.schedule, self.state.len());
        let is_good = self.take_end(lane, &schedule.units[trajectory.number * n..][..n], last);
        if is_good {
            self.frame.orthonormalise(self.simd);
            trajectory.complete(&self.state, &self.frame, schedule);
            trajectory.elapsed += last.time - self.ensemble.times[0];
            trajectory.n_steps += n_steps;
            trajectory.left -= 1;
        }
        let ends = !is_good || trajectory.n_complete == schedule.n_intervals;
        if !ends && trajectory.left == 0 {
            trajectory.left = self.turn;
            self.shared.waiting.lock().expect(POISONED).push_back(trajectory);
            return Onward::Waits;
        }
        let trajectory = self.lanes[lane].insert(trajectory);
        if ends {
            return Onward::Ends;
        }
        Onward::Begins { state: &trajectory.state, tangents: &trajectory.tangents }
    }

    fn resume(&mut self, lane: usize) -> Option<(usize, &[f64], &[f64])> {
        let trajectory = self.shared.waiting.lock().expect(POISONED).pop_front()?;
        let trajectory = self.lanes[lane].insert(trajectory);
        Some((trajectory.number, &trajectory.state, &trajectory.tangents))
    }

    fn end(&mut self, lane: usize, trajectory: usize, summary: Summary) {
        let Some(mut present) = self.lanes[lane].take() else { return };
        if matches!(summary.outcome, Outcome::Cancelled | Outcome::TimeLimit) {
            present.elapsed += summary.time - self.ensemble.times[0];
            present.n_steps += summary.n_steps;
            present.state = summary.state;
        }
        self.shared.ended.lock().expect(POISONED)[trajectory] = present.ended(summary.outcome);
    }
}
