//! The charged and the twisted top: so(3) (x) A for dim A = 3, all cross products fused.

use super::{Bounds, Field, Instance, Instantiate, Majorant, Point, SinglePrecision, Space, Terms, over};
use crate::error::Error;
use crate::lanes::{Body, Lane};

pub(crate) const N: usize = 9;
/// l, alpha, beta, and the angular velocity omega as work quantity.
pub(crate) const GROUP: usize = 12;
pub(crate) const OMEGA: usize = 9;

/// The twisted top with diagonal inertia, in the body frame.
///
/// With `omega_i = l_i / I_i`,
/// ```text
/// l'     = l x omega + alpha x a + beta x b
/// alpha' = alpha x omega + epsilon beta x a
/// beta'  = beta x omega
/// ```
/// State `(l, alpha, beta)`, dimensionless. `epsilon = 0` is the charged heavy top.
///
/// # References
/// Thiffeault and Morrison, *The twisted top* (2001), the three equations of motion of its section 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Top {
    pub(crate) a: [f64; 3],
    pub(crate) b: [f64; 3],
    /// epsilon a
    pub(crate) twist: [f64; 3],
    pub(crate) inverse_inertia: [f64; 3],
    /// `(l x omega)_1 = (1 - I3/I2) l2 omega3` and cyclically: one product instead of two, and exactly zero for
    /// equal moments, so that a symmetric top keeps `l3` exactly.
    pub(crate) asymmetry: [f64; 3],
    /// Bit `3 * constant + axis` for each constant that is not zero: one test of an integer where a kernel asks for it.
    present: u16,
}

impl Top {
    /// The top with principal moments `inertia`, centre of mass `a`, centre of charge `b` and cocycle `epsilon`.
    ///
    /// # Errors
    /// A moment that is not positive, or any number that is not finite.
    pub fn new(inertia: [f64; 3], a: [f64; 3], b: [f64; 3], epsilon: f64) -> Result<Top, Error> {
        if inertia.iter().any(|&moment| !(moment.is_finite() && moment > 0.0)) {
            return Err(Error::Inertia { got: inertia });
        }
        for (name, values) in [("a", &a[..]), ("b", &b[..]), ("epsilon", &[epsilon][..])] {
            if let Some(&got) = values.iter().find(|value| !value.is_finite()) {
                return Err(Error::ParameterNotFinite { name, got });
            }
        }
        let [i1, i2, i3] = inertia;
        let mut top = Top {
            a,
            b,
            twist: a.map(|component| epsilon * component),
            inverse_inertia: inertia.map(f64::recip),
            asymmetry: [(i2 - i3) / i2, (i3 - i1) / i3, (i1 - i2) / i1],
            present: 0,
        };
        for constant in Constant::ALL {
            for axis in 0..3 {
                let present = top.vector(constant)[axis] != 0.0;
                top.present |= u16::from(present) << constant.bit(axis);
            }
        }
        Ok(top)
    }

    /// One of the vectors of constants.
    #[inline(always)]
    pub(super) fn vector(&self, constant: Constant) -> &[f64; 3] {
        match constant {
            Constant::A => &self.a,
            Constant::B => &self.b,
            Constant::Twist => &self.twist,
            Constant::InverseInertia => &self.inverse_inertia,
            Constant::Asymmetry => &self.asymmetry,
        }
    }

    #[inline(always)]
    fn omega<V: Lane>(&self, group: &[V; N]) -> [V; 3] {
        let mut omega = [V::splat(0.0); 3];
        for i in 0..3 {
            omega[i] = group[i].mul(V::splat(self.inverse_inertia[i]));
        }
        omega
    }
}

/// The vectors of constants in the equations of a top.
#[derive(Clone, Copy)]
pub(crate) enum Constant {
    A,
    B,
    Twist,
    InverseInertia,
    Asymmetry,
}

