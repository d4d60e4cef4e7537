//! The top for one trajectory alone: registers hold the components of a vector instead of trajectories.

use super::{Field, Top};
use crate::lanes::{Lane, Triple, as_scalars_mut};

/// Each vector is followed by a zero, so that a register holds it: `l 0 alpha 0 beta 0`.
const N: usize = 12;
const L: usize = 0;
const ALPHA: usize = 4;
const BETA: usize = 8;
// work quantities
const ALPHA_ROTATED: usize = 12;
const BETA_ROTATED: usize = 16;
const OMEGA: usize = 20;
const OMEGA_ROTATED: usize = 24;
const GROUP: usize = 28;

/// The field of [`Top`] on states in which a zero follows each vector (12 numbers), without tangent vectors.
///
/// With `r` for the rotation `(1, 2, 3) -> (2, 3, 1)`, `u x w = r(u r(w) - r(u) w)`, so a cross product is two products
/// of registers, and the rotation of a sum is made once. Sums run in two interleaved halves to hide the latency of the
/// processor: results differ from those of [`Top`] in the last bits.
#[derive(Clone, Copy, Debug)]
pub struct SingleTop {
    top: Top,
}

impl SingleTop {
    /// The same top, for one trajectory.
    pub fn new(top: Top) -> SingleTop {
        SingleTop { top }
    }

    /// A state of nine numbers with the zeros put in.
    pub fn pad(state: &[f64]) -> Vec<f64> {
        state.chunks_exact(3).flat_map(|vector| [vector[0], vector[1], vector[2], 0.0]).collect()
    }

    /// Numbers with every fourth left out.
    pub fn strip(padded: &[f64]) -> Vec<f64> {
        padded.chunks_exact(4).flat_map(|vector| [vector[0], vector[1], vector[2]]).collect()
    }
}

impl Field for SingleTop {
    fn n_components(&self) -> usize {
        N
    }

    fn group(&self) -> usize {
        GROUP
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, rows: &mut [V], _n_tangents: usize, k: usize) {
        let row = &mut as_scalars_mut(rows)[k * GROUP..(k + 1) * GROUP];
        let omega = V::Triple::load(&row[L..]).mul(triple::<V>(&self.top.inverse_inertia));
        V::Triple::load(&row[ALPHA..]).rotate().store(&mut row[ALPHA_ROTATED..]);
        V::Triple::load(&row[BETA..]).rotate().store(&mut row[BETA_ROTATED..]);
        omega.store(&mut row[OMEGA..]);
        omega.rotate().store(&mut row[OMEGA_ROTATED..]);
    }

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        assert!(V::WIDTH == 1 && n_tangents == 0, "a single top is one trajectory without tangent vectors");
        let (known, next) = as_scalars_mut(rows).split_at_mut((k + 1) * GROUP);
        let (mut even, mut odd) = (Sums::<V::Triple>::zero(), Sums::<V::Triple>::zero());
        let mut terms = known.chunks_exact(GROUP).zip(known.chunks_exact(GROUP).rev());
        while let Some((x, y)) = terms.next() {
            even.add_term(x, y);
            if let Some((x, y)) = terms.next() {
                odd.add_term(x, y);
            }
        }
        let sums = even.plus(odd);
        let row = &known[k * GROUP..];
        let (alpha, beta) = (V::Triple::load(&row[ALPHA..]), V::Triple::load(&row[BETA..]));
        let (alpha_rotated, beta_rotated) =
            (V::Triple::load(&row[ALPHA_ROTATED..]), V::Triple::load(&row[BETA_ROTATED..]));
        let scale = V::Triple::splat(1.0 / (k + 1) as f64);
        // l omega_rotated = (l1 omega2, l2 omega3, l3 omega1): rotated, these are the products that `asymmetry` expects
        let spin = sums.l.rotate().mul(triple::<V>(&self.top.asymmetry));
        let l =
            cross::<V>(alpha, alpha_rotated, &self.top.a).add(cross::<V>(beta, beta_rotated, &self.top.b)).add(spin);
        let turn = |plus: V::Triple, minus: V::Triple| plus.sub(minus).rotate();
        let alpha = turn(sums.alpha, sums.alpha_rotated).add(cross::<V>(beta, beta_rotated, &self.top.twist));
        l.mul(scale).store(&mut next[L..]);
        alpha.mul(scale).store(&mut next[ALPHA..]);
        turn(sums.beta, sums.beta_rotated).mul(scale).store(&mut next[BETA..]);
    }
}

/// Sums of products of coefficients: of each vector with `omega` rotated, and of each vector rotated with `omega`.
struct Sums<T> {
    l: T,
    alpha: T,
    alpha_rotated: T,
    beta: T,
    beta_rotated: T,
}

impl<T: Triple> Sums<T> {
    #[inline(always)]
    fn zero() -> Self {
        let zero = T::splat(0.0);
        Sums { l: zero, alpha: zero, alpha_rotated: zero, beta: zero, beta_rotated: zero }
    }

    #[inline(always)]
    fn add_term(&mut self, x: &[f64], y: &[f64]) {
        let (omega, omega_rotated) = (T::load(&y[OMEGA..]), T::load(&y[OMEGA_ROTATED..]));
        self.l = T::load(&x[L..]).mul_add(omega_rotated, self.l);
        self.alpha = T::load(&x[ALPHA..]).mul_add(omega_rotated, self.alpha);
        self.alpha_rotated = T::load(&x[ALPHA_ROTATED..]).mul_add(omega, self.alpha_rotated);
        self.beta = T::load(&x[BETA..]).mul_add(omega_rotated, self.beta);
        self.beta_rotated = T::load(&x[BETA_ROTATED..]).mul_add(omega, self.beta_rotated);
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Sums {
            l: self.l.add(other.l),
            alpha: self.alpha.add(other.alpha),
            alpha_rotated: self.alpha_rotated.add(other.alpha_rotated),
            beta: self.beta.add(other.beta),
            beta_rotated: self.beta_rotated.add(other.beta_rotated),
        }
    }
}

#[inline(always)]
fn triple<V: Lane>(c: &[f64; 3]) -> V::Triple {
    V::Triple::load(&[c[0], c[1], c[2], 0.0])
}

/// `u x c` for a constant `c`.
#[inline(always)]
fn cross<V: Lane>(u: V::Triple, u_rotated: V::Triple, c: &[f64; 3]) -> V::Triple {
    let c = triple::<V>(c);
    u.mul(c.rotate()).sub(u_rotated.mul(c)).rotate()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padding_and_stripping_are_inverse() {
        let state: Vec<f64> = (1..=9).map(f64::from).collect();
        let padded = SingleTop::pad(&state);
        assert_eq!((padded[3], padded[7], padded[11]), (0.0, 0.0, 0.0));
        assert_eq!(SingleTop::strip(&padded), state);
    }
}
