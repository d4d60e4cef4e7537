//! Whether the series of a step still obeys the equations along the step.
//!
//! The terms of a series say nothing about a force that is too weak to be seen where the step begins: that of `q^26` at
//! `q = 0` has no term up to order 24, that of `exp(-q)` at `q = 150` none above round-off. A series of straight motion then
//! passes through such a steep barrier, and where the force vanishes again beyond it, nothing is left of it at the end. So the
//! derivative of the series is compared with the field at nodes along the step, and the step ends before the first one at
//! which they differ.
//!
//! A force is seen from as far as it is above round-off: one that decays as `exp(-d/w)` at a distance of 25 `w`, so the nodes
//! may be much further apart than barriers are thick. How far apart they may be at all is the affair of [`StepEnd::limit`]: a step
//! is at most twice as long as the one before it, the first as the time in which the state changes by its own size.
//!
//! Nodes inside of the step are for fields with terms that hide like this, exponentials and high powers
//! ([`Tape::has_steep_barriers`]). What varies as a power of the distance, such as a pole, is seen from everywhere or is too thin
//! for any nodes; of fields that have nothing else the end of the step is looked at, and its length is not limited. Nor is anything
//! but the end of a step looked at along which exponents change too little for an exponential to come out of round-off ([`SLOW`]).
//!
//! Fields of degree two need no such look where a term vanishes exactly: a series that ends before half of its order and
//! obeys the equations up to its order is a solution.

use crate::field::{Field, Space, Straight, Tape, Terms};
use crate::lanes::{Body, Lane, Pair, ROUNDINGS, Wide};
use crate::method::taylor::{n_measured, size_of_state};

/// Passes over the nodes of one step at most; each at least halves it, or is the last one.
const MOST_PASSES: usize = 40;

/// Nodes of a step that is as long as it may grow, evenly spaced, the end among them: such a step, of a motion that is nearly
/// free, may be as long as all of the way before it.
const MANY: usize = 32;

/// Every which of them is a node of a step that its own terms limit. Of 300 random barriers, up to a hundred times thinner than the
/// motion is wide, 2 were missed with 8 nodes and steps that double, some 30 with 4; an adaptive Runge-Kutta method of order 8
/// at 1e-12 missed 9.
const EVERY: usize = 4;

/// Exponents that change by no more along a step hide nothing: `exp(2 SLOW)` times round-off, the two for `1 - tanh^2`, is less than what is
/// [`HARMLESS`].
const SLOW: f64 = 4.5;

/// The longest step, in units of the one before it.
const GROWTH: f64 = 2.0;

/// A smaller defect, relative to the state, does no harm.
const HARMLESS: f64 = 1e-12;

/// A larger defect is no round-off.
const NO_ROUND_OFF: f64 = 1e-6;

/// What the last terms of an honest series leave at most, in units of the order times the tolerance.
const HONEST: f64 = 64.0;

/// Nodes at which a step is looked at unless it is as long as it may grow, or exponents change much.
pub(super) fn n_looks(field: &Tape, order: usize) -> usize {
    if field.has_steep_powers(order) { MANY / EVERY } else { 1 }
}

/// Places to compute in, and what is known of each lane.
pub(super) struct StepEnd<V> {
    n: usize,
    work: Vec<V>,
    defects: Vec<f64>,
    /// The steps that lead to `x`.
    at: Vec<f64>,
    looks: Vec<Look>,
    /// The times of a node, one for each lane.
    nodes: Vec<f64>,
    /// The defect that is allowed at each node.
    allowed: Vec<f64>,
    errors: Errors,
    has_steep_barriers: bool,
    has_steep_powers: bool,
    /// Lanes in which nothing can hide along the step.
    are_clear: Vec<bool>,
}

/// What is known of the step of one lane.
#[derive(Clone, Copy, Default)]
struct Look {
    is_open: bool,
    /// Whether the step is as long as it may grow: the series may know nothing of what comes.
    is_free: bool,
    /// Every which node is looked at.
    every: usize,
    /// Part of the step up to which no defect was seen.
    good: f64,
    /// Part of the step at which one was seen.
    bad: f64,
    /// The longest step before the present one that no observer cut short; zero if there is none.
    last: f64,
    /// The step that was found good.
    found: f64,
}

