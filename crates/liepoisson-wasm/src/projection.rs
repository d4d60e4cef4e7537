//! Newton's method onto given values of functions: the nearest state to first order, as Python's `Leaf.project` has it.

use crate::refusal::{Kind, Refusal};
use liepoisson_core::error::Error;
use liepoisson_core::field::Functions;

/// Largest relative residual of a solution; Newton's method usually ends at 2e-16.
const CONVERGED: f64 = 1e-13;
/// Below it no step helps.
const ROUND_OFF: f64 = 2e-16;
const MOST_STEPS: usize = 80;
const MOST_HALVINGS: usize = 14;
/// Singular values below this fraction of the largest are relations between the functions.
const RANK: f64 = 1e-12;
/// Sweeps over all pairs of rows; three or four are usual.
const MOST_SWEEPS: usize = 30;

/// Functions with the values that they are to have.
struct Equations<'f> {
    functions: &'f Functions,
    /// What follows the components that move, and stays.
    fixed: &'f [f64],
    /// Of each component that moves: lengths are those of states divided by them.
    units: &'f [f64],
    wanted: &'f [f64],
    work: Vec<f64>,
}

/// Residuals and their gradients.
struct Residuals {
    values: Vec<f64>,
    rows: Vec<Vec<f64>>,
    /// The largest absolute value; infinite where one is not finite.
    largest: f64,
}

impl Equations<'_> {
    /// Of each equation f = c, divided by the size of the terms that must cancel, `|c| + |y| |grad f|`.
    fn residuals(&mut self, y: &[f64]) -> Residuals {
        let (n, m) = (self.functions.n_components(), self.wanted.len());
        let mut rows = vec![vec![0.0; y.len()]; m];
        let mut found = vec![0.0; 2 * m];
        let mut line = vec![0.0; 2 * n];
        line[y.len()..n].copy_from_slice(self.fixed);
        for (i, (y, unit)) in y.iter().zip(self.units).enumerate() {
            line[i] = y * unit;
        }
        for (k, unit) in self.units.iter().enumerate() {
            // the line through the state along one component: its derivative is a part of the gradient
            line[n..].fill(0.0);
            line[n + k] = *unit;
            self.functions.series(&line, &mut self.work, &mut found);
            for (row, slope) in rows.iter_mut().zip(&found[m..]) {
                row[k] = *slope;
            }
        }
        let length = norm(y);
        let mut values = Vec::with_capacity(m);
        for ((row, value), wanted) in rows.iter_mut().zip(&found).zip(self.wanted) {
            let scale = wanted.abs() + length * norm(row);
            let scale = if scale == 0.0 { 1.0 } else { scale };
            row.iter_mut().for_each(|slope| *slope /= scale);
            values.push((value - wanted) / scale);
        }
        let is_finite = rows.iter().flatten().chain(&values).all(|number| number.is_finite());
        let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        Residuals { values, rows, largest: if is_finite { largest } else { f64::INFINITY } }
    }

    /// Newton steps, halved where they do not help.
    fn solve(&mut self, mut y: Vec<f64>) -> (Vec<f64>, Residuals) {
        let mut now = self.residuals(&y);
        for _ in 0..MOST_STEPS {
            if !now.largest.is_finite() || now.largest <= ROUND_OFF {
                break;
            }
            let step = shortest_step(now.rows.clone(), now.values.clone());
            let mut part = 1.0;
            let mut better = None;
            for _ in 0..MOST_HALVINGS {
                let trial: Vec<f64> = y.iter().zip(&step).map(|(y, step)| y + part * step).collect();
                let reached = self.residuals(&trial);
                if reached.largest < now.largest {
                    better = Some((trial, reached));
                    break;
                }
                if now.largest <= CONVERGED {
                    break;
                }
                part /= 2.0;
            }
            let Some(found) = better else { break };
            (y, now) = found;
        }
        (y, now)
    }
}

fn norm(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// The step of minimum norm along which the rows undo the values as far as they can. Rotations of pairs of rows make
/// them orthogonal (one-sided Jacobi): their lengths are then the singular values.
fn shortest_step(mut rows: Vec<Vec<f64>>, mut values: Vec<f64>) -> Vec<f64> {
    let (m, n) = (rows.len(), rows[0].len());
    for _ in 0..MOST_SWEEPS {
        let mut is_done = true;
        for q in 1..m {
            for p in 0..q {
                let (pp, qq, pq) = (dot(&rows[p], &rows[p]), dot(&rows[q], &rows[q]), dot(&rows[p], &rows[q]));
                if pq.abs() <= f64::EPSILON * (pp * qq).sqrt() {
                    continue;
                }
                is_done = false;
                let zeta = (qq - pp) / (2.0 * pq);
                let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                let turn = |a: &mut f64, b: &mut f64| {
                    (*a, *b) = (cosine * (*a - tangent * *b), cosine * (*b + tangent * *a));
                };
                let (before, after) = rows.split_at_mut(q);
                before[p].iter_mut().zip(&mut after[0]).for_each(|(a, b)| turn(a, b));
                let (before, after) = values.split_at_mut(q);
                turn(&mut before[p], &mut after[0]);
            }
        }
        if is_done {
            break;
        }
    }
    let lengths: Vec<f64> = rows.iter().map(|row| norm(row)).collect();
    let least = RANK * lengths.iter().fold(0.0, |most: f64, length| most.max(*length));
    let mut step = vec![0.0; n];
    for ((row, value), length) in rows.iter().zip(&values).zip(&lengths).filter(|(_, length)| **length > least) {
        let part = value / length / length;
        step.iter_mut().zip(row).for_each(|(step, slope)| *step -= part * slope);
    }
    step
}

/// `[state, residual]`: the state near `state` at which each function has its value, and how far each is from it,
/// relative to what must cancel. Of the components as many move as there are units.
pub(crate) fn project(
    functions: &Functions,
    state: &[f64],
    wanted: &[f64],
    units: &[f64],
) -> Result<Vec<Vec<f64>>, Refusal> {
    let length = |name, wanted, got| if wanted == got { Ok(()) } else { Err(Error::Length { name, wanted, got }) };
    length("state", functions.n_components(), state.len())?;
    length("values", functions.n_functions(), wanted.len())?;
    length("units", units.len().clamp(1, state.len()), units.len())?;
    if !units.iter().all(|unit| *unit > 0.0) || !state.iter().chain(wanted).chain(units).all(|x| x.is_finite()) {
        let message = "projection: wanted a finite state, finite values, and units that are positive; got others";
        return Err(Refusal::new(Kind::Parameter, message));
    }
    let (moving, fixed) = state.split_at(units.len());
    let mut equations = Equations { functions, fixed, units, wanted, work: Vec::new() };
    let (y, residuals) = equations.solve(moving.iter().zip(units).map(|(x, unit)| x / unit).collect());
    let found = y.iter().zip(units).map(|(y, unit)| y * unit).chain(fixed.iter().copied()).collect();
    Ok(vec![found, residuals.values])
}
