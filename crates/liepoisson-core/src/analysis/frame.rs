//! Orthonormal frames of tangent vectors: the same bits on every processor, which a library for linear algebra with kernels for
//! each of them does not promise.

use crate::lanes::{Body, Simd, Task, Wide, dispatch};
use std::marker::PhantomData;

// Loops over rows count: an iterator over parts of a slice begins with a division, which takes as long as a row of a small matrix.

/// Columns of a row are a multiple of this, so that registers of any width hold whole parts of it.
const WIDEST: usize = 8;

/// Room for the factors of matrices of one shape, for one after the other.
///
/// The columns of a row stand side by side in registers. Sums are those of one column, in the order of the components, so that
/// they have the same bits in registers of any width.
pub struct Frame {
    n_rows: usize,
    n_columns: usize,
    /// Numbers in a row of `matrix`.
    stride: usize,
    matrix: Vec<f64>,
    /// Normals of the planes in which columns are reflected, one after the other.
    normals: Vec<f64>,
    triangle: Vec<f64>,
}

impl Frame {
    /// Room for matrices with so many rows and columns.
    ///
    /// # Panics
    /// If there are more columns than rows.
    pub fn new(n_rows: usize, n_columns: usize) -> Frame {
        assert!(n_columns <= n_rows, "a frame has at most as many vectors as components");
        let stride = n_columns.next_multiple_of(WIDEST);
        let (matrix, normals) = (vec![0.0; n_rows * stride], vec![0.0; n_rows * n_columns]);
        Frame { n_rows, n_columns, stride, matrix, normals, triangle: vec![0.0; n_columns * n_columns] }
    }

    /// Sets an entry of the matrix.
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.matrix[row * self.stride + column] = value;
    }

    /// A row of the matrix, or after [`Frame::orthonormalise`] of Q.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.matrix[row * self.stride..][..self.n_columns]
    }

    /// R, row by row, after [`Frame::orthonormalise`].
    pub fn triangle(&self) -> &[f64] {
        &self.triangle
    }

    /// Replaces the matrix by the factor Q of Q R with a positive diagonal of R, by Householder's reflections.
    ///
    /// A column that depends on those before it gets a diagonal of round-off, or zero, and a vector that makes the frame
    /// orthonormal all the same.
    pub fn orthonormalise(&mut self, simd: Simd) {
        dispatch(simd, Outlined(self));
    }

    /// The normal of the reflection that takes column `k` to a multiple of the first component left, and its weight, two over the
    /// square of its length; none where nothing is left of the column.
    #[inline(always)]
    fn make_normal(&mut self, k: usize) -> Option<f64> {
        let (n_rows, n_columns, stride) = (self.n_rows, self.n_columns, self.stride);
        let normal = &mut self.normals[k * n_rows..(k + 1) * n_rows];
        for i in k..n_rows {
            normal[i] = self.matrix[i * stride + k];
        }
        let size = normal[k..].iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        if size > 0.0 {
            normal[k..].iter_mut().for_each(|x| *x /= size);
            let mut square = 0.0;
            for x in &normal[k..] {
                square += x * x;
            }
            let length = square.sqrt();
            let first = normal[k];
            // away from the first component, so that nothing cancels; the sign of R follows later
            let image = if first < 0.0 { length } else { -length };
            normal[k] = first - image;
            self.triangle[k * n_columns + k] = image * size;
            return Some(1.0 / (square - first * image));
        }
        normal[k..].fill(0.0);
        self.triangle[k * n_columns + k] = 0.0;
        None
    }

    /// Reflects the columns from the register with column `from` on; those before, in the same register, nobody reads again.
    #[inline(always)]
    fn reflect<V: Wide>(&mut self, k: usize, from: usize, weight: f64) {
        let mut at = from / V::WIDTH * V::WIDTH;
        while at < self.n_columns {
            at += match (self.n_columns - at).div_ceil(V::WIDTH) {
                4.. => self.reflect_columns::<V, 4>(k, at, weight),
                2.. => self.reflect_columns::<V, 2>(k, at, weight),
                _ => self.reflect_columns::<V, 1>(k, at, weight),
            };
        }
    }

    /// The same for the columns of `M` registers, as many as are returned.
    #[inline(always)]
    fn reflect_columns<V: Wide, const M: usize>(&mut self, k: usize, at: usize, weight: f64) -> usize {
        let (n_rows, stride) = (self.n_rows, self.stride);
        let normal = &self.normals[k * n_rows..(k + 1) * n_rows];
        let mut share = [V::splat(0.0); M];
        for i in k..n_rows {
            let (part, x) = (&self.matrix[i * stride + at..][..M * V::WIDTH], V::splat(normal[i]));
            for m in 0..M {
                share[m] = share[m].add(x.mul(register(&part[m * V::WIDTH..])));
            }
        }
        for m in 0..M {
            share[m] = share[m].mul(V::splat(weight));
        }
        for i in k..n_rows {
            let (part, x) = (&mut self.matrix[i * stride + at..][..M * V::WIDTH], V::splat(normal[i]));
            for m in 0..M {
                let part = &mut part[m * V::WIDTH..][..V::WIDTH];
                let value: V = register(part);
                part.copy_from_slice(value.sub(share[m].mul(x)).as_scalars());
            }
        }
        M * V::WIDTH
    }

    /// The reflections one after the other, and R.
    #[inline(always)]
    fn reduce<V: Wide>(&mut self) {
        let (n, stride) = (self.n_columns, self.stride);
        for k in 0..n {
            if let Some(weight) = self.make_normal(k)
                && k + 1 < n
            {
                self.reflect::<V>(k, k + 1, weight);
            }
            let (row, reflected) = (&mut self.triangle[k * n..][..n], &self.matrix[k * stride..][..n]);
            row[..k].fill(0.0);
            row[k + 1..].copy_from_slice(&reflected[k + 1..]);
        }
    }

    /// Q from the reflections, in the reverse order.
    #[inline(always)]
    fn build<V: Wide>(&mut self) {
        self.matrix.fill(0.0);
        for k in (0..self.n_columns).rev() {
            self.matrix[k * self.stride + k] = 1.0;
            let normal = &self.normals[k * self.n_rows + k..(k + 1) * self.n_rows];
            let mut square = 0.0;
            for x in normal {
                square += x * x;
            }
            if square > 0.0 {
                self.reflect::<V>(k, k, 2.0 / square);
            }
        }
    }

    /// Changes signs until the diagonal of R is positive.
    #[inline(always)]
    fn turn(&mut self) {
        let n = self.n_columns;
        for k in 0..n {
            if self.triangle[k * n + k] < 0.0 {
                for x in &mut self.triangle[k * n + k..(k + 1) * n] {
                    *x = -*x;
                }
                for i in 0..self.n_rows {
                    let x = &mut self.matrix[i * self.stride + k];
                    *x = -*x;
                }
            }
        }
    }
}

