//! The Taylor method of tops in mixed precision: what a step is made of in single precision, what it is added to in double.

use crate::field::top::{
    Constant, Constants, GROUP, N, OMEGA, products_of_state, products_of_state_and_tangent, products_of_tangents,
};
use crate::field::{Field, Instance, Instantiate, Top, over};
use crate::lanes::{Body, Lane, Number, Wide, as_scalars};
use crate::method::estimates::{exp2_estimate, exp2_estimate_single, log2_estimate, log2_estimate_single};
use crate::method::taylor::{Terms, Trend, sum_of_sizes};
use crate::method::{Block, Method, Overview, Precision, Series, StepOutcome, Stepping, Taylor};
use std::collections::TryReserveError;

/// [`Taylor`] for a [`Top`], with the high orders of the state and all of the tangent vectors in single precision.
///
/// A term of the series that is small beside the state need not be known to as many digits. The lowest orders of the
/// state, those with terms above `2^22 tol` of it, are computed and summed in double precision; the rest in single
/// precision, twice as many trajectories to a register. The state is then as accurate as with [`Taylor`] of the same
/// tolerance. Tangent vectors are kept in single precision throughout: a step rounds them to 6e-8 of their length, independently from
/// step to step. Their series is cut where its terms drop below `2^-24`, or below `tol` if that is more, and no earlier: what is left
/// out is no noise. It is the same on each round of a regular orbit, and a tangent map that is off by `d` in each step makes vectors
/// grow exponentially, at a rate of about `d` a step, where they grow as `t`.
///
/// Time is measured in units of the step before, rounded to a power of two: else the coefficients of a fast top would
/// leave the range of single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixedTaylor(pub Taylor);

/// Longest step in units of the step before: the highest terms of the series must not vanish by underflow.
const LONGEST: f64 = 8.0;

/// Units in which a fast top's coefficients overflow are divided by this, until they do not.
const SHORTER_UNIT: f64 = 1.0 / 256.0;

/// Units shorter than this are not divided further.
const SHORTEST_UNIT: f64 = 1e-290;

/// Steps below two to minus this, in units of the step before, and states below this size are not judged in single precision,
/// which has no numbers for the products of their terms.
const LEAST_POWER: f32 = 4.0;
const LEAST_SIZE: f32 = 1e-20;

/// Units are powers of two between this one and its inverse.
const LEAST_UNIT: f64 = f64::from_bits((1023 - 1000) << 52);

/// Round-off of single precision, 2^-24.
const ROUND_OFF: f64 = 1.0 / 16_777_216.0;

impl MixedTaylor {
    /// Highest order of the state that is computed in double precision.
    fn double_order(&self) -> usize {
        // tol^(k/N) <= 2^22 tol
        let share = 1.0 - 22.0 * std::f64::consts::LN_2 / -libm::log(self.0.tolerance());
        ((share * self.0.order() as f64).ceil().max(1.0) as usize).min(self.0.order() - 1)
    }

    /// Relative size of the terms of a tangent vector's series that are left out.
    fn tangent_tolerance(&self) -> f64 {
        ROUND_OFF.max(self.0.tolerance())
    }

    /// Highest order of the tangent vectors.
    fn tangent_order(&self) -> usize {
        let share = libm::log(self.tangent_tolerance()) / libm::log(self.0.tolerance());
        ((share * self.0.order() as f64).ceil() as usize).clamp(2, self.0.order())
    }
}

