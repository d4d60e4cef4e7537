//! Many trajectories: threads times lanes, with progress, cancellation, and one outcome per trajectory.

use crate::error::Error;
use crate::field::Field;
use crate::lanes::{Lane, Simd, Task, dispatch};
use crate::method::{Block, Taylor};
use std::collections::TryReserveError;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex};
use std::time::Duration;

/// How a trajectory ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It reached the last time.
    Finished,
    /// Its step no longer changes the time.
    StepTooSmall,
    /// Its state, a tangent vector, or their series are not finite.
    NotFinite,
    /// It took as many steps as it may without reaching the last time.
    MaxSteps,
    /// The run was cancelled before it reached the last time.
    Cancelled,
}

impl Outcome {
    /// All of them; the position of an outcome is its code in results.
    pub const ALL: [Outcome; 5] =
        [Outcome::Finished, Outcome::StepTooSmall, Outcome::NotFinite, Outcome::MaxSteps, Outcome::Cancelled];

    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Finished => "finished",
            Outcome::StepTooSmall => "step too small",
            Outcome::NotFinite => "not finite",
            Outcome::MaxSteps => "max steps",
            Outcome::Cancelled => "cancelled",
        }
    }
}

/// The end of one trajectory: the last point that it reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// How it ended.
    pub outcome: Outcome,
    /// Time reached.
    pub time: f64,
    /// Accepted steps.
    pub n_steps: u64,
    /// State at that time.
    pub state: Vec<f64>,
}

/// Seen by an [`Observer`]: one lane during one accepted step, before the lane is advanced.
pub struct Step<'s, F, V> {
    block: &'s Block<'s, F, V>,
    lane: usize,
    /// Time at the start of the step.
    pub time: f64,
    /// Length of the step, negative when running backwards.
    pub size: f64,
    scales: &'s [i64],
}

impl<F: Field, V: Lane> Step<'_, F, V> {
    /// The state a time `tau` after the start of the step.
    #[inline(always)]
    pub fn state(&self, tau: f64, values: &mut [f64]) {
        self.block.evaluate(self.lane, 0, tau, values);
    }

    /// Tangent vector `k` (from 0) as `values * 2^scale`; returns `scale`.
    #[inline(always)]
    pub fn tangent(&self, k: usize, tau: f64, values: &mut [f64]) -> i64 {
        self.block.evaluate(self.lane, 1 + k, tau, values);
        self.scales[k]
    }

    /// Appends the power series of the state about the start of the step.
    ///
    /// # Errors
    /// There is no memory for it.
    pub fn copy_series(&self, to: &mut Vec<f64>) -> Result<(), TryReserveError> {
        self.block.copy_series(self.lane, to)
    }
}

/// What a worker does with the trajectories that it advances; each worker has its own.
pub trait Observer: Send {
    /// `member` starts in `lane`.
    fn begin(&mut self, lane: usize, member: usize);
    /// A step was accepted.
    fn step<F: Field, V: Lane>(&mut self, lane: usize, step: &Step<'_, F, V>);
    /// The step contains time number `index` of the ensemble, `tau` after its start.
    fn sample<F: Field, V: Lane>(&mut self, lane: usize, index: usize, tau: f64, step: &Step<'_, F, V>);
    /// `member` has ended.
    fn end(&mut self, lane: usize, member: usize, summary: Summary);
}

/// Progress of a run and the wish to end it; shared with the caller.
#[derive(Default)]
pub struct Control {
    cancelled: AtomicBool,
    /// Trajectories done, in units of 2^-32.
    done: AtomicU64,
}

const ONE: f64 = 4_294_967_296.0;

impl Control {
    /// Asks the workers to stop soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Number of trajectories done, fractions of running ones included.
    pub fn done(&self) -> f64 {
        self.done.load(Ordering::Relaxed) as f64 / ONE
    }
}

/// What is to be computed: starts, tangent vectors, and the times that matter.
pub struct Ensemble<'a, F> {
    /// The vector field.
    pub field: &'a F,
    /// How it is integrated.
    pub method: Taylor,
    /// States at the first time, member by member.
    pub states: &'a [f64],
    /// Tangent vectors at the first time: member by member, vector by vector.
    pub tangents: &'a [f64],
    /// Tangent vectors per member.
    pub n_tangents: usize,
    /// Start, times of interest, end; strictly monotone in either direction.
    pub times: &'a [f64],
}

impl<F: Field> Ensemble<'_, F> {
    /// Number of trajectories.
    pub fn n_members(&self) -> usize {
        self.states.len() / self.field.n_components()
    }

