//! The implicit midpoint rule and the Gauss collocation methods: every quadratic invariant is kept.
//!
//! # References
//! Hairer, Lubich and Wanner, *Geometric Numerical Integration*, 2nd ed. (2006), sections II.1.3, IV.2 (quadratic invariants)
//! and VIII.6 (solution of the implicit equations). Hairer, McLachlan and Razakarivony, *Achieving Brouwer's law with
//! implicit Runge-Kutta methods*, BIT 48 (2008): iteration to round-off, compensated summation.

use crate::error::Error;
use crate::field::Field;
use crate::lanes::{Body, Lane, Wide};
use crate::method::gauss_legendre::{COLLOCATIONS, Collocation};
use crate::method::taylor::{n_measured, size_of_state, sum_of_sizes};
use crate::method::variational::{Sum, Update, Variational, copy_lane, in_chunks, spread};
use crate::method::{AnyMethod, Block, Method, Options, Precision, Series, StepOutcome, Stepping};

const MAX_STAGES: usize = COLLOCATIONS.len();

/// Sweeps after which a step is given up: a contraction by 3/4 has reached round-off before.
const MOST_SWEEPS: usize = 100;

/// Relative change in a sweep below which it may be round-off that hinders it from shrinking further.
const ROUND_OFF: f64 = 1e-12;

/// The method as data: `n_stages` stages, order `2 n_stages`, equal steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauss {
    n_stages: usize,
    step: f64,
    max_steps: u64,
}

impl Gauss {
    /// Collocation at `n_stages` Gauss points (one: the implicit midpoint rule) with equal steps between wanted times, at
    /// most `step` long, and at most `max_steps` of them.
    ///
    /// The equations `k_i = f(x + h sum_j a_ij k_j)` are solved by fixed-point iteration to round-off, for the state and
    /// its tangent vectors together, so that a tangent vector is mapped by the derivative of the step. The iteration
    /// contracts for steps well below the fastest time scale of the field; a trajectory for which it does not ends.
    ///
    /// # Errors
    /// A number of stages outside `1..=4`; a step that is not positive and finite.
    pub fn new(n_stages: usize, step: f64, max_steps: u64) -> Result<Gauss, Error> {
        if !(1..=MAX_STAGES).contains(&n_stages) {
            return Err(Error::Stages { got: n_stages });
        }
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::StepSize { got: step });
        }
        Ok(Gauss { n_stages, step, max_steps })
    }

    /// The method with the options `order`, `step` and `max_steps`.
    pub(crate) fn with_options(options: &Options) -> Result<AnyMethod, Error> {
        let order = options.order()?.unwrap_or(4);
        if order % 2 == 1 {
            return Err(Error::SplittingOrder { got: order });
        }
        Ok(Gauss::new(order / 2, options.step()?, options.max_steps()?)?.into())
    }

    /// Order of the method.
    pub fn order(&self) -> usize {
        2 * self.n_stages
    }
}

impl<F: Field> Method<F> for Gauss {
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        let system = Variational::<F, V>::new(field, n_tangents, true);
        let zeros = |count: usize| vec![V::splat(0.0); count];
        let row = system.row();
        Box::new(GaussBlock {
            step: self.step,
            collocation: &COLLOCATIONS[self.n_stages - 1],
            system,
            rates: zeros(self.n_stages * row),
            other: zeros(self.n_stages * row),
            one: zeros(row),
            fresh: vec![true; V::WIDTH],
            defects: vec![0.0; V::WIDTH],
            lanes: vec![Progress::Settled; V::WIDTH],
        })
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        // two sets of rates; state, start, one stage and what rounding took
        field.registers(n_tangents, 1) + (2 * self.n_stages + 6) * field.row(n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.max_steps
    }
}

