//! Python shell over `liepoisson-core`: arrays in, arrays out, errors translated, the interpreter released meanwhile.
//!
//! Whatever comes in, an exception or a result goes out: arrays are copied before the interpreter is released, since other
//! threads may write into them, and a panic becomes a `CoreError`.

mod enclosures;
mod errors;
mod fields;
mod formulas;
mod linear;
mod methods;
mod verdicts;

use crate::errors::{broken, exception, guarded, translate};
use crate::fields::{Field, InstructionParts, read_instructions};
use crate::formulas::{TypedSystem, printed_equations, printed_field, printed_functions};
use crate::methods::Method;
use liepoisson_core::analysis::frame::orthonormalise;
use liepoisson_core::analysis::section::{self, Surface, Uncertified};
use liepoisson_core::analysis::tangent_frames::{self, Schedule};
use liepoisson_core::analysis::{last_states, lyapunov, orbit};
use liepoisson_core::choice::{AnyField, AnyMethod};
use liepoisson_core::ensemble::{AnyEnsemble, Control, Outcome, Summary};
use liepoisson_core::error::Error;
use liepoisson_core::field::Functions;
use liepoisson_core::lanes::Simd;
use liepoisson_core::method::AcrossComponents;
use liepoisson_core::modular::{self, Matrix};
use numpy::{Element, IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

/// An array of the caller as numbers of our own.
fn copied<T: Element + Copy>(array: &PyReadonlyArray1<'_, T>) -> PyResult<Vec<T>> {
    let (array, mut numbers) = (array.as_array(), Vec::new());
    let bytes = size_of::<T>() * array.len();
    numbers.try_reserve_exact(array.len()).map_err(|_| translate(Error::Memory { bytes }))?;
    numbers.extend(array.iter().copied());
    Ok(numbers)
}

/// How often the calling thread looks for Ctrl-C and reports progress.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(100);

/// Runs `work` with the interpreter released. `work` is handed the control of the run and a loop for the calling thread
/// that, several times a second, lets Python look for signals and calls `progress` with the fraction that is done.
fn supervised<R: Send>(
    py: Python<'_>,
    n_trajectories: usize,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
    work: impl Send + FnOnce(&Control, &mut (dyn FnMut(&dyn Fn(Duration) -> bool) + Send)) -> Result<R, Error>,
) -> PyResult<R> {
    if time_limit.is_nan() || time_limit <= 0.0 {
        let message = format!("time_limit: wanted a positive number of seconds; got {time_limit}; try 60");
        return Err(exception("ParameterError", &message));
    }
    // beyond what a clock can count there is no limit
    let control = Duration::try_from_secs_f64(time_limit).map_or_else(|_| Control::default(), Control::with_time_limit);
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
                        progress.call1(py, (control.done() / n_trajectories as f64,))?;
                    }
                    Ok(())
                });
                if let Err(error) = seen {
                    interruption = Some(error);
                    control.cancel();
                }
            }
        };
        catch_unwind(AssertUnwindSafe(|| work(&control, &mut watch)))
    });
    match (result, interruption) {
        (_, Some(error)) => Err(error),
        (Ok(result), None) => result.map_err(translate),
        (Err(panic), None) => Err(broken(&*panic)),
    }
}

/// The result of a run: outcome codes, times reached, numbers of steps and last states; kernel and order.
fn result_of_run<'py>(
    py: Python<'py>,
    summaries: &[Summary],
    n_components: usize,
    kernel: &str,
    order: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let codes = summaries.iter().map(|summary| summary.outcome.code() as i8);
    let states = last_states(summaries, n_components).map_err(translate)?;
    result.set_item("outcome", PyArray1::from_iter(py, codes))?;
    result.set_item("end_time", PyArray1::from_iter(py, summaries.iter().map(|summary| summary.time)))?;
    result.set_item("n_steps", PyArray1::from_iter(py, summaries.iter().map(|summary| summary.n_steps as i64)))?;
    result.set_item("final_state", PyArray1::from_vec(py, states))?;
    result.set_item("kernel", kernel)?;
    result.set_item("order", order)?;
    Ok(result)
}

