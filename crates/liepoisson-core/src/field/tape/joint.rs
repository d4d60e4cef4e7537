//! The state and its tangent vector in one go: each node's sums of products, its rule and that of its tangent part.
//!
//! A coefficient that is loaded serves the state and the tangent vector, sums of the current order stay in registers,
//! and the tape is read once for each order. Orders from 1 upwards; order 0 is in `rules`, and so are the rules that
//! are too rare to be worth it.

use super::convolution::{self, Sums};
use super::frame::{Frame, Group};
use super::program::Program;
use super::rules::{advance, advance_tangent, divided, minus};
use super::steps::{Joint, JointForm};
use crate::lanes::{Body, Lane};

/// Which sums an order needs.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// None: order 1.
    Empty,
    /// Those of this order and the next.
    Forming,
    /// Those that the order before has formed.
    Second,
}

const EMPTY: u8 = Phase::Empty as u8;
const FORMING: u8 = Phase::Forming as u8;
const SECOND: u8 = Phase::Second as u8;

/// Completes order `k >= 1` of the state and, with `TANGENT`, of its first tangent vector.
#[inline(always)]
pub(super) fn complete<V: Lane, const TANGENT: bool>(
    program: &Program,
    frame: &Frame,
    row: &[V],
    work: &mut [V],
    phase: Phase,
) {
    match phase {
        Phase::Empty => V::outline(Order::<V, TANGENT, EMPTY> { program, frame, row, work }),
        Phase::Forming => V::outline(Order::<V, TANGENT, FORMING> { program, frame, row, work }),
        Phase::Second => V::outline(Order::<V, TANGENT, SECOND> { program, frame, row, work }),
    }
}

/// One order, a function of its own: few registers are left over for what other orders need.
struct Order<'w, V, const TANGENT: bool, const PHASE: u8> {
    program: &'w Program,
    frame: &'w Frame,
    row: &'w [V],
    work: &'w mut [V],
}

impl<V: Lane, const TANGENT: bool, const PHASE: u8> Body for Order<'_, V, TANGENT, PHASE> {
    #[inline(always)]
    fn run(self) {
        run::<V, TANGENT, PHASE>(self.program, self.frame, self.row, self.work);
    }
}

/// Where the state and the tangent vector are.
struct Groups<'p> {
    state: &'p Group,
    tangent: &'p Group,
}

