//! The Taylor method for one trajectory of a top alone: registers hold the components of vectors instead of trajectories.

use crate::field::{Top, needs_remainder};
use crate::lanes::{Body, TwoVectors, Vectors, Wide};
use crate::method::estimates::{exp2_estimate, log2_estimate};
use crate::method::known_terms::{FEWEST, finite_order, is_in_range, longest_step};
use crate::method::taylor::{MAX_ORDER, Terms, Trend};
use crate::method::{Block, Method, Overview, Precision, Series, StepOutcome, Stepping, Taylor};
use std::collections::TryReserveError;

/// [`Taylor`] for one trajectory of a [`Top`] without tangent vectors.
///
/// With `r` for the rotation `(1, 2, 3) -> (2, 3, 1)`, `u x w = r(u r(w) - r(u) w)`, so a cross product is two products
/// of registers, and the rotation of a sum is made once. What limits a single trajectory is how long each operation waits for
/// the one before, and what is loaded: the newest coefficient enters each sum last, so that the rest of the sum is under way
/// while it is computed, and the sums of two orders share what they load. (Straight-line code for each order was measured to be
/// slower: it is longer than the first cache of instructions.) Results differ from those of the kernel for many in the last bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcrossComponents(pub Taylor);

impl Method<Top> for AcrossComponents {
    fn block<'f, V: Wide>(&self, field: &'f Top, n_tangents: usize) -> Box<dyn Block + 'f> {
        assert_eq!(n_tangents, 0, "the kernel for one trajectory has no tangent vectors");
        let rows = Box::new([Row::default(); MAX_ORDER + 1]);
        Box::new(SingleBlock::<V> {
            top: SpreadTop::new(field),
            method: self.0,
            trend: Trend::new(self.0.tolerance(), self.0.order()),
            rows,
            register: std::marker::PhantomData,
        })
    }

    fn registers(&self, _field: &Top, _n_tangents: usize) -> usize {
        size_of::<Rows>() / size_of::<f64>()
    }

    fn max_steps(&self) -> u64 {
        self.0.max_steps()
    }
}

/// The coefficients of one order: each vector followed by a zero, and what is derived from them.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
struct Row {
    /// alpha and beta
    fields: [f64; 8],
    /// alpha and beta, rotated
    fields_rotated: [f64; 8],
    l: [f64; 4],
    omega: [f64; 4],
    omega_rotated: [f64; 4],
}

/// The rows of a series, as many as the highest order needs.
type Rows = [Row; MAX_ORDER + 1];

impl Terms<f64> for Rows {
    #[inline(always)]
    fn size(&self, k: usize, _group: usize) -> f64 {
        self[k].norm()
    }
}

/// The parameters as vectors with a zero behind them.
struct SpreadTop {
    inverse_inertia: [f64; 4],
    asymmetry: [f64; 4],
    /// a and b, and rotated: what alpha and beta are multiplied with.
    centres: [f64; 8],
    centres_rotated: [f64; 8],
    /// epsilon a and 0, and rotated: what beta and alpha are multiplied with.
    twist: [f64; 8],
    twist_rotated: [f64; 8],
}

impl SpreadTop {
    fn new(top: &Top) -> SpreadTop {
        let spread = |v: [f64; 3]| [v[0], v[1], v[2], 0.0];
        let pair = |u: [f64; 3], v: [f64; 3]| [u[0], u[1], u[2], 0.0, v[0], v[1], v[2], 0.0];
        let turn = |v: [f64; 3]| [v[1], v[2], v[0]];
        SpreadTop {
            inverse_inertia: spread(top.inverse_inertia),
            asymmetry: spread(top.asymmetry),
            centres: pair(top.a, top.b),
            centres_rotated: pair(turn(top.a), turn(top.b)),
            twist: pair(top.twist, [0.0; 3]),
            twist_rotated: pair(turn(top.twist), [0.0; 3]),
        }
    }
}

struct SingleBlock<V> {
    top: SpreadTop,
    method: Taylor,
    trend: Trend,
    rows: Box<Rows>,
    register: std::marker::PhantomData<V>,
}

impl<V: Wide> Block for SingleBlock<V> {
    fn n_lanes(&self) -> usize {
        1
    }

