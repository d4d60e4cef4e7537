//! Methods of integration as Python gives them.

use crate::errors::{exception, translate};
use liepoisson_core::choice::AnyMethod;
use liepoisson_core::method::{Options, Setting};
use pyo3::prelude::*;
use std::collections::HashMap;

/// A method of integration.
#[pyclass(frozen, module = "liepoisson._core")]
pub(crate) struct Method(pub(crate) AnyMethod);

#[derive(FromPyObject)]
enum Given {
    Number(f64),
    Word(String),
}

#[pymethods]
impl Method {
    /// The method of a name with options by name; None is not given.
    #[new]
    fn new(name: &str, options: HashMap<String, Option<Given>>) -> PyResult<Method> {
        let given = options.into_iter().filter_map(|(name, value)| match value? {
            Given::Number(number) => Some((name, Setting::Number(number))),
            Given::Word(word) => Some((name, Setting::Word(word))),
        });
        let unknown =
            || exception("UnknownNameError", &format!("method: wanted {}; got {name:?}", methods().join(", ")));
        let made = AnyMethod::named(name, &Options(given.collect())).ok_or_else(unknown)?;
        made.map(Method).map_err(translate)
    }
}

/// The names of all methods.
#[pyfunction]
pub(crate) fn methods() -> Vec<&'static str> {
    AnyMethod::NAMES.iter().map(|(name, _)| *name).collect()
}
