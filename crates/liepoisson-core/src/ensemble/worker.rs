//! The loop: slots are filled, steps are chosen, shown and taken, and trajectories end.

use super::any_ensemble::AnyEnsemble;
use super::control::{Control, ONE};
use super::observer::{Observer, Onward, Step, Stop};
use super::outcome::{Outcome, Summary};
use super::poll_interval::PollInterval;
use super::slot::Slot;
use crate::lanes::Simd;
use crate::method::{Block, Precision, StepOutcome, Stepping};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Samples within one step between two looks at the clock.
const SAMPLES_PER_LOOK: usize = 4096;

/// Advances one block of trajectories, on one thread. What the loop does in each turn and for every observer alike is inlined into
/// it: as calls it was measured to take 2% more instructions where a step is short.
pub(super) struct Worker<'w> {
    pub(super) ensemble: &'w AnyEnsemble<'w>,
    pub(super) queue: &'w AtomicUsize,
    pub(super) control: &'w Control,
}

impl Worker<'_> {
    pub(super) fn work<O: Observer>(&self, simd: Simd, make_observer: &impl Fn(usize) -> O) {
        let ensemble = self.ensemble;
        let mut block = ensemble.integrator.block(simd, ensemble.n_tangents);
        let block = block.as_mut();
        let lanes = block.n_lanes();
        let mut observer = make_observer(lanes);
        let mut slots: Vec<Slot> = (0..lanes).map(|_| Slot::empty(ensemble.n_tangents)).collect();
        let (mut sizes, mut outcomes) = (vec![0.0; lanes], vec![StepOutcome::Taken; lanes]);
        let mut ahead = sizes.clone();
        let (stepping, precision) = (block.stepping(), block.precision());
        let (has_series, most_repeats) = (matches!(stepping, Stepping::Series), stepping.most_repeats());
        let large = libm::scalbn(1.0, precision.range_exponent());
        let mut poll_interval = PollInterval::new();
        self.control.look_at_clock();
        while self.fill_slots(block, &mut slots, &mut observer) {
            if has_series {
                for (ahead, slot) in ahead.iter_mut().zip(&slots) {
                    *ahead = if slot.occupied { slot.until(ensemble.times[ensemble.times.len() - 1]) } else { 0.0 };
                }
            }
            block.prepare(&ahead, &mut sizes);
            if has_series
                && observer.looks_over()
                && let Some(series) = block.series()
            {
                for ((step, slot), &longest) in ahead.iter_mut().zip(&slots).zip(&sizes) {
                    *step = if slot.occupied { self.step_along_series(slot, longest).0 } else { 0.0 };
                }
                observer.look_over(series, &ahead);
            }
            let repeats = self.plan((stepping, precision), &mut slots, poll_interval.repeats);
            for (lane, slot) in slots.iter_mut().enumerate() {
                sizes[lane] = self.decide(block, stepping, lane, slot, (sizes[lane], repeats), &mut observer);
            }
            block.advance(&sizes, repeats, &mut outcomes);
            if !has_series {
                for (lane, slot) in slots.iter_mut().enumerate().filter(|(_, slot)| slot.occupied) {
                    self.conclude(block, lane, slot, (sizes[lane], repeats), outcomes[lane], &mut observer);
                }
            }
            self.rescale_tangents(block, &mut slots, &mut sizes, large);
            for (lane, slot) in slots.iter_mut().enumerate() {
                if slot.occupied && slot.next_sample == ensemble.times.len() {
                    self.lead_on(block, lane, slot, &mut observer);
                }
            }
            if poll_interval.is_time(most_repeats) {
                for slot in slots.iter_mut().filter(|slot| slot.occupied) {
                    self.report(slot, false, observer.passes());
                }
                self.control.look_at_clock();
            }
            if self.control.reason_to_stop().is_some() {
                break;
            }
        }
        let outcome = self.control.reason_to_stop().unwrap_or(Outcome::Cancelled);
        for (lane, slot) in slots.iter_mut().enumerate().filter(|(_, slot)| slot.occupied) {
            self.dismiss(block, lane, slot, outcome, &mut observer);
        }
    }

    /// Gives every empty slot the next trajectory in the queue; false when nobody is left.
    fn fill_slots<O: Observer>(&self, block: &mut dyn Block, slots: &mut [Slot], observer: &mut O) -> bool {
        let ensemble = self.ensemble;
        let (n, n_tangents) = (ensemble.n_components, ensemble.n_tangents);
        let mut any = false;
        for (lane, slot) in slots.iter_mut().enumerate() {
            let may_fill = !slot.occupied && self.control.reason_to_stop().is_none();
            if may_fill && self.queue.load(Ordering::Relaxed) < ensemble.n_trajectories() {
                let trajectory = self.queue.fetch_add(1, Ordering::Relaxed);
                if trajectory < ensemble.n_trajectories() {
                    let tangents = &ensemble.tangents[trajectory * n_tangents * n..][..n_tangents * n];
                    self.begin(block, lane, slot, (trajectory, &ensemble.states[trajectory * n..][..n], tangents));
                    observer.begin(lane, trajectory);
                }
            }
            if may_fill
                && !slot.occupied
                && let Some(start) = observer.resume(lane)
            {
                self.begin(block, lane, slot, start);
            }
            any |= slot.occupied;
        }
        any
    }

    /// Puts a trajectory, from its number, state and tangent vectors, into a lane at the first time.
    fn begin(&self, block: &mut dyn Block, lane: usize, slot: &mut Slot, start: (usize, &[f64], &[f64])) {
        let (trajectory, state, tangents) = start;
        slot.take(trajectory, self.ensemble.times[0]);
        load(block, (lane, trajectory), 0, state, &mut slot.stored);
        for (k, tangent) in tangents.chunks_exact(state.len()).enumerate() {
            slot.scales[k] = load_tangent(block, (lane, trajectory), 1 + k, tangent, &mut slot.stored);
        }
    }

    /// What follows for a trajectory that has reached the last time.
    #[inline(always)]
    fn lead_on<O: Observer>(&self, block: &mut dyn Block, lane: usize, slot: &mut Slot, observer: &mut O) {
        let (passes, n_steps, trajectory) = (observer.passes(), slot.n_steps, slot.trajectory);
        let last = Step { block, lane, time: slot.time, size: 0.0, scales: &slot.scales };
        match observer.onward(lane, n_steps, &last) {
            Onward::Ends => self.dismiss(block, lane, slot, Outcome::Finished, observer),
            Onward::Begins { state, tangents } => {
                self.report(slot, true, passes);
                self.begin(block, lane, slot, (trajectory, state, tangents));
            }
            Onward::Waits => {
                self.report(slot, true, passes);
                self.vacate(block, lane, slot);
            }
        }
    }

    /// Divides the time up to the next wanted one into equal steps, for a method that takes such; how many steps all
    /// slots can take at once, and not more than `most`. A power of two, so that the product with the size is exact.
    #[inline(always)]
    fn plan(&self, (stepping, precision): (Stepping, Precision), slots: &mut [Slot], most: u64) -> u64 {
        let Stepping::Fixed { longest, most_repeats } = stepping else { return 1 };
        let (times, max_steps) = (self.ensemble.times, self.ensemble.max_steps);
        let mut repeats = most_repeats.min(most);
        for slot in slots.iter_mut().filter(|slot| slot.occupied) {
            if slot.steps_left == 0 {
                let end = times[slot.next_sample.max(1)];
                let interval = slot.until(end);
                // a whole number of steps is not one step more, up to the rounding of both times and of what they were made of,
                // and of times that were shifted before
                let of_times = 8.0 * f64::EPSILON * end.abs().max((end - interval).abs());
                let rounding = of_times.max(1e-12 * interval.abs());
                let count = ((interval.abs() - rounding) / longest).ceil().max(1.0);
                (slot.steps_left, slot.equal_step) = (count as u64, precision.nearest(interval / count));
            }
            if slot.careful_steps > 0 {
                repeats = 1;
            }
            repeats = repeats.min(max_steps.saturating_sub(slot.n_steps)).min((slot.steps_left - 1).max(1));
        }
        1 << repeats.max(1).ilog2()
    }

    /// The step of one lane, at most `longest`, which may be taken so many times at once: zero for an empty slot and for a
    /// trajectory that cannot go on, which leaves its slot here, before the block advances, at the last point that was good.
    fn decide<O: Observer>(
        &self,
        block: &mut dyn Block,
        stepping: Stepping,
        lane: usize,
        slot: &mut Slot,
        (longest, repeats): (f64, u64),
        observer: &mut O,
    ) -> f64 {
        if !slot.occupied {
            return 0.0;
        }
        let times = self.ensemble.times;
        let (size, is_last) = match stepping {
            Stepping::Series => self.step_along_series(slot, longest),
            Stepping::Trial => {
                let interval = slot.until(times[slot.next_sample.max(1)]);
                let n_steps = if longest >= interval.abs() { 1.0 } else { 2.0 };
                let lands = n_steps * longest >= interval.abs();
                (if lands { interval / n_steps } else { longest.copysign(interval) }, n_steps == 1.0)
            }
            Stepping::Fixed { .. } if slot.steps_left == 1 => (slot.until(times[slot.next_sample.max(1)]), true),
            Stepping::Fixed { .. } => (slot.equal_step, false),
        };
        if let Some(outcome) = self.obstacle(slot, longest, size, is_last) {
            self.dismiss(block, lane, slot, outcome, observer);
            return 0.0;
        }
        if stepping == Stepping::Series {
            return self.observe_inside(block, lane, slot, (size, is_last), observer);
        }
        if slot.next_sample == 0 {
            let start = Step { block, lane, time: slot.time, size: 0.0, scales: &slot.scales };
            observer.sample(lane, 0, 0.0, &start);
            slot.next_sample = 1;
        }
        debug_assert!(repeats == 1 || !is_last);
        size
    }

    /// The step of a method with series, at most `longest`, and whether it ends at the last time.
    #[inline(always)]
    fn step_along_series(&self, slot: &Slot, longest: f64) -> (f64, bool) {
        let remaining = slot.until(self.ensemble.times[self.ensemble.times.len() - 1]);
        let is_last = longest >= remaining.abs();
        (if is_last { remaining } else { longest.copysign(remaining) }, is_last)
    }

    /// Shows a step with power series to the observer, and the wanted times inside it, and moves the clock.
    fn observe_inside<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        slot: &mut Slot,
        (mut size, mut is_last): (f64, bool),
        observer: &mut O,
    ) -> f64 {
        let times = self.ensemble.times;
        let step = Step { block, lane, time: slot.time, size, scales: &slot.scales };
        let stop = observer.step(lane, &step).break_value();
        if let Some(Stop::Interrupted { after } | Stop::Served { after }) = stop
            && after != size
        {
            (size, is_last) = (after, false);
        }
        let within = |tau: &f64| is_last || tau.abs() <= size.abs();
        while times.get(slot.next_sample).is_some_and(|&time| within(&slot.until(time))) {
            let first = slot.next_sample;
            let mut taus = std::mem::take(&mut slot.taus);
            let ahead = times[first..].iter().map(|&time| slot.until(time));
            taus.clear();
            taus.extend(ahead.take_while(within).take(SAMPLES_PER_LOOK));
            observer.samples(lane, first, &taus, &step);
            let count = taus.len();
            (slot.taus, slot.next_sample) = (taus, first + count);
            if count < SAMPLES_PER_LOOK {
                break;
            }
            if let Some(outcome) = self.control.look_at_clock() {
                self.dismiss(block, lane, slot, outcome, observer);
                return 0.0;
            }
        }
        if is_last {
            (slot.time, slot.time_low) = (times[times.len() - 1], 0.0);
        } else {
            slot.move_clock(size);
        }
        slot.n_steps += 1;
        if matches!(stop, Some(Stop::Served { .. })) {
            slot.next_sample = times.len();
        }
        size
    }

    /// What follows from the outcome of a step of a method without series.
    fn conclude<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        slot: &mut Slot,
        (size, repeats): (f64, u64),
        outcome: StepOutcome,
        observer: &mut O,
    ) {
        match outcome {
            StepOutcome::Taken => {}
            StepOutcome::TooLong => {
                slot.n_refused += 1;
                return;
            }
            StepOutcome::NotFinite | StepOutcome::TooLarge if repeats > 1 => {
                slot.careful_steps = repeats;
                return;
            }
            StepOutcome::NotFinite => return self.dismiss(block, lane, slot, Outcome::NotFinite, observer),
            StepOutcome::NoConvergence => return self.dismiss(block, lane, slot, Outcome::NoConvergence, observer),
            StepOutcome::TooLarge => return self.dismiss(block, lane, slot, Outcome::StepTooLarge, observer),
        }
        let target = self.ensemble.times[slot.next_sample];
        let is_last = size == slot.until(target) && repeats == 1;
        let whole = size * repeats as f64;
        let step = Step { block, lane, time: slot.time, size: whole, scales: &slot.scales };
        let served = matches!(observer.step(lane, &step), ControlFlow::Break(Stop::Served { .. }));
        slot.n_steps += repeats;
        slot.careful_steps = slot.careful_steps.saturating_sub(repeats);
        slot.steps_left = slot.steps_left.saturating_sub(repeats);
        if is_last {
            observer.sample(lane, slot.next_sample, whole, &step);
            (slot.time, slot.time_low, slot.steps_left) = (target, 0.0, 0);
            slot.next_sample += 1;
        } else {
            slot.move_clock(whole);
        }
        if served {
            slot.next_sample = self.ensemble.times.len();
        }
    }

    /// Why a trajectory cannot take the step `size`, if so; `longest` is what the method allows.
    fn obstacle(&self, slot: &Slot, longest: f64, size: f64, is_last: bool) -> Option<Outcome> {
        if longest.is_nan() {
            Some(Outcome::NotFinite)
        } else if !is_last && slot.time + size == slot.time {
            Some(Outcome::StepTooSmall)
        } else if slot.n_steps + slot.n_refused >= self.ensemble.max_steps {
            Some(Outcome::MaxSteps)
        } else {
            None
        }
    }

    /// Takes powers of two out of tangent vectors that are longer than `large` or shorter than its inverse: far from overflow, no
    /// rounding ever.
    #[inline(always)]
    fn rescale_tangents(&self, block: &mut dyn Block, slots: &mut [Slot], norms: &mut [f64], large: f64) {
        let usual = 1.0 / large..large;
        for tangent in 0..self.ensemble.n_tangents {
            block.norms(1 + tangent, norms);
            if norms.iter().fold(true, |all, norm| all & usual.contains(norm)) {
                continue;
            }
            for (lane, slot) in slots.iter_mut().enumerate() {
                let norm = norms[lane];
                if slot.occupied && !usual.contains(&norm) && norm > 0.0 && norm.is_finite() {
                    let exponent = ((norm.to_bits() >> 52) & 0x7ff) as i64 - 1023;
                    block.scale_tangent(lane, 1 + tangent, -exponent as i32);
                    slot.scales[tangent] += exponent;
                }
            }
        }
    }

    /// Hands the end of a trajectory to the observer and empties its slot.
    fn dismiss<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        slot: &mut Slot,
        outcome: Outcome,
        observer: &mut O,
    ) {
        let n = self.ensemble.n_components;
        let mut state = vec![0.0; n];
        block.read(lane, 0, &mut state);
        if !matches!(outcome, Outcome::Cancelled | Outcome::TimeLimit) {
            self.report(slot, true, observer.passes());
        }
        observer.end(lane, slot.trajectory, Summary { outcome, time: slot.time, n_steps: slot.n_steps, state });
        self.vacate(block, lane, slot);
    }

    /// Empties a slot: its lane rests at the origin.
    fn vacate(&self, block: &mut dyn Block, lane: usize, slot: &mut Slot) {
        for group in 0..=self.ensemble.n_tangents {
            block.load(lane, slot.trajectory, group, &vec![0.0; self.ensemble.n_components]);
        }
        slot.occupied = false;
    }

    fn report(&self, slot: &mut Slot, ended: bool, passes: u64) {
        let times = self.ensemble.times;
        let fraction = (slot.time - times[0]) / (times[times.len() - 1] - times[0]);
        let whole = ONE / passes as f64;
        let done = if ended { whole as u64 } else { (fraction * whole) as u64 };
        self.control.done.fetch_add(done - slot.reported, Ordering::Relaxed);
        slot.reported = done;
    }
}