impl<V: Wide> StepEnd<V> {
    pub(super) fn new(field: &Tape, order: usize, tolerance: f64) -> Self {
        let allowed = |node: usize| {
            let truncation =
                HONEST * order as f64 * tolerance * libm::pow(node as f64 / MANY as f64, order as f64 - 1.0);
            truncation.max(HARMLESS)
        };
        StepEnd {
            n: field.n_components(),
            work: vec![V::splat(0.0); field.registers(0, 1)],
            defects: vec![0.0; V::WIDTH],
            at: vec![f64::NAN; V::WIDTH],
            looks: vec![Look::default(); V::WIDTH],
            nodes: vec![0.0; V::WIDTH],
            allowed: (1..=MANY).map(allowed).collect(),
            errors: Errors::default(),
            has_steep_barriers: field.has_steep_barriers(order),
            has_steep_powers: field.has_steep_powers(order),
            are_clear: vec![!field.has_steep_barriers(order); V::WIDTH],
        }
    }

    /// Whether these steps were looked at last: the states after them are known ([`states_at`]).
    pub(super) fn knows_states_after(&self, steps: &[f64]) -> bool {
        self.at == steps
    }

    /// Forgets the steps of a lane.
    pub(super) fn forget(&mut self, lane: usize) {
        self.looks[lane] = Look::default();
    }

    /// Keeps the longest steps to what the steps before them allow; `first` is the time in which the state of a lane changes
    /// by its own size.
    pub(super) fn limit(&mut self, longest: &mut [f64], first: impl Fn(usize) -> f64) {
        if !self.has_steep_barriers {
            return;
        }
        for (lane, (look, longest)) in self.looks.iter_mut().zip(longest).enumerate() {
            let bound = if look.last > 0.0 { GROWTH * look.last } else { first(lane) };
            look.is_free = bound < *longest;
            if look.is_free {
                *longest = bound;
            }
        }
    }

    /// Remembers the steps that are taken.
    pub(super) fn take(&mut self, steps: &[f64]) {
        for (look, &step) in self.looks.iter_mut().zip(steps).filter(|(_, step)| **step != 0.0) {
            let was_cut = step.abs() < look.found.abs();
            look.last = if was_cut { look.last.max(step.abs()) } else { step.abs() };
        }
    }

    /// Shortens the steps, one for each lane and zero for one that stays, along which the series fails the equations.
    ///
    /// `memory` holds the coefficients from order 0 to `order`, `row` registers each, those of the state first, and in the end room
    /// for [`look_registers`].
    pub(super) fn keep_to_the_field(
        &mut self,
        field: &Tape,
        memory: &mut [V],
        (row, order): (usize, usize),
        steps: &mut [f64],
    ) {
        for (look, &step) in self.looks.iter_mut().zip(steps.iter()) {
            look.is_open = step != 0.0 && step.is_finite();
        }
        if self.has_steep_barriers && !self.has_steep_powers {
            let (changes, are_clear) = (ChangesOfExponents { field, row, order }, &mut self.are_clear[..]);
            V::outline(ClearLanes { changes, memory, steps, are_clear });
        }
        for (look, is_clear) in self.looks.iter_mut().zip(&self.are_clear) {
            look.every = match (is_clear, look.is_free) {
                (true, _) => MANY,
                (false, false) => EVERY,
                (false, true) => 1,
            };
        }
        let mut nodes = std::mem::take(&mut self.nodes);
        let mut are_good = false;
        match self.stride() {
            EVERY => V::outline(CommonNodes { field, memory, row, order, steps, are_good: &mut are_good, to: self }),
            MANY if self.looks.iter().any(|look| look.is_open) => {
                V::outline(Defects { field, memory, row, order, steps, part: 1.0, to: self });
                let is_good = |(look, &defect): (&Look, &f64)| !look.is_open || defect <= self.allowed[MANY - 1];
                are_good = self.looks.iter().zip(&self.defects).all(is_good);
            }
            _ => {}
        }
        let passes = if are_good { 0 } else { MOST_PASSES };
        for _ in 0..passes {
            if !self.looks.iter().any(|look| look.is_open) {
                break;
            }
            for look in &mut self.looks {
                (look.good, look.bad) = (0.0, 0.0);
            }
            let stride = self.stride();
            for node in (stride..=MANY).step_by(stride) {
                let part = node as f64 / MANY as f64;
                for (node, step) in nodes.iter_mut().zip(steps.iter()) {
                    *node = part * step;
                }
                V::outline(Defects { field, memory, row, order, steps: &nodes, part, to: self });
                for lane in 0..V::WIDTH {
                    let look = &self.looks[lane];
                    if !(look.is_open && look.bad == 0.0 && node.is_multiple_of(look.every)) {
                        continue;
                    }
                    let (defect, allowed) = (self.defects[lane], self.allowed[node - 1]);
                    let is_good = defect <= allowed
                        || defect < NO_ROUND_OFF
                            && self.excess(field, memory, (row, order), lane, (nodes[lane], steps[lane])) <= allowed;
                    *(if is_good { &mut self.looks[lane].good } else { &mut self.looks[lane].bad }) = part;
                }
                if !self.looks.iter().any(|look| look.is_open && look.bad == 0.0) {
                    break;
                }
            }
            for (look, step) in self.looks.iter_mut().zip(steps.iter_mut()).filter(|(look, _)| look.is_open) {
                look.is_open = look.bad > 0.0 && look.good == 0.0;
                if look.bad > 0.0 {
                    *step *= if look.good > 0.0 { look.good } else { look.bad.min(0.5) };
                }
            }
        }
        for (look, &step) in self.looks.iter_mut().zip(steps.iter()) {
            look.found = step;
        }
        self.nodes = nodes;
    }