    /// Checks that the parts fit together.
    ///
    /// # Errors
    /// Times that are not strictly monotone and finite; arrays of the wrong length.
    pub fn check(&self) -> Result<(), Error> {
        let n = self.field.n_components();
        if !self.states.len().is_multiple_of(n) {
            return Err(Error::Length { name: "states", wanted: n * (self.n_members() + 1), got: self.states.len() });
        }
        let wanted = self.states.len() * self.n_tangents;
        if self.tangents.len() != wanted {
            return Err(Error::Length { name: "tangents", wanted, got: self.tangents.len() });
        }
        if self.times.len() < 2 {
            return Err(Error::Times { index: self.times.len() });
        }
        let direction = (self.times[1] - self.times[0]).signum();
        for (index, pair) in self.times.windows(2).enumerate() {
            // written so that a NaN is refused too
            if !(pair[0].is_finite() && pair[1].is_finite() && (pair[1] - pair[0]) * direction > 0.0) {
                return Err(Error::Times { index: index + 1 });
            }
        }
        Ok(())
    }

    /// Integrates every member on `threads` threads.
    ///
    /// The result for a member has the same bits for any number of threads and any instruction set. `observer` makes
    /// the observer of one worker, given the number of its lanes. `watch` runs on the calling thread meanwhile: the
    /// function that it is given waits for the workers, at most so long, and says whether they have all ended.
    ///
    /// # Errors
    /// See [`Ensemble::check`].
    pub fn run<O: Observer>(
        &self,
        threads: usize,
        simd: Simd,
        control: &Control,
        observer: impl Fn(usize) -> O + Sync,
        watch: impl FnOnce(&dyn Fn(Duration) -> bool),
    ) -> Result<(), Error> {
        self.check()?;
        let threads = threads.clamp(1, self.n_members().max(1));
        let (queue, running) = (AtomicUsize::new(0), Running::new(threads));
        std::thread::scope(|scope| {
            for _ in 0..threads {
                let (queue, running, observer) = (&queue, &running, &observer);
                scope.spawn(move || {
                    let _counted = running.guard();
                    dispatch(simd, Worker { ensemble: self, queue, control, observer });
                });
            }
            watch(&|at_most| running.wait(at_most));
        });
        Ok(())
    }
}

/// Workers that have not ended yet.
struct Running {
    count: Mutex<usize>,
    all_ended: Condvar,
}

impl Running {
    fn new(count: usize) -> Running {
        Running { count: Mutex::new(count), all_ended: Condvar::new() }
    }

    /// Counts one worker down when dropped, also when it panics.
    fn guard(&self) -> impl Drop + '_ {
        struct Guard<'r>(&'r Running);
        impl Drop for Guard<'_> {
            fn drop(&mut self) {
                let mut count = self.0.count.lock().expect("nobody panics while counting");
                *count -= 1;
                if *count == 0 {
                    self.0.all_ended.notify_all();
                }
            }
        }
        Guard(self)
    }

    fn wait(&self, at_most: Duration) -> bool {
        let count = self.count.lock().expect("nobody panics while counting");
        let (count, _) = self
            .all_ended
            .wait_timeout_while(count, at_most, |count| *count > 0)
            .expect("nobody panics while counting");
        *count == 0
    }
}

/// Steps between two looks at the flag of cancellation and two reports of progress.
const STEPS_PER_REPORT: usize = 64;

/// Samples within one step between two looks at the flag of cancellation.
const SAMPLES_PER_LOOK: usize = 4096;

struct Worker<'w, F, M> {
    ensemble: &'w Ensemble<'w, F>,
    queue: &'w AtomicUsize,
    control: &'w Control,
    observer: &'w M,
}

/// One trajectory under way.
struct Seat {
    member: usize,
    occupied: bool,
    /// Time as an unevaluated sum, so that a long run does not lose its clock.
    time: f64,
    time_low: f64,
    next_sample: usize,
    n_steps: u64,
    /// Exponents of the powers of two taken out of the tangent vectors.
    scales: Vec<i64>,
    reported: u64,
}

