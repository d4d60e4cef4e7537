//! The rules for power series, order by order, for the state and for tangent vectors.
//!
//! Sums of products run over `j = 1..k`; the ends, which need coefficients of order `k`, are added here.

use super::elementary::Called;
use super::frame::{Frame, Group};
use super::graph::Function;
use super::program::Program;
use super::steps::{Step, TangentStep};
use crate::lanes::Lane;

impl Group {
    /// A series of this group with one of another.
    #[inline(always)]
    fn factors<'w, V>(&self, work: &'w [V], l: usize, other: &Group, r: usize, frame: &Frame) -> Factors<'w, V> {
        Factors { l: self.series(work, l), r: other.series(work, r), k: frame.k, is_second: frame.is_second }
    }
}

/// Two series of one product.
#[derive(Clone, Copy)]
struct Factors<'w, V> {
    l: &'w [V],
    r: &'w [V],
    k: usize,
    is_second: bool,
}

impl<V: Lane> Factors<'_, V> {
    /// `sum`, with the terms `j = 1` and `j = k - 1` if they are not yet in it.
    #[inline(always)]
    fn add_late(self, mut sum: V) -> V {
        if self.is_second {
            sum = self.l[1].mul_add(self.r[self.k - 1], sum);
            sum = self.l[self.k - 1].mul_add(self.r[1], sum);
        }
        sum
    }

    /// `sum + l_k r_0`
    #[inline(always)]
    fn add_left_end(self, sum: V) -> V {
        self.l[self.k].mul_add(self.r[0], sum)
    }

    /// `sum + l_0 r_k`
    #[inline(always)]
    fn add_right_end(self, sum: V) -> V {
        self.l[0].mul_add(self.r[self.k], sum)
    }

    /// `sum + l_k r_0`; at order 0, where it is the same as `l_0 r_k`, `sum`.
    #[inline(always)]
    fn add_left_end_unless_same(self, sum: V) -> V {
        if self.k == 0 { sum } else { self.add_left_end(sum) }
    }

    /// `sum + l_k r_0 + l_0 r_k`: what is computed last, the right factor, comes last.
    #[inline(always)]
    fn add_ends(self, sum: V) -> V {
        self.add_right_end(self.add_left_end_unless_same(sum))
    }
}

/// Order 0 of the state. Where a rule has no value or no series, it shows in the register of the defect. A number beyond the
/// range, and what is computed of it, does not: what is divided by it is zero, and everything else that it enters shows that it is not
/// finite. Nor do the components: they are the state.
#[inline(always)]
pub(super) fn start<V: Lane>(program: &Program, state: &Group, row: &[V], work: &mut [V]) {
    let (one, zero) = (V::splat(1.0), V::splat(0.0));
    let mut defect = zero;
    for step in &program.steps {
        let value = match *step {
            Step::Component { from, to } => {
                work[state.at(to)] = row[from];
                None
            }
            Step::Affine { ref form, to } => {
                let value = state.form(work, form);
                work[state.at(to)] = value;
                None
            }
            Step::Product { a, b, to, .. } => {
                let value = work[state.start(a)].mul(work[state.start(b)]);
                work[state.at(to)] = value;
                None
            }
            Step::Square { a, to, .. } => {
                let a = work[state.start(a)];
                let value = a.mul(a);
                work[state.at(to)] = value;
                None
            }
            Step::Quotient { a, b, inverse, to, .. } => {
                let b = work[state.start(b)];
                let reciprocal = one.div(b);
                let value = a.map_or(reciprocal, |a| work[state.at(a)].div(b));
                work[state.singles + inverse] = reciprocal;
                work[state.start(to)] = value;
                // an inverse that is not finite shows in the series
                Some(value)
            }
            Step::Sqrt { a, inverse, to, .. } => {
                let value = work[state.at(a)].sqrt();
                let reciprocal = V::splat(0.5).div(value);
                work[state.singles + inverse] = reciprocal;
                work[state.start(to)] = value;
                Some(reciprocal)
            }
            Step::Weigh { to, .. } => {
                work[state.start(to)] = zero;
                None
            }
            Step::Integral { function, a, to, .. } => {
                let [value, _] = Called::One(function).of(work[state.at(a)]);
                work[state.at(to)] = value;
                (function != Function::Exp).then_some(value)
            }
            Step::Pair { a, hyperbolic, first, second, .. } => {
                let a = work[state.at(a)];
                let [one, other] = Called::Pair { hyperbolic }.of(a);
                work[state.start(first)] = one;
                work[state.start(second)] = other;
                None
            }
            Step::DividedIntegral { function, a, divisor, weighted, inverse, to, .. } => {
                let [value, _] = Called::One(function).of(work[state.at(a)]);
                let reciprocal = one.div(work[state.start(divisor)]);
                work[state.singles + inverse] = reciprocal;
                work[state.start(weighted)] = zero;
                work[state.at(to)] = value;
                Some(value.add(reciprocal))
            }
        };
        if let Some(value) = value {
            defect = value.mul_add(zero, defect);
        }
    }
    work[state.singles + program.defect] = defect;
}