impl<F: Instantiate> Method<F> for MixedTaylor
where
    for<'f> F::Instance<'f>: Constants,
{
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        let field = field.instantiate();
        let (n_double, row) = (self.double_order() + 1, field.row(n_tangents));
        Box::new(MixedBlock::<F::Instance<'f>, V> {
            top: field,
            method: self.0,
            double_order: self.double_order(),
            tangent_order: self.tangent_order(),
            tangent_tolerance: self.tangent_tolerance(),
            trends: [
                Trend::new(self.0.tolerance(), self.0.order()),
                Trend::new(8.0 * self.tangent_tolerance(), self.tangent_order()),
            ],
            n_tangents,
            row,
            double: [vec![V::splat(0.0); n_double * GROUP], vec![V::splat(0.0); n_double * GROUP]],
            single: vec![V::Narrow::splat(0.0); (self.0.order() + 1) * row],
            units: vec![1.0; 2 * V::WIDTH],
        })
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        let field = field.instantiate();
        2 * (self.double_order() + 1) * GROUP + (self.0.order() + 1) * field.row(n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.0.max_steps()
    }
}

struct MixedBlock<C, V: Wide> {
    top: C,
    method: Taylor,
    double_order: usize,
    tangent_order: usize,
    tangent_tolerance: f64,
    /// Of the state, and of the tangent vectors.
    trends: [Trend; 2],
    n_tangents: usize,
    /// Registers of one order in `single`.
    row: usize,
    /// Low orders of the state, the first and the second half of the lanes.
    double: [Vec<V>; 2],
    /// All orders of state and tangent vectors.
    single: Vec<V::Narrow>,
    /// The unit of time of each lane, a power of two.
    units: Vec<f64>,
}

impl<C: Constants + Instance, V: Wide> Block for MixedBlock<C, V> {
    fn n_lanes(&self) -> usize {
        2 * V::WIDTH
    }

    fn stepping(&self) -> Stepping {
        Stepping::Series
    }

    fn precision(&self) -> Precision {
        Precision::Single
    }

    fn load(&mut self, lane: usize, trajectory: usize, group: usize, values: &[f64]) {
        for (i, &value) in values.iter().enumerate() {
            if group == 0 {
                self.double[lane / V::WIDTH][i].set(lane % V::WIDTH, value);
            } else {
                self.single[group * GROUP + i].set(lane, value);
            }
        }
        if group == 0 {
            self.top.assign(lane, trajectory);
            self.units[lane] = first_unit(self.top.in_lane(lane), values);
        }
    }

    fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = if group == 0 {
                self.double[lane / V::WIDTH][i].get(lane % V::WIDTH)
            } else {
                self.single[group * GROUP + i].get(lane)
            };
        }
    }

    fn prepare(&mut self, _ahead: &[f64], longest: &mut [f64]) {
        loop {
            V::outline(Expansion(self));
            V::outline(Steps { block: self, sizes: longest });
            let mut again = false;
            for lane in 0..longest.len() {
                if longest[lane].is_nan() && self.is_finite(lane) && self.units[lane] > SHORTEST_UNIT {
                    self.units[lane] *= SHORTER_UNIT;
                    again = true;
                } else {
                    longest[lane] *= self.units[lane];
                }
            }
            if !again {
                break;
            }
        }
    }

    fn advance(&mut self, sizes: &[f64], _repeats: u64, outcomes: &mut [StepOutcome]) {
        outcomes.fill(StepOutcome::Taken);
        V::outline(Advance { block: self, sizes });
        for (unit, &size) in self.units.iter_mut().zip(sizes).filter(|(_, size)| **size != 0.0) {
            *unit = power_of_two(size.abs());
        }
    }

    fn norms(&self, group: usize, norms: &mut [f64]) {
        V::outline(Norms { block: self, group, norms });
    }

    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32) {
        for register in &mut self.single[group * GROUP..][..N] {
            register.set(lane, libm::scalbn(register.get(lane), exponent));
        }
    }

    fn series(&self) -> Option<&dyn Series> {
        Some(self)
    }
}

impl<C: Constants, V: Wide> Series for MixedBlock<C, V> {
    fn evaluate(&self, lane: usize, group: usize, taus: &[f64], n: usize, values: &mut [f64], stride: usize) {
        for (&tau, values) in taus.iter().zip(values.chunks_mut(stride)) {
            V::outline(Evaluation { block: self, lane, group, tau, values: &mut values[..n] });
        }
    }

