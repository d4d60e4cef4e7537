//! The Runge-Kutta method of order 8 of Dormand and Prince, with adaptive or fixed steps.
//!
//! # References
//! Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. (1993), sections II.4 (choice of the
//! step), II.5 and II.10 (the method, known as DOP853).

use crate::error::Error;
use crate::field::{Field, SinglePrecision, Straight};
use crate::lanes::{Body, Lane, Number, Wide};
use crate::method::dop853::{ERROR_OF_ORDER_3, ERROR_OF_ORDER_5, STAGES, WEIGHTS};
use crate::method::estimates::{exp2_estimate, log2_estimate};
use crate::method::momentum_of_time::momentum_of_time;
use crate::method::taylor::{n_measured, size_of_state, sum_of_sizes};
use crate::method::variational::{Chunk, Sum, Variational, in_chunks, spread};
use crate::method::{AnyMethod, Block, Method, Options, Precision, Series, Single, StepOutcome, Stepping};

const ORDER: f64 = 8.0;

/// Equal steps that are taken at once: what a turn of the ensemble costs is then small beside them.
const MOST_REPEATS: u64 = 64;

/// The smallest tolerance in single precision, 16 units of round-off: below it the estimated error is that of rounding.
const SINGLE_TOLERANCE: f64 = 1.0 / 1_048_576.0;

/// The method as data: twelve stages, order 8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RungeKutta {
    steps: Steps,
    compensated: bool,
    max_steps: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Steps {
    Adaptive { tolerance: f64 },
    Fixed { step: f64 },
}

impl RungeKutta {
    /// A method whose estimated error of each step is at most `tolerance` times the size of the state (sum of the
    /// absolute values of its components), and the same for every tangent vector; a trajectory may take at most
    /// `max_steps` steps, those that were refused included.
    ///
    /// # Errors
    /// Tolerance outside `[2^-53, 0.1]`.
    pub fn new(tolerance: f64, max_steps: u64) -> Result<RungeKutta, Error> {
        if !(f64::EPSILON / 2.0..=0.1).contains(&tolerance) {
            return Err(Error::Tolerance { got: tolerance });
        }
        Ok(RungeKutta { steps: Steps::Adaptive { tolerance }, compensated: false, max_steps })
    }

    /// The method with the options `tol` or `step`, `precision` ("single"), `compensated` and `max_steps`.
    pub(crate) fn with_options(options: &Options) -> Result<AnyMethod, Error> {
        let max_steps = options.max_steps()?;
        let method = match options.number("step")? {
            Some(step) => RungeKutta::fixed(step, max_steps)?,
            None => RungeKutta::new(options.number("tol")?.unwrap_or(1e-8), max_steps)?,
        };
        if options.says("precision", "single") {
            return Ok(Single::<RungeKutta>::new(method)?.into());
        }
        Ok(if options.says("compensated", "yes") { method.compensated() } else { method }.into())
    }

    /// The method with equal steps between wanted times, at most `step` long.
    ///
    /// A trajectory whose numbers leave the finite ones ends with the last time before that at which its ensemble took
    /// stock, up to 64 steps earlier.
    ///
    /// # Errors
    /// A step that is not positive and finite.
    pub fn fixed(step: f64, max_steps: u64) -> Result<RungeKutta, Error> {
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::StepSize { got: step });
        }
        Ok(RungeKutta { steps: Steps::Fixed { step }, compensated: false, max_steps })
    }

    /// The same method with compensated summation of the state: what rounding takes from each step is added to the next.
    /// For many short steps, where rounding and not the method limits the accuracy.
    pub fn compensated(self) -> RungeKutta {
        RungeKutta { compensated: true, ..self }
    }

    /// Order of the method.
    pub fn order(&self) -> usize {
        8
    }

    /// Relative size of the estimated error of a step, if steps are adaptive.
    pub fn tolerance(&self) -> Option<f64> {
        match self.steps {
            Steps::Adaptive { tolerance } => Some(tolerance),
            Steps::Fixed { .. } => None,
        }
    }
}

impl Single<RungeKutta> {
    /// The method in single precision.
    ///
    /// # Errors
    /// A tolerance below `2^-20`: it would ask for less than the round-off of single precision.
    pub fn new(method: RungeKutta) -> Result<Self, Error> {
        match method.tolerance() {
            Some(got) if got < SINGLE_TOLERANCE => Err(Error::SingleTolerance { got }),
            _ => Ok(Single(method)),
        }
    }
}

