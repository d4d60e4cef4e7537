//! The variational system: trajectories with their tangent vectors as one state, and linear combinations of its rates.

use crate::field::{Field, Point};
use crate::lanes::{Body, Lane, Number};
use crate::method::taylor::sum_of_sizes;

/// Position and factor of one summand of a linear combination.
pub(super) type Term = (usize, f64);

/// `x' = f(x)`, `v' = Df(x) v` for every tangent vector `v`.
///
/// States and rates lie group after group, components only; one of either is a *row*.
pub(super) struct Variational<'f, F, V> {
    pub(super) field: &'f F,
    pub(super) n_tangents: usize,
    /// The present values.
    pub(super) state: Vec<V>,
    /// What rounding took from the state; empty where that is not followed.
    low: Vec<V>,
    /// Both at the start of the step.
    pub(super) start: Vec<V>,
    start_low: Vec<V>,
    /// Values at a stage of the step.
    beside: Vec<V>,
    /// Where the field computes.
    work: Vec<V>,
}

impl<'f, F: Field, V: Lane> Variational<'f, F, V> {
    /// At rest at the origin; `compensated` says whether what rounding takes from the state is followed.
    pub(super) fn new(field: &'f F, n_tangents: usize, compensated: bool) -> Self {
        let zeros = |count: usize| vec![V::splat(0.0); count];
        let (row, n_low) =
            (field.n_components() * (1 + n_tangents), if compensated { field.n_components() } else { 0 });
        Variational {
            field,
            n_tangents,
            state: zeros(row),
            low: zeros(n_low),
            start: zeros(row),
            start_low: zeros(n_low),
            beside: zeros(row),
            work: zeros(field.registers(n_tangents, 1)),
        }
    }

    /// Remembers the present values as those at the start of a step.
    #[inline(always)]
    pub(super) fn remember(&mut self) {
        self.start.copy_from_slice(&self.state);
        self.start_low.copy_from_slice(&self.low);
    }

    /// Brings one lane back to where it was.
    #[inline(always)]
    pub(super) fn restore(&mut self, lane: usize) {
        copy_lane(&self.start, &mut self.state, lane);
        copy_lane(&self.start_low, &mut self.low, lane);
    }

    /// Adds `step sum_j a_j k_j` to the state and the tangent vectors, where `k_j` are rows of `rates`.
    #[inline(always)]
    pub(super) fn update(&mut self, step: V, terms: &[Term], rates: &[V]) {
        let (row, n) = (self.row(), self.low.len());
        let (compensated, rest) = self.state.split_at_mut(n);
        let (low, sum) = (&mut self.low, |first: usize| Sum { terms, known: &rates[first..], row });
        in_chunks::<V>(n, &mut CompensatedUpdate { state: compensated, low, step, sum: sum(0) });
        in_chunks::<V>(row - n, &mut Update { state: rest, step, sum: sum(n) });
    }

    /// Registers of [`Variational::write`].
    pub(super) fn n_values(&self) -> usize {
        self.state.len() + self.low.len()
    }

    /// Writes the present values, and what rounding took from them.
    #[inline(always)]
    pub(super) fn write(&self, to: &mut [V]) {
        let (state, low) = to.split_at_mut(self.state.len());
        state.copy_from_slice(&self.state);
        low.copy_from_slice(&self.low);
    }

    /// Reads them back.
    #[inline(always)]
    pub(super) fn read_back(&mut self, from: &[V]) {
        let (state, low) = from.split_at(self.state.len());
        self.state.copy_from_slice(state);
        self.low.copy_from_slice(low);
    }

    /// Registers in a row.
    #[inline(always)]
    pub(super) fn row(&self) -> usize {
        self.state.len()
    }

    /// Registers in a group.
    #[inline(always)]
    pub(super) fn n_components(&self) -> usize {
        self.field.n_components()
    }

    /// The state and every tangent vector: where their registers are in a row.
    #[inline(always)]
    pub(super) fn groups(&self) -> impl Iterator<Item = std::ops::Range<usize>> + use<F, V> {
        let n = self.field.n_components();
        (0..=self.n_tangents).map(move |group| group * n..(group + 1) * n)
    }

