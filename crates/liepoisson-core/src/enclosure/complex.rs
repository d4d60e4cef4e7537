//! Complex numbers in doubles, and matrices of complex intervals, as far as eigenvalues need them.

use super::interval::Interval;
use super::linear::Scalar;
use super::matrix::Matrix;
use std::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Number {
    pub(super) const ZERO: Number = Number { re: 0.0, im: 0.0 };
    pub(super) const ONE: Number = Number { re: 1.0, im: 0.0 };
}

impl Scalar for Number {
    fn real(re: f64) -> Number {
        Number { re, im: 0.0 }
    }

    fn size(self) -> f64 {
        libm::hypot(self.re, self.im)
    }
}

impl Add for Number {
    type Output = Number;
    fn add(self, other: Number) -> Number {
        Number { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Number {
    type Output = Number;
    fn sub(self, other: Number) -> Number {
        Number { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Number {
    type Output = Number;
    fn mul(self, other: Number) -> Number {
        Number { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for Number {
    type Output = Number;
    fn div(self, other: Number) -> Number {
        let size = other.size();
        let (re, im) = (other.re / size, other.im / size);
        let turned = self * Number { re, im: -im };
        Number { re: turned.re / size, im: turned.im / size }
    }
}

/// A matrix of complex intervals, by real and imaginary parts.
#[derive(Clone, Debug)]
pub(super) struct ComplexMatrix {
    pub(super) re: Matrix<Interval>,
    pub(super) im: Matrix<Interval>,
}

impl ComplexMatrix {
    pub(super) fn enclosing(matrix: &Matrix<Number>) -> ComplexMatrix {
        ComplexMatrix {
            re: matrix.map(|entry| Interval::point(entry.re)),
            im: matrix.map(|entry| Interval::point(entry.im)),
        }
    }

    pub(super) fn real(matrix: &Matrix<Interval>) -> ComplexMatrix {
        ComplexMatrix { re: matrix.clone(), im: matrix.map(|_| Interval::ZERO) }
    }

    pub(super) fn times(&self, other: &ComplexMatrix) -> ComplexMatrix {
        ComplexMatrix {
            re: self.re.times(&other.re).minus(&self.im.times(&other.im)),
            im: self.re.times(&other.im).plus(&self.im.times(&other.re)),
        }
    }

    pub(super) fn minus_identity(&self) -> ComplexMatrix {
        let unit = Matrix::identity(self.re.n_rows()).enclosed();
        ComplexMatrix { re: self.re.minus(&unit), im: self.im.clone() }
    }

    pub(super) fn modulus(&self, i: usize, j: usize) -> Interval {
        (self.re[(i, j)].sqr() + self.im[(i, j)].sqr()).sqrt()
    }

    /// `max_i sum_j |a_ij|`, from above.
    pub(super) fn row_sum_norm(&self) -> f64 {
        let n = self.re.n_columns();
        let sum = |i: usize| (0..n).fold(Interval::ZERO, |sum, j| sum + self.modulus(i, j)).hi();
        (0..self.re.n_rows()).map(sum).fold(0.0, super::linear::larger)
    }
}