/// How far the iteration of one lane is.
#[derive(Clone, Copy, PartialEq)]
enum Progress {
    /// Under way, with the relative change in the last sweep.
    Iterates(f64),
    /// The rates are those of the last sweep.
    Settled,
    /// The rates were put aside while other lanes went on.
    PutAside,
    /// It met numbers that are not finite.
    Failed,
}

impl Progress {
    /// After a sweep with this relative change: it goes on until the change no longer shrinks, at the level of round-off.
    fn next(self, change: f64) -> Progress {
        match self {
            Progress::Iterates(_) if !change.is_finite() => Progress::Failed,
            Progress::Iterates(last) if change == 0.0 || (change >= last && change < ROUND_OFF) => Progress::Settled,
            Progress::Iterates(_) => Progress::Iterates(change),
            ended => ended,
        }
    }
}

/// Trajectories with their tangent vectors and the rates at all stages.
struct GaussBlock<'f, F, V> {
    step: f64,
    collocation: &'static Collocation,
    system: Variational<'f, F, V>,
    /// `k_i` of the last step, then of this one.
    rates: Vec<V>,
    /// Guesses of the rates while they are made, then the rates of lanes that have settled before others.
    other: Vec<V>,
    /// `k_i` of one stage.
    one: Vec<V>,
    fresh: Vec<bool>,
    /// NaN for a lane that started with numbers that are not finite, or whose rates were not.
    defects: Vec<f64>,
    lanes: Vec<Progress>,
}

impl<F: Field, V: Lane> GaussBlock<'_, F, V> {
    /// The rates of a new trajectory are guessed to be constant.
    #[inline(always)]
    fn begin(&mut self) {
        let row = self.system.row();
        self.system.rates(&mut self.one);
        let size = sum_of_sizes(&self.system.state).add(sum_of_sizes(&self.one));
        for lane in 0..V::WIDTH {
            if self.fresh[lane] {
                self.fresh[lane] = false;
                self.defects[lane] = size.get(lane) * 0.0;
                for rates in self.rates.chunks_exact_mut(row) {
                    copy_lane(&self.one, rates, lane);
                }
            }
        }
    }

    /// Continues the collocation polynomial of the last step.
    #[inline(always)]
    fn guess(&mut self) {
        let row = self.system.row();
        for (terms, to) in self.collocation.continuation.iter().zip(self.other.chunks_exact_mut(row)) {
            let (state, step) = (to, V::splat(1.0));
            state.fill(V::splat(0.0));
            in_chunks::<V>(row, &mut Update { state, step, sum: Sum { terms, known: &self.rates, row } });
        }
        std::mem::swap(&mut self.rates, &mut self.other);
    }

    /// Computes the rates at each stage from the newest at the others; adds the changes, each relative to the size of
    /// its group, times the step.
    #[inline(always)]
    fn sweep(&mut self, step: V) -> V {
        let row = self.system.row();
        let mut largest = V::splat(0.0);
        for (i, terms) in self.collocation.stages.iter().enumerate() {
            self.system.rates_beside(step, terms, &self.rates, &mut self.one);
            let rates = &mut self.rates[i * row..(i + 1) * row];
            for (g, group) in self.system.groups().enumerate() {
                let limits = self.system.size_limits(g);
                let size = size_of_state(limits, &self.system.state[group.clone()]);
                let (mut change, n) = (V::splat(0.0), n_measured(limits, group.len()));
                for (i, (old, new)) in rates[group.clone()].iter_mut().zip(&self.one[group]).enumerate() {
                    if i < n {
                        change = change.add(new.sub(*old).abs());
                    }
                    *old = *new;
                }
                // a tangent vector that is zero changes by zero
                let size = size.add(V::splat(f64::MIN_POSITIVE));
                largest = largest.add(change.mul(step.abs()).div(size));
            }
        }
        largest
    }

    /// Solves for the rates; a lane that has settled keeps its own whatever its neighbours need.
    #[inline(always)]
    fn solve(&mut self, step: V) {
        for _ in 0..MOST_SWEEPS {
            let change = self.sweep(step);
            for (lane, progress) in self.lanes.iter_mut().enumerate() {
                *progress = progress.next(change.get(lane));
            }
            if !self.lanes.iter().any(|progress| matches!(progress, Progress::Iterates(_))) {
                break;
            }
            for lane in 0..V::WIDTH {
                if self.lanes[lane] == Progress::Settled {
                    copy_lane(&self.rates, &mut self.other, lane);
                    self.lanes[lane] = Progress::PutAside;
                }
            }
        }
        for lane in 0..V::WIDTH {
            if self.lanes[lane] == Progress::PutAside {
                copy_lane(&self.other, &mut self.rates, lane);
            }
        }
    }
}