    fn stepping(&self) -> Stepping {
        Stepping::Series
    }

    fn precision(&self) -> Precision {
        Precision::Double
    }

    fn load(&mut self, _lane: usize, _trajectory: usize, _group: usize, values: &[f64]) {
        let row = &mut self.rows[0];
        row.l[..3].copy_from_slice(&values[..3]);
        row.fields[..3].copy_from_slice(&values[3..6]);
        row.fields[4..7].copy_from_slice(&values[6..9]);
    }

    fn read(&self, _lane: usize, _group: usize, values: &mut [f64]) {
        self.rows[0].copy_to(values);
    }

    fn prepare(&mut self, _ahead: &[f64], longest: &mut [f64]) {
        V::outline(Expansion { block: self, longest });
    }

    fn advance(&mut self, sizes: &[f64], _repeats: u64, outcomes: &mut [StepOutcome]) {
        outcomes.fill(StepOutcome::Taken);
        V::outline(Advance { block: self, step: sizes[0] });
    }

    fn norms(&self, _group: usize, norms: &mut [f64]) {
        norms[0] = self.rows[0].norm();
    }

    fn scale_tangent(&mut self, _lane: usize, _group: usize, _exponent: i32) {}

    fn series(&self) -> Option<&dyn Series> {
        Some(self)
    }
}

impl<V: Wide> Series for SingleBlock<V> {
    fn evaluate(&self, _lane: usize, _group: usize, taus: &[f64], _n: usize, values: &mut [f64], stride: usize) {
        V::outline(Evaluation { block: self, taus, values, stride });
    }

    fn keeps_tangents_whole(&self) -> bool {
        true
    }

    fn look_over(&self, _steps: &[f64], _of: &mut Overview<'_>) -> bool {
        false
    }

    fn copy(&self, _lane: usize, n_orders: usize, to: &mut Vec<f64>) -> Result<(), TryReserveError> {
        let rows = &self.rows[..n_orders.min(self.method.order() + 1)];
        to.try_reserve(9 * rows.len())?;
        let mut values = [0.0; 9];
        for row in rows {
            row.copy_to(&mut values);
            to.extend_from_slice(&values);
        }
        Ok(())
    }
}

impl Row {
    fn copy_to(&self, values: &mut [f64]) {
        values[..3].copy_from_slice(&self.l[..3]);
        values[3..6].copy_from_slice(&self.fields[..3]);
        values[6..9].copy_from_slice(&self.fields[4..7]);
    }

    /// Sum of the absolute values of the components; the zeros behind the vectors stay zeros, or become NaN.
    #[inline(always)]
    fn norm(&self) -> f64 {
        let (l, fields) = (&self.l, &self.fields);
        let sums: [f64; 4] = std::array::from_fn(|i| l[i].abs() + (fields[i].abs() + fields[4 + i].abs()));
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }
}

impl<V: Wide> SingleBlock<V> {
    /// Cuts the series where it is no longer finite, and shortens the step where its last terms are lost.
    #[cold]
    fn rely_on_known_terms(&mut self, longest: &mut f64) {
        let order = self.method.order();
        let finite = if longest.is_nan() { finite_order(order, |k| self.rows[k].norm()) } else { order };
        if finite < FEWEST.min(order) || !self.rows[0].norm().is_finite() {
            return;
        }
        if finite < order {
            *longest = f64::INFINITY;
            self.rows[finite + 1..=order].fill(Row::default());
        }
        let step = longest_step(order, finite, self.method.tolerance(), |k| self.rows[k].norm());
        *longest = longest.min(step.unwrap_or(f64::INFINITY));
    }

