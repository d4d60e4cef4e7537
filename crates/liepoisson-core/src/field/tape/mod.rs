//! Any smooth field: a tape of instructions, run as rules for power series.

mod branch;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
pub(super) mod compiled;
mod convolution;
mod cost;
mod drive;
mod elementary;
mod enclosure;
mod frame;
mod functions;
mod graph;
mod instruction;
mod joint;
mod program;
mod rules;
mod steps;
mod sums;

pub(crate) use cost::OF_A_STEP;
pub use enclosure::{Enclosure, Rounding};
pub use functions::Functions;
pub use instruction::Instruction;

use super::{Bounds, Field, Majorant, Space, Terms};
use crate::error::Error;
use crate::lanes::{Body, Lane, Simd};
use enclosure::enclose;
use frame::Frame;
use graph::Graph;
use instruction::check;
use program::Program;

/// A field given as a list of instructions, with its variational equations.
///
/// Registers `0..n` hold the state, instruction `m` writes register `n + m` and reads earlier ones, and `x_i'` is the
/// register `outputs[i]`. The series of a register follows order by order from those that it reads: that of a product is
/// a sum of products, the other rules come from differential equations such as `z' = z a'` for `z = exp a`. The parts
/// that belong to a tangent vector are the linearised rules, `dz = f'(a) da`, so they are exact up to round-off.
///
/// Construction optimises: constants are folded, equal and unused instructions dropped (even if they would fail, as in
/// `0 log(0)`), linear combinations merged into what reads them, sine and cosine of one argument computed together,
/// whole powers turned into products.
///
/// Where an instruction has no finite value (a pole, the logarithm of zero) or no series (the square root of zero), the
/// series has NaN in every order, so the trajectory ends there. A series would continue a root or a power beyond a zero, on its other
/// branch (`sqrt(x^2)` as `x`, not `|x|`): the trajectory ends before such a zero. A quotient has one branch: where its pole
/// cancels, the solution passes through it.
///
/// ```
/// use liepoisson_core::field::{Instruction, Tape};
/// // the pendulum: q' = p, p' = -sin q
/// let sine = Instruction::Sin(0);
/// let minus = Instruction::Linear { terms: vec![(2, -1.0)], constant: 0.0 };
/// let pendulum = Tape::new(2, vec![sine, minus], vec![1, 3])?;
/// # Ok::<(), liepoisson_core::error::Error>(())
/// ```
///
/// # References
/// Griewank and Walther, *Evaluating Derivatives* (2008), chapter 13: rules for power series.
#[derive(Clone, Debug)]
pub struct Tape {
    n_components: usize,
    instructions: Vec<Instruction>,
    outputs: Vec<usize>,
    program: Program,
    /// The highest order of a zero of what it is made of, exponentials left aside.
    degree: f64,
    /// How many exponentials are multiplied at most.
    n_exponentials: f64,
    size_limits: Vec<f64>,
    #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
    compiled: std::sync::Arc<compiled::Compiled>,
}

impl Tape {
    /// A tape with `n_components` components of the state, and as many outputs.
    ///
    /// # Errors
    /// No component; an instruction that reads a register not yet written, or has a number that is not finite; outputs
    /// that are not one existing register for each component.
    pub fn new(n_components: usize, instructions: Vec<Instruction>, outputs: Vec<usize>) -> Result<Tape, Error> {
        check(n_components, &instructions, &outputs)?;
        if outputs.len() != n_components {
            return Err(Error::Outputs { wanted: n_components, got: outputs.len() });
        }
        let graph = Graph::new(n_components, &instructions, &outputs);
        Ok(Tape {
            n_components,
            instructions,
            outputs,
            program: Program::new(&graph),
            degree: graph.degree(1.0, 0.0),
            n_exponentials: graph.degree(0.0, 1.0),
            size_limits: vec![],
            #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
            compiled: std::sync::Arc::default(),
        })
    }

    /// The same tape with [`Field::size_limits`].
    ///
    /// # Errors
    /// Not one limit, which is not negative, for each component; or none but zero.
    pub fn with_size_limits(mut self, limits: Vec<f64>) -> Result<Tape, Error> {
        let is_one_for_each = limits.len() == self.n_components && limits.iter().all(|&limit| limit >= 0.0);
        if !limits.is_empty() && (!is_one_for_each || limits.iter().all(|&limit| limit == 0.0)) {
            return Err(Error::SizeLimits { wanted: self.n_components, got: limits });
        }
        self.size_limits = limits;
        Ok(self)
    }

