//! The charged and the twisted top: so(3) (x) A for dim A = 3, all cross products fused.

use super::{Field, Majorant, SinglePrecision, Space, Terms, over};
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
        Ok(Top {
            a,
            b,
            twist: a.map(|component| epsilon * component),
            inverse_inertia: inertia.map(f64::recip),
            asymmetry: [(i2 - i3) / i2, (i3 - i1) / i3, (i1 - i2) / i1],
        })
    }

    #[inline(always)]
    fn omega<V: Lane>(&self, group: &[V; N]) -> [V; 3] {
        let mut omega = [V::splat(0.0); 3];
        for i in 0..3 {
            omega[i] = group[i].mul(V::splat(self.inverse_inertia[i]));
        }
        omega
    }

    /// The work quantities of some groups.
    #[inline(always)]
    fn derive_work_of<V: Lane>(&self, groups: &mut [V]) {
        for group in groups.chunks_exact_mut(GROUP) {
            for i in 0..3 {
                group[OMEGA + i] = group[i].mul(V::splat(self.inverse_inertia[i]));
            }
        }
    }

    /// The next coefficients of the state, and of the `first` tangent vector if there is one.
    #[inline(always)]
    fn extend_state<V: Lane>(&self, known: &[V], next: &mut [V], row: usize, first: usize) {
        let (order, last) = (known.len() / row, known.len() - row);
        // With 32 registers the state and the first tangent vector share the coefficients that they load. The sums are
        // the same, term by term, so a trajectory has the same bits either way.
        if first == 1 && V::REGISTERS >= 32 {
            let (mut derivative, mut tangent) = products_of_state_and_tangent(known, row);
            self.finish(&mut derivative, group_of(known, last));
            store(next, 0, &derivative, order);
            self.finish(&mut tangent, group_of(known, last + GROUP));
            store(next, GROUP, &tangent, order);
            return;
        }
        let mut derivative = products_of_state(known, row);
        self.finish(&mut derivative, group_of(known, last));
        store(next, 0, &derivative, order);
        if first == 1 {
            self.extend_tangents::<V, 1>(known, next, row, GROUP);
        }
    }

    /// The next coefficients of the `M` tangent vectors from group `at` on.
    #[inline(always)]
    fn extend_tangents<V: Lane, const M: usize>(&self, known: &[V], next: &mut [V], row: usize, at: usize) {
        let (order, last) = (known.len() / row, known.len() - row);
        let mut tangents = products_of_tangents::<V, M>(known, row, at);
        for m in 0..M {
            self.finish(&mut tangents[m], group_of(known, last + at + m * GROUP));
            store(next, at + m * GROUP, &tangents[m], order);
        }
    }

    /// The series of these tangent vectors, where that of the state is known; the registers that they take.
    #[inline(always)]
    fn expand_tangents<V: Lane, const M: usize>(&self, rows: &mut [V], row: usize, at: usize, order: usize) -> usize {
        for k in 0..order {
            self.derive_work_of(&mut rows[k * row + at..][..M * GROUP]);
            let (known, next) = rows.split_at_mut((k + 1) * row);
            self.extend_tangents::<V, M>(known, next, row, at);
        }
        M * GROUP
    }

    /// Terms linear in the coefficients, and the factor of `l x omega`: the sum of products becomes the derivative.
    #[inline(always)]
    fn finish<V: Lane>(&self, derivative: &mut [V; N], row: &[V]) {
        for i in 0..3 {
            derivative[i] = derivative[i].mul(V::splat(self.asymmetry[i]));
        }
        add_cross_with_constant(derivative, 0, row, 3, &self.a);
        add_cross_with_constant(derivative, 0, row, 6, &self.b);
        add_cross_with_constant(derivative, 3, row, 6, &self.twist);
    }
}

