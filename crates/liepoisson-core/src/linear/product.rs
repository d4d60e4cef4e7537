//! Products of matrices.

/// `a b` for `a` of shape (n, m) and `b` of shape (m, p), added to `result`, shape (n, p), which begins as zero.
///
/// # Panics
/// If a slice has another length.
pub fn product(a: &[f64], b: &[f64], (n, m, p): (usize, usize, usize), result: &mut [f64]) {
    assert!(a.len() == n * m && b.len() == m * p && result.len() == n * p, "shapes of a product");
    if p == 1 {
        for (row, sum) in a.chunks_exact(m.max(1)).zip(result) {
            for (x, y) in row.iter().zip(b) {
                *sum += x * y;
            }
        }
        return;
    }
    for i in 0..n {
        let sums = &mut result[i * p..(i + 1) * p];
        for k in 0..m {
            let x = a[i * m + k];
            for (sum, y) in sums.iter_mut().zip(&b[k * p..(k + 1) * p]) {
                *sum += x * y;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_times_columns() {
        let mut result = [0.0; 4];
        product(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &[1.0, 0.0, 0.0, 1.0, 2.0, -1.0], (2, 3, 2), &mut result);
        assert_eq!(result, [7.0, -1.0, 16.0, -1.0]);
        let mut result = [0.0; 2];
        product(&[1.0, 2.0, 3.0, 4.0], &[5.0, 6.0], (2, 2, 1), &mut result);
        assert_eq!(result, [17.0, 39.0]);
        product(&[], &[], (2, 0, 1), &mut result);
    }
}
