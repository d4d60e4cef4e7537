//! Systems that are typed or printed: a bracket, formulas and parameters in, the field as plain data out.

use crate::errors::{broken, translate};
use liepoisson_core::field::Functions;
use liepoisson_core::formula::{Bracket, Coordinates, Entry, Given, Lines, Lowered, Printed, Refusal, System};
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

    /// The names of the parameters on which the Hamiltonian depends.
    fn parameters(&self) -> PyResult<Vec<String>> {
        run(|| self.0.parameters())
    }

    /// The field as the record that `liepoisson.compile.field.record_of` makes; a top as any other field, if that is wanted.
    #[pyo3(signature = (general=false))]
    fn field<'py>(&self, py: Python<'py>, general: bool) -> PyResult<Bound<'py, PyDict>> {
        let field = run(|| if general { self.0.general_field() } else { self.0.field() })?;
        record_of_field(py, field)
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

/// Functions of a printed system, as the record of a tape without its kind.
#[pyfunction]
pub(crate) fn printed_functions(
    py: Python<'_>,
    n_components: usize,
    parts: Vec<String>,
    functions: Vec<String>,
) -> PyResult<Bound<'_, PyDict>> {
    let lines = run(|| Printed::new(n_components, &parts)?.functions(&functions))?;
    record_of(py, &lines)
}

/// The field of printed equations, as the record of a field; a tape whatever their degree, if that is wanted.
#[pyfunction]
pub(crate) fn printed_equations(
    py: Python<'_>,
    n_components: usize,
    parts: Vec<String>,
    rates: Vec<String>,
    as_tape: bool,
) -> PyResult<Bound<'_, PyDict>> {
    let field = run(|| Printed::new(n_components, &parts)?.equations(&rates, as_tape))?;
    record_of_field(py, field)
}

/// The field of a printed Hamiltonian on a bracket with these terms.
#[pyfunction]
pub(crate) fn printed_field(
    py: Python<'_>,
    n_components: usize,
    parts: Vec<String>,
    terms: Terms,
    hamiltonian: String,
    as_tape: bool,
) -> PyResult<Bound<'_, PyDict>> {
    let entries = terms.into_iter().map(|(i, j, m, c)| Entry { i, j, m, c }).collect();
    let field = run(|| Printed::new(n_components, &parts)?.field(entries, &hamiltonian, as_tape))?;
    record_of_field(py, field)
}

fn record_of_field(py: Python<'_>, field: Lowered) -> PyResult<Bound<'_, PyDict>> {
    let record = PyDict::new(py);
    match field {
        Lowered::Top { inertia, a, b, epsilon } => {
            record.set_item("kind", "top")?;
            for (name, vector) in [("inertia", inertia), ("a", a), ("b", b)] {
                record.set_item(name, PyTuple::new(py, vector)?)?;
            }
            record.set_item("epsilon", epsilon)?;
        }
        Lowered::Quadratic { n_components, constant, linear, quadratic } => {
            record.set_item("kind", "quadratic")?;
            record.set_item("n_components", n_components)?;
            record.set_item("constant", constant)?;
            record.set_item("linear", linear)?;
            record.set_item("quadratic", quadratic)?;
        }
        Lowered::Tape(lines) => {
            record.update(record_of(py, &lines)?.as_mapping())?;
            record.set_item("kind", "tape")?;
        }
    }
    Ok(record)
}

fn record_of<'py>(py: Python<'py>, lines: &Lines) -> PyResult<Bound<'py, PyDict>> {
    let record = PyDict::new(py);
    record.set_item("n_components", lines.n_components)?;
    record.set_item("instructions", lines.instructions.clone())?;
    record.set_item("outputs", &lines.outputs)?;
    Ok(record)
}
