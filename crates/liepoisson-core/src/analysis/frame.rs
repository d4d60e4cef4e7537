//! Orthonormal frames of tangent vectors: the same bits on every processor, which a library for linear algebra with kernels for
//! each of them does not promise.

/// The factors Q R of a matrix, with a positive diagonal of R, by Householder's reflections.
///
/// Sums are in the order of the components. A column that depends on those before it gets a diagonal of round-off, or zero, and a
/// vector that makes the frame orthonormal all the same.
///
/// # Arguments
/// * `matrix`: `n_rows` rows of `n_columns` numbers, not more columns than rows; becomes Q.
/// * `triangle`: becomes R, `n_columns` rows of `n_columns` numbers.
///
/// # Panics
/// If the lengths do not fit.
pub fn orthonormalise(matrix: &mut [f64], n_rows: usize, n_columns: usize, triangle: &mut [f64]) {
    assert!(n_columns <= n_rows && matrix.len() == n_rows * n_columns && triangle.len() == n_columns * n_columns);
    let at = |row: usize, column: usize| row * n_columns + column;
    let mut normals = vec![0.0; n_rows * n_columns];
    triangle.fill(0.0);
    for k in 0..n_columns {
        let size = (k..n_rows).fold(0.0, |size: f64, i| size.max(matrix[at(i, k)].abs()));
        if size > 0.0 {
            let mut square = 0.0;
            for i in k..n_rows {
                let x = matrix[at(i, k)] / size;
                normals[at(i, k)] = x;
                square += x * x;
            }
            let length = square.sqrt();
            let first = normals[at(k, k)];
            // away from the first component, so that nothing cancels; the sign of R follows below
            let image = if first < 0.0 { length } else { -length };
            normals[at(k, k)] = first - image;
            triangle[at(k, k)] = image * size;
            let weight = 1.0 / (square - first * image);
            for j in k + 1..n_columns {
                reflect(&normals, matrix, k, j, weight, n_rows, n_columns);
            }
        }
        for j in k + 1..n_columns {
            triangle[at(k, j)] = matrix[at(k, j)];
        }
    }
    matrix.fill(0.0);
    for k in (0..n_columns).rev() {
        matrix[at(k, k)] = 1.0;
        let mut square = 0.0;
        for i in k..n_rows {
            square += normals[at(i, k)] * normals[at(i, k)];
        }
        if square > 0.0 {
            for j in k..n_columns {
                reflect(&normals, matrix, k, j, 2.0 / square, n_rows, n_columns);
            }
        }
    }
    for k in 0..n_columns {
        if triangle[at(k, k)] < 0.0 {
            for j in k..n_columns {
                triangle[at(k, j)] = -triangle[at(k, j)];
            }
            for i in 0..n_rows {
                matrix[at(i, k)] = -matrix[at(i, k)];
            }
        }
    }
}

/// Reflects column j in the plane with the normal in column k; the weight is two over the square of its length.
fn reflect(normals: &[f64], matrix: &mut [f64], k: usize, j: usize, weight: f64, n_rows: usize, n_columns: usize) {
    let mut product = 0.0;
    for i in k..n_rows {
        product += normals[i * n_columns + k] * matrix[i * n_columns + j];
    }
    let share = product * weight;
    for i in k..n_rows {
        matrix[i * n_columns + j] -= share * normals[i * n_columns + k];
    }
}