    /// [`Field::size_limits`] of the state, group 0; none of tangent vectors.
    #[inline(always)]
    pub(super) fn size_limits(&self, group: usize) -> &[f64] {
        if group == 0 { self.field.size_limits() } else { &[] }
    }

    pub(super) fn load(&mut self, lane: usize, group: usize, values: &[f64]) {
        let at = group * self.n_components();
        for (register, &value) in self.state[at..].iter_mut().zip(values) {
            register.set(lane, value);
        }
        if group == 0 {
            self.low.iter_mut().for_each(|register| register.set(lane, 0.0));
        }
    }

    pub(super) fn read(&self, lane: usize, group: usize, values: &mut [f64]) {
        let at = group * self.n_components();
        for (register, value) in self.state[at..].iter().zip(values) {
            *value = register.get(lane);
        }
    }

    /// For each lane the sum of the absolute values of the components of one group.
    pub(super) fn norms(&self, group: usize, norms: &mut [f64]) {
        let n = self.n_components();
        V::outline(Norms { group: &self.state[group * n..(group + 1) * n], norms });
    }

    /// Multiplies one group of one lane by a power of two, in some rows.
    pub(super) fn scale(n: usize, rows: &mut [V], row: usize, (lane, group): (usize, usize), exponent: i32) {
        for row in rows.chunks_exact_mut(row) {
            for register in &mut row[group * n..(group + 1) * n] {
                register.set(lane, libm::scalbn(register.get(lane), exponent));
            }
        }
    }

    /// The rates at the present values.
    pub(super) fn rates(&mut self, rates: &mut [V]) {
        let Variational { field, n_tangents, state, work, .. } = self;
        V::outline(Rates { field: *field, n_tangents: *n_tangents, x: state, work, rates });
    }

    /// The rates at `state + step sum_j a_j k_j`, where `k_j` are rows of `known`.
    #[inline(always)]
    pub(super) fn rates_beside(&mut self, step: V, terms: &[Term], known: &[V], rates: &mut [V]) {
        let row = self.row();
        let Variational { field, n_tangents, state, beside, work, .. } = self;
        let point = Beside { state, step, sum: Sum { terms, known, row } };
        field.rates_at(&point, *n_tangents, beside, work, rates);
    }
}

/// The field at one point: a function of its own, because a tape is much code.
struct Rates<'a, F, V> {
    field: &'a F,
    n_tangents: usize,
    x: &'a [V],
    work: &'a mut [V],
    rates: &'a mut [V],
}

impl<F: Field, V: Lane> Body for Rates<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        self.field.rates(self.x, self.n_tangents, self.work, self.rates);
    }
}

struct Norms<'a, V> {
    group: &'a [V],
    norms: &'a mut [f64],
}

impl<V: Lane> Body for Norms<'_, V> {
    #[inline(always)]
    fn run(self) {
        for (norm, sum) in self.norms.iter_mut().zip(sum_of_sizes(self.group).as_scalars()) {
            *norm = sum.to_f64();
        }
    }
}

/// Something to be done for several components at once, so that each hides the latency of the others.
pub(super) trait Chunk {
    /// Does it for `M` components from `first` on.
    fn run<const M: usize>(&mut self, first: usize);
}

/// Runs `task` for `n` components, in chunks whose sums fit into the registers; nines are what tops are made of.
///
/// A function of its own for each register and task, whatever the field: it is compiled once.
pub(super) fn in_chunks<V: Lane>(n: usize, task: &mut impl Chunk) {
    V::outline(InChunks::<_, V> { n, task, register: std::marker::PhantomData });
}

struct InChunks<'t, T, V> {
    n: usize,
    task: &'t mut T,
    register: std::marker::PhantomData<V>,
}

impl<T: Chunk, V: Lane> Body for InChunks<'_, T, V> {
    #[inline(always)]
    fn run(self) {
        let InChunks { n, task, .. } = self;
        let mut first = 0;
        while first < n {
            let (left, many_registers) = (n - first, V::REGISTERS >= 32);
            if many_registers && left >= 18 {
                task.run::<18>(first);
                first += 18;
            } else if left.is_multiple_of(9) {
                task.run::<9>(first);
                first += 9;
            } else if left >= 4 {
                task.run::<4>(first);
                first += 4;
            } else {
                task.run::<1>(first);
                first += 1;
            }
        }
    }
}

