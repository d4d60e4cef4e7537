//! The adaptive Taylor method: power series to an order set by the tolerance, steps to its radius of convergence.
//!
//! # References
//! Jorba and Zou, *A software package for the numerical integration of ODEs by means of high-order Taylor methods*,
//! Experimental Mathematics 14 (2005): the choice of order and step; here each lane takes its own step.

use crate::error::Error;
use crate::field::{Field, Instance, Instantiate, Straight};
use crate::lanes::{Body, Lane, Number, Wide, as_scalars};
use crate::method::estimates::{exp2_estimate, log2_estimate};
use crate::method::known_terms::{FEWEST, finite_order, is_in_range, longest_step};
use crate::method::momentum_of_time::{OwnSeries, momentum_of_time};
use crate::method::overview::{LookOver, Overview};
use crate::method::series_sum::{FEW, Strides, Sums};
use crate::method::{AnyMethod, Block, Method, MixedTaylor, Options, Precision, Series, StepOutcome, Stepping};
use std::collections::TryReserveError;
use std::marker::PhantomData;

pub(crate) const MAX_ORDER: usize = 64;

/// The method as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor {
    tolerance: f64,
    order: usize,
    /// Whether a caller chose the order.
    has_own_order: bool,
    max_steps: u64,
}

impl Taylor {
    /// A method whose last retained term is at most `tolerance` times the size of the state (sum of the absolute values
    /// of its components), with at most `max_steps` steps per trajectory.
    ///
    /// Without an `order` the cheapest for that tolerance is taken: the work of a step grows as the square of the order,
    /// its length as `tolerance^(1/order)`, which gives `-ln(tolerance)/2` for the products alone; the part of the work
    /// that grows more slowly moves the optimum upwards. Measured on the twisted Kovalevskaya top with one tangent
    /// vector (AVX-512): 20 to 22 are best at 1e-13, 14 to 16 at 1e-8, and within 5% of one another. A tape has an order
    /// of its own: [`Taylor::for_tape`].
    ///
    /// # Errors
    /// Tolerance outside `[2^-53, 0.1]`, order outside `2..=64`.
    pub fn new(tolerance: f64, order: Option<usize>, max_steps: u64) -> Result<Taylor, Error> {
        if !(f64::EPSILON / 2.0..=0.1).contains(&tolerance) {
            return Err(Error::Tolerance { got: tolerance });
        }
        let has_own_order = order.is_some();
        let order = order.unwrap_or_else(|| (3.5 - 0.58 * libm::log(tolerance)).ceil() as usize);
        if !(2..=MAX_ORDER).contains(&order) {
            return Err(Error::Order { got: order });
        }
        Ok(Taylor { tolerance, order, has_own_order, max_steps })
    }

    /// The method with the options `tol`, `order`, `precision` ("mixed") and `max_steps`.
    pub(crate) fn with_options(options: &Options) -> Result<AnyMethod, Error> {
        let taylor = Taylor::new(options.number("tol")?.unwrap_or(1e-15), options.order()?, options.max_steps()?)?;
        Ok(if options.says("precision", "mixed") { MixedTaylor(taylor).into() } else { taylor.into() })
    }

    /// Relative size of the last retained terms.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Order of the series.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Whether a caller chose it.
    pub(super) fn has_own_order(&self) -> bool {
        self.has_own_order
    }

    pub(super) fn with_order(self, order: usize) -> Taylor {
        Taylor { order, ..self }
    }

    /// Most steps that a trajectory may take.
    pub fn max_steps(&self) -> u64 {
        self.max_steps
    }
}

impl<F: Instantiate> Method<F> for Taylor {
    fn block<'f, V: Wide>(&self, field: &'f F, n_tangents: usize) -> Box<dyn Block + 'f> {
        Box::new(TaylorBlock::<_, V>::new(*self, field.instantiate(), n_tangents))
    }

    fn registers(&self, field: &F, n_tangents: usize) -> usize {
        let field = field.instantiate();
        field.registers(n_tangents, self.order) + registers_of_sizes(&field, n_tangents)
    }

    fn max_steps(&self) -> u64 {
        self.max_steps
    }
}

