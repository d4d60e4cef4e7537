//! Enclosures of the eigenvalues of all matrices of an interval matrix.
//!
//! With approximate eigenvectors in the columns of `V` and an approximate inverse `W`, the eigenvalues of `A` are those of
//! `(W V)^-1 W A V`. With `E = W V - I`, `|E| < 1`, this is `W A V` up to `|E| / (1 - |E|) |W A V|` in the norm of row sums, and
//! Gershgorin's discs contain the eigenvalues: a set of discs that is apart from the others contains as many as it has.
//!
//! Whether the eigenvectors are good decides how narrow the discs are, not whether they are right.
//!
//! # References
//! - S. M. Rump, *Verification methods*, Acta Numerica 19 (2010) 287, section 13; S. Gerschgorin, 1931.

use super::complex::{ComplexMatrix, Number};
use super::interval::Interval;
use super::linear::{Scalar, approximate_inverse};
use super::matrix::Matrix;

/// A disc that contains eigenvalues: a box around it.
#[derive(Clone, Copy, Debug)]
pub struct Eigenvalue {
    /// Real part.
    pub re: Interval,
    /// Imaginary part.
    pub im: Interval,
    /// Whether the disc contains exactly one eigenvalue of every matrix; otherwise it overlaps others.
    pub is_alone: bool,
}

impl Eigenvalue {
    /// The absolute value.
    pub fn modulus(&self) -> Interval {
        (self.re.sqr() + self.im.sqr()).sqrt()
    }
}

/// As many discs as the matrix has rows; none if they are not certain.
pub fn eigenvalues(matrix: &Matrix<Interval>) -> Option<Vec<Eigenvalue>> {
    let n = matrix.n_rows();
    let vectors = approximate_eigenvectors(&matrix.mid())?;
    let back = approximate_inverse(&vectors)?;
    let (vectors, back) = (ComplexMatrix::enclosing(&vectors), ComplexMatrix::enclosing(&back));
    let product = back.times(&ComplexMatrix::real(matrix)).times(&vectors);
    let defect = back.times(&vectors).minus_identity().row_sum_norm();
    let rest = Interval::ONE - Interval::point(defect);
    if !rest.is_positive() {
        return None;
    }
    let further = Interval::point(defect) / rest * Interval::point(product.row_sum_norm());
    let radius = |i: usize| {
        let off = (0..n).filter(|&j| j != i).fold(further, |sum, j| sum + product.modulus(i, j));
        Interval::symmetric(off.hi())
    };
    let boxes: Vec<(Interval, Interval)> =
        (0..n).map(|i| (product.re[(i, i)] + radius(i), product.im[(i, i)] + radius(i))).collect();
    if boxes.iter().any(|(re, im)| re.is_unknown() || im.is_unknown()) {
        return None;
    }
    let are_apart =
        |i: usize, j: usize| boxes[i].0.meet(boxes[j].0).is_unknown() || boxes[i].1.meet(boxes[j].1).is_unknown();
    let is_alone = |i: usize| (0..n).all(|j| j == i || are_apart(i, j));
    let of_real = |i: usize| {
        let (re, im) = boxes[i];
        // the conjugate of the only eigenvalue in a box around a piece of the real axis is in there, too
        let mirrored =
            (0..n).all(|j| j == i || boxes[j].0.meet(re).is_unknown() || boxes[j].1.meet(im.hull(-im)).is_unknown());
        im.contains(0.0) && is_alone(i) && mirrored
    };
    let eigenvalue = |i: usize| Eigenvalue {
        re: boxes[i].0,
        im: if of_real(i) { Interval::ZERO } else { boxes[i].1 },
        is_alone: is_alone(i),
    };
    let mut found: Vec<Eigenvalue> = (0..n).map(eigenvalue).collect();
    found.sort_by(|a, b| b.modulus().mid().total_cmp(&a.modulus().mid()).then(b.im.mid().total_cmp(&a.im.mid())));
    Some(found)
}

/// Eigenvectors in doubles: eigenvalues as roots of the characteristic polynomial, all at once (Durand and Kerner), then
/// inverse iteration.
fn approximate_eigenvectors(matrix: &Matrix<f64>) -> Option<Matrix<Number>> {
    let n = matrix.n_rows();
    let scale = matrix.entries().iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    if scale == 0.0 || !scale.is_finite() {
        return Some(Matrix::from_fn(n, n, |i, j| Number::real(if i == j { 1.0 } else { 0.0 })));
    }
    let roots = roots(&characteristic_polynomial(matrix));
    let mut columns: Vec<Vec<Number>> = vec![];
    for (number, root) in roots.iter().enumerate() {
        // a little beside the eigenvalue the matrix is regular; the start is not orthogonal to the eigenvector by chance only
        let mut shift = *root + Number { re: 1e-10 * scale, im: 1e-11 * scale };
        let mut vector: Vec<Number> =
            (0..n).map(|i| Number { re: 1.0 + 0.3 * ((i * 7 + number * 3) % 11) as f64, im: 0.1 * i as f64 }).collect();
        for _ in 0..6 {
            let shifted = Matrix::from_fn(n, n, |i, j| {
                let unit = Number::real(if i == j { 1.0 } else { 0.0 });
                Number::real(matrix[(i, j)]) - shift * unit
            });
            let Some(inverse) = approximate_inverse(&shifted) else { break };
            let image: Vec<Number> =
                (0..n).map(|i| (0..n).fold(Number::ZERO, |sum, j| sum + inverse[(i, j)] * vector[j])).collect();
            let size = image.iter().fold(0.0_f64, |size, entry| size.max(entry.size()));
            // Rayleigh's quotient with the vector before: A w = shift w + v
            let largest = (0..n).fold(0, |best, i| if image[i].size() > image[best].size() { i } else { best });
            let next = shift + vector[largest] / image[largest];
            let is_near = (next - *root).size() < 1e-3 * scale;
            if is_near && next.size().is_finite() {
                shift = next + Number { re: 1e-14 * scale, im: 0.0 };
            }
            vector = image.iter().map(|&entry| entry * Number::real(1.0 / size)).collect();
        }
        columns.push(vector);
    }
    Some(Matrix::from_fn(n, n, |i, j| columns[j][i]))
}

