//! Vector fields as Python gives them.

use crate::errors::guarded;
use liepoisson_core::choice::AnyField;
use liepoisson_core::error::Error;
use liepoisson_core::field::{Instruction, Noise, Path, Quadratic, Quadratics, Ridge, SplitTerms, Tape, Top, Tops};
use pyo3::prelude::*;

/// A vector field that the core integrates.
#[pyclass(frozen, module = "liepoisson._core")]
pub(crate) struct Field(pub(crate) AnyField);

/// A linear form, the coefficients of a polynomial, a sparse matrix.
type SplitTermParts = (Vec<(usize, f64)>, Vec<f64>, Vec<(usize, usize, f64)>);

/// Entries of degree zero, one and two.
type QuadraticParts = (Vec<(usize, f64)>, Vec<(usize, usize, f64)>, Vec<(usize, usize, usize, f64)>);

/// Inertia, a, b, epsilon.
type TopParts = ([f64; 3], [f64; 3], [f64; 3], f64);

/// Name, registers, numbers.
pub(crate) type InstructionParts = (String, Vec<usize>, Vec<f64>);

pub(crate) fn read_instructions(instructions: &[InstructionParts]) -> Result<Vec<Instruction>, Error> {
    let read = |(name, registers, numbers): &InstructionParts| Instruction::from_parts(name, registers, numbers);
    instructions.iter().map(read).collect()
}

fn split_terms(n_components: usize, pieces: Vec<SplitTermParts>) -> Result<SplitTerms, Error> {
    let ridge = |(form, derivative, generator)| Ridge { form, generator, derivative };
    SplitTerms::new(n_components, pieces.into_iter().map(ridge).collect())
}

#[pymethods]
impl Field {
    /// Dimension of the state.
    #[getter]
    pub(crate) fn n_components(&self) -> usize {
        self.0.n_components()
    }

    /// Whether the Runge-Kutta method takes less work at a tolerance than Taylor's.
    fn prefers_runge_kutta(&self, tol: f64) -> PyResult<bool> {
        guarded(|| self.0.prefers_runge_kutta(tol))
    }

    /// The charged or twisted top.
    #[staticmethod]
    fn top(inertia: [f64; 3], a: [f64; 3], b: [f64; 3], epsilon: f64) -> PyResult<Field> {
        guarded(|| Top::new(inertia, a, b, epsilon)).map(|top| Field(AnyField::Top(top)))
    }

    /// Tops, one for each trajectory.
    #[staticmethod]
    fn tops(tops: Vec<TopParts>) -> PyResult<Field> {
        guarded(|| {
            let made = tops.into_iter().map(|(inertia, a, b, epsilon)| Top::new(inertia, a, b, epsilon));
            Tops::new(made.collect::<Result<_, _>>()?)
        })
        .map(|tops| Field(AnyField::Tops(tops)))
    }

    /// Any field of degree at most two, by its nonzero entries.
    #[staticmethod]
    fn quadratic(
        n_components: usize,
        constant: Vec<(usize, f64)>,
        linear: Vec<(usize, usize, f64)>,
        quadratic: Vec<(usize, usize, usize, f64)>,
    ) -> PyResult<Field> {
        let field = guarded(|| Quadratic::new(n_components, &constant, &linear, &quadratic))?;
        Ok(Field(AnyField::Quadratic(field)))
    }

    /// Fields of degree at most two with the same terms, one for each trajectory, by their nonzero entries.
    #[staticmethod]
    fn quadratics(n_components: usize, fields: Vec<QuadraticParts>) -> PyResult<Field> {
        let make = |(constant, linear, quadratic): QuadraticParts| {
            Quadratic::new(n_components, &constant, &linear, &quadratic)
        };
        guarded(|| Quadratics::new(fields.into_iter().map(make))).map(|fields| Field(AnyField::Quadratics(fields)))
    }

    /// Any smooth field, by the instructions that compute it.
    #[staticmethod]
    #[pyo3(signature = (n_components, instructions, outputs, size_limits = vec![]))]
    fn tape(
        n_components: usize,
        instructions: Vec<InstructionParts>,
        outputs: Vec<usize>,
        size_limits: Vec<Option<f64>>,
    ) -> PyResult<Field> {
        let size_limits = size_limits.into_iter().map(|limit| limit.unwrap_or(f64::INFINITY)).collect();
        let tape = guarded(|| {
            Tape::new(n_components, read_instructions(&instructions)?, outputs)?.with_size_limits(size_limits)
        })?;
        Ok(Field(AnyField::Tape(tape)))
    }

    /// A Lie-Poisson system by split terms of its Hamiltonian, each with a known flow: form, derivative, matrix.
    #[staticmethod]
    fn pieces(n_components: usize, pieces: Vec<SplitTermParts>) -> PyResult<Field> {
        guarded(|| split_terms(n_components, pieces)).map(|terms| Field(AnyField::SplitTerms(terms)))
    }

    /// The same field with noise Hamiltonians by their split terms, the Hamiltonian by its own and an inverse temperature for
    /// the damping, and what the path is made of: two words, the number of the first trajectory, steps before the first one,
    /// increments in each step.
    #[allow(clippy::too_many_arguments)]
    fn with_noise(
        &self,
        noises: Vec<Vec<SplitTermParts>>,
        energy: Vec<SplitTermParts>,
        inverse_temperature: f64,
        key: [u32; 2],
        first: u64,
        n_before: u64,
        n_increments: u32,
    ) -> PyResult<Field> {
        let n = self.n_components();
        guarded(|| {
            let channels = noises.into_iter().map(|noise| split_terms(n, noise)).collect::<Result<_, _>>()?;
            let damping = match inverse_temperature {
                0.0 => None,
                beta => Some((split_terms(n, energy)?, beta)),
            };
            self.0.with_noise(Noise::new(channels, damping, Path { key, first, n_before, n_increments })?)
        })
        .map(Field)
    }
}