impl Constant {
    pub(super) const COUNT: usize = 5;
    pub(super) const ALL: [Constant; Constant::COUNT] =
        [Constant::A, Constant::B, Constant::Twist, Constant::InverseInertia, Constant::Asymmetry];

    /// Which bit stands for a component in a set of constants.
    #[inline(always)]
    const fn bit(self, axis: usize) -> usize {
        3 * self as usize + axis
    }
}

/// Where the constants come from: the same in all lanes, or lane by lane.
pub(crate) trait Constants {
    /// A constant in a register whose first number belongs to `first_lane`.
    fn of<V: Lane>(&self, constant: Constant, axis: usize, first_lane: usize) -> V;

    /// Whether it is zero in all lanes: then it costs nothing.
    fn vanishes(&self, constant: Constant, axis: usize) -> bool;

    /// The top of a lane.
    fn in_lane(&self, lane: usize) -> &Top;
}

impl Constants for Top {
    #[inline(always)]
    fn of<V: Lane>(&self, constant: Constant, axis: usize, _first_lane: usize) -> V {
        V::splat(self.vector(constant)[axis])
    }

    #[inline(always)]
    fn vanishes(&self, constant: Constant, axis: usize) -> bool {
        self.present >> constant.bit(axis) & 1 == 0
    }

    fn in_lane(&self, _lane: usize) -> &Top {
        self
    }
}

impl Instantiate for Top {
    type Instance<'f> = Top;

    fn instantiate(&self) -> Top {
        *self
    }
}

impl Instance for Top {
    fn assign(&mut self, _lane: usize, _trajectory: usize) {}
}

/// Terms linear in the coefficients, and the factor of `l x omega`: the sum of products becomes the derivative.
#[inline(always)]
fn finish<C: Constants, V: Lane>(top: &C, derivative: &mut [V; N], row: &[V]) {
    for i in 0..3 {
        derivative[i] = derivative[i].mul(top.of(Constant::Asymmetry, i, 0));
    }
    add_cross_with_constant(derivative, 0, row, 3, top, Constant::A);
    add_cross_with_constant(derivative, 0, row, 6, top, Constant::B);
    add_cross_with_constant(derivative, 3, row, 6, top, Constant::Twist);
}

/// The work quantities of some groups.
#[inline(always)]
pub(super) fn derive_work<C: Constants, V: Lane>(top: &C, groups: &mut [V]) {
    for group in groups.chunks_exact_mut(GROUP) {
        for i in 0..3 {
            group[OMEGA + i] = group[i].mul(top.of(Constant::InverseInertia, i, 0));
        }
    }
}

/// The next coefficients of the state, and of the `first` tangent vector if there is one.
#[inline(always)]
fn extend_state<C: Constants, V: Lane>(top: &C, known: &[V], next: &mut [V], row: usize, first: usize) {
    let (order, last) = (known.len() / row, known.len() - row);
    // With 32 registers the state and the first tangent vector share the coefficients that they load. The sums are
    // the same, term by term, so a trajectory has the same bits either way.
    if first == 1 && V::REGISTERS >= 32 {
        let (mut derivative, mut tangent) = products_of_state_and_tangent::<V, false>(known, row);
        finish(top, &mut derivative, group_of(known, last));
        store(next, 0, &derivative, order);
        finish(top, &mut tangent, group_of(known, last + GROUP));
        store(next, GROUP, &tangent, order);
        return;
    }
    let mut derivative = products_of_state::<V, false>(known, row);
    finish(top, &mut derivative, group_of(known, last));
    store(next, 0, &derivative, order);
    if first == 1 {
        extend_tangents::<C, V, 1>(top, known, next, row, GROUP);
    }
}

/// The next coefficients of the `M` tangent vectors from group `at` on.
#[inline(always)]
fn extend_tangents<C: Constants, V: Lane, const M: usize>(top: &C, known: &[V], next: &mut [V], row: usize, at: usize) {
    let (order, last) = (known.len() / row, known.len() - row);
    let mut tangents = products_of_tangents::<V, M, false>(known, row, at);
    for m in 0..M {
        finish(top, &mut tangents[m], group_of(known, last + at + m * GROUP));
        store(next, at + m * GROUP, &tangents[m], order);
    }
}