impl<F: Field, O: Observer, M: Fn(usize) -> O + Sync> Task for Worker<'_, F, M> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lane>(self) {
        let ensemble = self.ensemble;
        let mut observer = (self.observer)(V::WIDTH);
        let mut block = Block::<F, V>::new(ensemble.field, ensemble.method, ensemble.n_tangents);
        let mut seats: Vec<Seat> = (0..V::WIDTH).map(|_| Seat::empty(ensemble.n_tangents)).collect();
        let mut sizes = vec![0.0; V::WIDTH];
        let mut steps = 0;
        while self.fill_seats(&mut block, &mut seats, &mut observer) {
            block.expand();
            block.step_sizes(&mut sizes);
            for lane in 0..V::WIDTH {
                sizes[lane] = self.decide(&mut block, lane, &mut seats[lane], sizes[lane], &mut observer);
            }
            let mut step = V::splat(0.0);
            step.as_scalars_mut().copy_from_slice(&sizes);
            block.advance(step);
            self.rescale_tangents(&mut block, &mut seats);
            self.dismiss_finished(&mut block, &mut seats, &mut observer);
            steps += 1;
            if steps % STEPS_PER_REPORT == 0 {
                for seat in seats.iter_mut().filter(|seat| seat.occupied) {
                    self.report(seat, false);
                }
                if self.is_cancelled() {
                    break;
                }
            }
        }
        for (lane, seat) in seats.iter_mut().enumerate().filter(|(_, seat)| seat.occupied) {
            self.dismiss(&mut block, lane, seat, Outcome::Cancelled, &mut observer);
        }
    }
}

