//! Singular values by one-sided Jacobi rotations (Hestenes 1958; Demmel and Veselić 1992).

use super::MOST_SWEEPS;
use crate::analysis::frame::Frame;
use crate::lanes::Simd;

/// A = U S V^T for a matrix of shape (n, m) with n >= m.
pub struct Singular {
    /// The left vectors as columns, shape (n, m): orthonormal, also those of values that vanish.
    pub left: Vec<f64>,
    /// The values, falling.
    pub values: Vec<f64>,
    /// The right vectors as rows, shape (m, m).
    pub right: Vec<f64>,
}

/// The factors of a matrix of shape (n, m) with n >= m.
///
/// Pairs of columns are rotated until all are orthogonal to round-off. The columns of U that belong to values of round-off
/// beside the largest one are made orthogonal by Householder's reflections, which complete those of zero.
///
/// # Panics
/// If n < m, or the slice has another length.
pub fn singular(matrix: &[f64], n: usize, m: usize) -> Singular {
    assert!(n >= m && matrix.len() == n * m, "as many rows as columns, or more");
    // columns of A and of V as contiguous rows; scaled, so that squares neither overflow nor vanish
    let scale = power_of_two_above(matrix.iter().fold(0.0, |size: f64, x| size.max(x.abs())));
    let mut columns: Vec<f64> = (0..n * m).map(|k| matrix[k % n * m + k / n] / scale).collect();
    let mut right = vec![0.0; m * m];
    (0..m).for_each(|k| right[k * m + k] = 1.0);
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for p in 0..m {
            for q in p + 1..m {
                rotated |= rotate(&mut columns, &mut right, (n, m), (p, q));
            }
        }
        if !rotated {
            break;
        }
    }
    let sizes: Vec<f64> = columns.chunks_exact(n.max(1)).map(length).collect();
    let mut order: Vec<usize> = (0..m).collect();
    order.sort_by(|&p, &q| sizes[q].total_cmp(&sizes[p]));
    let values: Vec<f64> = order.iter().map(|&k| sizes[k] * scale).collect();
    let left = left_vectors(&columns, &sizes, &order, n);
    let right = order.iter().flat_map(|&k| right[k * m..(k + 1) * m].iter().copied()).collect();
    Singular { left, values, right }
}

/// A power of two, so that division by it is exact; one for zero and for what is not finite.
pub(super) fn power_of_two_above(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        let exponent = (size.to_bits() >> 52) as i64 - 1022; // of a subnormal number: -1022
        libm::scalbn(1.0, exponent.clamp(-1020, 1020) as i32)
    } else {
        1.0
    }
}

/// The length of a vector, also of one whose squares are too small for doubles.
fn length(x: &[f64]) -> f64 {
    let unit = power_of_two_above(x.iter().fold(0.0, |size: f64, x| size.max(x.abs())));
    x.iter().fold(0.0, |sum, x| sum + (x / unit) * (x / unit)).sqrt() * unit
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (x, y)| sum + x * y)
}

/// Makes two columns orthogonal; whether they were not.
fn rotate(columns: &mut [f64], right: &mut [f64], (n, m): (usize, usize), (p, q): (usize, usize)) -> bool {
    let (a, b) = (&columns[p * n..(p + 1) * n], &columns[q * n..(q + 1) * n]);
    let (alpha, beta, gamma) = (dot(a, a), dot(b, b), dot(a, b));
    if gamma.abs() <= f64::EPSILON * (alpha * beta).sqrt() || gamma.is_nan() {
        return false;
    }
    let zeta = (beta - alpha) / (2.0 * gamma);
    let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    turn(columns, n, (p, q), (c, c * t));
    turn(right, m, (p, q), (c, c * t));
    true
}

/// Rotates rows `p < q` of length `n`.
pub(super) fn turn(rows: &mut [f64], n: usize, (p, q): (usize, usize), (c, s): (f64, f64)) {
    let (first, second) = rows.split_at_mut(q * n);
    for (x, y) in first[p * n..(p + 1) * n].iter_mut().zip(&mut second[..n]) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}

