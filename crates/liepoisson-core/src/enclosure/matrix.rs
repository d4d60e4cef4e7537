//! Vectors and matrices of doubles and of intervals.

use super::interval::Interval;
use super::sum::Sum;
use std::ops::{Index, IndexMut};

/// A box: an interval for each component.
pub type IntervalVector = Vec<Interval>;

/// A matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix<T> {
    n_rows: usize,
    n_columns: usize,
    entries: Vec<T>,
}

impl<T> Index<(usize, usize)> for Matrix<T> {
    type Output = T;
    fn index(&self, (row, column): (usize, usize)) -> &T {
        &self.entries[row * self.n_columns + column]
    }
}

impl<T> IndexMut<(usize, usize)> for Matrix<T> {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut T {
        &mut self.entries[row * self.n_columns + column]
    }
}

impl<T: Copy> Matrix<T> {
    /// The matrix with these entries.
    pub fn from_fn(n_rows: usize, n_columns: usize, mut entry: impl FnMut(usize, usize) -> T) -> Matrix<T> {
        let mut entries = Vec::with_capacity(n_rows * n_columns);
        for row in 0..n_rows {
            for column in 0..n_columns {
                entries.push(entry(row, column));
            }
        }
        Matrix { n_rows, n_columns, entries }
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Number of columns.
    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// The entries, row by row.
    pub fn entries(&self) -> &[T] {
        &self.entries
    }

    /// One row.
    pub fn row(&self, row: usize) -> &[T] {
        &self.entries[row * self.n_columns..(row + 1) * self.n_columns]
    }

    /// One column.
    pub fn column(&self, column: usize) -> Vec<T> {
        (0..self.n_rows).map(|row| self[(row, column)]).collect()
    }

    /// Rows and columns in exchanged places.
    pub fn transposed(&self) -> Matrix<T> {
        Matrix::from_fn(self.n_columns, self.n_rows, |i, j| self[(j, i)])
    }

    /// The rows and columns of these numbers.
    pub fn block(&self, rows: &[usize], columns: &[usize]) -> Matrix<T> {
        Matrix::from_fn(rows.len(), columns.len(), |i, j| self[(rows[i], columns[j])])
    }

    /// The matrix with each entry replaced.
    pub fn map<U: Copy>(&self, function: impl Fn(T) -> U) -> Matrix<U> {
        Matrix::from_fn(self.n_rows, self.n_columns, |i, j| function(self[(i, j)]))
    }
}

impl Matrix<f64> {
    /// The unit matrix.
    pub fn identity(n: usize) -> Matrix<f64> {
        Matrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    /// The same matrix as a matrix of intervals.
    pub fn enclosed(&self) -> Matrix<Interval> {
        self.map(Interval::point)
    }
}

impl Matrix<Interval> {
    /// The product with a matrix.
    ///
    /// # Panics
    /// If the shapes do not fit.
    pub fn times(&self, other: &Matrix<Interval>) -> Matrix<Interval> {
        assert_eq!(self.n_columns, other.n_rows, "shapes of the factors");
        let columns = other.transposed();
        Matrix::from_fn(self.n_rows, other.n_columns, |i, j| dot(self.row(i), columns.row(j)))
    }

    /// The product with a vector.
    pub fn apply(&self, vector: &[Interval]) -> IntervalVector {
        (0..self.n_rows).map(|i| dot(self.row(i), vector)).collect()
    }

    /// The sum.
    pub fn plus(&self, other: &Matrix<Interval>) -> Matrix<Interval> {
        Matrix::from_fn(self.n_rows, self.n_columns, |i, j| self[(i, j)] + other[(i, j)])
    }

    /// The difference.
    pub fn minus(&self, other: &Matrix<Interval>) -> Matrix<Interval> {
        Matrix::from_fn(self.n_rows, self.n_columns, |i, j| self[(i, j)] - other[(i, j)])
    }

    /// The middles of the entries.
    pub fn mid(&self) -> Matrix<f64> {
        self.map(Interval::mid)
    }

    /// Whether every entry is within that of `other`.
    pub fn is_within(&self, other: &Matrix<Interval>) -> bool {
        self.entries.iter().zip(&other.entries).all(|(a, b)| a.is_within(*b))
    }

    /// Whether nothing is known of an entry.
    pub fn is_unknown(&self) -> bool {
        self.entries.iter().any(|entry| entry.is_unknown())
    }
}

/// `sum_i a_i b_i`.
///
/// # Panics
/// If the lengths differ.
pub fn dot(a: &[Interval], b: &[Interval]) -> Interval {
    assert_eq!(a.len(), b.len(), "lengths of the factors");
    let mut sum = Sum::new();
    a.iter().zip(b).for_each(|(&a, &b)| sum.add_product(a, b));
    sum.total()
}

/// Doubles as intervals.
pub fn points(values: &[f64]) -> IntervalVector {
    values.iter().map(|&value| Interval::point(value)).collect()
}

/// The middle of a box.
pub fn mid(vector: &[Interval]) -> Vec<f64> {
    vector.iter().map(|component| component.mid()).collect()
}

/// Component by component.
pub fn combine(a: &[Interval], b: &[Interval], operation: impl Fn(Interval, Interval) -> Interval) -> IntervalVector {
    a.iter().zip(b).map(|(&a, &b)| operation(a, b)).collect()
}

/// The least box that contains both.
pub fn hull(a: &[Interval], b: &[Interval]) -> IntervalVector {
    combine(a, b, Interval::hull)
}

/// What both boxes have in common; unknown where that is nothing.
pub fn meet(a: &[Interval], b: &[Interval]) -> IntervalVector {
    combine(a, b, Interval::meet)
}

/// Whether box `a` is a part of box `b`.
pub fn is_within(a: &[Interval], b: &[Interval]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.is_within(*b))
}

/// Whether box `a` is a part of box `b` and does not touch its boundary.
pub fn is_inside(a: &[Interval], b: &[Interval]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.is_inside(*b))
}

/// Whether nothing is known of a component.
pub fn is_unknown(vector: &[Interval]) -> bool {
    vector.iter().any(|component| component.is_unknown())
}