impl<F: Field, M> Worker<'_, F, M> {
    fn is_cancelled(&self) -> bool {
        self.control.cancelled.load(Ordering::Relaxed)
    }

    /// Gives every empty seat the next member in the queue; false when nobody is left.
    #[inline(always)]
    fn fill_seats<V: Lane, O: Observer>(&self, block: &mut Block<F, V>, seats: &mut [Seat], observer: &mut O) -> bool {
        let ensemble = self.ensemble;
        let (n, n_tangents) = (ensemble.field.n_components(), ensemble.n_tangents);
        let mut any = false;
        for (lane, seat) in seats.iter_mut().enumerate() {
            if !seat.occupied && !self.is_cancelled() && self.queue.load(Ordering::Relaxed) < ensemble.n_members() {
                let member = self.queue.fetch_add(1, Ordering::Relaxed);
                if member < ensemble.n_members() {
                    for i in 0..n {
                        block.set(lane, 0, i, ensemble.states[member * n + i]);
                    }
                    for k in 0..n_tangents {
                        for i in 0..n {
                            block.set(lane, 1 + k, i, ensemble.tangents[(member * n_tangents + k) * n + i]);
                        }
                    }
                    seat.take(member, ensemble.times[0]);
                    observer.begin(lane, member);
                }
            }
            any |= seat.occupied;
        }
        any
    }

    /// The step of one lane, at most `longest`: zero for an empty seat and for a trajectory that can not go on, which
    /// leaves its seat here, before the block advances, at the last point that was good.
    #[inline(always)]
    fn decide<V: Lane, O: Observer>(
        &self,
        block: &mut Block<F, V>,
        lane: usize,
        seat: &mut Seat,
        longest: f64,
        observer: &mut O,
    ) -> f64 {
        if !seat.occupied {
            return 0.0;
        }
        let times = self.ensemble.times;
        let end = times[times.len() - 1];
        let remaining = seat.until(end);
        let is_last = longest >= remaining.abs();
        let size = if is_last { remaining } else { longest.copysign(remaining) };
        if let Some(outcome) = self.obstacle(seat, longest, size, is_last) {
            self.dismiss(block, lane, seat, outcome, observer);
            return 0.0;
        }
        let step = Step { block, lane, time: seat.time, size, scales: &seat.scales };
        observer.step(lane, &step);
        while seat.next_sample < times.len() {
            let tau = seat.until(times[seat.next_sample]);
            if !is_last && tau.abs() > size.abs() {
                break;
            }
            observer.sample(lane, seat.next_sample, tau, &step);
            seat.next_sample += 1;
            if seat.next_sample.is_multiple_of(SAMPLES_PER_LOOK) && self.is_cancelled() {
                self.dismiss(block, lane, seat, Outcome::Cancelled, observer);
                return 0.0;
            }
        }
        if is_last {
            (seat.time, seat.time_low) = (end, 0.0);
        } else {
            seat.move_clock(size);
        }
        seat.n_steps += 1;
        size
    }

    /// Why a trajectory can not take the step `size`, if so; `longest` is what the method allows.
    #[inline(always)]
    fn obstacle(&self, seat: &Seat, longest: f64, size: f64, is_last: bool) -> Option<Outcome> {
        if longest.is_nan() {
            Some(Outcome::NotFinite)
        } else if !is_last && seat.time + size == seat.time {
            Some(Outcome::StepTooSmall)
        } else if seat.n_steps >= self.ensemble.method.max_steps() {
            Some(Outcome::MaxSteps)
        } else {
            None
        }
    }

    /// Takes powers of two out of tangent vectors that have grown or shrunk far.
    #[inline(always)]
    fn rescale_tangents<V: Lane>(&self, block: &mut Block<F, V>, seats: &mut [Seat]) {
        for tangent in 0..self.ensemble.n_tangents {
            let norms = block.norm(0, 1 + tangent);
            for (lane, seat) in seats.iter_mut().enumerate() {
                let norm = norms.as_scalars()[lane];
                if seat.occupied && !(SMALL..LARGE).contains(&norm) && norm > 0.0 && norm.is_finite() {
                    let exponent = ((norm.to_bits() >> 52) & 0x7ff) as i64 - 1023;
                    block.scale_tangent(lane, 1 + tangent, libm::scalbn(1.0, -exponent as i32));
                    seat.scales[tangent] += exponent;
                }
            }
        }
    }

    #[inline(always)]
    fn dismiss_finished<V: Lane, O: Observer>(&self, block: &mut Block<F, V>, seats: &mut [Seat], observer: &mut O) {
        for (lane, seat) in seats.iter_mut().enumerate() {
            if seat.occupied && seat.next_sample == self.ensemble.times.len() {
                self.dismiss(block, lane, seat, Outcome::Finished, observer);
            }
        }
    }

    /// Hands the end of a trajectory to the observer and empties its seat.
    #[inline(always)]
    fn dismiss<V: Lane, O: Observer>(
        &self,
        block: &mut Block<F, V>,
        lane: usize,
        seat: &mut Seat,
        outcome: Outcome,
        observer: &mut O,
    ) {
        let n = self.ensemble.field.n_components();
        let state = (0..n).map(|i| block.get(lane, 0, i)).collect();
        if outcome != Outcome::Cancelled {
            self.report(seat, true);
        }
        observer.end(lane, seat.member, Summary { outcome, time: seat.time, n_steps: seat.n_steps, state });
        for group in 0..=self.ensemble.n_tangents {
            for i in 0..n {
                block.set(lane, group, i, 0.0);
            }
        }
        seat.occupied = false;
    }

    fn report(&self, seat: &mut Seat, ended: bool) {
        let times = self.ensemble.times;
        let fraction = (seat.time - times[0]) / (times[times.len() - 1] - times[0]);
        let done = if ended { ONE as u64 } else { (fraction * ONE) as u64 };
        self.control.done.fetch_add(done - seat.reported, Ordering::Relaxed);
        seat.reported = done;
    }
}

/// Tangent vectors are kept between these sizes by exact powers of two: far from overflow, and no rounding ever.
const LARGE: f64 = 1.157920892373162e77; // 2^256
const SMALL: f64 = 1.0 / LARGE;

impl Seat {
    fn empty(n_tangents: usize) -> Seat {
        Seat {
            member: 0,
            occupied: false,
            time: 0.0,
            time_low: 0.0,
            next_sample: 0,
            n_steps: 0,
            scales: vec![0; n_tangents],
            reported: 0,
        }
    }

    fn take(&mut self, member: usize, time: f64) {
        (self.member, self.occupied, self.time, self.time_low) = (member, true, time, 0.0);
        (self.next_sample, self.n_steps, self.reported) = (0, 0, 0);
        self.scales.fill(0);
    }

    /// Time from now to `time`.
    #[inline(always)]
    fn until(&self, time: f64) -> f64 {
        (time - self.time) - self.time_low
    }

    /// Adds `size` to the clock; the sum of both parts is exact to twice the working precision.
    #[inline(always)]
    fn move_clock(&mut self, size: f64) {
        let sum = self.time + size;
        let virtual_size = sum - self.time;
        let error = (self.time - (sum - virtual_size)) + (size - virtual_size);
        let low = self.time_low + error;
        self.time = sum + low;
        self.time_low = low - (self.time - sum);
    }
}
