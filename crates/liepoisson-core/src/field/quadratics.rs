//! Quadratic fields that differ in their coefficients only, one for each trajectory: a register holds trajectories of all of them.

use super::quadratic::Coefficients;
use super::tops::MOST_LANES;
use super::{Field, Hold, Quadratic, Space};
use crate::error::Error;
use crate::lanes::{Lane, Number};

/// The field of each member of an ensemble, in their order.
#[derive(Clone, Debug)]
pub struct Quadratics {
    /// The field of the first member, whose terms are those of all.
    shape: Quadratic,
    n_members: usize,
    /// `(member, number)`
    coefficients: Vec<f64>,
}

impl Quadratics {
    /// One field for each member.
    ///
    /// # Errors
    /// No field, or one that has other terms than the first.
    pub fn new(fields: impl IntoIterator<Item = Result<Quadratic, Error>>) -> Result<Quadratics, Error> {
        let mut fields = fields.into_iter();
        let shape = fields.next().ok_or(Error::Length { name: "fields", wanted: 1, got: 0 })??;
        let mut all = Quadratics { n_members: 1, coefficients: shape.coefficients().collect(), shape };
        for field in fields {
            let field = field?;
            if !field.has_the_terms_of(&all.shape) {
                return Err(Error::OtherTerms { member: all.n_members });
            }
            all.coefficients.extend(field.coefficients());
            all.n_members += 1;
        }
        Ok(all)
    }
}

impl Space for Quadratics {
    fn n_components(&self) -> usize {
        self.shape.n_components()
    }

    fn n_members(&self) -> Option<usize> {
        Some(self.n_members)
    }
}

impl Hold for Quadratics {
    type Held<'f> = SeatedQuadratics<'f>;

    fn hold(&self) -> SeatedQuadratics<'_> {
        let n_coefficients = self.coefficients.len() / self.n_members;
        SeatedQuadratics { fields: self, lanes: vec![[0.0; MOST_LANES]; n_coefficients] }
    }
}

/// The fields of the trajectories that a block advances.
#[derive(Clone, Debug)]
pub struct SeatedQuadratics<'f> {
    fields: &'f Quadratics,
    /// Their coefficients, `(number, lane)`; zero for a lane that was always empty.
    lanes: Vec<[f64; MOST_LANES]>,
}

#[derive(Clone, Copy)]
struct ByLane<'l>(&'l [[f64; MOST_LANES]]);

impl Coefficients for ByLane<'_> {
    #[inline(always)]
    fn scaled<V: Lane>(self, _coefficient: f64, number: usize, scale: f64) -> V {
        let mut register = V::splat(0.0);
        for (to, &coefficient) in register.as_scalars_mut().iter_mut().zip(&self.0[number][..V::WIDTH]) {
            *to = V::Number::of(coefficient * scale);
        }
        register
    }
}

impl Space for SeatedQuadratics<'_> {
    fn n_components(&self) -> usize {
        self.fields.n_components()
    }
}

impl Field for SeatedQuadratics<'_> {
    fn group(&self) -> usize {
        self.fields.shape.group()
    }

    fn seat(&mut self, lane: usize, member: usize) {
        let own = &self.fields.coefficients[member * self.lanes.len()..];
        for (numbers, &number) in self.lanes.iter_mut().zip(own) {
            numbers[lane] = number;
        }
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, _rows: &mut [V], _n_tangents: usize, _k: usize) {}

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        self.fields.shape.extend_with(ByLane(&self.lanes), rows, n_tangents, k);
    }
}
