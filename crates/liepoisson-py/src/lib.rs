//! Python shell over `liepoisson-core`: arrays in, arrays out, errors translated, the interpreter released meanwhile.

use liepoisson_core::analysis::{lyapunov, orbit, orbit::Orbits};
use liepoisson_core::ensemble::{Control, Ensemble, Outcome, Summary};
use liepoisson_core::error::Error;
use liepoisson_core::field::{Field, SingleTop, Top};
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::Taylor;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::Duration;

/// A refusal of the core as `liepoisson.errors.ParameterError`.
fn translate(error: Error) -> PyErr {
    Python::attach(|py| {
        let refusal = py.import("liepoisson.errors").and_then(|errors| errors.getattr("ParameterError"));
        match refusal.and_then(|class| class.call1((error.to_string(),))) {
            Ok(refusal) => PyErr::from_value(refusal),
            Err(failure) => failure,
        }
    })
}

/// Parameters of the charged or twisted top: `(inertia, a, b, epsilon)`.
type TopParameters = ([f64; 3], [f64; 3], [f64; 3], f64);

/// Tolerance, order (chosen from the tolerance if None), most steps per trajectory.
type TaylorParameters = (f64, Option<usize>, u64);

fn top_of((inertia, a, b, epsilon): TopParameters) -> PyResult<Top> {
    Top::new(inertia, a, b, epsilon).map_err(translate)
}

fn taylor_of((tolerance, order, max_steps): TaylorParameters) -> PyResult<Taylor> {
    Taylor::new(tolerance, order, max_steps).map_err(translate)
}

/// How often the calling thread looks for Ctrl-C and reports progress.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(100);

/// Runs `work` with the interpreter released. `work` is handed the control of the run and a loop for the calling thread
/// that, several times a second, lets Python look for signals and calls `progress` with the fraction that is done.
fn supervised<R: Send>(
    py: Python<'_>,
    n_members: usize,
    progress: Option<Py<PyAny>>,
    work: impl Send + FnOnce(&Control, &mut (dyn FnMut(&dyn Fn(Duration) -> bool) + Send)) -> Result<R, Error>,
) -> PyResult<R> {
    let control = Control::default();
    let mut interruption: Option<PyErr> = None;
    let result = py.detach(|| {
        let mut watch = |ended_within: &dyn Fn(Duration) -> bool| {
            while !ended_within(BETWEEN_SIGNALS) {
                if interruption.is_some() {
                    continue;
                }
                let seen = Python::attach(|py| {
                    py.check_signals()?;
                    if let Some(progress) = &progress {
                        progress.call1(py, (control.done() / n_members as f64,))?;
                    }
                    Ok(())
                });
                if let Err(error) = seen {
                    interruption = Some(error);
                    control.cancel();
                }
            }
        };
        work(&control, &mut watch)
    });
    match interruption {
        Some(error) => Err(error),
        None => result.map_err(translate),
    }
}

/// Writes outcome codes, times reached, numbers of steps and last states into the result.
fn add_summaries(result: &Bound<'_, PyDict>, summaries: &[Summary], n: usize) -> PyResult<()> {
    let py = result.py();
    let code =
        |summary: &Summary| Outcome::ALL.iter().position(|&outcome| outcome == summary.outcome).unwrap_or(0) as i8;
    let states = summaries.iter().flat_map(|summary| (0..n).map(|i| summary.state.get(i).copied().unwrap_or(f64::NAN)));
    result.set_item("outcome", PyArray1::from_iter(py, summaries.iter().map(code)))?;
    result.set_item("end_time", PyArray1::from_iter(py, summaries.iter().map(|summary| summary.time)))?;
    result.set_item("n_steps", PyArray1::from_iter(py, summaries.iter().map(|summary| summary.n_steps as i64)))?;
    result.set_item("final_state", PyArray1::from_vec(py, states.collect()))?;
    Ok(())
}

/// Which code advances the trajectories.
#[derive(Clone, Copy)]
enum Kernel {
    /// Trajectories side by side in registers: the same bits for any width.
    Lanes(Simd),
    /// One trajectory, the components of its vectors side by side: other last bits.
    Components,
}

impl Kernel {
    fn choose(components: bool) -> PyResult<Kernel> {
        let simd = Simd::from_environment().map_err(translate)?;
        Ok(if components { Kernel::Components } else { Kernel::Lanes(simd) })
    }

    fn name(self) -> &'static str {
        match self {
            Kernel::Lanes(simd) => simd.name(),
            Kernel::Components => "components",
        }
    }
}

