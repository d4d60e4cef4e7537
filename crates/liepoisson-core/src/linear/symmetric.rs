//! Eigenvalues of symmetric matrices by Jacobi's method.

use super::MOST_SWEEPS;
use super::singular::{power_of_two_above, turn};

/// Eigenvalues, rising, and eigenvectors as rows, of a symmetric matrix of shape (n, n), of which the lower triangle is read.
///
/// # Panics
/// If the slice has another length.
pub fn symmetric(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<f64>) {
    assert_eq!(matrix.len(), n * n, "a square matrix");
    let at = |k: usize| matrix[(k / n).max(k % n) * n + (k / n).min(k % n)];
    let scale = power_of_two_above((0..n * n).fold(0.0, |size: f64, k| size.max(at(k).abs())));
    let mut a: Vec<f64> = (0..n * n).map(|k| at(k) / scale).collect();
    let mut vectors = vec![0.0; n * n];
    (0..n).for_each(|k| vectors[k * n + k] = 1.0);
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                rotated |= rotate(&mut a, &mut vectors, n, (p, q));
            }
        }
        if !rotated {
            break;
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&p, &q| a[p * n + p].total_cmp(&a[q * n + q]));
    let values = order.iter().map(|&k| a[k * n + k] * scale).collect();
    (values, order.iter().flat_map(|&k| vectors[k * n..(k + 1) * n].iter().copied()).collect())
}

/// Makes an entry off the diagonal zero; whether it was more than round-off of the two entries on the diagonal.
fn rotate(a: &mut [f64], vectors: &mut [f64], n: usize, (p, q): (usize, usize)) -> bool {
    let (alpha, beta, gamma) = (a[p * n + p], a[q * n + q], a[p * n + q]);
    // beside neither can it be seen: dropped, as by a rotation by less than round-off
    if !(alpha.abs() + 0.01 * gamma.abs() != alpha.abs() || beta.abs() + 0.01 * gamma.abs() != beta.abs())
        || gamma == 0.0
    {
        (a[p * n + q], a[q * n + p]) = (0.0, 0.0);
        return false;
    }
    let zeta = (beta - alpha) / (2.0 * gamma);
    let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    let s = c * t;
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
    }
    turn(a, n, (p, q), (c, s));
    (a[p * n + p], a[q * n + q]) = (alpha - t * gamma, beta + t * gamma);
    (a[p * n + q], a[q * n + p]) = (0.0, 0.0);
    turn(vectors, n, (p, q), (c, s));
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::product;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn vectors_are_eigenvectors(n in 1_usize..9, entries in prop::collection::vec(-1.0..1.0_f64, 64), same in any::<bool>()) {
            let mut matrix = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..=i {
                    let x = if same && (i + j) % 2 == 0 { 1.0 } else { entries[i * 8 + j] };
                    (matrix[i * n + j], matrix[j * n + i]) = (x, x);
                }
            }
            let (values, vectors) = symmetric(&matrix, n);
            prop_assert!(values.windows(2).all(|pair| pair[0] <= pair[1]));
            for (value, vector) in values.iter().zip(vectors.chunks_exact(n)) {
                let mut image = vec![0.0; n];
                product(&matrix, vector, (n, n, 1), &mut image);
                let length: f64 = vector.iter().map(|x| x * x).sum();
                prop_assert!((length - 1.0).abs() < 1e-13);
                for (x, y) in image.iter().zip(vector) {
                    prop_assert!((x - value * y).abs() < 3e-14, "{image:?} {value} {vector:?}");
                }
            }
        }
    }

    #[test]
    fn known_values() {
        assert_eq!(symmetric(&[2.0, 9.0, 0.0, -1.0], 2).0, [-1.0, 2.0]); // the upper triangle is not read
        let (values, _) = symmetric(&[2.0, 1.0, 1.0, 2.0], 2);
        assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
        assert_eq!(symmetric(&[], 0).0, [0.0; 0]);
    }
}
