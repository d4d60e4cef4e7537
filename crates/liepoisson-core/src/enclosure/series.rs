//! The power series of a solution in time, and of its derivative by the start, with coefficients that are enclosed.
//!
//! `x_0` is the start, `x_{k+1} = f(x)_k / (k + 1)`, and the coefficients of a product are `(u v)_k = sum_j u_j v_{k-j}`. The
//! derivative `V = d x / d x_0` has `V_0 = I`, and products `(du v + u dv)_k`. For a box of starts the coefficients contain
//! those of every member.
//!
//! # References
//! - R. E. Moore, *Interval Analysis*, 1966, chapter 11; W. Tucker, *Validated Numerics*, 2011, 6.2.

use super::balls::{Ball, Balls, Factor};
use super::interval::Interval;
use super::matrix::{IntervalVector, Matrix};
use super::program::Program;
use super::sum::Sum;

/// Coefficients of the state and of its derivative, and the room for computing them.
#[derive(Clone, Debug)]
pub struct Series {
    order: usize,
    n_variables: usize,
    /// The most products in a sum of the derivatives.
    n_terms: usize,
    /// Coefficients of each register, one after the other.
    values: Vec<Interval>,
    /// The same, as factors of balls.
    factors: Vec<Factor>,
    /// Of each register and order, the derivatives by all components of the start.
    derivatives: Balls,
}

/// `sum_j a_j b_{k-j}` for `j` from 0 to `k`.
fn convolution(a: &[Interval], b: &[Interval], k: usize) -> Interval {
    let mut sum = Sum::new();
    a[..=k].iter().zip(b[..=k].iter().rev()).for_each(|(&a, &b)| sum.add_product(a, b));
    sum.total()
}

/// `sum_j a_j a_{k-j}`: equal products once, and the middle one as a square, which is never negative.
fn convolution_square(a: &[Interval], k: usize) -> Interval {
    let mut sum = Sum::new();
    for j in 0..k.div_ceil(2) {
        sum.add_product(a[j], a[k - j]);
    }
    let half = sum.total();
    let sum = half + half;
    if k.is_multiple_of(2) { sum + a[k / 2].sqr() } else { sum }
}

impl Series {
    /// Room for the coefficients `0..=order` of the solutions of a field.
    pub fn new(field: &Program, order: usize) -> Series {
        let n = field.n_variables;
        let n_rows = field.n_registers() * (order + 1);
        Series {
            order,
            n_variables: n,
            n_terms: field.rows.iter().map(|row| row.terms.len()).fold(2 * (order + 1), usize::max),
            values: vec![Interval::ZERO; n_rows],
            factors: vec![Factor::default(); n_rows],
            derivatives: Balls::zeros(n_rows, n),
        }
    }

    /// Computes the coefficients of the state, for starts in a box.
    pub fn expand(&mut self, field: &Program, start: &[Interval]) {
        self.run(field, start, false);
    }

    /// Computes the coefficients of the state and its derivative.
    pub fn expand_with_derivative(&mut self, field: &Program, start: &[Interval]) {
        self.run(field, start, true);
    }

    fn run(&mut self, field: &Program, start: &[Interval], with_derivative: bool) {
        let (n, stride) = (self.n_variables, self.order + 1);
        for i in 0..n {
            self.values[i * stride] = start[i];
            self.derivatives.set_unit_row(i * stride, i);
        }
        for k in 0..=self.order {
            self.multiply(field, k);
            if k < self.order {
                self.integrate(field, k);
            }
            if with_derivative {
                for row in (0..field.n_registers()).map(|register| register * stride + k) {
                    self.factors[row] = Factor::new(self.values[row], self.n_terms);
                }
                self.multiply_derivatives(field, k);
                if k < self.order {
                    self.integrate_derivatives(field, k);
                }
            }
        }
    }

    /// Coefficient `k` of the products.
    fn multiply(&mut self, field: &Program, k: usize) {
        let (n, stride) = (self.n_variables, self.order + 1);
        for (m, &(a, b)) in field.products.iter().enumerate() {
            let (u, v) = (&self.values[a * stride..][..stride], &self.values[b * stride..][..stride]);
            self.values[(n + m) * stride + k] = if a == b { convolution_square(u, k) } else { convolution(u, v, k) };
        }
    }

    /// Coefficient `k + 1` of the state.
    fn integrate(&mut self, field: &Program, k: usize) {
        let stride = self.order + 1;
        for (i, row) in field.rows.iter().enumerate() {
            let mut sum = Sum::new();
            sum.add(if k == 0 { row.constant } else { Interval::ZERO });
            row.terms.iter().for_each(|&(factor, r)| sum.add_product(factor, self.values[r * stride + k]));
            self.values[i * stride + k + 1] = sum.total() / Interval::point((k + 1) as f64);
        }
    }

    /// `sum_j du_j v_{k-j} + u_{k-j} dv_j` for each product.
    fn multiply_derivatives(&mut self, field: &Program, k: usize) {
        let (n, stride) = (self.n_variables, self.order + 1);
        for (m, &(a, b)) in field.products.iter().enumerate() {
            let mut sum = self.derivatives.sum();
            for j in 0..=k {
                sum.add(&self.derivatives, a * stride + j, self.factors[b * stride + k - j]);
                sum.add(&self.derivatives, b * stride + j, self.factors[a * stride + k - j]);
            }
            self.derivatives.store((n + m) * stride + k, sum, self.n_terms, 1);
        }
    }

    /// Coefficient `k + 1` of the derivative.
    fn integrate_derivatives(&mut self, field: &Program, k: usize) {
        let stride = self.order + 1;
        for (i, row) in field.rows.iter().enumerate() {
            let mut sum = self.derivatives.sum();
            for &(coefficient, r) in &row.terms {
                sum.add(&self.derivatives, r * stride + k, Factor::new(coefficient, self.n_terms));
            }
            self.derivatives.store(i * stride + k + 1, sum, self.n_terms, k + 1);
        }
    }

    /// Highest coefficient.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Coefficient `k` of the state.
    pub fn state(&self, k: usize) -> IntervalVector {
        (0..self.n_variables).map(|i| self.values[i * (self.order + 1) + k]).collect()
    }

    /// Coefficient `k` of the derivative.
    pub fn derivative(&self, k: usize) -> Matrix<Interval> {
        let (n, stride) = (self.n_variables, self.order + 1);
        Matrix::from_fn(n, n, |i, j| self.derivatives.get(i * stride + k, j).enclosure())
    }

    /// The polynomial of degree `degree` of the state at `time`.
    pub fn state_at(&self, time: Interval, degree: usize) -> IntervalVector {
        let value = |i: usize, k: usize| self.values[i * (self.order + 1) + k];
        (0..self.n_variables).map(|i| horner(|k| value(i, k), degree, time)).collect()
    }

    /// The polynomial of degree `degree` of the derivative at `time`.
    pub fn derivative_at(&self, time: Interval, degree: usize) -> Matrix<Interval> {
        let (n, stride) = (self.n_variables, self.order + 1);
        let value = |i: usize, j: usize, k: usize| Ball::enclosure(self.derivatives.get(i * stride + k, j));
        Matrix::from_fn(n, n, |i, j| horner(|k| value(i, j, k), degree, time))
    }
}

fn horner(coefficient: impl Fn(usize) -> Interval, degree: usize, at: Interval) -> Interval {
    (0..degree).rev().fold(coefficient(degree), |sum, k| sum * at + coefficient(k))
}
