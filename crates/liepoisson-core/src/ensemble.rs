//! Many trajectories: threads times lanes, with progress, cancellation, and one outcome per trajectory.

use crate::error::Error;
use crate::field::Space;
use crate::lanes::Simd;
use crate::method::{Block, Method, StepOutcome, Stepping};
use std::collections::TryReserveError;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex};
use std::time::{Duration, Instant};

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
    /// The implicit equation of a step was not solved: the step is too long for it.
    NoConvergence,
    /// The time that the run may take was over before it reached the last time.
    TimeLimit,
}

impl Outcome {
    /// All of them; the position of an outcome is its code in results.
    pub const ALL: [Outcome; 7] = [
        Outcome::Finished,
        Outcome::StepTooSmall,
        Outcome::NotFinite,
        Outcome::MaxSteps,
        Outcome::Cancelled,
        Outcome::NoConvergence,
        Outcome::TimeLimit,
    ];

    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Finished => "finished",
            Outcome::StepTooSmall => "step too small",
            Outcome::NotFinite => "not finite",
            Outcome::MaxSteps => "max steps",
            Outcome::Cancelled => "cancelled",
            Outcome::NoConvergence => "no convergence",
            Outcome::TimeLimit => "time limit",
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

/// Seen by an [`Observer`]: one lane during one accepted step.
///
/// A method with power series shows it before the lane is advanced, and knows the state at any time inside it; the
/// others show it afterwards, and know the state at its end.
pub struct Step<'s> {
    block: &'s dyn Block,
    lane: usize,
    /// Time at the start of the step.
    pub time: f64,
    /// Length of the step, negative when running backwards; equal steps come several at once, with their whole length.
    pub size: f64,
    scales: &'s [i64],
}

impl Step<'_> {
    /// The state a time `tau` after the start of the step.
    pub fn state(&self, tau: f64, values: &mut [f64]) {
        self.block.evaluate(self.lane, 0, tau, values);
    }

    /// Tangent vector `k` (from 0) as `values * 2^scale`; returns `scale`.
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

/// Why an observer ends a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// It has served its purpose, and ends with this step.
    Served,
    /// The run has to stop, and the step was not looked at to its end: the trajectory ends `after` its start, with the reason
    /// that [`Control::reason_to_stop`] gives. For steps with power series, which can be cut anywhere.
    Interrupted {
        /// Length of the part of the step that was looked at.
        after: f64,
    },
}

/// What a worker does with the trajectories that it advances; each worker has its own.
pub trait Observer: Send {
    /// `member` starts in `lane`.
    fn begin(&mut self, lane: usize, member: usize);
    /// A step was accepted. Breaks where the trajectory is to end.
    fn step(&mut self, lane: usize, step: &Step<'_>) -> ControlFlow<Stop> {
        let _ = (lane, step);
        ControlFlow::Continue(())
    }
    /// The step contains time number `index` of the ensemble, `tau` after its start.
    fn sample(&mut self, lane: usize, index: usize, tau: f64, step: &Step<'_>) {
        let _ = (lane, index, tau, step);
    }
    /// `member` has ended.
    fn end(&mut self, lane: usize, member: usize, summary: Summary);
}

/// Progress of a run and the wish to end it; shared with the caller.
#[derive(Default)]
pub struct Control {
    cancelled: AtomicBool,
    deadline: Option<Instant>,
    time_is_up: AtomicBool,
    /// Trajectories done, in units of 2^-32.
    done: AtomicU64,
}

const ONE: f64 = 4_294_967_296.0;

impl Control {
    /// A run that ends by itself after `limit`.
    pub fn with_time_limit(limit: Duration) -> Control {
        Control { deadline: Instant::now().checked_add(limit), ..Control::default() }
    }

    /// The outcome of trajectories that have to stop now, if they have to.
    pub fn reason_to_stop(&self) -> Option<Outcome> {
        if self.cancelled.load(Ordering::Relaxed) {
            Some(Outcome::Cancelled)
        } else if self.time_is_up.load(Ordering::Relaxed) {
            Some(Outcome::TimeLimit)
        } else {
            None
        }
    }

    /// Looks at the clock; cheap, but not cheap enough for every step. What takes long within a step asks for itself.
    pub(crate) fn look_at_clock(&self) -> Option<Outcome> {
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.time_is_up.store(true, Ordering::Relaxed);
        }
        self.reason_to_stop()
    }

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
#[derive(Clone, Copy)]
pub struct Ensemble<'a, F, M> {
    /// The vector field.
    pub field: &'a F,
    /// How it is integrated.
    pub method: M,
    /// States at the first time, member by member.
    pub states: &'a [f64],
    /// Tangent vectors at the first time: member by member, vector by vector.
    pub tangents: &'a [f64],
    /// Tangent vectors per member.
    pub n_tangents: usize,
    /// Start, times of interest, end; strictly monotone in either direction.
    pub times: &'a [f64],
}

