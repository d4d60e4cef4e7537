//! Polynomials with rational coefficients: what a field or an integral is, and what is proved of it without rounding.

use super::rational::Rational;
use crate::error::Error;
use std::collections::BTreeMap;

/// A sum of rational multiples of products of variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    n_variables: usize,
    /// Coefficients, none of them zero, by the numbers of the factors, ascending and with repetitions.
    terms: BTreeMap<Vec<usize>, Rational>,
}

impl Polynomial {
    /// The polynomial with these terms: a coefficient, and the numbers of the variables that it is multiplied by. Equal
    /// products are added.
    ///
    /// # Errors
    /// A factor that is no variable; a sum of coefficients that does not fit.
    pub fn new(
        n_variables: usize,
        terms: impl IntoIterator<Item = (Rational, Vec<usize>)>,
    ) -> Result<Polynomial, Error> {
        let mut sum = Polynomial { n_variables, terms: BTreeMap::new() };
        for (coefficient, mut factors) in terms {
            if let Some(&got) = factors.iter().find(|&&factor| factor >= n_variables) {
                return Err(Error::ComponentIndex { name: "polynomial", n_components: n_variables, got });
            }
            factors.sort_unstable();
            sum.add(factors, coefficient).ok_or(Error::RationalSize)?;
        }
        Ok(sum)
    }

    fn add(&mut self, factors: Vec<usize>, coefficient: Rational) -> Option<()> {
        let sum = self.terms.get(&factors).copied().unwrap_or(Rational::ZERO).plus(coefficient)?;
        if sum.is_zero() {
            self.terms.remove(&factors);
        } else {
            self.terms.insert(factors, sum);
        }
        Some(())
    }

    /// Number of variables.
    pub fn n_variables(&self) -> usize {
        self.n_variables
    }

    /// Factors and coefficients.
    pub fn terms(&self) -> impl Iterator<Item = (&[usize], Rational)> {
        self.terms.iter().map(|(factors, &coefficient)| (factors.as_slice(), coefficient))
    }

    /// Whether it is the zero polynomial.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The derivative along a field, `sum_i f_i d/dx_i`; `None` if a coefficient does not fit.
    pub fn along(&self, field: &[Polynomial]) -> Option<Polynomial> {
        let mut derivative = Polynomial { n_variables: self.n_variables, terms: BTreeMap::new() };
        for (factors, &coefficient) in &self.terms {
            for place in 0..factors.len() {
                let mut others = factors.clone();
                let factor = others.remove(place);
                for (more, rate) in &field.get(factor)?.terms {
                    let mut product = [others.as_slice(), more.as_slice()].concat();
                    product.sort_unstable();
                    derivative.add(product, coefficient.times(*rate)?)?;
                }
            }
        }
        Some(derivative)
    }

    /// `p(s_1 x_1, ..., s_n x_n)` for signs `s`.
    pub fn with_signs(&self, signs: &[Sign]) -> Polynomial {
        let terms = self.terms.iter().map(|(factors, &coefficient)| {
            let is_odd = factors.iter().filter(|&&factor| signs[factor] == Sign::Minus).count() % 2 == 1;
            (factors.clone(), if is_odd { coefficient.negative() } else { coefficient })
        });
        Polynomial { n_variables: self.n_variables, terms: terms.collect() }
    }

    /// The polynomial with the other sign.
    pub fn negative(&self) -> Polynomial {
        let terms = self.terms.iter().map(|(factors, coefficient)| (factors.clone(), coefficient.negative()));
        Polynomial { n_variables: self.n_variables, terms: terms.collect() }
    }
}

/// A sign of a component under a reflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// It is kept.
    Plus,
    /// It is changed.
    Minus,
}

impl Sign {
    /// The number as it is, or with the other sign.
    pub fn of<T: std::ops::Neg<Output = T>>(self, value: T) -> T {
        match self {
            Sign::Plus => value,
            Sign::Minus => -value,
        }
    }
}

/// Whether `f(S x) = S f(x)` for a reflection S, or `f(S x) = -S f(x)`, if `reversing`: then S turns orbits into orbits, run
/// through backwards.
pub fn commutes(field: &[Polynomial], signs: &[Sign], reversing: bool) -> bool {
    field.iter().zip(signs).all(|(component, sign)| {
        let is_changed = (*sign == Sign::Minus) != reversing;
        component.with_signs(signs) == if is_changed { component.negative() } else { component.clone() }
    })
}