/// Orbits at `times`; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (field, method, states, tangents, n_tangents, times, threads, time_limit, dense, components, progress))]
#[allow(clippy::too_many_arguments)] // a function of the shell takes what the Python side has checked, flat
fn orbits<'py>(
    py: Python<'py>,
    field: &Field,
    method: &Method,
    states: PyReadonlyArray1<'py, f64>,
    tangents: PyReadonlyArray1<'py, f64>,
    n_tangents: usize,
    times: PyReadonlyArray1<'py, f64>,
    threads: usize,
    time_limit: f64,
    dense: bool,
    components: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (states, tangents, times) = (&*copied(&states)?, &*copied(&tangents)?, &*copied(&times)?);
    let simd = Simd::for_trajectories(states.len() / field.n_components()).map_err(translate)?;
    let (kernel, method) = match (components, method.0) {
        (false, method) => (None, method),
        (true, AnyMethod::Taylor(taylor)) if n_tangents == 0 && matches!(field.0, AnyField::Top(_)) => {
            (Some("components"), AnyMethod::AcrossComponents(AcrossComponents(taylor)))
        }
        (true, _) => return Err(translate(Error::AcrossComponents)),
    };
    let integrator = field.0.with(method).map_err(translate)?;
    let ensemble = AnyEnsemble::new(integrator, states, tangents, n_tangents, times);
    let orbits = supervised(py, ensemble.n_trajectories(), time_limit, progress, |control, watch| {
        orbit::orbits(ensemble, threads, simd, control, dense, watch)
    })?;
    let kernel = kernel.unwrap_or_else(|| field.0.kernel(simd));
    let result = result_of_run(py, &orbits.summaries, field.n_components(), kernel, field.0.order(method))?;
    result.set_item("state", orbits.states.into_pyarray(py))?;
    result.set_item("tangent", orbits.tangents.into_pyarray(py))?;
    let series =
        orbits.series.into_iter().map(|series| (series.times.into_pyarray(py), series.coefficients.into_pyarray(py)));
    result.set_item("series", series.collect::<Vec<_>>())?;
    Ok(result)
}

/// States of trajectories with dense output at `times`; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
fn states_at<'py>(
    py: Python<'py>,
    series: Vec<(PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>)>,
    ends: Vec<f64>,
    n_components: usize,
    times: PyReadonlyArray1<'py, f64>,
    backwards: bool,
) -> PyResult<Doubles<'py>> {
    let simd = Simd::from_environment().map_err(translate)?;
    let kept = series.iter().zip(&ends).map(|((times, coefficients), &end)| {
        Ok(orbit::Kept { times: times.as_slice()?, coefficients: coefficients.as_slice()?, end })
    });
    let (kept, times) = (kept.collect::<PyResult<Vec<_>>>()?, copied(&times)?);
    let states = py.detach(|| orbit::states_at(&kept, n_components, &times, backwards, simd));
    Ok(states.map_err(translate)?.into_pyarray(py))
}

/// Finite-time Lyapunov exponents at `times[1:]`; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (field, method, states, tangents, times, threads, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
fn growth<'py>(
    py: Python<'py>,
    field: &Field,
    method: &Method,
    states: PyReadonlyArray1<'py, f64>,
    tangents: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    threads: usize,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (states, tangents, times) = (&*copied(&states)?, &*copied(&tangents)?, &*copied(&times)?);
    let simd = Simd::for_trajectories(states.len() / field.n_components()).map_err(translate)?;
    let ensemble = AnyEnsemble::new(field.0.with(method.0).map_err(translate)?, states, tangents, 1, times);
    let found = supervised(py, ensemble.n_trajectories(), time_limit, progress, |control, watch| {
        lyapunov::finite_time_exponents(ensemble, threads, simd, control, watch)
    })?;
    let result =
        result_of_run(py, &found.summaries, field.n_components(), field.0.kernel(simd), field.0.order(method.0))?;
    result.set_item("exponent", found.exponents.into_pyarray(py))?;
    Ok(result)
}

/// Orthonormal frames carried along trajectories, over many intervals; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (
    field, method, states, frames, n_vectors, units, elapsed, duration, n_intervals, per_row, keep, threads, time_limit, progress
))]
#[allow(clippy::too_many_arguments)]
fn carry_frames<'py>(
    py: Python<'py>,
    field: &Field,
    method: &Method,
    states: PyReadonlyArray1<'py, f64>,
    frames: PyReadonlyArray1<'py, f64>,
    n_vectors: usize,
    units: PyReadonlyArray1<'py, f64>,
    elapsed: PyReadonlyArray1<'py, f64>,
    duration: f64,
    n_intervals: usize,
    per_row: usize,
    keep: bool,
    threads: usize,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let simd = Simd::from_environment().map_err(translate)?;
    let (states, frames) = (&*copied(&states)?, &*copied(&frames)?);
    let (units, elapsed) = (&*copied(&units)?, &*copied(&elapsed)?);
    let schedule = Schedule { frames, units, elapsed, n_intervals, per_row, keep };
    let times = &[0.0, duration];
    let ensemble = AnyEnsemble::new(field.0.with(method.0).map_err(translate)?, states, &[], n_vectors, times);
    let carried = supervised(py, ensemble.n_trajectories(), time_limit, progress, |control, watch| {
        tangent_frames::carry(ensemble, &schedule, threads, simd, control, watch)
    })?;
    let result =
        result_of_run(py, &carried.summaries, field.n_components(), field.0.kernel(simd), field.0.order(method.0))?;
    result.set_item("growth", carried.growth.into_pyarray(py))?;
    result.set_item("triangle", carried.triangles.into_pyarray(py))?;
    result.set_item("kept_frame", carried.kept_frames.into_pyarray(py))?;
    result.set_item("kept_state", carried.kept_states.into_pyarray(py))?;
    result.set_item("frame", carried.frames.into_pyarray(py))?;
    result.set_item("n_complete", PyArray1::from_iter(py, carried.n_complete.iter().map(|&n| n as i64)))?;
    result.set_item("ratio", carried.ratios.into_pyarray(py))?;
    Ok(result)
}