/// Order `k >= 1` of the state.
#[inline(always)]
pub(super) fn advance<V: Lane>(step: &Step, frame: &Frame, state: &Group, row: &[V], work: &mut [V]) {
    let k = frame.k;
    let inverse_of = |work: &[V], inverse: usize| work[state.singles + inverse];
    match *step {
        Step::Component { from, to } => work[state.at(to)] = row[from],
        Step::Affine { ref form, to } => work[state.at(to)] = state.form(work, form),
        Step::Product { a, b, sums, to } => {
            let factors = state.factors(work, a, state, b, frame);
            work[state.at(to)] = factors.add_ends(factors.add_late(state.formed(work, sums, frame)));
        }
        Step::Square { a, sums, to } => {
            let factors = state.factors(work, a, state, a, frame);
            work[state.at(to)] = factors.add_ends(factors.add_late(state.formed(work, sums, frame)));
        }
        // b z = a: z_k b_0 = a_k - b_k z_0 - sum
        Step::Quotient { a, b, sums, inverse, to } => {
            let factors = state.factors(work, b, state, to, frame);
            let sum = factors.add_left_end(factors.add_late(state.formed(work, sums, frame)));
            let a = a.map_or(V::splat(0.0), |a| work[state.at(a)]);
            work[state.start(to) + k] = divided(minus(a, sum), inverse_of(work, inverse), k);
        }
        // z z = a: 2 z_k z_0 = a_k - sum
        Step::Sqrt { a, sums, inverse, to } => {
            let factors = state.factors(work, to, state, to, frame);
            let sum = factors.add_late(state.formed(work, sums, frame));
            work[state.start(to) + k] = minus(work[state.at(a)], sum).mul(inverse_of(work, inverse));
        }
        Step::Weigh { a, to } => work[state.start(to) + k] = work[state.at(a)].mul(V::splat(k as f64)),
        // k z_k = factor (sum + k a_k w_0)
        Step::Integral { weighted, derivative, factor, sums, to, .. } => {
            let factors = state.factors(work, weighted, state, derivative, frame);
            let sum = factors.add_left_end(factors.add_late(state.formed(work, sums, frame)));
            work[state.at(to)] = sum.mul(V::splat(factor / k as f64));
        }
        Step::Pair { hyperbolic, weighted, first, second, sums, .. } => {
            let scale = 1.0 / k as f64;
            let of_first = state.factors(work, weighted, state, second, frame);
            let of_second = state.factors(work, weighted, state, first, frame);
            let sum = of_first.add_left_end(of_first.add_late(state.formed(work, sums, frame)));
            let other = of_second.add_left_end(of_second.add_late(state.formed(work, sums + 2, frame)));
            work[state.start(first) + k] = sum.mul(V::splat(scale));
            work[state.start(second) + k] = other.mul(V::splat(if hyperbolic { scale } else { -scale }));
        }
        // k z_k d_0 = factor k a_k - sum
        Step::DividedIntegral { a, factor, divisor, weighted, sums, inverse, to, .. } => {
            let factors = state.factors(work, weighted, state, divisor, frame);
            let sum = factors.add_late(state.formed(work, sums, frame));
            let right = work[state.at(a)].mul(V::splat(factor * k as f64));
            let slope = divided(minus(right, sum), inverse_of(work, inverse), k);
            work[state.start(weighted) + k] = slope;
            work[state.at(to)] = slope.mul(V::splat(1.0 / k as f64));
        }
    }
}