    /// The sum of the series at `tau`; even and odd powers apart, so that two chains of operations run side by side.
    #[inline(always)]
    fn sum(&self, tau: f64) -> ([f64; 4], [f64; 8]) {
        let (t, t2) = (V::Vector::splat(tau), V::Vector::splat(tau * tau));
        let (s, s2) = (V::TwoVectors::splat(tau), V::TwoVectors::splat(tau * tau));
        let row = |k: usize| (V::Vector::load(&self.rows[k].l), V::TwoVectors::load(&self.rows[k].fields));
        let order = self.method.order();
        if (tau * tau).is_infinite() {
            // only what rests takes such a step
            let (mut l, mut fields) = row(order);
            for k in (0..order).rev() {
                let next = row(k);
                (l, fields) = (l.mul_add(t, next.0), fields.mul_add(s, next.1));
            }
            return as_numbers::<V>(l, fields);
        }
        let (mut high, mut low) = (row(order), row(order - 1));
        let mut k = order - 1;
        while k >= 2 {
            let (next_high, next_low) = (row(k - 1), row(k - 2));
            high = (high.0.mul_add(t2, next_high.0), high.1.mul_add(s2, next_high.1));
            low = (low.0.mul_add(t2, next_low.0), low.1.mul_add(s2, next_low.1));
            k -= 2;
        }
        // `high` stands at power k + 1, `low` at power k, which is 1 or 0
        let (mut l, mut fields) = (high.0.mul_add(t, low.0), high.1.mul_add(s, low.1));
        if k == 1 {
            let first = row(0);
            (l, fields) = (l.mul_add(t, first.0), fields.mul_add(s, first.1));
        }
        as_numbers::<V>(l, fields)
    }
}

#[inline(always)]
fn as_numbers<V: Wide>(l: V::Vector, fields: V::TwoVectors) -> ([f64; 4], [f64; 8]) {
    let (mut l_numbers, mut field_numbers) = ([0.0; 4], [0.0; 8]);
    l.store(&mut l_numbers);
    fields.store(&mut field_numbers);
    (l_numbers, field_numbers)
}

/// The power series and the longest step that its last two terms allow; as [`Taylor`] chooses it.
struct Expansion<'b, V> {
    block: &'b mut SingleBlock<V>,
    longest: &'b mut [f64],
}

impl<V: Wide> Body for Expansion<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Expansion { block, longest } = self;
        let order = block.method.order();
        let mut series = Growing::<V>::new(&block.top, &block.rows[0]);
        let rows: &mut Rows = &mut block.rows;
        let mut k = 0;
        while k < order {
            series.extend(rows, k, k + 1 == order);
            k += 2;
        }
        series.l.store(&mut block.rows[order].l);
        series.fields.store(&mut block.rows[order].fields);
        let (size, last, before) = (block.rows[0].norm(), block.rows[order].norm(), block.rows[order - 1].norm());
        let defect = (size + last) * 0.0;
        let allowed = log2_estimate(block.method.tolerance() * size);
        let bound = |term: f64, power: usize| {
            if term > 0.0 { (allowed - log2_estimate(term)) / power as f64 } else { f64::INFINITY }
        };
        let (by_last, by_before) = (bound(last, order), bound(before, order - 1));
        let mut logarithm = [(if by_last < by_before { by_last } else { by_before }) + defect];
        longest[0] = exp2_estimate(logarithm[0]);
        if block.trend.suspects(longest[0], &*block.rows, 0) {
            block.trend.shorten(&mut logarithm, &*block.rows, 0);
            longest[0] = exp2_estimate(logarithm[0]);
        }
        if !(is_in_range(last) && is_in_range(before)) {
            block.rely_on_known_terms(&mut longest[0]);
        }
    }
}

/// A series under way: its newest coefficients, and the parameters in registers.
struct Growing<V: Wide> {
    l: V::Vector,
    fields: V::TwoVectors,
    inverse_inertia: V::Vector,
    asymmetry: V::Vector,
    centres: V::TwoVectors,
    centres_rotated: V::TwoVectors,
    twist: V::TwoVectors,
    twist_rotated: V::TwoVectors,
    first: Newest<V>,
    second: Newest<V>,
}

impl<V: Wide> Growing<V> {
    #[inline(always)]
    fn new(top: &SpreadTop, row: &Row) -> Self {
        let inverse_inertia = V::Vector::load(&top.inverse_inertia);
        let (l, fields) = (V::Vector::load(&row.l), V::TwoVectors::load(&row.fields));
        Growing {
            l,
            fields,
            inverse_inertia,
            asymmetry: V::Vector::load(&top.asymmetry),
            centres: V::TwoVectors::load(&top.centres),
            centres_rotated: V::TwoVectors::load(&top.centres_rotated),
            twist: V::TwoVectors::load(&top.twist),
            twist_rotated: V::TwoVectors::load(&top.twist_rotated),
            first: Newest::of(l, fields, inverse_inertia),
            second: Newest::of(l, fields, inverse_inertia),
        }
    }

