//! Polynomials made ready for evaluation: each product of variables is computed once.

use super::interval::Interval;
use super::matrix::{IntervalVector, Matrix};
use super::polynomial::Polynomial;
use super::sum::Sum;
use std::collections::HashMap;

/// Several polynomials of the same variables.
///
/// Registers `0..n` hold the variables, register `n + m` the product of two earlier ones; a polynomial is a linear
/// combination of registers and a constant.
#[derive(Clone, Debug)]
pub struct Program {
    pub(super) n_variables: usize,
    pub(super) products: Vec<(usize, usize)>,
    pub(super) rows: Vec<Row>,
}

/// `constant + sum_i coefficient_i register_i`.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) constant: Interval,
    pub(super) terms: Vec<(Interval, usize)>,
}

impl Program {
    /// The polynomials, with coefficients enclosed in intervals.
    pub fn new(n_variables: usize, polynomials: &[Polynomial]) -> Program {
        let mut program = Program { n_variables, products: vec![], rows: vec![] };
        let mut known = HashMap::new();
        for polynomial in polynomials {
            let mut row = Row { constant: Interval::ZERO, terms: vec![] };
            for (factors, coefficient) in polynomial.terms() {
                match program.register(factors, &mut known) {
                    Some(register) => row.terms.push((coefficient.enclosure(), register)),
                    None => row.constant = coefficient.enclosure(),
                }
            }
            program.rows.push(row);
        }
        program
    }

    /// The register of a product of variables; `None` for the empty product.
    fn register(&mut self, factors: &[usize], known: &mut HashMap<Vec<usize>, usize>) -> Option<usize> {
        let (&last, others) = factors.split_last()?;
        if others.is_empty() {
            return Some(last);
        }
        if let Some(&register) = known.get(factors) {
            return Some(register);
        }
        let first = self.register(others, known)?;
        self.products.push((first, last));
        let register = self.n_registers() - 1;
        known.insert(factors.to_vec(), register);
        Some(register)
    }

    pub(super) fn n_registers(&self) -> usize {
        self.n_variables + self.products.len()
    }

    /// Number of polynomials.
    pub fn n_rows(&self) -> usize {
        self.rows.len()
    }

    /// Number of variables.
    pub fn n_variables(&self) -> usize {
        self.n_variables
    }

    /// The values on a box.
    pub fn values(&self, at: &[Interval]) -> IntervalVector {
        let registers = self.registers(at);
        let value = |row: &Row| {
            let mut sum = Sum::new();
            sum.add(row.constant);
            row.terms.iter().for_each(|&(coefficient, register)| sum.add_product(coefficient, registers[register]));
            sum.total()
        };
        self.rows.iter().map(value).collect()
    }

    fn registers(&self, at: &[Interval]) -> Vec<Interval> {
        let mut registers = at.to_vec();
        for &(a, b) in &self.products {
            registers.push(if a == b { registers[a].sqr() } else { registers[a] * registers[b] });
        }
        registers
    }

    /// The derivatives on a box, a row for each polynomial.
    pub fn jacobian(&self, at: &[Interval]) -> Matrix<Interval> {
        let registers = self.registers(at);
        let n = self.n_variables;
        let mut gradients: Vec<IntervalVector> = Vec::with_capacity(self.n_registers());
        for i in 0..n {
            gradients.push((0..n).map(|j| if i == j { Interval::ONE } else { Interval::ZERO }).collect());
        }
        for &(a, b) in &self.products {
            let gradient = (0..n).map(|j| gradients[a][j] * registers[b] + registers[a] * gradients[b][j]).collect();
            gradients.push(gradient);
        }
        let mut jacobian = Matrix::from_fn(self.rows.len(), n, |_, _| Interval::ZERO);
        for (i, row) in self.rows.iter().enumerate() {
            for &(coefficient, register) in &row.terms {
                for j in 0..n {
                    jacobian[(i, j)] += coefficient * gradients[register][j];
                }
            }
        }
        jacobian
    }
}