/// Trajectories with their tangent vectors and the power series of all of them.
pub(super) struct TaylorBlock<F, V> {
    pub(super) field: F,
    pub(super) method: Taylor,
    trend: Trend,
    pub(super) n_tangents: usize,
    pub(super) row: usize,
    /// Registers of the series, with all that the field keeps.
    pub(super) n_registers: usize,
    /// These, and what else a method keeps behind them.
    pub(super) rows: Vec<V>,
    /// Whether compiled code has put the sizes of terms behind the series: [`TermSizes`].
    has_sizes: bool,
}

impl<F: Instance, V: Wide> Block for TaylorBlock<F, V> {
    fn n_lanes(&self) -> usize {
        V::WIDTH
    }

    fn stepping(&self) -> Stepping {
        Stepping::Series
    }

    fn precision(&self) -> Precision {
        Precision::Double
    }

    fn load(&mut self, lane: usize, trajectory: usize, group: usize, values: &[f64]) {
        if group == 0 {
            self.field.assign(lane, trajectory);
        }
        let at = group * self.field.group();
        for (register, &value) in self.rows[at..].iter_mut().zip(values) {
            register.set(lane, value);
        }
    }

    fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        let at = group * self.field.group();
        for (register, value) in self.rows[at..].iter().zip(values) {
            *value = register.get(lane);
        }
    }

    fn prepare(&mut self, ahead: &[f64], longest: &mut [f64]) {
        V::outline(Expansion(self));
        let sizes = TermSizes::of(self);
        self.has_sizes = self.rows.len() >= sizes.end()
            && self.field.run_compiled(&SizesOfTerms(sizes, self.field.size_limits()), &mut self.rows);
        let mut is_out_of_range = false;
        V::outline(Steps { block: self, ahead, sizes: longest, is_out_of_range: &mut is_out_of_range });
        if is_out_of_range {
            for (lane, longest) in longest.iter_mut().enumerate() {
                self.rely_on_known_terms(lane, longest);
            }
        }
    }

    fn advance(&mut self, sizes: &[f64], _repeats: u64, outcomes: &mut [StepOutcome]) {
        outcomes.fill(StepOutcome::Taken);
        self.sum(sizes, 0);
    }

    fn norms(&self, group: usize, norms: &mut [f64]) {
        V::outline(Norms { block: self, group, norms });
    }

    fn scale_tangent(&mut self, lane: usize, group: usize, exponent: i32) {
        let at = group * self.field.group();
        for register in &mut self.rows[at..at + self.field.n_components()] {
            register.set(lane, libm::scalbn(register.get(lane), exponent));
        }
    }

    fn series(&self) -> Option<&dyn Series> {
        Some(self)
    }
}

impl<F: Field, V: Wide> Series for TaylorBlock<F, V> {
    fn evaluate(&self, lane: usize, group: usize, taus: &[f64], n: usize, values: &mut [f64], stride: usize) {
        if taus.len() <= FEW {
            for (&tau, values) in taus.iter().zip(values.chunks_mut(stride)) {
                V::outline(Evaluation { block: self, lane, group, tau, values: &mut values[..n] });
            }
            return;
        }
        let coefficients = &as_scalars(&self.rows)[group * self.field.group() * V::WIDTH + lane..];
        let (strides, order) = (Strides { order: self.row * V::WIDTH, component: V::WIDTH }, self.method.order);
        V::outline(Sums::<V> { coefficients, strides, order, n, taus, values, stride, registers: PhantomData });
    }

    fn keeps_tangents_whole(&self) -> bool {
        true
    }

    fn copy(&self, lane: usize, n_orders: usize, to: &mut Vec<f64>) -> Result<(), TryReserveError> {
        let n_orders = n_orders.min(self.method.order + 1);
        to.try_reserve(n_orders * self.field.n_components())?;
        let (scalars, n) = (as_scalars(&self.rows), self.field.n_components());
        for row in scalars.chunks_exact(self.row * V::WIDTH).take(n_orders) {
            to.extend(row[lane..].iter().step_by(V::WIDTH).take(n));
        }
        Ok(())
    }