impl<F: Field> Method<F> for RungeKutta {
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        Box::new(RungeKuttaBlock::<F, V>::new(*self, field, n_tangents))
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        // the rates of all stages; state, start, one stage and what rounding took
        field.registers(n_tangents, 1) + (STAGES.len() + 6) * field.row(n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.max_steps
    }
}

impl<F: Field + SinglePrecision> Method<F> for Single<RungeKutta> {
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        let mut method = self.0;
        if let Steps::Adaptive { tolerance } = &mut method.steps {
            *tolerance = tolerance.max(SINGLE_TOLERANCE);
        }
        Box::new(RungeKuttaBlock::<F, V::Narrow>::new(method, field, n_tangents))
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        self.0.registers(field, n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.0.max_steps
    }
}

/// What one lane knows about its steps.
#[derive(Clone, Copy)]
struct Control {
    /// Its trajectory has not been looked at.
    fresh: bool,
    /// Its last step was refused.
    refused: bool,
    /// The next step that it would take.
    longest: f64,
}

impl Control {
    const FRESH: Control = Control { fresh: true, refused: false, longest: 0.0 };

    /// What became of a step whose error is `error` times the tolerance, and the next step: `factor = 0.9 error^(-1/8)`
    /// times as long, between a third of the last one and six times it; no longer than it after a refusal.
    #[inline(always)]
    fn judge(&mut self, size: f64, error: f64, factor: f64) -> StepOutcome {
        let size = size.abs();
        if error.is_nan() || error > 1.0 {
            self.refused = true;
            self.longest = size * if error.is_finite() { factor.clamp(1.0 / 3.0, 0.9) } else { 0.1 };
            return StepOutcome::TooLong;
        }
        let next = size * factor.clamp(1.0 / 3.0, if self.refused { 1.0 } else { 6.0 });
        // A step cut short to land on a wanted time says little about the longest one.
        let cut_short = size < self.longest && factor >= 1.0;
        self.longest = if cut_short { self.longest.max(next) } else { next };
        self.refused = false;
        StepOutcome::Taken
    }
}

/// Trajectories with their tangent vectors and the rates at all stages.
struct RungeKuttaBlock<'f, F, V> {
    method: RungeKutta,
    system: Variational<'f, F, V>,
    rates: Vec<V>,
    /// What the error of each group follows from, and in the end that of the momentum of time: [`RungeKuttaBlock::estimate`].
    estimates: Vec<[V; 3]>,
    /// The memory of a step of compiled code: values, the size of the step, estimates; empty where there is none.
    memory: Vec<V>,
    controls: Vec<Control>,
    errors: Vec<f64>,
    factors: Vec<f64>,
}

impl<'f, F: Field, V: Lane> RungeKuttaBlock<'f, F, V> {
    fn new(method: RungeKutta, field: &'f F, n_tangents: usize) -> Self {
        let system = Variational::new(field, n_tangents, method.compensated);
        let n_judged = 1 + n_tangents + usize::from(momentum_of_time(field.size_limits()).is_some());
        let n_memory = if F::IS_COMPILED { system.n_values() + 1 + 3 * n_judged } else { 0 };
        RungeKuttaBlock {
            method,
            estimates: vec![[V::splat(0.0); 3]; n_judged],
            memory: vec![V::splat(0.0); n_memory],
            rates: vec![V::splat(0.0); (1 + STAGES.len()) * system.row()],
            controls: vec![Control::FRESH; V::WIDTH],
            errors: vec![0.0; V::WIDTH],
            factors: vec![0.0; V::WIDTH],
            system,
        }
    }

    /// The rates at all stages after the first.
    #[inline(always)]
    fn stages(&mut self, step: V) {
        let row = self.system.row();
        for (i, terms) in STAGES.iter().enumerate() {
            let (known, rates) = self.rates.split_at_mut((i + 1) * row);
            self.system.rates_beside(step, terms, known, &mut rates[..row]);
        }
    }

    /// A step from the present values and their rates; its start is kept where errors are estimated.
    #[inline(always)]
    fn step(&mut self, step: V) {
        self.stages(step);
        if self.method.tolerance().is_some() {
            self.system.remember();
        }
        self.system.update(step, WEIGHTS, &self.rates);
        if self.method.tolerance().is_some() {
            self.estimate();
        }
    }

    /// A step with the rates at its start.
    #[inline(always)]
    fn step_with_first_rates(&mut self, step: V) {
        let row = self.system.row();
        self.system.rates(&mut self.rates[..row]);
        self.step(step);
    }