#[inline(always)]
fn run<V: Lane, const TANGENT: bool, const PHASE: u8>(program: &Program, frame: &Frame, row: &[V], work: &mut [V]) {
    let (state, tangent) = (frame.state(program), frame.tangent(program, 0));
    let groups = Groups { state: &state, tangent: &tangent };
    let k = state.k;
    assert!(k >= 1 && (k >= 2 || PHASE == EMPTY) && k < state.n_orders);
    let n = program.outputs.len();
    let over_k = 1.0 / k as f64;
    for joint in &program.joints {
        match *joint {
            Joint::Component { from, to } => {
                work[state.at(to[0])] = row[from];
                if TANGENT {
                    work[tangent.at(to[1])] = row[n + from];
                }
            }
            Joint::Affine { ref form, to } => {
                let [value, derivative] = groups.form::<V, TANGENT>(work, form);
                work[state.at(to[0])] = value;
                if TANGENT {
                    work[tangent.at(to[1])] = derivative;
                }
            }
            Joint::Product { a, b, sums, to } => {
                let (l, r) = (state.known(work, a[0]), state.known(work, b[0]));
                if TANGENT {
                    let (dl, dr) = (tangent.known(work, a[1]), tangent.known(work, b[1]));
                    let formed = || convolution::product_with_tangent([l, dl], [r, dr], k);
                    let [[sum, next], [dsum, dnext]] = groups.sums::<V, PHASE>(work, sums, formed);
                    let (mut sum, mut dsum) = (sum, dsum);
                    if PHASE == SECOND {
                        sum = add_late(l, r, k, sum);
                        dsum = add_late(dl, r, k, add_late(l, dr, k, dsum));
                    }
                    let value = add_ends(l, r, k, sum);
                    // what is computed last comes last
                    let dsum = dr[0].mul_add(l[k], dl[0].mul_add(r[k], dsum));
                    let derivative = dr[k].mul_add(l[0], dl[k].mul_add(r[0], dsum));
                    groups.keep::<V, PHASE>(work, sums, [next, dnext]);
                    work[state.at(to[0])] = value;
                    work[tangent.at(to[1])] = derivative;
                } else {
                    let [sum, next] = state.sums::<V, PHASE>(work, sums[0], || convolution::product(l, r, k));
                    let sum = if PHASE == SECOND { add_late(l, r, k, sum) } else { sum };
                    let value = add_ends(l, r, k, sum);
                    state.keep::<V, PHASE>(work, sums[0], next);
                    work[state.at(to[0])] = value;
                }
            }
            Joint::Square { a, sums, to } => {
                let l = state.known(work, a[0]);
                if TANGENT {
                    let dl = tangent.known(work, a[1]);
                    let formed = || convolution::square_with_tangent([l, dl], k);
                    let [[sum, next], [dsum, dnext]] = groups.sums::<V, PHASE>(work, sums, formed);
                    let (mut sum, mut dsum) = (sum, dsum);
                    if PHASE == SECOND {
                        sum = add_late(l, l, k, sum);
                        dsum = add_late(l, dl, k, dsum);
                    }
                    let value = add_ends(l, l, k, sum);
                    let derivative = add_ends(l, dl, k, dsum);
                    groups.keep::<V, PHASE>(work, sums, [next, dnext]);
                    work[state.at(to[0])] = value;
                    work[tangent.at(to[1])] = derivative.add(derivative);
                } else {
                    let [sum, next] = state.sums::<V, PHASE>(work, sums[0], || convolution::square(l, k));
                    let sum = if PHASE == SECOND { add_late(l, l, k, sum) } else { sum };
                    let value = add_ends(l, l, k, sum);
                    state.keep::<V, PHASE>(work, sums[0], next);
                    work[state.at(to[0])] = value;
                }
            }
            // b z = a: z_k b_0 = a_k - b_k z_0 - sum, and b dz = da - z db
            Joint::Quotient { a, b, z, sums, inverse } => {
                let (l, r) = (state.known(work, b[0]), state.known(work, z[0]));
                let inverse = work[state.singles + inverse];
                let numerator = a.map_or(V::splat(0.0), |a| work[state.at(a[0])]);
                if TANGENT {
                    let (dl, dr) = (tangent.known(work, b[1]), tangent.known(work, z[1]));
                    let formed = || convolution::product_with_tangent([l, dl], [r, dr], k);
                    let [[sum, next], [dsum, dnext]] = groups.sums::<V, PHASE>(work, sums, formed);
                    let (mut sum, mut dsum) = (sum, dsum);
                    if PHASE == SECOND {
                        sum = add_late(l, r, k, sum);
                        dsum = add_late(dl, r, k, add_late(l, dr, k, dsum));
                    }
                    let value = divided(minus(numerator, l[k].mul_add(r[0], sum)), inverse, k);
                    let dsum = dl[k].mul_add(r[0], dr[0].mul_add(l[k], dsum));
                    let numerator = a.map_or(V::splat(0.0), |a| work[tangent.at(a[1])]);
                    let derivative = divided(dl[0].neg_mul_add(value, minus(numerator, dsum)), inverse, k);
                    groups.keep::<V, PHASE>(work, sums, [next, dnext]);
                    work[state.start(z[0]) + k] = value;
                    work[tangent.start(z[1]) + k] = derivative;
                } else {
                    let [sum, next] = state.sums::<V, PHASE>(work, sums[0], || convolution::product(l, r, k));
                    let sum = if PHASE == SECOND { add_late(l, r, k, sum) } else { sum };
                    let value = divided(minus(numerator, l[k].mul_add(r[0], sum)), inverse, k);
                    state.keep::<V, PHASE>(work, sums[0], next);
                    work[state.start(z[0]) + k] = value;
                }
            }
            // k s_k = sum of j a_j c_(k-j), and ds = c da; the same for c with the other sign
            Joint::Pair { hyperbolic, weighted, da, first, second, to, sums } => {
                let w = state.known(work, weighted);
                let (s, c) = (state.known(work, first), state.known(work, second));
                let sign = if hyperbolic { 1.0 } else { -1.0 };
                let scale = [V::splat(over_k), V::splat(sign * over_k)];
                let sign = V::splat(sign);
                if TANGENT {
                    let da = tangent.known(work, da);
                    let both = || convolution::two_by_two([w, da], [c, s], k);
                    let [state_sums, tangent_sums] = match PHASE {
                        FORMING => both(),
                        _ => [
                            [state.stored::<V, PHASE>(work, sums[0]), state.stored::<V, PHASE>(work, sums[0] + 2)],
                            [tangent.stored::<V, PHASE>(work, sums[1]), tangent.stored::<V, PHASE>(work, sums[1] + 2)],
                        ],
                    };
                    let mut value = [V::splat(0.0); 2];
                    let mut derivative = [V::splat(0.0); 2];
                    for (i, series) in [c, s].into_iter().enumerate() {
                        let (mut sum, mut dsum) = (state_sums[i][0], tangent_sums[i][0]);
                        if PHASE == SECOND {
                            sum = add_late(w, series, k, sum);
                            dsum = add_late(da, series, k, dsum);
                        }
                        value[i] = w[k].mul_add(series[0], sum).mul(scale[i]);
                        derivative[i] = da[k].mul_add(series[0], dsum);
                    }
                    // sine and cosine of this order with da_0
                    let derivative = [da[0].mul_add(value[1], derivative[0]), da[0].mul_add(value[0], derivative[1])];
                    for i in 0..2 {
                        groups.keep::<V, PHASE>(
                            work,
                            sums.map(|at| at + 2 * i),
                            [state_sums[i][1], tangent_sums[i][1]],
                        );
                    }
                    work[state.start(first) + k] = value[0];
                    work[state.start(second) + k] = value[1];
                    if let Some(to) = to[0] {
                        work[tangent.at(to)] = derivative[0];
                    }
                    if let Some(to) = to[1] {
                        work[tangent.at(to)] = derivative[1].mul(sign);
                    }
                } else {
                    let formed = match PHASE {
                        FORMING => convolution::one_by_two(w, [c, s], k),
                        _ => [state.stored::<V, PHASE>(work, sums[0]), state.stored::<V, PHASE>(work, sums[0] + 2)],
                    };
                    let mut value = [V::splat(0.0); 2];
                    for (i, series) in [c, s].into_iter().enumerate() {
                        let sum = formed[i][0];
                        let sum = if PHASE == SECOND { add_late(w, series, k, sum) } else { sum };
                        value[i] = w[k].mul_add(series[0], sum).mul(scale[i]);
                    }
                    for i in 0..2 {
                        state.keep::<V, PHASE>(work, sums[0] + 2 * i, formed[i][1]);
                    }
                    work[state.start(first) + k] = value[0];
                    work[state.start(second) + k] = value[1];
                }
            }
            // z z = a: 2 z_k z_0 = a_k - sum, and 2 dz_k z_0 = da_k - 2 (z_k dz_0 + sum)
            Joint::Sqrt { a, z, sums, inverse } => {
                let l = state.known(work, z[0]);
                let inverse = work[state.singles + inverse];
                if TANGENT {
                    let dl = tangent.known(work, z[1]);
                    let formed = || convolution::square_with_tangent([l, dl], k);
                    let [[sum, next], [dsum, dnext]] = groups.sums::<V, PHASE>(work, sums, formed);
                    let (mut sum, mut dsum) = (sum, dsum);
                    if PHASE == SECOND {
                        sum = add_late(l, l, k, sum);
                        dsum = add_late(l, dl, k, dsum);
                    }
                    let value = minus(work[state.at(a[0])], sum).mul(inverse);
                    let dsum = dl[0].mul_add(value, dsum);
                    let derivative = dsum.neg_mul_add(V::splat(2.0), work[tangent.at(a[1])]).mul(inverse);
                    groups.keep::<V, PHASE>(work, sums, [next, dnext]);
                    work[state.start(z[0]) + k] = value;
                    work[tangent.start(z[1]) + k] = derivative;
                } else {
                    let [sum, next] = state.sums::<V, PHASE>(work, sums[0], || convolution::square(l, k));
                    let sum = if PHASE == SECOND { add_late(l, l, k, sum) } else { sum };
                    let value = minus(work[state.at(a[0])], sum).mul(inverse);
                    state.keep::<V, PHASE>(work, sums[0], next);
                    work[state.start(z[0]) + k] = value;
                }
            }
            Joint::Weigh { a, to } => work[state.start(to) + k] = work[state.at(a)].mul(V::splat(k as f64)),
            Joint::State(step) => advance(&program.steps[step], frame, &state, row, work),
            Joint::Tangent(step) => {
                if TANGENT {
                    advance_tangent(&program.tangent_steps[step], frame, &state, &tangent, &row[n..], work);
                }
            }
        }
    }
}