/// Crossings of a surface; arrays are flat, row-major: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (field, method, surface, has_guard, states, times, direction, n_crossings, sides, threads, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
fn sections<'py>(
    py: Python<'py>,
    field: &Field,
    method: &Method,
    surface: (usize, Vec<InstructionParts>, Vec<usize>),
    has_guard: bool,
    states: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    direction: i8,
    n_crossings: Option<usize>,
    sides: Vec<i8>,
    threads: usize,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let simd = Simd::from_environment().map_err(translate)?;
    let (states, times) = (&*copied(&states)?, &*copied(&times)?);
    let ensemble = field.0.section(method.0, states, times).map_err(translate)?;
    let (n_components, instructions, outputs) = surface;
    let surface = guarded(|| {
        let functions = Functions::new(n_components, read_instructions(&instructions)?, outputs)?;
        Ok(Surface { direction, n_crossings, sides, ..Surface::of(functions, has_guard) })
    })?;
    let sections = supervised(py, ensemble.n_trajectories(), time_limit, progress, |control, watch| {
        section::sections(ensemble, &surface, threads, simd, control, watch)
    })?;
    let result =
        result_of_run(py, &sections.summaries, field.n_components(), field.0.kernel(simd), field.0.order(method.0))?;
    let counts = |counts: Vec<usize>| PyArray1::from_iter(py, counts.into_iter().map(|count| count as i64));
    let uncertified = |count: &dyn Fn(&Uncertified) -> u64| {
        PyArray1::from_iter(py, sections.uncertified.iter().map(|uncertified| count(uncertified) as i64))
    };
    result.set_item("unbounded_steps", uncertified(&|uncertified| uncertified.n_unbounded))?;
    result.set_item("unseen_steps", uncertified(&|uncertified| uncertified.n_unseen))?;
    let times = |time: &dyn Fn(&Uncertified) -> f64| PyArray1::from_iter(py, sections.uncertified.iter().map(time));
    result.set_item("undefined_time", times(&|uncertified| uncertified.undefined_time))?;
    result.set_item("unresolved_time", times(&|uncertified| uncertified.unresolved_time))?;
    result.set_item("seen_to", times(&|uncertified| uncertified.seen_to))?;
    result.set_item("lost_changes", uncertified(&|uncertified| uncertified.n_lost_changes))?;
    let in_surface = sections.uncertified.iter().map(|uncertified| uncertified.is_in_surface);
    result.set_item("in_surface", PyArray1::from_iter(py, in_surface))?;
    result.set_item("side", sections.sides.into_pyarray(py))?;
    result.set_item("first_step", sections.first_steps.into_pyarray(py))?;
    result.set_item("count", counts(sections.crossing_counts))?;
    result.set_item("time", sections.crossings.times.into_pyarray(py))?;
    result.set_item("state", sections.crossings.states.into_pyarray(py))?;
    result.set_item("sign", sections.crossings.signs.into_pyarray(py))?;
    result.set_item("touch_count", counts(sections.touch_counts))?;
    result.set_item("touch_time", sections.touches.times.into_pyarray(py))?;
    result.set_item("touch_state", sections.touches.states.into_pyarray(py))?;
    Ok(result)
}

/// An array of doubles that Python gets.
type Doubles<'py> = Bound<'py, PyArray1<f64>>;

