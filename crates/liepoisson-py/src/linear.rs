//! Linear algebra and elementary functions with the same bits on every processor: flat arrays of several matrices, row by row.

use crate::errors::exception;
use crate::{Doubles, copied};
use liepoisson_core::elementary;
use liepoisson_core::fourier;
use liepoisson_core::linear::{self, Eigen, Lu, Singular};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;

/// Several arrays of doubles.
type Parts<'py, const N: usize> = [Doubles<'py>; N];

/// `N` arrays with the numbers of each of `n` matrices that have `size` entries; none where one matrix has no numbers.
fn of_each<'py, const N: usize, Numbers: IntoIterator<Item = f64>>(
    py: Python<'py>,
    array: &PyReadonlyArray1<'py, f64>,
    n: usize,
    size: usize,
    numbers_of: impl Fn(&[f64]) -> Option<[Numbers; N]>,
) -> PyResult<Option<Parts<'py, N>>> {
    let matrices = matrices(array, n, size)?;
    let mut found = [const { Vec::new() }; N];
    for k in 0..n {
        let Some(numbers) = numbers_of(&matrices[k * size..(k + 1) * size]) else { return Ok(None) };
        found.iter_mut().zip(numbers).for_each(|(all, these)| all.extend(these));
    }
    Ok(Some(found.map(|numbers| numbers.into_pyarray(py))))
}

/// The same where every matrix has them.
fn of_all<'py, const N: usize, Numbers: IntoIterator<Item = f64>>(
    py: Python<'py>,
    array: &PyReadonlyArray1<'py, f64>,
    n: usize,
    size: usize,
    numbers_of: impl Fn(&[f64]) -> [Numbers; N],
) -> PyResult<Parts<'py, N>> {
    let found = of_each(py, array, n, size, |matrix| Some(numbers_of(matrix)))?;
    Ok(found.expect("each matrix has numbers"))
}

fn wrong_length(name: &str, wanted: usize, got: usize) -> PyErr {
    exception("ShapeError", &format!("{name}: wanted {wanted} numbers; got {got}."))
}

/// The numbers of `n` matrices with `size` entries each.
fn matrices(array: &PyReadonlyArray1<'_, f64>, n: usize, size: usize) -> PyResult<Vec<f64>> {
    let numbers = copied(array)?;
    let wanted = n.saturating_mul(size);
    if numbers.len() == wanted { Ok(numbers) } else { Err(wrong_length("matrices", wanted, numbers.len())) }
}

/// The parts of matrices `k` of `n`; of one for all, the same each time.
fn part(numbers: &[f64], size: usize, k: usize) -> &[f64] {
    let first = if numbers.len() == size { 0 } else { k * size };
    &numbers[first..first + size]
}

/// Products of `n_matrices` pairs of shapes (n, m) and (m, p); either side may be one matrix for all.
#[pyfunction]
pub(crate) fn products<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    b: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    shape: (usize, usize, usize),
) -> PyResult<Doubles<'py>> {
    let ((n, m, p), a, b) = (shape, copied(&a)?, copied(&b)?);
    for (name, numbers, size) in [("a", &a, n * m), ("b", &b, m * p)] {
        if numbers.len() != size && numbers.len() != n_matrices * size {
            return Err(wrong_length(name, n_matrices * size, numbers.len()));
        }
    }
    let mut result = vec![0.0; n_matrices * n * p];
    for k in 0..n_matrices {
        linear::product(part(&a, n * m, k), part(&b, m * p, k), shape, &mut result[k * n * p..(k + 1) * n * p]);
    }
    Ok(result.into_pyarray(py))
}

/// Solutions of `n_matrices` systems of shapes (n, n) and (n, m); none where a matrix is singular.
#[pyfunction]
pub(crate) fn solutions<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    b: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    shape: (usize, usize),
) -> PyResult<Option<Doubles<'py>>> {
    let (n, m) = shape;
    let (a, mut b) = (matrices(&a, n_matrices, n * n)?, matrices(&b, n_matrices, n * m)?);
    for k in 0..n_matrices {
        let lu = Lu::new(part(&a, n * n, k), n);
        if lu.is_singular() {
            return Ok(None);
        }
        lu.solve(&mut b[k * n * m..(k + 1) * n * m], m);
    }
    Ok(Some(b.into_pyarray(py)))
}

