//! Systems that are typed: a bracket, a formula and parameters in, the field as plain data out.

use crate::errors::{broken, translate};
use liepoisson_core::field::Functions;
use liepoisson_core::formula::{Bracket, Coordinates, Entry, Given, Lines, Lowered, Refusal, System};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Fields with the names of their components, or scalars.
#[derive(FromPyObject)]
enum Names {
    Scalars(Vec<String>),
    Vectors(Vec<(String, Vec<String>)>),
}

/// The texts of a parameter: a number, a vector, a matrix.
#[derive(FromPyObject)]
enum Texts {
    Scalar(String),
    Vector(Vec<String>),
    Matrix(Vec<Vec<String>>),
}

impl From<Texts> for Given {
    fn from(texts: Texts) -> Given {
        match texts {
            Texts::Scalar(text) => Given::Scalar(text),
            Texts::Vector(entries) => Given::Vector(entries),
            Texts::Matrix(rows) => Given::Matrix(rows),
        }
    }
}

/// The terms of a bracket, `(i, j, m, c)`.
type Terms = Vec<(usize, usize, Option<usize>, String)>;

/// A refusal as the exception of Python's reader.
fn refused(refusal: &Refusal) -> PyErr {
    Python::attach(|py| {
        let errors = py.import("liepoisson.errors");
        let made = errors.and_then(|errors| match refusal.position {
            Some(position) => errors.getattr("ExpressionError")?.call1((&refusal.message, &refusal.text, position)),
            None => errors.getattr("ParameterError")?.call1((&refusal.message,)),
        });
        made.map_or_else(|failure| failure, PyErr::from_value)
    })
}

fn run<R>(work: impl FnOnce() -> Result<R, Refusal>) -> PyResult<R> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(result) => result.map_err(|refusal| refused(&refusal)),
        Err(panic) => Err(broken(&*panic)),
    }
}

/// A Hamiltonian system that is typed.
#[pyclass(frozen, module = "liepoisson._core")]
pub(crate) struct TypedSystem(System);

#[pymethods]
impl TypedSystem {
    /// A system: the names of its coordinates, the terms of its bracket, which has been checked, a formula, values and declarations of parameters.
    #[new]
    fn new(
        names: Names,
        terms: Terms,
        hamiltonian: &str,
        parameters: Vec<(String, Texts)>,
        declared: Vec<String>,
    ) -> PyResult<TypedSystem> {
        let coordinates = match names {
            Names::Scalars(names) => Coordinates::Scalars(names),
            Names::Vectors(fields) => Coordinates::Vectors(fields),
        };
        let entries = terms.into_iter().map(|(i, j, m, c)| Entry { i, j, m, c }).collect();
        let parameters: Vec<(String, Given)> =
            parameters.into_iter().map(|(name, texts)| (name, texts.into())).collect();
        run(|| System::new(Bracket::known(coordinates, entries)?, hamiltonian, &parameters, &declared)).map(TypedSystem)
    }

    /// The equations of motion as texts.
    fn equations(&self) -> PyResult<Vec<String>> {
        run(|| self.0.equations())
    }

    /// The field as the record that `liepoisson.compile.field.record_of` makes.
    fn field<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        match run(|| self.0.field())? {
            Lowered::Top { inertia, a, b, epsilon } => {
                let record = PyDict::new(py);
                record.set_item("kind", "top")?;
                for (name, vector) in [("inertia", inertia), ("a", a), ("b", b)] {
                    record.set_item(name, PyTuple::new(py, vector)?)?;
                }
                record.set_item("epsilon", epsilon)?;
                Ok(record)
            }
            Lowered::Quadratic { n_components, constant, linear, quadratic } => {
                let record = PyDict::new(py);
                record.set_item("kind", "quadratic")?;
                record.set_item("n_components", n_components)?;
                record.set_item("constant", constant)?;
                record.set_item("linear", linear)?;
                record.set_item("quadratic", quadratic)?;
                Ok(record)
            }
            Lowered::Tape(lines) => {
                let record = record_of(py, &lines)?;
                record.set_item("kind", "tape")?;
                Ok(record)
            }
        }
    }

    /// Functions of the coordinates, as the record of a tape without its kind.
    fn functions<'py>(&self, py: Python<'py>, texts: Vec<String>) -> PyResult<Bound<'py, PyDict>> {
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let lines = run(|| self.0.functions(&texts))?;
        // what the tape itself refuses is refused here
        Functions::try_from(lines.clone()).map_err(translate)?;
        record_of(py, &lines)
    }
}

fn record_of<'py>(py: Python<'py>, lines: &Lines) -> PyResult<Bound<'py, PyDict>> {
    let record = PyDict::new(py);
    record.set_item("n_components", lines.n_components)?;
    record.set_item("instructions", lines.instructions.clone())?;
    record.set_item("outputs", &lines.outputs)?;
    Ok(record)
}
