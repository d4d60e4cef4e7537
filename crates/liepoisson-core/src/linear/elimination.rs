//! Triangular factors: Gauss with row exchanges, and Cholesky.

/// The factors of a square matrix, P A = L U.
pub struct Lu {
    n: usize,
    factors: Vec<f64>,
    rows: Vec<usize>,
    /// Whether the number of exchanges is odd.
    odd: bool,
}

impl Lu {
    /// Factors a matrix of shape (n, n): in each column the largest entry, the first among equals, is the pivot.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn new(matrix: &[f64], n: usize) -> Lu {
        assert_eq!(matrix.len(), n * n, "a square matrix");
        let mut lu = Lu { n, factors: matrix.to_vec(), rows: (0..n).collect(), odd: false };
        for k in 0..n {
            lu.eliminate(k);
        }
        lu
    }

    fn eliminate(&mut self, k: usize) {
        let (n, f) = (self.n, &mut self.factors);
        let mut pivot = k;
        for i in k + 1..n {
            if f[i * n + k].abs() > f[pivot * n + k].abs() {
                pivot = i;
            }
        }
        if pivot != k {
            for j in 0..n {
                f.swap(k * n + j, pivot * n + j);
            }
            self.rows.swap(k, pivot);
            self.odd = !self.odd;
        }
        let size = f[k * n + k];
        if size == 0.0 {
            return;
        }
        let (above, below) = f.split_at_mut((k + 1) * n);
        let row = &above[k * n + k + 1..];
        for other in below.chunks_exact_mut(n) {
            let factor = other[k] / size;
            other[k] = factor;
            for (x, y) in other[k + 1..].iter_mut().zip(row) {
                *x -= factor * y;
            }
        }
    }

    /// Whether a pivot is zero or not a number.
    pub fn is_singular(&self) -> bool {
        (0..self.n).any(|k| matches!(self.factors[k * self.n + k], pivot if pivot == 0.0 || pivot.is_nan()))
    }

    /// The determinant.
    pub fn determinant(&self) -> f64 {
        let sign = if self.odd { -1.0 } else { 1.0 };
        (0..self.n).fold(sign, |product, k| product * self.factors[k * self.n + k])
    }

    /// Sign and logarithm of the absolute value of the determinant.
    pub fn sign_and_logarithm(&self) -> (f64, f64) {
        let (mut sign, mut logarithm) = (if self.odd { -1.0 } else { 1.0 }, 0.0);
        for k in 0..self.n {
            let pivot = self.factors[k * self.n + k];
            sign *= if pivot == 0.0 { 0.0 } else { pivot.signum() };
            logarithm += libm::log(pivot.abs());
        }
        (sign, logarithm)
    }

    /// The solution of A x = b for right-hand sides of shape (n, m), written over them.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn solve(&self, right: &mut [f64], m: usize) {
        let (n, f) = (self.n, &self.factors);
        assert_eq!(right.len(), n * m, "right-hand sides");
        let given = right.to_vec();
        for (i, &row) in self.rows.iter().enumerate() {
            right[i * m..(i + 1) * m].copy_from_slice(&given[row * m..(row + 1) * m]);
        }
        for i in 0..n {
            for k in 0..i {
                subtract(right, m, i, k, f[i * n + k]);
            }
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                subtract(right, m, i, k, f[i * n + k]);
            }
            let pivot = f[i * n + i];
            right[i * m..(i + 1) * m].iter_mut().for_each(|x| *x /= pivot);
        }
    }
}

/// Row `i` less `factor` times row `k`.
fn subtract(rows: &mut [f64], m: usize, i: usize, k: usize, factor: f64) {
    for j in 0..m {
        rows[i * m + j] -= factor * rows[k * m + j];
    }
}

/// The lower factor L of a symmetric matrix, A = L L^T; none where A is not positive definite.
///
/// # Panics
/// If the slice has another length.
pub fn cholesky(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    assert_eq!(matrix.len(), n * n, "a square matrix");
    let mut lower = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let mut left = matrix[i * n + j];
            for k in 0..j {
                left -= lower[i * n + k] * lower[j * n + k];
            }
            if i == j {
                if left <= 0.0 || left.is_nan() {
                    return None;
                }
                lower[i * n + i] = left.sqrt();
            } else {
                lower[i * n + j] = left / lower[j * n + j];
            }
        }
    }
    Some(lower)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::product;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_solved_solves(n in 1_usize..9, entries in prop::collection::vec(-1.0..1.0_f64, 90)) {
            let (matrix, right) = (&entries[..n * n], &entries[80..80 + n]);
            let lu = Lu::new(matrix, n);
            prop_assume!(lu.determinant().abs() > 1e-6);
            let mut x = right.to_vec();
            lu.solve(&mut x, 1);
            let mut back = vec![0.0; n];
            product(matrix, &x, (n, n, 1), &mut back);
            for (b, wanted) in back.iter().zip(right) {
                prop_assert!((b - wanted).abs() < 1e-7, "{b} {wanted}");
            }
            let (sign, logarithm) = lu.sign_and_logarithm();
            let wanted = lu.determinant();
            prop_assert!((sign * libm::exp(logarithm) - wanted).abs() < 1e-13 * wanted.abs());
        }

        #[test]
        fn a_gram_matrix_has_its_factor(n in 1_usize..7, entries in prop::collection::vec(-1.0..1.0_f64, 49)) {
            let mut lower = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..=i {
                    lower[i * n + j] = if i == j { entries[i * 7 + j].abs() + 0.5 } else { entries[i * 7 + j] };
                }
            }
            let transposed: Vec<f64> = (0..n * n).map(|k| lower[k % n * n + k / n]).collect();
            let mut gram = vec![0.0; n * n];
            product(&lower, &transposed, (n, n, n), &mut gram);
            for (one, other) in cholesky(&gram, n).unwrap().iter().zip(&lower) {
                prop_assert!((one - other).abs() < 1e-8);
            }
            gram[0] = -1.0;
            prop_assert!(cholesky(&gram, n).is_none());
        }
    }

    #[test]
    fn determinants_and_singular_matrices() {
        assert_eq!(Lu::new(&[0.0, 2.0, 3.0, 0.0], 2).determinant(), -6.0);
        assert!(Lu::new(&[1.0, 2.0, 2.0, 4.0], 2).is_singular());
        assert!(Lu::new(&[f64::NAN], 1).is_singular());
        assert_eq!(Lu::new(&[], 0).determinant(), 1.0);
    }
}
