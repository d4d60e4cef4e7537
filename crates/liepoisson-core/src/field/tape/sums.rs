//! Sums of products that no joint step forms: those of rare rules, and of tangent vectors after the first.

use super::convolution;
use super::frame::Frame;
use super::program::Program;
use super::steps::Kind;
use crate::lanes::Lane;

/// Sums of products for this order and the next.
#[inline(always)]
pub(super) fn form<V: Lane>(program: &Program, frame: &Frame, work: &mut [V]) {
    let state = frame.state(program);
    let k = frame.k;
    for convolution in program.separate.iter().map(|&index| &program.convolutions[index]) {
        let sums = state.singles + convolution.sums;
        let l = state.series(work, convolution.left);
        let r = convolution.right.map(|right| state.series(work, right));
        let tangent = convolution.tangent.filter(|_| frame.n_tangents > 0);
        if let Some(part) = tangent {
            let group = frame.tangent(program, 0);
            let (dl, dr) = (group.series(work, part.left), group.series(work, part.right));
            let dsums = group.singles + part.sums;
            match convolution.kind {
                Kind::Product => {
                    let [value, derivative] = convolution::product_with_tangent([l, dl], [r[0], dr], k);
                    put(work, sums, value);
                    put(work, dsums, derivative);
                }
                Kind::Square => {
                    let [value, derivative] = convolution::square_with_tangent([l, dl], k);
                    put(work, sums, value);
                    put(work, dsums, derivative);
                }
                Kind::Single => {
                    let [value, derivative] = convolution::two_by_one([l, dl], r[0], k);
                    put(work, sums, value);
                    put(work, dsums, derivative);
                }
                Kind::Pair => {
                    let [values, derivatives] = convolution::two_by_two([l, dl], r, k);
                    for i in 0..2 {
                        put(work, sums + 2 * i, values[i]);
                        put(work, dsums + 2 * i, derivatives[i]);
                    }
                }
            }
        } else {
            match convolution.kind {
                Kind::Product | Kind::Single => {
                    let value = convolution::product(l, r[0], k);
                    put(work, sums, value);
                }
                Kind::Square => {
                    let value = convolution::square(l, k);
                    put(work, sums, value);
                }
                Kind::Pair => {
                    let values = convolution::one_by_two(l, r, k);
                    put(work, sums, values[0]);
                    put(work, sums + 2, values[1]);
                }
            }
        }
    }
    for tangent in 1..frame.n_tangents {
        form_of_tangent(program, frame, tangent, work);
    }
}

#[inline(always)]
fn put<V: Lane>(work: &mut [V], at: usize, sums: convolution::Sums<V>) {
    work[at..at + 2].copy_from_slice(&sums);
}

/// The same for a tangent vector after the first, which comes with the state.
#[inline(always)]
fn form_of_tangent<V: Lane>(program: &Program, frame: &Frame, tangent: usize, work: &mut [V]) {
    let (state, group, k) = (frame.state(program), frame.tangent(program, tangent), frame.k);
    for convolution in &program.convolutions {
        let Some(part) = convolution.tangent else { continue };
        let sums = group.singles + part.sums;
        let l = state.series(work, convolution.left);
        let r = convolution.right.map(|right| state.series(work, right));
        let (dl, dr) = (group.series(work, part.left), group.series(work, part.right));
        match convolution.kind {
            Kind::Product => {
                let (first, second) = (convolution::product(l, dr, k), convolution::product(dl, r[0], k));
                put(work, sums, [first[0].add(second[0]), first[1].add(second[1])]);
            }
            Kind::Square => {
                let sum = convolution::product(l, dl, k);
                put(work, sums, sum);
            }
            Kind::Single => {
                let sum = convolution::product(dl, r[0], k);
                put(work, sums, sum);
            }
            Kind::Pair => {
                let both = convolution::one_by_two(dl, r, k);
                put(work, sums, both[0]);
                put(work, sums + 2, both[1]);
            }
        }
    }
}