    fn keeps_tangents_whole(&self) -> bool {
        false
    }

    fn look_over(&self, _steps: &[f64], _of: &mut Overview<'_>) -> bool {
        false
    }

    fn copy(&self, lane: usize, n_orders: usize, to: &mut Vec<f64>) -> Result<(), TryReserveError> {
        let n_orders = n_orders.min(self.method.order() + 1);
        to.try_reserve(n_orders * N)?;
        for k in 0..n_orders {
            // A unit whose power leaves the range of numbers takes coefficients with it that the step counts on.
            let scale = libm::pow(self.units[lane], -(k as f64));
            let scale = if (1e-280..1e280).contains(&scale) { scale } else { f64::NAN };
            for i in 0..N {
                let coefficient = if k <= self.double_order {
                    self.double[lane / V::WIDTH][k * GROUP + i].get(lane % V::WIDTH)
                } else {
                    self.single[k * self.row + i].get(lane)
                };
                to.push(coefficient * scale);
            }
        }
        Ok(())
    }
}

impl<C, V: Wide> MixedBlock<C, V> {
    fn is_finite(&self, lane: usize) -> bool {
        self.double[lane / V::WIDTH][..N].iter().all(|component| component.get(lane % V::WIDTH).is_finite())
    }

    /// Sum of the absolute values of the components of `group`, in coefficient `k`.
    #[inline(always)]
    fn norm(&self, k: usize, group: usize) -> V::Narrow {
        sum_of_sizes(&self.single[k * self.row + group * GROUP..][..N])
    }
}

/// The time in which the state changes by its own size, as a power of two.
fn first_unit(top: &Top, state: &[f64]) -> f64 {
    let mut rows = [0.0; 2 * GROUP];
    rows[..N].copy_from_slice(state);
    top.derive_work(&mut rows, 0, 0);
    top.extend(&mut rows, 0, 0);
    let time = sum_of_sizes(&rows[..N]) / sum_of_sizes(&rows[GROUP..GROUP + N]);
    if time.is_finite() { power_of_two(time) } else { 1.0 }
}

/// The power of two below a positive number, between 2^-1000 and 2^1000.
fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.clamp(LEAST_UNIT, 1.0 / LEAST_UNIT).to_bits() & EXPONENT)
}

/// The parameters of the top with time in units of each lane: products that single precision can hold where it cannot hold
/// the factors.
struct ScaledTop<V> {
    /// Which components of a, b and the twist are zero in all lanes.
    vanish: [[bool; 3]; 3],
    asymmetry: [V; 3],
    inverse_inertia: [V; 3],
    a: [V; 3],
    b: [V; 3],
    twist: [V; 3],
}

impl<V: Wide> ScaledTop<V> {
    #[inline(always)]
    fn new<C: Constants>(top: &C, unit: V, first_lane: usize) -> Self {
        let mut scaled = ScaledTop {
            vanish: [[false; 3]; 3],
            asymmetry: [unit; 3],
            inverse_inertia: [unit; 3],
            a: [unit; 3],
            b: [unit; 3],
            twist: [unit; 3],
        };
        // loops: what is called through `map` is not compiled for these registers
        for axis in 0..3 {
            scaled.vanish[0][axis] = top.vanishes(Constant::A, axis);
            scaled.vanish[1][axis] = top.vanishes(Constant::B, axis);
            scaled.vanish[2][axis] = top.vanishes(Constant::Twist, axis);
            scaled.asymmetry[axis] = top.of(Constant::Asymmetry, axis, first_lane);
            scaled.inverse_inertia[axis] = unit.mul(top.of(Constant::InverseInertia, axis, first_lane));
            scaled.a[axis] = unit.mul(top.of(Constant::A, axis, first_lane));
            scaled.b[axis] = unit.mul(top.of(Constant::B, axis, first_lane));
            scaled.twist[axis] = unit.mul(top.of(Constant::Twist, axis, first_lane));
        }
        scaled
    }

