//! Verified linear algebra: norms, inverses and solutions of linear systems for all matrices of an interval matrix.
//!
//! An inverse `R` of the middle, computed in doubles, is only an approximation. With `G = I - R A` and `|G| < 1` in the norm
//! of row sums, `A` is regular, `A^-1 = R + G (I - G)^-1 R`, and component `i` of `G (I - G)^-1 v` is at most
//! `sum_j |G_ij| max|v| / (1 - |G|)`.
//!
//! # References
//! - S. M. Rump, *Verification methods: rigorous results using floating-point arithmetic*, Acta Numerica 19 (2010) 287,
//!   theorems 10.2 and 10.4.

use super::interval::Interval;
use super::matrix::{IntervalVector, Matrix, combine, mid, points};
use std::ops::{Div, Mul, Sub};

/// Real or complex numbers in doubles.
pub(super) trait Scalar: Copy + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    fn real(x: f64) -> Self;
    fn size(self) -> f64;
}

impl Scalar for f64 {
    fn real(x: f64) -> f64 {
        x
    }

    fn size(self) -> f64 {
        self.abs()
    }
}

/// An approximate inverse by Gauss–Jordan elimination with partial pivoting; `None` if a pivot vanishes or is not finite.
pub(super) fn approximate_inverse<T: Scalar>(matrix: &Matrix<T>) -> Option<Matrix<T>> {
    let n = matrix.n_rows();
    let mut left = matrix.clone();
    let mut right = Matrix::from_fn(n, n, |i, j| T::real(if i == j { 1.0 } else { 0.0 }));
    for k in 0..n {
        let size = |row: usize| left[(row, k)].size();
        let pivot_row = (k..n).fold(k, |best, row| if size(row) > size(best) { row } else { best });
        let pivot = left[(pivot_row, k)];
        if pivot.size() == 0.0 || !pivot.size().is_finite() {
            return None;
        }
        for column in 0..n {
            for side in [&mut left, &mut right] {
                let (upper, lower) = (side[(k, column)], side[(pivot_row, column)]);
                side[(pivot_row, column)] = upper;
                side[(k, column)] = lower / pivot;
            }
        }
        for row in (0..n).filter(|&row| row != k) {
            let factor = left[(row, k)];
            for column in 0..n {
                for side in [&mut left, &mut right] {
                    side[(row, column)] = side[(row, column)] - factor * side[(k, column)];
                }
            }
        }
    }
    right.entries().iter().all(|entry| entry.size().is_finite()).then_some(right)
}

/// `max_i sum_j |a_ij|`, from above, of all matrices.
pub fn row_sum_norm(matrix: &Matrix<Interval>) -> f64 {
    (0..matrix.n_rows()).map(|i| row_sum(matrix.row(i))).fold(0.0, larger)
}

/// The sum of absolute values, from above.
fn row_sum(row: &[Interval]) -> f64 {
    row.iter().fold(Interval::ZERO, |sum, entry| sum + entry.abs()).hi()
}

/// The larger number, or NaN.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The Euclidean norm of all vectors of a box.
pub fn euclidean_norm(vector: &[Interval]) -> Interval {
    vector.iter().fold(Interval::ZERO, |sum, entry| sum + entry.sqr()).sqrt()
}

/// An upper bound of `max |A v| / |v|` in the Euclidean norm, for all matrices of `matrix`.
///
/// Of two rows and columns by the closed form: the singular values are half the sum and half the difference of
/// `|(a + d, b - c)|` and `|(a - d, b + c)|`. Of any other shape by `|A|^2 <= max_i sum_j |(A^T A)_ij|`.
pub fn spectral_norm(matrix: &Matrix<Interval>) -> f64 {
    match (matrix.n_rows(), matrix.n_columns()) {
        (1, 1) => matrix[(0, 0)].mag(),
        (2, 2) => {
            let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|place| matrix[place]);
            let sum = euclidean_norm(&[a + d, b - c]) + euclidean_norm(&[a - d, b + c]);
            (sum * Interval::point(0.5)).hi()
        }
        _ => Interval::new(0.0, row_sum_norm(&matrix.transposed().times(matrix))).sqrt().hi(),
    }
}

/// `1 / (1 - |G|)`; `None` if `|G| < 1` is not sure.
fn geometric_series(norm: f64) -> Option<Interval> {
    let rest = Interval::ONE - Interval::point(norm);
    rest.is_positive().then(|| Interval::ONE / rest)
}

/// An approximate inverse of the middle, and `G`.
fn preconditioned(matrix: &Matrix<Interval>) -> Option<(Matrix<Interval>, Matrix<Interval>)> {
    let approximation = approximate_inverse(&matrix.mid())?.enclosed();
    let rest = Matrix::identity(matrix.n_rows()).enclosed().minus(&approximation.times(matrix));
    Some((approximation, rest))
}

/// `G (I - G)^-1 v` for all vectors whose components are at most `largest`.
fn series_applied(rest: &Matrix<Interval>, largest: f64) -> Option<IntervalVector> {
    let scale = geometric_series(row_sum_norm(rest))? * Interval::point(largest);
    Some(
        (0..rest.n_rows()).map(|i| Interval::symmetric((Interval::point(row_sum(rest.row(i))) * scale).hi())).collect(),
    )
}

/// The greatest absolute value of a component.
fn largest(vector: &[Interval]) -> f64 {
    vector.iter().map(|entry| entry.mag()).fold(0.0, larger)
}

