//! Methods of integration as Python gives them, and the fields that each applies to: all that the shell knows of a method.

use crate::errors::translate;
use liepoisson_core::method::{Gauss, LagrangeMap, MixedTaylor, RungeKutta, Single, Splitting, Taylor};
use pyo3::prelude::*;

/// A method of integration.
#[pyclass(frozen, module = "liepoisson._core")]
pub(crate) struct Method(pub(crate) How);

#[derive(Clone, Copy)]
pub(crate) enum How {
    Taylor(Taylor),
    MixedTaylor(MixedTaylor),
    RungeKutta(RungeKutta),
    SingleRungeKutta(Single<RungeKutta>),
    Splitting(Splitting),
    SingleSplitting(Single<Splitting>),
    Gauss(Gauss),
    LagrangeMap(LagrangeMap),
}

#[pymethods]
impl Method {
    /// Power series with adaptive steps.
    #[staticmethod]
    fn taylor(tol: f64, order: Option<usize>, mixed: bool, max_steps: u64) -> PyResult<Method> {
        let taylor = Taylor::new(tol, order, max_steps).map_err(translate)?;
        Ok(Method(if mixed { How::MixedTaylor(MixedTaylor(taylor)) } else { How::Taylor(taylor) }))
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
            return Single::<RungeKutta>::new(method)
                .map(|single| Method(How::SingleRungeKutta(single)))
                .map_err(translate);
        }
        Ok(Method(How::RungeKutta(if compensated { method.compensated() } else { method })))
    }

    /// Compositions of exact flows.
    #[staticmethod]
    fn splitting(order: usize, step: f64, single: bool, max_steps: u64) -> PyResult<Method> {
        let method = Splitting::new(order, step, max_steps).map_err(translate)?;
        Ok(Method(if single { How::SingleSplitting(Single(method)) } else { How::Splitting(method) }))
    }

    /// The Lagrange top in discrete time.
    #[staticmethod]
    fn lagrange_map(step: f64, max_steps: u64) -> PyResult<Method> {
        LagrangeMap::new(step, max_steps).map(|map| Method(How::LagrangeMap(map))).map_err(translate)
    }

    /// Gauss collocation.
    #[staticmethod]
    fn gauss(n_stages: usize, step: f64, max_steps: u64) -> PyResult<Method> {
        Gauss::new(n_stages, step, max_steps).map(|gauss| Method(How::Gauss(gauss))).map_err(translate)
    }
}

impl How {
    pub(crate) fn order(self) -> usize {
        match self {
            How::Taylor(method) | How::MixedTaylor(MixedTaylor(method)) => method.order(),
            How::RungeKutta(_) | How::SingleRungeKutta(_) => 8,
            How::Splitting(method) | How::SingleSplitting(Single(method)) => method.order(),
            How::Gauss(method) => method.order(),
            How::LagrangeMap(_) => 2,
        }
    }
}

/// Runs a macro with the field and the method of a call, as types of their own.
macro_rules! with_field_and_method {
    ($field:expr, $method:expr, $run:ident) => {{
        use liepoisson_core::error::Error;
        use liepoisson_core::method::LagrangeMap;
        use $crate::errors::translate;
        use $crate::fields::Kind;
        use $crate::methods::How;
        match (&$field.0, $method.0) {
            (Kind::Top(field), How::Taylor(method)) => $run!(field, method),
            (Kind::Top(field), How::MixedTaylor(method)) => $run!(field, method),
            (Kind::Top(field), How::RungeKutta(method)) => $run!(field, method),
            (Kind::Top(field), How::SingleRungeKutta(method)) => $run!(field, method),
            (Kind::Top(field), How::Splitting(method)) => $run!(field, method),
            (Kind::Top(field), How::SingleSplitting(method)) => $run!(field, method),
            (Kind::Top(field), How::Gauss(method)) => $run!(field, method),
            (Kind::Top(field), How::LagrangeMap(_)) if !LagrangeMap::applies_to(field) => {
                return Err(translate(Error::NotLagrange));
            }
            (Kind::Top(field), How::LagrangeMap(method)) => $run!(field, method),
            (Kind::Tops(field), How::Taylor(method)) => $run!(field, method),
            (Kind::Tops(field), How::MixedTaylor(method)) => $run!(field, method),
            (Kind::Quadratics(field), How::Taylor(method)) => $run!(field, method),
            (Kind::Quadratic(field), How::Taylor(method)) => $run!(field, method),
            (Kind::Quadratic(field), How::RungeKutta(method)) => $run!(field, method),
            (Kind::Quadratic(field), How::SingleRungeKutta(method)) => $run!(field, method),
            (Kind::Quadratic(field), How::Gauss(method)) => $run!(field, method),
            (Kind::Tape(field), How::Taylor(method)) => $run!(field, method),
            (Kind::Tape(field), How::RungeKutta(method)) => $run!(field, method),
            (Kind::Tape(field), How::Gauss(method)) => $run!(field, method),
            (Kind::SplitTerms(field), How::Splitting(method)) => $run!(field, method),
            _ => return Err(translate(Error::MethodForField)),
        }
    }};
}
pub(crate) use with_field_and_method;
