//! One order after the other: sums of products, then the rules, then the derivatives of the components.

use super::frame::Frame;
use super::joint::{self, Phase};
use super::program::Program;
use super::rules::{advance_tangent, start};
use super::sums;
use crate::field::over_uniformly;
use crate::lanes::Lane;

/// Completes order `k` of all series, given the components of that order (of the state, then of each tangent vector).
#[inline(always)]
pub(super) fn complete_order<V: Lane>(program: &Program, frame: &Frame, row: &[V], work: &mut [V]) {
    let n = program.outputs.len();
    let state = frame.state(program);
    if frame.k == 0 {
        work[state.singles..].fill(V::splat(0.0)); // the sums of order 1
        start(program, &state, row, work);
    } else {
        let phase = match frame.k {
            1 => Phase::Empty,
            _ if frame.is_second => Phase::Second,
            _ => Phase::Forming,
        };
        if phase == Phase::Forming {
            sums::form(program, frame, work);
        }
        if frame.n_tangents > 0 {
            joint::complete::<V, true>(program, frame, row, work, phase);
        } else {
            joint::complete::<V, false>(program, frame, row, work, phase);
        }
    }
    for tangent in usize::from(frame.k > 0)..frame.n_tangents {
        let group = frame.tangent(program, tangent);
        for step in &program.tangent_steps {
            advance_tangent(step, frame, &state, &group, &row[(1 + tangent) * n..], work);
        }
    }
}

/// The derivatives of the components: order `k + 1` of their series. A defect shows in the first one, which the size of a state contains.
#[inline(always)]
pub(super) fn write_outputs<V: Lane>(program: &Program, frame: &Frame, next: &mut [V], work: &[V]) {
    let n = program.outputs.len();
    let order = frame.k + 1;
    let defect = work[frame.state(program).singles + program.defect];
    if frame.n_tangents == 0 {
        for (i, to) in next[..n].iter_mut().enumerate() {
            let [value, _] = joint::output::<V, false>(program, frame, work, i);
            *to = over_uniformly(value, order);
        }
    } else {
        let (values, derivatives) = next.split_at_mut(n);
        for (i, (to, derivative_to)) in values.iter_mut().zip(derivatives.iter_mut()).enumerate() {
            let [value, derivative] = joint::output::<V, true>(program, frame, work, i);
            *to = over_uniformly(value, order);
            *derivative_to = over_uniformly(derivative, order);
        }
    }
    next[0] = next[0].add(defect);
    for tangent in 1..frame.n_tangents {
        let group = frame.tangent(program, tangent);
        for (to, form) in next[(1 + tangent) * n..].iter_mut().zip(&program.tangent_outputs) {
            *to = over_uniformly(group.form(work, form), order);
        }
    }
}

/// The coefficients of order `k` of functions, which are the outputs of a program that is not a field.
#[inline(always)]
pub(super) fn write_functions<V: Lane>(program: &Program, frame: &Frame, to: &mut [f64], work: &[V]) {
    let defect = work[frame.state(program).singles + program.defect];
    for (i, to) in to[..program.outputs.len()].iter_mut().enumerate() {
        let [value, _] = joint::output::<V, false>(program, frame, work, i);
        *to = value.add(defect).get(0);
    }
}
