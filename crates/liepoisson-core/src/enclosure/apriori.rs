//! Boxes in which solutions stay during a whole step, by Picard's operator.
//!
//! If `X + [0, h] f(Z)` is within the box `Z`, then every solution that starts in `X` exists up to time `h` and stays in
//! `X + [0, h] f(Z)`: the operator `y -> x + integral of f(y)` maps the continuous functions with values in `Z` into
//! themselves and has a fixed point (Schauder), the solution (it is unique, since `f` is smooth). The box that is tried next
//! is the image, inflated: the hull with the box before would never come to rest.
//!
//! # References
//! - R. J. Lohner, *Computation of guaranteed enclosures for the solutions of ordinary initial and boundary value problems*,
//!   in: Computational Ordinary Differential Equations, 1992, 425.

use super::interval::Interval;
use super::linear::row_sum_norm;
use super::matrix::{IntervalVector, Matrix, combine, is_within};
use super::program::Program;

/// How often an image is inflated before a step is given up.
const TRIALS: usize = 12;
/// How often an enclosure that holds is improved.
const IMPROVEMENTS: usize = 2;

/// A box that contains all solutions that start in `start`, for all times of `time`, which contains zero; `None` if none was
/// found.
pub fn states(field: &Program, start: &[Interval], time: Interval) -> Option<IntervalVector> {
    let image = |within: &[Interval]| combine(start, &field.values(within), |start, rate| start + time * rate);
    let mut trial = inflated(&image(start));
    for _ in 0..TRIALS {
        let mut next = image(&trial);
        if is_within(&next, &trial) {
            for _ in 0..IMPROVEMENTS {
                next = image(&next);
            }
            return Some(next);
        }
        trial = inflated(&next);
    }
    None
}

/// A tenth wider on either side, and wider than round-off.
fn inflated(of: &[Interval]) -> IntervalVector {
    let wider = |component: &Interval| {
        let by = 0.1 * component.width() + 4.0 * f64::EPSILON * component.mag() + f64::MIN_POSITIVE;
        *component + Interval::symmetric(by)
    };
    of.iter().map(wider).collect()
}

/// A matrix that contains `d x(t) / d x(0)` for all times of `time`, which contains zero, of solutions in a box.
///
/// `V' = Df V`, so `|V - I| <= exp(|t| |Df|) - 1` in the norm of row sums, and `V = I + integral of Df V` improves this.
pub fn derivatives(jacobian: &Matrix<Interval>, time: Interval) -> Matrix<Interval> {
    let n = jacobian.n_rows();
    let radius = growth(Interval::point(row_sum_norm(jacobian)) * Interval::point(time.mag()));
    let unit = Matrix::identity(n).enclosed();
    let mut bound = unit.map(|entry| entry + Interval::symmetric(radius));
    for _ in 0..4 {
        let rate = jacobian.times(&bound);
        bound = Matrix::from_fn(n, n, |i, j| bound[(i, j)].meet(unit[(i, j)] + time * rate[(i, j)]));
    }
    bound
}

/// An upper bound of `exp(u) - 1` for `u >= 0`: `exp(u) <= (1 - u / 2^m)^(-2^m)` where `u < 2^m`.
fn growth(u: Interval) -> f64 {
    let mut halvings = 0;
    let mut part = u;
    while part.hi() > 0.125 && halvings < 64 {
        part = part * Interval::point(0.5);
        halvings += 1;
    }
    if part.hi().is_nan() || part.hi() > 0.125 {
        return f64::NAN;
    }
    let mut power = Interval::ONE / (Interval::ONE - part);
    for _ in 0..halvings {
        power = power.sqr();
    }
    (power - Interval::ONE).hi()
}