    /// What runs have been computed with so far, given the instruction set: its name, or that of code compiled for it.
    pub fn kernel(&self, simd: Simd) -> &'static str {
        #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
        return self.compiled.kernel(simd);
        #[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
        simd.name()
    }

    /// Whether a term that does not show in a series up to `order` where it begins can be large along the step, as a barrier is
    /// that is thin beside it.
    pub(crate) fn has_steep_barriers(&self, order: usize) -> bool {
        self.has_steep_powers(order) || !self.program.exponents.is_empty()
    }

    /// Whether there are such terms that are not exponentials.
    pub(crate) fn has_steep_powers(&self, order: usize) -> bool {
        self.degree > order as f64 / 2.0
    }

    /// How many exponentials are multiplied at most.
    pub(crate) fn n_exponentials(&self) -> f64 {
        self.n_exponentials
    }

    /// The square of how much the arguments of exponentials change along `step` at most, given the series of the state up to `order`:
    /// an argument `a` changes by the sum of `|a_j h^j|` at most, all together by the root of the sum of the squares.
    #[inline(always)]
    pub(crate) fn square_of_changes<V: Lane>(&self, rows: &[V], n_tangents: usize, order: usize, step: V) -> V {
        let row = self.row(n_tangents);
        // the work of the last order is not complete
        let frame = Frame::new(&self.program, rows.len(), row, n_tangents, order - 1);
        let (state, work) = (frame.state(&self.program), &rows[frame.n_orders * row..]);
        let (size, mut squares) = (step.abs(), V::splat(0.0));
        for &series in &self.program.exponents {
            let mut sum = V::splat(0.0);
            for slope in state.series(work, series)[1..order].iter().rev() {
                sum = sum.mul_add(size, slope.abs());
            }
            let change = sum.mul(size);
            squares = change.mul_add(change, squares);
        }
        squares
    }

    /// Whether the field has branches, such as the two values of a root, that a series can pass from one to another.
    pub(crate) fn has_branches(&self) -> bool {
        !self.program.branches.is_empty()
    }

    /// Shortens steps, one for each lane, along which the solution would leave its branch, to zero where it is about to; given its
    /// series up to `order` and the largest steps so far, with their signs, zero for a lane that has made none.
    #[inline(always)]
    pub(crate) fn keep_to_branches<V: Lane>(
        &self,
        rows: &[V],
        n_tangents: usize,
        order: usize,
        largest: &[f64],
        steps: &mut [f64],
    ) {
        let row = self.row(n_tangents);
        // the work of the last order is not complete
        let frame = Frame::new(&self.program, rows.len(), row, n_tangents, order - 1);
        branch::keep(&self.program, &frame, &rows[frame.n_orders * row..], largest, steps);
    }

    /// The largest errors of the rates of change at `state` through round-off and the errors of its components.
    pub(crate) fn round_off(&self, state: &[f64], errors: Option<&[f64]>, to: &mut Terms) {
        to.clear(self.n_components);
        let of_component = |i: usize| (0.0, errors.map_or(0.0, |errors| errors[i]));
        enclose(&self.instructions, state, of_component, f64::EPSILON.into(), &mut to.work);
        for (sum, &output) in to.linear.iter_mut().zip(&self.outputs) {
            *sum = to.work[output].error;
        }
    }
}

impl Space for Tape {
    fn n_components(&self) -> usize {
        self.n_components
    }
}

impl Bounds for Tape {
    fn majorant(&self) -> Option<Majorant> {
        None
    }

    fn terms(&self, state: &[f64], rest: &[f64], to: &mut Terms) {
        to.clear(self.n_components);
        enclose(&self.instructions, state, |i| (rest[i], 0.0), f64::EPSILON.into(), &mut to.work);
        for (sum, &output) in to.linear.iter_mut().zip(&self.outputs) {
            *sum = to.work[output].error / f64::EPSILON;
        }
    }
}

impl Field for Tape {
    fn group(&self) -> usize {
        self.n_components
    }

    fn size_limits(&self) -> &[f64] {
        &self.size_limits
    }

    fn round_off_of_rate(&self, state: &[f64], component: usize) -> f64 {
        let errors: Vec<f64> = state.iter().map(|x| f64::EPSILON * x.abs()).collect();
        let mut terms = Terms::default();
        self.round_off(state, Some(&errors), &mut terms);
        terms.linear[component]
    }

    fn registers(&self, n_tangents: usize, order: usize) -> usize {
        self.row(n_tangents) * (order + 1) + self.program.registers(n_tangents, order + 1)
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        let frame = Frame::new(&self.program, rows.len(), self.row(n_tangents), n_tangents, k);
        let (components, work) = rows.split_at_mut(frame.n_orders * self.row(n_tangents));
        drive::complete_order(&self.program, &frame, &components[k * self.row(n_tangents)..], work);
    }

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        let row = self.row(n_tangents);
        let frame = Frame::new(&self.program, rows.len(), row, n_tangents, k);
        let (components, work) = rows.split_at_mut(frame.n_orders * row);
        drive::write_outputs(&self.program, &frame, &mut components[(k + 1) * row..][..row], work);
    }

    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
        if self.compiled.expand(self, rows, n_tangents, order) {
            return;
        }
        for k in 0..order {
            self.derive_work(rows, n_tangents, k);
            self.extend(rows, n_tangents, k);
        }
    }

    const IS_COMPILED: bool = cfg!(all(target_arch = "x86_64", target_os = "linux"));

    #[cfg(all(target_arch = "x86_64", target_os = "linux"))]
    #[inline(always)]
    fn run_compiled<V: Lane>(&self, code: &impl super::Straight, memory: &mut [V]) -> bool {
        self.compiled.run(self, code, memory)
    }

    #[inline(always)]
    fn rates<V: Lane>(&self, x: &[V], n_tangents: usize, work: &mut [V], rates: &mut [V]) {
        V::outline(Rates { tape: self, x, n_tangents, work, rates });
    }
}

/// The vector field as the expansion up to order 1, which can be compiled.
struct Rates<'a, V> {
    tape: &'a Tape,
    x: &'a [V],
    n_tangents: usize,
    work: &'a mut [V],
    rates: &'a mut [V],
}

impl<V: Lane> Body for Rates<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Rates { tape, x, n_tangents, work, rates } = self;
        let row = x.len();
        work[..row].copy_from_slice(x);
        tape.expand(work, n_tangents, 1);
        rates.copy_from_slice(&work[row..2 * row]);
    }
}