/// Coefficients of `det(z - A)`, highest first (Faddeev and LeVerrier).
fn characteristic_polynomial(matrix: &Matrix<f64>) -> Vec<f64> {
    let n = matrix.n_rows();
    let product = |a: &Matrix<f64>, b: &Matrix<f64>| {
        Matrix::from_fn(n, n, |i, j| (0..n).map(|k| a[(i, k)] * b[(k, j)]).sum::<f64>())
    };
    let (mut coefficients, mut power) = (vec![1.0], Matrix::identity(n));
    for k in 1..=n {
        let next = product(matrix, &power);
        let coefficient = -(0..n).map(|i| next[(i, i)]).sum::<f64>() / k as f64;
        coefficients.push(coefficient);
        power = Matrix::from_fn(n, n, |i, j| next[(i, j)] + if i == j { coefficient } else { 0.0 });
    }
    coefficients
}

fn roots(coefficients: &[f64]) -> Vec<Number> {
    let degree = coefficients.len() - 1;
    // no root is larger than this (Fujiwara)
    let bound =
        (1..=degree).map(|k| 2.0 * libm::pow(coefficients[k].abs(), 1.0 / k as f64)).fold(f64::MIN_POSITIVE, f64::max);
    let start = Number { re: 0.4, im: 0.9 };
    let mut power = Number::ONE;
    let mut found: Vec<Number> = (0..degree)
        .map(|_| {
            power = power * start;
            power * Number::real(0.5 * bound)
        })
        .collect();
    for _ in 0..500 {
        let mut change = 0.0_f64;
        for i in 0..degree {
            let value =
                coefficients.iter().fold(Number::ZERO, |sum, &coefficient| sum * found[i] + Number::real(coefficient));
            let others =
                (0..degree).filter(|&j| j != i).fold(Number::ONE, |product, j| product * (found[i] - found[j]));
            let step = value / others;
            if step.size().is_finite() {
                found[i] = found[i] - step;
                change = change.max(step.size());
            }
        }
        if change < 1e-15 * bound {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[&[f64]], radius: f64) -> Vec<Eigenvalue> {
        let n = rows.len();
        eigenvalues(&Matrix::from_fn(n, n, |i, j| Interval::ball(rows[i][j], radius))).unwrap()
    }

    #[test]
    fn known_eigenvalues_are_enclosed_narrowly() {
        // companion matrix of (z - 1)(z - 2)(z^2 + 2 z + 5)
        let found =
            of(&[&[1.0, -1.0, 11.0, -10.0], &[1.0, 0.0, 0.0, 0.0], &[0.0, 1.0, 0.0, 0.0], &[0.0, 0.0, 1.0, 0.0]], 0.0);
        let exact = [(-1.0, 2.0), (-1.0, -2.0), (2.0, 0.0), (1.0, 0.0)];
        for (eigenvalue, (re, im)) in found.iter().zip(exact) {
            assert!(eigenvalue.re.contains(re) && eigenvalue.im.contains(im) && eigenvalue.is_alone, "{found:?}");
            assert!(eigenvalue.re.width() < 1e-12 && eigenvalue.im.width() < 1e-12, "{found:?}");
        }
        assert_eq!(found[2].im, Interval::ZERO); // alone, and so real
    }

    #[test]
    fn eigenvalues_of_all_matrices_are_enclosed() {
        let rows = [[2.0, 1.0], [0.5, -1.0]];
        let found = of(&[&rows[0], &rows[1]], 0.01);
        for corner in 0..16 {
            let entry = |k: usize| rows[k / 2][k % 2] + if corner >> k & 1 == 0 { 0.01 } else { -0.01 };
            let (trace, determinant) = (entry(0) + entry(3), entry(0) * entry(3) - entry(1) * entry(2));
            let root = (0.25 * trace * trace - determinant).sqrt();
            assert!(found[0].re.contains(0.5 * trace + root) && found[1].re.contains(0.5 * trace - root), "{found:?}");
        }
    }

    #[test]
    fn equal_eigenvalues_are_not_alone() {
        let found = of(&[&[1.0, 1e-3], &[0.0, 1.0]], 1e-12);
        assert!(found.iter().all(|eigenvalue| !eigenvalue.is_alone && eigenvalue.re.contains(1.0)), "{found:?}");
        assert!(eigenvalues(&Matrix::from_fn(2, 2, |_, _| Interval::UNKNOWN)).is_none());
        let zero = of(&[&[0.0, 0.0], &[0.0, 0.0]], 0.0);
        assert!(zero.iter().all(|eigenvalue| eigenvalue.re.contains(0.0) && !eigenvalue.is_alone));
    }
}
