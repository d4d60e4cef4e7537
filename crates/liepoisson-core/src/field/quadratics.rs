//! Quadratic fields that differ in their coefficients only, one for each trajectory: a register holds trajectories of all of them.

use super::quadratic::Coefficients;
use super::tops::MOST_LANES;
use super::{Field, Instance, Instantiate, Quadratic, Space};
use crate::error::Error;
use crate::lanes::{Lane, Number};

/// The field of each trajectory of an ensemble, in their order.
#[derive(Clone, Debug)]
pub struct Quadratics {
    /// The field of the first trajectory, whose terms are those of all.
    shape: Quadratic,
    n_trajectories: usize,
    /// `(trajectory, number)`
    coefficients: Vec<f64>,
}

impl Quadratics {
    /// One field for each trajectory.
    ///
    /// # Errors
    /// No field, or one that has other terms than the first.
    pub fn new(fields: impl IntoIterator<Item = Result<Quadratic, Error>>) -> Result<Quadratics, Error> {
        let mut fields = fields.into_iter();
        let shape = fields.next().ok_or(Error::Length { name: "fields", wanted: 1, got: 0 })??;
        let mut all = Quadratics { n_trajectories: 1, coefficients: shape.coefficients().collect(), shape };
        for field in fields {
            let field = field?;
            if !field.has_the_terms_of(&all.shape) {
                return Err(Error::OtherTerms { trajectory: all.n_trajectories });
            }
            all.coefficients.extend(field.coefficients());
            all.n_trajectories += 1;
        }
        Ok(all)
    }
}

impl Space for Quadratics {
    fn n_components(&self) -> usize {
        self.shape.n_components()
    }

    fn n_trajectories(&self) -> Option<usize> {
        Some(self.n_trajectories)
    }
}

impl Instantiate for Quadratics {
    type Instance<'f> = LaneQuadratics<'f>;

    fn instantiate(&self) -> LaneQuadratics<'_> {
        let n_coefficients = self.coefficients.len() / self.n_trajectories;
        LaneQuadratics { fields: self, lanes: vec![[0.0; MOST_LANES]; n_coefficients] }
    }
}

/// The fields of the trajectories that a block advances.
#[derive(Clone, Debug)]
pub struct LaneQuadratics<'f> {
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

impl Space for LaneQuadratics<'_> {
    fn n_components(&self) -> usize {
        self.fields.n_components()
    }
}

impl Instance for LaneQuadratics<'_> {
    fn assign(&mut self, lane: usize, trajectory: usize) {
        let own = &self.fields.coefficients[trajectory * self.lanes.len()..];
        for (numbers, &number) in self.lanes.iter_mut().zip(own) {
            numbers[lane] = number;
        }
    }
}

impl Field for LaneQuadratics<'_> {
    fn group(&self) -> usize {
        self.fields.shape.group()
    }

    #[inline(always)]
    fn derive_work<V: Lane>(&self, _rows: &mut [V], _n_tangents: usize, _k: usize) {}

    #[inline(always)]
    fn extend<V: Lane>(&self, rows: &mut [V], n_tangents: usize, k: usize) {
        self.fields.shape.extend_with(ByLane(&self.lanes), rows, n_tangents, k);
    }
}