impl<F: Space, M: Method<F>> Ensemble<'_, F, M> {
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
            let wanted = n.saturating_mul(self.n_members() + 1);
            return Err(Error::Length { name: "states", wanted, got: self.states.len() });
        }
        let wanted = self.states.len().saturating_mul(self.n_tangents);
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
    /// See [`Ensemble::check`]; no memory for the trajectories under way, no thread.
    ///
    /// # Panics
    /// As a worker does, with its message; the other workers are stopped before.
    pub fn run<O: Observer>(
        &self,
        threads: usize,
        simd: Simd,
        control: &Control,
        observer: impl Fn(usize) -> O + Sync,
        watch: impl FnOnce(&dyn Fn(Duration) -> bool),
    ) -> Result<(), Error> {
        self.check()?;
        if self.n_members() == 0 {
            return Ok(());
        }
        let threads = threads.clamp(1, self.n_members());
        self.reserve(threads, simd)?;
        let (queue, running) = (AtomicUsize::new(0), Running::new(threads));
        let mut panic = None;
        let mut refused = None;
        std::thread::scope(|scope| {
            let mut workers = Vec::new();
            for _ in 0..threads {
                let (queue, observer) = (&queue, &observer);
                let counted = running.guard();
                let work = move || {
                    let _counted = counted;
                    let _cancels = CancelOnPanic(control);
                    Worker { ensemble: self, queue, control }.run(simd, observer);
                };
                // fewer threads than were asked for do the same work
                match std::thread::Builder::new().spawn_scoped(scope, work) {
                    Ok(worker) => workers.push(worker),
                    Err(refusal) => refused = Some(refusal),
                }
            }
            if !workers.is_empty() {
                refused = None;
            }
            watch(&|at_most| running.wait(at_most));
            for worker in workers {
                if let Err(message) = worker.join() {
                    panic = Some(message);
                }
            }
        });
        match (panic, refused) {
            (Some(message), _) => std::panic::resume_unwind(message),
            (None, Some(_)) => Err(Error::Threads { wanted: threads }),
            (None, None) => Ok(()),
        }
    }

    /// Finds out whether there is memory for the trajectories under way: where an allocation fails, Rust ends the process.
    fn reserve(&self, threads: usize, simd: Simd) -> Result<(), Error> {
        let registers = self.method.registers(self.field, self.n_tangents);
        let bytes = registers.saturating_mul(simd.width() * size_of::<f64>()).saturating_mul(threads);
        let mut room = Vec::<u8>::new();
        room.try_reserve_exact(bytes).map_err(|_| Error::Memory { bytes })
    }
}

/// Stops the other workers when the one that holds it panics.
struct CancelOnPanic<'c>(&'c Control);

impl Drop for CancelOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.cancel();
        }
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
    fn guard(&self) -> impl Drop + Send + '_ {
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

/// Turns of the loop between two looks at the clock, and two reports of progress, where turns are short.
const TURNS_PER_REPORT: u64 = 64;

/// How often a worker looks at the clock, and how many equal steps it takes at once: as often and as many as the time that
/// they take allows. It begins carefully, since a step of a large field can take longer than a whole run of a small one.
struct Pace {
    /// Turns between two looks.
    turns: u64,
    /// Turns that are left up to the next look.
    left: u64,
    /// Equal steps in a turn.
    repeats: u64,
    last: Instant,
}

impl Pace {
    /// Between two looks there should be so much time: less costs more looks, more is felt as a delay.
    const SHORT: Duration = Duration::from_millis(25);
    const LONG: Duration = Duration::from_millis(100);

    fn new() -> Pace {
        Pace { turns: 1, left: 1, repeats: 1, last: Instant::now() }
    }

    /// Counts a turn; whether it is time for a look.
    #[inline(always)]
    fn is_time(&mut self, most_repeats: u64) -> bool {
        self.left -= 1;
        if self.left > 0 {
            return false;
        }
        let now = Instant::now();
        let elapsed = now.duration_since(self.last);
        if elapsed < Pace::SHORT {
            // more steps in a turn first: they cost less than more turns
            if self.repeats < most_repeats {
                self.repeats *= 2;
            } else {
                self.turns = (2 * self.turns).min(TURNS_PER_REPORT);
            }
        } else if elapsed > Pace::LONG {
            if self.turns > 1 {
                self.turns /= 2;
            } else {
                self.repeats = (self.repeats / 2).max(1);
            }
        }
        (self.left, self.last) = (self.turns, now);
        true
    }
}