/// `sum_j a_j k_j` over rows `k_j`.
#[derive(Clone, Copy)]
pub(super) struct Sum<'a, V> {
    pub(super) terms: &'a [Term],
    pub(super) known: &'a [V],
    pub(super) row: usize,
}

impl<V: Lane> Sum<'_, V> {
    #[inline(always)]
    pub(super) fn of<const M: usize>(&self, first: usize) -> [V; M] {
        let mut sum = [V::splat(0.0); M];
        for &(j, factor) in self.terms {
            let factor = V::splat(factor);
            let k: &[V; M] = self.known[j * self.row + first..].first_chunk().expect("a row of rates for each term");
            for i in 0..M {
                sum[i] = k[i].mul_add(factor, sum[i]);
            }
        }
        sum
    }
}

/// `state + step sum`
struct Beside<'a, V> {
    state: &'a [V],
    step: V,
    sum: Sum<'a, V>,
}

impl<V: Lane> Point<V> for Beside<'_, V> {
    #[inline(always)]
    fn components<const M: usize>(&self, first: usize) -> [V; M] {
        let mut sum = self.sum.of::<M>(first);
        let state = &self.state[first..][..M];
        for i in 0..M {
            sum[i] = sum[i].mul_add(self.step, state[i]);
        }
        sum
    }

    #[inline(always)]
    fn write(&self, to: &mut [V]) {
        in_chunks::<V>(to.len(), &mut Write { point: self, to });
    }
}

struct Write<'a, V> {
    point: &'a Beside<'a, V>,
    to: &'a mut [V],
}

impl<V: Lane> Chunk for Write<'_, V> {
    #[inline(always)]
    fn run<const M: usize>(&mut self, first: usize) {
        self.to[first..][..M].copy_from_slice(&self.point.components::<M>(first));
    }
}

/// `state += step sum`
pub(super) struct Update<'a, V> {
    pub(super) state: &'a mut [V],
    pub(super) step: V,
    pub(super) sum: Sum<'a, V>,
}

impl<V: Lane> Chunk for Update<'_, V> {
    #[inline(always)]
    fn run<const M: usize>(&mut self, first: usize) {
        let sum = self.sum.of::<M>(first);
        let state = &mut self.state[first..][..M];
        for i in 0..M {
            state[i] = sum[i].mul_add(self.step, state[i]);
        }
    }
}

/// `state += step sum`, where `low` carries what the rounded sum leaves out (Kahan's compensated summation).
struct CompensatedUpdate<'a, V> {
    state: &'a mut [V],
    low: &'a mut [V],
    step: V,
    sum: Sum<'a, V>,
}

impl<V: Lane> Chunk for CompensatedUpdate<'_, V> {
    #[inline(always)]
    fn run<const M: usize>(&mut self, first: usize) {
        let sum = self.sum.of::<M>(first);
        let (state, low) = (&mut self.state[first..][..M], &mut self.low[first..][..M]);
        for i in 0..M {
            let increment = sum[i].mul_add(self.step, low[i]);
            let new = state[i].add(increment);
            // Knuth's sum of two numbers: exact whichever is larger
            let part = new.sub(state[i]);
            low[i] = state[i].sub(new.sub(part)).add(increment.sub(part));
            state[i] = new;
        }
    }
}

/// Copies one lane of all registers.
#[inline(always)]
pub(super) fn copy_lane<V: Lane>(from: &[V], to: &mut [V], lane: usize) {
    for (to, from) in to.iter_mut().zip(from) {
        to.as_scalars_mut()[lane] = from.as_scalars()[lane];
    }
}

/// A register with the number of each lane. Lane by lane, since by way of a slice it stays in memory: 3% more instructions of a
/// splitting.
#[inline(always)]
pub(super) fn spread<V: Lane>(numbers: &[f64]) -> V {
    let mut register = V::splat(0.0);
    for (lane, &number) in numbers[..V::WIDTH].iter().enumerate() {
        register.set(lane, number);
    }
    register
}