/// Determinants of matrices of shape (n, n), their signs, and the logarithms of their absolute values.
#[pyfunction]
pub(crate) fn determinants<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    n: usize,
) -> PyResult<Parts<'py, 3>> {
    of_all(py, &a, n_matrices, n * n, |matrix| {
        let lu = Lu::new(matrix, n);
        let (sign, logarithm) = lu.sign_and_logarithm();
        [[lu.determinant()], [sign], [logarithm]]
    })
}

/// Cholesky's factors of symmetric matrices of shape (n, n); none where one is not positive definite.
#[pyfunction]
pub(crate) fn cholesky<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    n: usize,
) -> PyResult<Option<Doubles<'py>>> {
    let found = of_each(py, &a, n_matrices, n * n, |matrix| linear::cholesky(matrix, n).map(|lower| [lower]))?;
    Ok(found.map(|[lower]| lower))
}

/// U, the singular values, and V^T of matrices of shape (n, m) with n >= m.
#[pyfunction]
pub(crate) fn singular<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    shape: (usize, usize),
) -> PyResult<Parts<'py, 3>> {
    let (n, m) = shape;
    if n < m {
        return Err(exception("ShapeError", "matrices must have at least as many rows as columns; got another shape."));
    }
    of_all(py, &a, n_matrices, n * m, |matrix| {
        let Singular { left, values, right } = linear::singular(matrix, n, m);
        [left, values, right]
    })
}

/// Eigenvalues, rising, and eigenvectors as rows of symmetric matrices, of which the lower triangles are read.
#[pyfunction]
pub(crate) fn symmetric<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    n: usize,
) -> PyResult<Parts<'py, 2>> {
    of_all(py, &a, n_matrices, n * n, |matrix| <[_; 2]>::from(linear::symmetric(matrix, n)))
}

/// Eigenvalues and eigenvectors as rows of matrices of shape (n, n), real and imaginary parts by turns; none where one has entries
/// that are not finite.
#[pyfunction]
pub(crate) fn eigen<'py>(
    py: Python<'py>,
    a: PyReadonlyArray1<'py, f64>,
    n_matrices: usize,
    n: usize,
) -> PyResult<Option<Parts<'py, 2>>> {
    of_each(py, &a, n_matrices, n * n, |matrix| {
        let Eigen { values, vectors } = linear::eigen(matrix, n)?;
        Some([values, vectors].map(|pairs| pairs.into_flattened()))
    })
}

/// Fourier transforms of rows of `n` complex samples, real and imaginary parts by turns; `n` is a power of two.
#[pyfunction]
pub(crate) fn fourier_transforms<'py>(
    py: Python<'py>,
    samples: PyReadonlyArray1<'py, f64>,
    n: usize,
) -> PyResult<Doubles<'py>> {
    let mut numbers = copied(&samples)?;
    if !n.is_power_of_two() || !numbers.len().is_multiple_of(2 * n) {
        return Err(exception("ShapeError", "samples: wanted rows of a power of two samples; got another shape."));
    }
    for row in numbers.chunks_exact_mut(2 * n) {
        fourier::transform(row.as_chunks_mut().0);
    }
    Ok(numbers.into_pyarray(py))
}

fn unknown(name: &str) -> PyErr {
    exception("ParameterError", &format!("name: wanted an elementary function; got {name}."))
}

/// Values of an elementary function of one variable.
#[pyfunction]
pub(crate) fn elementary_of_one<'py>(
    py: Python<'py>,
    name: &str,
    x: PyReadonlyArray1<'py, f64>,
) -> PyResult<Doubles<'py>> {
    let function = elementary::of_one(name).ok_or_else(|| unknown(name))?;
    let mut values = copied(&x)?;
    values.iter_mut().for_each(|x| *x = function(*x));
    Ok(values.into_pyarray(py))
}

/// Values of an elementary function of two variables.
#[pyfunction]
pub(crate) fn elementary_of_two<'py>(
    py: Python<'py>,
    name: &str,
    x: PyReadonlyArray1<'py, f64>,
    y: PyReadonlyArray1<'py, f64>,
) -> PyResult<Doubles<'py>> {
    let function = elementary::of_two(name).ok_or_else(|| unknown(name))?;
    let mut values = copied(&x)?;
    let other = matrices(&y, values.len(), 1)?;
    values.iter_mut().zip(&other).for_each(|(x, &y)| *x = function(*x, y));
    Ok(values.into_pyarray(py))
}