    /// Of all lanes, from the two halves.
    #[inline(always)]
    fn narrow([first, second]: &[ScaledTop<V>; 2]) -> ScaledTop<V::Narrow> {
        ScaledTop {
            vanish: first.vanish,
            asymmetry: narrow(&first.asymmetry, &second.asymmetry),
            inverse_inertia: narrow(&first.inverse_inertia, &second.inverse_inertia),
            a: narrow(&first.a, &second.a),
            b: narrow(&first.b, &second.b),
            twist: narrow(&first.twist, &second.twist),
        }
    }
}

/// Three registers from two halves; no closure, which the compiler was seen to call instead of inlining it.
#[inline(always)]
fn narrow<V: Wide>(first: &[V; 3], second: &[V; 3]) -> [V::Narrow; 3] {
    [V::narrow(first[0], second[0]), V::narrow(first[1], second[1]), V::narrow(first[2], second[2])]
}

impl<V: Lane> ScaledTop<V> {
    #[inline(always)]
    fn derive_omega(&self, group: &mut [V]) {
        for i in 0..3 {
            group[OMEGA + i] = group[i].mul(self.inverse_inertia[i]);
        }
    }

    /// From sums of products to the next coefficients: terms linear in the last ones, and the factors.
    #[inline(always)]
    fn finish(&self, sum: &mut [V; N], last: &[V], next: &mut [V], k: usize) {
        for i in 0..3 {
            sum[i] = sum[i].mul(self.asymmetry[i]);
        }
        let [a, b, twist] = &self.vanish;
        add_cross(sum, 0, &last[3..6], a, &self.a);
        add_cross(sum, 0, &last[6..9], b, &self.b);
        add_cross(sum, 3, &last[6..9], twist, &self.twist);
        for i in 0..N {
            next[i] = over(sum[i], k + 1);
        }
        self.derive_omega(next);
    }
}

/// `sum[at..] += u x c`: components of `c` that are zero cost nothing.
#[inline(always)]
fn add_cross<V: Lane>(sum: &mut [V; N], at: usize, u: &[V], vanish: &[bool; 3], c: &[V; 3]) {
    for axis in 0..3 {
        if !vanish[axis] {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            sum[at + next] = u[last].mul_add(c[axis], sum[at + next]);
            sum[at + last] = u[next].neg_mul_add(c[axis], sum[at + last]);
        }
    }
}

/// The power series: the low orders of the state in double precision, the rest from them in single precision.
struct Expansion<'b, C, V: Wide>(&'b mut MixedBlock<C, V>);