fn run_orbits<F: Field>(
    py: Python<'_>,
    ensemble: &Ensemble<'_, F>,
    threads: usize,
    simd: Simd,
    dense: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Orbits> {
    supervised(py, ensemble.n_members(), progress, |control, watch| {
        orbit::orbits(ensemble, threads, simd, control, dense, watch)
    })
}

/// Leaves the zeros out that [`SingleTop`] keeps behind each vector.
fn stripped(mut orbits: Orbits) -> Orbits {
    orbits.states = SingleTop::strip(&orbits.states);
    for summary in &mut orbits.summaries {
        summary.state = SingleTop::strip(&summary.state);
    }
    for series in &mut orbits.series {
        series.coefficients = SingleTop::strip(&series.coefficients);
    }
    orbits
}

/// Orbits of a top at `times`; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (top, taylor, states, tangents, n_tangents, times, threads, dense, components, progress))]
#[allow(clippy::too_many_arguments)] // a function of the shell takes what the Python side has checked, flat
fn orbits_of_top<'py>(
    py: Python<'py>,
    top: TopParameters,
    taylor: TaylorParameters,
    states: PyReadonlyArray1<'py, f64>,
    tangents: PyReadonlyArray1<'py, f64>,
    n_tangents: usize,
    times: PyReadonlyArray1<'py, f64>,
    threads: usize,
    dense: bool,
    components: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (top, taylor) = (top_of(top)?, taylor_of(taylor)?);
    let (states, tangents, times) = (states.as_slice()?, tangents.as_slice()?, times.as_slice()?);
    let kernel = Kernel::choose(components)?;
    let orbits = match kernel {
        Kernel::Lanes(simd) => {
            let ensemble = Ensemble { field: &top, method: taylor, states, tangents, n_tangents, times };
            run_orbits(py, &ensemble, threads, simd, dense, progress)?
        }
        Kernel::Components => {
            let (field, padded) = (SingleTop::new(top), SingleTop::pad(states));
            let ensemble = Ensemble { field: &field, method: taylor, states: &padded, tangents, n_tangents, times };
            stripped(run_orbits(py, &ensemble, 1, Simd::Scalar, dense, progress)?)
        }
    };
    let result = PyDict::new(py);
    add_summaries(&result, &orbits.summaries, 9)?;
    result.set_item("state", orbits.states.into_pyarray(py))?;
    result.set_item("tangent", orbits.tangents.into_pyarray(py))?;
    let series =
        orbits.series.into_iter().map(|series| (series.times.into_pyarray(py), series.coefficients.into_pyarray(py)));
    result.set_item("series", series.collect::<Vec<_>>())?;
    result.set_item("kernel", kernel.name())?;
    result.set_item("order", taylor.order())?;
    Ok(result)
}

/// Finite-time Lyapunov exponents of a top at `times[1:]`; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (top, taylor, states, tangents, times, threads, progress))]
#[allow(clippy::too_many_arguments)]
fn growth_of_top<'py>(
    py: Python<'py>,
    top: TopParameters,
    taylor: TaylorParameters,
    states: PyReadonlyArray1<'py, f64>,
    tangents: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (top, taylor) = (top_of(top)?, taylor_of(taylor)?);
    let simd = Simd::from_environment().map_err(translate)?;
    let (states, tangents, times) = (states.as_slice()?, tangents.as_slice()?, times.as_slice()?);
    let ensemble = Ensemble { field: &top, method: taylor, states, tangents, n_tangents: 1, times };
    let growth = supervised(py, ensemble.n_members(), progress, |control, watch| {
        lyapunov::growth(&ensemble, threads, simd, control, watch)
    })?;
    let result = PyDict::new(py);
    add_summaries(&result, &growth.summaries, 9)?;
    result.set_item("exponent", growth.exponents.into_pyarray(py))?;
    result.set_item("kernel", simd.name())?;
    result.set_item("order", taylor.order())?;
    Ok(result)
}

/// Name of the instruction set that the kernels use, after `LIEPOISSON_SIMD`.
#[pyfunction]
fn simd() -> PyResult<&'static str> {
    Simd::from_environment().map(Simd::name).map_err(translate)
}

/// Names of the instruction sets that this processor has.
#[pyfunction]
fn available_simd() -> Vec<&'static str> {
    Simd::ALL.into_iter().filter(|simd| simd.is_available()).map(Simd::name).collect()
}

/// Names of the outcomes; the code of an outcome is its position.
#[pyfunction]
fn outcomes() -> Vec<&'static str> {
    Outcome::ALL.into_iter().map(Outcome::name).collect()
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(orbits_of_top, module)?)?;
    module.add_function(wrap_pyfunction!(growth_of_top, module)?)?;
    module.add_function(wrap_pyfunction!(simd, module)?)?;
    module.add_function(wrap_pyfunction!(available_simd, module)?)?;
    module.add_function(wrap_pyfunction!(outcomes, module)?)
}