/// Q and R of matrices, one after the other, with a positive diagonal of R; the same bits on every processor.
#[pyfunction]
fn orthonormal<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray1<'py, f64>,
    n_rows: usize,
    n_columns: usize,
) -> PyResult<(Doubles<'py>, Doubles<'py>)> {
    let (mut frames, simd) = (copied(&matrices)?, Simd::from_environment().map_err(translate)?);
    let size = n_rows * n_columns;
    if n_columns == 0 || n_columns > n_rows || !frames.len().is_multiple_of(size) {
        return Err(exception("ShapeError", "matrices must have at least as many rows as columns; got another shape."));
    }
    let mut triangles = vec![0.0; frames.len() / n_rows * n_columns];
    for (frame, triangle) in frames.chunks_exact_mut(size).zip(triangles.chunks_exact_mut(n_columns * n_columns)) {
        orthonormalise(simd, frame, n_rows, n_columns, triangle);
    }
    Ok((frames.into_pyarray(py), triangles.into_pyarray(py)))
}

/// Rank and null space of a sparse matrix modulo a prime: see `_core.pyi`.
#[pyfunction]
#[pyo3(signature = (indptr, columns, residues, n_columns, prime, enough_rank, time_limit, progress))]
#[allow(clippy::too_many_arguments)]
fn modular_null_space<'py>(
    py: Python<'py>,
    indptr: PyReadonlyArray1<'py, u64>,
    columns: PyReadonlyArray1<'py, u32>,
    residues: PyReadonlyArray1<'py, u64>,
    n_columns: usize,
    prime: u64,
    enough_rank: Option<usize>,
    time_limit: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (starts, columns, residues) = (&*copied(&indptr)?, &*copied(&columns)?, &*copied(&residues)?);
    let matrix = Matrix { starts, columns, residues, n_columns };
    let space = supervised(py, 1, time_limit, progress, |control, watch| {
        modular::null_space(&matrix, prime, enough_rank, control, watch)
    })?;
    let result = PyDict::new(py);
    result.set_item("rank", space.rank)?;
    result.set_item("complete", space.basis.is_some())?;
    result.set_item("pivots", space.pivots.into_pyarray(py))?;
    result.set_item("free", space.free.into_pyarray(py))?;
    let basis = space.basis.unwrap_or_default();
    result.set_item("indptr", basis.starts.into_pyarray(py))?;
    result.set_item("columns", basis.columns.into_pyarray(py))?;
    result.set_item("residues", basis.residues.into_pyarray(py))?;
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
    module.add_class::<Field>()?;
    module.add_class::<TypedSystem>()?;
    module.add_class::<Method>()?;
    module.add_function(wrap_pyfunction!(methods::methods, module)?)?;
    module.add_function(wrap_pyfunction!(printed_field, module)?)?;
    module.add_function(wrap_pyfunction!(printed_equations, module)?)?;
    module.add_function(wrap_pyfunction!(printed_functions, module)?)?;
    module.add_function(wrap_pyfunction!(orbits, module)?)?;
    module.add_function(wrap_pyfunction!(states_at, module)?)?;
    module.add_function(wrap_pyfunction!(growth, module)?)?;
    module.add_function(wrap_pyfunction!(carry_frames, module)?)?;
    module.add_function(wrap_pyfunction!(sections, module)?)?;
    module.add_function(wrap_pyfunction!(orthonormal, module)?)?;
    module.add_function(wrap_pyfunction!(modular_null_space, module)?)?;
    module.add_function(wrap_pyfunction!(linear::products, module)?)?;
    module.add_function(wrap_pyfunction!(linear::fourier_transforms, module)?)?;
    module.add_function(wrap_pyfunction!(linear::solutions, module)?)?;
    module.add_function(wrap_pyfunction!(linear::determinants, module)?)?;
    module.add_function(wrap_pyfunction!(linear::cholesky, module)?)?;
    module.add_function(wrap_pyfunction!(linear::singular, module)?)?;
    module.add_function(wrap_pyfunction!(linear::symmetric, module)?)?;
    module.add_function(wrap_pyfunction!(linear::eigen, module)?)?;
    module.add_function(wrap_pyfunction!(linear::elementary_of_one, module)?)?;
    module.add_function(wrap_pyfunction!(linear::elementary_of_two, module)?)?;
    module.add_function(wrap_pyfunction!(enclosures::enclose_flow, module)?)?;
    module.add_function(wrap_pyfunction!(enclosures::enclose_section_map, module)?)?;
    module.add_function(wrap_pyfunction!(enclosures::enclose_periodic_orbit, module)?)?;
    module.add_function(wrap_pyfunction!(enclosures::enclose_equilibria, module)?)?;
    module.add_function(wrap_pyfunction!(enclosures::check_covering_relations, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::usual_rule, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::votes, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::verdicts, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::megno, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::growth_powers, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::sali, module)?)?;
    module.add_function(wrap_pyfunction!(verdicts::average_changes, module)?)?;
    module.add_function(wrap_pyfunction!(simd, module)?)?;
    module.add_function(wrap_pyfunction!(available_simd, module)?)?;
    module.add_function(wrap_pyfunction!(outcomes, module)?)
}
