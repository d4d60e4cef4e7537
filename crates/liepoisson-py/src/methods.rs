//! Methods of integration as Python gives them.

use crate::errors::translate;
use liepoisson_core::choice::AnyMethod;
use liepoisson_core::error::Error;
use liepoisson_core::method::{Gauss, LagrangeMap, MixedTaylor, RungeKutta, Single, Splitting, Taylor};
use pyo3::prelude::*;

fn given(method: Result<impl Into<AnyMethod>, Error>) -> PyResult<Method> {
    method.map(|method| Method(method.into())).map_err(translate)
}

/// A method of integration.
#[pyclass(frozen, module = "liepoisson._core")]
pub(crate) struct Method(pub(crate) AnyMethod);

#[pymethods]
impl Method {
    /// Power series with adaptive steps.
    #[staticmethod]
    fn taylor(tol: f64, order: Option<usize>, mixed: bool, max_steps: u64) -> PyResult<Method> {
        let taylor = Taylor::new(tol, order, max_steps).map_err(translate)?;
        Ok(Method(if mixed { MixedTaylor(taylor).into() } else { taylor.into() }))
    }

    /// The explicit method of order 8, by tolerance or with equal steps.
    #[staticmethod]
    fn runge_kutta(
        tol: Option<f64>,
        step: Option<f64>,
        single: bool,
        compensated: bool,
        max_steps: u64,
    ) -> PyResult<Method> {
        let method = match step {
            Some(step) => RungeKutta::fixed(step, max_steps),
            None => RungeKutta::new(tol.unwrap_or(1e-8), max_steps),
        };
        let method = method.map_err(translate)?;
        if single {
            return given(Single::<RungeKutta>::new(method));
        }
        given(Ok(if compensated { method.compensated() } else { method }))
    }

    /// Compositions of exact flows.
    #[staticmethod]
    fn splitting(order: usize, step: f64, single: bool, max_steps: u64) -> PyResult<Method> {
        let method = Splitting::new(order, step, max_steps).map_err(translate)?;
        Ok(Method(if single { Single(method).into() } else { method.into() }))
    }

    /// The Lagrange top in discrete time.
    #[staticmethod]
    fn lagrange_map(step: f64, max_steps: u64) -> PyResult<Method> {
        given(LagrangeMap::new(step, max_steps))
    }

    /// Gauss collocation.
    #[staticmethod]
    fn gauss(n_stages: usize, step: f64, max_steps: u64) -> PyResult<Method> {
        given(Gauss::new(n_stages, step, max_steps))
    }
}