impl<F: Field, V: Wide> Block for GaussBlock<'_, F, V> {
    fn n_lanes(&self) -> usize {
        V::WIDTH
    }

    fn stepping(&self) -> Stepping {
        Stepping::Fixed { longest: self.step, most_repeats: 1 }
    }

    fn precision(&self) -> Precision {
        Precision::Double
    }

    fn load(&mut self, lane: usize, _trajectory: usize, group: usize, values: &[f64]) {
        self.system.load(lane, group, values);
        if group == 0 {
            self.fresh[lane] = true;
        }
    }

    fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        self.system.read(lane, group, values);
    }

    fn prepare(&mut self, _ahead: &[f64], longest: &mut [f64]) {
        if self.fresh.iter().any(|&fresh| fresh) {
            V::outline(Begin(self));
        }
        for (longest, defect) in longest.iter_mut().zip(&self.defects) {
            *longest = f64::INFINITY + defect;
        }
    }

    fn advance(&mut self, sizes: &[f64], _repeats: u64, outcomes: &mut [StepOutcome]) {
        V::outline(Advance { block: self, sizes, outcomes });
    }

    fn norms(&self, group: usize, norms: &mut [f64]) {
        self.system.norms(group, norms);
    }

    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32) {
        let (n, row) = (self.system.n_components(), self.system.row());
        Variational::<F, V>::scale(n, &mut self.system.state, row, (lane, group), exponent);
        Variational::<F, V>::scale(n, &mut self.rates, row, (lane, group), exponent);
    }

    fn series(&self) -> Option<&dyn Series> {
        None
    }
}

struct Begin<'b, 'f, F, V>(&'b mut GaussBlock<'f, F, V>);

impl<F: Field, V: Lane> Body for Begin<'_, '_, F, V> {
    #[inline(always)]
    fn run(self) {
        self.0.begin();
    }
}

/// One step of every lane.
struct Advance<'b, 'f, F, V> {
    block: &'b mut GaussBlock<'f, F, V>,
    sizes: &'b [f64],
    outcomes: &'b mut [StepOutcome],
}

impl<F: Field, V: Lane> Body for Advance<'_, '_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Advance { block, sizes, outcomes } = self;
        let step: V = spread(&sizes[..V::WIDTH]);
        block.system.remember();
        for (progress, &size) in block.lanes.iter_mut().zip(sizes) {
            *progress = if size == 0.0 { Progress::Settled } else { Progress::Iterates(f64::INFINITY) };
        }
        block.guess();
        block.solve(step);
        block.system.update(step, block.collocation.weights, &block.rates);
        let size = sum_of_sizes(&block.system.state);
        for lane in 0..V::WIDTH {
            outcomes[lane] = match block.lanes[lane] {
                _ if sizes[lane] == 0.0 => StepOutcome::Taken,
                Progress::Iterates(_) | Progress::Failed => StepOutcome::NoConvergence,
                _ if size.get(lane).is_finite() => StepOutcome::Taken,
                _ => StepOutcome::NotFinite,
            };
            if sizes[lane] == 0.0 || outcomes[lane] != StepOutcome::Taken {
                block.system.restore(lane);
            }
        }
    }
}