/// The series of these tangent vectors, where that of the state is known; the registers that they take.
#[inline(always)]
fn expand_tangents<C: Constants, V: Lane, const M: usize>(
    top: &C,
    rows: &mut [V],
    row: usize,
    at: usize,
    order: usize,
) -> usize {
    for k in 0..order {
        derive_work(top, &mut rows[k * row + at..][..M * GROUP]);
        let (known, next) = rows.split_at_mut((k + 1) * row);
        extend_tangents::<C, V, M>(top, known, next, row, at);
    }
    M * GROUP
}

/// [`Field::extend`] of tops.
#[inline(always)]
pub(super) fn extend<C: Constants, V: Lane>(top: &C, rows: &mut [V], n_tangents: usize, k: usize) {
    let row = GROUP * (1 + n_tangents);
    let (known, next) = rows.split_at_mut((k + 1) * row);
    let first = n_tangents.min(1);
    extend_state(top, known, next, row, first);
    for i in 1 + first..=n_tangents {
        extend_tangents::<C, V, 1>(top, known, next, row, i * GROUP);
    }
}

/// [`Field::expand`] of tops: the state and the first tangent vector are expanded to the last order, then the others one or two
/// at a time: with the state, these coefficients stay in the nearest cache, where those of all tangent vectors would not.
#[inline(always)]
pub(super) fn expand<C: Constants, V: Lane>(top: &C, rows: &mut [V], n_tangents: usize, order: usize) {
    let (row, first) = (GROUP * (1 + n_tangents), n_tangents.min(1));
    for k in 0..order {
        derive_work(top, &mut rows[k * row..][..(1 + first) * GROUP]);
        let (known, next) = rows.split_at_mut((k + 1) * row);
        extend_state(top, known, next, row, first);
    }
    let mut at = (1 + first) * GROUP;
    while at < row {
        at += match (row - at) / GROUP {
            2.. if V::REGISTERS >= 32 => expand_tangents::<C, V, 2>(top, rows, row, at, order),
            _ => expand_tangents::<C, V, 1>(top, rows, row, at, order),
        };
    }
}

impl Space for Top {
    fn n_components(&self) -> usize {
        N
    }
}

impl Bounds for Top {
    fn majorant(&self) -> Option<Majorant> {
        // a row of the matrix of u -> u x v: the two components of v that stand in it
        let row = |v: &[f64; 3], i: usize| v[(i + 1) % 3].abs() + v[(i + 2) % 3].abs();
        let mut majorant = Majorant::default();
        for i in 0..3 {
            let linear = (row(&self.a, i) + row(&self.b, i)).max(row(&self.twist, i));
            let omega = self.asymmetry[i].abs() * self.inverse_inertia[(i + 2) % 3];
            majorant.linear = majorant.linear.max(linear);
            majorant.quadratic = majorant.quadratic.max(omega.max(row(&self.inverse_inertia, i)));
        }
        Some(majorant)
    }

    fn terms(&self, state: &[f64], rest: &[f64], to: &mut Terms) {
        to.clear(N);
        let size = |k: usize| state[k].abs() + rest[k];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let cross = |v: &[f64; 3], at: usize| v[j].abs() * size(at + k) + v[k].abs() * size(at + j);
            let omega = |k: usize| self.inverse_inertia[k] * size(k);
            (to.linear[i], to.linear[3 + i]) = (cross(&self.a, 3) + cross(&self.b, 6), cross(&self.twist, 6));
            to.quadratic[i] = self.asymmetry[i].abs() * size(j) * omega(k);
            for at in [3, 6] {
                to.quadratic[at + i] = size(at + j) * omega(k) + size(at + k) * omega(j);
            }
        }
    }
}