    fn look_over(&self, steps: &[f64], of: &mut Overview<'_>) -> bool {
        let (row, n, n_orders) = (self.row, self.field.n_components(), self.method.order + 1);
        V::outline(LookOver { rows: &self.rows, row, n, n_orders, steps, of });
        true
    }
}

impl<F: Field, V: Wide> TaylorBlock<F, V> {
    pub(super) fn new(method: Taylor, field: F, n_tangents: usize) -> Self {
        let n_registers = field.registers(n_tangents, method.order);
        TaylorBlock {
            trend: Trend::new(method.tolerance, method.order),
            n_tangents,
            row: field.row(n_tangents),
            n_registers,
            rows: vec![V::splat(0.0); n_registers + registers_of_sizes(&field, n_tangents)],
            has_sizes: false,
            method,
            field,
        }
    }

    /// Size of `group` in coefficient `k`: [`size_of_term`].
    #[inline(always)]
    fn norm(&self, k: usize, group: usize) -> V {
        let at = k * self.row + group * self.field.group();
        let place = (self.field.size_limits(), k, group);
        size_of_term(place, &self.rows[at..at + self.field.n_components()])
    }

    /// The same of one lane.
    pub(super) fn norm_in(&self, lane: usize, k: usize, group: usize) -> f64 {
        let at = k * self.row + group * self.field.group();
        let term = self.rows[at..at + self.field.n_components()].iter().map(|register| register.get(lane));
        size_of_term((self.field.size_limits(), k, group), &term.collect::<Vec<f64>>())
    }

    /// Cuts the series of one lane where it is no longer finite, and shortens its step where the last terms are lost.
    #[cold]
    fn rely_on_known_terms(&mut self, lane: usize, longest: &mut f64) {
        let order = self.method.order;
        let groups = 0..=self.n_tangents;
        if self.rows[self.row..2 * self.row].iter().all(|register| register.get(lane) == 0.0) {
            return; // an equilibrium or an empty slot: all terms vanish
        }
        let finite = match longest.is_nan() {
            true => groups.clone().map(|group| finite_order(order, |k| self.norm_in(lane, k, group))).min(),
            false => None,
        };
        let finite = finite.unwrap_or(order);
        if finite < FEWEST.min(order) || !groups.clone().all(|group| self.norm_in(lane, 0, group).is_finite()) {
            return;
        }
        if finite < order {
            *longest = self.longest_of_momentum(lane, finite);
            for register in &mut self.rows[(finite + 1) * self.row..(order + 1) * self.row] {
                register.set(lane, 0.0);
            }
        }
        for group in groups {
            let step = longest_step(order, finite, self.method.tolerance, |k| self.norm_in(lane, k, group));
            *longest = longest.min(step.unwrap_or(f64::INFINITY));
        }
    }

    /// The longest step that the momentum of time allows in one lane, by its terms up to an order.
    fn longest_of_momentum(&self, lane: usize, order: usize) -> f64 {
        let Some(at) = momentum_of_time(self.field.size_limits()) else { return f64::INFINITY };
        let terms: Vec<f64> = (0..=order).map(|k| self.rows[k * self.row + at].get(lane)).collect();
        let mut logarithm = f64::INFINITY;
        OwnSeries { rows: &terms, row: 1, at: 0, order }.shorten(&mut logarithm, self.method.tolerance);
        exp2_estimate(logarithm)
    }

    /// Advances every lane by its own step, from a group on.
    pub(super) fn sum(&mut self, sizes: &[f64], first_group: usize) {
        let sum = Sum { place: TermSizes::of(self), first_group };
        if sum.place.end() <= self.rows.len() {
            self.rows[self.n_registers].as_scalars_mut().copy_from_slice(sizes);
            if self.field.run_compiled(&sum, &mut self.rows) {
                return;
            }
        }
        V::outline(Advance { block: self, sizes, first_group });
    }

    #[inline(always)]
    fn advance_components<const M: usize>(&mut self, first: usize, step: V) -> usize {
        let mut value = [V::splat(0.0); M];
        value.copy_from_slice(&self.rows[self.method.order * self.row + first..][..M]);
        for k in (0..self.method.order).rev() {
            let coefficients = &self.rows[k * self.row + first..][..M];
            for i in 0..M {
                value[i] = value[i].mul_add(step, coefficients[i]);
            }
        }
        self.rows[first..first + M].copy_from_slice(&value);
        M
    }
}

