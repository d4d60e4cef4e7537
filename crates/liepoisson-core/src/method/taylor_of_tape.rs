//! The Taylor method of tapes, whose series can hide a term of the field and pass from one branch of it to another.

use crate::field::{Field, Space, Tape};
use crate::lanes::{Body, Wide};
use crate::method::step_end::{StepEnd, look_registers, n_looks, states_at};
use crate::method::taylor::{TaylorBlock, registers_of_sizes};
use crate::method::{Block, Method, Precision, Series, StepOutcome, Stepping, Taylor};

/// A step that is shortened to less than this part of the largest so far, so that no branch is left, is none.
const NO_STEP: f64 = 1e-9;

/// The lowest order that is chosen.
const LEAST_ORDER: usize = 4;

/// The highest one, what the general rule takes at round-off: the law counts with a radius of convergence, and where there is none steps
/// would become so long that large terms cancel, those of a solution that oscillates as `exp(step)`.
const HIGHEST_ORDER: usize = 25;

/// Orders that cost so much more than the cheapest are as good: about it the cost hardly changes, and a lower order takes less memory.
const AS_GOOD: f64 = 1.02;

impl Taylor {
    /// The method for a tape: of the order that a caller chose, or of the one that is cheapest for the tape.
    ///
    /// A series of radius `rho` whose last two terms are within the tolerance allows a step of `rho tolerance^(1/(N-1))`. With `W(N)`
    /// the operations of a step, counted in the tape, the time up to a given moment goes as `W(N) tolerance^(-1/(N-1))`; the cheapest
    /// order is `1 - ln(tolerance)/2` where only sums of products count (Jorba and Zou), more where other operations do. It depends on
    /// the tape and the tolerance alone, so that all processors take the same.
    pub fn for_tape(self, tape: &Tape) -> Taylor {
        if self.has_own_order() {
            return self;
        }
        let of_unit = |order: usize| {
            let work = tape.cost_of_a_step(order, n_looks(tape, order));
            work * libm::exp(-libm::log(self.tolerance()) / (order as f64 - 1.0))
        };
        let least = (LEAST_ORDER..=HIGHEST_ORDER).map(of_unit).fold(f64::INFINITY, f64::min);
        let order = (LEAST_ORDER..=HIGHEST_ORDER).find(|&order| of_unit(order) <= AS_GOOD * least);
        self.with_order(order.unwrap_or(HIGHEST_ORDER))
    }
}

impl Method<Tape> for Taylor {
    fn block<'f, V: Wide>(&self, field: &'f Tape, n_tangents: usize) -> Box<dyn Block + 'f> {
        let method = self.for_tape(field);
        let mut taylor = TaylorBlock::new(method, field, n_tangents);
        taylor.rows.extend(vec![V::splat(0.0); look_registers(field)]);
        Box::new(TapeBlock::<V> {
            taylor,
            end: StepEnd::new(field, method.order(), method.tolerance()),
            steps: vec![0.0; V::WIDTH],
            largest: vec![0.0; if field.has_branches() { V::WIDTH } else { 0 }],
        })
    }

    fn registers(&self, field: &Tape, n_tangents: usize) -> usize {
        let series = field.registers(n_tangents, self.for_tape(field).order());
        series + registers_of_sizes(&field, n_tangents) + look_registers(field)
    }

    fn max_steps(&self) -> u64 {
        Taylor::max_steps(self)
    }
}

/// Trajectories of a tape: their steps end where the series fails the equations, and before the solution leaves its branch.
struct TapeBlock<'f, V> {
    taylor: TaylorBlock<&'f Tape, V>,
    end: StepEnd<V>,
    /// The steps that the longest lead to.
    steps: Vec<f64>,
    /// The largest steps so far, with their signs, zero before the first; empty where the field has no branches.
    largest: Vec<f64>,
}

