//! The multipliers of a periodic orbit with two directions in and two out: whether they are complex, and their angle.
//!
//! The derivative of a symplectic map of four dimensions has the polynomial `z^4 - T z^3 + S z^2 - T z + 1`, with `T` its trace
//! and `S` the sum of its principal minors of two rows. With `zeta = z + 1/z` it is `zeta^2 - T zeta + S - 2 = 0`. If
//! `T^2/4 - S + 2 < 0`, then `zeta = a + i b` is not real, and neither is any `z = rho e^{i theta}`:
//! ```text
//! a = T/2,  b^2 = S - 2 - T^2/4,  m = rho + 1/rho = (|zeta - 2| + |zeta + 2|) / 2,  cos theta = a / m,
//! sin theta = b / sqrt(m^2 - 4),  rho = (m + sqrt(m^2 - 4)) / 2 .
//! ```
//! (`zeta` is on the ellipse with foci -2, 2 and half axes `rho + 1/rho`, `rho - 1/rho`.)

use crate::enclosure::elementary::{atan, pi};
use crate::enclosure::interval::Interval;
use crate::enclosure::linear::euclidean_norm;
use crate::enclosure::matrix::Matrix;

/// `T^2/4 - S + 2` of a matrix of four rows.
pub fn discriminant(derivative: &Matrix<Interval>) -> Interval {
    let (trace, minors) = coefficients(derivative);
    trace.sqr() * Interval::point(0.25) - minors + Interval::point(2.0)
}

/// Trace, and sum of the principal minors of two rows.
fn coefficients(derivative: &Matrix<Interval>) -> (Interval, Interval) {
    let n = derivative.n_rows();
    let entry = |i: usize, j: usize| derivative[(i, j)];
    let trace = (0..n).fold(Interval::ZERO, |sum, i| sum + entry(i, i));
    let mut minors = Interval::ZERO;
    for i in 0..n {
        for j in i + 1..n {
            minors += entry(i, i) * entry(j, j) - entry(i, j) * entry(j, i);
        }
    }
    (trace, minors)
}

/// The multipliers `rho e^{i theta}`, their conjugates and inverses.
#[derive(Clone, Copy, Debug)]
pub struct Multipliers {
    /// Absolute value, above one.
    pub modulus: Interval,
    /// `theta / pi`, between 0 and 1.
    pub rotation: Interval,
}

/// The multipliers of a matrix with a negative [`discriminant`]; unknown otherwise.
pub fn multipliers(derivative: &Matrix<Interval>) -> Multipliers {
    let two = Interval::point(2.0);
    let a = coefficients(derivative).0 / two;
    let b = (-discriminant(derivative)).sqrt();
    let m = (euclidean_norm(&[a - two, b]) + euclidean_norm(&[a + two, b])) / two;
    let difference = (m.sqr() - Interval::point(4.0)).sqrt();
    // theta = pi/2 - atan(cot theta)
    let cotangent = a * difference / (m * b);
    Multipliers { modulus: (m + difference) / two, rotation: Interval::point(0.5) - atan(cotangent) / pi() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A symplectic matrix with the multipliers `rho e^{i theta}`, seen in a sheared basis.
    fn matrix(rho: f64, theta: f64) -> Matrix<Interval> {
        let (cosine, sine) = (theta.cos(), theta.sin());
        let block = |factor: f64| [[factor * cosine, -factor * sine], [factor * sine, factor * cosine]];
        let (out, back) = (block(rho), block(1.0 / rho));
        let diagonal = Matrix::from_fn(4, 4, |i, j| match (i / 2, j / 2) {
            (0, 0) => Interval::point(out[i][j]),
            (1, 1) => Interval::point(back[i - 2][j - 2]),
            _ => Interval::ZERO,
        });
        let shear = |sign: f64| {
            Matrix::from_fn(4, 4, |i, j| match (i, j) {
                (0, 3) => Interval::point(sign * 0.7),
                _ if i == j => Interval::ONE,
                _ => Interval::ZERO,
            })
        };
        shear(1.0).times(&diagonal).times(&shear(-1.0))
    }

    #[test]
    fn modulus_and_angle_of_a_known_matrix_are_found() {
        for (rho, turns) in [(8.08, 0.7168), (1.5, 0.1), (3.0, 0.5), (20.0, 0.9)] {
            let found = multipliers(&matrix(rho, turns * std::f64::consts::PI));
            assert!((found.modulus.mid() - rho).abs() < 1e-12 * rho && found.modulus.width() < 1e-11, "{found:?}");
            assert!((found.rotation.mid() - turns).abs() < 1e-12 && found.rotation.width() < 1e-11, "{found:?}");
            assert!(discriminant(&matrix(rho, turns * 3.1)).is_negative());
        }
    }

    #[test]
    fn real_multipliers_have_no_angle() {
        let real =
            Matrix::from_fn(4, 4, |i, j| Interval::point(if i == j { [3.0, 5.0, 0.2, 1.0 / 3.0][i] } else { 0.0 }));
        assert!(!discriminant(&real).is_negative() && multipliers(&real).rotation.is_unknown());
    }
}