    /// The same as compiled code; false, and nothing, where there is none.
    #[inline(always)]
    fn step_compiled(&mut self, step: V) -> bool {
        if !F::IS_COMPILED {
            return false;
        }
        let RungeKuttaBlock { method, system, estimates, memory, .. } = self;
        let (n, whole) =
            (system.n_values(), WholeStep { method: *method, field: system.field, n_tangents: system.n_tangents });
        system.write(&mut memory[..n]);
        memory[n] = step;
        if !system.field.run_compiled(&whole, memory) {
            return false;
        }
        if method.tolerance().is_some() {
            system.remember();
            estimates.as_flattened_mut().copy_from_slice(&memory[n + 1..]);
        }
        system.read_back(&memory[..n]);
        true
    }

    /// The sums of the absolute values of the estimates of orders 5 and 3 of some components.
    #[inline(always)]
    fn error_sizes(&self, first: usize, n: usize) -> [V; 2] {
        let (known, row) = (&self.rates[first..], self.system.row());
        let mut error_sizes = ErrorSizes {
            of_order_5: Sum { terms: ERROR_OF_ORDER_5, known, row },
            of_order_3: Sum { terms: ERROR_OF_ORDER_3, known, row },
            sums: [V::splat(0.0); 2],
        };
        in_chunks::<V>(n, &mut error_sizes);
        error_sizes.sums
    }

    /// What the error of each group follows from, and in the end that of the momentum of time: [`relative_error`], for
    /// [`RungeKuttaBlock::judge_errors`].
    #[inline(always)]
    fn estimate(&mut self) {
        for (g, group) in self.system.groups().enumerate() {
            let limits = self.system.size_limits(g);
            let error_sizes = self.error_sizes(group.start, n_measured(limits, group.len()));
            let before = size_of_state(limits, &self.system.start[group.clone()]);
            self.estimates[g] =
                relative_error(error_sizes, before.add(size_of_state(limits, &self.system.state[group])));
        }
        if let Some(i) = momentum_of_time(self.system.size_limits(0)) {
            let size = self.system.start[i].abs().add(self.system.state[i].abs());
            *self.estimates.last_mut().expect("that of the momentum") = relative_error(self.error_sizes(i, 1), size);
        }
    }

    /// For each lane the estimated error of the step over what is allowed; NaN if a number is not finite.
    ///
    /// With the estimates `e5` and `e3` of orders 5 and 3, which are sums of absolute values over a group, the error is
    /// `h e5^2 / sqrt(e5^2 + 0.01 e3^2)`, of order 8 in `h`; the largest over the groups, each relative to its own size,
    /// decides. Tangent vectors have a say because an equilibrium allows any step, and the flow about it does not.
    #[inline(always)]
    fn judge_errors(&mut self, sizes: &[f64]) {
        let Steps::Adaptive { tolerance } = self.method.steps else { return };
        self.errors.fill(0.0);
        for [relative, e5, defect] in &self.estimates[..=self.system.n_tangents] {
            let (relative, e5, defect) = (relative.as_scalars(), e5.as_scalars(), defect.as_scalars());
            for (lane, largest) in self.errors[..V::WIDTH].iter_mut().enumerate() {
                let relative = if e5[lane].to_f64() > 0.0 { relative[lane].to_f64() } else { 0.0 };
                *largest = (if relative > *largest { relative } else { *largest }) + defect[lane].to_f64();
            }
        }
        for (error, size) in self.errors[..V::WIDTH].iter_mut().zip(&sizes[..V::WIDTH]) {
            *error *= size.abs() / tolerance;
        }
        if let Some(component) = momentum_of_time(self.system.size_limits(0)) {
            let [relative, e5, _] = self.estimates[self.system.n_tangents + 1];
            for (lane, size) in sizes[..V::WIDTH].iter().enumerate() {
                let mut error = relative.get(lane) * size.abs() / tolerance;
                if error > 1.0 {
                    error *= self.share_beside_terms((lane, component), e5.get(lane), size.abs());
                }
                if error > self.errors[lane] {
                    self.errors[lane] = error;
                }
            }
        }
        self.factors.copy_from_slice(&self.errors);
        for factor in &mut self.factors[..V::WIDTH] {
            *factor = 0.9 * exp2_estimate(log2_estimate(*factor) * (-1.0 / ORDER));
        }
    }