/// `sum`, with the terms `j = 1` and `j = k - 1`.
#[inline(always)]
fn add_late<V: Lane>(l: &[V], r: &[V], k: usize, sum: V) -> V {
    l[k - 1].mul_add(r[1], l[1].mul_add(r[k - 1], sum))
}

/// `sum + l_k r_0 + l_0 r_k`: what is computed last, the right factor, comes last.
#[inline(always)]
fn add_ends<V: Lane>(l: &[V], r: &[V], k: usize, sum: V) -> V {
    l[0].mul_add(r[k], l[k].mul_add(r[0], sum))
}

impl Group {
    /// The coefficients of a series up to the current order.
    #[inline(always)]
    fn known<'w, V>(&self, work: &'w [V], series: usize) -> &'w [V] {
        &work[self.start(series)..][..self.k + 1]
    }

    /// The sums of this order and the next, unless they are to be formed.
    #[inline(always)]
    fn stored<V: Lane, const PHASE: u8>(&self, work: &[V], sums: usize) -> Sums<V> {
        let zero = V::splat(0.0);
        if PHASE == SECOND { [work[self.singles + sums + 1], zero] } else { [zero; 2] }
    }

    #[inline(always)]
    fn sums<V: Lane, const PHASE: u8>(&self, work: &[V], sums: usize, formed: impl FnOnce() -> Sums<V>) -> Sums<V> {
        if PHASE == FORMING { formed() } else { self.stored::<V, PHASE>(work, sums) }
    }

    /// Keeps the sum of the next order.
    #[inline(always)]
    fn keep<V: Lane, const PHASE: u8>(&self, work: &mut [V], sums: usize, next: V) {
        if PHASE == FORMING {
            work[self.singles + sums + 1] = next;
        }
    }
}