/// Puts values into one group of a lane; those that its numbers cannot hold, since single precision ends at 1e-38, as NaN:
/// a state of 1e-300 would come to rest at the origin and be said to have finished there.
fn load(
    block: &mut dyn Block,
    (lane, trajectory): (usize, usize),
    group: usize,
    values: &[f64],
    stored: &mut Vec<f64>,
) {
    block.load(lane, trajectory, group, values);
    stored.resize(values.len(), 0.0);
    block.read(lane, group, stored);
    if largest(stored) < 0.5 * largest(values) {
        block.load(lane, trajectory, group, &vec![f64::NAN; values.len()]);
    }
}

/// Puts a tangent vector into a lane, less a power of two where it is beyond the range in which the block keeps them: one that is
/// shorter than the numbers of single precision keeps its digits. The exponent of that power.
fn load_tangent(block: &mut dyn Block, at: (usize, usize), group: usize, values: &[f64], stored: &mut Vec<f64>) -> i64 {
    let (_, exponent) = libm::frexp(largest(values));
    if exponent.abs() < block.precision().range_exponent() || !values.iter().all(|value| value.is_finite()) {
        load(block, at, group, values, stored);
        return 0;
    }
    let scaled: Vec<f64> = values.iter().map(|&value| libm::scalbn(value, -exponent)).collect();
    load(block, at, group, &scaled, stored);
    i64::from(exponent)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |size, value| size.max(value.abs()))
}