    /// What the size of a component is, at both ends of a step, beside the same with the terms of its rate, which may cancel; zero
    /// where the estimate of order 5 is no more than round-off.
    #[cold]
    fn share_beside_terms(&self, (lane, component): (usize, usize), e5: f64, step: f64) -> f64 {
        let start = &self.system.start[..self.system.n_components()];
        let start: Vec<f64> = start.iter().map(|register| register.get(lane)).collect();
        let round_off = self.system.field.round_off_of_rate(&start, component) + f64::MIN_POSITIVE;
        let factors: f64 = ERROR_OF_ORDER_5.iter().map(|(_, factor)| factor.abs()).sum();
        let size = (start[component].abs() + self.system.state[component].get(lane).abs()).max(f64::MIN_POSITIVE);
        if e5 <= factors * round_off { 0.0 } else { size / (size + step * round_off / f64::EPSILON) }
    }

    /// The first proposal of a trajectory, NaN if it or its rates are not finite.
    ///
    /// `tolerance^(1/8) |x| / |x'|`, the least of all groups: the step for which the term of order 8 is as large as
    /// allowed if each coefficient of the power series is to the one before as `x'` to `x`. A state next to the origin
    /// tells no scale of time: there it is `10^-6 tolerance^(1/8)`, from which steps grow.
    #[inline(always)]
    fn first_step(&self, lane: usize) -> f64 {
        let (mut shortest, mut defect) = (f64::INFINITY, 0.0);
        for (g, group) in self.system.groups().enumerate() {
            let limits = self.system.size_limits(g);
            let size = size_of_state(limits, &self.system.state[group.clone()]).get(lane);
            let rate = sum_of_sizes(&self.rates[group][..n_measured(limits, self.system.n_components())]).get(lane);
            let ratio = if rate > 0.0 { (size / rate).max(1e-6) } else { f64::INFINITY };
            shortest = shortest.min(ratio);
            defect += (size + rate) * 0.0;
        }
        let Steps::Adaptive { tolerance } = self.method.steps else { return shortest + defect };
        shortest * exp2_estimate(log2_estimate(tolerance) / ORDER) + defect
    }
}

/// `2 e5 / (sqrt(1 + 0.01 (e3/e5)^2) size)`, `e5`, and zero, or NaN where a number is not finite.
#[inline(always)]
fn relative_error<V: Lane>([e5, e3]: [V; 2], size: V) -> [V; 3] {
    let (ratio, twice) = (e3.div(e5), V::splat(2.0));
    let root = ratio.mul(ratio).mul_add(V::splat(0.01), V::splat(1.0)).sqrt();
    let relative = e5.mul(twice).div(root.mul(size));
    // zero times infinity is NaN
    [relative, e5, e5.add(e3).add(size).mul(V::splat(0.0))]
}

/// Adds up the sizes of two sums over all components.
struct ErrorSizes<'a, V> {
    of_order_5: Sum<'a, V>,
    of_order_3: Sum<'a, V>,
    sums: [V; 2],
}

impl<V: Lane> Chunk for ErrorSizes<'_, V> {
    #[inline(always)]
    fn run<const M: usize>(&mut self, first: usize) {
        for (total, sum) in self.sums.iter_mut().zip([self.of_order_5, self.of_order_3]) {
            let sum = sum.of::<M>(first);
            for i in 0..M {
                *total = total.add(sum[i].abs());
            }
        }
    }
}

impl<F: Field, V: Lane> Block for RungeKuttaBlock<'_, F, V> {
    fn n_lanes(&self) -> usize {
        V::WIDTH
    }

    fn stepping(&self) -> Stepping {
        match self.method.steps {
            Steps::Adaptive { .. } => Stepping::Trial,
            Steps::Fixed { step } => Stepping::Fixed { longest: step, most_repeats: MOST_REPEATS },
        }
    }

    fn precision(&self) -> Precision {
        Precision::of::<V::Number>()
    }

    fn load(&mut self, lane: usize, _trajectory: usize, group: usize, values: &[f64]) {
        self.system.load(lane, group, values);
        if group == 0 {
            self.controls[lane] = Control::FRESH;
        }
    }

    fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        self.system.read(lane, group, values);
    }

    fn prepare(&mut self, _ahead: &[f64], longest: &mut [f64]) {
        let any_fresh = self.controls.iter().any(|control| control.fresh);
        // compiled code begins with the rates at the start
        if any_fresh || self.method.tolerance().is_some() && !F::IS_COMPILED {
            V::outline(FirstRates(self));
        }
        for (lane, longest) in longest.iter_mut().enumerate() {
            *longest = self.precision().nearest(self.controls[lane].longest);
        }
    }

    fn advance(&mut self, sizes: &[f64], repeats: u64, outcomes: &mut [StepOutcome]) {
        match self.method.steps {
            Steps::Adaptive { .. } => V::outline(TrialStep { block: self, sizes, outcomes }),
            Steps::Fixed { .. } => V::outline(FixedSteps { block: self, sizes, repeats, outcomes }),
        }
    }

    fn norms(&self, group: usize, norms: &mut [f64]) {
        self.system.norms(group, norms);
    }

    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32) {
        let (n, row) = (self.system.n_components(), self.system.row());
        Variational::<F, V>::scale(n, &mut self.system.state, row, (lane, group), exponent);
    }

    fn series(&self) -> Option<&dyn Series> {
        None
    }
}