impl<C: Constants, V: Wide> Body for Expansion<'_, C, V> {
    #[inline(always)]
    fn run(self) {
        let MixedBlock { top, method, double_order, tangent_order, n_tangents, row, double, single, units, .. } =
            self.0;
        let (row, n_tangents) = (*row, *n_tangents);
        let mut both = [V::splat(0.0); 2];
        for (unit, units) in both.iter_mut().zip(units.chunks_exact(V::WIDTH)) {
            unit.as_scalars_mut().copy_from_slice(units);
        }
        let halves = [ScaledTop::new(&*top, both[0], 0), ScaledTop::new(&*top, both[1], V::WIDTH)];
        for half in 0..2 {
            halves[half].derive_omega(&mut double[half][..GROUP]);
        }
        // order by order in both halves, so that one hides the latency of the other
        for k in 0..*double_order {
            for half in 0..2 {
                let (known, next) = double[half].split_at_mut((k + 1) * GROUP);
                let mut sum = products_of_state::<V, true>(known, GROUP);
                halves[half].finish(&mut sum, &known[k * GROUP..], &mut next[..GROUP], k);
            }
        }
        for k in 0..=*double_order {
            for i in 0..GROUP {
                single[k * row + i] = V::narrow(double[0][k * GROUP + i], double[1][k * GROUP + i]);
            }
        }
        let top = ScaledTop::narrow(&halves);
        for tangent in 1..=n_tangents {
            top.derive_omega(&mut single[tangent * GROUP..][..GROUP]);
        }
        for k in 0..method.order() {
            let (known, next) = single.split_at_mut((k + 1) * row);
            let (with_state, with_tangents) = (k >= *double_order, k < *tangent_order && n_tangents > 0);
            let fused = with_state && with_tangents && V::Narrow::REGISTERS >= 32;
            if fused {
                let (mut sum, mut tangent) = products_of_state_and_tangent::<V::Narrow, true>(known, row);
                top.finish(&mut sum, &known[k * row..], &mut next[..GROUP], k);
                top.finish(&mut tangent, &known[k * row + GROUP..], &mut next[GROUP..2 * GROUP], k);
            } else if with_state {
                let mut sum = products_of_state::<V::Narrow, true>(known, row);
                top.finish(&mut sum, &known[k * row..], &mut next[..GROUP], k);
            }
            if with_tangents && !fused {
                extend_tangents::<V::Narrow, 1>(&top, known, next, row, GROUP);
            }
        }
        let mut at = 2 * GROUP;
        while at < row {
            at += match (row - at) / GROUP {
                2.. if V::Narrow::REGISTERS >= 32 => {
                    expand_tangents::<V::Narrow, 2>(&top, single, row, at, *tangent_order)
                }
                _ => expand_tangents::<V::Narrow, 1>(&top, single, row, at, *tangent_order),
            };
        }
    }
}

/// The next coefficients of the `M` tangent vectors from group `at` on.
#[inline(always)]
fn extend_tangents<V: Lane, const M: usize>(top: &ScaledTop<V>, known: &[V], next: &mut [V], row: usize, at: usize) {
    let (k, last) = (known.len() / row - 1, known.len() - row);
    let mut sums = products_of_tangents::<V, M, true>(known, row, at);
    for m in 0..M {
        let at = at + m * GROUP;
        top.finish(&mut sums[m], &known[last + at..], &mut next[at..at + GROUP], k);
    }
}

/// The series of these tangent vectors, where that of the state is known; the registers that they take. With the state, they
/// stay in the nearest cache.
#[inline(always)]
fn expand_tangents<V: Lane, const M: usize>(
    top: &ScaledTop<V>,
    rows: &mut [V],
    row: usize,
    at: usize,
    order: usize,
) -> usize {
    for k in 0..order {
        let (known, next) = rows.split_at_mut((k + 1) * row);
        extend_tangents::<V, M>(top, known, next, row, at);
    }
    M * GROUP
}

/// For each lane the longest step, in its unit: as [`Taylor`] chooses it, but for the tolerance of tangent vectors, from
/// logarithms in single precision: they hold where the tolerance times a size has no number there.
struct Steps<'b, C, V: Wide> {
    block: &'b MixedBlock<C, V>,
    sizes: &'b mut [f64],
}

impl<C, V: Wide> Body for Steps<'_, C, V> {
    #[inline(always)]
    fn run(self) {
        let Steps { block, sizes } = self;
        let mut logarithms = V::Narrow::splat(libm::log2(LONGEST));
        for group in 0..=block.n_tangents {
            let (order, tolerance) = match group {
                0 => (block.method.order(), block.method.tolerance()),
                _ => (block.tangent_order, 8.0 * block.tangent_tolerance),
            };
            let tolerance = log2_estimate(tolerance) as f32;
            let (mut allowed, last) = (block.norm(0, group), block.norm(order, group));
            logarithms = logarithms.add(allowed.add(last).mul(V::Narrow::splat(0.0)));
            for allowed in allowed.as_scalars_mut() {
                *allowed = log2_estimate_single(*allowed) + tolerance;
            }
            shorten(&mut logarithms, &allowed, &last, order);
            shorten(&mut logarithms, &allowed, &block.norm(order - 1, group), order - 1);
        }
        let mut step = logarithms;
        for step in step.as_scalars_mut() {
            *step = exp2_estimate_single(*step);
        }
        for (size, &step) in sizes.iter_mut().zip(step.as_scalars()) {
            *size = f64::from(step);
        }
        if block.suspects(logarithms, step) {
            block.shorten_by_trend(logarithms.as_scalars(), sizes);
        }
    }
}