impl Field for Top {
    fn group(&self) -> usize {
        GROUP
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        let row = self.row(n_tangents);
        derive_work(self, &mut rows[k * row..(k + 1) * row]);
    }

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        extend(self, rows, n_tangents, k);
    }

    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        expand(self, rows, n_tangents, order);
    }

    /// The sums of [`Field::extend`] for order 0, in registers.
    #[inline(always)]
    fn rates<V: Lane>(&self, x: &[V], _n_tangents: usize, _work: &mut [V], rates: &mut [V]) {
        V::outline(Rates { top: self, point: &Known(x), rates });
    }

    #[inline(always)]
    fn rates_at<V: Lane>(
        &self,
        point: &impl Point<V>,
        _n_tangents: usize,
        _x: &mut [V],
        _work: &mut [V],
        rates: &mut [V],
    ) {
        Rates { top: self, point, rates }.run();
    }
}

/// A point that lies in memory.
struct Known<'a, V>(&'a [V]);

impl<V: Lane> Point<V> for Known<'_, V> {
    #[inline(always)]
    fn components<const M: usize>(&self, first: usize) -> [V; M] {
        *self.0[first..].first_chunk().expect("whole groups")
    }

    fn write(&self, to: &mut [V]) {
        to.copy_from_slice(self.0);
    }
}

struct Rates<'a, P, V> {
    top: &'a Top,
    point: &'a P,
    rates: &'a mut [V],
}

impl<P: Point<V>, V: Lane> Body for Rates<'_, P, V> {
    #[inline(always)]
    fn run(self) {
        let Rates { top, point, rates } = self;
        let (to, tangents) = rates.as_chunks_mut::<N>().0.split_first_mut().expect("the state is a group");
        let state: [V; N] = point.components(0);
        let omega = top.omega(&state);
        let mut sum = [V::splat(0.0); N];
        add_products(&mut sum, &state, &omega);
        finish(top, &mut sum, &state);
        *to = sum;
        for (g, to) in tangents.iter_mut().enumerate() {
            let tangent: [V; N] = point.components((1 + g) * N);
            let mut sum = [V::splat(0.0); N];
            add_products(&mut sum, &state, &top.omega(&tangent));
            add_products(&mut sum, &tangent, &omega);
            finish(top, &mut sum, &tangent);
            *to = sum;
        }
    }
}

impl SinglePrecision for Top {}

#[inline(always)]
pub(crate) fn group_of<V>(rows: &[V], at: usize) -> &[V; GROUP] {
    rows[at..].first_chunk().expect("a row holds whole groups")
}

#[inline(always)]
fn store<V: Lane>(next: &mut [V], at: usize, derivative: &[V; N], order: usize) {
    for i in 0..N {
        next[at + i] = over(derivative[i], order);
    }
}

/// `sum[at..] += row[from..] x c`, skipping components of `c` that are zero.
#[inline(always)]
fn add_cross_with_constant<C: Constants, V: Lane>(
    sum: &mut [V; N],
    at: usize,
    row: &[V],
    from: usize,
    top: &C,
    c: Constant,
) {
    for axis in 0..3 {
        if !top.vanishes(c, axis) {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let factor: V = top.of(c, axis, 0);
            sum[at + next] = row[from + last].mul_add(factor, sum[at + next]);
            sum[at + last] = row[from + next].neg_mul_add(factor, sum[at + last]);
        }
    }
}

/// Adds the products that one state contributes: `l2 omega3` and cyclically, `alpha x omega`, `beta x omega`.
#[inline(always)]
fn add_products<V: Lane>(sum: &mut [V; N], x: &[V], omega: &[V]) {
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        sum[i] = x[j].mul_add(omega[k], sum[i]);
        sum[3 + i] = x[3 + j].mul_add(omega[k], sum[3 + i]);
        sum[3 + i] = x[3 + k].neg_mul_add(omega[j], sum[3 + i]);
        sum[6 + i] = x[6 + j].mul_add(omega[k], sum[6 + i]);
        sum[6 + i] = x[6 + k].neg_mul_add(omega[j], sum[6 + i]);
    }
}