/// The rates at the present values, and the first proposals of new trajectories.
struct FirstRates<'b, 'f, F, V>(&'b mut RungeKuttaBlock<'f, F, V>);

impl<F: Field, V: Lane> Body for FirstRates<'_, '_, F, V> {
    #[inline(always)]
    fn run(self) {
        let block = self.0;
        let row = block.system.row();
        block.system.rates(&mut block.rates[..row]);
        for lane in 0..V::WIDTH {
            if block.controls[lane].fresh {
                block.controls[lane] = Control { fresh: false, refused: false, longest: block.first_step(lane) };
            }
        }
    }
}

/// One step of every lane, which is taken or refused.
struct TrialStep<'b, 'f, F, V> {
    block: &'b mut RungeKuttaBlock<'f, F, V>,
    sizes: &'b [f64],
    outcomes: &'b mut [StepOutcome],
}

impl<F: Field, V: Lane> Body for TrialStep<'_, '_, F, V> {
    #[inline(always)]
    fn run(self) {
        let TrialStep { block, sizes, outcomes } = self;
        let (sizes, outcomes) = (&sizes[..V::WIDTH], &mut outcomes[..V::WIDTH]);
        let step: V = spread(sizes);
        if !F::IS_COMPILED {
            block.step(step);
        } else if !block.step_compiled(step) {
            block.step_with_first_rates(step);
        }
        block.judge_errors(sizes);
        for lane in 0..V::WIDTH {
            let stays = sizes[lane] == 0.0;
            let (error, factor) = (block.errors[lane], block.factors[lane]);
            outcomes[lane] =
                if stays { StepOutcome::Taken } else { block.controls[lane].judge(sizes[lane], error, factor) };
            if stays || outcomes[lane] == StepOutcome::TooLong {
                block.system.restore(lane);
            }
        }
    }
}

/// Several steps of every lane.
struct FixedSteps<'b, 'f, F, V> {
    block: &'b mut RungeKuttaBlock<'f, F, V>,
    sizes: &'b [f64],
    repeats: u64,
    outcomes: &'b mut [StepOutcome],
}

impl<F: Field, V: Lane> Body for FixedSteps<'_, '_, F, V> {
    #[inline(always)]
    fn run(self) {
        let FixedSteps { block, sizes, repeats, outcomes } = self;
        let step: V = spread(&sizes[..V::WIDTH]);
        block.system.remember();
        for _ in 0..repeats {
            if !block.step_compiled(step) {
                block.step_with_first_rates(step);
            }
        }
        let size = sum_of_sizes(&block.system.state);
        for lane in 0..V::WIDTH {
            let finite = size.get(lane).is_finite();
            outcomes[lane] = if finite || sizes[lane] == 0.0 { StepOutcome::Taken } else { StepOutcome::NotFinite };
            if !finite || sizes[lane] == 0.0 {
                block.system.restore(lane);
            }
        }
    }
}

/// A step as straight code: from values and the size of the step in the memory to new values, and estimates of errors.
struct WholeStep<'f, F> {
    method: RungeKutta,
    field: &'f F,
    n_tangents: usize,
}

impl<F: Field> Straight for WholeStep<'_, F> {
    fn key(&self) -> u64 {
        let (compensated, adaptive) = (self.method.compensated, self.method.tolerance().is_some());
        (self.n_tangents as u64) << 2 | u64::from(compensated) << 1 | u64::from(adaptive)
    }

    fn n_rates(&self) -> usize {
        (1 + STAGES.len()) * (1 + self.n_tangents)
    }

    #[inline(always)]
    fn run<V: Lane>(&self, memory: &mut [V]) {
        let mut block = RungeKuttaBlock::<F, V>::new(self.method, self.field, self.n_tangents);
        let n = block.system.n_values();
        block.system.read_back(&memory[..n]);
        block.step_with_first_rates(memory[n]);
        block.system.write(&mut memory[..n]);
        if self.method.tolerance().is_some() {
            memory[n + 1..].copy_from_slice(block.estimates.as_flattened());
        }
    }
}