struct Outlined<'f>(&'f mut Frame);

impl Task for Outlined<'_> {
    type Output = ();

    fn run<V: Wide>(self) {
        V::outline(Reflections::<V>(self.0, PhantomData));
    }
}

struct Reflections<'f, V>(&'f mut Frame, PhantomData<V>);

impl<V: Wide> Body for Reflections<'_, V> {
    #[inline(always)]
    fn run(self) {
        self.0.reduce::<V>();
        self.0.build::<V>();
        self.0.turn();
    }
}

/// The first numbers of a slice.
#[inline(always)]
fn register<V: Wide>(numbers: &[f64]) -> V {
    let mut register = V::splat(0.0);
    register.as_scalars_mut().copy_from_slice(&numbers[..V::WIDTH]);
    register
}

/// The factors Q R of a matrix, with a positive diagonal of R; see [`Frame::orthonormalise`].
///
/// # Arguments
/// * `matrix`: `n_rows` rows of `n_columns` numbers, not more columns than rows; becomes Q.
/// * `triangle`: becomes R, `n_columns` rows of `n_columns` numbers.
///
/// # Panics
/// If the lengths do not fit.
pub fn orthonormalise(simd: Simd, matrix: &mut [f64], n_rows: usize, n_columns: usize, triangle: &mut [f64]) {
    assert!(matrix.len() == n_rows * n_columns && triangle.len() == n_columns * n_columns);
    let mut frame = Frame::new(n_rows, n_columns);
    for (i, row) in matrix.chunks_exact(n_columns.max(1)).enumerate() {
        for (j, &x) in row.iter().enumerate() {
            frame.set(i, j, x);
        }
    }
    frame.orthonormalise(simd);
    for (i, row) in matrix.chunks_exact_mut(n_columns.max(1)).enumerate() {
        row.copy_from_slice(frame.row(i));
    }
    triangle.copy_from_slice(frame.triangle());
}