/// A matrix that contains the inverse of every matrix of `matrix`; `None` if it is not sure that they are all regular.
pub fn inverse(matrix: &Matrix<Interval>) -> Option<Matrix<Interval>> {
    let n = matrix.n_rows();
    let (approximation, rest) = preconditioned(matrix)?;
    let further: Option<Vec<IntervalVector>> =
        (0..n).map(|j| series_applied(&rest, largest(&approximation.column(j)))).collect();
    let further = further?;
    let first = Matrix::from_fn(n, n, |i, j| approximation[(i, j)] + further[j][i]);
    // A^-1 = R + G A^-1, once more, for wide matrices
    let second = approximation.plus(&rest.times(&first));
    Some(Matrix::from_fn(n, n, |i, j| first[(i, j)].meet(second[(i, j)])))
}

/// A box that contains the solution `x` of `A x = b` for every `A` of `matrix` and `b` of `right`; `None` if it is not sure
/// that these `A` are all regular.
pub fn solve(matrix: &Matrix<Interval>, right: &[Interval]) -> Option<IntervalVector> {
    let (approximation, rest) = preconditioned(matrix)?;
    let guess = points(&mid(&approximation.apply(right)));
    // x - guess = R (b - A guess) + G (I - G)^-1 R (b - A guess)
    let defect = approximation.apply(&combine(right, &matrix.apply(&guess), |b, image| b - image));
    let further = series_applied(&rest, largest(&defect))?;
    Some((0..guess.len()).map(|i| guess[i] + defect[i] + further[i]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enclosure::rational::Rational;

    /// `1 / (i + j + 1)`, whose inverse has whole entries.
    fn hilbert(n: usize) -> Matrix<Interval> {
        Matrix::from_fn(n, n, |i, j| Rational::new(1, (i + j + 1) as i128).unwrap().enclosure())
    }

    #[test]
    fn the_inverse_of_a_hilbert_matrix_contains_its_whole_entries() {
        let inverse = inverse(&hilbert(4)).unwrap();
        let exact = [16, -120, 240, -140, -120, 1200, -2700, 1680, 240, -2700, 6480, -4200, -140, 1680, -4200, 2800];
        for (entry, exact) in inverse.entries().iter().zip(exact) {
            assert!(entry.contains(f64::from(exact)) && entry.width() < 1e-8, "{entry:?} {exact}");
        }
        let sums = solve(&hilbert(4), &[Interval::ONE; 4]).unwrap();
        for (sum, exact) in sums.iter().zip([-4.0, 60.0, -180.0, 140.0]) {
            assert!(sum.contains(exact) && sum.width() < 1e-9, "{sum:?} {exact}");
        }
    }

    #[test]
    fn all_inverses_of_an_interval_matrix_are_contained() {
        let matrix = Matrix::from_fn(2, 2, |i, j| Interval::ball([[2.0, 1.0], [-1.0, 3.0]][i][j], 0.1));
        let (inverse, right) = (inverse(&matrix).unwrap(), [Interval::ONE, Interval::new(0.0, 1.0)]);
        let solution = solve(&matrix, &right).unwrap();
        for corner in 0..16 {
            let entry = |k: usize| {
                let entry = matrix.entries()[k];
                if corner >> k & 1 == 0 { entry.lo() } else { entry.hi() }
            };
            let determinant = entry(0) * entry(3) - entry(1) * entry(2);
            let exact = [entry(3), -entry(1), -entry(2), entry(0)].map(|entry| entry / determinant);
            for (entry, exact) in inverse.entries().iter().zip(exact) {
                assert!(entry.contains(exact), "{entry:?} {exact}");
            }
            for (i, x) in solution.iter().enumerate() {
                assert!(x.contains(exact[2 * i]) && x.contains(exact[2 * i] + exact[2 * i + 1]));
            }
        }
    }

    #[test]
    fn a_matrix_that_may_be_singular_has_no_inverse() {
        let singular = Matrix::from_fn(2, 2, |i, j| Interval::ball([[1.0, 2.0], [2.0, 4.0]][i][j], 1e-9));
        assert!(inverse(&singular).is_none() && solve(&singular, &[Interval::ONE; 2]).is_none());
        let unknown = Matrix::from_fn(2, 2, |_, _| Interval::UNKNOWN);
        assert!(inverse(&unknown).is_none());
    }

    #[test]
    fn norms_bound_the_growth_of_vectors() {
        let turn = Matrix::from_fn(2, 2, |i, j| Interval::point([[0.6, -0.8], [0.8, 0.6]][i][j] * 3.0));
        assert!(spectral_norm(&turn) >= 3.0 && spectral_norm(&turn) < 3.0 + 1e-14);
        let shear = Matrix::from_fn(3, 3, |i, j| Interval::point(if i <= j { 1.0 } else { 0.0 }));
        // the largest singular value of the upper triangle of ones, 1 / (2 sin(pi / 14))
        let exact = 0.5 / (std::f64::consts::PI / 14.0).sin();
        assert!(spectral_norm(&shear) >= exact && spectral_norm(&shear) < 1.2 * exact);
        assert!(row_sum_norm(&shear) == 3.0);
        assert!(spectral_norm(&Matrix::from_fn(2, 2, |_, _| Interval::UNKNOWN)).is_nan());
    }
}