/// The logarithm of each size, at most that for which the logarithm of `term size^power` is `allowed`; NaN stays.
#[inline(always)]
fn shorten<V: Lane<Number = f32>>(sizes: &mut V, allowed: &V, terms: &V, power: usize) {
    let inverse = 1.0 / power as f32;
    let terms = allowed.as_scalars().iter().zip(terms.as_scalars());
    for (size, (&allowed, &term)) in sizes.as_scalars_mut().iter_mut().zip(terms) {
        let bound = (allowed - log2_estimate_single(term)) * inverse;
        let bound = if term > 0.0 { bound } else { f32::INFINITY };
        *size = if bound < *size { bound } else { *size };
    }
}

impl<C, V: Wide> MixedBlock<C, V> {
    /// Whether [`Trend::suspects`] a step in any lane, or single precision cannot tell: all lanes at once.
    #[inline(always)]
    fn suspects(&self, logarithms: V::Narrow, step: V::Narrow) -> bool {
        let mut suspicious = false;
        for &logarithm in logarithms.as_scalars() {
            suspicious |= logarithm < -LEAST_POWER;
        }
        for group in 0..=self.n_tangents {
            for &size in self.norm(0, group).as_scalars() {
                suspicious |= 0.0 < size && size < LEAST_SIZE;
            }
            suspicious |= self.trends[usize::from(group > 0)].suspects(step, self, group);
        }
        suspicious
    }

    /// Shortens the steps with these logarithms where [`Trend::shorten`] does; the others keep their bits.
    #[inline(always)]
    fn shorten_by_trend(&self, logarithms: &[f32], steps: &mut [f64]) {
        let halves = logarithms.chunks_exact(V::WIDTH).zip(steps.chunks_exact_mut(V::WIDTH));
        for (second, (logarithms, steps)) in [false, true].into_iter().zip(halves) {
            let mut shortened = V::splat(0.0);
            for (shortened, &logarithm) in shortened.as_scalars_mut().iter_mut().zip(logarithms) {
                *shortened = f64::from(logarithm);
            }
            for group in 0..=self.n_tangents {
                let trend = &self.trends[usize::from(group > 0)];
                trend.shorten(shortened.as_scalars_mut(), &Half::<C, V> { block: self, second }, group);
            }
            let lanes = logarithms.iter().zip(shortened.as_scalars());
            for (step, (&logarithm, &shortened)) in steps.iter_mut().zip(lanes) {
                if shortened < f64::from(logarithm) {
                    *step = exp2_estimate(shortened);
                }
            }
        }
    }
}

impl<C, V: Wide> Terms<V::Narrow> for MixedBlock<C, V> {
    #[inline(always)]
    fn size(&self, k: usize, group: usize) -> V::Narrow {
        self.norm(k, group)
    }
}

/// One half of the lanes, in double precision.
struct Half<'h, C, V: Wide> {
    block: &'h MixedBlock<C, V>,
    second: bool,
}

impl<C, V: Wide> Terms<V> for Half<'_, C, V> {
    #[inline(always)]
    fn size(&self, k: usize, group: usize) -> V {
        let (first, second) = V::widen(self.block.norm(k, group));
        if self.second { second } else { first }
    }
}

/// One group of one lane, some time after the start of the step.
struct Evaluation<'b, C, V: Wide> {
    block: &'b MixedBlock<C, V>,
    lane: usize,
    group: usize,
    tau: f64,
    values: &'b mut [f64],
}