/// Sum of the absolute values of some components; not finite if one of them is not.
#[inline(always)]
pub(super) fn sum_of_sizes<V: Lane>(components: &[V]) -> V {
    let mut sum = components[0].abs();
    for component in &components[1..] {
        sum = sum.add(component.abs());
    }
    sum
}

/// How many components count, all but the last ones whose limit is zero: see [`Field::size_limits`].
pub(super) fn n_measured(limits: &[f64], n: usize) -> usize {
    n - limits.iter().rev().take_while(|&&limit| limit == 0.0).count()
}

/// The size of a state that tolerances are relative to: the sum of the absolute values of its components, each at most its limit; not
/// finite if one of them is not.
#[inline(always)]
pub(super) fn size_of_state<V: Lane>(limits: &[f64], state: &[V]) -> V {
    if limits.is_empty() {
        return sum_of_sizes(state);
    }
    let n = n_measured(limits, state.len());
    let mut sum = V::splat(0.0);
    for (component, &limit) in state[..n].iter().zip(limits) {
        let (size, most) = (component.abs(), V::splat(limit));
        // the smaller of both, without a comparison; NaN of what is not finite
        let least =
            if limit == f64::INFINITY { size } else { size.add(most).sub(size.sub(most).abs()).mul(V::splat(0.5)) };
        sum = sum.add(least);
    }
    with_defects(sum, &state[n..])
}

/// The size of the coefficient `k` of a group: of the state itself [`size_of_state`], of its other coefficients the sum of the absolute
/// values of the components that count, of tangent vectors of all; not finite if one of them is not.
#[inline(always)]
fn size_of_term<V: Lane>((limits, k, group): (&[f64], usize, usize), term: &[V]) -> V {
    let n = n_measured(limits, term.len());
    match (k, group) {
        (0, 0) => size_of_state(limits, term),
        (_, 0) => with_defects(sum_of_sizes(&term[..n]), &term[n..]),
        _ => sum_of_sizes(term),
    }
}

/// The sum, NaN where one of the components that do not count is not finite.
#[inline(always)]
fn with_defects<V: Lane>(mut sum: V, uncounted: &[V]) -> V {
    for component in uncounted {
        sum = component.abs().mul_add(V::splat(0.0), sum);
    }
    sum
}

/// The power series, from its first coefficients.
struct Expansion<'b, F, V>(&'b mut TaylorBlock<F, V>);

impl<F: Field, V: Wide> Body for Expansion<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        let TaylorBlock { field, method, n_tangents, rows, n_registers, .. } = self.0;
        field.expand(&mut rows[..*n_registers], *n_tangents, method.order);
    }
}

/// For each lane the longest step for which each of the last two terms of the series of the state, and of every
/// tangent vector, stays below the tolerance; less where the terms before them foretell larger ones ([`Trend`]); NaN where
/// one of them is not finite.
///
/// Tangent vectors have a say because the state alone does not see the linear flow about it: at an equilibrium its
/// own series allows any step.
struct Steps<'b, F, V> {
    block: &'b TaylorBlock<F, V>,
    /// How far each lane has to go: zero where there is no trajectory.
    ahead: &'b [f64],
    sizes: &'b mut [f64],
    /// Whether a last term may be lost, or is beyond the range of numbers, in any lane with a trajectory.
    is_out_of_range: &'b mut bool,
}