    /// Every which node has to be looked at for some lane.
    fn stride(&self) -> usize {
        self.looks.iter().filter(|look| look.is_open).map(|look| look.every).fold(MANY, usize::min)
    }

    /// The defect of one lane at the node that was looked at last, less what round-off explains.
    #[cold]
    fn excess(
        &mut self,
        field: &Tape,
        rows: &[V],
        (row, order): (usize, usize),
        lane: usize,
        (node, step): (f64, f64),
    ) -> f64 {
        let Errors { start, x, state, slope, terms } = &mut self.errors;
        let n = self.n;
        let (values, slopes) = rows[states_at(field, rows.len())..].split_at(n);
        let (slopes, rates) = slopes.split_at(n);
        start.clear();
        start.extend(rows[..n].iter().map(|x| x.get(lane)));
        x.clear();
        x.extend(values.iter().map(|x| x.get(lane)));
        state.clear();
        state.resize(n, 0.0);
        slope.clear();
        slope.resize(n, 0.0);
        for k in (0..=order).rev() {
            for i in 0..n {
                slope[i] = slope[i].mul_add(node.abs(), state[i]);
                state[i] = state[i].mul_add(node.abs(), rows[k * row + i].get(lane).abs());
            }
        }
        for sum in state.iter_mut().chain(slope.iter_mut()) {
            *sum *= UNIT;
        }
        field.round_off(start, None, terms);
        for (slope, error) in slope.iter_mut().zip(&terms.linear) {
            *slope += error;
        }
        field.round_off(x, Some(state), terms);
        let size: f64 = start.iter().map(|x| x.abs()).sum();
        let mut excess = 0.0;
        for i in 0..n {
            let defect = (slopes[i].get(lane) - rates[i].get(lane)).abs();
            excess += (defect - slope[i] - terms.linear[i]).max(0.0);
        }
        excess * step.abs() / size
    }
}

/// Relative error of a sum of the terms of a series: each coefficient, each product and each sum is rounded.
const UNIT: f64 = 4.0 * ROUNDINGS * f64::EPSILON;

/// Places to bound round-off in.
#[derive(Default)]
struct Errors {
    start: Vec<f64>,
    x: Vec<f64>,
    state: Vec<f64>,
    slope: Vec<f64>,
    terms: Terms,
}

/// Registers behind the series for a look at two nodes: the steps to them, what [`look`] finds at the second, and the defect of the
/// first. A look at one node has the first step alone.
pub(super) fn look_registers(field: &Tape) -> usize {
    3 * field.n_components() + 5
}

/// Where, in a memory of so many registers, the states are that a look has led to; what else it has found follows.
pub(super) fn states_at(field: &Tape, registers: usize) -> usize {
    registers - look_registers(field) + 2
}

