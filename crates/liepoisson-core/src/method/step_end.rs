//! Whether the series of a step still obeys the equations where the step ends.
//!
//! The terms of a series say nothing about a force that is too weak to be seen where the step begins: that of `q^26` at
//! `q = 0` has no term up to order 24, that of `exp(-q)` at `q = 150` none above round-off. A series of straight motion then
//! passes through the wall. So the derivative of the series is compared with the field at the end of the step, and the
//! step is halved until they agree.
//!
//! Fields of degree two need no such look where a term vanishes exactly: a series that ends before half of its order and
//! obeys the equations up to its order is a solution.

use crate::field::Field;
use crate::lanes::{Body, Wide};
use crate::method::taylor::sum_of_sizes;

/// Halvings of one step at most.
const MOST_HALVINGS: usize = 40;

/// A small defect that half the step does not divide by more than the first number is round-off, which shorter steps do not
/// make smaller; one above the second is none.
const LEAST_GAIN: f64 = 4.0;
const NO_ROUND_OFF: f64 = 1e-6;

/// The defect that round-off may cause, relative to the state.
const ROUND_OFF: f64 = 1e-11;

/// What the last terms of an honest series leave at most, in units of the order times the tolerance.
const HONEST: f64 = 64.0;

/// Places to compute in.
pub(super) struct StepEnd<V> {
    x: Vec<V>,
    slope: Vec<V>,
    rates: Vec<V>,
    work: Vec<V>,
    defects: Vec<f64>,
    /// The steps that lead to `x`.
    at: Vec<f64>,
    looks: Vec<Look>,
    allowed: f64,
}

/// What is known of the step of one lane.
#[derive(Clone, Copy)]
struct Look {
    is_open: bool,
    /// The step that was proposed.
    proposed: f64,
    /// The defect of the step twice as long.
    before: f64,
}

impl<V: Wide> StepEnd<V> {
    pub(super) fn new<F: Field>(field: &F, order: usize, tolerance: f64) -> Self {
        let zero = vec![V::splat(0.0); field.n_components()];
        StepEnd {
            x: zero.clone(),
            slope: zero.clone(),
            rates: zero,
            work: vec![V::splat(0.0); field.registers(0, 1)],
            defects: vec![0.0; V::WIDTH],
            at: vec![f64::NAN; V::WIDTH],
            looks: vec![Look { is_open: false, proposed: 0.0, before: f64::INFINITY }; V::WIDTH],
            allowed: ROUND_OFF.max(HONEST * order as f64 * tolerance),
        }
    }

    /// The states after these steps, if they were looked at last.
    pub(super) fn states_after(&self, steps: &[f64]) -> Option<&[V]> {
        (self.at == steps).then_some(&self.x)
    }

    /// Halves the steps, one for each lane and zero for one that stays, at whose ends the series fails the equations.
    ///
    /// `rows` are the coefficients from order 0 to `order`, `row` registers each, those of the state first.
    pub(super) fn keep_to_the_field<F: Field>(
        &mut self,
        field: &F,
        rows: &[V],
        (row, order): (usize, usize),
        steps: &mut [f64],
    ) {
        for (look, &step) in self.looks.iter_mut().zip(steps.iter()) {
            *look = Look { is_open: step != 0.0 && step.is_finite(), proposed: step, before: f64::INFINITY };
        }
        for halvings in 0..=MOST_HALVINGS {
            if !self.looks.iter().any(|look| look.is_open) {
                return;
            }
            V::outline(Defects { field, rows, row, order, steps, to: self });
            for ((look, &defect), step) in self.looks.iter_mut().zip(&self.defects).zip(steps.iter_mut()) {
                if !look.is_open {
                    continue;
                }
                if defect <= self.allowed {
                    look.is_open = false;
                } else if defect < NO_ROUND_OFF && defect * LEAST_GAIN > look.before {
                    // it is not the length of the step
                    (look.is_open, *step) = (false, *step * 2.0);
                } else if halvings == MOST_HALVINGS {
                    *step = look.proposed;
                } else {
                    look.before = if defect.is_finite() { defect } else { f64::INFINITY };
                    *step /= 2.0;
                }
            }
        }
    }
}

impl<V: Wide> StepEnd<V> {
    /// The values of some components and their slopes after the step, by Horner's rule; as many as were computed.
    #[inline(always)]
    fn expand<const M: usize>(&mut self, first: usize, rows: &[V], (row, order): (usize, usize), step: V) -> usize {
        let (mut value, mut slope) = ([V::splat(0.0); M], [V::splat(0.0); M]);
        value.copy_from_slice(&rows[order * row + first..][..M]);
        for k in (0..order).rev() {
            let coefficients = &rows[k * row + first..][..M];
            for i in 0..M {
                slope[i] = slope[i].mul_add(step, value[i]);
                value[i] = value[i].mul_add(step, coefficients[i]);
            }
        }
        self.x[first..first + M].copy_from_slice(&value);
        self.slope[first..first + M].copy_from_slice(&slope);
        M
    }
}

/// For each lane the sum of `|x'(h) - f(x(h))| |h|` over the components, in units of the size of the state.
struct Defects<'a, F, V> {
    field: &'a F,
    rows: &'a [V],
    row: usize,
    order: usize,
    steps: &'a [f64],
    to: &'a mut StepEnd<V>,
}

impl<F: Field, V: Wide> Body for Defects<'_, F, V> {
    #[inline(always)]
    fn run(self) {
        let Defects { field, rows, row, order, steps, to } = self;
        let mut step = V::splat(0.0);
        step.as_scalars_mut().copy_from_slice(&steps[..V::WIDTH]);
        to.at.copy_from_slice(&steps[..V::WIDTH]);
        let (mut i, n) = (0, to.x.len());
        while i < n {
            i += match n - i {
                6.. => to.expand::<6>(i, rows, (row, order), step),
                3.. => to.expand::<3>(i, rows, (row, order), step),
                _ => to.expand::<1>(i, rows, (row, order), step),
            };
        }
        let size = sum_of_sizes(&rows[..n]);
        field.rates(&to.x, 0, &mut to.work, &mut to.rates);
        let mut defect = V::splat(0.0);
        for i in 0..to.x.len() {
            defect = defect.add(to.slope[i].sub(to.rates[i]).mul(step).abs());
        }
        let (defect, size) = (defect.as_scalars(), size.as_scalars());
        for ((to, &defect), &size) in to.defects.iter_mut().zip(defect).zip(size) {
            *to = if defect == 0.0 { 0.0 } else { defect / size };
        }
    }
}