impl<F: Field, V: Wide> Body for Steps<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Steps { block, ahead, sizes, is_out_of_range } = self;
        let order = block.method.order;
        // registers, since the number of their lanes is known when this is compiled
        let (mut logarithm, mut remaining, mut are_in_range) = (V::splat(f64::INFINITY), V::splat(0.0), true);
        remaining.as_scalars_mut().copy_from_slice(&ahead[..V::WIDTH]);
        for group in 0..=block.n_tangents {
            let [size, last, before] = [0, order, order - 1].map(|k| block.size(k, group));
            // Each coefficient enters the next, so the first and the highest tell of all; zero times infinity is NaN.
            let defect = size.add(last).mul(V::splat(0.0));
            let allowed = logarithms(size.mul(V::splat(block.method.tolerance)));
            logarithm = logarithm.add(defect);
            shorten(logarithm.as_scalars_mut(), allowed.as_scalars(), last.as_scalars(), order);
            shorten(logarithm.as_scalars_mut(), allowed.as_scalars(), before.as_scalars(), order - 1);
            let terms = last.as_scalars().iter().zip(before.as_scalars());
            for ((&last, &before), &remaining) in terms.zip(remaining.as_scalars()) {
                are_in_range &= (is_in_range(last) & is_in_range(before)) | (remaining == 0.0);
            }
        }
        if let Some(at) = momentum_of_time(block.field.size_limits()) {
            OwnSeries { rows: &block.rows, row: block.row, at, order }.shorten(&mut logarithm, block.method.tolerance);
        }
        *is_out_of_range = !are_in_range;
        let step = steps_by_trend([&block.trend; 2], block.n_tangents, logarithm, block);
        sizes[..V::WIDTH].copy_from_slice(step.as_scalars());
    }
}

/// The steps with these logarithms, shortened where the terms before the last two foretell larger ones; by the trends of the state and of
/// tangent vectors.
#[inline(always)]
fn steps_by_trend<V: Lane<Number = f64>>(
    trends: [&Trend; 2],
    n_tangents: usize,
    mut logarithm: V,
    terms: &impl Terms<V>,
) -> V {
    let step = powers(logarithm);
    let mut suspicious = false;
    for group in 0..=n_tangents {
        suspicious |= trends[usize::from(group > 0)].suspects(step, terms, group);
    }
    if suspicious {
        for group in 0..=n_tangents {
            trends[usize::from(group > 0)].shorten(logarithm.as_scalars_mut(), terms, group);
        }
        return powers(logarithm);
    }
    step
}

/// The logarithm in each lane.
#[inline(always)]
fn logarithms<V: Lane<Number = f64>>(mut x: V) -> V {
    for x in x.as_scalars_mut() {
        *x = log2_estimate(*x);
    }
    x
}

/// The power of two in each lane.
#[inline(always)]
fn powers<V: Lane<Number = f64>>(mut x: V) -> V {
    for x in x.as_scalars_mut() {
        *x = exp2_estimate(*x);
    }
    x
}

/// The logarithm of each size, at most that for which the logarithm of `term size^power` is `allowed`; NaN stays.
#[inline(always)]
fn shorten(sizes: &mut [f64], allowed: &[f64], terms: &[f64], power: usize) {
    for ((size, &allowed), &term) in sizes.iter_mut().zip(allowed).zip(terms) {
        let bound = (allowed - log2_estimate(term)) / power as f64;
        let bound = if term > 0.0 { bound } else { f64::INFINITY };
        *size = if bound < *size { bound } else { *size };
    }
}

/// Advances every lane by its own step: Horner's rule, several components at once to hide the latency of each.
struct Advance<'b, F, V> {
    block: &'b mut TaylorBlock<F, V>,
    sizes: &'b [f64],
    /// The state, group 0, may be known already.
    first_group: usize,
}

impl<F: Field, V: Wide> Body for Advance<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Advance { block, sizes, first_group } = self;
        let mut step = V::splat(0.0);
        step.as_scalars_mut().copy_from_slice(sizes);
        let (components, group) = (block.field.n_components(), block.field.group());
        for first in (first_group * group..block.row).step_by(group) {
            let (mut i, end) = (first, first + components);
            while i < end {
                i += match end - i {
                    12.. => block.advance_components::<12>(i, step),
                    9.. => block.advance_components::<9>(i, step),
                    4.. => block.advance_components::<4>(i, step),
                    _ => block.advance_components::<1>(i, step),
                };
            }
        }
    }
}

/// The sizes of the terms of a series.
///
/// A trait, since what is compiled for wide registers has to be inlined, and a closure cannot be told to be.
pub(super) trait Terms<V> {
    /// Sum of the absolute values of the components of order `k` of a group.
    fn size(&self, k: usize, group: usize) -> V;
}