impl<V: Wide> Block for TapeBlock<'_, V> {
    fn n_lanes(&self) -> usize {
        self.taylor.n_lanes()
    }

    fn stepping(&self) -> Stepping {
        self.taylor.stepping()
    }

    fn precision(&self) -> Precision {
        self.taylor.precision()
    }

    fn load(&mut self, lane: usize, trajectory: usize, group: usize, values: &[f64]) {
        self.taylor.load(lane, trajectory, group, values);
        if let Some(largest) = self.largest.get_mut(lane) {
            *largest = 0.0;
        }
        if group == 0 {
            self.end.forget(lane);
        }
    }

    fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        self.taylor.read(lane, group, values);
    }

    fn prepare(&mut self, ahead: &[f64], longest: &mut [f64]) {
        self.taylor.prepare(ahead, longest);
        let TapeBlock { taylor, end, largest, .. } = self;
        end.limit(longest, |lane| taylor.norm_in(lane, 0, 0) / taylor.norm_in(lane, 1, 0));
        if !largest.is_empty() {
            V::outline(Branches { taylor, largest, steps: longest });
        }
        self.look_ahead(ahead, longest);
    }

    fn advance(&mut self, sizes: &[f64], _repeats: u64, outcomes: &mut [StepOutcome]) {
        outcomes.fill(StepOutcome::Taken);
        // a look may have led to the states already
        let knows_states = self.end.knows_states_after(sizes);
        if !knows_states || self.taylor.n_tangents > 0 {
            self.taylor.sum(sizes, usize::from(knows_states));
        }
        if knows_states {
            let TaylorBlock { field, rows, .. } = &mut self.taylor;
            let at = states_at(field, rows.len());
            let (rows, states) = rows.split_at_mut(at);
            let n = field.n_components();
            rows[..n].copy_from_slice(&states[..n]);
        }
        self.end.take(sizes);
        for (largest, &size) in self.largest.iter_mut().zip(sizes) {
            *largest = if size.abs() > largest.abs() { size } else { *largest };
        }
    }

    fn norms(&self, group: usize, norms: &mut [f64]) {
        self.taylor.norms(group, norms);
    }

    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32) {
        self.taylor.scale_tangent(lane, group, exponent);
    }

    fn series(&self) -> Option<&dyn Series> {
        Some(&self.taylor)
    }
}

impl<V: Wide> TapeBlock<'_, V> {
    /// Shortens the longest steps where the steps that they lead to would end wrongly.
    fn look_ahead(&mut self, ahead: &[f64], longest: &mut [f64]) {
        let TapeBlock { taylor, end, steps, largest } = self;
        for ((step, &longest), &ahead) in steps.iter_mut().zip(&*longest).zip(ahead) {
            let is_open = longest > 0.0 && ahead != 0.0;
            *step = if is_open { longest.min(ahead.abs()).copysign(ahead) } else { 0.0 };
        }
        end.keep_to_the_field(taylor.field, &mut taylor.rows, (taylor.row, taylor.method.order()), steps);
        for (step, largest) in steps.iter_mut().zip(largest) {
            // what is hidden is the corner of a root, where the branch ends, and no barrier
            if step.abs() < NO_STEP * largest.abs() {
                *step = 0.0;
            }
        }
        for ((longest, &ahead), step) in longest.iter_mut().zip(ahead).zip(steps) {
            if *longest > 0.0 && step.abs() < longest.min(ahead.abs()) {
                *longest = step.abs();
            }
        }
    }
}

/// Shortens the steps so that no branch is left.
struct Branches<'b, 'f, V> {
    taylor: &'b TaylorBlock<&'f Tape, V>,
    largest: &'b [f64],
    steps: &'b mut [f64],
}

impl<V: Wide> Body for Branches<'_, '_, V> {
    #[inline(always)]
    fn run(self) {
        let Branches { taylor, largest, steps } = self;
        let order = taylor.method.order();
        let rows = &taylor.rows[..taylor.n_registers];
        taylor.field.keep_to_branches(rows, taylor.n_tangents, order, largest, &mut steps[..V::WIDTH]);
    }
}