    /// Stores row k, the newest, and goes on to the coefficients of order k + 2, or of k + 1 if that is the last.
    #[inline(always)]
    fn extend(&mut self, rows: &mut Rows, k: usize, is_last: bool) {
        let [inner, next_inner] = inner_products::<V>(rows, k);
        let row = Newest::<V>::of(self.l, self.fields, self.inverse_inertia);
        row.store(&mut rows[k]);
        let first = self.first;
        let sums = if k > 0 { inner.with(&row, &first).with(&first, &row) } else { inner.with(&first, &first) };
        self.finish(sums, &row, k + 1);
        if is_last {
            return;
        }
        let next = Newest::<V>::of(self.l, self.fields, self.inverse_inertia);
        next.store(&mut rows[k + 1]);
        if k == 0 {
            self.second = next;
        }
        let second = self.second;
        let sums = if k > 0 { next_inner.with(&row, &second).with(&second, &row) } else { next_inner };
        self.finish(sums.with(&next, &first).with(&first, &next), &next, k + 2);
    }

    /// The coefficients of an order, from the sums of products and the newest row.
    #[inline(always)]
    fn finish(&mut self, sums: Products<V>, newest: &Newest<V>, order: usize) {
        let careful = needs_remainder(order);
        let inverse = if careful { 1.0 } else { INVERSES[order] };
        let (scale, scales) = (V::Vector::splat(inverse), V::TwoVectors::splat(inverse));
        // constant vectors act on the newest row alone
        let forces = newest.fields.mul(self.centres_rotated);
        let forces = newest.fields_rotated.neg_mul_add(self.centres, forces).rotate();
        let force = forces.first().add(forces.second()).mul(scale);
        let (betas, betas_rotated) = (newest.fields.swap(), newest.fields_rotated.swap());
        let twisted = betas_rotated.neg_mul_add(self.twist, betas.mul(self.twist_rotated)).rotate().mul(scales);
        // l omega_rotated = (l1 omega2, l2 omega3, l3 omega1): rotated, these are what `asymmetry` expects
        self.l = sums.l.rotate().mul_add(self.asymmetry.mul(scale), force);
        self.fields = sums.fields.rotate().mul_add(scales, twisted);
        if careful {
            (self.l, self.fields) = (divided(self.l, order), divided(self.fields, order));
        }
    }
}

/// `1 / k`
static INVERSES: [f64; MAX_ORDER + 2] = {
    let mut inverses = [1.0; MAX_ORDER + 2];
    let mut k = 2;
    while k < inverses.len() {
        inverses[k] = 1.0 / k as f64;
        k += 1;
    }
    inverses
};

/// Sums of products of rows: `l omega_rotated`, and `fields omega_rotated - fields_rotated omega`.
struct Products<V: Wide> {
    l: V::Vector,
    fields: V::TwoVectors,
}

impl<V: Wide> Products<V> {
    /// With those of one pair of rows.
    #[inline(always)]
    fn with(self, x: &Newest<V>, y: &Newest<V>) -> Self {
        let minus = x.fields_rotated.neg_mul_add(V::TwoVectors::both(y.omega), self.fields);
        Products {
            l: x.l.mul_add(y.omega_rotated, self.l),
            fields: x.fields.mul_add(V::TwoVectors::both(y.omega_rotated), minus),
        }
    }
}

/// Sums of products of the rows 1..k with one another, of two orders: of pairs whose numbers add up to k, and to k + 1.
///
/// Each row is loaded once for both, and nothing here waits for row k.
#[inline(always)]
fn inner_products<V: Wide>(rows: &Rows, k: usize) -> [Products<V>; 2] {
    let none = Sums { l: V::Vector::splat(0.0), plus: V::TwoVectors::splat(0.0), minus: V::TwoVectors::splat(0.0) };
    let (mut sums, mut next) = (none, none);
    if k > 1 {
        let mut before = Turns::<V>::load(&rows[k - 1]);
        sums = sums.with(&rows[1], before);
        for (x, y) in rows[2..k].iter().zip(rows[1..k - 1].iter().rev()) {
            let turns = Turns::load(y);
            sums = sums.with(x, turns);
            next = next.with(x, before);
            before = turns;
        }
    }
    [sums.total(), next.total()]
}