impl<F: Field, V: Wide> Terms<V> for TaylorBlock<F, V> {
    #[inline(always)]
    fn size(&self, k: usize, group: usize) -> V {
        if self.has_sizes { self.rows[TermSizes::of(self).at(k, group)] } else { self.norm(k, group) }
    }
}

/// Registers behind the series for [`TermSizes`], and for the step of a [`Sum`].
pub(super) fn registers_of_sizes<F: Field>(_field: &F, n_tangents: usize) -> usize {
    if F::IS_COMPILED { TermSizes::COUNT * (1 + n_tangents) } else { 0 }
}

/// The sizes of the terms that the step depends on, those of order 0 and the last eight, as straight code: put behind the series.
struct TermSizes {
    n_registers: usize,
    n_components: usize,
    group: usize,
    row: usize,
    order: usize,
}

impl TermSizes {
    /// Registers behind the series for each group.
    const COUNT: usize = 9;

    #[inline(always)]
    fn of<F: Field, V>(block: &TaylorBlock<F, V>) -> TermSizes {
        let &TaylorBlock { ref field, ref method, row, n_registers, .. } = block;
        TermSizes { n_registers, n_components: field.n_components(), group: field.group(), row, order: method.order }
    }

    #[inline(always)]
    fn lowest(&self) -> usize {
        self.order.saturating_sub(7).max(1)
    }

    /// The register of a size.
    #[inline(always)]
    fn at(&self, k: usize, group: usize) -> usize {
        self.n_registers + group * TermSizes::COUNT + if k == 0 { 0 } else { k + 1 - self.lowest() }
    }

    #[inline(always)]
    fn end(&self) -> usize {
        self.n_registers + self.row / self.group * TermSizes::COUNT
    }
}

/// The computation of these sizes, beside the limits of components.
struct SizesOfTerms<'a>(TermSizes, &'a [f64]);

impl Straight for SizesOfTerms<'_> {
    fn key(&self) -> u64 {
        6 << 32 | (self.0.row as u64) << 8 | self.0.order as u64
    }

    fn n_rates(&self) -> usize {
        1
    }

    #[inline(always)]
    fn run<V: Lane>(&self, memory: &mut [V]) {
        let SizesOfTerms(place, limits) = self;
        for group in 0..place.row / place.group {
            for k in std::iter::once(0).chain(place.lowest()..=place.order) {
                let at = k * place.row + group * place.group;
                memory[place.at(k, group)] = size_of_term((limits, k, group), &memory[at..at + place.n_components]);
            }
        }
    }
}

/// The sum of the series from a group on, as straight code: Horner's rule. The first register behind the series has the steps.
struct Sum {
    place: TermSizes,
    first_group: usize,
}

impl Straight for Sum {
    fn key(&self) -> u64 {
        (2 + u64::from(self.first_group > 0)) << 32 | (self.place.row as u64) << 8 | self.place.order as u64
    }

    fn n_rates(&self) -> usize {
        0
    }

    #[inline(always)]
    fn run<V: Lane>(&self, memory: &mut [V]) {
        let TermSizes { n_registers, n_components, group, row, order, .. } = self.place;
        let step = memory[n_registers];
        for first in (self.first_group * group..row).step_by(group) {
            for i in first..first + n_components {
                let mut value = memory[order * row + i];
                for k in (0..order).rev() {
                    value = value.mul_add(step, memory[k * row + i]);
                }
                memory[i] = value;
            }
        }
    }
}

/// What terms of lower order foretell of the last ones, if they all decay alike: with the last two, the last eight are looked at.
///
/// The last two vanish together where a solution has a symmetry: on planar orbits of the twisted top only every sixth order
/// of a component differs from zero, and of all components together every second or third. The step would be unlimited.
///
/// `|c_k| = |c_0| rho^-k` allows a step of `rho tol^(1/(N-1))`. Such a forecast does not see a factor in front of `rho^-k`, so a
/// step that the last terms allow is shortened only where it is longer by more than a factor of a million would explain.
#[derive(Clone, Debug)]
pub(super) struct Trend {
    order: usize,
    tolerance: f64,
    /// Power of the term, and the size up to which it is beyond suspicion, in units of the first.
    limits: Vec<(usize, f64)>,
}