/// Samples within one step between two looks at the clock.
const SAMPLES_PER_LOOK: usize = 4096;

struct Worker<'w, F, M> {
    ensemble: &'w Ensemble<'w, F, M>,
    queue: &'w AtomicUsize,
    control: &'w Control,
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
    n_refused: u64,
    /// Equal steps that are left up to the next wanted time, and their size.
    steps_left: u64,
    equal_step: f64,
    /// Steps to be taken one by one, because several at once have left the finite numbers: a trajectory that fails does so
    /// at its last good step, however many its neighbours allow at once, and tangent vectors are rescaled in between.
    careful_steps: u64,
    /// Exponents of the powers of two taken out of the tangent vectors.
    scales: Vec<i64>,
    reported: u64,
}

impl<F: Space, M: Method<F>> Worker<'_, F, M> {
    fn run<O: Observer>(&self, simd: Simd, make_observer: &impl Fn(usize) -> O) {
        let ensemble = self.ensemble;
        let mut block = ensemble.method.block_for(simd, ensemble.field, ensemble.n_tangents);
        let block = block.as_mut();
        let lanes = block.n_lanes();
        let mut observer = make_observer(lanes);
        let mut seats: Vec<Seat> = (0..lanes).map(|_| Seat::empty(ensemble.n_tangents)).collect();
        let (mut sizes, mut outcomes) = (vec![0.0; lanes], vec![StepOutcome::Taken; lanes]);
        let mut pace = Pace::new();
        self.control.look_at_clock();
        while self.fill_seats(block, &mut seats, &mut observer) {
            block.prepare(&mut sizes);
            let repeats = self.plan(block, &mut seats, pace.repeats);
            for (lane, seat) in seats.iter_mut().enumerate() {
                sizes[lane] = self.decide(block, lane, seat, sizes[lane], repeats, &mut observer);
            }
            block.advance(&sizes, repeats, &mut outcomes);
            if block.stepping() != Stepping::Series {
                for (lane, seat) in seats.iter_mut().enumerate().filter(|(_, seat)| seat.occupied) {
                    self.conclude(block, lane, seat, (sizes[lane], repeats), outcomes[lane], &mut observer);
                }
            }
            self.rescale_tangents(block, &mut seats, &mut sizes);
            for (lane, seat) in seats.iter_mut().enumerate() {
                if seat.occupied && seat.next_sample == ensemble.times.len() {
                    self.dismiss(block, lane, seat, Outcome::Finished, &mut observer);
                }
            }
            if pace.is_time(block.most_repeats()) {
                for seat in seats.iter_mut().filter(|seat| seat.occupied) {
                    self.report(seat, false);
                }
                self.control.look_at_clock();
            }
            if self.control.reason_to_stop().is_some() {
                break;
            }
        }
        let outcome = self.control.reason_to_stop().unwrap_or(Outcome::Cancelled);
        for (lane, seat) in seats.iter_mut().enumerate().filter(|(_, seat)| seat.occupied) {
            self.dismiss(block, lane, seat, outcome, &mut observer);
        }
    }

    /// Gives every empty seat the next member in the queue; false when nobody is left.
    fn fill_seats<O: Observer>(&self, block: &mut dyn Block, seats: &mut [Seat], observer: &mut O) -> bool {
        let ensemble = self.ensemble;
        let (n, n_tangents) = (ensemble.field.n_components(), ensemble.n_tangents);
        let mut any = false;
        for (lane, seat) in seats.iter_mut().enumerate() {
            let may_sit = !seat.occupied && self.control.reason_to_stop().is_none();
            if may_sit && self.queue.load(Ordering::Relaxed) < ensemble.n_members() {
                let member = self.queue.fetch_add(1, Ordering::Relaxed);
                if member < ensemble.n_members() {
                    load(block, lane, 0, &ensemble.states[member * n..][..n]);
                    for k in 0..n_tangents {
                        load(block, lane, 1 + k, &ensemble.tangents[(member * n_tangents + k) * n..][..n]);
                    }
                    seat.take(member, ensemble.times[0]);
                    observer.begin(lane, member);
                }
            }
            any |= seat.occupied;
        }
        any
    }

    /// Divides the time up to the next wanted one into equal steps, for a method that takes such; how many steps all
    /// seats can take at once, and not more than `most`. A power of two, so that the product with the size is exact.
    fn plan(&self, block: &dyn Block, seats: &mut [Seat], most: u64) -> u64 {
        let Stepping::Fixed(longest) = block.stepping() else { return 1 };
        let (times, max_steps) = (self.ensemble.times, self.ensemble.method.max_steps());
        let mut repeats = block.most_repeats().min(most);
        for seat in seats.iter_mut().filter(|seat| seat.occupied) {
            if seat.steps_left == 0 {
                let interval = seat.until(times[seat.next_sample.max(1)]);
                // a whole number of steps up to round-off is not one step more
                let count = (interval.abs() / longest * (1.0 - 1e-12)).ceil().max(1.0);
                (seat.steps_left, seat.equal_step) = (count as u64, block.representable(interval / count));
            }
            if seat.careful_steps > 0 {
                repeats = 1;
            }
            repeats = repeats.min(max_steps.saturating_sub(seat.n_steps)).min((seat.steps_left - 1).max(1));
        }
        1 << repeats.max(1).ilog2()
    }

    /// The step of one lane, at most `longest`: zero for an empty seat and for a trajectory that can not go on, which
    /// leaves its seat here, before the block advances, at the last point that was good.
    fn decide<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        seat: &mut Seat,
        longest: f64,
        repeats: u64,
        observer: &mut O,
    ) -> f64 {
        if !seat.occupied {
            return 0.0;
        }
        let times = self.ensemble.times;
        let end = times[times.len() - 1];
        let (size, is_last) = match block.stepping() {
            Stepping::Series => {
                let remaining = seat.until(end);
                let is_last = longest >= remaining.abs();
                (if is_last { remaining } else { longest.copysign(remaining) }, is_last)
            }
            Stepping::Trial => {
                let interval = seat.until(times[seat.next_sample.max(1)]);
                let n_steps = if longest >= interval.abs() { 1.0 } else { 2.0 };
                let lands = n_steps * longest >= interval.abs();
                (if lands { interval / n_steps } else { longest.copysign(interval) }, n_steps == 1.0)
            }
            Stepping::Fixed(_) if seat.steps_left == 1 => (seat.until(times[seat.next_sample.max(1)]), true),
            Stepping::Fixed(_) => (seat.equal_step, false),
        };
        if let Some(outcome) = self.obstacle(seat, longest, size, is_last) {
            self.dismiss(block, lane, seat, outcome, observer);
            return 0.0;
        }
        if block.stepping() == Stepping::Series {
            return self.observe_inside(block, lane, seat, (size, is_last), observer);
        }
        if seat.next_sample == 0 {
            let start = Step { block, lane, time: seat.time, size: 0.0, scales: &seat.scales };
            observer.sample(lane, 0, 0.0, &start);
            seat.next_sample = 1;
        }
        debug_assert!(repeats == 1 || !is_last);
        size
    }

    /// Shows a step with power series to the observer, and the wanted times inside it, and moves the clock.
    fn observe_inside<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        seat: &mut Seat,
        (mut size, mut is_last): (f64, bool),
        observer: &mut O,
    ) -> f64 {
        let times = self.ensemble.times;
        let step = Step { block, lane, time: seat.time, size, scales: &seat.scales };
        let stop = observer.step(lane, &step).break_value();
        if let Some(Stop::Interrupted { after }) = stop {
            (size, is_last) = (after, false);
        }
        while seat.next_sample < times.len() {
            let tau = seat.until(times[seat.next_sample]);
            if !is_last && tau.abs() > size.abs() {
                break;
            }
            observer.sample(lane, seat.next_sample, tau, &step);
            seat.next_sample += 1;
            if seat.next_sample.is_multiple_of(SAMPLES_PER_LOOK)
                && let Some(outcome) = self.control.look_at_clock()
            {
                self.dismiss(block, lane, seat, outcome, observer);
                return 0.0;
            }
        }
        if is_last {
            (seat.time, seat.time_low) = (times[times.len() - 1], 0.0);
        } else {
            seat.move_clock(size);
        }
        seat.n_steps += 1;
        if stop == Some(Stop::Served) {
            seat.next_sample = times.len();
        }
        size
    }

    /// What follows from the outcome of a step of a method without series.
    fn conclude<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        seat: &mut Seat,
        (size, repeats): (f64, u64),
        outcome: StepOutcome,
        observer: &mut O,
    ) {
        match outcome {
            StepOutcome::Taken => {}
            StepOutcome::TooLong => {
                seat.n_refused += 1;
                return;
            }
            StepOutcome::NotFinite if repeats > 1 => {
                seat.careful_steps = repeats;
                return;
            }
            StepOutcome::NotFinite => return self.dismiss(block, lane, seat, Outcome::NotFinite, observer),
            StepOutcome::NoConvergence => return self.dismiss(block, lane, seat, Outcome::NoConvergence, observer),
        }
        let target = self.ensemble.times[seat.next_sample];
        let is_last = size == seat.until(target) && repeats == 1;
        let whole = size * repeats as f64;
        let step = Step { block, lane, time: seat.time, size: whole, scales: &seat.scales };
        let served = observer.step(lane, &step) == ControlFlow::Break(Stop::Served);
        seat.n_steps += repeats;
        seat.careful_steps = seat.careful_steps.saturating_sub(repeats);
        seat.steps_left = seat.steps_left.saturating_sub(repeats);
        if is_last {
            observer.sample(lane, seat.next_sample, whole, &step);
            (seat.time, seat.time_low, seat.steps_left) = (target, 0.0, 0);
            seat.next_sample += 1;
        } else {
            seat.move_clock(whole);
        }
        if served {
            seat.next_sample = self.ensemble.times.len();
        }
    }

    /// Why a trajectory can not take the step `size`, if so; `longest` is what the method allows.
    fn obstacle(&self, seat: &Seat, longest: f64, size: f64, is_last: bool) -> Option<Outcome> {
        if longest.is_nan() {
            Some(Outcome::NotFinite)
        } else if !is_last && seat.time + size == seat.time {
            Some(Outcome::StepTooSmall)
        } else if seat.n_steps + seat.n_refused >= self.ensemble.method.max_steps() {
            Some(Outcome::MaxSteps)
        } else {
            None
        }
    }

    /// Takes powers of two out of tangent vectors that have grown or shrunk far: far from overflow, no rounding ever.
    fn rescale_tangents(&self, block: &mut dyn Block, seats: &mut [Seat], norms: &mut [f64]) {
        let large = libm::scalbn(1.0, block.range_exponent());
        for tangent in 0..self.ensemble.n_tangents {
            block.norms(1 + tangent, norms);
            for (lane, seat) in seats.iter_mut().enumerate() {
                let norm = norms[lane];
                if seat.occupied && !(1.0 / large..large).contains(&norm) && norm > 0.0 && norm.is_finite() {
                    let exponent = ((norm.to_bits() >> 52) & 0x7ff) as i64 - 1023;
                    block.scale_tangent(lane, 1 + tangent, -exponent as i32);
                    seat.scales[tangent] += exponent;
                }
            }
        }
    }

    /// Hands the end of a trajectory to the observer and empties its seat.
    fn dismiss<O: Observer>(
        &self,
        block: &mut dyn Block,
        lane: usize,
        seat: &mut Seat,
        outcome: Outcome,
        observer: &mut O,
    ) {
        let n = self.ensemble.field.n_components();
        let mut state = vec![0.0; n];
        block.read(lane, 0, &mut state);
        if !matches!(outcome, Outcome::Cancelled | Outcome::TimeLimit) {
            self.report(seat, true);
        }
        observer.end(lane, seat.member, Summary { outcome, time: seat.time, n_steps: seat.n_steps, state });
        for group in 0..=self.ensemble.n_tangents {
            block.load(lane, group, &vec![0.0; n]);
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

/// Puts values into one group of a lane; those that its numbers cannot hold, since single precision ends at 1e-38, as NaN:
/// a state of 1e-300 would come to rest at the origin and be said to have finished there.
fn load(block: &mut dyn Block, lane: usize, group: usize, values: &[f64]) {
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    block.load(lane, group, values);
    let mut held = vec![0.0; values.len()];
    block.read(lane, group, &mut held);
    if size(&held) < 0.5 * size(values) {
        block.load(lane, group, &vec![f64::NAN; values.len()]);
    }
}

impl Seat {
    fn empty(n_tangents: usize) -> Seat {
        Seat {
            member: 0,
            occupied: false,
            time: 0.0,
            time_low: 0.0,
            next_sample: 0,
            n_steps: 0,
            n_refused: 0,
            steps_left: 0,
            equal_step: 0.0,
            careful_steps: 0,
            scales: vec![0; n_tangents],
            reported: 0,
        }
    }

    fn take(&mut self, member: usize, time: f64) {
        (self.member, self.occupied, self.time, self.time_low) = (member, true, time, 0.0);
        (self.next_sample, self.n_steps, self.n_refused, self.steps_left, self.reported) = (0, 0, 0, 0, 0);
        self.careful_steps = 0;
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