/// Looks at a node: the state, its slope by the series and by the field, the sum of `|x'(h) - f(x(h))| |h|` over the components, and
/// the size of the state at the start; into `found` in this order.
#[inline(always)]
fn look<V: Lane>(field: &Tape, rows: &[V], (row, order): (usize, usize), step: V, work: &mut [V], found: &mut [V]) {
    let n = field.n_components();
    let (x, rest) = found.split_at_mut(n);
    let (slope, rest) = rest.split_at_mut(n);
    let (rates, sums) = rest.split_at_mut(n);
    let (mut i, place) = (0, (row, order));
    while i < n {
        i += match n - i {
            6.. => expand::<V, 6>(i, rows, place, step, x, slope),
            4 => expand::<V, 4>(i, rows, place, step, x, slope),
            3.. => expand::<V, 3>(i, rows, place, step, x, slope),
            2 => expand::<V, 2>(i, rows, place, step, x, slope),
            _ => expand::<V, 1>(i, rows, place, step, x, slope),
        };
    }
    field.rates(x, 0, work, rates);
    sums[0] = V::splat(0.0);
    for i in 0..n_measured(field.size_limits(), n) {
        sums[0] = sums[0].add(slope[i].sub(rates[i]).mul(step).abs());
    }
    sums[1] = size_of_state(field.size_limits(), &rows[..n]);
}

/// The values of some components and their slopes after the step, by Horner's rule; as many as were computed.
#[inline(always)]
fn expand<V: Lane, const M: usize>(
    first: usize,
    rows: &[V],
    (row, order): (usize, usize),
    step: V,
    x: &mut [V],
    slopes: &mut [V],
) -> usize {
    let (mut value, mut slope) = ([V::splat(0.0); M], [V::splat(0.0); M]);
    value.copy_from_slice(&rows[order * row + first..][..M]);
    for k in (0..order).rev() {
        let coefficients = &rows[k * row + first..][..M];
        for i in 0..M {
            slope[i] = slope[i].mul_add(step, value[i]);
            value[i] = value[i].mul_add(step, coefficients[i]);
        }
    }
    x[first..first + M].copy_from_slice(&value);
    slopes[first..first + M].copy_from_slice(&slope);
    M
}

/// [`look`] as straight code on a memory with the series and, in the end, room for the look.
struct NodeLook<'f> {
    field: &'f Tape,
    row: usize,
    order: usize,
}

impl Straight for NodeLook<'_> {
    fn key(&self) -> u64 {
        1 << 32 | (self.row as u64) << 8 | self.order as u64
    }

    fn n_rates(&self) -> usize {
        1
    }

    #[inline(always)]
    fn run<V: Lane>(&self, memory: &mut [V]) {
        let NodeLook { field, row, order } = *self;
        let (rows, room) = memory.split_at_mut(memory.len() - look_registers(field));
        let mut work = vec![V::splat(0.0); field.registers(0, 1)];
        let (steps, found) = room.split_at_mut(2);
        look(field, rows, (row, order), steps[0], &mut work, &mut found[..3 * field.n_components() + 2]);
    }
}

/// The same at two nodes: operations on both side by side, so that neither waits for the other.
struct TwoNodes<'f> {
    field: &'f Tape,
    row: usize,
    order: usize,
}

impl Straight for TwoNodes<'_> {
    fn key(&self) -> u64 {
        4 << 32 | (self.row as u64) << 8 | self.order as u64
    }

    fn n_rates(&self) -> usize {
        2
    }

    #[inline(always)]
    fn run<V: Lane>(&self, memory: &mut [V]) {
        let TwoNodes { field, row, order } = *self;
        let (rows, room) = memory.split_at_mut(memory.len() - look_registers(field));
        let (n, zero) = (field.n_components(), Pair::new([V::splat(0.0); 2]));
        let both: Vec<Pair<V>> =
            rows.chunks(row).take(order + 1).flat_map(|row| &row[..n]).map(|&c| Pair::new([c; 2])).collect();
        let (mut work, mut found) = (vec![zero; field.registers(0, 1)], vec![zero; 3 * n + 2]);
        look(field, &both, (n, order), Pair::new([room[0], room[1]]), &mut work, &mut found);
        for (to, found) in room[2..].iter_mut().zip(&found) {
            *to = found.registers()[1];
        }
        room[3 * n + 4] = found[3 * n].registers()[0];
    }
}

/// Finds the lanes in which exponents change too little for anything to hide.
struct ClearLanes<'a, V> {
    changes: ChangesOfExponents<'a>,
    memory: &'a mut [V],
    steps: &'a [f64],
    are_clear: &'a mut [bool],
}

impl<V: Wide> Body for ClearLanes<'_, V> {
    #[inline(always)]
    fn run(self) {
        let ClearLanes { changes, memory, steps, are_clear } = self;
        let (field, room) = (changes.field, memory.len() - look_registers(changes.field));
        memory[room].as_scalars_mut().copy_from_slice(&steps[..V::WIDTH]);
        if !field.run_compiled(&changes, memory) {
            changes.run(memory);
        }
        let limit = SLOW / field.n_exponentials();
        for (is_clear, &square) in are_clear.iter_mut().zip(memory[room + 1].as_scalars()) {
            *is_clear = square <= limit * limit;
        }
    }
}