#[inline(always)]
pub(crate) fn products_of_state<V: Lane, const NEWEST_LAST: bool>(rows: &[V], row: usize) -> [V; N] {
    let mut sum = [V::splat(0.0); N];
    let (first, xs, ys) = pairs::<V, NEWEST_LAST>(rows, row);
    for (x, y) in xs.chunks_exact(row).zip(ys.chunks_exact(row).rev()) {
        add_products(&mut sum, &x[..OMEGA], &y[OMEGA..GROUP]);
    }
    if NEWEST_LAST {
        add_products(&mut sum, &first[..OMEGA], &rows[rows.len() - row..][OMEGA..GROUP]);
    }
    sum
}

/// The rows whose pairs are summed one after the other, from the ends of the series; `NEWEST_LAST` begins with the second row and
/// leaves out the pair of the first row with the last.
///
/// The last row is the one that was just computed: sums that begin with it wait for it.
#[inline(always)]
fn pairs<V: Lane, const NEWEST_LAST: bool>(rows: &[V], row: usize) -> (&[V], &[V], &[V]) {
    if NEWEST_LAST { (&rows[..row], &rows[row..], &rows[..rows.len() - row]) } else { (&rows[..row], rows, rows) }
}

/// The products of [`products_of_state`], and their directional derivative along the first tangent vector.
#[inline(always)]
pub(crate) fn products_of_state_and_tangent<V: Lane, const NEWEST_LAST: bool>(
    rows: &[V],
    row: usize,
) -> ([V; N], [V; N]) {
    let mut sums = ([V::splat(0.0); N], [V::splat(0.0); N]);
    let (first, xs, ys) = pairs::<V, NEWEST_LAST>(rows, row);
    for (x, y) in xs.chunks_exact(row).zip(ys.chunks_exact(row).rev()) {
        add_products_and_derivatives(&mut sums, x, y);
    }
    if NEWEST_LAST {
        add_products_and_derivatives(&mut sums, first, &rows[rows.len() - row..]);
    }
    sums
}

#[inline(always)]
fn add_products_and_derivatives<V: Lane>((state, tangent): &mut ([V; N], [V; N]), x: &[V], y: &[V]) {
    let (x, y) = (&x[..2 * GROUP], &y[..2 * GROUP]);
    let (omega, d_omega) = (&y[OMEGA..GROUP], &y[GROUP + OMEGA..]);
    add_products(state, x, omega);
    add_products(tangent, x, d_omega);
    add_products(tangent, &x[GROUP..], omega);
}

/// The derivatives of [`products_of_state`] along the `M` tangent vectors from group `at` on.
#[inline(always)]
pub(crate) fn products_of_tangents<V: Lane, const M: usize, const NEWEST_LAST: bool>(
    rows: &[V],
    row: usize,
    at: usize,
) -> [[V; N]; M] {
    let mut tangents = [[V::splat(0.0); N]; M];
    let (first, xs, ys) = pairs::<V, NEWEST_LAST>(rows, row);
    for (x, y) in xs.chunks_exact(row).zip(ys.chunks_exact(row).rev()) {
        add_derivatives(&mut tangents, x, y, at);
    }
    if NEWEST_LAST {
        add_derivatives(&mut tangents, first, &rows[rows.len() - row..], at);
    }
    tangents
}

#[inline(always)]
fn add_derivatives<V: Lane, const M: usize>(tangents: &mut [[V; N]; M], x: &[V], y: &[V], at: usize) {
    let (dx, dy) = (&x[at..at + M * GROUP], &y[at..at + M * GROUP]);
    for m in 0..M {
        add_products(&mut tangents[m], x, &dy[m * GROUP + OMEGA..(m + 1) * GROUP]);
        add_products(&mut tangents[m], &dx[m * GROUP..(m + 1) * GROUP], &y[OMEGA..GROUP]);
    }
}