impl<C, V: Wide> Body for Evaluation<'_, C, V> {
    #[inline(always)]
    fn run(self) {
        let Evaluation { block, lane, group, tau, values } = self;
        let s = tau / block.units[lane];
        let top_order = if group == 0 { block.method.order() } else { block.tangent_order };
        let (single, stride) = (as_scalars(&block.single), block.row * 2 * V::WIDTH);
        let mut sums = [0.0_f64; N];
        for k in (0..=top_order).rev() {
            if group == 0 && k <= block.double_order {
                let coefficients = &block.double[lane / V::WIDTH][k * GROUP..][..N];
                for i in 0..N {
                    sums[i] = sums[i].mul_add(s, coefficients[i].get(lane % V::WIDTH));
                }
            } else {
                let coefficients = &single[k * stride + group * GROUP * 2 * V::WIDTH + lane..];
                for i in 0..N {
                    sums[i] = sums[i].mul_add(s, coefficients[i * 2 * V::WIDTH].to_f64());
                }
            }
        }
        values.copy_from_slice(&sums[..values.len()]);
    }
}

/// Sizes of one group of all lanes.
struct Norms<'b, C, V: Wide> {
    block: &'b MixedBlock<C, V>,
    group: usize,
    norms: &'b mut [f64],
}

impl<C, V: Wide> Body for Norms<'_, C, V> {
    #[inline(always)]
    fn run(self) {
        let (low, high) = V::widen(self.block.norm(0, self.group));
        self.norms[..V::WIDTH].copy_from_slice(low.as_scalars());
        self.norms[V::WIDTH..].copy_from_slice(high.as_scalars());
    }
}

/// Horner's rule: the high orders in single precision, then the low ones of the state in double precision.
struct Advance<'b, C, V: Wide> {
    block: &'b mut MixedBlock<C, V>,
    sizes: &'b [f64],
}

impl<C, V: Wide> Body for Advance<'_, C, V> {
    #[inline(always)]
    fn run(self) {
        let Advance { block, sizes } = self;
        let mut step = [V::splat(0.0); 2];
        for (half, step) in step.iter_mut().enumerate() {
            let lanes = half * V::WIDTH..(half + 1) * V::WIDTH;
            let ratios = sizes[lanes.clone()].iter().zip(&block.units[lanes]).map(|(size, unit)| size / unit);
            step.as_scalars_mut().iter_mut().zip(ratios).for_each(|(step, ratio)| *step = ratio);
        }
        let narrow = V::narrow(step[0], step[1]);
        let (zero, orders) = ([V::Narrow::splat(0.0); N], block.double_order + 1..=block.method.order());
        let high = horner(&block.single, block.row, 0, orders, narrow, zero);
        let mut rest = [[V::splat(0.0); N]; 2];
        for i in 0..N {
            (rest[0][i], rest[1][i]) = V::widen(high[i].mul(narrow));
        }
        for half in 0..2 {
            // the rest of the series stands at power `double_order + 1`, one of which is in it
            let value = horner(&block.double[half], GROUP, 0, 0..=block.double_order, step[half], rest[half]);
            block.double[half][..N].copy_from_slice(&value);
        }
        for at in (1..=block.n_tangents).map(|tangent| tangent * GROUP) {
            let value = horner(&block.single, block.row, at, 0..=block.tangent_order, narrow, zero);
            block.single[at..at + N].copy_from_slice(&value);
        }
    }
}

/// `rest + c_n`, then Horner's rule down to the lowest of `orders`, of which n is the highest.
#[inline(always)]
fn horner<V: Lane>(
    rows: &[V],
    row: usize,
    at: usize,
    orders: std::ops::RangeInclusive<usize>,
    step: V,
    rest: [V; N],
) -> [V; N] {
    let mut value = rest;
    for i in 0..N {
        value[i] = value[i].add(rows[*orders.end() * row + at + i]);
    }
    for k in (*orders.start()..*orders.end()).rev() {
        let coefficients = &rows[k * row + at..][..N];
        for i in 0..N {
            value[i] = value[i].mul_add(step, coefficients[i]);
        }
    }
    value
}