/// [`Tape::square_of_changes`] as straight code on a memory with the series and, in the end, room for the look: from the steps in the
/// first register of that into the second.
struct ChangesOfExponents<'f> {
    field: &'f Tape,
    row: usize,
    order: usize,
}

impl Straight for ChangesOfExponents<'_> {
    fn key(&self) -> u64 {
        5 << 32 | (self.row as u64) << 8 | self.order as u64
    }

    fn n_rates(&self) -> usize {
        1
    }

    #[inline(always)]
    fn run<V: Lane>(&self, memory: &mut [V]) {
        let ChangesOfExponents { field, row, order } = *self;
        let (n_tangents, room) = (row / field.n_components() - 1, memory.len() - look_registers(field));
        let rows = &memory[..field.registers(n_tangents, order)];
        memory[room + 1] = field.square_of_changes(rows, n_tangents, order, memory[room]);
    }
}

/// Looks at the nodes that all steps have, by compiled code; whether nothing is wrong at any. False where there is no such code, or
/// something has to be looked at again.
struct CommonNodes<'a, V> {
    field: &'a Tape,
    memory: &'a mut [V],
    row: usize,
    order: usize,
    steps: &'a [f64],
    are_good: &'a mut bool,
    to: &'a mut StepEnd<V>,
}

impl<V: Wide> Body for CommonNodes<'_, V> {
    #[inline(always)]
    fn run(self) {
        /// Smaller than one by more than round-off: what is good here is good by [`Defects`].
        const CLEARLY: f64 = 0.999;
        let CommonNodes { field, memory, row, order, steps, are_good, to } = self;
        let (room, n) = (memory.len() - look_registers(field), to.n);
        let mut step = V::splat(0.0);
        step.as_scalars_mut().copy_from_slice(&steps[..V::WIDTH]);
        let mut is_good = true;
        for node in (2 * EVERY..=MANY).step_by(2 * EVERY) {
            let nodes = [node - EVERY, node];
            for (to, node) in memory[room..].iter_mut().zip(nodes) {
                *to = step.mul(V::splat(node as f64 / MANY as f64));
            }
            if !field.run_compiled(&TwoNodes { field, row, order }, memory) {
                return;
            }
            let found = &memory[room + 2..];
            let size = found[3 * n + 1];
            for (node, defect) in nodes.into_iter().zip([found[3 * n + 2], found[3 * n]]) {
                let part = node as f64 / MANY as f64;
                let bound = size.mul(V::splat(CLEARLY * part * to.allowed[node - 1]));
                for ((look, defect), bound) in to.looks.iter().zip(defect.as_scalars()).zip(bound.as_scalars()) {
                    is_good &= defect <= bound || !look.is_open;
                }
            }
        }
        to.at.copy_from_slice(&steps[..V::WIDTH]);
        *are_good = is_good;
    }
}

/// For each lane the sum of `|x'(h) - f(x(h))| |h|` over the components, in units of the size of the state.
struct Defects<'a, V> {
    field: &'a Tape,
    memory: &'a mut [V],
    row: usize,
    order: usize,
    steps: &'a [f64],
    /// Part of the whole step at which the node is.
    part: f64,
    to: &'a mut StepEnd<V>,
}

impl<V: Wide> Body for Defects<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Defects { field, memory, row, order, steps, part, to } = self;
        let mut step = V::splat(0.0);
        step.as_scalars_mut().copy_from_slice(&steps[..V::WIDTH]);
        to.at.copy_from_slice(&steps[..V::WIDTH]);
        let (room, found) = (memory.len() - look_registers(field), states_at(field, memory.len()));
        memory[room] = step;
        if !field.run_compiled(&NodeLook { field, row, order }, memory) {
            let (rows, found) = memory.split_at_mut(found);
            look(field, rows, (row, order), step, &mut to.work, &mut found[..3 * to.n + 2]);
        }
        let (defect, size) = (memory[found + 3 * to.n], memory[found + 3 * to.n + 1]);
        let (defect, size) = (defect.as_scalars(), size.as_scalars());
        for ((to, &defect), &size) in to.defects.iter_mut().zip(defect).zip(size) {
            *to = if defect == 0.0 { 0.0 } else { defect / (part * size) };
        }
    }
}