/// The derivative of component `i` and, with `TANGENT`, that of the first tangent vector, before they are divided by the order.
///
/// Not with a closure for what is done with them: one that the compiler does not inline is compiled without the wide
/// registers, which was measured to halve the speed.
#[inline(always)]
pub(super) fn output<V: Lane, const TANGENT: bool>(program: &Program, frame: &Frame, work: &[V], i: usize) -> [V; 2] {
    let (state, tangent) = (frame.state(program), frame.tangent(program, 0));
    Groups { state: &state, tangent: &tangent }.form::<V, TANGENT>(work, &program.outputs[i])
}

impl Groups<'_> {
    #[inline(always)]
    fn form<V: Lane, const TANGENT: bool>(&self, work: &[V], form: &JointForm) -> [V; 2] {
        let constant = self.state.constant(form.constant);
        let mut sums = [V::splat(constant), V::splat(0.0)];
        for (number, &(slots, c)) in form.terms.iter().enumerate() {
            let c = V::splat(c);
            let x = work[self.state.at(slots[0])];
            sums[0] = if number == 0 && constant == 0.0 { x.mul(c) } else { x.mul_add(c, sums[0]) };
            if TANGENT {
                let dx = work[self.tangent.at(slots[1])];
                sums[1] = if number == 0 { dx.mul(c) } else { dx.mul_add(c, sums[1]) };
            }
        }
        sums
    }

    #[inline(always)]
    fn sums<V: Lane, const PHASE: u8>(
        &self,
        work: &[V],
        sums: [usize; 2],
        formed: impl FnOnce() -> [Sums<V>; 2],
    ) -> [Sums<V>; 2] {
        if PHASE == FORMING {
            formed()
        } else {
            [self.state.stored::<V, PHASE>(work, sums[0]), self.tangent.stored::<V, PHASE>(work, sums[1])]
        }
    }

    #[inline(always)]
    fn keep<V: Lane, const PHASE: u8>(&self, work: &mut [V], sums: [usize; 2], next: [V; 2]) {
        self.state.keep::<V, PHASE>(work, sums[0], next[0]);
        self.tangent.keep::<V, PHASE>(work, sums[1], next[1]);
    }
}