/// The columns over their lengths, in the order of the values; small ones are orthogonal to others to absolute round-off
/// only, and are made so, those of zero completed.
fn left_vectors(columns: &[f64], sizes: &[f64], order: &[usize], n: usize) -> Vec<f64> {
    let m = order.len();
    let least = f64::EPSILON * n as f64 * sizes.iter().fold(0.0, |size: f64, x| size.max(*x));
    let mut left = vec![0.0; n * m];
    let known = order.iter().take_while(|&&k| sizes[k] > least).count();
    for (j, &k) in order.iter().enumerate().filter(|&(_, &k)| sizes[k] > 0.0) {
        for i in 0..n {
            left[i * m + j] = columns[k * n + i] / sizes[k];
        }
    }
    if known < m && sizes.iter().all(|size| size.is_finite()) {
        let mut frame = Frame::new(n, m);
        for k in 0..n * m {
            frame.set(k / m, k % m, left[k]);
        }
        frame.orthonormalise(Simd::Scalar);
        for i in 0..n {
            left[i * m + known..(i + 1) * m].copy_from_slice(&frame.row(i)[known..]);
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::product;
    use proptest::prelude::*;

    fn transposed(a: &[f64], n: usize, m: usize) -> Vec<f64> {
        (0..n * m).map(|k| a[k % n * m + k / n]).collect()
    }

    fn check(matrix: &[f64], n: usize, m: usize) -> Result<(), TestCaseError> {
        let Singular { left, values, right } = singular(matrix, n, m);
        let size = values.first().copied().unwrap_or(0.0);
        let scaled: Vec<f64> = (0..n * m).map(|k| left[k] * values[k % m]).collect();
        let mut back = vec![0.0; n * m];
        product(&scaled, &right, (n, m, m), &mut back);
        for (x, y) in back.iter().zip(matrix) {
            prop_assert!((x - y).abs() <= 1e-14 * size, "{x} {y}");
        }
        for (frame, rows) in [(transposed(&left, n, m), n), (right.clone(), m)] {
            let mut gram = vec![0.0; m * m];
            product(&frame, &transposed(&frame, m, rows), (m, rows, m), &mut gram);
            for (k, x) in gram.iter().enumerate() {
                prop_assert!((x - f64::from(u8::from(k % (m + 1) == 0))).abs() < 2e-14, "{gram:?}");
            }
        }
        prop_assert!(values.windows(2).all(|pair| pair[0] >= pair[1]));
        Ok(())
    }

    proptest! {
        #[test]
        fn the_factors_give_the_matrix(
            n in 1_usize..9, m in 1_usize..9, rank in 1_usize..9, exponent in -300..300_i32,
            entries in prop::collection::vec(-1.0..1.0_f64, 128)
        ) {
            let (n, m) = (n.max(m), n.min(m));
            let rank = rank.min(m);
            let mut matrix = vec![0.0; n * m];
            product(&entries[..n * rank], &entries[64..64 + rank * m], (n, rank, m), &mut matrix);
            matrix.iter_mut().for_each(|x| *x *= libm::exp2(f64::from(exponent)));
            check(&matrix, n, m)?;
        }
    }

    #[test]
    fn extreme_matrices() {
        for (matrix, n, m) in [
            (vec![0.0; 6], 3, 2),
            (vec![1e308; 4], 2, 2),
            (vec![1.0, 0.0, 0.0, 1.0], 2, 2),
            (vec![5e-324, 0.0, 0.0, 5e-324, 0.0, 0.0], 3, 2),
            (vec![1.0, 0.0, 0.0, 1e-200, 0.0, 0.0], 3, 2),
            (vec![], 3, 0),
        ] {
            check(&matrix, n, m).unwrap();
        }
        assert!(singular(&[f64::NAN, 1.0, 2.0, 3.0], 2, 2).values[0].is_nan());
    }

    #[test]
    fn vectors_of_small_values_are_those_of_their_columns() {
        // the directions of both columns are known, however small the second is
        for small in [1e-15, -1e-17, 1e-30, -1e-163, 1e-320] {
            let Singular { left, values, .. } = singular(&[1.0, 0.0, 0.0, small, 0.0, 0.0], 3, 2);
            assert_eq!((left[3], values[1]), (small.signum(), small.abs()));
        }
    }

    #[test]
    fn small_values_beside_large_ones_are_known_to_their_own_digits() {
        // A = Q diag(1, 1e-18) with a rotation Q: the smaller value is 1e-18
        let (c, s) = (0.6, 0.8);
        let values = singular(&[c, -s * 1e-18, s, c * 1e-18], 2, 2).values;
        assert!((values[1] / 1e-18 - 1.0).abs() < 1e-15, "{values:?}");
    }
}