impl Trend {
    pub(super) fn new(tolerance: f64, order: usize) -> Trend {
        let mut trend = Trend { order, tolerance, limits: vec![] };
        let powers = order.saturating_sub(7).max(1)..=order.saturating_sub(2);
        // The suspicion is a little wider than the verdict, so that whom it spares the verdict would spare, too: what a
        // lane does must not depend on its neighbours.
        const CAUTION: f64 = 0.01;
        trend.limits = powers.map(|k| (k, libm::exp2(k as f64 * (trend.longest(k) - CAUTION)))).collect();
        trend
    }

    /// Logarithm of the longest step that a term of order `k` lets pass, in units of `(|c_0| / |c_k|)^(1/k)`.
    #[inline(always)]
    fn longest(&self, power: usize) -> f64 {
        const LOG2_OF_A_MILLION: f64 = 20.0;
        const FLUCTUATION: f64 = 0.1;
        self.allowed() + FLUCTUATION + LOG2_OF_A_MILLION * (1.0 / power as f64 - 1.0 / self.order as f64)
    }

    /// Logarithm of the step that the forecast allows, in these units.
    #[inline(always)]
    fn allowed(&self) -> f64 {
        log2_estimate(self.tolerance) / (self.order as f64 - 1.0)
    }

    /// Whether a step is under suspicion in any lane, given the sizes of the terms; a few operations for each.
    #[inline(always)]
    pub(super) fn suspects<V: Lane>(&self, step: V, terms: &impl Terms<V>, group: usize) -> bool {
        let start = terms.size(0, group);
        let Some(&(lowest, _)) = self.limits.first() else { return false };
        let mut power = V::splat(1.0);
        for _ in 0..lowest {
            power = power.mul(step);
        }
        let mut suspicious = false;
        for &(k, limit) in &self.limits {
            let excess = start.neg_mul_add(V::splat(limit), terms.size(k, group).mul(power));
            for &lane in excess.as_scalars() {
                suspicious |= lane.to_f64() > 0.0;
            }
            power = power.mul(step);
        }
        suspicious
    }

    /// Shortens the logarithms of steps.
    #[inline(always)]
    pub(super) fn shorten<V: Lane<Number = f64>>(&self, steps: &mut [f64], terms: &impl Terms<V>, group: usize) {
        let start = terms.size(0, group);
        for &(k, _) in &self.limits {
            let (term, allowed, longest) = (terms.size(k, group), self.allowed(), self.longest(k));
            for ((step, &start), &term) in steps.iter_mut().zip(start.as_scalars()).zip(term.as_scalars()) {
                let unit = (log2_estimate(start) - log2_estimate(term)) / k as f64;
                if term > 0.0 && *step > unit + longest {
                    *step = unit + allowed;
                }
            }
        }
    }
}

/// Sizes of one group of all lanes.
struct Norms<'b, F, V> {
    block: &'b TaylorBlock<F, V>,
    group: usize,
    norms: &'b mut [f64],
}

impl<F: Field, V: Wide> Body for Norms<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        self.norms.copy_from_slice(self.block.norm(0, self.group).as_scalars());
    }
}

/// One group of one lane, some time after the start of the step.
struct Evaluation<'b, F, V> {
    block: &'b TaylorBlock<F, V>,
    lane: usize,
    group: usize,
    tau: f64,
    values: &'b mut [f64],
}

impl<F: Field, V: Wide> Body for Evaluation<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Evaluation { block, lane, group, tau, values } = self;
        let scalars = as_scalars(&block.rows);
        let (stride, at) = (block.row * V::WIDTH, group * block.field.group() * V::WIDTH + lane);
        for (i, value) in values.iter_mut().enumerate() {
            *value = scalars[block.method.order * stride + at + i * V::WIDTH];
        }
        for k in (0..block.method.order).rev() {
            let row = &scalars[k * stride + at..];
            for (i, value) in values.iter_mut().enumerate() {
                *value = value.multiply_add(tau, row[i * V::WIDTH]);
            }
        }
    }
}