/// `rest * inverse` at order `k`, for the inverse of a divisor: zero where the divisor is beyond the range of numbers, whatever its
/// series. Compiled code is left there, where the first orders find it.
#[inline(always)]
pub(super) fn divided<V: Lane>(rest: V, inverse: V, k: usize) -> V {
    let quotient = rest.mul(inverse);
    if !V::IS_RECORDED {
        return quotient.where_not_zero(inverse);
    }
    if k <= 1 {
        V::splat(f64::MIN_POSITIVE * f64::EPSILON).record_limit(inverse.abs());
    }
    quotient
}

/// `a - b`
#[inline(always)]
pub(super) fn minus<V: Lane>(a: V, b: V) -> V {
    b.neg_mul_add(V::splat(1.0), a)
}

/// Any order of a tangent vector, after that of the state.
#[inline(always)]
pub(super) fn advance_tangent<V: Lane>(
    step: &TangentStep,
    frame: &Frame,
    state: &Group,
    tangent: &Group,
    row: &[V],
    work: &mut [V],
) {
    let k = frame.k;
    let inverse_of = |work: &[V], inverse: usize| work[state.singles + inverse];
    match *step {
        TangentStep::Component { from, to } => work[tangent.at(to)] = row[from],
        TangentStep::Affine { ref form, to } => work[tangent.at(to)] = tangent.form(work, form),
        // the ends that have tangent parts of order k come last, since those are the last to be computed
        TangentStep::Product { a, b, da, db, sums, to } => {
            let first = state.factors(work, a, tangent, db, frame);
            let second = state.factors(work, b, tangent, da, frame);
            let sum = second.add_late(first.add_late(tangent.formed(work, sums, frame)));
            let sum = second.add_left_end_unless_same(first.add_left_end_unless_same(sum));
            work[tangent.at(to)] = first.add_right_end(second.add_right_end(sum));
        }
        TangentStep::Square { a, da, sums, to } => {
            let factors = state.factors(work, a, tangent, da, frame);
            let sum = factors.add_ends(factors.add_late(tangent.formed(work, sums, frame)));
            work[tangent.at(to)] = sum.add(sum);
        }
        // b dz + z db = da
        TangentStep::Quotient { da, b, z, db, sums, inverse, to } => {
            let of_z = state.factors(work, z, tangent, db, frame);
            let of_b = state.factors(work, b, tangent, to, frame);
            let sum = of_b.add_late(of_z.add_late(tangent.formed(work, sums, frame)));
            let sum = of_z.add_ends(of_b.add_left_end_unless_same(sum));
            let da = da.map_or(V::splat(0.0), |da| work[tangent.at(da)]);
            work[tangent.start(to) + k] = divided(minus(da, sum), inverse_of(work, inverse), k);
        }
        // z dz = da / 2, and the inverse is that of 2 z_0
        TangentStep::Sqrt { da, z, sums, inverse, to } => {
            let factors = state.factors(work, z, tangent, to, frame);
            let sum = factors.add_left_end_unless_same(factors.add_late(tangent.formed(work, sums, frame)));
            let rest = sum.neg_mul_add(V::splat(2.0), work[tangent.at(da)]);
            work[tangent.start(to) + k] = rest.mul(inverse_of(work, inverse));
        }
        TangentStep::Integral { w, da, factor, sums, to } => {
            let factors = state.factors(work, w, tangent, da, frame);
            let sum = factors.add_ends(factors.add_late(tangent.formed(work, sums, frame)));
            work[tangent.at(to)] = sum.mul(V::splat(factor));
        }
        TangentStep::DividedIntegral { da, factor, divisor, sums, inverse, to } => {
            let factors = state.factors(work, divisor, tangent, to, frame);
            let sum = factors.add_left_end_unless_same(factors.add_late(tangent.formed(work, sums, frame)));
            let right = work[tangent.at(da)].mul(V::splat(factor));
            work[tangent.start(to) + k] = divided(minus(right, sum), inverse_of(work, inverse), k);
        }
    }
}