impl Space for Top {
    fn n_components(&self) -> usize {
        N
    }

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
        self.derive_work_of(&mut rows[k * row..(k + 1) * row]);
    }

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        let row = self.row(n_tangents);
        let (known, next) = rows.split_at_mut((k + 1) * row);
        let first = n_tangents.min(1);
        self.extend_state(known, next, row, first);
        for i in 1 + first..=n_tangents {
            self.extend_tangents::<V, 1>(known, next, row, i * GROUP);
        }
    }

    /// The state and the first tangent vector are expanded to the last order, then the others one or two at a time: with the
    /// state, these coefficients stay in the nearest cache, where those of all tangent vectors would not.
    #[inline(always)]
    fn expand<V: Lane>(&self, rows: &mut [V], n_tangents: usize, order: usize) {
        let (row, first) = (self.row(n_tangents), n_tangents.min(1));
        for k in 0..order {
            self.derive_work_of(&mut rows[k * row..][..(1 + first) * GROUP]);
            let (known, next) = rows.split_at_mut((k + 1) * row);
            self.extend_state(known, next, row, first);
        }
        let mut at = (1 + first) * GROUP;
        while at < row {
            at += match (row - at) / GROUP {
                2.. if V::REGISTERS >= 32 => self.expand_tangents::<V, 2>(rows, row, at, order),
                _ => self.expand_tangents::<V, 1>(rows, row, at, order),
            };
        }
    }

    /// The sums of [`Field::extend`] for order 0, in registers.
    #[inline(always)]
    fn rates<V: Lane>(&self, x: &[V], _n_tangents: usize, _work: &mut [V], rates: &mut [V]) {
        V::outline(Rates { top: self, x, rates });
    }
}

struct Rates<'a, V> {
    top: &'a Top,
    x: &'a [V],
    rates: &'a mut [V],
}

impl<V: Lane> Body for Rates<'_, V> {
    #[inline(always)]
    fn run(self) {
        let Rates { top, x, rates } = self;
        let (groups, _) = x.as_chunks::<N>();
        let state = groups[0];
        let omega = top.omega(&state);
        for (g, (group, to)) in groups.iter().zip(rates.as_chunks_mut::<N>().0).enumerate() {
            let mut sum = [V::splat(0.0); N];
            if g == 0 {
                add_products(&mut sum, &state, &omega);
            } else {
                add_products(&mut sum, &state, &top.omega(group));
                add_products(&mut sum, group, &omega);
            }
            top.finish(&mut sum, group);
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
fn add_cross_with_constant<V: Lane>(sum: &mut [V; N], at: usize, row: &[V], from: usize, c: &[f64; 3]) {
    for axis in 0..3 {
        if c[axis] != 0.0 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let factor = V::splat(c[axis]);
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
pub(crate) fn products_of_state<V: Lane>(rows: &[V], row: usize) -> [V; N] {
    let mut sum = [V::splat(0.0); N];
    for (x, y) in rows.chunks_exact(row).zip(rows.chunks_exact(row).rev()) {
        add_products(&mut sum, &x[..OMEGA], &y[OMEGA..GROUP]);
    }
    sum
}

/// The products of [`products_of_state`], and their directional derivative along the first tangent vector.
#[inline(always)]
pub(crate) fn products_of_state_and_tangent<V: Lane>(rows: &[V], row: usize) -> ([V; N], [V; N]) {
    let mut state = [V::splat(0.0); N];
    let mut tangent = [V::splat(0.0); N];
    for (x, y) in rows.chunks_exact(row).zip(rows.chunks_exact(row).rev()) {
        let (x, y) = (&x[..2 * GROUP], &y[..2 * GROUP]);
        let (omega, d_omega) = (&y[OMEGA..GROUP], &y[GROUP + OMEGA..]);
        add_products(&mut state, x, omega);
        add_products(&mut tangent, x, d_omega);
        add_products(&mut tangent, &x[GROUP..], omega);
    }
    (state, tangent)
}

/// The derivatives of [`products_of_state`] along the `M` tangent vectors from group `at` on.
#[inline(always)]
pub(crate) fn products_of_tangents<V: Lane, const M: usize>(rows: &[V], row: usize, at: usize) -> [[V; N]; M] {
    let mut tangents = [[V::splat(0.0); N]; M];
    for (x, y) in rows.chunks_exact(row).zip(rows.chunks_exact(row).rev()) {
        let (dx, dy) = (&x[at..at + M * GROUP], &y[at..at + M * GROUP]);
        for m in 0..M {
            add_products(&mut tangents[m], x, &dy[m * GROUP + OMEGA..(m + 1) * GROUP]);
            add_products(&mut tangents[m], &dx[m * GROUP..(m + 1) * GROUP], &y[OMEGA..GROUP]);
        }
    }
    tangents
}