/// What vectors of another row are turned by.
struct Turns<V: Wide> {
    omega: V::TwoVectors,
    omega_rotated: V::TwoVectors,
}

impl<V: Wide> Clone for Turns<V> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<V: Wide> Copy for Turns<V> {}

impl<V: Wide> Turns<V> {
    #[inline(always)]
    fn load(row: &Row) -> Self {
        Turns {
            omega: V::TwoVectors::both(V::Vector::load(&row.omega)),
            omega_rotated: V::TwoVectors::both(V::Vector::load(&row.omega_rotated)),
        }
    }
}

/// Sums under way, of positive and negative products apart.
struct Sums<V: Wide> {
    l: V::Vector,
    plus: V::TwoVectors,
    minus: V::TwoVectors,
}

impl<V: Wide> Clone for Sums<V> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<V: Wide> Copy for Sums<V> {}

impl<V: Wide> Sums<V> {
    #[inline(always)]
    fn with(self, row: &Row, by: Turns<V>) -> Self {
        Sums {
            l: V::Vector::load(&row.l).mul_add(by.omega_rotated.first(), self.l),
            plus: V::TwoVectors::load(&row.fields).mul_add(by.omega_rotated, self.plus),
            minus: V::TwoVectors::load(&row.fields_rotated).neg_mul_add(by.omega, self.minus),
        }
    }

    #[inline(always)]
    fn total(self) -> Products<V> {
        Products { l: self.l, fields: self.plus.add(self.minus) }
    }
}

/// `sum / order`, corrected with the remainder as [`crate::field::over`] does.
#[inline(always)]
fn divided<T: Vectors>(sum: T, order: usize) -> T {
    let inverse = T::splat(1.0 / order as f64);
    let quotient = sum.mul(inverse);
    quotient.neg_mul_add(T::splat(order as f64), sum).mul_add(inverse, quotient)
}

/// The newest row, in registers.
struct Newest<V: Wide> {
    l: V::Vector,
    fields: V::TwoVectors,
    fields_rotated: V::TwoVectors,
    omega: V::Vector,
    omega_rotated: V::Vector,
}

impl<V: Wide> Clone for Newest<V> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<V: Wide> Copy for Newest<V> {}

impl<V: Wide> Newest<V> {
    #[inline(always)]
    fn of(l: V::Vector, fields: V::TwoVectors, inverse_inertia: V::Vector) -> Self {
        let omega = l.mul(inverse_inertia);
        Newest { l, fields, fields_rotated: fields.rotate(), omega, omega_rotated: omega.rotate() }
    }

    #[inline(always)]
    fn store(&self, row: &mut Row) {
        self.l.store(&mut row.l);
        self.fields.store(&mut row.fields);
        self.fields_rotated.store(&mut row.fields_rotated);
        self.omega.store(&mut row.omega);
        self.omega_rotated.store(&mut row.omega_rotated);
    }
}

/// The state at times after the start of the step.
struct Evaluation<'b, V> {
    block: &'b SingleBlock<V>,
    taus: &'b [f64],
    values: &'b mut [f64],
    stride: usize,
}

impl<V: Wide> Body for Evaluation<'_, V> {
    #[inline(always)]
    fn run(self) {
        for (&tau, values) in self.taus.iter().zip(self.values.chunks_mut(self.stride)) {
            let (l, fields) = self.block.sum(tau);
            values[..3].copy_from_slice(&l[..3]);
            values[3..6].copy_from_slice(&fields[..3]);
            values[6..9].copy_from_slice(&fields[4..7]);
        }
    }
}

struct Advance<'b, V> {
    block: &'b mut SingleBlock<V>,
    step: f64,
}

impl<V: Wide> Body for Advance<'_, V> {
    #[inline(always)]
    fn run(self) {
        let (l, fields) = self.block.sum(self.step);
        (self.block.rows[0].l, self.block.rows[0].fields) = (l, fields);
    }
}
